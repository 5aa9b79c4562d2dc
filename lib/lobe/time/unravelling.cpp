#include "lobe/time/unravelling.h"

#include <algorithm>
#include <cmath>

#include "lobe/fem/volume_term.h"

namespace lobe {
namespace {

// Returns the alive ones of these tetrahedra, with so many rings of neighbours by common vertices.
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

template <class Real>
double volume_ratio_of(const Elements& elements, Index tet, const Mat3X<Real>& u) {
  const Mat34<Real> at_corners = u(Eigen::all, elements.topology.corners(tet));
  return volume_ratio<double>(displacement_gradient<double>(
      at_corners.template cast<double>(), elements.shape_of(tet).gradients.template rightCols<3>()));
}

bool is_driven(const HeldVertices& held) {
  return std::any_of(held.all().begin(), held.all().end(), [](const HeldVertices::Held& item) {
    return item.holder != HeldVertices::boundary || item.start != item.goal;
  });
}

Unravelling::Unravelling(const Elements& elements, double diagonal) {
  double slowest = std::numeric_limits<double>::infinity();  // [m²/s²]
  for (const Elastic& e : elements.materials)
    slowest = std::min(slowest, (e.mu + std::min(0.0, e.fibre.shear)) / e.density);
  patience_ = 16 * diagonal / std::sqrt(slowest);
}

void Unravelling::leave_alone(const std::vector<Index>& tets) {
  std::erase_if(state_.tets, [&](Index t) { return std::binary_search(tets.begin(), tets.end(), t); });
}

template <class Real>
void Unravelling::lump(const Dynamics<Real>& body, double volume_ratio) {
  const double guard = body.model.elements.guard_below, least = state_.is_lumped ? guard : guard / 2;
  state_.is_lumped = body.inertia.may_be_selective() && volume_ratio < least && !is_driven(body.model.held);
}

// Whether all tetrahedra that were made linear, and still are, are at least halfway between the guard's
// threshold and rest.
template <class Real>
bool Unravelling::have_come_back(const Dynamics<Real>& body) const {
  const Elements& elements = body.model.elements;
  const double safe = (1 + elements.guard_below) / 2;
  return std::all_of(state_.tets.begin(), state_.tets.end(), [&](Index t) {
    return !elements.is_in(unravelling_model, t) ||
           volume_ratio_of(elements, t, body.motion.u.padded()) > safe;
  });
}

// Makes tetrahedra linear around the tangle and around those that are linear already (none at the start).
std::optional<Unravelling::Remedy> Unravelling::make_linear_around(const Elements& elements, double time,
                                                                   std::vector<Index> tangled) {
  state_.since = time;
  std::vector<Index>& tets = state_.tets;
  const std::size_t crushed = tangled.size(), before = tets.size();
  tangled.insert(tangled.end(), tets.begin(), tets.end());
  std::vector<Index> others;
  while (others.empty() && !tangled.empty() && state_.stage < stages) {
    others = with_rings(elements.topology, tangled, rings[state_.stage++]);
    std::erase_if(others, [&](Index t) { return elements.region_of[t] != tangling_model; });
  }
  if (others.empty()) return {};
  tets.insert(tets.end(), others.begin(), others.end());
  std::sort(tets.begin(), tets.end());
  const std::string why = before > 0 ? counted(before) + " that are linear have not come back"
                                     : counted(crushed) + " stay crushed or inverted, the first of them " +
                                           std::to_string(tangled.front());
  const std::string count = counted(others.size());
  return Remedy{unravelling_model, std::move(others),
                why + ": " + count + " around become linear until they are back"};
}

Unravelling::Remedy Unravelling::end(const Elements& elements, double time, const std::string& how) {
  std::vector<Index> tets;
  tets.swap(state_.tets);
  state_.since = time;
  std::erase_if(tets, [&](Index t) { return elements.region_of[t] != unravelling_model; });
  const std::string count = counted(tets.size());
  return {tangling_model, std::move(tets), count + " " + how};
}

template double volume_ratio_of(const Elements&, Index, const Mat3X<float>&);
template double volume_ratio_of(const Elements&, Index, const Mat3X<double>&);
template void Unravelling::lump(const Dynamics<float>&, double);
template void Unravelling::lump(const Dynamics<double>&, double);
template bool Unravelling::have_come_back(const Dynamics<float>&) const;
template bool Unravelling::have_come_back(const Dynamics<double>&) const;

}  // namespace lobe
