#include "lobe/region/patch_layout.h"

#include <doctest/doctest.h>

#include <map>
#include <random>
#include <set>

#include "lobe/assert.h"
#include "lobe/fem/elements.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

using Layout = PatchLayout<4>;
using Items = std::vector<Layout::Item>;

Layout::Corners corners_of(const Elements& elements, Index t) {
  const Eigen::Vector4i v = elements.topology.corners(t);
  return {v[0], v[1], v[2], v[3]};
}

Items all_tets(const Elements& elements) {
  Items items;
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    items.push_back({t, corners_of(elements, t), elements.material_of[t]});
  return items;
}

Layout layout_of(const Elements& elements) {
  Layout layout;
  layout.resize(elements.topology.vertex_count(), elements.topology.tet_count());
  layout.enter(all_tets(elements), elements.points.padded());
  return layout;
}

Index leave(Layout& layout, const Layout::Item& item) {
  return layout.leave(item.id,
                      layout.local_corners(layout.slot_of(item.id) / Layout::capacity, item.corners));
}

// Every tetrahedron of the layout has a slot of its own and its patch knows its corners; nobody else has a
// place.
void check(const Layout& layout, const Elements& elements, Index tet_count) {
  REQUIRE(layout.item_count() == tet_count);
  Index tets = 0;
  std::map<Index, std::set<Index>> places;  // per vertex
  for (Index p = 0; p < layout.patch_count(); ++p) {
    const Layout::Patch& patch = layout.patch(p);
    CHECK((patch.items <= Layout::capacity && patch.vertices <= patch_vertices));
    tets += patch.items;
    std::set<Index> used;
    for (Index slot = p * Layout::capacity; slot < p * Layout::capacity + patch.items; ++slot) {
      const Index t = layout.id_of(slot);
      CHECK(layout.slot_of(t) == slot);
      CHECK(elements.material_of[t] == patch.kind);
      const Layout::Corners corners = corners_of(elements, t);
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
  const Layout layout = layout_of(elements);
  check(layout, elements, 3072);
  CHECK(layout.patch_count() <= 2 * (3072 / 2 / Layout::capacity + 2));
  Index vertices = 0;
  for (Index p = 0; p < layout.patch_count(); ++p) vertices += layout.patch(p).vertices;
  CHECK(vertices < 5 * elements.topology.vertex_count());
}

TEST_CASE("tetrahedra leave and come back in any order, and the layout stays whole") {
  const Elements elements(hybrid_setup(irregular_box(5)));
  Layout layout = layout_of(elements);
  Items inside = all_tets(elements), outside;
  std::mt19937 random(3);
  for (int round = 0; round < 12; ++round) {
    std::shuffle(inside.begin(), inside.end(), random);
    for (int i = 0; i < 120; ++i) {
      const Index slot = layout.slot_of(inside.back().id), last = leave(layout, inside.back());
      CHECK(last / Layout::capacity == slot / Layout::capacity);
      CHECK(layout.slot_of(inside.back().id) == -1);
      outside.push_back(inside.back());
      inside.pop_back();
    }
    check(layout, elements, static_cast<Index>(inside.size()));
    std::shuffle(outside.begin(), outside.end(), random);
    const Items back(outside.begin() + 60, outside.end());
    layout.enter(back, elements.points.padded());
    inside.insert(inside.end(), back.begin(), back.end());
    outside.resize(60);
    check(layout, elements, static_cast<Index>(inside.size()));
  }
}

TEST_CASE("what gets other corners keeps its slot as long as its patch has numbers for them") {
  const Elements elements(setup_of(irregular_box(5)));
  Layout layout = layout_of(elements);
  const Index vertices = elements.topology.vertex_count(), tets = elements.topology.tet_count();
  layout.resize(vertices + 4 * tets, tets);
  const auto corners_in = [&](Index slot) {
    return layout.local_corners(slot / Layout::capacity, corners_of(elements, layout.id_of(slot)));
  };
  std::vector<Index> slots;
  for (Index t = 0; t < tets; ++t) slots.push_back(layout.slot_of(t));

  Items around_one;
  const Index v = elements.topology.corners(tets / 2)[0];
  for (Index t : elements.topology.around(v)) {
    Layout::Corners corners = corners_of(elements, t);
    std::replace(corners.begin(), corners.end(), v, vertices);
    around_one.push_back({t, corners, elements.material_of[t]});
  }
  const auto places = layout.places()[v].size();
  Layout split = layout;
  CHECK(split.keep(around_one, corners_in).empty());
  CHECK(split.places()[v].empty());
  CHECK(split.places()[vertices].size() == places);

  Items apart = all_tets(elements);  // each with corners that no other has
  for (Layout::Item& item : apart)
    for (std::size_t c = 0; c < 4; ++c) item.corners[c] = vertices + 4 * item.id + static_cast<Index>(c);
  const Items others = layout.keep(apart, corners_in);
  CHECK((others.size() > apart.size() / 2 && others.size() < apart.size()));
  for (const Layout::Item& item : others) CHECK(layout.must_leave(item.id));
  for (Index t = 0; t < tets; ++t) {
    CHECK(layout.slot_of(t) == slots[std::size_t(t)]);
    const Index p = slots[std::size_t(t)] / Layout::capacity;
    CHECK(layout.patch(p).vertices <= patch_vertices);
    const Layout::Corners corners =
        layout.must_leave(t) ? corners_of(elements, t) : apart[std::size_t(t)].corners;
    const auto local = layout.local_corners(p, corners);
    for (std::size_t c = 0; c < 4; ++c) CHECK(layout.vertices(p)[local[c]] == corners[c]);
  }
}

TEST_CASE("patches that were emptied are filled again") {
  const Elements elements(setup_of(irregular_box(5)));
  Layout layout = layout_of(elements);
  const Index patches = layout.patch_count();
  for (int round = 0; round < 3; ++round) {
    for (const Layout::Item& item : all_tets(elements)) leave(layout, item);
    check(layout, elements, 0);
    for (const Layout::Item& item : all_tets(elements)) layout.enter({item}, elements.points.padded());
    check(layout, elements, elements.topology.tet_count());
    CHECK(layout.patch_count() == patches);
  }
}

TEST_CASE("an item is in one patch at most, and leaves only if it is there") {
  const Elements elements(setup_of(irregular_box(3)));
  const Items tets = all_tets(elements);
  Layout layout = layout_of(elements);
  CHECK_THROWS_AS(layout.enter({tets[5]}, elements.points.padded()), BrokenInvariant);
  layout = layout_of(elements);
  const auto local = layout.local_corners(layout.slot_of(5) / Layout::capacity, tets[5].corners);
  layout.leave(5, local);
  CHECK_THROWS_AS(layout.leave(5, local), BrokenInvariant);
  Layout::Corners elsewhere = tets[6].corners;
  layout.resize(elements.topology.vertex_count() + 1, elements.topology.tet_count());
  elsewhere[0] = elements.topology.vertex_count();  // no patch has it
  CHECK_THROWS_AS(layout.local_corners(0, elsewhere), BrokenInvariant);
}
