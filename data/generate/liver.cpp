#include "organs.h"

namespace organs {
namespace {

// The curved cavity under the liver in which the stomach, the duodenum and the kidney lie. It rises to the
// left.
double viscera(const Vec3& p) {
  return tilted_ellipsoid(p, {-0.012, 0.064, -0.122}, {0.30, 0.128, 0.116}, 0.36);
}

// A furrow in a surface: a tube around the curve that lies on that surface above the segment a-b of the (x,
// y) plane, its radius going from ra to rb; `surface` is the distance of p to the surface.
double furrow(const Vec3& p, double surface, const Vec2& a, const Vec2& b, double ra, double rb) {
  const Vec2 q = p.head<2>();
  const double t = foot_on_segment(q, a, b);
  return std::hypot(distance_to_segment(q, a, b), surface) - (ra + t * (rb - ra));
}

}  // namespace

double liver(const Vec3& p) {
  const double dome = ellipsoid(p, {-0.038, 0.004, 0.004}, {0.061, 0.063, 0.056});
  const double flank = tilted_ellipsoid(p, {-0.060, -0.006, -0.018}, {0.040, 0.052, 0.056}, -0.25);
  const double left = tilted_ellipsoid(p, {0.026, -0.016, 0.014}, {0.076, 0.045, 0.038}, 0.22);
  double d = smooth_union(smooth_union(dome, flank, 0.030), left, 0.022);
  // Falciform ligament: a faint crease over the front and the top, between the lobes.
  d = smooth_subtraction(d, furrow(p, d, {0.024, -0.08}, {0.010, 0.02}, 0.0, 0.0), 0.006);
  // Heart, on top of the left lobe.
  d = smooth_subtraction(d, ellipsoid(p, {0.045, -0.008, 0.105}, {0.070, 0.060, 0.055}), 0.030);
  // The visceral surface. Its edge is sharp in front (the inferior edge) and rounded in the back (the bare
  // area).
  const double hollow = viscera(p);
  d = smooth_subtraction(d, hollow, 0.006 + 0.020 * std::clamp(p.y() / 0.05, 0.0, 1.0));
  // Ligamentum teres: the fissure between the lobes, which notches the front edge.
  d = smooth_subtraction(d, furrow(p, hollow, {0.022, -0.08}, {0.012, 0.012}, 0.013, 0.006), 0.010);
  // Gallbladder.
  d = smooth_subtraction(d, furrow(p, hollow, {-0.040, -0.075}, {-0.018, 0.000}, 0.013, 0.008), 0.012);
  // Porta hepatis.
  d = smooth_subtraction(d, furrow(p, hollow, {-0.018, 0.018}, {0.008, 0.018}, 0.006, 0.006), 0.012);
  // Inferior vena cava, in the back.
  const double vena_cava =
      distance_to_segment<Vec3>(p, {-0.005, 0.066, -0.08}, {-0.002, 0.058, 0.08}) - 0.014;
  return smooth_subtraction(d, vena_cava, 0.010);
}

}  // namespace organs
