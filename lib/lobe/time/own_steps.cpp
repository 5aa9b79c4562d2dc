#include "lobe/time/own_steps.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <type_traits>
#include <utility>

#include "lobe/numerics/lanczos.h"
#include "lobe/sort_unique.h"
#include "lobe/time/dynamics.h"

namespace lobe {
namespace {

constexpr double softest = 1.0 / 16;  // ω² to that at rest, below which no step is chosen

// ---- At rest

// The levels of vertices, with those of each level as stiff as `ratios` say, for short steps of a share c of
// the longest one.
std::vector<Level> paces_of(const std::vector<double>& squares, double highest, const LevelRatios& ratios,
                            double c) {
  std::vector<Level> paces(squares.size(), 0);
  for (std::size_t v = 0; v < squares.size(); ++v)
    for (Level l = 1; l <= highest_level; ++l) {
      const double times = (1 << l) * ratios[l] * c;
      if (times * times * squares[v] <= highest) paces[v] = l;
    }
  return paces;
}

// The lowest of all vertices within `rings` tetrahedra.
std::vector<Level> lowest_around(const Topology& topology, std::vector<Level> levels, int rings) {
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<Level> next = levels;
    for (Index t = 0; t < topology.tet_count(); ++t) {
      if (!topology.alive(t)) continue;
      Level lowest = highest_level;
      for (Index v : topology.corners(t)) lowest = std::min(lowest, levels[std::size_t(v)]);
      for (Index v : topology.corners(t)) next[std::size_t(v)] = std::min(next[std::size_t(v)], lowest);
    }
    levels = std::move(next);
  }
  return levels;
}

// Lowers levels so that what shares a vertex differs by at most one. An item's vertices are within `rings`
// tetrahedra of each other, and its level is the lowest of theirs.
void grade(const Topology& topology, int rings, std::vector<Level>& levels) {
  for (Level level = 0; level + 1 < highest_level; ++level) {
    std::vector<Level> capped = levels;
    for (Level& one : capped) one = one <= level ? level : highest_level;
    capped = lowest_around(topology, std::move(capped), rings);
    for (std::size_t v = 0; v < levels.size(); ++v)
      if (capped[v] <= level) levels[v] = std::min(levels[v], Level(level + 1));
  }
}

struct RestPaces {
  std::vector<Level> of_vertices;
  double c = 1;     // short steps, as a share of the longest
  double cost = 1;  // per time, of that of one step for all
};

RestPaces cheapest_paces(const Topology& topology, int rings, const std::vector<double>& squares,
                         double highest, const LevelRatios& ratios) {
  RestPaces best{.cost = worth_it};
  for (int k = 0; k <= 8; ++k) {
    const double c = std::exp2(-k / 8.0);
    std::vector<Level> paces = paces_of(squares, highest, ratios, c);
    grade(topology, rings, paces);
    const std::vector<Level> of_items = lowest_around(topology, paces, rings - 1);
    double evaluated = 0;
    for (Index t = 0; t < topology.tet_count(); ++t) {
      Level lowest = highest_level;
      for (Index v : topology.corners(t)) lowest = std::min(lowest, of_items[std::size_t(v)]);
      evaluated += 1.0 / (1 << lowest);
    }
    const double cost = (evaluated / topology.tet_count() + cost_of_step) / (1 + cost_of_step) / c;
    if (cost < best.cost) best = {std::move(paces), c, cost};
  }
  return best;
}

RegionEdit all_tets(const Topology& topology) {
  RegionEdit edit;
  for (Index t = 0; t < topology.tet_count(); ++t)
    if (topology.alive(t)) edit.entered.push_back(t);
  edit.vertices.resize(std::size_t(topology.vertex_count()));
  std::iota(edit.vertices.begin(), edit.vertices.end(), 0);
  return edit;
}

}  // namespace

