// What hands did, as a scene that `lobe run` plays.
#include "lobe/live/session_scene.h"

#include <random>

#include "folder.h"
#include "live/hands_support.h"
#include "lobe/error.h"
#include "lobe/io/mesh_io.h"
#include "lobe/run/recording.h"
#include "lobe/scene/frames.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/write_scene.h"
#include "near.h"

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

// Written, read and played from its start, on two threads, the scene gives the same bits.
void check_plays_as(const Scene& kept, World<float>& world) {
  const Folder folder;
  const Scene again = read_scene(folder.write("kept.json", to_json(kept)));
  World<float> played(resolve(again, read_mesh(mesh_path(again)).mesh).setup, 2);
  const Frames frames = frames_of(again.time);
  for (int i = 0; i < frames.count; ++i) REQUIRE(played.advance(frames.length).ok);
  CHECK(same_bits(played, world));
}

// Cuts into the beam with a cautery, which splits vertices beside it, takes hold of these by a ray, and of
// the end, turns and lifts both, cuts once more, and lets the end go.
template <class Real>
void act(Session<Real>& session) {
  Controller hands = session.connect("surgeon");
  const auto frames = [&](int count) {
    for (int i = 0; i < count; ++i) REQUIRE(session.step_frame());
  };
  hands.send(bring_tool(2, {0.058, -0.005, 0.012}, BringCautery{"", 0.0027, {0.058, -0.005, 0.012}}));
  hands.send(turn_on(Kind::turn_on, true, 2));
  hands.send(lead_to({0.057, 0.025, 0.011}, 2));
  frames(25);
  hands.send(turn_on(Kind::turn_on, false, 2));
  hands.send({.kind = Kind::take_at_ray,
              .hand = 3,
              .position = {0.061, 0.01, 0.2},
              .direction = {0, 0, -3},
              .radius = 0.012});
  hands.send(take_at({0.08, 0.01, 0.01}, 0.006, 1));
  frames(3);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.3, Vec3d::UnitX()));
  for (const HandStatus& hand : session.status()->hands) {
    if (hand.type == CauterySetup::type) continue;
    HandCommand lead = lead_to(hand.pose.position + Vec3d(0, 0.002, 0.005), hand.hand);
    lead.orientation = turn.coeffs();
    hands.send(lead);
  }
  frames(20);
  hands.send(turn_on(Kind::turn_on, true, 2));
  hands.send(lead_to({0.03, 0.01, 0.02}, 2));
  frames(20);
  hands.send(ask(Kind::let_go, 1));
  frames(10);
}

