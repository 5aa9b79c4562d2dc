// Selective mass scaling of a World (theory, section 7).
#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "lobe/error.h"
#include "lobe/sim/world.h"

namespace lobe {

template <class Real>
void World<Real>::find_inertia() {
  if (moving_is_stale_) find_moving();
  if (inertia_is_stale_) {
    std::sort(inertia_edits_.begin(), inertia_edits_.end());
    inertia_edits_.erase(std::unique(inertia_edits_.begin(), inertia_edits_.end()), inertia_edits_.end());
    selective_mass_.follow(elements_, inertia_edits_, [&](Index t) {
      return is_expanded_ || elements_.region_of[std::size_t(t)] != RegionModel::precomputed;
    });
    inertia_edits_.clear();
    selective_mass_.measure(moving_vertices<Real>(inverse_mass_));
    arrangement_is_stale_ = sleep_.any();
    inertia_is_stale_ = false;
  }
  if (std::exchange(arrangement_is_stale_, false)) selective_mass_.arrange(moving_);
}

template <class Real>
std::vector<int> World<Real>::mass_degrees() const {
  std::vector<int> degrees;
  for (int degree : {1, 3, 5, 9, 12})
    if (degree < setup_.selective_mass) degrees.push_back(degree);
  degrees.push_back(setup_.selective_mass);
  return degrees;
}

// ½ v·C⁻¹v by conjugate gradients: M C p = M v in the inner product of M⁻¹, in which M C is symmetric. What each adds to
// v·p is known without p. Components that are led have lumped masses.
template <class Real>
double World<Real>::kinetic_energy() {
  double twice = 0;
  for (Index v = 0; v < state_.v.count(); ++v)
    twice += mass_[v] * state_.v.col(v).template cast<double>().squaredNorm();
  if (selective_mass_.degree() == 1) return twice / 2;
  find_inertia();
  SelectiveMass<Real> inertia = selective_mass_;  // which keeps the accelerations of the last step
  const auto inner = [&](const Mat3X<Real>& a, const Mat3X<Real>& b) {
    double sum = 0;
    for (const MovingVertex<Real>& own : moving_)
      sum += double(own.inverse_mass) * double(a.col(own.vertex).dot(b.col(own.vertex)));
    return sum;
  };
  Mat3X<Real> left = Mat3X<Real>::Zero(3, state_.v.count());
  for (const MovingVertex<Real>& own : moving_)
    left.col(own.vertex) = state_.v.col(own.vertex) / own.inverse_mass;
  for (const HeldVertices::Held& item : led_)
    for (int axis = 0; axis < 3; ++axis)
      if (item.axes[axis]) left(axis, item.vertex) = 0;
  Mat3X<Real> along = left, image;
  double square = inner(left, left);
  const double small = double(std::numeric_limits<Real>::epsilon()) * square;
  twice -= square;
  constexpr int most = 1000;
  for (int i = 0; i < most && square > small; ++i) {
    image = along;
    inertia.apply(led_, parallel_, image);
    const double step = square / inner(along, image);
    twice += step * square;
    left -= Real(step) * image;
    along = left + Real(inner(left, left) / square) * along;
    square = inner(left, left);
  }
  return twice / 2;
}

template <class Real>
void World<Real>::set_mass_degree(int degree) {
  const std::vector<int> degrees = mass_degrees();
  if (std::find(degrees.begin(), degrees.end(), degree) == degrees.end())
    throw InputError("selective_mass", "has no degree " + std::to_string(degree) +
                                           ", only 1, 3, 5, 9, 12 up to that of the setup, " +
                                           std::to_string(setup_.selective_mass));
  mass_degree_ = degree;
  if (!unravelling_.is_lumped) use_mass_degree(degree);
}

// Where inertia grows, short waves keep about their momentum, v → P v, which they would else carry further than before; long
// ones keep their speed: v → v − (1 − P)² v.
template <class Real>
void World<Real>::use_mass_degree(int degree) {
  const int before = selective_mass_.degree();
  if (degree == before) return;
  catch_up();
  selective_mass_.set_degree(degree);
  if (degree > before) {
    find_inertia();
    Mat3X<Real> once = Mat3X<Real>::Zero(3, state_.v.count());
    for (const MovingVertex<Real>& own : moving_)
      once.col(own.vertex) = state_.v.col(own.vertex) / own.inverse_mass;
    selective_mass_.apply(led_, parallel_, once);
    Mat3X<Real> twice = once;
    selective_mass_.apply(led_, parallel_, twice);
    for (const MovingVertex<Real>& own : moving_)
      state_.v.col(own.vertex) = own.inverse_mass * (Real(2) * once.col(own.vertex) - twice.col(own.vertex));
  }
  ratios_.forget_all(at_rest().ratio);
  ratios_.steps = 0;
  if (at_rest().omega > 0) ratios_.limit = 2 / at_rest().omega;  // a deformed body is measured again soon
  interior_ = Interior::stale;
  known_ = Known::stale;
}

template <class Real>
auto World<Real>::smooth_acceleration(int degree) -> typename SelectiveMass<Real>::Acceleration {
  if (selective_mass_.degree() > 1) return selective_mass_.acceleration();
  Mat3X<Real> smooth = forces_.view();
  make_smooth(degree, smooth);
  return selective_mass_.acceleration();
}

template <class Real>
void World<Real>::make_smooth(int degree, Mat3X<Real>& f) {
  find_inertia();
  const int own = selective_mass_.degree();
  selective_mass_.set_degree(degree);
  selective_mass_.apply(led_, parallel_, f);
  selective_mass_.set_degree(own);
}

template <class Real>
double World<Real>::missing_mobility(const Mat3X<Real>& f) {
  Mat3X<Real> smooth = f;
  make_smooth(setup_.selective_mass, smooth);
  double all = 0, left = 0;
  for (const MovingVertex<Real>& own : moving_) {
    all += double(own.inverse_mass) * double(f.col(own.vertex).squaredNorm());
    left += double(own.inverse_mass) * double(f.col(own.vertex).dot(smooth.col(own.vertex)));
  }
  return all > 0 ? 1 - left / all : 0;
}

template class World<float>;
template class World<double>;

}  // namespace lobe