template <class Real>
void OwnSteps<Real>::lay_out(Dynamics<Real>& body, const std::vector<double>& squares, double small) {
  constexpr int most_rounds = 12;
  const Elements& elements = body.model.elements;
  const double highest = *std::max_element(squares.begin(), squares.end());
  const bool any_smoothed = std::any_of(elements.materials.begin(), elements.materials.end(),
                                        [](const Elastic& elastic) { return elastic.is_smoothed(); });
  rest_square_ = highest;
  for (int round = 0; highest > 0 && round <= most_rounds; ++round) {
    const RestPaces paces = round < most_rounds ? cheapest_paces(elements.topology, any_smoothed ? 2 : 1,
                                                                 squares, highest, ratios_)
                                                : RestPaces{};
    if (paces.of_vertices.empty() && round == 0) break;
    body.regions.lay_out(elements, all_tets(elements.topology), {paces.of_vertices});
    structure_ = ~std::uint64_t(0);
    if (paces.of_vertices.empty()) break;
    rest_square_ = highest / (paces.c * paces.c);
    follow(body);
    std::vector<Level> levels;
    for (const PatchGraph::Patch& patch : graph_.patches) levels.push_back(patch.pace);
    use(body, levels);
    bool all_stable = true;
    for (Level l = 1; l <= top_; ++l) {
      const double times = (1 << l) * paces.c * highest_of_level(body, l, squares, small);
      if (times * times <= highest) continue;
      all_stable = false;
      ratios_[l] *= std::max(1.05, times / std::sqrt(highest));
    }
    forget();
    if (all_stable) break;
  }
  follow(body);
}

// ω of the patches of a level alone, with the masses of all [rad/s].
template <class Real>
double OwnSteps<Real>::highest_of_level(Dynamics<Real>& body, Level level, const std::vector<double>& squares,
                                        double small) const {
  std::vector<double> inverse_mass(squares.size(), 0);
  for (std::size_t v = 0; v < squares.size(); ++v)
    for (Index p : patches_of_[v])
      if (levels_[std::size_t(p)] == level) inverse_mass[v] = body.inertia.inverse_mass(Index(v));
  if (*std::max_element(inverse_mass.begin(), inverse_mass.end()) == 0) return 0;
  const auto square = [&](Index v) { return inverse_mass[std::size_t(v)] > 0 ? squares[std::size_t(v)] : 0; };
  body.regions.visit_patches([&](const auto&, auto& sums) { sums.levels().take(level, level, false); });
  const HighestFrequency found = highest_frequency<Real>(
      inverse_mass, square, small,
      [&](const Mat3X<Real>& u, Mat3X<Real>& f) { body.regions.add_forces_near_rest(u, f, body.parallel); });
  body.regions.visit_patches([](const auto&, auto& sums) { sums.levels().take_all(); });
  return found.omega;
}

// ---- The patches of a body

template <class Real>
void OwnSteps<Real>::follow(Dynamics<Real>& body) {
  if (structure_ == body.model.revisions.structure) return;
  structure_ = body.model.revisions.structure;
  graph_ = {};
  patches_of_.assign(std::size_t(body.model.elements.topology.vertex_count()), {});
  body.regions.visit_patches([&]<class Layout>(const Layout& layout, const auto&) {
    for (Index p = 0; p < layout.patch_count(); ++p) {
      const Index patch = static_cast<Index>(graph_.patches.size());
      const auto& of_layout = layout.patch(p);
      graph_.patches.push_back(
          {double(of_layout.items), of_layout.pace, std::is_same_v<Layout, PatchLayout<2>>});
      if (of_layout.items == 0) continue;
      for (Index v : layout.vertices_of(p)) {
        std::vector<Index>& of_vertex = patches_of_[std::size_t(v)];
        const auto has_place = [&] {
          for (Index place : layout.places()[v])
            if (place / patch_vertices == p) return true;
          return false;
        };
        if ((of_vertex.empty() || of_vertex.back() != patch) && has_place()) of_vertex.push_back(patch);
      }
    }
  });
  graph_.neighbours.assign(graph_.patches.size(), {});
  for (const std::vector<Index>& patches : patches_of_)
    for (Index p : patches)
      for (Index q : patches)
        if (p != q) graph_.neighbours[std::size_t(p)].push_back(q);
  for (std::vector<Index>& neighbours : graph_.neighbours) sort_unique(neighbours);
  forget();
  limits_.squares.assign(graph_.patches.size(), 0);
}

