#include "lobe/live/hands.h"

#include <chrono>
#include <cmath>
#include <thread>

#include "live/hands_support.h"
#include "lobe/error.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("a hand takes hold, leads and lets go; what it holds follows it") {
  const Setup setup = block();
  Session<float> session(setup);
  Controller mouse = session.connect("mouse");
  REQUIRE(mouse.send(take_at(top)));
  REQUIRE(mouse.send(lead_to(top + lift)));
  step(session, 120);
  const auto status = session.status();
  REQUIRE(status->hands.size() == 1);
  const HandStatus& hand = status->hands[0];
  CHECK(hand.holds);
  CHECK(hand.vertices > 3);
  CHECK((hand.pose.position - top - lift).norm() < 1e-6);
  CHECK(hand.force.z() < -0.1);
  const auto u = session.world().state().u;
  for (const HeldVertices::Held& item : session.world().held().all())
    if (item.holder == hand.tool) CHECK(double(u(2, item.vertex) - item.start.z()) == near(0.01, 1e-4));
  mouse.send(ask(Kind::let_go));
  step(session, 120);
  CHECK(session.status()->hands.empty());
  // Nothing but what the simulation puts right by itself, which is counted.
  for (const SessionMessage& message : messages(session)) CHECK(message.name == "sub_stepped");
  CHECK(times_said(session, "sub_stepped") == session.status()->reruns);
  CHECK(replays(session, setup, 2));
}

TEST_CASE("jaws keep the orientation with which a hand has brought them, and turn with the hand") {
  Session<float> session(block());
  Controller mouse = session.connect("mouse");
  const Eigen::Quaterniond from_above(Eigen::AngleAxisd(std::acos(-1.0), Vec3d::UnitX())),
      turned(Eigen::AngleAxisd(0.4, Vec3d::UnitZ()));
  const Vec3d beside = top + Vec3d(0, 0, 0.1);
  BringProbe jaws{"", RigidShape::jaws({0.02, 0.004, 0.03}), {beside, from_above.coeffs(), 0.08}, 0.5};
  REQUIRE(mouse.send(bring_tool(1, beside, jaws)));
  step(session, 5);
  const auto pose = [&] { return session.status()->hands.at(0).pose; };
  const auto angle_to = [&](const Eigen::Quaterniond& wanted) {
    return wanted.angularDistance(Eigen::Quaterniond(pose().orientation));
  };
  CHECK(angle_to(from_above) < 1e-12);
  mouse.send(lead_to(beside + lift));
  step(session, 120);
  CHECK((pose().position - beside - lift).norm() < 1e-6);
  CHECK(angle_to(from_above) < 1e-12);
  HandCommand turn = lead_to(beside + lift);
  turn.orientation = turned.coeffs();
  mouse.send(turn);
  step(session, 120);
  CHECK(angle_to(turned * from_above) < 1e-6);
  const Probe& probe = session.world().tools().lists().probes.front();
  CHECK((turned * from_above).angularDistance(Eigen::Quaterniond(probe.path.back().orientation)) < 1e-6);
  CHECK(session.status()->hands[0].shape.opening == 0.08);
}

TEST_CASE("a probe that a hand brings into the body is told of, and one beside it is not") {
  Session<float> session(block());
  Controller mouse = session.connect("mouse");
  const auto bring = [&](const Vec3d& at) {
    REQUIRE(mouse.send(bring_tool(1, at, BringProbe{"", RigidShape::sphere(0.003), {.position = at}, 0.1})));
    step(session, 1);
  };
  bring(top + lift);
  CHECK(times_said(session, "inside") == 0);
  bring(top - 2 * lift);
  CHECK(times_said(session, "inside", "hand 1 of mouse: its probe begins inside the body") == 1);
}

TEST_CASE("a blade that cuts wholly inside the body is told of once, and one whose heel is outside is not") {
  for (const bool is_inside : {false, true}) {
    CAPTURE(is_inside);
    Session<float> session(block());
    Controller mouse = session.connect("mouse");
    const Vec3d tip = top - 2 * lift, heel = is_inside ? Vec3d(top - lift) : Vec3d(top + lift);
    REQUIRE(mouse.send(bring_tool(1, tip, BringScalpel{"", {tip, heel}})));
    step(session, 12);
    CHECK(times_said(session, "blade_inside") == 0);  // it does not cut yet
    mouse.send(turn_on(Kind::turn_on, true));
    step(session, 30);
    CHECK(times_said(session, "blade_inside", "hand 1 of mouse: its blade is wholly inside") == is_inside);
  }
}

