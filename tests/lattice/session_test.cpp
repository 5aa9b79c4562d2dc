// Sessions whose body is one reduced region: what hands do to it is recorded, replayed, saved, undone and
// written as a scene.
#include "folder.h"
#include "lattice/lattice_worlds.h"
#include "live/hands_support.h"
#include "lobe/io/mesh_io.h"
#include "lobe/live/session_scene.h"
#include "lobe/scene/frames.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/write_scene.h"

using namespace lobe;
using namespace lobe::test;

namespace {

const Vec3d end{0.16, 0.02, 0.02};  // of the bar [m]

Setup damped_bar() {
  Setup setup = bar(16, 4);
  setup.damping = 20;
  setup.guard_below = 0.2;
  return setup;
}

// What of the body followed the lattice after the frames that were played.
struct Seen {
  bool zones = false, all_full = false;

  void look(const Session<float>& session) {
    const auto& region = session.world().body().regions.reduced();
    const bool any = region.any_embedded();
    all_full |= !any;
    zones |= any && !session.status()->hands.empty() &&
             region.full_tet_count() < session.world().elements().topology.tet_count() / 2;
  }
};

void play(Session<float>& session, int frames, Seen& seen) {
  for (int i = 0; i < frames; ++i) {
    REQUIRE(session.step_frame());
    seen.look(session);
  }
}

// Takes hold of the end, lifts it, burns into the bar and lets go.
Seen pull_and_burn(Session<float>& session, Controller& hands) {
  Seen seen;
  hands.send(take_at(end, 0.014));
  hands.send(lead_to(end + lift));
  play(session, 20, seen);
  const Vec3d above(0.09, 0.02, 0.05);
  hands.send(bring_tool(2, above, BringCautery{"", 0.006, above}));
  hands.send(turn_on(Kind::turn_on, true, 2));
  hands.send(lead_to(above - 1.5 * lift, 2));
  play(session, 20, seen);
  hands.send(ask(Kind::let_go, 2));
  hands.send(ask(Kind::let_go));
  play(session, 40, seen);
  return seen;
}

void check_same_motion(Session<float>& a, Session<float>& b) {
  CHECK(same_bits(a.world(), b.world()));
  CHECK(a.world().body().motion.nodes.u == b.world().body().motion.nodes.u);
  CHECK(a.world().body().motion.nodes.v == b.world().body().motion.nodes.v);
}

}  // namespace

TEST_CASE("what hands do to a reduced bar is replayed to the same bits, on any threads") {
  const Setup setup = damped_bar();
  Session<float> session(setup);
  Controller hands = session.connect("surgeon");
  const Seen seen = pull_and_burn(session, hands);
  CHECK(seen.zones);
  CHECK(seen.all_full);
  CHECK(session.world().body().regions.reduced().any_embedded());
  CHECK(session.world().elements().topology.alive_count() < setup.mesh.tet_count());
  CHECK(times_said(session, "refused") == 0);
  CHECK(replays(session, setup));
  CHECK(replays(session, setup, 3));
}

TEST_CASE("another session goes on with a reduced bar from a saved one to the same bits, whatever was full") {
  const Setup setup = damped_bar();
  for (const int frames : {3, 25, 44}) {  // all full, a zone at a hand, and after it has let go
    CAPTURE(frames);
    const Folder folder;
    const std::filesystem::path file = folder.path / "saved.lobe";
    Session<float> first(setup), second(setup);
    Controller a = first.connect("a"), b = second.connect("b");
    const auto begin = [&] {
      a.send(take_at(end, 0.014));
      a.send(lead_to(end + lift));
      step(first, std::min(frames, 40));
      if (frames <= 40) return;
      a.send(ask(Kind::let_go));
      step(first, frames - 40);
    };
    begin();
    CHECK(first.world().body().regions.reduced().any_embedded() == (frames == 25));
    first.save(file);
    second.restore(file);
    first.restore(file);  // hands let go
    check_same_motion(first, second);
    Seen seen;
    for (auto [session, hand] : {std::pair(&first, &a), std::pair(&second, &b)}) {
      hand->send(take_at({0.1, 0.02, 0.04}, 0.014));
      hand->send(lead_to(Vec3d(0.1, 0.02, 0.04) + lift));
      play(*session, 30, seen);
    }
    CHECK(seen.zones);
    check_same_motion(first, second);
    CHECK(replays(second, setup));
    CHECK(replays(second, setup, 2));
  }
}

TEST_CASE("a session goes back in time with a reduced bar, and its record is replayed") {
  const Setup setup = damped_bar();
  Session<float> session(setup, {.back_every = 0.05});
  Controller hands = session.connect("surgeon");
  pull_and_burn(session, hands);
  const double time = session.world().time();
  hands.send(ask_for(Kind::back, 40 * session.frame()));  // before the cautery had come
  session.step_frame();
  CHECK(session.world().time() < time - 30 * session.frame());
  Seen seen;
  hands.send(take_at(end, 0.014));
  hands.send(lead_to(end - lift));
  play(session, 30, seen);
  CHECK(seen.zones);
  CHECK(replays(session, setup, 2));
}

TEST_CASE("what hands did to a reduced bar, written as a scene and read again, is played to the same bits") {
  const Folder folder;
  write_vtu(folder.path / "bar.vtu", bar(16, 4).mesh);
  const Scene scene = read_scene(folder.write("scene.json", R"({
    "mesh": "bar.vtu",
    "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4, "density": 1000}],
    "volume_penalty": 1e5,
    "regions": [{"model": "reduced", "cell": 0.02, "where": {"box": {"min": [-1, -1, -1], "max": [1, 1, 1]}}}],
    "boundary": [{"fix": true, "where": {"box": {"min": [-1, -1, -1], "max": [0.002, 1, 1]}}}],
    "time": {"duration": 9, "damping": 20}
  })"));
  const Setup setup = resolve(scene, read_mesh(mesh_path(scene)).mesh).setup;
  Session<float> session(setup);
  Controller hands = session.connect("surgeon");
  const Seen seen = pull_and_burn(session, hands);
  CHECK(seen.zones);
  const Folder other;
  const Scene again = read_scene(other.write("kept.json", to_json(session_scene(scene, setup, session))));
  World<float> world(resolve(again, read_mesh(mesh_path(again)).mesh).setup, 2);
  const Frames frames = frames_of(again.time);
  for (int i = 0; i < frames.count; ++i) REQUIRE(world.advance(frames.length).ok);
  CHECK(world.elements().topology.alive_count() < setup.mesh.tet_count());
  CHECK(world.body().regions.reduced().any_embedded());
  CHECK(same_bits(world, session.world()));
}
