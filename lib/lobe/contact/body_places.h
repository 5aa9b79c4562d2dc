// How contact sees the body: where the points of its surface and its vertices are in a step, and at stations
// that self contact sets, and where the forces of self contact go. Private: included by contact.cpp.
#pragma once

#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "lobe/contact/contact.h"

namespace lobe {

// Columns that begin at the same place of a line of the cache as others.
template <class Real>
class Contact<Real>::Station {
 public:
  int count() const { return count_; }
  auto columns() { return Eigen::Map<Mat3X<Real>>(numbers_.data() + first_, 3, count_); }
  auto columns() const { return Eigen::Map<const Mat3X<Real>>(numbers_.data() + first_, 3, count_); }
  void lie_like(const Mat3X<Real>& other, int count) {
    constexpr std::size_t line = 64;
    count_ = count;
    numbers_.resize(3 * std::size_t(count) + line / sizeof(Real));
    const auto place = [](const Real* at) { return reinterpret_cast<std::uintptr_t>(at) % line; };
    first_ = (place(other.data()) + line - place(numbers_.data())) % line / sizeof(Real);
  }

 private:
  std::vector<Real> numbers_;
  std::size_t first_ = 0;
  int count_ = 0;
};

template <class Real>
struct Contact<Real>::Stations {
  GapKernels kernels = gap_kernels(chosen_instruction_set());
  Station u[SelfContact::stations], zeros;  // one column per vertex
};

template <class Real>
class Contact<Real>::Here final : public Places {
 public:
  Here(const ContactSurface& surface, const At& at, Stations* stations = nullptr)
      : surface_(surface), at_(at), stations_(stations) {}
  Vec3d of_vertex(Index v) const override {
    return at_.model.elements.points.col(v) + at_.u.col(v).template cast<double>();
  }
  Vec3d velocity_of_vertex(Index v) const override { return at_.v.col(v).template cast<double>(); }
  void of_points(const std::vector<int>& points, PointRows& x, PointRows& v) const override {
    for (std::size_t i = 0; i < points.size(); ++i) {
      x.col(Eigen::Index(i)) = Here::of_point(points[i]);
      v.col(Eigen::Index(i)) = Here::velocity_of_point(points[i]);
    }
  }
  Vec3d of_point(int point) const override {
    const ContactSurface::Point& surface_point = surface_.points()[std::size_t(point)];
    if (surface_point.count == 1) return of_vertex(surface_point.corners[0]);
    Vec3d sum = Vec3d::Zero();
    for (int i = 0; i < surface_point.count; ++i)
      sum += surface_point.weights[i] * of_vertex(surface_point.corners[i]);
    return sum;
  }
  Vec3d velocity_of_point(int point) const override {
    const ContactSurface::Point& surface_point = surface_.points()[std::size_t(point)];
    if (surface_point.count == 1) return velocity_of_vertex(surface_point.corners[0]);
    Vec3d sum = Vec3d::Zero();
    for (int i = 0; i < surface_point.count; ++i)
      sum += surface_point.weights[i] * velocity_of_vertex(surface_point.corners[i]);
    return sum;
  }
  void of_vertices(const std::vector<Index>& vertices, const std::vector<int>& to, double* x,
                   double* v) const override {
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const std::size_t place = 4 * std::size_t(to[i]);
      Eigen::Map<Vec3d>(x + place) = Here::of_vertex(vertices[i]);
      if (v) Eigen::Map<Vec3d>(v + place) = Here::velocity_of_vertex(vertices[i]);
    }
  }

  void set_station(int station, double ahead) const override {
    Station& own = stations_->u[station];
    own.lie_like(at_.u, count());
    own.columns() = at_.u.leftCols(count()) + Real(ahead) * at_.v.leftCols(count());
  }
  double range_since(int station) const override { return range(at_.u, stations_->u[station]); }
  double range_of_speeds() const override {
    if (stations_->zeros.count() != count()) {
      stations_->zeros.lie_like(at_.v, count());
      stations_->zeros.columns().setZero();
    }
    return range(at_.v, stations_->zeros);
  }
  void of_vertices_there(int station, Index origin, const std::vector<Index>& vertices,
                         float* x) const override {
    const auto u = std::as_const(stations_->u[station]).columns();
    const auto& X = at_.model.elements.points;
    const Vec3d from = X.col(origin);
    const Vec3<Real> moved = u.col(origin);
    for (Index v : vertices) {
      Eigen::Map<Vec3<float>> place(x);
      place = (X.col(v) - from).template cast<float>() + (u.col(v) - moved).template cast<float>();
      x += 4;
    }
  }

 private:
  int count() const { return int(at_.model.elements.topology.vertex_count()); }
  double range(const Mat3X<Real>& u, const Station& from) const {
    if (from.count() != count()) return std::numeric_limits<double>::infinity();
    const Real* there = from.columns().data();
    if constexpr (std::is_same_v<Real, float>)
      return stations_->kernels.float_range(u.data(), there, count());
    else
      return stations_->kernels.double_range(u.data(), there, count());
  }

  const ContactSurface& surface_;
  const At& at_;
  Stations* stations_;
};

// Sums in double precision, per vertex of the mesh.
template <class Real>
class Contact<Real>::SelfForces final : public ContactForces {
 public:
  void begin(const ContactSurface& surface, Eigen::Index vertices) {
    surface_ = &surface;
    if (sum_.cols() < vertices) sum_.setZero(3, vertices);
  }
  void add_to_point(int point, const Vec3d& force) override {
    const ContactSurface::Point& surface_point = surface_->points()[std::size_t(point)];
    for (int c = 0; c < surface_point.count; ++c)
      add_to_vertex(surface_point.corners[c], surface_point.weights[c] * force);
  }
  void add_to_vertex(Index v, const Vec3d& force) override {
    if (sum_.col(v).isZero(0)) vertices_.push_back(v);
    sum_.col(v) += force;
  }
  void end(Mat3X<Real>& f) {
    for (Index v : vertices_) {
      f.col(v) += sum_.col(v).template cast<Real>();
      sum_.col(v).setZero();
    }
    vertices_.clear();
  }

 private:
  const ContactSurface* surface_ = nullptr;
  Mat3X<double> sum_;
  std::vector<Index> vertices_;  // some perhaps twice
};

}  // namespace lobe
