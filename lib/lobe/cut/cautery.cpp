#include "lobe/cut/cautery.h"

#include <algorithm>
#include <cmath>

#include "lobe/cut/distance.h"

namespace lobe {

Eigen::AlignedBox3d box_of(const Sweep& sweep) {
  return {sweep.from.cwiseMin(sweep.to).array() - sweep.radius,
          sweep.from.cwiseMax(sweep.to).array() + sweep.radius};
}

bool touches(const Sweep& sweep, const Mat34<double>& x) {
  const double length = (sweep.to - sweep.from).norm();
  const int samples = static_cast<int>(std::clamp(std::ceil(4 * length / sweep.radius), 1.0, 1e4));
  for (int s = 0; s <= samples; ++s) {
    const Vec3d tip = sweep.from + (sweep.to - sweep.from) * (double(s) / samples);
    if (distance_to_tet(tip, x) <= sweep.radius) return true;
  }
  return false;
}

SweptVolume swept_volume(const Sweep& sweep) {
  return {box_of(sweep), [sweep](const Mat34<double>& corners) { return touches(sweep, corners); }, {}};
}

std::vector<Index> touched_tets(const Topology& topology, const Mat3X<double>& x, const Sweep& sweep) {
  const Eigen::AlignedBox3d reached = box_of(sweep);
  std::vector<Index> touched;
  for (Index t = 0; t < topology.tet_count(); ++t) {
    if (!topology.alive(t)) continue;
    const Mat34<double> corners = x(Eigen::all, topology.corners(t));
    const Eigen::AlignedBox3d box(corners.rowwise().minCoeff(), corners.rowwise().maxCoeff());
    if (box.intersects(reached) && touches(sweep, corners)) touched.push_back(t);
  }
  return touched;
}

}  // namespace lobe
