#include "lobe/region/tet_owners.h"

#include <doctest/doctest.h>

#include <map>
#include <numeric>
#include <random>

#include "lobe/sort_unique.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Checks that each tetrahedron is in the chain of one of its domains, once, and oriented as it is. Returns
// how many domains have any.
int check_chains(const Elements& elements, const SmoothedEdges& edges, const TetOwners& owners) {
  std::map<Index, int> found;
  int with_tets = 0;
  for (Index e = 0; e < edges.count(); ++e) {
    if (owners.of(e).empty()) continue;
    ++with_tets;
    REQUIRE(edges[e].volume > 0);
    TetChain chain;
    find_tet_chain(elements.topology, edges[e], owners.of(e), chain);
    const std::size_t vertices = edges[e].vertices.size();
    CHECK(chain.order.size() >= vertices);
    CHECK(chain.order.size() <= vertices + 1);  // a ring that is closed
    CHECK(chain.tets.size() + 3 <= chain.order.size());
    for (std::size_t i = 0; i < chain.tets.size(); ++i) {
      if (chain.tets[i] < 0) continue;
      ++found[chain.tets[i]];
      Mat34<double> at;
      const std::size_t numbers[]{0, 1, 2 + i, 3 + i};
      for (int c = 0; c < 4; ++c) at.col(c) = elements.points.col(edges[e].vertices[chain.order[numbers[c]]]);
      CHECK(signed_volume(at) == near(elements.volume(chain.tets[i]), 1e-12));
    }
  }
  for (Index t = 0; t < elements.topology.tet_count(); ++t) CHECK(found[t] == elements.topology.alive(t));
  return with_tets;
}

}  // namespace

TEST_CASE("each tetrahedron has one of its six domains, and few domains have any, also after cuts") {
  const Setup setup = smoothed(setup_of(irregular_box(6)));
  Elements elements(setup);
  SmoothedEdges edges;
  TetOwners owners;
  std::vector<Index> all(std::size_t(setup.mesh.tet_count()));
  std::iota(all.begin(), all.end(), 0);
  edges.follow(elements, {}, all);
  owners.follow(edges, {}, all);
  CHECK(check_chains(elements, edges, owners) < 0.3 * setup.mesh.tet_count());
  std::mt19937 random(3);
  std::shuffle(all.begin(), all.end(), random);
  for (int cut = 0; cut < 4; ++cut) {  // with tetrahedra that come back, as those of other corners do
    const MeshEdit edit = elements.topology.remove({all.begin() + 40 * cut, all.begin() + 40 * (cut + 1)});
    elements.follow(edit);
    std::vector<Index> entered(all.end() - 30 * (cut + 1), all.end() - 30 * cut), left = edit.removed;
    for (const VertexSplit& split : edit.splits)
      entered.insert(entered.end(), split.tets.begin(), split.tets.end());
    sort_unique(entered);
    left.insert(left.end(), entered.begin(), entered.end());
    edges.follow(elements, left, entered);
    owners.follow(edges, left, entered);
    check_chains(elements, edges, owners);
  }
}

TEST_CASE("fans that hang together by an edge alone are chains with a gap between them") {
  Setup setup = setup_of(irregular_box(1));
  setup.mesh = TetMesh{};
  setup.mesh.points.resize(3, 8);
  setup.mesh.points << 0, 0, 1, 1, 0, -1, -1, 0,  //
      0, 0, 0, 1, 1, 0, -1, -1,                   //
      -1, 1, 0, 0, 0, 0, 0, 0;
  setup.mesh.tets.resize(4, 3);
  setup.mesh.tets << 0, 0, 0, 1, 1, 1, 2, 3, 5, 3, 4, 6;
  setup.mesh.labels.assign(3, 0);
  setup.material_of.assign(3, 0);
  setup.region_of.assign(3, RegionModel::nonlinear);
  prepare(setup.mesh, "fans");
  const Elements elements(smoothed(setup));
  const SmoothedEdges edges(elements);
  TetOwners owners;
  owners.follow(edges, {}, {0, 1, 2});
  CHECK(check_chains(elements, edges, owners) == 1);
  for (Index e = 0; e < edges.count(); ++e) {
    if (owners.of(e).empty()) continue;
    TetChain chain;
    find_tet_chain(elements.topology, edges[e], owners.of(e), chain);
    CHECK(std::count(chain.tets.begin(), chain.tets.end(), -1) == 1);
    CHECK(chain.tets.size() == 4);
  }
}
