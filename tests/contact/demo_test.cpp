// The scenes of data/scenes that show contact: a tumour that is felt, a lobe that is picked up.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "lobe/diagnostics/body_figures.h"
#include "lobe/diagnostics/body_overlap.h"
#include "lobe/scene/frames.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/scene_mesh.h"
#include "lobe/sim/world.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

struct Shipped {
  Scene scene;
  Setup setup;
  explicit Shipped(const std::string& name)
      : scene(read_scene(std::filesystem::path(LOBE_DATA_DIR) / "scenes" / (name + ".json"))),
        setup(resolve(scene, read_scene_mesh(scene).mesh).setup) {}

  // after_frame(world), each frame.
  template <class AfterFrame>
  void play(AfterFrame&& after_frame) const {
    World<float> world(setup);
    const Frames frames = frames_of(scene.time);
    for (int i = 0; i < frames.count; ++i) {
      REQUIRE(world.advance(frames.length).ok);
      after_frame(world);
    }
  }
};

// The largest force on the probe from 0 to 0.8 s, from then to 1.8 s, and after that [N].
Vec3d forces_of_presses(const Shipped& palpation) {
  Vec3d most = Vec3d::Zero();
  palpation.play([&](World<float>& world) {
    double& of_press = most[world.time() < 0.8 ? 0 : world.time() < 1.8 ? 1 : 2];
    of_press = std::max(of_press, world.tools().lists().probes.front().force.norm());
  });
  return most;
}

// The part of the body that lies left of the cut, which falls.
struct FallenPiece {
  double mass = 0;    // [kg]
  double height = 0;  // of its centre [m]
};

FallenPiece fallen_piece(World<float>& world) {
  FallenPiece piece;
  const Elements& elements = world.elements();
  const auto u = world.displacements();
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    if (!elements.topology.alive(t)) continue;
    const Eigen::Vector4i corners = elements.topology.corners(t);
    const Mat34<double> X = elements.points.view()(Eigen::all, corners);
    if (X.row(0).mean() < 0.012) continue;
    const double own = 1000 * std::abs((X.rightCols<3>().colwise() - X.col(0)).determinant()) / 6;
    piece.mass += own;
    for (int c = 0; c < 4; ++c) piece.height += own * (X(2, c) + double(u(2, corners[c]))) / 4;
  }
  piece.height /= piece.mass;
  return piece;
}

struct PickedUp {
  double rise = 0;            // of the piece's middle since the jaws closed [m]
  double lift = 0, grip = 0;  // means while the jaws rise steadily [N]
  double weight = 0;          // of the piece [N]
};

PickedUp pick_up(const Shipped& shipped) {
  PickedUp result;
  double before = 0;
  int frames = 0;
  shipped.play([&](World<float>& world) {
    const FallenPiece piece = fallen_piece(world);
    if (world.time() < 1.7) before = piece.height;
    result.rise = piece.height - before;
    result.weight = 9.81 * piece.mass;
    if (world.time() < 2.1 || world.time() > 2.29) return;
    const Probe& jaws = world.tools().lists().probes.front();
    result.lift += jaws.force.z();
    result.grip += jaws.grip;
    ++frames;
  });
  result.lift /= frames;
  result.grip /= frames;
  return result;
}

}  // namespace

TEST_CASE("a finger feels a tumour of ten times the stiffness under the surface") {
  Shipped palpation("liver_palpation");
  const Vec3d with = forces_of_presses(palpation);
  std::fill(palpation.setup.material_of.begin(), palpation.setup.material_of.end(), 1);
  const Vec3d without = forces_of_presses(palpation);
  CAPTURE(with.transpose());
  CAPTURE(without.transpose());
  CHECK(with[1] > 1.9 * with[0]);
  CHECK(with[1] > 1.9 * with[2]);
  CHECK(with[1] > 2 * without[1]);
  CHECK(without.maxCoeff() < 1.25 * without.minCoeff());  // no place stands out where there is none
}

TEST_CASE("two jaws pick up the lobe that was cut off and fell, by friction") {
  const Shipped shipped("liver_pick_up");
  const PickedUp piece = pick_up(shipped);
  const double speed = 0.07 / 0.6, drag = piece.weight / 9.81 * shipped.setup.damping * speed;
  CHECK(piece.rise > 0.06);  // the jaws rise by 0.07 m
  CHECK(piece.lift == near(piece.weight + drag, 0.03));
  CHECK(2 * 0.6 * piece.grip > piece.lift);  // Coulomb's bound, of both jaws
}

// As the page's jaws do: brought open, led down, closed, and led up.
TEST_CASE("a hand picks up the lobe with jaws that close until they feel it") {
  Shipped shipped("liver_pick_up");
  const ProbeSetup jaws = shipped.setup.probes.front();
  shipped.setup.probes.clear();
  shipped.scene.time.duration = 5.5;
  ToolPose pose{{0.046, 0, 0.10}, {1, 0, 0, 0}, 0.1};
  ToolId id = 0;
  double before = 0, rise = 0, grip = 0;
  shipped.play([&](World<float>& world) {
    const double time = world.time();
    if (time < 1.2) return;
    if (id == 0) {
      id = world.tools().next_id();
      world.apply(BringProbe{jaws.name, jaws.shape, pose, jaws.friction});
    }
    const double down = 0.098 * std::clamp((time - 1.2) / 0.3, 0.0, 1.0),
                 up = 0.07 * std::clamp((time - 4.5) / 0.6, 0.0, 1.0);
    world.apply(Lead{id, {{0.046, 0, 0.10 - down + up}, pose.orientation}});
    if (time > 1.59 && time < 1.61) world.apply(SwitchTool{id, true});
    grip = std::max(grip, world.tools().lists().probes.front().grip);
    const double height = fallen_piece(world).height;
    if (time < 4.5) before = height;
    rise = height - before;
  });
  CAPTURE(grip);
  CHECK(grip > most_grip);
  CHECK(grip < 1.3 * most_grip);
  CHECK(rise > 0.06);  // of 0.07 m
}

TEST_CASE("jaws that close less hold too little of the lobe, and slip off") {
  Shipped shipped("liver_pick_up");
  for (PathPoint& row : shipped.setup.probes.front().path) row.opening = std::max(row.opening, 0.078);
  const PickedUp piece = pick_up(shipped);
  CHECK(std::abs(piece.rise) < 0.01);
  CHECK(piece.lift < 0.1 * piece.weight);
}

TEST_CASE("a finger pushes a kidney along under the liver that rests on it") {
  const Shipped shipped("two_organs");
  double pushed = 0, lifted = 0, deepest = 0;
  Vec3d kidney = Vec3d::Zero(), liver = Vec3d::Zero();
  shipped.play([&](World<float>& world) {
    const State<float> state = world.state();
    const std::vector<BodyFigures> bodies =
        body_figures(world.elements(), state.u.cast<double>(), state.v.cast<double>());
    if (world.time() < 0.51) {
      liver = bodies[0].centre;
      kidney = bodies[1].centre;
    }
    pushed = kidney.x() - bodies[1].centre.x();
    lifted = bodies[0].centre.z() - liver.z();
    TetMesh now = shipped.setup.mesh;
    now.points += state.u.cast<double>();
    for (const BodyOverlap& overlap : body_overlaps(now)) deepest = std::max(deepest, overlap.depth);
  });
  CHECK(pushed > 0.025);    // the finger moves on by 0.05 m
  CHECK(lifted > 0.0002);   // by what is higher under it now
  CHECK(deepest < 0.0015);  // of the organs in each other
}
