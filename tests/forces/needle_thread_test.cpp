// Threads that needles draw through tissue.
#include <doctest/doctest.h>

#include <string>

#include "lobe/error.h"
#include "lobe/sim/checkpoint.h"
#include "near.h"
#include "needle_support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// On needle 1. Its bites lie nowhere.
Thread thread_on_needle(const std::vector<double>& spans, double tail, double length) {
  Thread thread;
  thread.number = 3;
  thread.is_sewn = true;
  thread.bites.resize(spans.size() + 1);
  for (std::size_t i = 0; i < thread.bites.size(); ++i) thread.bites[i].number = Index(i);
  for (const double span : spans) thread.spans.emplace_back().length = span;
  thread.hand.holds = true;
  thread.hand.needle = 1;
  thread.hand.tail.length = tail;
  thread.length = length;
  REQUIRE(thread.is_valid());
  return thread;
}

// A stitch in half a second. Then the needle goes up by a height until 0.8 s, comes back until 1 s, goes up
// again, by another height, until 1.3 s, and stays.
Setup drawn_by_needle(double up, double again, double length) {
  const auto above = [](double time, double height) {
    return turned(time, above_block + Vec3d(0, 0, height), 3 * std::numbers::pi);
  };
  std::vector<PathPoint> path = turning(1, 0.5);
  path.insert(path.end(), {above(0.8, up), above(1, 0), above(1.3, again), above(1.4, again)});
  Setup setup = sewn_block();
  setup.needles = {half_circle_needle(path)};
  setup.needles[0].thread_length = length;
  return setup;
}

Vec3d place_of_bite(World<double>& world, std::size_t bite) {
  return position(sewn_thread(world).bites[bite].point, world.elements(), Mat3X<double>(world.state().u));
}

bool has_event(const std::vector<Event>& events, Event::Kind kind) {
  return std::any_of(events.begin(), events.end(), [&](const Event& event) { return event.kind == kind; });
}

}  // namespace

// ---- The thread alone

TEST_CASE("a needle draws what is slack next to it first, and the rest from the thread's free end") {
  Thread thread = thread_on_needle({0.02, 0.03}, 0.01, 0.2);
  const std::vector<double> ways = {0.01, 0.01};
  CHECK(thread.runs_through());
  CHECK(thread.free_length() == near(0.14, 1e-15));
  CHECK(thread.draw_through(0.025, ways) == -1);
  CHECK(thread.hand.tail.length == near(0.025, 1e-15));
  CHECK(thread.spans[1].length == near(0.015, 1e-15));
  CHECK(thread.spans[0].length == near(0.02, 1e-15));
  CHECK(thread.free_length() == near(0.14, 1e-15));
  CHECK(thread.draw_through(0.05, ways) == -1);
  CHECK(thread.spans[1].length == near(0.01, 1e-15));
  CHECK(thread.spans[0].length == near(0.01, 1e-15));
  CHECK(thread.free_length() == near(0.13, 1e-14));
  CHECK(thread.draw_through(0.02, ways) == -1);  // it comes back: the thread does not
  CHECK(thread.hand.tail.length == near(0.05, 1e-15));
  CHECK(thread.free_length() == near(0.13, 1e-14));
}

TEST_CASE("a thread that is drawn further than it is long leaves its bites, the first one first") {
  const std::vector<double> ways = {0.01, 0.01};
  Thread thread = thread_on_needle({0.01, 0.01}, 0.01, 0.2);
  CHECK(thread.draw_through(0.185, ways) == 0);
  REQUIRE(thread.bites.size() == 2);
  CHECK(thread.bites[0].number == 1);
  CHECK(thread.free_length() == near(0.005, 1e-14));
  CHECK(thread.is_valid());
  CHECK(thread.draw_through(0.3, {0.01}) == 2);
  CHECK(thread.bites.empty());
  CHECK(!thread.is_on_needle());
  CHECK(thread.length == 0.2);
  CHECK(thread.is_valid());
}