// The vertex of the highest bound of each patch comes first. Of the others only those are computed whose
// bound is above what their patches have by then.
template <class Real>
void OwnSteps<Real>::see_frequencies(Dynamics<Real>& body, const std::function<double(Index)>& bound,
                                     const std::function<double(Index)>& square) {
  follow(body);
  std::vector<double>& squares = limits_.squares;
  if (!any() && wait_ > 0) return squares.clear();
  squares.resize(graph_.patches.size());
  for (std::size_t p = 0; p < squares.size(); ++p)
    squares[p] = softest * rest_square_ / (1 << 2 * graph_.patches[p].pace);
  std::vector<double> bounds(patches_of_.size()), highest(squares.size(), 0);
  std::vector<Index> first(squares.size(), -1);
  for (std::size_t v = 0; v < patches_of_.size(); ++v) {
    if (patches_of_[v].empty()) continue;
    bounds[v] = bound(Index(v));
    for (Index p : patches_of_[v])
      if (bounds[v] > highest[std::size_t(p)]) {
        highest[std::size_t(p)] = bounds[v];
        first[std::size_t(p)] = Index(v);
      }
  }
  const auto see = [&](Index v) {
    const auto is_lower = [&](Index p) { return squares[std::size_t(p)] < bounds[std::size_t(v)]; };
    const std::vector<Index>& patches = patches_of_[std::size_t(v)];
    if (std::none_of(patches.begin(), patches.end(), is_lower)) return;
    const double of_vertex = square(v);
    for (Index p : patches) squares[std::size_t(p)] = std::max(squares[std::size_t(p)], of_vertex);
  };
  for (Index v : first)
    if (v >= 0) see(v);
  for (std::size_t v = 0; v < patches_of_.size(); ++v) see(Index(v));
}

// ---- A frame

// Patches at what force terms act on, and at what is held in some directions only.
template <class Real>
std::vector<std::uint8_t> OwnSteps<Real>::fast_patches(const Dynamics<Real>& body) const {
  std::vector<std::uint8_t> is_fast(graph_.patches.size(), 0);
  const auto mark = [&](Index v) {
    for (Index p : patches_of_[std::size_t(v)]) is_fast[std::size_t(p)] = 1;
  };
  for (Index v : body.acted_on_by_terms()) mark(v);
  for (const HeldVertices::Held& item : body.model.held.all())
    if (!body.model.held.fixes(item.vertex)) mark(item.vertex);
  for (const HeldVertices::Held& item : body.model.held.partly()) mark(item.vertex);
  return is_fast;
}

// How many steps of the last length take this time [s]; 0: no whole number.
template <class Real>
int OwnSteps<Real>::steps_in(double duration) const {
  if (!(step_length_ > 1e-6 * duration)) return 0;
  const double steps = std::round(duration / step_length_);
  return std::abs(steps * step_length_ - duration) < 1e-6 * duration ? static_cast<int>(steps) : 0;
}

// A choice takes as long as some steps, so a pace that is kept is looked at again after some frames.
template <class Real>
OwnPace OwnSteps<Real>::pace_of_frame(const Dynamics<Real>& body, int fewest) {
  const bool waits = wait_ > 0;
  if (waits) --wait_;
  if (!any() && (waits || limits_.squares.empty())) return {.steps = fewest};
  limits_.is_fast = fast_patches(body);
  const PresentPace present{levels_, steps_in(fewest * limits_.longest)};
  if (waits)
    if (const auto kept = keep_pace(graph_, limits_, fewest, present)) return *kept;
  wait_ = frames_to_stay;
  return choose_pace(graph_, limits_, fewest, present);
}

template <class Real>
int OwnSteps<Real>::begin_frame(Dynamics<Real>& body, int fewest, double longest, double safety) {
  limits_.ratios = ratios_;
  limits_.longest = longest;
  limits_.safety = safety;
  OwnPace chosen{.steps = fewest};
  if (structure_ == body.model.revisions.structure) chosen = pace_of_frame(body, fewest);
  if (chosen.levels != levels_) {
    const int wait = wait_;
    end(body);
    if (!chosen.levels.empty()) use(body, chosen.levels);
    wait_ = wait;
  }
  share_ = chosen.share;
  step_length_ = fewest * longest / chosen.steps;
  return chosen.steps;
}

template <class Real>
void OwnSteps<Real>::end(Dynamics<Real>& body) {
  if (any()) body.synchronise_velocities();
  forget();
}

template <class Real>
void OwnSteps<Real>::end_after_trouble(Dynamics<Real>& body) {
  step_ = 0;
  end(body);
  share_ = 1;
  wait_ = frames_together;
}

template <class Real>
bool OwnSteps<Real>::are_stable(double dt) const {
  return !any() || lobe::are_stable(graph_, limits_, levels_, dt, 1);
}

template <class Real>
LevelRatios OwnSteps<Real>::shares_of_levels() const {
  LevelRatios shares{};
  double all = 0;
  for (const PatchGraph::Patch& patch : graph_.patches) all += patch.cost;
  for (std::size_t p = 0; p < graph_.patches.size() && all > 0; ++p)
    shares[any() ? levels_[p] : 0] += graph_.patches[p].cost / all;
  return shares;
}

