#include "lobe/live/session.h"

#include "live/hands_support.h"
#include "lobe/error.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double frame = 1.0 / 120;

void step(Session<float>& session, int frames) {
  for (int i = 0; i < frames; ++i) REQUIRE(session.step_frame());
}

bool replays(const Session<float>& session, const Setup& setup, int threads) {
  World<float> world(setup, threads);
  const Replayed replayed = replay(session.recording(), world);
  return replayed.same && replayed.commands == session.recording().commands.size();
}

}  // namespace

TEST_CASE("a hand takes hold, leads and lets go; what it holds follows it") {
  const Setup setup = block();
  Session<float> session(setup);
  Controller mouse = session.connect("mouse");
  REQUIRE(mouse.send(take_at(top)));
  REQUIRE(mouse.send(lead_to(top + Vec3d(0, 0, 0.01))));
  step(session, 120);
  const auto status = session.status();
  REQUIRE(status->hands.size() == 1);
  const HandStatus& hand = status->hands[0];
  CHECK(hand.holds);
  CHECK(hand.vertices > 3);
  CHECK((hand.pose.position - top - Vec3d(0, 0, 0.01)).norm() < 1e-6);
  CHECK(hand.force.z() < -0.1);
  const auto u = session.world().state().u;
  for (const HeldVertices::Held& item : session.world().held().all())
    if (item.holder == hand.tool) CHECK(double(u(2, item.vertex) - item.start.z()) == near(0.01, 1e-4));
  mouse.send(ask(Kind::let_go));
  step(session, 120);
  CHECK(session.status()->hands.empty());
  CHECK(messages(session).empty());
  CHECK(replays(session, setup, 2));
}
