#include "lobe/condense/narrow_interface.h"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Index shared_vertices(const TetMesh& mesh, const std::vector<Side>& sides) {
  Index shared = 0;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    bool linear = false, other = false;
    for (Index t = 0; t < mesh.tet_count(); ++t)
      for (Index corner : mesh.tets.col(t))
        if (corner == v) (sides[std::size_t(t)] == Side::linear ? linear : other) = true;
    shared += linear && other;
  }
  return shared;
}

std::vector<Side> ends_of(const TetMesh& mesh, double low, double high) {
  std::vector<Side> sides;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const double x = barycentre(mesh, t).x();
    sides.push_back(x < low ? Side::linear : x > high ? Side::nonlinear : Side::either);
  }
  return sides;
}

}  // namespace

TEST_CASE("a bar with a waist is divided at the waist") {
  TetMesh mesh = box_mesh({0.09, 0.03, 0.03}, 9, 3, 3);
  std::vector<Index> kept;  // of the middle third one edge only
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Vec3d x = barycentre(mesh, t);
    if (std::abs(x.x() - 0.045) > 0.015 || (x.y() < 0.01 && x.z() < 0.01)) kept.push_back(t);
  }
  mesh.tets = Tets(mesh.tets(Eigen::all, kept));
  const std::vector<Side> sides = with_narrow_interface(mesh, ends_of(mesh, 0.02, 0.07));
  CHECK(shared_vertices(mesh, sides) <= 5);  // of a cross-section of one cell, with the vertex in its middle
  for (std::size_t t = 0; t < sides.size(); ++t) CHECK(sides[t] != Side::either);
}

TEST_CASE("no division of a small body shares fewer vertices: all are tried") {
  const TetMesh mesh = irregular_box(2);
  std::mt19937 random(3);
  for (int trial = 0; trial < 5; ++trial) {
    std::vector<Side> sides(std::size_t(mesh.tet_count()), Side::linear);
    std::vector<std::size_t> open;
    for (Side& side : sides) side = random() % 2 ? Side::linear : Side::nonlinear;
    while (open.size() < 10) {
      const std::size_t t = random() % sides.size();
      if (sides[t] == Side::either) continue;
      sides[t] = Side::either;
      open.push_back(t);
    }
    Index fewest = mesh.vertex_count();
    std::vector<Side> tried = sides;
    for (unsigned choice = 0; choice < 1u << open.size(); ++choice) {
      for (std::size_t i = 0; i < open.size(); ++i)
        tried[open[i]] = choice >> i & 1 ? Side::linear : Side::nonlinear;
      fewest = std::min(fewest, shared_vertices(mesh, tried));
    }
    CHECK(shared_vertices(mesh, with_narrow_interface(mesh, sides)) == fewest);
  }
}
