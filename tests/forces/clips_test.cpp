// Clips on a duct: a box of 24 × 4 × 4 mm along x, held where x = 0, in which something flows.
#include "lobe/forces/clips.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "lobe/error.h"
#include "lobe/mesh/generators.h"
#include "lobe/mesh/joined_mesh.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/rebuild.h"
#include "near.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double duct_width = 0.004, clip_frame = 0.02;  // [m], [s]
const Vec3d duct_middle{0, 0.002, 0.002};                // of its section

Setup duct_setup(Carries carries = Carries::bile) {
  Setup setup;
  append_body(box_mesh({0.024, duct_width, duct_width}, 12, 2, 2), "duct", setup.mesh);
  setup.materials = {{.lambda = 2e4, .mu = 1e4, .density = 1000}};
  setup.material_of.assign(std::size_t(setup.mesh.tet_count()), 0);
  setup.region_of.assign(std::size_t(setup.mesh.tet_count()), RegionModel::nonlinear);
  setup.damping = 40;
  CarrierSetup carrier{0, carries, {}};
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) == 0) {
      setup.prescribed.push_back({v});
      carrier.fed.push_back(v);
    }
  setup.carriers = {carrier};
  return setup;
}

constexpr ClipShape clip_shape{.length = 0.0063, .opening = 0.006, .gap = 0.0026};

// Across the duct: its legs along y.
PathPoint clip_at(double time, double x) {
  const double half = std::sqrt(0.5);
  return {time, duct_middle + Vec3d(x, 0, 0), {0, 0, half, half}};
}

// The tetrahedra of a slice of the box that is 2 mm long.
RemoveTets slice_of(const Setup& setup, double from) {
  RemoveTets slice;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (const double x = barycentre(setup.mesh, t).x(); x > from && x < from + 0.002) slice.tets.push_back(t);
  return slice;
}

template <class Real>
std::vector<Event> frames_of(World<Real>& world, int frames) {
  std::vector<Event> events;
  for (int i = 0; i < frames; ++i) {
    const Report report = world.advance(clip_frame);
    REQUIRE(report.ok);
    events.insert(events.end(), report.events.begin(), report.events.end());
  }
  return events;
}

std::vector<Event> events_of(const std::vector<Event>& events, Event::Kind kind) {
  std::vector<Event> found;
  for (const Event& event : events)
    if (event.kind == kind) found.push_back(event);
  return found;
}

}  // namespace

TEST_CASE("a clip draws the walls together to its gap, and says so") {
  Setup setup = duct_setup();
  setup.clip_appliers = {{"clip", clip_shape, {clip_at(0.05, 0.009)}}};
  World<double> world(setup);
  const std::vector<Event> events = frames_of(world, 40);
  REQUIRE(events.size() == 1);
  CHECK(events[0].kind == Event::Kind::clipped);
  CHECK(events[0].time == near(0.04, 1e-9));
  CHECK(events[0].size == near(duct_width, 1e-3));
  CHECK(events[0].text == "clip \"clip\" closes on 4 mm of tissue");
  const std::vector<ClipFigures> clips = clip_figures(world);
  REQUIRE(clips.size() == 1);
  CHECK(clips[0].pairs == 10);  // 5 of 9 rays along the legs meet the duct, at both sides of the middle
  CHECK(clips[0].apart > clip_shape.gap);
  CHECK(clips[0].apart < 1.2 * clip_shape.gap);
  // Springs of the same stiffness: their forces lie between those of the least and of the largest distance.
  CHECK(clips[0].force > 0);
  CHECK(clips[0].force <= clip_shape.stiffness * (clips[0].apart - clip_shape.gap) * (1 + 1e-12));
  CHECK(term_lines(world).size() == 1);
}

