// A skin on tetrahedra that blades have cut: the grains under its vertices, and the gaps of its edges.
#include <algorithm>
#include <limits>

#include "lobe/cut/distance.h"
#include "lobe/skin/skin.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

// The distance to the grains of a tetrahedron of the simulation.
double distance_to(const Grains& grains, Index element, const Vec3d& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (Index grain : grains.of(element)) {
    Mat34<double> X;
    for (int k = 0; k < 4; ++k) X.col(k) = grains.point(grains[grain].points[k]);
    nearest = std::min(nearest, distance_to_tet(p, X));
  }
  return nearest;
}

// A gap lies between a tetrahedron that exists and one that is gone, or between two that have come apart.
bool is_gap(const Topology& topology, Index before, Index after) {
  if (before < 0 || after < 0) return before != after;
  return before != after && touch(topology, before, after) == Touch::apart;
}

}  // namespace

std::span<const Index> Skin::copies_of(Index tet) const {
  const auto at = state_.copies_of.find(tet);
  return at == state_.copies_of.end() ? std::span<const Index>() : std::span<const Index>(at->second);
}

template <class Visit>
void Skin::for_elements(Index tet, Visit&& visit) const {
  visit(tet);
  for (Index copy : copies_of(tet)) visit(copy);
}

bool Skin::has_lost_a_copy(const Topology& topology, Index tet) const {
  bool found = false;
  for_elements(tet, [&](Index element) { found = found || !topology.alive(element); });
  return found;
}

bool Skin::has_lost_a_tet(const CutBody& body, Index triangle) const {
  const std::span<const Index> tets = rest_.lies_on[triangle];
  return std::any_of(tets.begin(), tets.end(), [&](Index tet) {
    bool any = false;
    for_elements(tet, [&](Index element) { any = any || body.topology.alive(element); });
    return !any;
  });
}

// Moves vertices on tetrahedra that were cut to the copies whose grains are under them.
void Skin::follow_grains(const CutBody& body, const std::vector<Index>& cut) {
  std::vector<Index> vertices;
  for (Index tet : cut)
    if (state_.copies_of.contains(tet))
      vertices.insert(vertices.end(), state_.carried_by[tet].begin(), state_.carried_by[tet].end());
  for (Index vertex : vertices) {
    Index found = -1;
    double nearest = std::numeric_limits<double>::infinity();
    for_elements(state_.carrier[vertex], [&](Index element) {
      const double distance = distance_to(body.grains, element, rest_.points.col(vertex));
      if (!(distance < nearest)) return;
      nearest = distance;
      found = element;
    });
    if (found >= 0) carry(vertex, found, body.topology);
  }
}

Index Skin::under(const CutBody& body, Index vertex) const {
  return has_lost_a_copy(body.topology, state_.carrier[vertex]) ? -1 : state_.element[vertex];
}

// Returns the nearest of these tetrahedra of the start and their copies; `before`, if it is as near as any
// other.
Index Skin::under(const CutBody& body, std::span<const Index> tets, const Vec3d& p, Index before) const {
  const double rounding = 1e-6 * body.grains.mean_edge();
  double nearest = std::numeric_limits<double>::infinity(), of_before = nearest;
  Index found = -1;
  const auto look = [&](Index element, double distance) {
    if (element == before) of_before = std::min(of_before, distance);
    if (!(distance < nearest)) return;
    nearest = distance;
    found = element;
  };
  for (Index tet : tets) {
    if (has_lost_a_copy(body.topology, tet))
      look(-1, distance_to_tet(p, tet_points(rest_.start, tet)));
    else if (!state_.copies_of.contains(tet))
      look(tet, distance_to_tet(p, tet_points(rest_.start, tet)));
    else
      for_elements(tet, [&](Index element) { look(element, distance_to(body.grains, element, p)); });
  }
  return of_before <= nearest + rounding ? before : found;
}

// ---- Gaps

std::vector<Index> Skin::triangles_at(const Edge& edge) const {
  std::vector<Index> found;
  for (Index triangle : rest_.around[edge.first])
    if ((rest_.corners.col(triangle).array() == edge.second).any()) found.push_back(triangle);
  return found;
}