TEST_CASE("a ray takes hold where it meets the body as it is now, and says so where it misses") {
  const Setup setup = block();
  SessionOptions options;
  options.hand.force_cap = 1e3;
  Session<float> session(setup, options);
  Controller mouse = session.connect("mouse");
  HandCommand ray{
      .kind = Kind::take_at_ray, .hand = 1, .position = {0.025, 0.025, 1}, .direction = {0, 0, -1}};
  ray.radius = 0.012;
  mouse.send(take_at(top, 0.02, 2));
  mouse.send(lead_to(top + lift, 2));
  step(session, 60);
  mouse.send(ask(Kind::let_go, 2));
  mouse.send(ray);
  ray.hand = 3;
  ray.position.x() = 0.2;
  mouse.send(ray);
  step(session, 2);
  CHECK(times_said(session, "missed", "hand 3 of mouse: the ray meets nothing") == 1);
  CHECK(messages(session).size() == 1);
  const auto status = session.status();
  REQUIRE(status->hands.size() == 1);
  CHECK(status->hands[0].hand == 1);
  CHECK(status->hands[0].holds);
  CHECK(status->hands[0].vertices > 0);
  CHECK(status->hands[0].pose.position.z() > 0.055);
  CHECK(replays(session, setup));
}

TEST_CASE("each malformed command is named, and disturbs neither the body nor other commands") {
  const Setup setup = block();
  Session<float> session(setup), undisturbed(setup);
  Controller mouse = session.connect("mouse"), other = undisturbed.connect("mouse");
  for (Controller* hands : {&mouse, &other}) {
    hands->send(take_at(top));
    hands->send(lead_to(top + lift));
  }
  step(session, 10);
  step(undisturbed, 10);
  const double nan = std::nan("");
  const auto edit = [](const Edit& command) {
    return HandCommand{.kind = Kind::edit, .body_edit = std::make_shared<const Edit>(command)};
  };
  const Index tets = setup.mesh.tet_count();
  const std::vector<std::pair<HandCommand, std::string>> wrong = {
      {lead_to(Vec3d(0, nan, 0)), "lead: its position must be three finite numbers"},
      {{.kind = Kind::lead, .hand = 1, .orientation = {0, 0, 0, 2}}, "lead: its orientation must be a unit"},
      {{.kind = Kind::lead, .hand = 1, .orientation = {nan, 0, 0, 1}},
       "lead: its orientation must be a unit"},
      {lead_to(top, 7), "hand 7 of mouse: has no tool to lead"},
      {turn_on(Kind::turn_on, true), "turn_on: hand 1 of mouse has nothing to turn on or off"},
      {take_at(top, nan, 2), "take_at_point: its radius must be above 0"},
      {take_at(top, -1, 2), "take_at_point: its radius must be above 0"},
      {{.kind = Kind::take_at_ray, .hand = 2, .radius = 0.01}, "take_at_ray: its direction"},
      {bring_tool(2, Vec3d::Zero(), BringCautery{"", 0, Vec3d::Zero()}), "cautery: needs a radius"},
      {bring_tool(2, Vec3d::Zero(), BringScalpel{"", {top, top}}), "scalpel:"},
      {bring_tool(2, Vec3d::Zero(), BringScalpel{"", {top, Vec3d(0, nan, 0)}}), "scalpel:"},
      {ask_for(Kind::speed, nan), "speed: must be from 0.001"},
      {ask_for(Kind::back, -1), "back: must be by 0 s or more"},
      {ask(Kind(77)), "command: there is none of kind 77"},
      {ask(Kind::edit), "edit: has no command for the body"},
      {edit(RemoveTets{{tets}}), "tetrahedron " + std::to_string(tets)},
      {edit(SetForces{{{0, Vec3d(nan, 0, 0)}}}), "refused"},
  };
  for (const auto& [command, text] : wrong) {
    CAPTURE(text);
    REQUIRE(mouse.send(command));
    step(session, 1);
    step(undisturbed, 1);
    CHECK(messages(session).back().name == "refused");
    if (text != "refused") CHECK(messages(session).back().text.find(text) != std::string::npos);
  }
  CHECK(times_said(session, "refused") == int(wrong.size()));
  CHECK(same_bits(session.world(), undisturbed.world()));
  CHECK(session.status()->hands.size() == 1);
  CHECK(replays(session, setup));
}

TEST_CASE("a message that is said again and again is one message") {
  Session<float> session(block());
  Controller mouse = session.connect("mouse");
  mouse.send(ask(Kind::edit));
  for (int i = 0; i < 500; ++i) {
    mouse.send(lead_to(Vec3d::Constant(std::nan(""))));
    step(session, 1);
  }
  REQUIRE(messages(session).size() == 2);
  CHECK(messages(session).back().times == 500);
  CHECK(messages(session).back().number == 2);
}

