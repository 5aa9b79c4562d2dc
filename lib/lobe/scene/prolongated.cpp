#include "lobe/scene/prolongated.h"

#include "lobe/io/grouped_mesh.h"
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

void prolongate(Selector& selector, bool of_tets, const TetMesh& old, const RefinedMesh& refined) {
  if (auto* parts = parts_of(selector)) {
    for (Selector& part : *parts) prolongate(part, of_tets, old, refined);
    return;
  }
  if (auto* surface = std::get_if<SelectSurface>(&selector.value)) {
    surface->triangles = refined_triangles(surface->triangles, old, refined);
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
  for_each_selector(scene, [&](Selector& selector, Selects what, auto&&...) {
    prolongate(selector, what == Selects::tets, old, refined);
  });
  return scene;
}

}  // namespace lobe
