#include "lobe/diagnostics/locate.h"

#include <doctest/doctest.h>

#include "lobe/cut/distance.h"
#include "lobe/error.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("the tree finds what a search of all tetrahedra finds, inside and outside, with any guess") {
  for (const TetMesh& mesh : std::array{irregular_box(4), cylinder_mesh(0.02, 0.04, 4, 3)}) {
    const Locator where(mesh);
    const Box box = bounding_box(mesh);
    const Vec3d middle = (box.min + box.max) / 2, size = box.max - box.min;
    const Mat3X<double> random = random_displacement(500, 1.0);
    Index guess = -1;
    for (Eigen::Index i = 0; i < random.cols(); ++i) {
      const Vec3d p = middle + size.cwiseProduct(random.col(i));
      double expected = 1e300;
      for (Index t = 0; t < mesh.tet_count(); ++t)
        expected = std::min(expected, distance_to_tet(p, tet_points(mesh, t)));
      const Locator::Found found = where.nearest(p), guessed = where.nearest(p, guess);
      CHECK(found.distance == expected);
      CHECK(guessed.distance == expected);
      CHECK(distance_to_tet(p, tet_points(mesh, found.tet)) == expected);
      guess = found.tet;
    }
  }
}

TEST_CASE("each barycentre lies in its own tetrahedron; barycentric coordinates give the point back") {
  const TetMesh mesh = irregular_box(5);
  const Locator where(mesh);
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Locator::Found found = where.nearest(barycentre(mesh, t));
    CHECK(found.tet == t);
    CHECK(found.distance == 0);
    CHECK((barycentric(mesh, t, barycentre(mesh, t)) - Eigen::Vector4d::Constant(0.25)).norm() < 1e-12);
    const Vec3d outside(1, 2, 3);
    CHECK((tet_points(mesh, t) * barycentric(mesh, t, outside) - outside).norm() < 1e-9);
  }
}

TEST_CASE("there is nothing to find in an empty mesh") {
  CHECK_THROWS_AS(Locator(TetMesh{Mat3X<double>::Zero(3, 4), Tets(4, 0), {}}), InputError);
}
