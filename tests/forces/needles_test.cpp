#include "lobe/forces/needles.h"

#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>

#include "joined_meshes.h"
#include "lobe/error.h"
#include "lobe/sim/checkpoint.h"
#include "near.h"
#include "needle_support.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;
using Tip = NeedlePassage::Tip;

namespace {

// A needle that no tool of the world moves. World::add() does not take the name of a kind that worlds make.
class LooseNeedles : public Needles<double> {
 public:
  std::string name() const override { return "loose needles"; }
};

struct Sewing {
  World<double> world;
  std::shared_ptr<LooseNeedles> needles = std::make_shared<LooseNeedles>();
  std::vector<PathPoint> path;
  NeedleSettings settings{{needle_radius, std::numbers::pi, 5e-4}, 0.2, 20};
  double goes = std::numeric_limits<double>::infinity();
  std::vector<NeedleBite> bites;

  Sewing(const Setup& setup, std::vector<PathPoint> way) : world(setup), path(std::move(way)) {
    world.add(needles);
  }
  void see(double duration) {
    const NeedleBody body{0, "needle", settings, path.front().time, goes, path};
    needles->see({&body, 1}, world.time(), world.time() + duration);
    for (const NeedleBite& bite : needles->take_bites()) bites.push_back(bite);
  }
  Report advance(double duration = needle_frame) {
    see(duration);
    const Report report = world.advance(duration);
    REQUIRE(report.ok);
    return report;
  }
  void step(double dt) {
    see(dt);
    REQUIRE(world.step(dt));
  }
  NeedleFigures now() const {
    const std::vector<NeedleFigures> all = needles->figures();
    return all.empty() ? NeedleFigures{} : all.front();
  }
  void run_until(double time) {
    while (world.time() < time - 1e-9) advance();
  }
  Vec3d rest(const EmbeddedPoint& point) const { return rest_position(point, world.elements()); }
  Vec3d place(const EmbeddedPoint& point) {
    return position(point, world.elements(), world.body().motion.u.padded());
  }
};

Setup rigid_block() {  // all of it is held
  Setup setup = sewn_block();
  setup.prescribed.clear();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) setup.prescribed.push_back({v});
  return setup;
}

// Two blocks side by side, with a gap of 2 mm between them.
Setup two_lips() {
  TetMesh right = box_mesh({0.019, 0.04, block_top}, 4, 8, 4);
  right.points.row(0).array() += 0.021;
  Setup setup = setup_of(joined(box_mesh({0.019, 0.04, block_top}, 4, 8, 4), right));
  setup.materials = sewn_block().materials;
  setup.damping = 40;
  setup.loose_pieces = LoosePieces::stay;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) setup.prescribed.push_back({v});
  return setup;
}

}  // namespace

TEST_CASE("a needle pushes at the surface until its force reaches the puncture force, and then enters") {
  Sewing sewing(sewn_block(), pushed_down(0.012, 0.3));
  double last = 0, most = 0;
  const double dt = 1e-4;
  int pushed = 0;
  while (sewing.now().tip != Tip::inside && sewing.world.time() < 0.3) {
    sewing.step(dt);
    const NeedleFigures now = sewing.now();
    if (now.tip != Tip::free) {
      ++pushed;
      last = most;
      most = std::max(most, now.pressed);
    }
    if (now.tip == Tip::pushing) CHECK(now.pressed < sewing.settings.puncture);
  }
  REQUIRE(sewing.now().tip == Tip::inside);
  CHECK(pushed > 100);
  CHECK(last < sewing.settings.puncture);
  CHECK(most >= sewing.settings.puncture);
  CHECK(most == near(sewing.settings.puncture, 0.05));
  CHECK(sewing.now().entries == 1);
  CHECK(std::abs(sewing.rest(sewing.now().holds.front()).z() - block_top) < 1e-12);
  // The surface springs back: what was pushed in goes along the needle.
  sewing.step(dt);
  CHECK(std::abs(sewing.now().force.z()) < 0.1 * sewing.settings.puncture);
}