TEST_CASE("a knot fixes the thread of a needle, and what is behind a cut is free again") {
  Thread thread = thread_on_needle({0.02, 0.03, 0.04}, 0.01, 0.3);
  thread.tie(0, 1, 0.01, 0, 0);
  CHECK(thread.is_on_needle());
  CHECK(!thread.runs_through());
  CHECK(thread.may_be_taut());
  thread.cut_after(1);
  CHECK(thread.first_on_needle() == 2);
  CHECK(thread.runs_through());
  CHECK(thread.length == near(0.03 + 0.04 + 0.01, 1e-15));
  CHECK(thread.free_length() == near(0.03, 1e-15));
  thread.cut_after(3);  // behind the last bite: it is on the needle, but in no tissue
  CHECK(!thread.is_on_needle());
  CHECK(thread.length == 0.01);
  CHECK(thread.bites.size() == 4);
  CHECK(thread.is_valid());
}

TEST_CASE("a needle loses its thread with the last bite behind a cut, not with one before") {
  Thread thread = thread_on_needle({0.02, 0.03}, 0.01, 0.3);
  thread.cut_after(1);
  CHECK(thread.first_on_needle() == 2);
  thread.remove_bite(0);
  CHECK(thread.is_on_needle());
  CHECK(thread.first_on_needle() == 1);
  thread.remove_bite(1);
  CHECK(!thread.is_on_needle());
  CHECK(thread.bites.size() == 1);
  CHECK(thread.is_valid());
}

// ---- In a world

TEST_CASE("a thread follows its needle through the tissue by the way that it goes, and pulls at nothing") {
  World<double> world(drawn_by_needle(0.06, 0, 0.2));
  play_frames(world, 80);
  const double bend = (place_of_bite(world, 1) - place_of_bite(world, 0)).norm();
  double way = (sewn_thread(world).hand.to - place_of_bite(world, 1)).norm();
  CHECK(way > 0.055);
  CHECK(sewn_thread(world).is_on_needle());
  CHECK(sewn_thread(world).hand.tail.length == near(way, 1e-6));
  CHECK(sewn_thread(world).free_length() == near(0.2 - way - bend, 1e-5));
  const double left = sewn_thread(world).free_length();
  play_frames(world, 20);
  way = (sewn_thread(world).hand.to - place_of_bite(world, 1)).norm();
  CHECK(sewn_thread(world).hand.tail.length - way > 0.03);  // slack
  CHECK(sewn_thread(world).free_length() == near(left, 1, 1e-6));
  CHECK(sewn_thread(world).spans[0].tension == 0);
  CHECK(sewn_thread(world).hand.tail.tension == 0);
  CHECK(term_of<Threads>(world.body().terms)->ledger().hand == 0);
  CHECK(thread_lines(world).size() == 1);
  CHECK(thread_lines(world)[0].points.cols() == 3);  // two bites and the needle's end
}

TEST_CASE("behind a knot the thread of a needle is taut, and the needle feels its tension") {
  Setup setup = drawn_by_needle(0.06, 0.062, 0.2);
  setup.needles[0].ties = {{0, 1, 1.0, 0.002, 0.05}};
  World<double> world(setup);
  play_frames(world, 115);
  REQUIRE(sewn_thread(world).knots.size() == 1);
  CHECK(sewn_thread(world).is_on_needle());
  CHECK(sewn_thread(world).spans[0].tension > 0);
  CHECK(sewn_thread(world).hand.tail.tension == 0);
  const auto behind_knot = [&] { return sewn_thread(world).hand.tail.length; };
  const double before = behind_knot();
  play_frames(world, 25);
  const Thread& thread = sewn_thread(world);
  const double tension = thread.hand.tail.tension;
  CHECK(tension > 0.05);
  CHECK(behind_knot() == near(before, 1e-12));
  const Vec3d way = thread.hand.to - place_of_bite(world, 1);
  CHECK(way.norm() - behind_knot() == near(tension * behind_knot() / 98, 0.02));
  const PlacedTool needle = placed_tools(world).front();
  CHECK(needle.force.norm() == near(tension, 0.15));  // the mean of a frame
  CHECK(needle.force.dot(way) > 0.99 * needle.force.norm() * way.norm());
}