// Whether any two of the tetrahedra that may lie under an edge have come apart.
bool Skin::may_have_gaps(const CutBody& body, const Edge& edge, const std::vector<Index>& tets) const {
  std::vector<Index> elements{state_.element[edge.first], state_.element[edge.second]};
  for (Index tet : tets) {
    if (has_lost_a_copy(body.topology, tet)) return true;
    for_elements(tet, [&](Index element) { elements.push_back(element); });
  }
  if (has_lost_a_copy(body.topology, state_.carrier[edge.first]) ||
      has_lost_a_copy(body.topology, state_.carrier[edge.second]))
    return true;
  for (std::size_t i = 0; i < elements.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (is_gap(body.topology, elements[i], elements[k])) return true;
  return false;
}

// Samples an edge in a few places, and finds the gap between two of them that differ.
std::vector<SkinState::Gap> Skin::gaps_of(const CutBody& body, const Edge& edge) const {
  constexpr double per_mean_edge = 6;
  std::vector<Index> tets;
  for (Index triangle : triangles_at(edge))
    tets.insert(tets.end(), rest_.lies_on[triangle].begin(), rest_.lies_on[triangle].end());
  sort_unique(tets);
  std::vector<Gap> gaps;
  if (!may_have_gaps(body, edge, tets)) return gaps;
  const Vec3d a = rest_.points.col(edge.first), b = rest_.points.col(edge.second);
  const int count =
      std::clamp(static_cast<int>(per_mean_edge * (b - a).norm() / body.grains.mean_edge()), 2, 24);
  Owner last{under(body, edge.first), 0};
  for (int i = 1; i <= count; ++i) {
    const double share = double(i) / count;
    const Owner own{
        i == count ? under(body, edge.second) : under(body, tets, a + share * (b - a), last.element), share};
    find_gaps(body, edge, tets, last, own, gaps);
    last = own;
  }
  return gaps;
}

void Skin::find_gaps(const CutBody& body, const Edge& edge, const std::vector<Index>& tets, const Owner& from,
                     const Owner& to, std::vector<Gap>& gaps) const {
  constexpr double near_enough = 1e-4, least = 1e-3;
  if (from.element == to.element) return;
  const bool both_there = from.element >= 0 && to.element >= 0;
  if (both_there && touch(body.topology, from.element, to.element) == Touch::together) return;
  const double share = (from.share + to.share) / 2;
  if (to.share - from.share < near_enough) {
    if (is_gap(body.topology, from.element, to.element))
      gaps.push_back({std::clamp(share, least, 1 - least), from.element, to.element});
    return;
  }
  const Vec3d a = rest_.points.col(edge.first), b = rest_.points.col(edge.second);
  const Owner middle{under(body, tets, a + share * (b - a), from.element), share};
  find_gaps(body, edge, tets, from, middle, gaps);
  find_gaps(body, edge, tets, middle, to, gaps);
}

// Removes triangles that have lost a tetrahedron. Then it finds the gaps of the edges of these triangles and
// of those around these vertices, and divides the triangles at them.
void Skin::open(const CutBody& body, std::vector<Index>& triangles, const std::vector<Index>& vertices) {
  const auto is_there = [&](Index triangle) {
    return state_.slot_of[triangle] >= 0 || state_.divided.contains(triangle);
  };
  sort_unique(triangles);
  for (Index triangle : triangles)
    if (is_there(triangle) && has_lost_a_tet(body, triangle)) take_apart(triangle);
  for (Index vertex : vertices) {
    triangles.insert(triangles.end(), rest_.around[vertex].begin(), rest_.around[vertex].end());
    if (body.topology.alive(state_.element[vertex])) continue;
    const Index element = under(body, candidates(vertex), rest_.points.col(vertex), -1);
    if (element >= 0) carry(vertex, element, body.topology);
  }
  sort_unique(triangles);
  std::vector<Edge> edges;
  for (Index triangle : triangles)
    for (int k = 0; k < 3; ++k)
      edges.push_back(
          std::minmax(Index(rest_.corners(k, triangle)), Index(rest_.corners((k + 1) % 3, triangle))));
  sort_unique(edges);
  for (const Edge& edge : edges) {
    std::vector<Gap> now = gaps_of(body, edge);
    const auto at = state_.gaps.find(edge);
    if (at == state_.gaps.end() && now.empty()) continue;
    const std::vector<Index> beside = triangles_at(edge);
    if (at != state_.gaps.end() && now == at->second) {
      for (Index triangle : beside) update_cut_vertices(body.topology, triangle);
      continue;
    }
    triangles.insert(triangles.end(), beside.begin(), beside.end());
    if (now.empty())
      state_.gaps.erase(at);
    else
      state_.gaps[edge] = std::move(now);
  }
  sort_unique(triangles);
  for (Index triangle : triangles)
    if (is_there(triangle)) divide(body, triangle);
}

}  // namespace lobe
