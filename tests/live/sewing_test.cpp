#include "lobe/live/sewing.h"

#include <cmath>
#include <map>

#include "folder.h"
#include "live/hands_support.h"
#include "lobe/error.h"
#include "lobe/forces/embedded.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double lips = 0.02;  // place of the slit along x [m]

// A soft block that hangs at x = 0 and is pulled at its other end, with a slit to half of its depth.
// `pairs`: vertices of both lips, that coincide at rest.
Setup slit_block(std::vector<std::pair<Index, Index>>& pairs) {
  TetMesh mesh = box_mesh({0.04, 0.04, 0.02}, 6, 6, 4);
  const Index before = mesh.vertex_count();
  std::map<Index, Index> copies;
  for (Index v = 0; v < before; ++v)
    if (std::abs(mesh.points(0, v) - lips) < 1e-9 && mesh.points(2, v) > 0.01 + 1e-9)
      copies.emplace(v, before + Index(copies.size()));
  mesh.points.conservativeResize(3, before + Index(copies.size()));
  for (const auto& [v, copy] : copies) mesh.points.col(copy) = mesh.points.col(v);
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    if (barycentre(mesh, t).x() < lips) continue;
    for (Index& v : mesh.tets.col(t))
      if (const auto copy = copies.find(v); copy != copies.end()) v = copy->second;
  }
  pairs.assign(copies.begin(), copies.end());
  Setup setup = setup_of(mesh);
  setup.materials = {{2885, 1923, 1000}};  // E = 5 kPa, ν = 0.3
  setup.damping = 40;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (mesh.points(0, v) == 0) setup.prescribed.push_back({v});
    if (mesh.points(0, v) > 0.04 - 1e-9) setup.vertex_loads.push_back({v, {0.002, 0, 0}});
  }
  return setup;
}

double gap(Session<float>& session, const std::vector<std::pair<Index, Index>>& pairs) {
  const auto u = session.world().displacements();
  double sum = 0;
  for (const auto& [left, right] : pairs) sum += double(u(0, right) - u(0, left));
  return sum / double(pairs.size());
}

// A session in which a hand sews.
struct Sewn {
  explicit Sewn(const Setup& setup, const HandLimits& limits = {})
      : session(setup),
        controller(session.connect("surgeon")),
        needle(
            session, [this](HandCommand command) { return controller.send(command); }, limits) {}

  // A thread with a bite below each of two places on top of the block at rest.
  void sew(int thread, const Vec3d& a, const Vec3d& b, const ThreadMaterial& material = {}) {
    REQUIRE(needle.bring(thread, material));
    for (const Vec3d& x : {a, b})
      REQUIRE(needle.bite_below(thread, Vec3d(x.x(), x.y(), 1), {0, 0, -1}, depth));
  }
  const Thread& thread(std::size_t i = 0) {
    const Threads<float>* threads = term_of<Threads>(session.world().body().terms);
    REQUIRE(threads);
    REQUIRE(threads->all().size() > i);
    return threads->all()[i];
  }
  double pull() { return thread().hand.head.tension + thread().hand.tail.tension; }

  static constexpr double depth = 0.006;  // [m]
  Session<float> session;
  Controller controller;
  Sewing<float> needle;
};

const Vec3d left{0.0143, 0.02, 0.02}, right{0.0257, 0.02, 0.02}, above{0.02, 0.02, 0.035};  // [m]

