// The forces by which a needle guides the tissue that it has gone through (theory, section 25).
//
// A point of tissue at x is on the needle at the place c, where the needle has the direction t. A stiff
// spring draws it there: F = −k (x − c) on the tissue. Across the needle this is all. Along it the force is
// at most the friction r, and the needle slips through the tissue as soon as it would be more: the point is
// then at another place of the needle, ds further from the tip.
//
// Forces are those at the end of a step of dt, so that k is no limit to the step:
//   F_i/k + dt push Σ_j M⁻¹_ij F_j + ds_i t_i = c_i⁺ − x_i − dt v_i,   |F_i · t_i| ≤ r_i,
//   ds_i = 0 where |F_i · t_i| < r_i;  ds_i ≥ 0 where F_i · t_i = r_i, and ≤ 0 where it is −r_i,
// with the velocities v that the points would have without the needle. M⁻¹_ij says how point i answers to a
// force on point j. The matrix is symmetric and positive definite, so that there is one solution. Which
// points slip is found by trying, from those of the last step on.
//
// O(n³) for n points.
#pragma once

#include <limits>
#include <vector>

#include "lobe/types.h"

namespace lobe {

class NeedleGuide {
 public:
  static constexpr int most = 24;           // points
  static constexpr double stiffness = 1e4;  // k: a needle yields by 0.1 mm under 1 N [N/m]

  struct Point {
    Vec3d x = Vec3d::Zero();       // the tissue at the start of the step [m]
    Vec3d v = Vec3d::Zero();       // its velocity at the end without the needle [m/s]
    Vec3d c = Vec3d::Zero();       // place on the needle at the end of the step [m]
    Vec3d along = Vec3d::UnitX();  // t, unit vector towards the tip
    double friction = 0;           // r [N]; infinite: it sticks
    // The force on the tissue slips along t (1), against it (−1), or sticks (0). At first that of the last
    // step.
    int slip = 0;
    // Results:
    Vec3d force = Vec3d::Zero();  // F [N]
    double slipped = 0;           // ds [m]
  };

  // mobility(a, b): by axis [1/kg], for a ≥ b.
  template <class Mobility>
  void couple(std::size_t count, const Mobility& mobility);
  std::vector<Point>& points() { return points_; }  // those of couple(), at most `most`
  const std::vector<Point>& points() const { return points_; }

  void solve(double dt, double push);  // [s], [s]
  // F of points that no step moves: x is where they are, c the place on the needle.
  static Vec3d force_at_rest(const Point& point);

  double friction_loss() const;  // what the last solution lost where the needle slips [J]

 private:
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3 * most, 3 * most>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3 * most, 1>;
  void assemble(double dt, double push);
  void solve_free();
  bool change_slips(bool only_first);

  std::vector<Point> points_;
  std::vector<Vec3d> mobilities_;  // by rows, #points² [1/kg]
  // Scratch of a step, in axes t, n, b of each point.
  std::vector<Mat3<double>> axes_;
  Matrix matrix_, factor_;  // [m/N]
  Vector right_, force_;    // [m], [N]
  Vector reduced_;
  std::vector<int> free_;  // entries of force_ that are not known
};

template <class Mobility>
void NeedleGuide::couple(std::size_t count, const Mobility& mobility) {
  points_.assign(count, {});
  mobilities_.resize(count * count);
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = 0; b <= a; ++b)
      mobilities_[a * count + b] = mobilities_[b * count + a] = mobility(a, b);
}

}  // namespace lobe
