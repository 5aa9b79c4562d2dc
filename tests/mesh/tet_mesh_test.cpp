#include "lobe/mesh/tet_mesh.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

using namespace lobe;

namespace {

TetMesh one_tet() {
  TetMesh mesh;
  mesh.points.resize(3, 4);
  mesh.points << 0, 2, 0, 0, /**/ 0, 0, 3, 0, /**/ 0, 0, 0, 4;
  mesh.tets.resize(4, 1);
  mesh.tets << 0, 1, 2, 3;
  return mesh;
}

}  // namespace

TEST_CASE("volume and barycentre of a right-angled tetrahedron") {
  const TetMesh mesh = one_tet();
  CHECK(signed_volume(tet_points(mesh, 0)) == 4);
  CHECK(total_volume(mesh) == 4);
  CHECK(barycentre(mesh, 0).isApprox(Vec3d(0.5, 0.75, 1)));
}

TEST_CASE("an inside-out tetrahedron has a negative volume") {
  TetMesh mesh = one_tet();
  std::swap(mesh.tets(1), mesh.tets(2));
  CHECK(signed_volume(tet_points(mesh, 0)) == -4);
}

TEST_CASE("the faces of a tetrahedron look outwards") {
  const TetMesh mesh = one_tet();
  for (int k = 0; k < 4; ++k) {
    const auto& [a, b, c] = face_corners[k];
    const Vec3d p = mesh.points.col(a), q = mesh.points.col(b), r = mesh.points.col(c);
    CHECK((q - p).cross(r - p).dot(mesh.points.col(k) - p) < 0);
  }
}
