#include "lobe/forces/needle_guide.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lobe {

Vec3d NeedleGuide::force_at_rest(const Point& point) {
  const Vec3d force = -stiffness * (point.x - point.c);
  const double along = force.dot(point.along);
  return force + (std::clamp(along, -point.friction, point.friction) - along) * point.along;
}

void NeedleGuide::assemble(double dt, double push) {
  const std::size_t count = points_.size();
  const auto size = Eigen::Index(3 * count);
  axes_.resize(count);
  matrix_.resize(size, size);
  right_.resize(size);
  for (std::size_t i = 0; i < count; ++i) {
    const Point& p = points_[i];
    Mat3<double>& own = axes_[i];
    own.col(0) = p.along;
    own.col(1) = p.along.unitOrthogonal();
    own.col(2) = own.col(0).cross(own.col(1));
    right_.segment<3>(Eigen::Index(3 * i)) = own.transpose() * (p.c - p.x - dt * p.v);
  }
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < count; ++k)
      matrix_.block<3, 3>(Eigen::Index(3 * i), Eigen::Index(3 * k)) =
          dt * push * axes_[i].transpose() * mobilities_[i * count + k].asDiagonal() * axes_[k];
  matrix_.diagonal().array() += 1 / stiffness;
}

// The forces that no friction bounds, with those that it does.
void NeedleGuide::solve_free() {
  free_.clear();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Point& p = points_[i];
    if (p.slip == 0)
      free_.push_back(int(3 * i));
    else
      force_[Eigen::Index(3 * i)] = p.slip * p.friction;
    free_.push_back(int(3 * i + 1));
    free_.push_back(int(3 * i + 2));
  }
  const auto size = Eigen::Index(free_.size());
  factor_.resize(size, size);
  reduced_.resize(size);
  for (Eigen::Index a = 0; a < size; ++a) {
    const Eigen::Index row = free_[std::size_t(a)];
    reduced_[a] = right_[row];
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (points_[i].slip != 0)
        reduced_[a] -= matrix_(row, Eigen::Index(3 * i)) * force_[Eigen::Index(3 * i)];
    for (Eigen::Index b = 0; b < size; ++b) factor_(a, b) = matrix_(row, free_[std::size_t(b)]);
  }
  Eigen::LLT<Eigen::Ref<Matrix>> factor(factor_);
  factor.solveInPlace(reduced_);
  for (Eigen::Index a = 0; a < size; ++a) force_[free_[std::size_t(a)]] = reduced_[a];
}

// Lets points slip whose force is above their friction, and those stick that would slip against it. Returns
// whether any was found.
bool NeedleGuide::change_slips(bool only_first) {
  bool changed = false;
  for (std::size_t i = 0; i < points_.size() && !(changed && only_first); ++i) {
    Point& p = points_[i];
    const auto row = Eigen::Index(3 * i);
    p.slipped = 0;
    if (p.slip == 0) {
      if (std::abs(force_[row]) <= p.friction) continue;
      p.slip = force_[row] > 0 ? 1 : -1;
      changed = true;
      continue;
    }
    p.slipped = right_[row] - matrix_.row(row).dot(force_);
    if (p.friction == 0 || p.slip * p.slipped >= 0) continue;
    p.slip = 0;
    changed = true;
  }
  return changed;
}

// At first all points change that should; if that goes in circles, the first of them alone, which comes to an
// end (Murty's rule of the least index).
void NeedleGuide::solve(double dt, double push) {
  if (points_.empty()) return;
  assemble(dt, push);
  force_.resize(right_.size());
  for (Point& p : points_)
    if (p.friction == 0 && p.slip == 0) p.slip = 1;
  const int together = 3 * int(points_.size());
  constexpr int most_tries = 200;
  for (int i = 0; i < most_tries; ++i) {
    solve_free();
    if (!change_slips(i >= together)) break;
  }
  for (std::size_t i = 0; i < points_.size(); ++i) {
    Point& p = points_[i];
    p.force = axes_[i] * force_.segment<3>(Eigen::Index(3 * i));
    p.slipped = p.slip == 0 ? 0 : right_[Eigen::Index(3 * i)] - matrix_.row(Eigen::Index(3 * i)).dot(force_);
  }
}

double NeedleGuide::friction_loss() const {
  double sum = 0;
  for (const Point& p : points_) sum += std::abs(p.force.dot(p.along) * p.slipped);
  return sum;
}

}  // namespace lobe