TEST_CASE("in rigid tissue the torque of a needle is its radius times its friction times its length inside") {
  Sewing sewing(rigid_block(), turning(1, 2));
  double inside = 0, most = 0;
  int compared = 0, out = 0;
  const double entered = std::numbers::pi + std::asin(0.3);
  while (sewing.world.time() < 2 - 1e-9) {
    sewing.advance();
    const NeedleFigures now = sewing.now();
    const double phi = std::numbers::pi * (1 + sewing.world.time());  // of the tip
    const double torque = -now.torque.y();
    if (now.tip == Tip::inside && inside > 1e-4) {
      CHECK(torque == near(needle_radius * sewing.settings.friction * inside, 1e-9));
      CHECK(std::abs(now.inside - needle_radius * (phi - entered)) < 1e-4);
      ++compared;
    }
    if (now.tip == Tip::free && now.exits == 1 && inside > 1e-4 && now.pressed == 0) {
      CHECK(torque == near(needle_radius * sewing.settings.friction * inside, 1e-9));
      ++out;
    }
    inside = now.inside;
    most = std::max(most, inside);
  }
  CHECK(compared > 300);
  CHECK(out > 300);
  CHECK(most == near(needle_radius * (std::numbers::pi - 2 * std::asin(0.3)), 0.01));
  CHECK(sewing.now().inside == 0);
  CHECK(sewing.now().force.norm() == 0);
}

TEST_CASE("a needle that has gone through leaves its bites where its circle meets the surface") {
  Sewing sewing(rigid_block(), turning(1, 2));
  sewing.run_until(2);
  sewing.see(needle_frame);
  REQUIRE(sewing.bites.size() == 2);
  const double step = 2 * std::numbers::pi * needle_radius * needle_frame / 2;
  for (int i = 0; i < 2; ++i) {
    const Vec3d wanted(above_block.x() + (i == 0 ? -1 : 1) * half_chord, above_block.y(), block_top);
    CHECK((sewing.rest(sewing.bites[std::size_t(i)].point) - wanted).norm() < 2 * step);
  }
  CHECK(sewing.now().tip == Tip::free);
}

TEST_CASE("a needle that goes through both lips of a cut leaves four bites, from lip to lip") {
  Sewing sewing(two_lips(), turning(1, 2));
  sewing.run_until(2);
  sewing.see(needle_frame);
  REQUIRE(sewing.bites.size() == 4);
  const double deep = block_top + 0.003 - std::sqrt(needle_radius * needle_radius - 0.0013 * 0.0013),
               deep_right = block_top + 0.003 - std::sqrt(needle_radius * needle_radius - 0.0007 * 0.0007);
  const Vec3d wanted[] = {{above_block.x() - half_chord, above_block.y(), block_top},
                          {0.019, above_block.y(), deep},
                          {0.021, above_block.y(), deep_right},
                          {above_block.x() + half_chord, above_block.y(), block_top}};
  for (std::size_t i = 0; i < 4; ++i) CHECK((sewing.rest(sewing.bites[i].point) - wanted[i]).norm() < 2e-4);
}

TEST_CASE("soft tissue is sewn, too, and moves with the needle that is in it") {
  std::vector<PathPoint> path = turning(0.25, 0.5);
  const Vec3d aside(0, 0.003, 0);
  path.push_back(turned(0.8, above_block + aside, 1.5 * std::numbers::pi));
  Sewing sewing(sewn_block(), path);
  sewing.run_until(0.5);
  REQUIRE(sewing.now().tip == Tip::inside);
  const std::vector<EmbeddedPoint> holds = sewing.now().holds;
  CHECK(holds.size() >= 3);
  std::vector<Vec3d> before;
  for (const EmbeddedPoint& point : holds) before.push_back(sewing.place(point));
  sewing.run_until(0.8);
  REQUIRE(sewing.now().holds.size() >= holds.size());
  for (std::size_t i = 0; i < holds.size(); ++i) {
    const Vec3d now = sewing.place(sewing.now().holds[i]);
    CHECK(now.y() - above_block.y() - aside.y() == near(0, 1, 2e-4));
    CHECK(sewing.place(holds[i]).y() - before[i].y() == near(aside.y(), 0.05));
    const Vec3d arm = now - above_block - aside;
    CHECK(std::hypot(arm.x(), arm.z()) == near(needle_radius, 0.02));
  }
}

