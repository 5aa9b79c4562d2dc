// What a world shows to others: its surface, and pictures for other threads.
#include <doctest/doctest.h>

#include <atomic>
#include <thread>

#include "lobe/sim/checkpoint.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Setup cut_block() {
  Setup setup = hybrid_setup(irregular_box(5));
  setup.gravity = {0, 0, -9.81};
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.cauteries.push_back({"tip", 0.008, {{0, {-0.01, 0.025, 0.05}}, {0.4, {0.06, 0.025, 0.04}}}});
  return setup;
}

double volume_of(const Elements& elements, const Mat3X<double>& u) {
  double sum = 0;
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    if (!elements.topology.alive(t)) continue;
    const Mat34<double> x = elements.corner_points(t) + u(Eigen::all, elements.topology.corners(t));
    sum += signed_volume(x);
  }
  return sum;
}

}  // namespace

TEST_CASE("the surface of a world encloses its volume, through cuts, changes of regions and back in time") {
  World<double> world(cut_block());
  world.surface();
  const Checkpoint<double> start = world.save();
  const auto check = [&] {
    const SurfaceMesh& surface = world.surface().mesh();
    Mat3X<double> x;
    const Mat3X<double> u = world.state().u;
    update_positions<double>(surface, world.elements().points.view(), u, x);
    CHECK(enclosed_volume(surface, x) == near(volume_of(world.elements(), u), 1e-10));
    for (std::size_t i = 0; i < surface.triangles.size(); ++i)
      CHECK(surface.region[i] == world.elements().region_of[std::size_t(surface.owner[i].tet)]);
  };
  for (int i = 0; i < 20; ++i) {
    world.advance(0.02);
    if (i == 10) world.apply(SetRegion{{1, 5, 9, 13, 17, 21}, RegionModel::nonlinear});
    if (i % 5 == 0) check();
  }
  check();
  const std::uint64_t revision = world.surface().revision();
  world.restore(start);
  CHECK(world.surface().revision() > revision);
  check();
}

TEST_CASE("a picture is the state that was published, and stays so when the world is cut, restored or gone") {
  auto world = std::make_unique<World<float>>(cut_block());
  const auto& snapshots = world->snapshots();
  CHECK_FALSE(snapshots.latest());
  const Checkpoint<float> start = world->save();
  world->publish(world->advance(0.02));
  const auto picture = snapshots.latest();
  REQUIRE(picture);
  const Mat3X<float> u = world->state().u, x = picture->surface.x;
  CHECK(picture->u == u);
  CHECK(picture->time == world->time());
  CHECK(picture->frame == 1);
  CHECK(picture->tools.size() == 1);
  const auto triangles = picture->surface.mesh->triangles;
  for (int i = 0; i < 10; ++i) world->publish(world->advance(0.02));
  world->restore(start);
  world->publish(Report{});
  CHECK(snapshots.latest()->time == 0);
  world.reset();
  CHECK(picture->u == u);
  CHECK(picture->surface.x == x);
  CHECK(picture->surface.mesh->triangles == triangles);
}

TEST_CASE("readers in other threads always see whole states while the world moves and is cut") {
  World<double> world(cut_block());
  world.publish(Report{});
  std::atomic<bool> is_running = true;
  std::atomic<int> torn = 0, seen = 0;
  const auto read = [&] {
    std::int64_t frame = -1;
    while (is_running) {
      const auto picture = world.snapshots().latest();
      const SurfaceMesh& surface = *picture->surface.mesh;
      const bool is_whole = picture->frame >= frame && picture->u.cols() == picture->v.cols() &&
                            picture->surface.x.cols() == surface.vertex_count() &&
                            picture->surface.normals.cols() == surface.vertex_count();
      Vec3d sum = Vec3d::Zero();  // of area vectors: a closed surface
      for (const Eigen::Vector3i& t : surface.triangles) {
        const Mat3X<double>& x = picture->surface.x;
        sum += Vec3d(x.col(t[1]) - x.col(t[0])).cross(Vec3d(x.col(t[2]) - x.col(t[0])));
      }
      torn += !is_whole || !(sum.norm() < 1e-12);
      ++seen;
      frame = picture->frame;
    }
  };
  std::thread first(read), second(read);
  for (int i = 0; i < 60; ++i) world.publish(world.advance(0.01));
  is_running = false;
  first.join();
  second.join();
  CHECK(seen > 0);
  CHECK(torn == 0);
}
