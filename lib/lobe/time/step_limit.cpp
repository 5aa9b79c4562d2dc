#include "lobe/time/step_limit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lobe/time/own_steps.h"

namespace lobe {
namespace {

constexpr double caution = 1.2;  // nodes move on until they are measured again

// Displacements from a state that is so far from rest [m], for differences of forces.
template <class Real>
double small_about(double farthest) {
  return std::sqrt(double(std::numeric_limits<Real>::epsilon())) / 3 * farthest;
}

// The longest stable step of x'' = −ω² x − c x', whose damping is taken half a step late: the Δt [s] of
// ω²Δt² + 2cΔt = 4.
double limit_of(double omega, double c) {  // [rad/s], [1/s]
  if (c > 0) return 4 / (c + std::sqrt(c * c + 4 * omega * omega));
  return omega > 0 ? 2 / omega : std::numeric_limits<double>::infinity();
}

// The highest rate at which force terms damp a vertex [1/s]. With selective masses, no rate is higher than
// with lumped ones.
template <class Real>
double damping_rate(const Dynamics<Real>& body) {
  if (body.terms.empty()) return 0;
  std::vector<double> damping(std::size_t(body.model.elements.topology.vertex_count()), 0);
  for (const auto& term : body.terms) term->add_diagonal_damping(body.here(), damping);
  double highest = 0;
  for (std::size_t v = 0; v < damping.size(); ++v)
    if (damping[v] > 0) highest = std::max(highest, damping[v] * body.inertia.inverse_mass(Index(v)));
  return highest;
}

}  // namespace

template <class Real>
template <class Weight>
void StepLimit<Real>::find_frequencies(Body& body, Weight&& weight) {
  body.regions.begin_forces(false, body.motion, body.parallel);  // wherever a reader may have left them
  frequencies_.find(body.model.elements.topology.vertex_count(), weight, [&](DiagonalStiffness& K) {
    const auto found = body.regions.add_diagonal_stiffness(body.motion.u.padded(), K, body.parallel);
    volume_ratio_ = found.smallest_volume_ratio;
    volume_ratio_tet_ = found.smallest_tet;
    auto nodes = body.regions.highest_frequency(body.motion, K, ratios_.most);
    node_omega_ = nodes.omega;
    node_squares_ = std::move(nodes.squares);
    if (nodes.smallest.volume_ratio < volume_ratio_) {
      volume_ratio_ = nodes.smallest.volume_ratio;
      volume_ratio_tet_ = nodes.smallest.tet;
    }
    for (const auto& term : body.terms) term->add_diagonal_stiffness(body.here(), K);
  });
  damping_rate_ = damping_rate(body);
  found_at_ = body.model.revisions;
}

template <class Real>
void StepLimit<Real>::find_anew(Body& body) {
  if (known_ == Known::anew && is_known(body)) return;
  find_frequencies(body, [&](Index v) { return weight(body, v); });
  known_ = Known::anew;
}

template <class Real>
double StepLimit<Real>::find(Body& body) {
  if (!is_known(body)) {
    known_ = Known::nothing;
    find_anew(body);
  }
  const VertexFrequency highest = frequencies_.highest([&](Index v) { return weight(body, v); });
  limiting_vertex_ = highest.vertex;
  // SVK softens when crushed. A step far longer than that of the body at rest would still be unsafe.
  const double omega = std::max({highest.omega, at_rest(body).omega / 4, ratios_.of_nodes * node_omega_});
  return limit_of(omega, damping_rate_);
}

template <class Real>
double StepLimit<Real>::keep(Body& body) {
  frame_limit_.limit = find(body);
  frame_limit_.time = body.motion.time;
  frame_limit_.limiting_vertex = limiting_vertex_;
  frame_limit_.volume_ratio = volume_ratio_;
  frame_limit_.volume_ratio_tet = volume_ratio_tet_;
  frame_limit_at_ = body.model.revisions;
  body.sleep.see_frequencies([&](Index v) { return bounded_square(v); });
  if (body.own_steps)
    body.own_steps->see_frequencies(
        body, [&](Index v) { return frequencies_.bounded_square(v); },
        [&](Index v) { return limiting_square(body, v, 0); });
  return frame_limit_.limit;
}

template <class Real>
std::vector<double> StepLimit<Real>::limiting_squares(const Body& body) const {
  std::vector<double> squares(std::size_t(body.motion.u.count()));
  for (std::size_t v = 0; v < squares.size(); ++v) squares[v] = limiting_square(body, Index(v), 0);
  return squares;
}

template <class Real>
double StepLimit<Real>::at_end(Body& body) {
  if (holds(body)) return std::numeric_limits<double>::infinity();
  frame_limit_.is_new = true;
  return keep(body);
}

// When it is found again does not depend on when a tool was brought: what hands did has the same bits when it
// is played as a scene, which has the tool from the start.
template <class Real>
bool StepLimit<Real>::holds(const Body& body) const {
  const Revisions& now = body.model.revisions;
  const auto number_of = [](double time) { return std::floor(time / interval + 1e-6); };
  return number_of(body.motion.time) == number_of(frame_limit_.time) &&
         frame_limit_at_.structure == now.structure && frame_limit_at_.inertia == now.inertia &&
         frame_limit_at_.replaced == now.replaced && frame_limit_at_.terms == now.terms;
}

template <class Real>
void StepLimit<Real>::set_frame_limit(const FrameLimit& frame_limit, const Body& body) {
  frame_limit_ = frame_limit;
  frame_limit_at_ = body.model.revisions;
}

template <class Real>
VertexFrequency StepLimit<Real>::highest_vertex(Body& body) {
  const auto alone = [&](Index v) { return body.inertia.inverse_mass(v); };
  find_frequencies(body, alone);
  known_ = Known::nothing;
  return frequencies_.highest(alone);
}

// Searches about the present state, with displacements that are small enough for forces to be linear, and
// large enough for their differences to be accurate. If the body has moved so far that there are none,
// nothing is found.
template <class Real>
HighestFrequency StepLimit<Real>::search_highest(Body& body, const LanczosSettings& settings) {
  body.regions.begin_forces(false, body.motion, body.parallel);
  const Mat3X<Real> at = body.motion.u.view();
  double farthest = 0;  // of what moves by itself [m]
  for (Index v = 0; v < static_cast<Index>(at.cols()); ++v)
    if (body.inertia.inverse_mass(v) > 0) farthest = std::max(farthest, double(at.col(v).norm()));
  const bool at_rest = farthest == 0;
  if (at_rest && !body.terms.empty()) return {};
  const double small = at_rest ? 1e-9 * mean_edge_ : small_about<Real>(farthest);
  if (!(small < 0.01 * mean_edge_)) return {};
  body.regions.invalidate_sums();
  const Mat3X<Real> velocities = body.terms.empty() ? Mat3X<Real>() : Mat3X<Real>(body.motion.v.view());
  const double missing_share = body.loads.missing_share(body.motion.time);
  const auto add_forces = [&](const Mat3X<Real>& u, Mat3X<Real>& f) {
    if (at_rest)
      body.regions.add_forces_near_rest(u, f, body.parallel);
    else
      body.regions.add_forces_near(u, missing_share, f, body.parallel);
    for (const auto& term : body.terms) term->add_forces({body.model, u, velocities, body.motion.time}, f);
  };
  Mat3X<Real> there = Mat3X<Real>::Zero(3, at.cols());
  if (!at_rest) add_forces(at, there);
  const std::function<void(Mat3X<Real>&)> nothing, scale = [&](Mat3X<Real>&f) {
    body.prepare_inertia();
    body.inertia.apply(body.parallel, f);
  };
  return highest_frequency<Real>(
      body.inertia.inverse_mass(), [&](Index v) { return bounded_square(v); }, small,
      [&](const Mat3X<Real>& u, Mat3X<Real>& f) {
        f -= there;
        add_forces(at_rest ? u : Mat3X<Real>(at + u), f);
      },
      settings, body.inertia.is_selective() ? scale : nothing);
}

// The same of all that moves, vertices and nodes in one list.
template <class Real>
HighestFrequency StepLimit<Real>::search_with_nodes(Body& body, const LanczosSettings& settings) {
  Motion<Real>& motion = body.motion;
  const std::vector<MovingVertex<Real>>& nodes = body.regions.moving_nodes();
  std::vector<Index> vertices;
  std::vector<double> inverse_mass, squares;
  for (Index v = 0; v < motion.u.count(); ++v) {
    if (!(body.inertia.inverse_mass(v) > 0)) continue;
    vertices.push_back(v);
    inverse_mass.push_back(body.inertia.inverse_mass(v));
    squares.push_back(bounded_square(v));
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    inverse_mass.push_back(double(nodes[i].inverse_mass));
    squares.push_back(node_squares_[i]);
  }
  const auto visit = [&](auto&& of_vertex, auto&& of_node) {
    Index i = 0;
    for (Index v : vertices) of_vertex(v, i++);
    for (const MovingVertex<Real>& node : nodes) of_node(node.vertex, i++);
  };
  const StateColumns<Real> at = motion;
  double farthest = 0;
  visit([&](Index v, Index) { farthest = std::max(farthest, double(at.u.col(v).norm())); },
        [&](Index n, Index) { farthest = std::max(farthest, double(at.nodes.u.col(n).norm())); });
  const double small = small_about<Real>(farthest);
  if (!(farthest > 0) || !(small < 0.01 * mean_edge_)) return {};
  const auto find_forces = [&](Mat3X<Real>& f) {
    body.find_forces();
    visit([&](Index v, Index i) { f.col(i) = motion.forces.col(v); },
          [&](Index n, Index i) { f.col(i) = motion.node_forces.col(n); });
  };
  body.regions.invalidate_sums();
  Mat3X<Real> there(3, static_cast<Eigen::Index>(squares.size()));
  find_forces(there);
  Mat3X<Real> forces = there;
  const HighestFrequency found = highest_frequency<Real>(
      inverse_mass, [&](Index i) { return squares[std::size_t(i)]; }, small,
      [&](const Mat3X<Real>& u, Mat3X<Real>& f) {
        visit([&](Index v, Index i) { motion.u.col(v) = at.u.col(v) + u.col(i); },
              [&](Index n, Index i) { motion.nodes.u.col(n) = at.nodes.u.col(n) + u.col(i); });
        find_forces(forces);
        f += forces - there;
      },
      settings);
  static_cast<StateColumns<Real>&>(motion) = at;
  body.regions.invalidate_sums();
  return found;
}

template <class Real>
void StepLimit<Real>::measure_degree_at_rest(Body& body) {
  ratios_.forget_all(1);
  const double vertex = highest_vertex(body).omega;
  if (!(vertex > 0)) return;
  search_ = search_highest(body, {});
  at_rest(body).ratio = std::max(least_ratio(body), search_.omega / vertex);
  at_rest(body).omega = at_rest(body).ratio * vertex;
  ratios_.forget_all(at_rest(body).ratio);
  ratios_.limit = find(body);
}

template <class Real>
void StepLimit<Real>::measure_at_rest(Body& body) {
  for (int degree : body.inertia.degrees()) {
    body.inertia.use(degree);
    measure_degree_at_rest(body);
  }
  if (!body.regions.has_modes()) at_rest_[1] = at_rest_[0];
}

template <class Real>
void StepLimit<Real>::measure_again(Body& body) {
  if (body.inertia.is_selective() && body.sleep.any()) return;  // C has the vertices that move only
  const double limit = find(body);
  if (!ratios_.is_worth_measuring(limit)) return;
  ratios_.steps = 0;
  ratios_.limit = limit;
  constexpr LanczosSettings settings{.tolerance = 0.02, .most = FrequencyRatios::evaluations};
  if (nodes_limit(limit)) {
    const HighestFrequency found = search_with_nodes(body, settings);
    if (found.omega > 0) ratios_.of_nodes = std::min(1.0, caution * found.omega / node_omega_);
    ratios_.limit = find(body);
    return;
  }
  const HighestFrequency found = search_highest(body, settings);
  if (!(found.omega > 0)) return;
  std::vector<double> alone;
  for (Index v = 0; v < body.model.elements.topology.vertex_count(); ++v)
    alone.push_back(std::sqrt(exact_square(body, v)));
  ratios_.measured(found.omega, alone, least_ratio(body));
  frequencies_.weigh([&](Index v) { return weight(body, v); });
  ratios_.limit = find(body);
}

template <class Real>
void StepLimit<Real>::restart(Body& body) {
  ratios_.forget_all(at_rest(body).ratio);
  forget();
}

template <class Real>
void StepLimit<Real>::restart_for_degree(Body& body) {
  restart(body);
  ratios_.steps = 0;
  if (at_rest(body).omega > 0)
    ratios_.limit = 2 / at_rest(body).omega;  // a deformed body is measured again soon
}

template <class Real>
CornerStiffness StepLimit<Real>::stiffness_of(const Body& body, Index tet) {
  const Mat34<Real> u = body.motion.u.padded()(Eigen::all, body.model.elements.topology.corners(tet));
  return corner_stiffness(body.model.elements, tet, u.template cast<double>());
}

template <class Real>
void StepLimit<Real>::follow(const Body& body, const MeshEdit& edit,
                             const std::vector<double>& shares_before) {
  const Elements& elements = body.model.elements;
  const bool is_local =
      is_sum_of_tets(body) && body.terms.empty() &&
      std::find(edit.removed.begin(), edit.removed.end(), volume_ratio_tet_) == edit.removed.end();
  known_ = is_known(body) && is_local ? Known::followed : Known::nothing;
  if (known_ == Known::nothing) return;
  frequencies_.extend(elements.topology.vertex_count());
  if (!edit.shares.empty()) return follow_shares(body, edit, shares_before);
  for (Index t : edit.removed) frequencies_.subtract(elements.topology.corners(t), stiffness_of(body, t));
  for (const VertexSplit& split : edit.splits)
    for (Index t : split.tets) {
      const Eigen::Vector4i corners = elements.topology.corners(t);
      const CornerStiffness K = stiffness_of(body, t);
      for (int c = 0; c < 4; ++c) {
        if (corners[c] != split.copy) continue;
        frequencies_.add(split.copy, K.col(c));
        frequencies_.add(split.vertex, -K.col(c));
      }
    }
}

// A blade removes nothing. All tetrahedra with another share or other corners are among those of edit.shares,
// and copies are where their parents are.
template <class Real>
void StepLimit<Real>::follow_shares(const Body& body, const MeshEdit& edit,
                                    const std::vector<double>& shares_before) {
  const Elements& elements = body.model.elements;
  for (std::size_t i = 0; i < edit.shares.size(); ++i) {
    const Index t = edit.shares[i].tet;
    const Eigen::Vector4i corners = elements.topology.corners(t);
    const CornerStiffness K = stiffness_of(body, t);
    frequencies_.subtract(corners, -K);
    if (shares_before[i] == 0) continue;
    Eigen::Vector4i before = corners;
    for (Index& v : before)
      if (!edit.splits.empty() && v >= edit.splits.front().copy)
        v = edit.splits[std::size_t(v - edit.splits.front().copy)].vertex;
    frequencies_.subtract(before, shares_before[i] / edit.shares[i].share * K);
  }
}

template <class Real>
void StepLimit<Real>::update(const Body& body, Index v) {
  ratios_.forget(v);
  if (is_known(body)) frequencies_.update(v, weight(body, v));
}

template class StepLimit<float>;
template class StepLimit<double>;

}  // namespace lobe