TEST_CASE("the end of a thread that is drawn too far leaves its bites, with an event of each") {
  World<double> world(drawn_by_needle(0.06, 0, 0.03));
  const std::vector<Event> events = play_frames(world, 80);
  CHECK(has_event(events, Event::Kind::drawn_out));
  CHECK(sewn_thread(world).bites.empty());
  CHECK(!sewn_thread(world).hand.holds);
  CHECK(sewn_thread(world).length == 0.03);
  for (const Event& event : events) {
    if (event.kind != Event::Kind::drawn_out) continue;
    REQUIRE(event.place);
    CHECK(std::abs(event.place->z() - block_top) < 0.004);
    CHECK(event.text.find("thread \"3\" was drawn too far") == 0);
  }
}

TEST_CASE("a needle goes on with what is left of its thread after that was cut") {
  std::vector<PathPoint> path = turning(1, 0.5);
  const Vec3d beside(0, 0.005, 0);
  path.push_back(turned(0.65, above_block + Vec3d(0, 0, 0.06), 3 * std::numbers::pi));
  for (PathPoint row : turning(1, 0.5, above_block + beside)) {
    row.time += 0.8;
    path.push_back(row);
  }
  Setup setup = sewn_block();
  setup.needles = {half_circle_needle(path)};
  World<double> world(setup);
  play_frames(world, 80);
  world.apply(Tie{3, 0, 1, 0.002, 0.02});
  world.apply(CutThread{3, 1});
  const double left = sewn_thread(world).length;  // what was drawn through
  CHECK(left > 0.055);
  CHECK(left < 0.07);
  CHECK(!sewn_thread(world).is_on_needle());
  play_frames(world, 55);
  const Thread& thread = sewn_thread(world);
  REQUIRE(thread.bites.size() == 4);
  CHECK(thread.knots.size() == 1);
  CHECK(thread.spans[1].is_cut);
  CHECK(thread.first_on_needle() == 2);
  CHECK(thread.length == left);
  CHECK(thread.runs_through());
  CHECK(thread.free_length() > 0.02);
}

TEST_CASE("a needle that is taken away leaves its thread in the tissue") {
  World<double> world(sewn_block());
  const std::vector<PathPoint> way = turning(1, 0.5);
  world.apply(brought_needle(way.front()));
  for (int i = 0; i < 52; ++i) {
    const double time = std::min(0.5, (i + 1) * sewing_frame);
    world.apply(Lead{1, {path_at(way, time), orientation_at(way, time)}});
    REQUIRE(world.advance(sewing_frame).ok);
  }
  REQUIRE(sewn_thread(world).bites.size() == 2);
  const auto fault = [&](const Command& command) -> std::string {
    try {
      world.apply(command);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  CHECK(fault(Pull{3, true, Vec3d(0, 0, 0.1)}).find("is on a needle, which draws it") != std::string::npos);
  CHECK(fault(Bite{3, {0, Eigen::Vector4d::Constant(0.25)}}).find("is on a needle") != std::string::npos);
  world.apply(LetGo{1});
  play_frames(world, 3);
  CHECK(sewn_thread(world).bites.size() == 2);
  CHECK(!sewn_thread(world).hand.holds);
  CHECK(fault(Pull{3, true, Vec3d(0.02, 0.02, 0.03)}) == "");
  play_frames(world, 1);
  CHECK(sewn_thread(world).hand.holds);
}

TEST_CASE_TEMPLATE("a thread on a needle goes on from a checkpoint with the same bits", Real, float, double) {
  Setup setup = drawn_by_needle(0.03, 0.032, 0.2);
  setup.needles[0].ties = {{0, 1, 1.0, 0.002, 0.05}};
  World<Real> world(setup);
  for (const int frames : {60, 45, 20}) {  // drawn through, tied, taut
    play_frames(world, frames);
    const Checkpoint<Real> middle = world.save();
    World<Real> restored(setup);
    restored.restore(middle);
    CHECK(term_of<Threads>(restored.body().terms)->save() == term_of<Threads>(world.body().terms)->save());
    play_frames(world, 5);
    play_frames(restored, 5);
    CHECK(same_bits(restored, world));
    CHECK(term_of<Threads>(restored.body().terms)->save() == term_of<Threads>(world.body().terms)->save());
    CHECK(term_of<Needles>(restored.body().terms)->save() == term_of<Needles>(world.body().terms)->save());
  }
}
