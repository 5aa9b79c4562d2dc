#include "lobe/contact/stations.h"

#include <cstdint>
#include <limits>

namespace lobe {

template <class Real>
void Stations::Columns<Real>::lie_like(const Mat3X<Real>& other, int count) {
  constexpr std::size_t line = 64;
  count_ = count;
  numbers_.resize(3 * std::size_t(count) + line / sizeof(Real));
  const auto place = [](const Real* at) { return reinterpret_cast<std::uintptr_t>(at) % line; };
  first_ = (place(other.data()) + line - place(numbers_.data())) % line / sizeof(Real);
}

void Stations::set(Station station, const Places& now, double ahead) {
  now.with([&]<class Real>(const Mat3X<Real>& u, const Mat3X<Real>& v) {
    Columns<Real>& own = kept<Real>(*this).u[station];
    own.lie_like(u, now.vertex_count());
    own.all() = u.leftCols(own.count()) + Real(ahead) * v.leftCols(own.count());
  });
}

double Stations::range_since(Station station, const Places& now) const {
  return now.with([&]<class Real>(const Mat3X<Real>& u, const Mat3X<Real>&) {
    return range(u, kept<Real>(*this).u[station], now.vertex_count());
  });
}

double Stations::range_of_speeds(const Places& now) {
  return now.with([&]<class Real>(const Mat3X<Real>&, const Mat3X<Real>& v) {
    Columns<Real>& zeros = kept<Real>(*this).zeros;
    if (zeros.count() != now.vertex_count()) {
      zeros.lie_like(v, now.vertex_count());
      zeros.all().setZero();
    }
    return range(v, zeros, now.vertex_count());
  });
}

void Stations::of_vertices(Station station, const Places& now, Index origin,
                           const std::vector<Index>& vertices, float* x) const {
  now.with([&]<class Real>(const Mat3X<Real>&, const Mat3X<Real>&) {
    const auto u = kept<Real>(*this).u[station].all();
    const auto& X = now.at_rest();
    const Vec3d from = X.col(origin);
    const Vec3<Real> moved = u.col(origin);
    for (Index v : vertices) {
      Eigen::Map<Vec3<float>> place(x);
      place = (X.col(v) - from).template cast<float>() + (u.col(v) - moved).template cast<float>();
      x += 4;
    }
  });
}

double Stations::range(const Mat3X<float>& u, const Columns<float>& from, int count) const {
  if (from.count() != count) return std::numeric_limits<double>::infinity();
  return kernels_.float_range(u.data(), from.all().data(), count);
}

double Stations::range(const Mat3X<double>& u, const Columns<double>& from, int count) const {
  if (from.count() != count) return std::numeric_limits<double>::infinity();
  return kernels_.double_range(u.data(), from.all().data(), count);
}

}  // namespace lobe
