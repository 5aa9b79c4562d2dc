// What a world says of blades that are unfit, or that cannot cut all that they meet.
#include <doctest/doctest.h>

#include "lobe/sim/checkpoint.h"
#include "lobe/sim/validate.h"
#include "near.h"
#include "strokes.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A bar along x at rest, whose cells are cubes of 10 mm.
Setup bar() {
  Setup setup = setup_of(box_mesh({0.12, 0.03, 0.03}, 12, 3, 3));
  setup.materials = {{8e5, 2e5, 1000}};
  return setup;
}

// A blade at x, from y = 0.0132 on, that falls through the bar.
ScalpelSetup falling(double length, double x = 0.0632, double seconds = 0.4) {
  const Vec3d high(x, 0.0132, 0.05), low(x, 0.0132, -0.03), edge(0, length, 0);
  return {"blade", 0.1, {{0.03, high}, {0.03 + seconds, low}}, {high + edge, low + edge}};
}

struct Seen {
  int narrow = 0, far = 0, crumbs = 0, waiting = 0, frames = 0;
  double area = 0;
  std::vector<std::string> texts;
};

void look(const Report& report, Seen& seen) {
  CHECK(report.ok);
  ++seen.frames;
  seen.area += report.cut_area;
  for (const Condition& c : report.conditions) {
    if (c.kind != Condition::Kind::scalpel) continue;
    seen.texts.push_back(c.text);
    const auto has = [&](const char* part) { return c.text.find(part) != std::string::npos; };
    seen.narrow += has("is shorter than the edges");
    seen.far += has("more than three mean edges");
    seen.crumbs += has("crumbs stay attached");
    seen.waiting += has("32 other blades cut");
  }
}

Seen after(World<double>& world, int frames, double frame = 1.0 / 30) {
  Seen seen;
  for (int i = 0; i < frames; ++i) look(world.advance(frame), seen);
  validate(world);
  return seen;
}

Seen after(const Setup& setup, int frames, double frame = 1.0 / 30) {
  World<double> world(setup);
  return after(world, frames, frame);
}

}  // namespace

TEST_CASE("a blade that is narrower than the tetrahedra that it meets is named once") {
  Setup setup = bar();
  setup.scalpels = {falling(0.002)};
  const Seen one = after(setup, 18);
  CHECK(one.narrow == 1);
  CHECK(one.texts.size() == 1);
  CHECK(one.texts[0].find("a blade of 0.002 m") == 0);
  CHECK(one.area == 0);
  setup.scalpels = {falling(0.002), falling(0.003, 0.0332)};  // each of two
  CHECK(after(setup, 18).narrow == 2);
  setup.scalpels = {falling(0.03)};
  CHECK(after(setup, 18).texts.empty());
  setup.scalpels = {falling(0.002, 0.2)};  // which meets nothing
  CHECK(after(setup, 18).texts.empty());
}

TEST_CASE("how long edges are is asked where the blade is") {
  Setup setup = bar();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {  // cells of 1.3 to 19 mm
    double& x = setup.mesh.points(0, v);
    x = 0.01 * x / 0.12 + 0.11 * std::pow(x / 0.12, 2);
  }
  const double mean = Grains(Elements(setup)).mean_edge();
  setup.scalpels = {falling(0.0115, 0.005)};
  CHECK(setup.scalpels[0].heels[0].y() - 0.0132 < mean);
  CHECK(after(setup, 18).narrow == 0);
  setup.scalpels = {falling(0.0115, 0.11)};
  CHECK(after(setup, 18).narrow == 1);
}

TEST_CASE("a blade that goes far in a frame is named once, if it cuts") {
  Setup setup = bar();
  const double mean = Grains(Elements(setup)).mean_edge();
  setup.scalpels = {falling(0.03, 0.0632, 0.08 / (3.1 * mean * 30))};
  CHECK(after(setup, 6).far == 1);
  setup.scalpels = {falling(0.03, 0.0632, 0.08 / (2.9 * mean * 30))};
  CHECK(after(setup, 6).far == 0);
  const Vec3d above(0.0632, 0.0132, 0.035), below = above - Vec3d(0, 0, 2 * mean),
                                            beside = below + Vec3d(2 * mean, 0, 0), edge(0, 0.03, 0);
  setup.scalpels = {{"blade",
                     0.1,
                     {{0.001, above}, {0.016, below}, {0.031, beside}},  // two rows in the same frame
                     {above + edge, below + edge, beside + edge}}};
  CHECK(after(setup, 2).far == 1);
  setup.scalpels = {falling(0.03, 0.2, 0.01)};
  CHECK(after(setup, 6).far == 0);
}

