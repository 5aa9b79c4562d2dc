#include "lobe/cut/cautery.h"

#include <algorithm>
#include <cmath>

#include "lobe/cut/distance.h"

namespace lobe {

Eigen::AlignedBox3d box_of(const Sweep& sweep) {
  return {sweep.from.cwiseMin(sweep.to).array() - sweep.radius,
          sweep.from.cwiseMax(sweep.to).array() + sweep.radius};
}

namespace {

template <class Distance>
bool comes_near(const Sweep& sweep, Distance&& distance_from) {
  const double length = (sweep.to - sweep.from).norm();
  const int samples = static_cast<int>(std::clamp(std::ceil(4 * length / sweep.radius), 1.0, 1e4));
  for (int s = 0; s <= samples; ++s)
    if (distance_from(Vec3d(sweep.from + (sweep.to - sweep.from) * (double(s) / samples))) <= sweep.radius)
      return true;
  return false;
}

}  // namespace

bool touches(const Sweep& sweep, const Mat34<double>& x) {
  return comes_near(sweep, [&](const Vec3d& tip) { return distance_to_tet(tip, x); });
}

bool touches(const Sweep& sweep, const Vec3d& p, const Vec3d& q) {
  return comes_near(sweep, [&](const Vec3d& tip) { return distance_to_segment(tip, p, q); });
}

SweptVolume swept_volume(const Sweep& sweep) {
  return {box_of(sweep),
          [sweep](const Mat34<double>& corners) { return touches(sweep, corners); },
          {},
          [sweep](const Vec3d& p, const Vec3d& q) { return touches(sweep, p, q); }};
}

SweptVolume swept_volume(const Sweep& tip, const Vec3d& from, const Vec3d& to) {
  const double length = std::max(from.norm(), to.norm());
  const int last = static_cast<int>(std::clamp(std::ceil(length / tip.radius), 1.0, 999.0));
  std::vector<Sweep> spheres;
  Eigen::AlignedBox3d box;
  for (int i = 0; i <= last; ++i) {
    const double share = double(i) / last;
    spheres.push_back({tip.from + share * from, tip.to + share * to, tip.radius});
    box.extend(box_of(spheres.back()));
  }
  const auto any_near = [](const std::vector<Sweep>& all, const Eigen::AlignedBox3d& reached,
                           auto&&... what) {
    return std::any_of(all.begin(), all.end(), [&](const Sweep& sphere) {
      return box_of(sphere).intersects(reached) && touches(sphere, what...);
    });
  };
  return {box,
          [spheres, any_near](const Mat34<double>& x) {
            return any_near(spheres, {x.rowwise().minCoeff(), x.rowwise().maxCoeff()}, x);
          },
          {},
          [spheres, any_near](const Vec3d& p, const Vec3d& q) {
            return any_near(spheres, {p.cwiseMin(q), p.cwiseMax(q)}, p, q);
          }};
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
