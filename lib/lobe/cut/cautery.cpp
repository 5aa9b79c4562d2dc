#include "lobe/cut/cautery.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "lobe/cut/distance.h"

namespace lobe {
namespace {

bool touches(const Sweep& sweep, int samples, const Mat34<double>& x) {
  for (int s = 0; s <= samples; ++s) {
    const Vec3d tip = sweep.from + (sweep.to - sweep.from) * (double(s) / samples);
    if (distance_to_tet(tip, x) <= sweep.radius) return true;
  }
  return false;
}

// One bit per side of a box beyond which a point lies.
std::uint8_t sides_beyond(const Vec3d& x, const Vec3d& low, const Vec3d& high) {
  unsigned bits = 0;
  for (int d = 0; d < 3; ++d) bits |= unsigned(x[d] < low[d]) << d | unsigned(x[d] > high[d]) << (3 + d);
  return static_cast<std::uint8_t>(bits);
}

}  // namespace

std::vector<Index> touched_tets(const Topology& topology, const Mat3X<double>& x, const Sweep& sweep) {
  const Vec3d low = sweep.from.cwiseMin(sweep.to).array() - sweep.radius;
  const Vec3d high = sweep.from.cwiseMax(sweep.to).array() + sweep.radius;
  const double length = (sweep.to - sweep.from).norm();
  const int samples = static_cast<int>(std::clamp(std::ceil(4 * length / sweep.radius), 1.0, 1e4));
  std::vector<std::uint8_t> beyond(std::size_t(topology.vertex_count()));
  for (Index v = 0; v < topology.vertex_count(); ++v) beyond[v] = sides_beyond(x.col(v), low, high);
  std::vector<Index> touched;
  for (Index t = 0; t < topology.tet_count(); ++t) {
    const Eigen::Vector4i v = topology.corners(t);
    if ((beyond[v[0]] & beyond[v[1]] & beyond[v[2]] & beyond[v[3]]) != 0 || !topology.alive(t)) continue;
    if (touches(sweep, samples, x(Eigen::all, v))) touched.push_back(t);
  }
  return touched;
}

}  // namespace lobe