template <class Work>
std::string fault_of_sewing(const Work& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("three stitches sewn by hand close a slit as those of a scene do") {
  std::vector<std::pair<Index, Index>> pairs;
  const Setup open = slit_block(pairs);
  Setup planned = open;
  constexpr double tighten = 0.00025, over = 0.2;  // [m], [s]
  const double places[] = {0.04 / 6, 0.02, 0.2 / 6};
  for (const double y : places) {
    StitchSetup& stitch = planned.stitches.emplace_back();
    for (const Vec3d& x : {left, right}) {
      const FoundPoint found = embed(Locator(open.mesh), {x.x(), y, x.z() - Sewn::depth});
      REQUIRE(found.distance < 1e-9);
      stitch.bites.push_back(found.point);
    }
    stitch.ties = {{0, 1, 0, tighten, over}};
  }
  Session<float> unsewn(open), scene(planned);
  Sewn hand(open);
  for (int i = 0; i < 3; ++i) {
    hand.sew(i, {left.x(), places[i], left.z()}, {right.x(), places[i], right.z()});
    REQUIRE(hand.needle.tie(i, 0, -1, tighten, over));
  }
  for (Session<float>* session : {&unsewn, &scene, &hand.session}) step(*session, 120);
  CHECK(messages(hand.session).size() <= 1);  // frames that were run again
  const double widest = gap(unsewn, pairs), left_open = gap(scene, pairs);
  MESSAGE("gap ", widest * 1e3, " mm, sewn ", left_open * 1e3, " mm, by hand ",
          gap(hand.session, pairs) * 1e3, " mm");
  CHECK(std::abs(left_open) < 0.25 * widest);
  CHECK(gap(hand.session, pairs) == near(left_open, 1e-3, widest));
  CHECK(replays(hand.session, open));
}

TEST_CASE("a hand draws a thread up, ties it and tightens the knot; a replay has the same bits") {
  std::vector<std::pair<Index, Index>> pairs;
  const Setup setup = slit_block(pairs);
  Sewn hand(setup);
  step(hand.session, 40);
  const double open = gap(hand.session, pairs);
  hand.sew(7, left, right);
  REQUIRE(hand.needle.pull(7, above));
  step(hand.session, 5);
  CHECK(hand.thread().hand.holds);
  CHECK(hand.pull() < 1e-3);  // its ends are straight, and pull at nothing yet
  const Vec3d from = hand.thread().hand.to;
  CHECK((from - above).norm() < 1e-12);
  REQUIRE(hand.needle.pull(7, above + Vec3d(0, 0, 0.004)));
  step(hand.session, 3);
  CHECK((hand.thread().hand.to - from).norm() < 0.5 * 3 * hand.session.frame());  // no faster than a hand
  step(hand.session, 60);
  CHECK((hand.thread().hand.to - from).norm() == near(0.004, 1e-3));
  CHECK(hand.pull() > 0.01);
  const double drawn = gap(hand.session, pairs);
  CHECK(drawn < open);
  REQUIRE(hand.needle.tie(7, 0, -1));
  step(hand.session, 40);
  CHECK_FALSE(hand.thread().hand.holds);
  REQUIRE(hand.thread().knots.size() == 1);
  CHECK(hand.thread().knots[0].closing.tension > 0);
  const double tied = gap(hand.session, pairs);
  CHECK(tied < open);
  REQUIRE(hand.needle.tie(7, 0, -1, 0.003, 0.1));  // the same knot
  step(hand.session, 60);
  CHECK(hand.thread().knots.size() == 1);
  CHECK(gap(hand.session, pairs) < tied - 0.0005);
  REQUIRE(hand.needle.remove(7));
  step(hand.session, 80);
  CHECK(hand.thread().knots.empty());
  CHECK(thread_lines(hand.session.world()).empty());
  CHECK(gap(hand.session, pairs) == near(open, 0.05));
  CHECK(times_said(hand.session, "refused") == 0);
  CHECK(replays(hand.session, setup, 2));
}

TEST_CASE("a session that is saved in the middle of a stitch goes on with the same bits, its hand empty") {
  std::vector<std::pair<Index, Index>> pairs;
  const Setup setup = slit_block(pairs);
  const Folder folder;
  const std::filesystem::path file = folder.path / "saved.lobe";
  Sewn first(setup), second(setup), third(setup);
  first.sew(0, left, right);
  REQUIRE(first.needle.pull(0, above));
  step(first.session, 2);
  REQUIRE(first.needle.pull(0, above + Vec3d(0, 0, 0.004)));
  step(first.session, 10);
  REQUIRE(first.pull() > 0);
  first.session.save(file);
  step(third.session, 7);
  for (Sewn* sewn : {&second, &third}) {
    sewn->session.restore(file);
    step(sewn->session, 3);
    CHECK_FALSE(sewn->thread().hand.holds);
    REQUIRE(sewn->needle.pull(0, above));
    REQUIRE(sewn->needle.tie(0, 0, 1, 0.002, 0.05));
    step(sewn->session, 10);
    CHECK(sewn->thread().knots.size() == 1);
  }
  CHECK(same_bits(second.session.world(), third.session.world()));
  CHECK(replays(second.session, setup));
  first.session.restore(file);  // what its hand has sent before comes later, and is taken back
  step(first.session, 3);
  CHECK_FALSE(first.thread().hand.holds);
}

TEST_CASE("going back takes back a bite, and a hand that pulled then holds nothing") {
  std::vector<std::pair<Index, Index>> pairs;
  const Setup setup = slit_block(pairs);
  Sewn hand(setup);
  step(hand.session, 3);
  hand.needle.bring(0, {});
  hand.needle.bite_at(0, {0.01, 0.02, 0.012});
  step(hand.session, 2);
  const double before = hand.session.world().time();
  hand.needle.bite_at(0, {0.03, 0.02, 0.012});
  step(hand.session, 4);
  hand.needle.pull(0, above);
  step(hand.session, 4);
  CHECK(hand.thread().bites.size() == 2);
  hand.controller.send(ask_for(Kind::back, hand.session.world().time() - before));
  step(hand.session, 2);
  CHECK(hand.session.world().time() == before + 2 * hand.session.frame());
  CHECK(hand.thread().bites.size() == 1);
  CHECK_FALSE(hand.thread().hand.holds);
  hand.controller.send(ask(Kind::restart));
  step(hand.session, 2);
  CHECK(thread_lines(hand.session.world()).empty());
  CHECK(times_said(hand.session, "refused") == 0);
  CHECK(replays(hand.session, setup));
}

TEST_CASE("a hand pulls on until the ends pull with a force, and lets slip what pulls harder") {
  std::vector<std::pair<Index, Index>> pairs;
  const Setup setup = slit_block(pairs);
  Sewn hand(setup, {.force_cap = 0.2});
  hand.sew(0, left, right, {.friction = 0});
  CHECK(fault_of_sewing([&] {
          hand.needle.pull_on(0, {0, 0, 1}, 0.1, 0.02);
        }) == "thread 0: is in no hand: pull it to a point first");
  REQUIRE(hand.needle.pull(0, above));
  REQUIRE(hand.needle.pull_on(0, {0, 0, 2}, 0.1, 0.02));
  step(hand.session, 10);
  CHECK((hand.thread().hand.to - above).norm() < 0.02 * 11 * hand.session.frame());
  step(hand.session, 150);
  CHECK(hand.pull() == near(0.1, 0.03));
  REQUIRE(hand.needle.pull_on(0, {0, 0, 1}, 5, 0.1));
  step(hand.session, 60);
  CHECK(times_said(hand.session, "slipped", "thread 0 slipped out of the hand, pulled with 0.2") == 1);
  CHECK_FALSE(hand.thread().hand.holds);
  CHECK(replays(hand.session, setup));
}

TEST_CASE("a thread that pulls harder than the tissue holds tears out, which the session says") {
  std::vector<std::pair<Index, Index>> pairs;
  Sewn hand(slit_block(pairs));
  hand.sew(0, left, right, {.holds = 0.05});
  REQUIRE(hand.needle.pull(0, above));
  step(hand.session, 1);
  REQUIRE(hand.needle.pull(0, above + Vec3d(0, 0, 0.03)));
  step(hand.session, 120);
  CHECK(times_said(hand.session, "torn", "thread \"0\" has torn out of the tissue at bite") >= 1);
}

TEST_CASE("a thread is found near the ray that shows it") {
  std::vector<std::pair<Index, Index>> pairs;
  Sewn hand(slit_block(pairs));
  hand.sew(3, left, right);
  step(hand.session, 1);
  const auto at = [&](double x, double y) {
    return thread_near(hand.session.world(), {x, y, 1}, {0, 0, -1}, 0.002);
  };
  CHECK(at(0.02, 0.021).thread == 3);
  CHECK(at(0.02, 0.021).after == 0);
  CHECK(at(0.02, 0.021).distance == near(0.001, 0.05));
  CHECK(at(0.02, 0.023).thread == -1);
  CHECK(at(0.01, 0.02).thread == -1);
  const ThreadPart behind = thread_near(hand.session.world(), {0.02, 0.02, 1}, {0, 0, 1}, 0.002);
  CHECK(behind.thread == -1);
  CHECK(fault_of_sewing([&] {
          hand.needle.cut_near({0.01, 0.02, 1}, {0, 0, -1}, 0.002);
        }) == "thread: is shown a place where none passes within 0.002 m");
  REQUIRE(hand.needle.cut_near({0.02, 0.021, 1}, {0, 0, -1}, 0.002));
  step(hand.session, 1);
  CHECK(hand.thread().spans[0].is_cut);
  CHECK(at(0.02, 0.021).thread == -1);
}

TEST_CASE("what cannot be sewn is named") {
  std::vector<std::pair<Index, Index>> pairs;
  const Setup setup = slit_block(pairs);
  Sewn hand(setup);
  hand.needle.bring(0, {});
  const auto fault_at = [&](const Vec3d& x) { return fault_of_sewing([&] { hand.needle.bite_at(0, x); }); };
  const auto fault_below = [&](const Vec3d& from, const Vec3d& along, double depth) {
    return fault_of_sewing([&] { hand.needle.bite_below(0, from, along, depth); });
  };
  CHECK(
      fault_at({0.01, 0.02, 0.025}) ==
      "thread: passes a point that is 0.005 m outside of every tetrahedron: a thread passes through tissue");
  CHECK(
      fault_below({0.01, 0.02, 1}, {0, 0, -1}, 0.03) ==
      "thread: passes 0.03 m below the surface, which is 0.01 m outside of the tissue: it is thinner there");
  CHECK(fault_below({0.1, 0.02, 1}, {0, 0, -1}, 0.003) ==
        "thread: is shown a place where there is no tissue");
  CHECK(fault_below({0.01, 0.02, 1}, {0, 0, 0}, 0.003).find("direction other than 0") != std::string::npos);
  CHECK(fault_below({0.01, 0.02, 1}, {0, 0, -1}, 0).find("more than 0 m") != std::string::npos);
  CHECK(fault_at({0.01, std::nan(""), 0.01}).find("not finite") != std::string::npos);
  CHECK(fault_of_sewing([&] { hand.needle.remove(9); }) == "thread 9: there is none of this number");

  // Of what the world then refuses there are messages.
  const auto refuses = [&](const std::string& why) {
    step(hand.session, 1);
    const SessionMessage last = messages(hand.session).back();
    CHECK(last.name == "refused");
    CHECK(last.text.find(why) != std::string::npos);
  };
  hand.needle.pull(0, above);
  refuses("passes no tissue yet: it cannot be pulled");
  hand.needle.tie(0, 0, -1);
  refuses("thread \"0\": passes no tissue");
  hand.needle.bite_at(0, {0.01, 0.02, 0.012});
  hand.needle.tie(0, 0, -1);
  refuses("has 1 bite: a knot is between two of them");
  hand.needle.bite_at(0, {0.03, 0.02, 0.012});
  hand.needle.tie(0, 0, 5);
  refuses("has no bite 5");
  hand.needle.tie(0, -3, 1);
  refuses("has no bite -3");
  hand.needle.tie(0, 0, 1, 0.021);
  refuses("more than half of its loop");
  hand.needle.bring(0, {});
  refuses("there is one of this number already");
  hand.needle.bite_at(4, {0.03, 0.02, 0.012});
  refuses("thread 4: there is none of this number");
  hand.needle.cut(0, 0);
  hand.needle.tie(0, 0, 1);
  refuses("what is cut cannot be tied");
  CHECK(replays(hand.session, setup));
}
