#include "lobe/time/inertia.h"

#include <limits>
#include <string>

#include "lobe/assert.h"
#include "lobe/error.h"

namespace lobe {

template <class Real>
void Inertia<Real>::update(const Model& model, const std::vector<Index>& vertices) {
  const auto n = std::size_t(model.elements.topology.vertex_count());
  for (auto* masses : {&mass_, &inverse_mass_}) masses->resize(n, 0);
  add_edits(vertices);
  for (Index v : vertices) mass_[v] = lumped_mass(model.elements, v);
  raise_to_floor(model, vertices);
}

template <class Real>
void Inertia<Real>::prepare_floor(const Elements& elements) {
  const Topology& topology = elements.topology;
  tet_squares_.resize(std::size_t(topology.tet_count() - topology.tet_copy_count()), 0);
  for (std::size_t t = 0; t < tet_squares_.size(); ++t)
    if (!(tet_squares_[t] > 0)) tet_squares_[t] = tet_square(elements, static_cast<Index>(t));
}

template <class Real>
void Inertia<Real>::raise_to_floor(const Model& model, const std::vector<Index>& vertices) {
  if (floor_.square == 0 || model.elements.shares.empty()) return;
  added_.resize(mass_.size(), 0);
  for (Index v : vertices) {
    const double raised = mass_[v] > 0 ? std::max(mass_[v], floor_.at(model.elements, v, &tet_squares_)) : 0;
    sum_of_floor_ += raised - mass_[v] - added_[v];
    added_[v] = raised - mass_[v];
    mass_[v] = raised;
  }
}

template <class Real>
void Inertia<Real>::update_inverse(Model& model, Index v) {
  lobe_assert(mass_[v] >= 0, "a vertex's mass is below 0, or not a number");
  inverse_mass_[v] = mass_[v] > 0 && !model.held.fixes(v) ? 1 / mass_[v] : 0;
  ++model.revisions.inertia;
}

template <class Real>
std::vector<int> Inertia<Real>::degrees() const {
  std::vector<int> degrees;
  for (int degree : {1, 3, 5, 9, 12})
    if (degree < highest_degree_) degrees.push_back(degree);
  degrees.push_back(highest_degree_);
  return degrees;
}

template <class Real>
void Inertia<Real>::check_degree(int degree) const {
  const std::vector<int> there = degrees();
  if (std::find(there.begin(), there.end(), degree) != there.end()) return;
  throw InputError("selective_mass", "has no degree " + std::to_string(degree) +
                                         ", only 1, 3, 5, 9, 12 up to that of the setup, " +
                                         std::to_string(highest_degree_));
}

template <class Real>
void Inertia<Real>::apply(int degree, Parallel& parallel, Mat3X<Real>& f) {
  const int asked_degree = selective_.degree();
  selective_.set_degree(degree);
  apply(parallel, f);
  selective_.set_degree(asked_degree);
}

template <class Real>
void Inertia<Real>::slow_short_waves(Parallel& parallel, Motion<Real>& motion) {
  Mat3X<Real> once = Mat3X<Real>::Zero(3, motion.v.count());
  for (const MovingVertex<Real>& moving : moving_)
    once.col(moving.vertex) = motion.v.col(moving.vertex) / moving.inverse_mass;
  apply(parallel, once);
  Mat3X<Real> twice = once;
  apply(parallel, twice);
  for (const MovingVertex<Real>& free_vertex : moving_)
    motion.v.col(free_vertex.vertex) =
        free_vertex.inverse_mass * (Real(2) * once.col(free_vertex.vertex) - twice.col(free_vertex.vertex));
}

// Computes ½ v·C⁻¹v by conjugate gradients for M C p = M v, in the inner product of M⁻¹, in which M C is
// symmetric. What each iteration adds to v·p is known without p. Driven components have lumped masses.
template <class Real>
double Inertia<Real>::kinetic_energy(const StateColumns<Real>& state, Parallel& parallel) const {
  double twice = 0;
  for (Index v = 0; v < state.v.count(); ++v)
    twice += mass_[v] * state.v.col(v).template cast<double>().squaredNorm();
  if (!is_selective()) return twice / 2;
  SelectiveMass<Real> selective = selective_;  // which keeps the accelerations of the last step
  const auto inner = [&](const Mat3X<Real>& a, const Mat3X<Real>& b) {
    double sum = 0;
    for (const MovingVertex<Real>& moving : moving_)
      sum += double(moving.inverse_mass) * double(a.col(moving.vertex).dot(b.col(moving.vertex)));
    return sum;
  };
  Mat3X<Real> left = Mat3X<Real>::Zero(3, state.v.count());
  for (const MovingVertex<Real>& moving : moving_)
    left.col(moving.vertex) = state.v.col(moving.vertex) / moving.inverse_mass;
  for (const Held& item : driven_)
    for (int axis = 0; axis < 3; ++axis)
      if (item.axes[axis]) left(axis, item.vertex) = 0;
  Mat3X<Real> along = left, image;
  double square = inner(left, left);
  const double small = double(std::numeric_limits<Real>::epsilon()) * square;
  twice -= square;
  constexpr int most = 1000;
  for (int i = 0; i < most && square > small; ++i) {
    image = along;
    selective.apply(driven_, parallel, image);
    const double step = square / inner(along, image);
    twice += step * square;
    left -= Real(step) * image;
    along = left + Real(inner(left, left) / square) * along;
    square = inner(left, left);
  }
  return twice / 2;
}

template class Inertia<float>;
template class Inertia<double>;

}  // namespace lobe
