#include "lobe/lattice/lattice.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "lattice_support.h"
#include "lobe/error.h"

using namespace lobe;
using namespace lobe::test;

namespace {

TetMesh joined(const TetMesh& a, const TetMesh& b) {  // beside each other, without a common vertex
  TetMesh both = a;
  const Index before = a.vertex_count();
  both.points.conservativeResize(3, before + b.vertex_count());
  both.points.rightCols(b.vertex_count()) = b.points;
  both.tets.conservativeResize(4, a.tet_count() + b.tet_count());
  both.tets.rightCols(b.tet_count()) = b.tets.array() + before;
  both.labels.insert(both.labels.end(), b.labels.begin(), b.labels.end());
  return both;
}

std::string fault_of(const Setup& setup) {
  try {
    choose_lattice(Elements(setup), setup.lattice_cell);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("the eight samples of a tetrahedron have its volume and its barycentre") {
  const auto& w = sample_weights();
  CHECK((w.colwise().sum().array() - 1).abs().maxCoeff() < 1e-15);
  CHECK((w.rowwise().mean().array() - 0.25).abs().maxCoeff() < 1e-15);
  CHECK(w.minCoeff() == 0.125);
}

TEST_CASE("weights of a lattice reproduce linear fields at every vertex") {
  const EmbeddedBox box;
  CHECK(box.lattice.node_count() > 64);
  CHECK(box.lattice.node_count() < box.setup.mesh.vertex_count());
  const Mat3X<double> X = interpolated(box, box.lattice.nodes);
  CHECK((X - box.setup.mesh.points).cwiseAbs().maxCoeff() < 1e-15);
}

TEST_CASE("a node is the corner of a cell that has tissue, and every corner of such a cell is one node") {
  const EmbeddedBox box;
  std::set<Index> used;
  std::set<std::array<int, 3>> corners;
  for (const Lattice::Part& part : box.lattice.parts) used.insert(part.nodes.begin(), part.nodes.end());
  for (const Eigen::Vector3i& c : box.lattice.corner_of_node) corners.insert({c[0], c[1], c[2]});
  CHECK(used.size() == std::size_t(box.lattice.node_count()));
  CHECK(corners.size() == used.size());  // nothing is cut: no corner has two nodes
}

TEST_CASE("two sides of a slit have nodes of their own, in whichever cells it lies") {
  TetMesh left = box_mesh({0.04, 0.04, 0.04}, 4, 4, 4), right = left;
  right.points.row(0).array() += 0.0401;
  const EmbeddedBox both(reduced_setup(joined(left, right), 0.02), 0);
  Setup one = reduced_setup(left, 0.02);
  const auto nodes_of = [&](const TetMesh& mesh, RegionModel other, bool first) {
    Setup setup = reduced_setup(mesh, 0.02);
    for (Index t = 0; t < mesh.tet_count(); ++t)
      if ((t < left.tet_count()) != first) setup.region_of[std::size_t(t)] = other;
    const Elements elements(setup);
    return make_lattice(elements, both.lattice.frame).node_count();
  };
  const TetMesh mesh = joined(left, right);
  CHECK(both.lattice.node_count() ==
        nodes_of(mesh, RegionModel::nonlinear, true) + nodes_of(mesh, RegionModel::nonlinear, false));
  std::set<std::array<int, 3>> corners;
  for (const Eigen::Vector3i& c : both.lattice.corner_of_node) corners.insert({c[0], c[1], c[2]});
  CHECK(corners.size() < std::size_t(both.lattice.node_count()));  // some lie in cells of both
}

TEST_CASE("two materials in a cell are two parts with the same nodes") {
  Setup setup = reduced_setup(box_mesh({0.04, 0.04, 0.04}, 4, 4, 4), 0.02);
  setup.materials.push_back({7e4, 2e4, 1100});
  for (std::size_t t = 0; t < setup.material_of.size(); ++t) setup.material_of[t] = t % 2 == 0;
  const Elements elements(setup);
  const Lattice lattice = make_lattice(elements, choose_lattice(elements, setup.lattice_cell));
  CHECK(lattice.parts.size() == 16);
  CHECK(lattice.node_count() == 27);
  for (std::size_t i = 0; i < 16; i += 2) {
    CHECK(lattice.parts[i].material != lattice.parts[i + 1].material);
    CHECK(lattice.parts[i].nodes == lattice.parts[i + 1].nodes);
  }
}

TEST_CASE("cells are chosen by the size of the body, and at least as large as its tetrahedra") {
  const Elements fine(reduced_setup(box_mesh({0.4, 0.1, 0.1}, 80, 20, 20), 0));
  CHECK(choose_lattice(fine, 0).edge == near(std::sqrt(0.18) / 20, 1e-12));
  const Elements coarse(reduced_setup(box_mesh({0.4, 0.1, 0.1}, 8, 2, 2), 0));
  CHECK(choose_lattice(coarse, 0).edge > 1.5 * 0.05);
  const LatticeFrame frame = choose_lattice(fine, 0.03);
  CHECK(frame.edge == 0.03);
  const Vec3d cells = (Vec3d(0.2, 0.05, 0.05) - frame.origin) / 0.03;  // in the middle of the lattice
  CHECK(((2 * cells).array() - (2 * cells).array().round()).abs().maxCoeff() < 1e-9);
}

TEST_CASE("a lattice that is finer than the tetrahedra, or coarser than the body, is refused") {
  const TetMesh mesh = box_mesh({0.08, 0.08, 0.08}, 8, 8, 8);
  CHECK(fault_of(reduced_setup(mesh, 0.02)) == "");
  CHECK(fault_of(reduced_setup(mesh, 0.01)).find("cell: 0.01 m is hardly larger than the tetrahedra") == 0);
  CHECK(fault_of(reduced_setup(mesh, 0.05)).find("cell: 0.05 m is more than half of the reduced regions") ==
        0);
}
