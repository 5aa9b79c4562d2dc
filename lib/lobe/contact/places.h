// Where a body is in a step, in single or double precision, and where forces of contact on it go.
#pragma once

#include "lobe/contact/contact_surface.h"

namespace lobe {

// One column for each point, component after component.
using PointRows = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;

class Places {
 public:
  // Displacements u [m] and velocities v [m/s], columns of at least all vertices. All are used as long as
  // the object is.
  Places(const ContactSurface& surface, const Model& model, const Mat3X<float>& u, const Mat3X<float>& v)
      : surface_(surface), model_(model), single_{&u, &v} {}
  Places(const ContactSurface& surface, const Model& model, const Mat3X<double>& u, const Mat3X<double>& v)
      : surface_(surface), model_(model), exact_{&u, &v} {}

  int vertex_count() const { return int(model_.elements.topology.vertex_count()); }
  const VertexColumns<Mat3X<double>>& at_rest() const { return model_.elements.points; }  // [m]
  // Calls use(u, v) with the arrays, which are of one precision or the other.
  template <class Use>
  decltype(auto) with(Use&& use) const {
    return single_.u ? use(*single_.u, *single_.v) : use(*exact_.u, *exact_.v);
  }

  Vec3d of_vertex(Index vertex) const {  // place of a vertex of the mesh [m]
    return with([&](const auto& u, const auto&) { return of_vertex_in(u, vertex); });
  }
  Vec3d of_point(int point) const {  // place of a point of the surface [m]
    return with([&](const auto& u, const auto&) {
      return at_point(point, [&](Index vertex) { return of_vertex_in(u, vertex); });
    });
  }
  Vec3d velocity_of_point(int point) const {  // [m/s]
    return with([&](const auto&, const auto& v) {
      return at_point(point, [&](Index vertex) { return Vec3d(v.col(vertex).template cast<double>()); });
    });
  }
  // The places [m] and velocities [m/s] of some points of the surface.
  void of_points(const std::vector<int>& points, PointRows& x, PointRows& v) const;
  // Writes the positions of vertices of the mesh [m] to x[4 to[i]] … x[4 to[i] + 2], and their velocities
  // [m/s] to v in the same way, unless v is null. Every fourth number keeps its value.
  void of_vertices(const std::vector<Index>& vertices, const std::vector<int>& to, double* x,
                   double* v) const;

 private:
  template <class Real>
  struct Columns {
    const Mat3X<Real>*u = nullptr, *v = nullptr;
  };
  template <class Real>
  Vec3d of_vertex_in(const Mat3X<Real>& u, Index vertex) const {
    return at_rest().col(vertex) + u.col(vertex).template cast<double>();
  }
  template <class OfVertex>
  Vec3d at_point(int point, OfVertex&& of_vertex) const {
    const ContactSurface::Point& surface_point = surface_.points()[std::size_t(point)];
    if (surface_point.count == 1) return of_vertex(surface_point.corners[0]);
    Vec3d sum = Vec3d::Zero();
    for (int i = 0; i < surface_point.count; ++i)
      sum += surface_point.weights[i] * of_vertex(surface_point.corners[i]);
    return sum;
  }

  const ContactSurface& surface_;
  const Model& model_;
  Columns<float> single_;  // null, as the next, if it is of the other precision
  Columns<double> exact_;
};

// Sums of forces in double precision, per vertex of the mesh.
class ContactForces {
 public:
  void begin(const ContactSurface& surface, Eigen::Index vertices) {
    surface_ = &surface;
    if (sum_.cols() < vertices) sum_.setZero(3, vertices);
  }
  void add_to_point(int point, const Vec3d& force) {  // a point of the surface, a force [N]
    const ContactSurface::Point& surface_point = surface_->points()[std::size_t(point)];
    for (int c = 0; c < surface_point.count; ++c)
      add_to_vertex(surface_point.corners[c], surface_point.weights[c] * force);
  }
  void add_to_vertex(Index vertex, const Vec3d& force) {  // a vertex of the mesh, a force [N]
    if (sum_.col(vertex).isZero(0)) vertices_.push_back(vertex);
    sum_.col(vertex) += force;
  }
  template <class Real>
  void end(Mat3X<Real>& f) {  // f += the sums, which are zero from now on
    for (Index v : vertices_) {
      f.col(v) += sum_.col(v).template cast<Real>();
      sum_.col(v).setZero();
    }
    vertices_.clear();
  }

 private:
  const ContactSurface* surface_ = nullptr;
  Mat3X<double> sum_;
  std::vector<Index> vertices_;  // vertices with a force, some perhaps twice
};

}  // namespace lobe