TEST_CASE("what is unfit in a hand is named once until the hand lets go") {
  World<double> world(bar());
  for (int turn = 1; turn <= 2; ++turn) {
    const ToolId id = world.tools().next_id();
    const Vec3d high(0.03 * turn, 0.0132, 0.06), down(0, 0, -0.08), edge(0, 0.004, 0);
    world.apply(BringScalpel{"blade", {high, high + edge}, 0.1});
    Seen seen;
    for (int stroke = 0; stroke < 3; ++stroke) {
      world.apply(SwitchTool{id, true});
      for (int i = 0; i < 4; ++i) {  // to and fro
        world.apply(Lead{id, {i % 2 == 0 ? Vec3d(high + down) : high}});
        look(world.advance(1.0 / 30), seen);
      }
      world.apply(SwitchTool{id, false});
    }
    CHECK(seen.narrow == 1);
    CHECK(seen.far == 1);
    CHECK(seen.texts.size() == 2);
    world.apply(LetGo{id});
    look(world.advance(1.0 / 30), seen);
  }
}

TEST_CASE("a world that was restored has the same bits, and says again what is unfit") {
  Setup setup = bar();
  setup.scalpels = {falling(0.002)};
  World<double> world(setup), other(setup);
  CHECK(after(world, 6).narrow == 1);
  other.restore(world.save());
  CHECK(after(world, 9).narrow == 0);
  CHECK(after(other, 9).narrow == 1);
  CHECK(world.state().u == other.state().u);
  CHECK(world.grains()->count() == other.grains()->count());
}

// A plane x + y + z = a cuts a³/6 off the corner of the bar, and a tetrahedron has 1/6 of the cube of 10 mm.
TEST_CASE(
    "a part below a thousandth of a tetrahedron stays attached, which is said; a larger one comes off") {
  for (const double a : {0.0007, 0.002}) {
    Setup setup = bar();
    const Vec3d along = Vec3d(1, -1, 0).normalized(), middle = Vec3d::Constant(a / 3),
                edge = 0.008 * Vec3d(1, 1, -2).normalized();
    const auto tip = [&](double x) { return Vec3d(middle + x * along - edge); };
    setup.scalpels = {{"blade",
                       0.02,
                       {{0.01, tip(-0.01)}, {0.11, tip(0.01)}},
                       {tip(-0.01) + 2 * edge, tip(0.01) + 2 * edge}}};
    World<double> world(setup);
    const Seen seen = after(world, 6);
    const bool is_crumb = a < 0.001;
    CHECK((seen.crumbs > 0) == is_crumb);
    CHECK(world.elements().topology.pieces().size() == (is_crumb ? 1 : 2));
    CHECK(world.grains()->count() > setup.mesh.tet_count());
    double volume = 0;
    for (Index t = 0; t < world.elements().topology.tet_count(); ++t) volume += world.elements().volume(t);
    CHECK(volume == near(1.08e-4, 1e-12));
  }
}

TEST_CASE("a blade waits while 32 others cut, which is said in each frame, and goes on when they are done") {
  Setup setup = bar();
  setup.scalpels.assign(32, falling(0.03, 0.2, 0.2));  // beside the bar
  CHECK(after(setup, 10).waiting == 0);
  setup.scalpels.push_back(falling(0.03, 0.0632, 0.8));
  World<double> world(setup);
  const Seen busy = after(world, 6), free = after(world, 20);
  CHECK(busy.waiting == busy.frames);
  CHECK(busy.area == 0);
  CHECK(free.waiting == 2);  // the others end in its first frame, and do not go on in its second
  CHECK(free.area > 3e-4);
}
