#include "lobe/region/patch_layout.h"

#include <doctest/doctest.h>

#include <map>
#include <numeric>
#include <random>
#include <set>

#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

std::vector<Index> all_tets(const Elements& elements) {
  std::vector<Index> tets(std::size_t(elements.topology.tet_count()));
  std::iota(tets.begin(), tets.end(), 0);
  return tets;
}

PatchLayout layout_of(const Elements& elements) {
  PatchLayout layout;
  layout.resize(elements.topology);
  layout.enter(elements, all_tets(elements));
  return layout;
}

Index leave(PatchLayout& layout, const Elements& elements, Index tet) {
  return layout.leave(tet,
                      layout.local_corners(layout.slot_of(tet) / patch_tets, elements.topology.corners(tet)));
}

// Every tetrahedron of the layout has a slot of its own and its patch knows its corners; nobody else has a place.
void check(const PatchLayout& layout, const Elements& elements, Index tet_count) {
  REQUIRE(layout.tet_count() == tet_count);
  Index tets = 0;
  std::map<Index, std::set<Index>> places;  // per vertex
  for (Index p = 0; p < layout.patch_count(); ++p) {
    const PatchLayout::Patch& patch = layout.patch(p);
    CHECK((patch.tets <= patch_tets && patch.vertices <= patch_vertices));
    tets += patch.tets;
    std::set<Index> used;
    for (Index slot = p * patch_tets; slot < p * patch_tets + patch.tets; ++slot) {
      const Index t = layout.tet_of(slot);
      CHECK(layout.slot_of(t) == slot);
      CHECK(elements.material_of[t] == patch.material);
      const Eigen::Vector4i corners = elements.topology.corners(t);
      const auto local = layout.local_corners(p, corners);
      for (int c = 0; c < 4; ++c) {
        REQUIRE(local[c] < patch.vertices);
        CHECK(layout.vertices(p)[local[c]] == corners[c]);
        used.insert(local[c]);
        places[corners[c]].insert(p * patch_vertices + local[c]);
      }
    }
    CHECK(static_cast<Index>(used.size()) == patch.vertices - patch.free);
  }
  CHECK(tets == tet_count);
  for (Index v = 0; v < elements.topology.vertex_count(); ++v) {
    const auto list = layout.places()[v];
    CHECK(std::set<Index>(list.begin(), list.end()) == places[v]);
    CHECK(list.size() == places[v].size());
  }
}

}  // namespace

TEST_CASE("a mesh fills patches of one material nearly to the brim, with few vertices that several know") {
  const Elements elements(hybrid_setup(irregular_box(8)));  // 3072 tetrahedra of two materials
  const PatchLayout layout = layout_of(elements);
  check(layout, elements, 3072);
  CHECK(layout.patch_count() <= 2 * (3072 / 2 / patch_tets + 2));
  Index vertices = 0;
  for (Index p = 0; p < layout.patch_count(); ++p) vertices += layout.patch(p).vertices;
  CHECK(vertices < 5 * elements.topology.vertex_count());
}

TEST_CASE("tetrahedra leave and come back in any order, and the layout stays whole") {
  const Elements elements(hybrid_setup(irregular_box(5)));
  PatchLayout layout = layout_of(elements);
  std::vector<Index> inside = all_tets(elements), outside;
  std::mt19937 random(3);
  for (int round = 0; round < 12; ++round) {
    std::shuffle(inside.begin(), inside.end(), random);
    for (int i = 0; i < 120; ++i) {
      const Index slot = layout.slot_of(inside.back()), last = leave(layout, elements, inside.back());
      CHECK(last / patch_tets == slot / patch_tets);
      CHECK(layout.slot_of(inside.back()) == -1);
      outside.push_back(inside.back());
      inside.pop_back();
    }
    check(layout, elements, static_cast<Index>(inside.size()));
    std::shuffle(outside.begin(), outside.end(), random);
    const std::vector<Index> back(outside.begin() + 60, outside.end());
    layout.enter(elements, back);
    inside.insert(inside.end(), back.begin(), back.end());
    outside.resize(60);
    check(layout, elements, static_cast<Index>(inside.size()));
  }
}

TEST_CASE("patches that were emptied are filled again") {
  const Elements elements(setup_of(irregular_box(5)));
  PatchLayout layout = layout_of(elements);
  const Index patches = layout.patch_count();
  for (int round = 0; round < 3; ++round) {
    for (Index t : all_tets(elements)) leave(layout, elements, t);
    check(layout, elements, 0);
    for (Index t : all_tets(elements)) layout.enter(elements, {t});
    check(layout, elements, elements.topology.tet_count());
    CHECK(layout.patch_count() == patches);
  }
}
