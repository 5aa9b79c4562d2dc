// What hands did, as a scene that `lobe run` plays.
#include "lobe/live/session_scene.h"

#include <random>

#include "folder.h"
#include "live/hands_support.h"
#include "lobe/error.h"
#include "lobe/io/mesh_io.h"
#include "lobe/scene/frames.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/write_scene.h"

using namespace lobe;
using namespace lobe::test;

namespace {

const char* const beam = R"({
  "mesh": "beam.vtu",
  "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4, "density": 1000}],
  "volume_penalty": 1e5,
  "regions": [{"model": "tensor-mass", "where": {"box": {"min": [0, 0, 0], "max": [0.03, 1, 1]}}}],
  "boundary": [{"fix": true, "where": {"box": {"min": [0, 0, 0], "max": [0, 1, 1]}}}],
  "gravity": [0, 0, -1],
  "tools": [{"type": "cautery", "radius": 0.003, "path": [[0.05, 0.07, -0.01, 0.02], [0.1, 0.07, 0.03, 0.02]]}],
  "time": {"duration": 9, "damping": 20},
  "output": {"pictures": [0.1, 8]}
})";

struct Played {
  Folder folder;
  Scene scene;
  Resolved resolved;

  Played(std::string text = beam) {
    write_vtu(folder.path / "beam.vtu", box_mesh({0.08, 0.02, 0.02}, 12, 3, 3));
    scene = read_scene(folder.write("scene.json", text));
    resolved = resolve(scene, read_mesh(mesh_path(scene)).mesh);
  }
};

// Cuts into the beam with a cautery, which splits vertices beside it, takes hold of these by a ray, and of the end, turns and lifts
// both, cuts once more, and lets the end go.
template <class Real>
void act(Session<Real>& session) {
  Controller hands = session.connect("surgeon");
  const auto frames = [&](int count) {
    for (int i = 0; i < count; ++i) REQUIRE(session.step_frame());
  };
  hands.send({.kind = Kind::bring_cautery, .hand = 2, .position = {0.058, -0.005, 0.012}, .radius = 0.0027});
  hands.send(turn_on(Kind::burn, true, 2));
  hands.send(lead_to({0.057, 0.025, 0.011}, 2));
  frames(25);
  hands.send(turn_on(Kind::burn, false, 2));
  hands.send({.kind = Kind::take_at_ray,
              .hand = 3,
              .position = {0.061, 0.01, 0.2},
              .direction = {0, 0, -3},
              .radius = 0.012});
  hands.send(take_at({0.08, 0.01, 0.01}, 0.006, 1));
  frames(3);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.3, Vec3d::UnitX()));
  for (const HandStatus& hand : session.status()->hands) {
    if (hand.type == ToolType::cautery) continue;
    HandCommand lead = lead_to(hand.pose.position + Vec3d(0, 0.002, 0.005), hand.hand);
    lead.orientation = turn.coeffs();
    hands.send(lead);
  }
  frames(20);
  hands.send(turn_on(Kind::burn, true, 2));
  hands.send(lead_to({0.03, 0.01, 0.02}, 2));
  frames(20);
  hands.send(ask(Kind::let_go, 1));
  frames(10);
}

bool holds_a_copy(const Tools& tools, Index mesh_vertices) {
  for (const Grasp& grasp : tools.grasps())
    for (Index v : grasp.vertices)
      if (v >= mesh_vertices) return true;
  return false;
}

}  // namespace

TEST_CASE_TEMPLATE("what hands did, written as a scene and read again, is played to the same bits", Real,
                   float, double) {
  std::string text = beam;
  if (std::is_same_v<Real, double>) text.replace(text.find("\"damping\""), 0, "\"precision\": \"double\", ");
  const Played played(text);
  const Setup& setup = played.resolved.setup;
  Session<Real> session(setup);
  act(session);
  CHECK(session.world().elements().topology.alive_count() < setup.mesh.tet_count() - 20);
  CHECK(holds_a_copy(session.world().tools(), setup.mesh.vertex_count()));
  const Scene kept = session_scene(played.scene, setup, session);
  CHECK(kept.output.pictures == std::vector<double>{0.1});
  const Folder other;
  const Scene again = read_scene(other.write("kept.json", to_json(kept)));
  const Resolved resolved = resolve(again, read_mesh(mesh_path(again)).mesh);
  World<Real> world(resolved.setup, 2);
  const Frames frames = frames_of(again.time);
  CHECK(frames.length == session.frame());
  for (int i = 0; i < frames.count; ++i) REQUIRE(world.advance(frames.length).ok);
  CHECK(world.elements().topology.alive_count() == session.world().elements().topology.alive_count());
  CHECK(same_bits(world, session.world()));
}
