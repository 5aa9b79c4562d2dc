// Strokes through a block at rest, for worlds of the same mesh: grains have the same numbers in all of them.
#pragma once

#include <doctest/doctest.h>

#include <random>

#include "knife.h"
#include "lobe/sim/world.h"
#include "rebuilt.h"

namespace lobe::test {

// Random planes through the middle, not all the way.
inline std::vector<Incision> incisions_of(const TetMesh& mesh, int strokes) {
  const Vec3d low = mesh.points.rowwise().minCoeff(), high = mesh.points.rowwise().maxCoeff();
  const Vec3d centre = (low + high) / 2;
  const double size = high.x() - low.x();
  Knife knife(mesh);
  std::vector<Incision> made;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int i = 0; i < strokes; ++i) {
    knife.begin();
    const Vec3d n = Vec3d(normal(random), normal(random), normal(random)).normalized(),
                along = n.unitOrthogonal(), edge = n.cross(along);
    const auto row = [&](double x) {
      return std::vector<Vec3d>{centre + size * (x * along - 2 * edge),
                                centre + size * (x * along + 2 * edge)};
    };
    for (int k = 0; k < 4; ++k) {
      const double from = -1 + 0.3 * k;
      const Incision incision = knife.sweep(row(from), row(from + 0.3)).incision;
      if (!incision.empty()) made.push_back(incision);
    }
  }
  return made;
}

// What is connected in a cut world, against what its grains alone give.
template <class Real>
void check_connections(const World<Real>& world) {
  REQUIRE(world.grains());
  const Topology& topology = world.elements().topology;
  const Rebuilt rebuilt(*world.grains(), topology);
  CHECK(rebuilt.faults == 0);
  CHECK(rebuilt.odd_edges == 0);
  CHECK(rebuilt.joined_alike);
  CHECK(rebuilt.pieces == Index(topology.pieces().size()));
  if (topology.alive_count() < topology.tet_count())
    return;  // what a burnt tetrahedron joined, it still does
  CHECK(rebuilt.same_vertices);
  CHECK(rebuilt.same_tets);
  CHECK(rebuilt.tets == topology.tet_count());
}

template <class Real>
void cut(World<Real>& world, const std::vector<Incision>& incisions) {
  for (const Incision& incision : incisions) incise(world, {incision});
}

template <class Real>
Mat3X<Real> after_run(const Setup& setup, int threads, int frames) {
  World<Real> world(setup, threads);
  for (int i = 0; i < frames; ++i) CHECK(world.advance(1.0 / 30).ok);
  return world.state().u;
}

}  // namespace lobe::test
