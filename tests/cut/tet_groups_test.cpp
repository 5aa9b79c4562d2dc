#include "lobe/cut/tet_groups.h"

#include <doctest/doctest.h>

#include <limits>

#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A body that creeps, swings, and is thrown about (which inverts it), while sweeps of all kinds pass: from
// outside, from inside, past it.
template <class Real>
Index compare_with_scan(TetMesh mesh, int rounds) {
  Topology topology(mesh);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> within(-0.03, 0.09), radius(0.001, 0.01);
  const auto point = [&] { return Vec3d(within(random), within(random), within(random)); };
  Mat3X<Real> u = Mat3X<Real>::Zero(3, mesh.vertex_count());
  TetGroups groups;
  Index found = 0;
  for (int round = 0; round < rounds; ++round) {
    const double step = round % 40 == 39 ? 0.03 : round % 7 == 6 ? 0.003 : 1e-5;
    const Mat3X<Real> before = u;
    u += random_displacement<Real>(mesh.vertex_count(), step, unsigned(round));
    u.row(0).array() += Real(step);
    groups.moved(double((u - before).colwise().norm().maxCoeff()), std::numeric_limits<Real>::epsilon());
    const Vec3d tip = point();
    const Sweep sweep{tip, round % 3 == 0 ? tip : Vec3d(tip + 0.1 * point()), radius(random)};
    const Mat3X<double> x = mesh.points + u.template cast<double>();
    const std::vector<Index> touched = groups.meeting(topology, mesh.points, u, swept_volume(sweep));
    REQUIRE(touched == touched_tets(topology, x, sweep));
    found += Index(touched.size());
    if (round % 5 == 0 && topology.alive_count() > mesh.tet_count() / 2) {
      const Index vertices = topology.vertex_count();
      const MeshEdit edit = topology.remove(touched);
      mesh.points.conservativeResize(3, topology.vertex_count());
      u.conservativeResize(3, topology.vertex_count());
      for (const VertexSplit& split : edit.splits) {
        mesh.points.col(split.copy) = mesh.points.col(split.vertex);
        u.col(split.copy) = u.col(split.vertex);
      }
      CHECK(topology.vertex_count() >= vertices);
    }
  }
  return found;
}

}  // namespace

TEST_CASE_TEMPLATE("groups of tetrahedra find what a scan of all finds, however the body moves", Real, float,
                   double) {
  CHECK(compare_with_scan<Real>(irregular_box(12, 0.005), 400) > 1000);
}

TEST_CASE("groups of a body that moved unsaid find nothing, until they are told to forget where it was") {
  const TetMesh mesh = irregular_box(8, 0.005);
  const Topology topology(mesh);
  const Sweep sweep{{0.02, 0.07, 0.02}, {0.03, 0.07, 0.02}, 0.004};
  TetGroups groups;
  Mat3X<double> u = Mat3X<double>::Zero(3, mesh.vertex_count());
  CHECK(groups.meeting(topology, mesh.points, u, swept_volume(sweep)).empty());
  u.row(1).array() += 0.05;
  CHECK(groups.meeting(topology, mesh.points, u, swept_volume(sweep)).empty());
  groups.forget();
  const std::vector<Index> touched = groups.meeting(topology, mesh.points, u, swept_volume(sweep));
  CHECK(!touched.empty());
  CHECK(touched == touched_tets(topology, mesh.points + u, sweep));
}

TEST_CASE("a copy of a tetrahedron is found from when it is added, and wherever it moves") {
  TetMesh mesh = irregular_box(8, 0.005);
  Topology topology(mesh);
  TetGroups groups;
  Mat3X<double> u = Mat3X<double>::Zero(3, mesh.vertex_count());
  const Index tet = mesh.tet_count() / 2, vertices = mesh.vertex_count();
  const Eigen::Vector4i corners = topology.corners(tet);
  const Vec3d middle = mesh.points(Eigen::all, corners).rowwise().mean(), way{0.09, 0, 0};
  const auto find_at = [&](const Vec3d& place) {
    const Sweep sweep{place, place, 0.003};
    const std::vector<Index> touched = groups.meeting(topology, mesh.points, u, swept_volume(sweep));
    CHECK(touched == touched_tets(topology, mesh.points + u, sweep));
    return touched;
  };
  find_at(middle);
  const auto copy = [&](Index of, const std::vector<Index>& split, const Eigen::Vector4i& corners_of_copy) {
    TetDivision division;
    division.may_part = false;
    division.vertices = split;
    division.parts = {{of, of, topology.corners(of), 0.3}, {topology.tet_count(), of, corners_of_copy, 0.3}};
    const MeshEdit edit = topology.divide(division);
    mesh.points.conservativeResize(3, topology.vertex_count());
    u.conservativeResize(3, topology.vertex_count());
    for (const VertexSplit& vertex : edit.splits) {
      mesh.points.col(vertex.copy) = mesh.points.col(vertex.vertex);
      u.col(vertex.copy).setZero();
    }
    groups.add_copy(edit.copies.front().tet, edit.copies.front().copy);
  };
  const Eigen::Vector4i of_copy(vertices, vertices + 1, vertices + 2, vertices + 3);
  copy(tet, {corners[0], corners[1], corners[2], corners[3]}, of_copy);
  copy(mesh.tet_count(), {}, of_copy);
  CHECK(find_at(middle).back() == mesh.tet_count() + 1);
  CHECK(find_at(middle + way).empty());
  u.rightCols(4).colwise() += way;
  groups.moved(way.norm(), 1e-16);
  CHECK(find_at(middle).back() < mesh.tet_count());
  CHECK(find_at(middle + way) == std::vector<Index>{mesh.tet_count(), mesh.tet_count() + 1});
}
