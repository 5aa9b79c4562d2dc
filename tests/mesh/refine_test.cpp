#include "lobe/mesh/refine.h"

#include <doctest/doctest.h>

#include "lobe/error.h"
#include "lobe/mesh/generators.h"
#include "lobe/mesh/quality.h"
#include "lobe/mesh/topology.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Mat34<double> unit_corner() {
  Mat34<double> X = Mat34<double>::Zero();
  X.rightCols<3>().setIdentity();
  return X;
}

}  // namespace

TEST_CASE(
    "one tetrahedron becomes eight of an eighth of its volume, with a vertex in the middle of each edge") {
  TetMesh mesh{unit_corner(), Eigen::Vector4i(0, 1, 2, 3), {7}};
  RefinedMesh fine = refine(mesh);
  CHECK(fine.mesh.vertex_count() == 10);
  CHECK(fine.mesh.tet_count() == 8);
  CHECK(fine.mesh.labels == std::vector<int>(8, 7));
  CHECK(fine.parent_of == std::vector<Index>(8, 0));
  for (Index t = 0; t < 8; ++t) CHECK(signed_volume(tet_points(fine.mesh, t)) == near(1.0 / 48, 1e-12));
  CHECK(prepare(fine.mesh, "refined").warnings().empty());
}

TEST_CASE("the octahedron is cut along its shortest diagonal, whichever that is") {
  for (int axis = 0; axis < 3; ++axis) {  // the opposite edges of the stretched axis have the closest middles
    Mat34<double> X;
    X << 1, -1, 1, -1, 1, -1, -1, 1, 1, 1, -1, -1;  // regular, around the origin
    X.row(axis) *= 0.5;
    if (signed_volume(X) < 0) X.col(2).swap(X.col(3));
    const RefinedMesh fine = refine({X, Eigen::Vector4i(0, 1, 2, 3), {0}});
    double longest = 0;
    for (Index t = 4; t < 8; ++t) {
      const Mat34<double> x = tet_points(fine.mesh, t);
      CHECK(signed_volume(x) == near(signed_volume(X) / 8, 1e-12));
      longest = std::max(longest, (x.col(0) - x.col(1)).norm());
    }
    CHECK(longest == near(1, 1e-12));  // the two other diagonals have the length 2
  }
}

TEST_CASE("a refined mesh is conforming, of the same volume and surface, with labels and parents in order") {
  TetMesh box = irregular_box(3), cylinder = cylinder_mesh(0.03, 0.1, 3, 4);
  for (TetMesh& mesh : std::array{box, cylinder}) {
    for (Index t = 0; t < mesh.tet_count(); ++t) mesh.labels[std::size_t(t)] = t % 5;
    RefinedMesh fine = refine(mesh);
    CHECK(fine.mesh.tet_count() == 8 * mesh.tet_count());
    CHECK(total_volume(fine.mesh) == near(total_volume(mesh), 1e-13));  // rounding of thousands of terms
    for (Index t = 0; t < fine.mesh.tet_count(); ++t) {
      const Index parent = fine.parent_of[std::size_t(t)];
      CHECK(parent == t / 8);
      CHECK(fine.mesh.labels[std::size_t(t)] == parent % 5);
      CHECK(signed_volume(tet_points(fine.mesh, t)) ==
            near(signed_volume(tet_points(mesh, parent)) / 8, 1e-9));
    }
    CHECK(prepare(fine.mesh, "refined").warnings().empty());  // no face of three tetrahedra, none inside out
    // With each boundary face in four and no other boundary, every other face has two tetrahedra.
    CHECK(Topology(fine.mesh).boundary_faces().size() == 4 * Topology(mesh).boundary_faces().size());
  }
}

TEST_CASE("a mesh without labels gets the label 0; one with too few is refused") {
  TetMesh mesh = box_mesh({1, 1, 1}, 1, 1, 1);
  mesh.labels.clear();
  CHECK(refine(mesh).mesh.labels == std::vector<int>(48, 0));
  mesh.labels = {1, 2};
  CHECK_THROWS_AS(refine(mesh), InputError);
}

TEST_CASE("prolongation leaves a P1 field as it is") {
  const TetMesh mesh = irregular_box(2);
  const RefinedMesh fine = refine(mesh);
  CHECK(fine.prolongate(mesh.points) == fine.mesh.points);
  Mat3<double> F;
  F << 1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.2, 0.1, 1.1;
  const Mat3X<double> expected = affine_displacement(fine.mesh.points, F);
  CHECK((fine.prolongate(affine_displacement(mesh.points, F)) - expected).norm() < 1e-15);
}

TEST_CASE("each tetrahedron inherits the values of the one that it was cut from") {
  const TetMesh mesh = irregular_box(2);
  Eigen::MatrixXd values(2, mesh.tet_count());
  for (Index t = 0; t < mesh.tet_count(); ++t) values.col(t) << t, 0.5 * t;
  const Eigen::MatrixXd fine = refine(mesh).inherit(values);
  REQUIRE(fine.cols() == 8 * mesh.tet_count());
  for (Index t = 0; t < fine.cols(); ++t) CHECK(fine.col(t) == Eigen::Vector2d(t / 8, 0.5 * (t / 8)));
}

TEST_CASE("angles do not degenerate under repeated refinement") {
  TetMesh mesh = irregular_box(2);
  double previous = 0;
  for (int level = 0; level < 4; ++level) {
    mesh = refine(mesh).mesh;
    const double angle = mesh_quality(mesh).min_dihedral;
    CAPTURE(level);
    if (level > 1) CHECK(angle == near(previous, 1e-6));
    previous = angle;
  }
  CHECK(previous > 0.5 * mesh_quality(irregular_box(2)).min_dihedral);
}
