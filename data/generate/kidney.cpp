#include "organs.h"

namespace organs {

// An ellipsoid whose axis is bent along the parabola x = bend z², so that both poles lean to the hilum, minus
// the hilum: a dent, and the narrower sinus that goes on into it.
double kidney(const Vec3& p) {
  const double bend = 4;  // [1/m]
  const Vec3 straight(p.x() - bend * p.z() * p.z(), p.y(), p.z());
  double d = ellipsoid(straight, {-0.005, 0, 0}, {0.0305, 0.0250, 0.0550});
  d = smooth_subtraction(d, ellipsoid(p, {0.036, 0, 0}, {0.018, 0.030, 0.026}), 0.012);
  return smooth_subtraction(d, ellipsoid(p, {0.020, 0, 0}, {0.013, 0.007, 0.014}), 0.006);
}

}  // namespace organs
