#include "organs.h"

namespace organs {
namespace {

// The axes of the fossa of the gallbladder in the liver: x along it to the front, z out of the liver.
Vec3 in_fossa(const Vec3& p) {
  const Vec3 origin(-0.026, -0.028, -0.026), x = Vec3(-13, -45, -30).normalized(), down(0, 0, -1);
  const Vec3 z = (down - down.dot(x) * x).normalized();
  const Vec3 q = p - origin;
  return {x.dot(q), z.cross(x).dot(q), z.dot(q)};
}

// A tube around the segment a-b, its radius going from ra to rb.
double tube(const Vec3& q, const Vec3& a, const Vec3& b, double ra, double rb) {
  return distance_to_segment(q, a, b) - (ra + foot_on_segment(q, a, b) * (rb - ra));
}

}  // namespace

// A cone with round ends that keeps away from the liver, a funnel, and the cystic duct.
double gallbladder(const Vec3& p) {
  const double gap = 0.003;  // from the liver [m]
  const Vec3 q = in_fossa(p), fundus(0.020, -0.001, 0.014), neck(-0.028, -0.001, 0.0102),
             duct(-0.040, -0.0015, 0.0130), end(-0.068, -0.004, 0.0185);
  double d = tube(q, fundus, neck, 0.0125, 0.0055);
  d = smooth_subtraction(d, liver(p) - gap, 0.003);
  d = smooth_union(d, tube(q, neck, duct, 0.0050, 0.0021), 0.006);
  return smooth_union(d, tube(q, duct, end, 0.0020, 0.0020), 0.003);
}

// From beside the end of the duct to the neck of the gallbladder.
double artery(const Vec3& p) {
  const Vec3 q = in_fossa(p), from(-0.068, -0.0175, 0.0150), bend(-0.042, -0.0135, 0.0135),
             to(-0.024, -0.0113, 0.0132);
  return smooth_union(tube(q, from, bend, 0.0019, 0.0019), tube(q, bend, to, 0.0019, 0.0019), 0.001);
}

}  // namespace organs
