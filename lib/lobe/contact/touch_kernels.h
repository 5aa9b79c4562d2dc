// The loops over the points of a triangle that a tool may touch, compiled once per instruction set
// (touch_kernels.cpp). They take plain arrays and share no inline function with the rest of the library, as
// region/wide_kernels.h says.
#pragma once

#include <array>

#include "lobe/contact/contact_law.h"
#include "lobe/contact/distance_formulas.h"
#include "lobe/contact/touch_points.h"
#include "lobe/instruction_set.h"
#include "lobe/setup/rigid_shape.h"

namespace lobe {

struct TouchShape {
  RigidShape::Kind kind;
  double radius, length;  // [m]
  Vec3d size;             // [m]
  double opening;         // opening of jaws [m]
  double opens;           // speed at which jaws open [m/s]
};

// ξ: the tangential part of the way from the anchor, which follows where friction cannot hold it [m].
// `is_unit`: the length of ∇φ is 1.
template <class T>
Vec3<T> held_slip(const ContactLaw& law, double stiffness, const Vec3<T>& way, const Vec3<T>& gradient,
                  bool is_unit, const T& pressure) {
  using std::sqrt;
  const T along = is_unit ? dot(gradient, way) : T(dot(gradient, way) / dot(gradient, gradient));
  const Vec3<T> slip = way - gradient * along;
  const double k = ContactLaw::slip_share * stiffness;
  const T square = T(k * k) * dot(slip, slip);
  return slip * law.held_share(pressure, square, T(sqrt(square)));
}

// The axes of a tool, and how they move.
struct TouchAxes {
  std::array<std::array<double, 3>, 3> to_tool{};  // rows of the rotation
  std::array<double, 3> position{}, velocity{};    // place and velocity of the tool [m], [m/s]
  std::array<double, 3> spin{};                    // angular velocity in its axes [rad/s]
};

// Points, component after component: that of point i at row[d * stride + i]. There is room for a multiple of
// PointBlock::width of them.
struct TouchRows {
  double* row = nullptr;
  int stride = 0;
};

// A triangle that the tool may touch.
struct TouchTriangle {
  double stiffness = 0;                 // κ [Pa/m]
  double area = 0;                      // area of each of its points [m²]
  std::array<int, 3> points{};          // its corners
  std::array<double, 3> start{};        // the first centroid [m], in the tool's axes, as what follows
  std::array<double, 3> along{}, up{};  // 1/n of its first and second edge [m]
  std::array<double, 3> turn{};         // way from a centroid to that of the turned triangle beside it [m]
};

// What is found at a block of points of a triangle.
struct alignas(64) TouchBlock {
  using Row = PointBlock::Row;

  const PointBlock* points = nullptr;
  int triangle = 0;
  int first = 0;                           // number of its first point
  unsigned int touched = 0;                // bits of lanes
  std::array<Row, 3> place{}, gradient{};  // [m], ∇φ
  Row distance{};                          // φ [m]
  Row held{};                              // h [m]
  std::array<Row, 3> anchor{};             // anchor of friction, where has_anchor is not 0 [m]
  Row has_anchor{};
};

struct TouchKernels {
  // Turns places and velocities of points to places and speeds against the tool, in its axes.
  void (*to_axes)(const TouchAxes& axes, TouchRows x, TouchRows v, int count);
  // Finds places, distances and gradients. Points that are nearer than `near` [m] are touched, and hold
  // nothing. Of a mesh: only places.
  void (*find_distances)(const TouchShape& shape, double near, const TouchTriangle* triangles,
                         TouchBlock* blocks, int count);
  // Adds the forces of points that are touched to those on the corners [N], four numbers each, point by
  // point. With friction anchors become those of after the step. Returns the grip of jaws [N].
  double (*add_forces)(const ContactLaw& law, const TouchShape& shape, const TouchTriangle* triangles,
                       TouchBlock* blocks, int count, TouchRows speeds, double* f);
};

TouchKernels touch_kernels(InstructionSet set);  // kernels for an available set

}  // namespace lobe
