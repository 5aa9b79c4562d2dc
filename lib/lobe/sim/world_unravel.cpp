// Tangles of a World: tetrahedra that stay crushed or inverted though nobody holds them there (theory, section 8).
#include <algorithm>

#include "lobe/fem/volume_term.h"
#include "lobe/sim/world.h"

namespace lobe {
namespace {

template <class Real>
double volume_ratio_of(const Elements& elements, Index tet, const Mat3X<Real>& u) {
  const Mat34<Real> own = u(Eigen::all, elements.topology.corners(tet));
  return volume_ratio<double>(displacement_gradient<double>(
      own.template cast<double>(), elements.shape_of(tet).gradients.template rightCols<3>()));
}

// The alive ones of these tetrahedra, and those that reach them by at most so many common vertices.
std::vector<Index> with_rings(const Topology& topology, const std::vector<Index>& tets, int rings) {
  std::vector<char> is_found(std::size_t(topology.tet_count()), 0);
  std::vector<Index> found;
  const auto add = [&](Index t) {
    if (!is_found[t] && topology.alive(t)) found.push_back(t);
    is_found[t] = 1;
  };
  for (Index t : tets) add(t);
  std::size_t begin = 0;
  for (int ring = 0; ring < rings && begin < found.size(); ++ring)
    for (const std::size_t end = found.size(); begin < end; ++begin)
      for (Index v : topology.corners(found[begin]))
        for (Index t : topology.around(v)) add(t);
  return found;
}

std::string counted(std::size_t count) { return std::to_string(count) + " tetrahedra"; }

}  // namespace

// By a tool, or by prescribed displacements that are not those at rest: whoever does that may crush it on purpose.
template <class Real>
bool World<Real>::is_led() const {
  return std::any_of(held_.all().begin(), held_.all().end(), [](const HeldVertices::Held& item) {
    return item.holder != HeldVertices::boundary || item.start != item.goal;
  });
}

// Non-linear, guarded, of a body that is held: a linear one that is not would grow as it turns.
template <class Real>
std::vector<Index> World<Real>::tangled_tets() const {
  std::vector<Index> tangled;
  if (volume_ratio_ >= elements_.guard_below) return tangled;
  for (Index t = 0; t < elements_.topology.tet_count(); ++t)
    if (elements_.topology.alive(t) && elements_.region_of[t] == RegionModel::nonlinear &&
        body_was_held_[body_of(t)] &&
        volume_ratio_of(elements_, t, state_.u.padded()) < elements_.guard_below)
      tangled.push_back(t);
  return tangled;
}

// The way out of a tangle is by short waves, which selective masses hold back: long ones fold the body meanwhile.
template <class Real>
void World<Real>::lump_masses() {
  const double least = unravelling_.is_lumped ? elements_.guard_below : elements_.guard_below / 2;
  unravelling_.is_lumped = setup_.selective_mass > 1 && volume_ratio_ < least && !is_led();
  use_mass_degree(unravelling_.is_lumped ? 1 : mass_degree_);
}

// At a frame's start, of which the smallest volume ratio is known.
template <class Real>
void World<Real>::unravel() {
  if (implicit_ || elements_.guard_below == 0) return;
  lump_masses();
  if (is_led()) {
    unravelling_.stage = 0;
    unravelling_.since = state_.time;
  }
  const double needed = unravelling_.is_on() ? patience_ / 2 : patience_;
  const bool has_waited = state_.time - unravelling_.since >= needed;
  if (unravelling_.is_on()) {
    if (has_come_back())
      end_unravelling("have come back, and are non-linear again");
    else if (has_waited && unravelling_.stage < Unravelling::stages)
      make_linear_around(tangled_tets());
    else if (has_waited)
      end_unravelling(
          "do not come back as linear ones either, and are non-linear again: smaller loads may help");
    return;
  }
  if (volume_ratio_ >= elements_.guard_below / 2)  // as a strong bend may be
    unravelling_.since = state_.time;
  else if (has_waited && unravelling_.stage < Unravelling::stages)
    make_linear_around(tangled_tets());
}

// All that were made linear and still are, halfway from the threshold of the guard to rest, and no others are tangled.
template <class Real>
bool World<Real>::has_come_back() const {
  const double safe = (1 + elements_.guard_below) / 2;
  return std::all_of(unravelling_.tets.begin(), unravelling_.tets.end(),
                     [&](Index t) {
                       return !elements_.topology.alive(t) ||
                              elements_.region_of[t] != RegionModel::tensor_mass ||
                              volume_ratio_of(elements_, t, state_.u.padded()) > safe;
                     }) &&
         tangled_tets().empty();
}

// And around those that are linear already, of which there are none at the start.
template <class Real>
void World<Real>::make_linear_around(std::vector<Index> tangled) {
  unravelling_.since = state_.time;
  std::vector<Index>& own = unravelling_.tets;
  const std::size_t crushed = tangled.size(), before = own.size();
  tangled.insert(tangled.end(), own.begin(), own.end());
  std::vector<Index> others;
  while (others.empty() && !tangled.empty() && unravelling_.stage < Unravelling::stages) {
    others = with_rings(elements_.topology, tangled, Unravelling::rings[unravelling_.stage++]);
    std::erase_if(others, [&](Index t) { return elements_.region_of[t] != RegionModel::nonlinear; });
  }
  if (others.empty()) return;
  own.insert(own.end(), others.begin(), others.end());
  std::sort(own.begin(), own.end());
  const std::string why = before > 0 ? counted(before) + " that are linear have not come back"
                                     : counted(crushed) + " stay crushed or inverted, the first of them " +
                                           std::to_string(tangled.front());
  pending_.push_back({Condition::Kind::unravelling,
                      why + ": " + counted(others.size()) + " around become linear until they are back",
                      state_.time});
  state();
  change_region(others, RegionModel::tensor_mass);
}

template <class Real>
void World<Real>::end_unravelling(const std::string& how) {
  std::vector<Index> tets;
  tets.swap(unravelling_.tets);
  unravelling_.since = state_.time;
  std::erase_if(tets, [&](Index t) { return elements_.region_of[t] != RegionModel::tensor_mass; });
  pending_.push_back({Condition::Kind::unravelling, counted(tets.size()) + " " + how, state_.time});
  state();
  change_region(tets, RegionModel::nonlinear);
}

template class World<float>;
template class World<double>;

}  // namespace lobe