TEST_CASE("where a controller dies in the middle of a drag its tools let go, and nobody else's") {
  const Setup setup = block();
  Session<float> session(setup);
  Controller stays = session.connect("stays");
  stays.send(take_at({0.045, 0.025, 0.05}, 0.008));
  {
    Controller dies = session.connect("dies");
    dies.send(take_at({0.005, 0.025, 0.05}, 0.008));
    dies.send(bring_tool(2, {0.025, 0.025, 0.045}, BringCautery{"", 0.004, {0.025, 0.025, 0.045}}));
    dies.send(lead_to(Vec3d(0.005, 0.025, 0.05) + lift));
    step(session, 10);
    dies.send(turn_on(Kind::turn_on, true, 2));
    REQUIRE(session.status()->hands.size() == 3);
  }
  step(session, 2);
  CHECK(times_said(session, "controller_gone", "dies: its 2 tools have let go") == 1);
  REQUIRE(session.status()->hands.size() == 1);
  CHECK(session.status()->hands[0].controller == stays.number());
  const Index alive = session.world().elements().topology.alive_count();
  step(session, 30);
  CHECK(session.world().elements().topology.alive_count() == alive);
  for (const HeldVertices::Held& item : session.world().held().all())
    CHECK((item.holder == HeldVertices::boundary || item.holder == session.status()->hands[0].tool));
  CHECK(replays(session, setup));
}

TEST_CASE("a controller that is silent for longer than the session's patience is gone, and may come back") {
  SessionOptions options;
  options.controller_timeout = 0.3;
  Session<float> session(block(), options);
  Controller mouse = session.connect("mouse");
  // However long a busy machine takes between two frames, it has said something just before each.
  const auto step_and_say_so = [&] {
    mouse.send(ask(Kind::alive));
    step(session, 1);
  };
  mouse.send(take_at(top));
  for (int i = 0; i < 2; ++i) step_and_say_so();
  for (int i = 0; i < 4; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    step_and_say_so();
  }
  CHECK(session.status()->hands.size() == 1);
  std::this_thread::sleep_for(std::chrono::milliseconds(350));
  step(session, 1);
  CHECK(session.status()->hands.empty());
  CHECK(times_said(session, "controller_gone", "silent for more than 0.3 s") == 1);
  mouse.send(take_at(top));
  for (int i = 0; i < 2; ++i) step_and_say_so();
  CHECK(session.status()->hands.size() == 1);
}

TEST_CASE("a hand whose tool an application lets go of is empty, which is said, and may take another") {
  Session<float> session(block());
  Controller mouse = session.connect("mouse"), leaves = session.connect("leaves");
  const auto take_away = [&](std::size_t hand) {
    session.world().apply(LetGo{session.status()->hands.at(hand).tool});
  };
  const Vec3d above = top + 2 * lift;
  mouse.send(take_at(top));
  leaves.send(bring_tool(1, above, BringCautery{"", 0.004, above}));
  step(session, 2);
  take_away(0);
  take_away(1);
  SUBCASE("it leads on") {
    mouse.send(lead_to(top + lift));
    leaves.send(turn_on(Kind::turn_on, true));
  }
  SUBCASE("it lets go") { mouse.send(ask(Kind::let_go)); }
  SUBCASE("its controller goes") { leaves = session.connect("another"); }
  step(session, 2);
  CHECK(session.status()->hands.empty());
  CHECK(messages(session).size() == 2);
  CHECK(times_said(session, "tool_gone", "hand 1 of mouse: its tool was let go of by the application") == 1);
  CHECK(times_said(session, "tool_gone", "hand 1 of leaves: its tool") == 1);
  mouse.send(take_at(top));
  step(session, 2);
  REQUIRE(session.status()->hands.size() == 1);
  CHECK(session.status()->hands[0].holds);
}

TEST_CASE("a grasp that is pulled at with more than the cap slips off, which is named") {
  const Setup setup = block();
  SessionOptions options;
  options.hand.force_cap = 1;
  options.hand.top_speed = 0.01;
  Session<float> session(setup, options);
  Controller mouse = session.connect("mouse");
  mouse.send(take_at(top));
  mouse.send(lead_to(top + 4 * lift));
  double strongest = 0;
  int frames = 0;
  for (; times_said(session, "slipped") == 0 && frames < 200; ++frames) {
    step(session, 1);
    for (const HandStatus& hand : session.status()->hands) strongest = std::max(strongest, hand.force.norm());
  }
  CHECK(frames > 5);
  CHECK(strongest > 0.3);
  CHECK(strongest <= 1);
  CHECK(times_said(session, "slipped", "hand 1 of mouse: it slipped off, pulled with") == 1);
  mouse.send(lead_to(top + 5 * lift));  // it has not noticed yet
  step(session, 100);
  CHECK(session.status()->hands.empty());
  CHECK(messages(session).size() == 1);
  for (const HeldVertices::Held& item : session.world().held().all())
    CHECK(item.holder == HeldVertices::boundary);
  CHECK(replays(session, setup));
}
