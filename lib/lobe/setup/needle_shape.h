// A curved needle: an arc of a circle. The origin of its axes is the centre of the circle, and the arc lies
// in the plane z = 0. The tip is at (radius, 0, 0) and points along y: the needle goes forward along itself
// while it is turned about z by positive angles. A place on it is said by its distance s behind the tip,
// along the arc.
#pragma once

#include <cmath>
#include <string>
#include <tuple>

#include "lobe/types.h"

namespace lobe {

struct NeedleShape {
  double radius = 0;                 // radius of the circle, to the middle of the wire [m]
  double angle = 3.141592653589793;  // angle of the arc [rad], at most a whole turn
  double thickness = 5e-4;           // diameter of the wire [m]

  double length() const { return radius * angle; }  // [m]
  Vec3d place(double s) const {                     // [m] → [m]
    return radius * Vec3d(std::cos(s / radius), -std::sin(s / radius), 0);
  }
  Vec3d forward(double s) const {  // unit vector towards the tip
    return {std::sin(s / radius), std::cos(s / radius), 0};
  }
  // What is wrong with it; empty: nothing.
  std::string fault() const {
    if (!(std::isfinite(radius) && radius > 0)) return "needs a radius above 0 m, and finite";
    if (!(angle > 0 && angle < 6.283185307179587)) return "needs an angle above 0 and below 2π";
    if (!(thickness > 0 && thickness < radius)) return "needs a thickness above 0 m and below its radius";
    return "";
  }

  bool operator==(const NeedleShape&) const = default;
  static constexpr auto fields =
      std::tuple(&NeedleShape::radius, &NeedleShape::angle, &NeedleShape::thickness);
};

// What a needle does to tissue.
struct NeedleSettings {
  NeedleShape shape;
  double puncture = 1;   // force of its tip along it at which the surface gives way [N]
  double friction = 20;  // force along it, per length in the tissue [N/m]

  std::string fault() const {
    if (!(std::isfinite(puncture) && puncture > 0)) return "needs a puncture force above 0 N, and finite";
    if (!(std::isfinite(friction) && friction >= 0)) return "needs a friction of at least 0 N/m, and finite";
    return shape.fault();
  }
  bool is_valid() const { return fault().empty(); }
  bool operator==(const NeedleSettings&) const = default;
  static constexpr auto fields =
      std::tuple(&NeedleSettings::shape, &NeedleSettings::puncture, &NeedleSettings::friction);
};

// Where a needle is.
struct NeedlePose {
  Vec3d centre = Vec3d::Zero();  // [m]
  Mat3<double> turn = Mat3<double>::Identity();

  Vec3d place(const NeedleShape& shape, double s) const { return centre + turn * shape.place(s); }
  Vec3d forward(const NeedleShape& shape, double s) const { return turn * shape.forward(s); }
};

}  // namespace lobe
