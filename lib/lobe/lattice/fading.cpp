#include "lobe/lattice/fading.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace lobe {

template <class Real>
Real Fading<Real>::share(double time) const {
  if (slides_.empty()) return 0;
  const double left = 1 - std::clamp((time - since_) / duration, 0.0, 1.0);
  return static_cast<Real>(left * left);
}

template <class Real>
Real Fading<Real>::rate(double time) const {
  const double left = 1 - std::clamp((time - since_) / duration, 0.0, 1.0);
  return static_cast<Real>(-2 * left / duration);
}

template <class Real>
typename Fading<Real>::State Fading<Real>::state() const {
  State state;
  state.since = since_;
  state.shifts.resize(3, static_cast<Eigen::Index>(slides_.size()));
  for (const Slide& slide : slides_) {
    state.shifts.col(static_cast<Eigen::Index>(state.vertices.size())) = slide.shift;
    state.vertices.push_back(slide.vertex);
  }
  return state;
}

template <class Real>
void Fading<Real>::set_state(const Elements& elements, const Lattice& lattice, const Embedding& embedding,
                             const State& state) {
  since_ = state.since;
  slides_.clear();
  for (std::size_t i = 0; i < state.vertices.size(); ++i)
    keep(elements, lattice, state.vertices[i], state.shifts.col(Eigen::Index(i)));
  list_at_full(embedding);
}

template <class Real>
void Fading<Real>::keep(const Elements& elements, const Lattice& lattice, Index vertex,
                        const Vec3<Real>& shift) {
  const Index part = lattice.part_of_vertex[std::size_t(vertex)];
  const CellGradients gradients =
      cell_gradients(lattice.in_cell(part, elements.points.col(vertex)), lattice.frame.edge);
  Slide slide{.vertex = vertex, .nodes = lattice.parts[std::size_t(part)].nodes, .shift = shift};
  for (std::size_t n = 0; n < 8; ++n)
    slide.slopes[n] =
        static_cast<Real>(gradients.row(Eigen::Index(n)).dot(shift.template cast<double>().transpose()));
  slides_.push_back(slide);
}

template <class Real>
void Fading<Real>::begin(const Elements& elements, const Lattice& lattice, const Embedding& embedding,
                         const StateColumns<Real>& state) {
  const double edge = lattice.frame.edge;
  since_ = state.time;
  slides_.clear();
  for (Index v : embedding.vertices) {
    const Index part = lattice.part_of_vertex[std::size_t(v)];
    const Vec3d at = lattice.in_cell(part, elements.points.col(v));
    Eigen::Matrix<double, 3, 8> q;
    for (int n = 0; n < 8; ++n)
      q.col(n) =
          state.nodes.u.col(lattice.parts[std::size_t(part)].nodes[std::size_t(n)]).template cast<double>();
    const Vec3d left = state.u.col(v).template cast<double>() - q * cell_weights(at);
    if (!(left.norm() > least * edge)) continue;
    const Mat3<double> F = Mat3<double>::Identity() + q * cell_gradients(at, edge);
    const Vec3d shift = F.inverse() * left;
    if (shift.norm() < edge) keep(elements, lattice, v, shift.template cast<Real>());
  }
  list_at_full(embedding);
}

template <class Real>
void Fading<Real>::list_at_full(const Embedding& embedding) {
  at_full_.clear();
  pulls_.clear();
  for (std::size_t i = 0; i < slides_.size(); ++i) {
    const Slide& slide = slides_[i];
    if (!std::binary_search(embedding.interface.begin(), embedding.interface.end(), slide.vertex)) continue;
    at_full_.push_back(static_cast<Index>(i));
    for (std::size_t n = 0; n < 8; ++n)
      if (embedding.mass[std::size_t(slide.nodes[n])] > 0)
        pulls_.push_back({slide.nodes[n], slide.vertex, slide.slopes[n]});
  }
}

template <class Real>
void Fading<Real>::add(const Slide& slide, bool velocities, Real s, Real ds,
                       StateColumns<Real>& state) const {
  const Vec3<Real> whole = slide.image(state.nodes.u, slide.shift);
  state.u.col(slide.vertex) += s * whole;
  if (velocities)
    state.v.col(slide.vertex) += ds * whole + s * slide.image(state.nodes.v, Vec3<Real>::Zero());
}

template <class Real>
void Fading<Real>::add(bool velocities, StateColumns<Real>& state) const {
  const Real s = share(state.time), ds = rate(state.time);
  if (s == 0) return;
  for (const Slide& slide : slides_) add(slide, velocities, s, ds, state);
}

template <class Real>
void Fading<Real>::add_at_full(bool velocities, Motion<Real>& motion, Parallel& parallel) const {
  const Real s = share(motion.time), ds = rate(motion.time);
  if (s == 0 || at_full_.empty()) return;
  parallel.for_ranges(static_cast<Index>(at_full_.size()), 1024, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i)
      add(slides_[std::size_t(at_full_[std::size_t(i)])], velocities, s, ds, motion);
  });
}

template <class Real>
void Fading<Real>::add_forces(Motion<Real>& motion) const {
  const Real s = share(motion.time);
  if (s == 0) return;
  for (const Pull& pull : pulls_)
    motion.node_forces.col(pull.node) += s * pull.slope * motion.forces.col(pull.vertex);
}

template <class Real>
std::array<Real, 8> Fading<Real>::change_of_weights(Index vertex, double time) const {
  const auto slide = std::lower_bound(slides_.begin(), slides_.end(), vertex,
                                      [](const Slide& own, Index v) { return own.vertex < v; });
  if (slide == slides_.end() || slide->vertex != vertex) return {};
  std::array<Real, 8> change = slide->slopes;
  for (Real& w : change) w *= share(time);
  return change;
}

template class Fading<float>;
template class Fading<double>;

}  // namespace lobe