TEST_CASE("forces of a clip are the slope of its energy, and have no sum") {
  Setup setup = duct_setup();
  setup.clip_appliers = {{"clip", clip_shape, {clip_at(0, 0.009)}}};
  World<double> world(setup);
  frames_of(world, 3);
  auto& clips = static_cast<Clips<double>&>(*world.body().terms.front());
  const auto at = world.body().here();
  Mat3X<double> f = Mat3X<double>::Zero(3, at.u.cols()), u = at.u;
  clips.add_forces(at, f);
  CHECK(f.norm() > 0);
  CHECK(f.rowwise().sum().norm() < 1e-12 * f.norm());
  constexpr double step = 1e-8;  // [m]
  for (const Index v : clips.acts_on(at.model)) {
    const auto energy = [&](double by) {
      u(2, v) = at.u(2, v) + by;
      return clips.energy({at.model, u, at.v, at.time});
    };
    const double slope = (energy(step) - energy(-step)) / (2 * step);
    u(2, v) = at.u(2, v);
    CHECK(std::abs(f(2, v) + slope) < 1e-6 * f.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("a duct that is cut through leaks at its fed end, with the area of the cut") {
  for (const Carries carries : {Carries::bile, Carries::blood}) {
    const Setup setup = duct_setup(carries);
    World<float> world(setup);
    CHECK(frames_of(world, 2).empty());
    world.apply(slice_of(setup, 0.012));
    const std::vector<Event> events = frames_of(world, 5);
    REQUIRE(events.size() == 1);
    CHECK(events[0].kind == (carries == Carries::blood ? Event::Kind::bleeding : Event::Kind::leak));
    CHECK(events[0].time == near(2 * clip_frame, 1e-9));
    CHECK(events[0].size == near(duct_width * duct_width, 1e-9));
    CHECK(events[0].text == (carries == Carries::blood ? "\"duct\" bleeds" : "\"duct\" leaks bile"));
    REQUIRE(events[0].place);
    CHECK((*events[0].place - duct_middle - Vec3d(0.012, 0, 0)).norm() < 1e-5);
    REQUIRE(carrier_figures(world).size() == 1);
    CHECK(carrier_figures(world)[0].open == near(duct_width * duct_width, 1e-9));
  }
}

TEST_CASE("a clip stops what flows where it is between the source and the cut, and all across") {
  struct Case {
    const char* what;
    double x, length;
    bool leaks;
  };
  for (const auto& [what, x, length, leaks] :
       {Case{"before the cut", 0.007, 0.006, false}, Case{"behind the cut", 0.019, 0.006, true},
        Case{"on a half of the section", 0.007, 0.0016, true}}) {
    CAPTURE(what);
    Setup setup = duct_setup();
    ClipShape clip = clip_shape;
    clip.length = length;
    setup.clip_appliers = {{"clip", clip, {clip_at(0, x)}}};
    World<float> world(setup);
    std::vector<Event> events = frames_of(world, 20);
    CHECK(events_of(events, Event::Kind::clipped).size() == 1);
    world.apply(slice_of(setup, 0.012));
    events = frames_of(world, 3);
    CHECK(events_of(events, Event::Kind::leak).size() == std::size_t(leaks));
    CHECK((carrier_figures(world)[0].open > 0) == leaks);
  }
}

TEST_CASE("a clip that comes late ends a leak, and one that is burnt away lets it begin") {
  Setup setup = duct_setup();
  setup.clip_appliers = {{"clip", clip_shape, {clip_at(0.1, 0.007)}}};
  World<float> world(setup);
  world.apply(slice_of(setup, 0.014));
  CHECK(events_of(frames_of(world, 3), Event::Kind::leak).size() == 1);
  frames_of(world, 20);
  CHECK(carrier_figures(world)[0].open == 0);
  world.apply(slice_of(setup, 0.006));
  const std::vector<Event> events = frames_of(world, 2);
  CHECK(clip_figures(world)[0].pairs == 0);
  REQUIRE(events_of(events, Event::Kind::leak).size() == 1);
  CHECK(events[0].size == near(duct_width * duct_width, 1e-9));
}

TEST_CASE("what a scalpel opens leaks") {
  Setup setup = duct_setup();
  ScalpelSetup scalpel;
  scalpel.path = {{0, {0.013, -0.002, -0.002}}, {0.2, {0.013, 0.006, -0.002}}};
  scalpel.heels = {{0.013, -0.002, 0.006}, {0.013, 0.006, 0.006}};
  setup.scalpels = {scalpel};
  World<float> world(setup);
  const std::vector<Event> events = events_of(frames_of(world, 12), Event::Kind::leak);
  REQUIRE(!events.empty());
  CHECK(!events[0].text.empty());
  for (std::size_t i = 1; i < events.size(); ++i) {
    CHECK(events[i].text.empty());
    CHECK(events[i].size > events[i - 1].size);
  }
  // While it is not cut through, both sides of the cut are fed.
  CHECK(events.back().size < 2 * duct_width * duct_width);
  CHECK(carrier_figures(world)[0].open == near(duct_width * duct_width, 0.02));
}

TEST_CASE("a clip on nothing is a condition of the report") {
  Setup setup = duct_setup();
  setup.clip_appliers = {{"loose", clip_shape, {clip_at(0, 0.05)}}};
  World<float> world(setup);
  const Report report = world.advance(clip_frame);
  CHECK(report.events.empty());
  REQUIRE(report.conditions.size() == 1);
  CHECK(report.conditions[0].kind == Condition::Kind::clip);
  CHECK(report.conditions[0].text.find("\"loose\" has closed on nothing") != std::string::npos);
  CHECK(clip_figures(world).empty());
}

TEST_CASE_TEMPLATE("a hand's clips, as paths and from a checkpoint while one closes, give the same bits",
                   Real, float, double) {
  World<Real> hand(duct_setup());
  std::vector<std::string> states;
  const auto play = [&](World<Real>& world, int from, int to) {
    constexpr ToolId applier = 1;
    for (int i = from; i < to; ++i) {
      const PathPoint at = clip_at(0, 0.007 + 0.001 * (i / 3));
      if (i == 1) world.apply(BringClipApplier{"clip", clip_shape, at.position, at.orientation});
      if (i > 1 && i < 12) world.apply(Lead{applier, {at.position, at.orientation}});
      if (i == 3 || i == 9) world.apply(SwitchTool{applier, true});
      if (i == 6) world.apply(SwitchTool{applier, false});
      if (i == 12) world.apply(LetGo{applier});
      REQUIRE(world.advance(clip_frame).ok);
    }
  };
  play(hand, 0, 6);
  const Checkpoint<Real> middle_of_closing = hand.save();
  play(hand, 6, 20);
  CHECK(clip_figures(hand).size() == 2);
  World<Real> restored(duct_setup());
  restored.restore(middle_of_closing);
  play(restored, 6, 20);
  CHECK(restored.state().u == hand.state().u);
  Setup setup = duct_setup();
  static_cast<ToolSetups&>(setup) = hand.tools().paths();
  REQUIRE(setup.clip_appliers.size() == 1);
  REQUIRE(setup.clip_appliers[0].path.size() == 2);
  World<Real> played(setup);
  for (int i = 0; i < 20; ++i) REQUIRE(played.advance(clip_frame).ok);
  CHECK(played.state().u == hand.state().u);
  CHECK(clip_figures(played).size() == 2);
}

TEST_CASE("a clipped and cut body is equal to one that is built of what is left") {
  Setup setup = duct_setup();
  setup.clip_appliers = {{"clip", clip_shape, {clip_at(0, 0.007)}}};
  World<double> world(setup);
  frames_of(world, 20);
  world.apply(slice_of(setup, 0.012));
  frames_of(world, 2);
  CHECK(compare_with_rebuilt(world).largest() < 1e-9);
}

TEST_CASE("clips and carriers that make no sense are refused by name") {
  const auto fault = [](const Setup& setup) -> std::string {
    try {
      World<float> world(setup);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const auto expect = [&](const auto& change, const char* text) {
    Setup setup = duct_setup();
    change(setup);
    CAPTURE(fault(setup));
    CHECK(fault(setup).find(text) != std::string::npos);
  };
  expect(
      [](Setup& s) {
        s.clip_appliers = {{"wide", {0.006, 0.002, 0.003}, {clip_at(0, 0.01)}}};
      },
      "\"wide\" needs a gap that is smaller than its opening");
  expect([](Setup& s) { s.clip_appliers = {{"none", {}, {clip_at(0, 0.01)}}}; }, "above 0, and finite");
  expect([](Setup& s) { s.clip_appliers = {{"still", clip_shape, {}}}; }, "has no path");
  expect([](Setup& s) { s.carriers[0].fed.clear(); }, "needs vertices of the mesh at which it comes in");
  expect([](Setup& s) { s.carriers[0].body = 1; }, "there is no body 1");
  expect([](Setup& s) { s.carriers.push_back(s.carriers[0]); }, "carries something twice");
  World<float> world(duct_setup());
  CHECK_THROWS_AS(world.apply(BringClipApplier{"clip", {0.006, 0.002, 0.003}}), InputError);
  CHECK_THROWS_AS(world.apply(BringClipApplier{"clip", clip_shape, Vec3d::Constant(std::nan(""))}),
                  InputError);
}