TEST_CASE("a needle through soft tissue leaves two bites on the surface") {
  Sewing sewing(sewn_block(), turning(1, 1));
  sewing.run_until(1);
  sewing.see(needle_frame);
  REQUIRE(sewing.bites.size() == 2);
  for (int i = 0; i < 2; ++i) {
    const Vec3d X = sewing.rest(sewing.bites[std::size_t(i)].point);
    CHECK(std::abs(X.z() - block_top) < 1e-9);
    CHECK(std::abs(X.x() - above_block.x() - (i == 0 ? -1 : 1) * half_chord) < 0.004);
  }
  CHECK(sewing.now().holds.empty());
}

TEST_CASE("a free lip that bends away is punctured from both sides, at the force along the needle") {
  // A plate stands on its lower edge. The needle goes through it from left to right.
  Setup setup = setup_of(box_mesh({0.008, 0.02, 0.02}, 4, 8, 8));
  setup.materials = sewn_block().materials;
  setup.damping = 40;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) == 0) setup.prescribed.push_back({v});
  Sewing sewing(setup, turning(1, 2, {0.005, 0.0098, 0.024}));
  sewing.settings.puncture = 0.05;
  sewing.settings.friction = 5;
  double bent = 0;
  std::vector<Event> events;
  while (sewing.world.time() < 1) {
    const Report report = sewing.advance();
    events.insert(events.end(), report.events.begin(), report.events.end());
    const NeedleFigures now = sewing.now();
    if (now.tip == Tip::pushing) bent = std::max(bent, (sewing.place(now.at) - sewing.rest(now.at)).x());
  }
  CHECK(bent > 0.004);
  REQUIRE(events.size() == 2);
  CHECK(events[0].kind == Event::Kind::punctured);
  CHECK(events[1].kind == Event::Kind::exited);
  for (const Event& event : events) {
    CHECK(event.size >= sewing.settings.puncture);
    CHECK(event.size == near(sewing.settings.puncture, 0.05));
  }
}

TEST_CASE("a needle that is drawn back out leaves nothing") {
  std::vector<PathPoint> path = pushed_down(0.01, 0.2);
  path.push_back({0.4, path.front().position, path.front().orientation});
  Sewing sewing(sewn_block(), path);
  bool was_inside = false;
  while (sewing.world.time() < 0.4 - 1e-9) {
    sewing.advance();
    was_inside = was_inside || sewing.now().tip == Tip::inside;
  }
  sewing.see(needle_frame);
  CHECK(was_inside);
  CHECK(sewing.now().tip == Tip::free);
  CHECK(sewing.now().holds.empty());
  CHECK(sewing.bites.empty());
  CHECK(sewing.needles->energy(sewing.world.body().here()) == 0);
}

TEST_CASE("a needle whose tip begins inside does nothing until it has come out and in again") {
  std::vector<PathPoint> path = pushed_down(0.005, 0.2);
  std::swap(path[0].position, path[1].position);
  Sewing sewing(sewn_block(), path);
  while (sewing.world.time() < 0.2 - 1e-9) {
    sewing.advance();
    CHECK(sewing.now().tip == Tip::free);
    CHECK(sewing.now().force.norm() == 0);
  }
}