bool holds_a_copy(const Tools& tools, Index mesh_vertices) {
  for (const Grasp& grasp : tools.lists().grasps)
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

TEST_CASE("reduced regions that were chosen automatically stay reduced in the scene of a session") {
  std::string text = beam;
  const auto begin = text.find("[{\"model\""), end = text.find("],\n  \"boundary\"");
  text.replace(begin, end + 1 - begin, R"({"auto": {"reduced": true, "correct": true, "tolerance": 0.03}})");
  const Played played(text);
  Setup setup = played.resolved.setup;
  setup.region_of.assign(setup.region_of.size(), RegionModel::reduced);  // whether it pays or not
  Session<float> session(setup);
  act(session);
  const Scene kept = session_scene(played.scene, setup, session);
  CHECK(kept.reduced_tolerance() == 0.03);
  const Folder other;
  const Scene again = read_scene(other.write("kept.json", to_json(kept)));
  const Resolved resolved = resolve(again, read_mesh(mesh_path(again)).mesh);
  CHECK(resolved.setup.region_of == setup.region_of);
  World<float> world(resolved.setup);
  const Frames frames = frames_of(again.time);
  for (int i = 0; i < frames.count; ++i) REQUIRE(world.advance(frames.length).ok);
  CHECK(same_bits(world, session.world()));
}

TEST_CASE("a hand parts the beam with a scalpel, without loss, and its scene is played to the same bits") {
  std::string text = beam;
  text.erase(text.find("\"tools\""), text.find("\"time\"") - text.find("\"tools\""));
  const Played played(text);
  const Setup& setup = played.resolved.setup;
  Session<float> session(setup);
  Controller hands = session.connect("surgeon");
  const auto volume = [](const World<float>& world) {
    double sum = 0;
    for (Index t = 0; t < world.elements().topology.tet_count(); ++t)
      if (world.elements().topology.alive(t)) sum += world.elements().volume(t);
    return sum;
  };
  const Vec3d tip(0.051, -0.004, -0.006), heel(0.051, -0.004, 0.026);
  hands.send(bring_tool(1, tip, BringScalpel{"", {tip, heel}}));
  hands.send(lead_to(tip + Vec3d(0, 0.03, 0), 1));
  step(session, 20);  // it is off: it only touches
  CHECK(session.world().grains() == nullptr);
  hands.send(turn_on(Kind::turn_on, true, 1));
  hands.send(lead_to(tip, 1));
  step(session, 40);
  CHECK(session.world().elements().topology.tet_count() > setup.mesh.tet_count());
  CHECK(session.world().elements().topology.pieces().size() == 2);
  CHECK(volume(session.world()) == near(0.08 * 0.02 * 0.02, 1e-12));
  REQUIRE(session.status()->hands.size() == 1);
  CHECK(session.status()->hands[0].type == std::string("scalpel"));
  CHECK(session.status()->hands[0].holds);
  hands.send(ask(Kind::let_go, 1));
  step(session, 5);
  CHECK(session.status()->hands.empty());
  const Scene kept = session_scene(played.scene, setup, session);
  REQUIRE(kept.tools.size() == 1);
  REQUIRE(kept.tools[0].type() == "scalpel");
  CHECK(kept.tools[0].as<ScalpelSetup>().heels.size() == kept.tools[0].path().size());
  check_plays_as(kept, session.world());
}

TEST_CASE("a hand presses a probe on a precomputed region: that is felt, and its scene has the same bits") {
  for (const bool turns : {false, true}) {  // where the region has a frame that turns it cannot be expanded
    CAPTURE(turns);
    std::string text = beam;
    text.erase(text.find("\"tools\""), text.find("\"time\"") - text.find("\"tools\""));
    text.replace(text.find("\"tensor-mass\""), 13,
                 turns ? R"("precomputed", "frame": "corotated")" : R"("precomputed")");
    const Played played(text);
    const Setup& setup = played.resolved.setup;
    CHECK(setup.expandable == !turns);
    Session<float> session(setup);
    Controller hands = session.connect("surgeon");
    const auto is_expanded = [&] { return session.world().body().regions.is_expanded(); };
    const Vec3d beside(0.015, 0.01, 0.027), pressed(0.015, 0.01, 0.024);
    step(session, 60);
    hands.send(bring_tool(1, beside, BringProbe{"", RigidShape::sphere(0.006), {.position = beside}, 0.1}));
    hands.send(lead_to(pressed));
    step(session, 60);
    CHECK(is_expanded() == !turns);
    CHECK(times_said(session, "lost_force") == turns);
    const double deepest = session.status()->hands.at(0).force.norm();
    if (!turns) CHECK(deepest > 0.05);
    hands.send(ask(Kind::let_go));
    step(session, 90);
    CHECK_FALSE(is_expanded());
    CHECK(replays(session, setup, 2));
    const Scene kept = session_scene(played.scene, setup, session);
    REQUIRE(kept.tools.size() == 1);
    check_plays_as(kept, session.world());
  }
}

TEST_CASE("a session that a scene cannot tell is refused with what and when") {
  const Played played;
  const Setup& setup = played.resolved.setup;
  Session<float> session(setup);
  Controller hands = session.connect("surgeon");
  const auto refusal = [&](const Setup& of = {}) -> std::string {
    try {
      session_scene(played.scene, of.mesh.tet_count() > 0 ? of : setup, session);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  CHECK(refusal() == "session: nothing was simulated yet");
  step(session, 60);
  CHECK(refusal() == "");
  Setup other = setup;
  other.damping += 1;
  CHECK(refusal(other) == "session: is of another scene, mesh or version of them");
  hands.send({.kind = Kind::edit, .body_edit = std::make_shared<const Edit>(RemoveTets{{100}})});
  step(session, 1);
  CHECK(refusal() ==
        "session: tetrahedra were removed at 0.5 s, which a scene cannot describe; a recording can");
  hands.send(ask_for(Kind::back, 0.2));
  step(session, 1);
  CHECK(refusal() == "");
  hands.send(
      {.kind = Kind::edit, .body_edit = std::make_shared<const Edit>(SetForces{{{100, Vec3d(0, 0, 1e20)}}})});
  session.step_frame();
  CHECK(refusal().find("session: forces were set at") == 0);
  Scene in_double = played.scene;
  in_double.time.precision = Precision::double_precision;
  CHECK_THROWS_WITH_AS(session_scene(in_double, setup, session),
                       "session: is in single precision, its scene in double", InputError);
}

TEST_CASE("each edit that a scene has no word for is refused by its name") {
  const Played played;
  const Setup& setup = played.resolved.setup;
  const auto refusal = [&](const Edit& edit) -> std::string {
    Session<float> session(setup);
    Controller hands = session.connect("surgeon");
    step(session, 12);
    hands.send({.kind = Kind::edit, .body_edit = std::make_shared<const Edit>(edit)});
    step(session, 1);
    try {
      session_scene(played.scene, setup, session);
    } catch (const InputError& error) {
      return error.what();
    }
    return times_said(session, "refused") > 0 ? "was not done" : "";
  };
  const std::string end = " at 0.1 s, which a scene cannot describe; a recording can";
  CHECK(refusal(SetRegion{{100}, RegionModel::tensor_mass}) == "session: a region was changed" + end);
  CHECK(refusal(SetSprings{{{100, 10, Vec3d::Zero()}}}) == "session: springs were set" + end);
  CHECK(refusal(SetForces{{{100, Vec3d(0, 0, 1e-3)}}}) == "session: forces were set" + end);
  CHECK(refusal(Expand{}) == "was not done");  // in a setup that is not expandable
}

TEST_CASE("a session in which a frame failed is refused") {
  std::string text = beam;
  text.replace(text.find("-1]"), 2, "-1e20");
  const Played falling(text);
  Session<float> failing(falling.resolved.setup);
  failing.step_frame();
  REQUIRE(times_said(failing, "stands_still") == 1);
  CHECK_THROWS_WITH_AS(session_scene(falling.scene, falling.resolved.setup, failing),
                       "session: a frame failed, after which no scene gets here; go back to before it",
                       InputError);
}

TEST_CASE("a session in double precision is none of a scene in single") {
  const Played played;
  Session<double> session(played.resolved.setup);
  REQUIRE(session.step_frame());
  CHECK_THROWS_WITH_AS(session_scene(played.scene, played.resolved.setup, session),
                       "session: is in double precision, its scene in single", InputError);
}

TEST_CASE("a scene tells where hands have got to, without what was undone") {
  const Played played;
  const Setup& setup = played.resolved.setup;
  Session<float> session(setup);
  Controller hands = session.connect("surgeon");
  hands.send(take_at({0.08, 0.01, 0.01}, 0.006));
  hands.send(lead_to({0.08, 0.01, 0.02}));
  step(session, 100);
  hands.send(ask_for(Kind::back, 0.3));
  step(session, 3);
  hands.send(take_at({0.08, 0.01, 0.01}, 0.012, 2));
  hands.send(lead_to({0.09, 0.01, 0.01}, 2));
  step(session, 40);
  const Scene kept = session_scene(played.scene, setup, session);
  CHECK(kept.tools.size() == 3);  // with the scene's own
  World<float> world(resolve(kept, setup.mesh).setup);
  const Frames frames = frames_of(kept.time);
  for (int i = 0; i < frames.count; ++i) world.advance(frames.length);
  CHECK(same_bits(world, session.world()));
}

TEST_CASE("a session sleeps; its scene and its recording say by how much displacements may differ") {
  const Played played;
  const Setup setup = session_setup(played.scene, played.resolved.setup);
  CHECK(setup.sleep == near(1e-4 * std::sqrt(0.0072), 1e-9));
  Session<float> session(setup);
  step(session, 300);
  REQUIRE(session.world().body().sleep.count() == setup.mesh.vertex_count());
  Controller hands = session.connect("surgeon");
  hands.send(take_at({0.08, 0.01, 0.01}, 0.008));
  step(session, 2);
  hands.send(lead_to(session.status()->hands[0].pose.position + Vec3d(0, 0, 0.01)));
  step(session, 30);
  CHECK(session.world().body().sleep.count() < setup.mesh.vertex_count());
  const Scene kept = session_scene(played.scene, setup, session);
  CHECK(kept.time.sleep == setup.sleep);
  check_plays_as(kept, session.world());

  const Folder folder;
  write_recording(folder.path / "drag.lobe", session.recording());
  const Recording recording = read_recording(folder.path / "drag.lobe");
  World<float> world(as_recorded(recording, played.resolved.setup), 2), awake(played.resolved.setup);
  CHECK(replay(recording, world).same);
  CHECK(same_bits(world, session.world()));
  CHECK_THROWS_WITH_AS(replay(recording, awake), doctest::Contains("is of another scene"), InputError);
}

TEST_CASE("a session does not sleep if its scene says so, nor beside what does not go with sleep") {
  const auto sleep_of = [](const std::string& part, const std::string& instead) {
    std::string text = beam;
    const Played played(text.replace(text.find(part), part.size(), instead));
    return session_setup(played.scene, played.resolved.setup).sleep;
  };
  CHECK(sleep_of("\"damping\"", "\"sleep\": false, \"damping\"") == 0);
  CHECK(sleep_of("\"damping\"", "\"sleep\": 0, \"damping\"") == 0);
  CHECK(sleep_of("\"damping\"", "\"sleep\": 1e-6, \"damping\"") == 1e-6);
  CHECK(sleep_of("\"damping\"", "\"integrator\": \"implicit\", \"damping\"") == 0);
  CHECK(sleep_of("\"density\"", "\"nodal_pressure\": true, \"density\"") == 0);
}

TEST_CASE("what hands burnt declares no gesture") {
  const Played played;
  Session<float> session(played.resolved.setup);
  act(session);
  const Scene kept = with_gestures(session_scene(played.scene, played.resolved.setup, session), 0.02);
  REQUIRE(kept.auto_regions);
  CHECK(kept.regions.empty());
  CHECK(kept.auto_regions->gestures.size() == 2);  // of two grasps and three strokes of a cautery
  for (const SceneGesture& gesture : kept.auto_regions->gestures) CHECK(gesture.value.norm() > 0);
}

TEST_CASE("the grasps of a session can be declared as gestures of automatic regions") {
  const Played played;
  const Setup& setup = played.resolved.setup;
  Session<float> session(setup);
  Controller hands = session.connect("surgeon");
  hands.send(take_at({0.08, 0.01, 0.01}, 0.008));
  step(session, 2);
  const Vec3d from = session.status()->hands[0].pose.position;
  hands.send(lead_to(from + Vec3d(0, 0, 0.01)));
  step(session, 60);
  hands.send(lead_to(from));
  step(session, 60);
  hands.send(take_at({0.06, 0.01, 0.02}, 0.008, 2));  // and holds still
  step(session, 10);
  const Scene kept = with_gestures(session_scene(played.scene, setup, session), 0.03);
  const Scene again = parse_scene(to_json(kept));
  REQUIRE(again.auto_regions);
  CHECK(again.auto_regions->tolerance == 0.03);
  const Resolved resolved = resolve(again, setup.mesh);
  REQUIRE(resolved.gestures.size() == 1);
  CHECK(resolved.gestures[0].vertices == session.world().tools().grasp(2)->vertices);
  CHECK((resolved.gestures[0].displacements[0] - Vec3d(0, 0, 0.01)).norm() < 1e-5);
}
