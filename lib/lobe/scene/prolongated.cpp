#include "lobe/scene/prolongated.h"

#include <algorithm>

#include "lobe/scene/each_selector.h"
#include "lobe/scene/select.h"

namespace lobe {
namespace {

SelectVertices prolongated_vertices(std::vector<Index> vertices, const TetMesh& old,
                                    const RefinedMesh& refined) {
  std::vector<char> chosen(std::size_t(old.vertex_count()), 0);
  for (Index v : vertices) chosen[std::size_t(v)] = 1;
  for (std::size_t i = 0; i < refined.ends.size(); ++i)
    if (chosen[std::size_t(refined.ends[i][0])] && chosen[std::size_t(refined.ends[i][1])])
      vertices.push_back(old.vertex_count() + Index(i));
  return {std::move(vertices)};
}

SelectTetrahedra children_of(const std::vector<Index>& tets) {
  SelectTetrahedra children;
  for (Index t : tets)
    for (Index child = 0; child < 8; ++child) children.tetrahedra.push_back(8 * t + child);
  return children;
}

// Four for each triangle of the mesh. Others select nothing on the old mesh either.
std::vector<std::array<Index, 3>> parts_of_triangles(const std::vector<std::array<Index, 3>>& triangles,
                                                     const TetMesh& old, const RefinedMesh& refined) {
  const auto middle = [&](Index a, Index b) {
    const auto [low, high] = std::minmax(a, b);
    const std::array<Index, 2> edge{low, high};
    const auto at = std::lower_bound(refined.ends.begin(), refined.ends.end(), edge);
    return at != refined.ends.end() && *at == edge ? old.vertex_count() + Index(at - refined.ends.begin())
                                                   : -1;
  };
  std::vector<std::array<Index, 3>> parts;
  for (const auto& [a, b, c] : triangles) {
    const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    if (ab < 0 || bc < 0 || ca < 0) continue;
    for (const std::array<Index, 3>& part :
         {std::array{a, ab, ca}, std::array{ab, b, bc}, std::array{ca, bc, c}, std::array{ab, bc, ca}})
      parts.push_back(part);
  }
  return parts;
}

void prolongate(Selector& selector, bool of_tets, const TetMesh& old, const RefinedMesh& refined) {
  if (auto* parts = parts_of(selector)) {
    for (Selector& part : *parts) prolongate(part, of_tets, old, refined);
    return;
  }
  if (auto* surface = std::get_if<SelectSurface>(&selector.value)) {
    surface->triangles = parts_of_triangles(surface->triangles, old, refined);
    return;
  }
  if (!by_number(selector)) return;
  if (of_tets || std::holds_alternative<SelectTetrahedra>(selector.value))
    selector.value = children_of(select_tets(selector, old));
  else
    selector.value = prolongated_vertices(select_vertices(selector, old), old, refined);
}

}  // namespace

Scene prolongated(Scene scene, const TetMesh& old, const RefinedMesh& refined) {
  for_each_selector(scene,
                    [&](Selector& selector, bool of_tets) { prolongate(selector, of_tets, old, refined); });
  return scene;
}

}  // namespace lobe