TEST_CASE("a needle that goes takes its holds with it") {
  Sewing sewing(sewn_block(), turning(0.25, 0.5));
  sewing.goes = 0.45;
  sewing.run_until(0.44);
  CHECK(sewing.now().inside > 0.004);
  sewing.run_until(0.46);
  CHECK(sewing.now().holds.empty());
  CHECK(sewing.now().force.norm() == 0);
  sewing.needles->see({}, 0.46, 0.47);
  CHECK(sewing.needles->figures().empty());
}

TEST_CASE("a checkpoint in the middle of a stitch goes on with the same bits") {
  Sewing sewing(sewn_block(), turning(1, 1));
  for (const double time : {0.1, 0.3, 0.6}) {
    sewing.run_until(time);
    const Checkpoint<double> middle = sewing.world.save();
    const std::size_t bites = sewing.bites.size();
    sewing.run_until(time + 0.1);
    const State<double> state = sewing.world.state();
    const std::string needles = sewing.needles->save();
    sewing.world.restore(middle);
    sewing.bites.resize(bites);
    sewing.run_until(time + 0.1);
    CHECK(sewing.world.state().u == state.u);
    CHECK(sewing.world.state().v == state.v);
    CHECK(sewing.needles->save() == needles);
  }
}

TEST_CASE("saved needles that are damaged are refused") {
  Sewing sewing(sewn_block(), turning(1, 1));
  sewing.run_until(0.3);
  const std::string saved = sewing.needles->save();
  const Index vertices = sewing.world.elements().topology.vertex_count();
  LooseNeedles other;
  other.load(saved, vertices);
  CHECK(other.save() == saved);
  CHECK_THROWS_AS(other.load(saved.substr(0, saved.size() - 1), vertices), InputError);
  CHECK_THROWS_AS(other.load(saved + "x", vertices), InputError);
  CHECK_THROWS_AS(other.load(saved, 3), InputError);
  CHECK(other.save() == saved);
}

TEST_CASE("a needle in tissue changes no step") {
  const Setup setup = sewn_block();
  Sewing sewing(setup, turning(0.25, 0.5));
  sewing.run_until(0.5);
  REQUIRE(sewing.now().holds.size() >= 3);
  World<double> without(setup);
  without.set_state(sewing.world.state());
  CHECK(sewing.world.time_step_limit() == near(without.time_step_limit(), 1e-9));
}

TEST_CASE("the work of a needle is what the tissue has, and what friction and the puncture took") {
  Setup setup = sewn_block();
  setup.damping = 0;
  Sewing sewing(setup, pushed_down(0.012, 0.1));
  while (sewing.world.time() < 0.1 - 1e-9) sewing.step(5e-5);
  REQUIRE(sewing.now().tip == Tip::inside);
  const NeedleLedger& ledger = sewing.needles->ledger();
  const double has = sewing.world.energies().total();
  CHECK(ledger.friction > 0);
  CHECK(ledger.puncture > 0);
  CHECK(ledger.hand > 1e-5);
  CHECK(ledger.hand == near(has + ledger.friction + ledger.puncture, 0.02));
}

TEST_CASE("a needle stays in what is left of tissue that is cut away around it") {
  Sewing sewing(sewn_block(), turning(1, 1));
  sewing.run_until(0.3);
  const auto cut_at = [&](const EmbeddedPoint& point) { sewing.world.apply(RemoveTets{{point.tet}}); };
  const std::size_t holds = sewing.now().holds.size();
  REQUIRE(holds >= 4);
  cut_at(sewing.now().holds.front());
  CHECK(sewing.now().holds.size() < holds);
  CHECK(sewing.now().entries == 1);
  CHECK(sewing.now().tip == Tip::inside);
  for (const EmbeddedPoint& point : sewing.now().holds)
    CHECK(exists(point, sewing.world.elements().topology));
  sewing.run_until(0.35);
  cut_at(sewing.now().at);
  CHECK(sewing.now().tip == Tip::free);
  sewing.run_until(0.5);
  CHECK(fault_of(sewing.world) == "");
}
