// A skin on tetrahedra that blades have cut.
#include <algorithm>
#include <limits>

#include "lobe/cut/distance.h"
#include "lobe/skin/skin.h"
#include "lobe/sort_unique.h"

namespace lobe {

// Vertices and triangles go over to the copies whose grains are under them.
void Skin::follow_grains(const Topology& topology, std::vector<Index>& cut, const Grains& grains) {
  sort_unique(cut);
  std::vector<Index> triangles, vertices;
  for (Index tet : cut) {
    if (!copies_of_.contains(tet)) continue;
    triangles.insert(triangles.end(), lying_on_[tet].begin(), lying_on_[tet].end());
    vertices.insert(vertices.end(), carried_by_[tet].begin(), carried_by_[tet].end());
  }
  sort_unique(triangles);
  for (Index triangle : triangles) find_elements_under(triangle, grains);
  sort_unique(vertices);
  for (Index vertex : vertices)
    if (const Index own = nearest_element({&carrier_[vertex], 1}, points_.col(vertex), &grains); own >= 0)
      carry(vertex, own, topology);
}

std::span<const Index> Skin::elements_under(Index triangle) const {
  const auto at = elements_under_.find(triangle);
  return at == elements_under_.end() ? lies_on_[triangle] : std::span<const Index>(at->second);
}

// Of points spread over it, a little inside.
void Skin::find_elements_under(Index triangle, const Grains& grains) {
  constexpr int n = 3;
  const Mat3<double> corners = points_(Eigen::all, corners_of_.col(triangle));
  const Vec3d middle = corners.rowwise().mean();
  std::vector<Index> elements;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      const Vec3d p = corners * Vec3d(i, j, n - i - j) / n;
      const Index own = nearest_element(lies_on_[triangle], middle + 0.98 * (p - middle), &grains);
      if (own >= 0) elements.push_back(own);
    }
  sort_unique(elements);
  if (!elements.empty()) elements_under_[triangle] = std::move(elements);
}

// Of these tetrahedra of the start, or of their copies, by the grains that are there.
Index Skin::nearest_element(std::span<const Index> tets, const Vec3d& p, const Grains* grains) const {
  if (!grains || copies_of_.empty()) return nearest_of(tets, start_, p);
  double nearest = std::numeric_limits<double>::infinity();
  Index found = -1;
  const auto look = [&](Index element) {
    for (Index grain : grains->of(element)) {
      Mat34<double> X;
      for (int k = 0; k < 4; ++k) X.col(k) = grains->point((*grains)[grain].points[k]);
      const double distance = distance_to_tet(p, X);
      if (!(distance < nearest)) continue;
      nearest = distance;
      found = element;
    }
  };
  for (Index tet : tets) {
    look(tet);
    if (const auto at = copies_of_.find(tet); at != copies_of_.end())
      for (Index copy : at->second) look(copy);
  }
  return found;
}

}  // namespace lobe
