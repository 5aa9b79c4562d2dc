// The shape of a rigid body that touches the organ, such as a tool's tip or a table. The origin of its
// coordinates is the position of the tool.
#pragma once

#include <functional>
#include <string>
#include <tuple>
#include <vector>

#include "lobe/types.h"

namespace lobe {

// Checks call this for each demand: whether it is met, and the fault if it is not.
using Expect = std::function<void(bool is_met, const std::string& fault)>;

struct RigidShape {
  enum class Kind : std::uint8_t { sphere, capsule, box, plane, jaws, mesh };
  Kind kind = Kind::sphere;
  double radius = 0;  // radius of a sphere about the origin, or of a capsule [m]
  double length = 0;  // length of a capsule, whose axis goes from the origin along z [m]
  // Edges of a box about the origin [m]. For jaws: width along x, thickness along y and length along z of
  // each. They start at the origin, one above and one below the plane y = 0, and open in parallel.
  Vec3d size = Vec3d::Zero();
  // Vertices of a closed mesh [m], and its triangles, counter-clockwise seen from outside.
  std::vector<Vec3d> points = {};
  std::vector<Eigen::Vector3i> triangles = {};

  static RigidShape sphere(double radius) { return {.kind = Kind::sphere, .radius = radius}; }
  static RigidShape capsule(double radius, double length) {
    return {.kind = Kind::capsule, .radius = radius, .length = length};
  }
  static RigidShape box(const Vec3d& size) { return {.kind = Kind::box, .size = size}; }
  static RigidShape plane() { return {.kind = Kind::plane}; }  // all that is below z = 0
  static RigidShape jaws(const Vec3d& size) { return {.kind = Kind::jaws, .size = size}; }

  void check(const Expect& expect, const std::string& whose) const;
  // Half of its least extent [m]. It cannot slip between quadrature points that are no further apart.
  double fineness() const;
  // The distance of its farthest point from the origin, of closed jaws [m]; infinite for a plane.
  double reach() const;

  bool operator==(const RigidShape&) const = default;
  static constexpr auto fields = std::tuple(&RigidShape::kind, &RigidShape::radius, &RigidShape::length,
                                            &RigidShape::size, &RigidShape::points, &RigidShape::triangles);
};

}  // namespace lobe
