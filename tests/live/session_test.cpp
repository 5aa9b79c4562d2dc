#include "lobe/live/session.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>
#include <utility>

#include "live/hands_support.h"
#include "lobe/error.h"

using namespace lobe;
using namespace lobe::test;

namespace {

void wait_for_frames(const Session<float>& session, std::int64_t frames) {
  for (int i = 0; i < 60000 && session.status()->frames < frames; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  REQUIRE(session.status()->frames >= frames);
}

}  // namespace

TEST_CASE("pausing and single steps do not change the bits") {
  const Setup setup = block();
  Session<float> paused(setup), straight(setup);
  Controller a = paused.connect("a"), b = straight.connect("b");
  for (Controller* hands : {&a, &b}) {
    hands->send(take_at(top));
    hands->send(lead_to(top + lift));
  }
  step(paused, 5);
  a.send(turn_on(Kind::run, false));
  for (int i = 0; i < 50; ++i) CHECK_FALSE(paused.step_frame());
  CHECK(paused.world().time() == 5 * paused.frame());
  CHECK_FALSE(paused.status()->is_running);
  for (int i = 0; i < 3; ++i) {
    a.send(ask(Kind::step));
    CHECK(paused.step_frame());
    CHECK_FALSE(paused.step_frame());
  }
  a.send(turn_on(Kind::run, true));
  step(paused, 12);
  step(straight, 20);
  CHECK(same_bits(paused.world(), straight.world()));
}

TEST_CASE("what is done while the simulation pauses is seen at once") {
  Session<float> session(block());
  Controller mouse = session.connect("mouse");
  step(session, 3);
  mouse.send(turn_on(Kind::run, false));
  session.step_frame();
  const Index before = session.pictures().latest()->figures.tets;
  mouse.send(
      {.kind = Kind::edit, .sequence = 41, .body_edit = std::make_shared<const Edit>(RemoveTets{{10, 11}})});
  CHECK_FALSE(session.step_frame());
  CHECK(session.pictures().latest()->figures.tets == before - 2);
  const auto status = session.status();
  CHECK(status->sequences[std::size_t(mouse.number())] == 41);
  CHECK(status->picture == session.pictures().latest()->frame);
}

TEST_CASE("restart and back put the body where it was; hands let go, and the whole record is replayed") {
  const Setup setup = block();
  SessionOptions options;
  options.back_every = 0.05;
  Session<float> session(setup, options), fresh(setup);
  Controller mouse = session.connect("mouse");
  const auto hold_and_burn = [&] {
    mouse.send(take_at(top));
    mouse.send(lead_to(top + lift));
    mouse.send(bring_tool(2, {0.01, -0.01, 0.04}, BringCautery{"", 0.005, {0.01, -0.01, 0.04}}));
    mouse.send(turn_on(Kind::turn_on, true, 2));
    mouse.send(lead_to({0.01, 0.06, 0.04}, 2));
  };
  hold_and_burn();
  step(session, 30);
  const Index alive = session.world().elements().topology.alive_count();
  CHECK(alive < setup.mesh.tet_count());
  mouse.send(ask_for(Kind::back, 0.2));
  step(session, 1);
  CHECK(session.world().time() == 7 * session.frame());
  CHECK(session.status()->can_go_back == session.world().time());
  CHECK(times_said(session, "went_back") == 1);
  CHECK(session.status()->hands.empty());
  CHECK(session.world().elements().topology.alive_count() > alive);
  step(session, 20);
  for (const HeldVertices::Held& item : session.world().held().all())
    CHECK(item.holder == HeldVertices::boundary);
  hold_and_burn();
  step(session, 10);
  mouse.send(ask(Kind::restart));
  step(session, 25);
  step(fresh, 25);
  CHECK(same_bits(session.world(), fresh.world()));
  CHECK(session.world().elements().topology.alive_count() == setup.mesh.tet_count());
  hold_and_burn();
  step(session, 20);
  mouse.send(ask_for(Kind::back, 1e9));  // further than there is
  step(session, 1);
  CHECK(session.world().time() == session.frame());
  for (int threads : {1, 2}) CHECK(replays(session, setup, threads));
}

TEST_CASE("one can go back to the moment before a hand took hold, not only to states some time apart") {
  const Setup setup = block();
  SessionOptions options;
  options.back_every = 100;
  Session<float> session(setup, options), fresh(setup);
  Controller mouse = session.connect("mouse");
  step(session, 5);
  mouse.send(take_at(top));
  mouse.send(lead_to(top + lift));
  step(session, 7);
  mouse.send(ask_for(Kind::back, 6.5 * session.frame()));
  step(session, 1);
  CHECK(session.world().time() == 6 * session.frame());
  step(fresh, 6);
  CHECK(same_bits(session.world(), fresh.world()));
  CHECK(replays(session, setup, 1));
}

TEST_CASE("states to go back to stay within their memory; with little of it one goes back further") {
  const Setup setup = block();
  World<float> world(setup);
  Timeline<float> timeline(world, 0.01, 200'000);
  for (int i = 0; i < 100; ++i) {
    timeline.advance(0.01);
    CHECK(timeline.bytes() <= 200'000);
  }
  CHECK(timeline.bytes() > 100'000);
  timeline.go_back(0.005);
  CHECK(world.time() == near(0.99, 1e-9));
  timeline.go_back(0.9);
  CHECK(world.time() == 0);
}

TEST_CASE("readers that keep pictures for ever do not stop the session") {
  Session<float> session(block());
  std::vector<TripleBuffer<Snapshot<float>>::View> pictures;
  std::vector<TripleBuffer<SessionStatus>::View> states;
  for (int i = 0; i < 12; ++i) {
    pictures.push_back(session.pictures().latest());
    states.push_back(session.status());
    step(session, 1);
  }
  CHECK(session.world().time() == 12 * session.frame());
  const double last = pictures.back()->time;
  pictures.clear();
  states.clear();
  step(session, 1);
  CHECK(session.pictures().latest()->time == session.world().time());
  CHECK(last < session.world().time());
}

TEST_CASE(
    "where no step is stable the session pauses and says so; going back helps, and all of it is replayed") {
  const Setup setup = block();
  SessionOptions options;
  options.back_every = 0.01;
  Session<float> session(setup, options);
  Controller mouse = session.connect("mouse");
  step(session, 20);
  const double before = session.world().time();
  mouse.send(take_at(top));
  mouse.send(
      {.kind = Kind::edit, .body_edit = std::make_shared<const Edit>(SetForces{{{100, Vec3d(0, 0, 1e20)}}})});
  session.step_frame();
  CHECK(session.world().time() == before);
  CHECK(session.status()->stands_still);
  CHECK_FALSE(session.status()->is_running);
  CHECK(times_said(session, "diverged") == 1);
  CHECK(times_said(session, "stands_still") == 1);
  CHECK_FALSE(session.step_frame());
  mouse.send(ask_for(Kind::back, 0.05));
  mouse.send(turn_on(Kind::run, true));
  step(session, 3);
  CHECK_FALSE(session.status()->stands_still);
  CHECK(session.world().time() < before);
  CHECK(replays(session, setup, 2));
}

TEST_CASE("a session with a thread of its own follows the clock, obeys while it pauses, and stops") {
  const Setup setup = block();
  SessionOptions options;
  options.running = false;
  Session<float> session(setup, options);
  Controller mouse = session.connect("mouse");
  session.start();
  CHECK(session.is_started());
  mouse.send(ask(Kind::step));
  wait_for_frames(session, 1);
  mouse.send(turn_on(Kind::run, true));
  wait_for_frames(session, 60);
  CHECK(session.status()->real_time_factor > 0);
  // In the half second that is looked at, 0.1 s that were lost before and a frame may be made up for.
  CHECK(session.status()->real_time_factor < 1.22);
  mouse.send(ask_for(Kind::speed, 0.001));  // 8 s per frame, which nobody has to wait for
  double time = 0;
  session.between_frames([&] { time = session.world().time(); });
  CHECK(time > 0.4);
  CHECK_THROWS_WITH_AS(session.between_frames([] { throw InputError("work", "went wrong"); }),
                       "work: went wrong", InputError);
  mouse.send(turn_on(Kind::run, false));
  session.between_frames([&] { time = session.world().time(); });
  session.stop();
  session.stop();
  CHECK_FALSE(session.is_started());
  session.between_frames([&] { time = 0; });
  CHECK(time == 0);
  CHECK(replays(session, setup));
}

TEST_CASE("options that are none are refused") {
  const auto refused = [](auto&& change) {
    SessionOptions options;
    change(options);
    CHECK_THROWS_AS(Session<float>(block(), options), InputError);
  };
  refused([](SessionOptions& o) { o.frame = 0; });
  refused([](SessionOptions& o) { o.frame = std::nan(""); });
  refused([](SessionOptions& o) { o.speed = -1; });
  refused([](SessionOptions& o) { o.queue = 0; });
  refused([](SessionOptions& o) { o.back_every = -1; });
  refused([](SessionOptions& o) { o.controller_timeout = -1; });
  refused([](SessionOptions& o) { o.hand.lag = 0; });
  refused([](SessionOptions& o) { o.hand.force_cap = 0; });
}

TEST_CASE(
    "times of frames are exact multiples of one length, which is the one asked for but for a billionth") {
  const Session<float> session(block());
  const double length = session.frame();
  CHECK(std::abs(length * 120 - 1) < 2e-9);
  double sum = 0;
  for (int i = 1; i <= 100000; ++i) {
    sum += length;
    REQUIRE(sum == i * length);
    REQUIRE(i * length / i == length);
  }
}

namespace {

// Leaves a frame in its middle by an exception, when it is told to.
struct Failing final : SessionHook<float> {
  bool before = false, after = false;
  void before_frame(Hands<float>&, World<float>& world, double) override {
    if (!std::exchange(before, false)) return;
    world.apply(RemoveTets{{1, 2, 3}});  // which no recording has
    throw std::runtime_error("as you wish");
  }
  void after_frame(Hands<float>&, World<float>&, double) override {
    if (std::exchange(after, false)) throw 7;
  }
};

void wait_until_failed(const Session<float>& session, int times) {
  for (int i = 0; i < 5000 && times_said(session, "failed") < times; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  REQUIRE(times_said(session, "failed") == times);
}

}  // namespace

TEST_CASE("an exception in a frame ends no thread: it is said, nothing is done, and going back leads on") {
  const Setup setup = block();
  Failing hook;
  SessionOptions options;
  options.paced = false;
  Session<float> session(setup, options);
  session.add_hook(hook);
  Controller mouse = session.connect("mouse");
  mouse.send(take_at(top));
  mouse.send(lead_to(top + lift));
  session.start();
  wait_for_frames(session, 20);
  session.between_frames([&] { hook.before = true; });
  wait_until_failed(session, 1);
  CHECK(times_said(session, "failed", "as you wish") == 1);
  CHECK(session.status()->stands_still);
  CHECK_FALSE(session.status()->is_running);
  mouse.send(turn_on(Kind::run, true));
  mouse.send(lead_to(top));
  for (int i = 0; i < 5000 && times_said(session, "refused", "has failed") < 2; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  CHECK(times_said(session, "refused", "has failed") == 2);
  CHECK_FALSE(session.status()->is_running);
  std::int64_t frames = session.status()->frames;
  mouse.send(ask(Kind::restart));
  mouse.send(turn_on(Kind::run, true));
  wait_for_frames(session, frames + 20);
  CHECK_FALSE(session.status()->stands_still);
  session.between_frames([&] { hook.after = true; });
  wait_until_failed(session, 2);
  frames = session.status()->frames;
  mouse.send(ask_for(Kind::back, 0.05));
  mouse.send(turn_on(Kind::run, true));
  wait_for_frames(session, frames + 20);
  session.stop();
  CHECK(replays(session, setup));
}

TEST_CASE("what is called with each picture may fail: that is said, and the simulation goes on") {
  SessionOptions options;
  std::atomic<bool> fails = false;
  options.paced = false;
  options.published = [&] {
    if (fails) throw std::runtime_error("as you wish");
  };
  Session<float> session(block(), options);
  session.start();
  wait_for_frames(session, 5);
  fails = true;
  wait_for_frames(session, session.status()->frames + 20);
  CHECK(times_said(session, "failed", "as you wish") >= 1);
  CHECK_FALSE(session.status()->stands_still);
}
