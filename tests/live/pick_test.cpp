#include "lobe/live/pick.h"

#include <doctest/doctest.h>

#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A box of 0.3 m, 0.2 m, 0.1 m whose corner is at the origin.
struct BoxBody {
  TetMesh mesh = box_mesh({0.3, 0.2, 0.1}, 3, 2, 2);
  Topology topology{mesh};
  std::vector<RegionModel> regions =
      std::vector<RegionModel>(std::size_t(mesh.tet_count()), RegionModel::nonlinear);
  Surface surface{topology, regions};
  Mat3X<double> x;

  BoxBody() { update_positions<double>(surface.mesh(), mesh.points, 0 * mesh.points, x); }
  std::optional<RayHit> cast(const Vec3d& origin, const Vec3d& direction) const {
    return cast_ray(surface.mesh(), x, origin, direction);
  }
};

}  // namespace

TEST_CASE("a ray meets the nearest face that it enters, wherever it starts outside") {
  const BoxBody box;
  const auto top = box.cast({0.11, 0.13, 1}, {0, 0, -4});
  REQUIRE(top);
  CHECK((top->point - Vec3d(0.11, 0.13, 0.1)).norm() < 1e-15);
  const Vec3d aim(0, 0.07, 0.03), eye(-2, 1, 0.5);  // on the face x = 0
  const auto slanted = box.cast(eye, aim - eye);
  REQUIRE(slanted);
  CHECK((slanted->point - aim).norm() < 1e-14);
}

TEST_CASE("a ray that passes the body, looks away or comes from within meets nothing") {
  const BoxBody box;
  CHECK_FALSE(box.cast({0.1, 0.1, 1}, {0, 0, 1}));
  CHECK_FALSE(box.cast({0.31, 0.1, 1}, {0, 0, -1}));
  CHECK_FALSE(box.cast({0.1, 0.1, 0.05}, {0, 0, -1}));
}

TEST_CASE("on a body that has moved a ray meets it where it is now") {
  BoxBody box;
  Mat3X<double> u = 0 * box.mesh.points;
  u.row(2).setConstant(0.5);
  update_positions<double>(box.surface.mesh(), box.mesh.points, u, box.x);
  const auto hit = box.cast({0.1, 0.1, 1}, {0, 0, -1});
  REQUIRE(hit);
  CHECK(hit->point.z() == near(0.6, 1e-12));
}

TEST_CASE("a point lies in a body where that is now, and not where it was or where it has been removed") {
  BoxBody box;
  Mat3X<double> u = 0 * box.mesh.points;
  u.row(2).setConstant(0.5);
  const auto has = [&](const Vec3d& point) {
    return lies_in<double>(box.topology, box.mesh.points, u, point);
  };
  CHECK(has({0.11, 0.13, 0.57}));
  CHECK_FALSE(has({0.11, 0.13, 0.61}));
  CHECK_FALSE(has({0.11, 0.13, 0.07}));
  CHECK_FALSE(has({0.31, 0.13, 0.57}));
  std::vector<Index> left;
  for (Index t = 0; t < box.mesh.tet_count(); ++t)
    if (barycentre(box.mesh, t).x() < 0.2) left.push_back(t);
  box.topology.remove(left);
  CHECK_FALSE(has({0.11, 0.13, 0.57}));
  CHECK(has({0.25, 0.13, 0.57}));
}