template <class Real>
void OwnSteps<Real>::use(Dynamics<Real>& body, const std::vector<Level>& levels) {
  levels_ = levels;
  top_ = *std::max_element(levels.begin(), levels.end());
  step_ = 0;
  of_vertices_.assign(patches_of_.size(), 0);
  for (std::size_t v = 0; v < patches_of_.size(); ++v) {
    if (patches_of_[v].empty()) continue;
    of_vertices_[v] = top_;
    for (Index p : patches_of_[v]) of_vertices_[v] = std::min(of_vertices_[v], levels[std::size_t(p)]);
  }
  vertices_.clear();
  for (Level l = 0; l <= highest_level; ++l) {
    for (std::size_t v = 0; v < of_vertices_.size(); ++v)
      if (of_vertices_[v] == l) vertices_.push_back(Index(v));
    ends_[std::size_t(l) + 1] = vertices_.size();
  }
  std::span<const Level> rest = levels_;
  body.regions.visit_patches([&](const auto& layout, auto& sums) {
    sums.levels().set(layout, rest.first(std::size_t(layout.patch_count())), of_vertices_);
    rest = rest.subspan(std::size_t(layout.patch_count()));
  });
  moving_found_at_ = {};
}

template <class Real>
bool OwnSteps<Real>::fits(Dynamics<Real>& body, const State& state) {
  follow(body);
  return state.squares.empty() || state.squares.size() == graph_.patches.size();
}

template <class Real>
void OwnSteps<Real>::set_state(Dynamics<Real>& body, const State& state) {
  follow(body);
  limits_.squares = state.squares;
  step_length_ = state.step;
  forget();
  if (!state.levels.empty()) use(body, state.levels);
  wait_ = state.wait;
}

// ---- A step

template <class Real>
int OwnSteps<Real>::highest_now() const {
  return step_ == 0 ? int(top_) : std::min(int(top_), std::countr_zero(unsigned(step_)));
}

template <class Real>
void OwnSteps<Real>::begin_forces(Dynamics<Real>& body, bool all) {
  const int highest = all ? int(top_) : highest_now();
  const std::span<const Index> vertices(vertices_.data(), ends_[std::size_t(highest) + 1]);
  const double share = body.loads.missing_share(body.motion.time);
  for (Index v : vertices) body.motion.forces.col(v) = body.loads.external().col(v);
  if (share > 0)
    for (Index v : vertices) body.motion.forces.col(v) -= Real(share) * body.loads.dead().col(v);
  body.regions.visit_patches([&](const auto&, auto& sums) { sums.levels().take(0, highest, true); });
}

template <class Real>
void OwnSteps<Real>::end_forces(Dynamics<Real>& body) {
  body.regions.visit_patches([](const auto&, auto& sums) { sums.levels().take_all(); });
}

template <class Real>
void OwnSteps<Real>::find_moving(Dynamics<Real>& body) {
  body.find_moving();
  const Revisions& now = body.model.revisions;
  const std::tuple found_at(now.inertia, now.replaced, body.sleep.revision(), true);
  if (moving_found_at_ == found_at) return;
  moving_found_at_ = found_at;
  for (auto& moving : moving_) moving.clear();
  for (const MovingVertex<Real>& one : body.inertia.moving())
    moving_[of_vertices_[std::size_t(one.vertex)]].push_back(one);
}

template <class Real>
Fastest<Real> OwnSteps<Real>::push(Dynamics<Real>& body, double kick, double dt) {
  find_moving(body);
  Motion<Real>& motion = body.motion;
  const int highest = dt > 0 ? highest_now() : int(top_);
  Fastest<Real> fastest;
  for (int l = 0; l <= highest; ++l) {
    const Real times = Real(1 << l);
    const Fastest<Real> of_level = central_difference(
        motion.forces.padded(), moving_[std::size_t(l)], times * Real(kick), times * Real(dt),
        Real(body.damping), motion.u.padded(), motion.v.padded(), motion.reversals, body.parallel);
    fastest.all = std::max(fastest.all, times * times * of_level.all);
    fastest.reversing = std::max(fastest.reversing, times * times * of_level.reversing);
  }
  if (dt > 0) step_ = (step_ + 1) % (1 << top_);
  return fastest;
}

template class OwnSteps<float>;
template class OwnSteps<double>;

}  // namespace lobe
