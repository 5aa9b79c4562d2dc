// Cautery: burns away the tetrahedra that a moving sphere or wire touches. [PDA] section 3.2.
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "lobe/mesh/topology.h"

namespace lobe {

// A sphere that moves in a straight line.
struct Sweep {
  Vec3d from, to;     // [m]
  double radius = 0;  // [m], > 0
};

// The volume that a tool sweeps. `box` contains it [m]. meets(corners) says whether it meets a tetrahedron,
// 3 × 4 [m], that meets `box`. may_meet(other) is false only if it meets no tetrahedron in the box `other`.
// An empty function stands for true. crosses(p, q) says whether it meets the segment from p to q [m]; where
// it is empty, it meets none.
struct SweptVolume {
  Eigen::AlignedBox3d box;
  std::function<bool(const Mat34<double>& corners)> meets = {};
  std::function<bool(const Eigen::AlignedBox3d&)> may_meet = {};
  std::function<bool(const Vec3d& p, const Vec3d& q)> crosses = {};
};
SweptVolume swept_volume(const Sweep& sweep);
// The volume of a wire whose tip makes the sweep. The wire leads from the tip by `from` at the beginning
// and by `to` at the end [m]. It burns as spheres would that are a radius apart, at most 1,000 of them.
SweptVolume swept_volume(const Sweep& tip, const Vec3d& from, const Vec3d& to);

Eigen::AlignedBox3d box_of(const Sweep& sweep);  // [m]

// Whether a tetrahedron is within reach of a sweep. The sweep is sampled every quarter of the radius (between
// samples the reach is short of the radius by less than 1 %), in at most 10,000 places.
bool touches(const Sweep& sweep, const Mat34<double>& corners);
bool touches(const Sweep& sweep, const Vec3d& p, const Vec3d& q);  // whether a segment is within reach [m]

// Alive tetrahedra within reach of the sweep, in ascending order. O(#tets), some nanoseconds each; TetGroups
// finds the same faster, frame after frame.
std::vector<Index> touched_tets(const Topology& topology,
                                const Mat3X<double>& x,  // 3 × #vertices, current positions [m]
                                const Sweep& sweep);

}  // namespace lobe
