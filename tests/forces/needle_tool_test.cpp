// Needles that are tools of a world, and the threads that follow them.
#include <doctest/doctest.h>

#include <string>

#include "lobe/error.h"
#include "lobe/organ/kinds_of_terms.h"
#include "lobe/sim/checkpoint.h"
#include "near.h"
#include "needle_support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Setup sewn_by_needle(double duration = 0.5) {
  Setup setup = sewn_block();
  setup.needles = {half_circle_needle(turning(1, duration))};
  return setup;
}

}  // namespace

TEST_CASE("a thread follows the needle of a scene through its two bites, and is tied") {
  World<double> world(sewn_by_needle());
  CHECK(!term_of<Threads>(world.body().terms));
  play_frames(world, 30);
  REQUIRE(needle_figures(world).size() == 1);
  CHECK(needle_figures(world).front().inside > 0.005);
  play_frames(world, 25);
  const Thread& thread = sewn_thread(world);
  CHECK(thread.number == 3);
  CHECK(thread.material.holds == 1.5);
  REQUIRE(thread.bites.size() == 2);
  for (int i = 0; i < 2; ++i) {
    const Vec3d X = rest_position(thread.bites[std::size_t(i)].point, world.elements());
    CHECK(std::abs(X.z() - block_top) < 1e-9);
    CHECK(std::abs(X.x() - above_block.x() - (i == 0 ? -1 : 1) * half_chord) < 0.004);
  }
  CHECK(needle_figures(world).front().inside == 0);
  world.apply(Tie{3, 0, 1, 0.002, 0.05});
  play_frames(world, 10);
  CHECK(sewn_thread(world).spans[0].tension > 0);
  CHECK(fault_of(world) == "");
}

TEST_CASE("the force and torque of a needle are those on its tool") {
  World<double> world(sewn_by_needle());
  play_frames(world, 18);
  const std::vector<PlacedTool> tools = placed_tools(world);
  REQUIRE(tools.size() == 1);
  CHECK(std::string(tools[0].type) == "needle");
  const NeedleFigures now = needle_figures(world).front();
  REQUIRE(now.tip == NeedlePassage::Tip::inside);
  CHECK(-tools[0].torque.y() > 0.5 * needle_radius * 20 * now.inside);
  CHECK(tools[0].force.norm() > 0);
}

TEST_CASE_TEMPLATE("a hand's needle, as a path and from a checkpoint in mid-stitch, gives the same bits",
                   Real, float, double) {
  const std::vector<PathPoint> way = turning(1, 0.5);
  const auto play = [&](World<Real>& world, int from, int to) {
    for (int i = from; i < to; ++i) {
      if (i == 2) world.apply(brought_needle(way.front()));
      if (i > 2 && i < 52) {
        const double time = (i - 2) * sewing_frame;
        world.apply(Lead{1, {path_at(way, time), orientation_at(way, time)}});
      }
      if (i == 54) world.apply(LetGo{1});
      REQUIRE(world.advance(sewing_frame).ok);
    }
  };
  World<Real> hand(sewn_block());
  play(hand, 0, 30);
  const Checkpoint<Real> middle = hand.save();
  const double inside = needle_figures(hand).front().inside;
  CHECK(inside > 0.003);
  play(hand, 30, 58);
  CHECK(sewn_thread(hand).bites.size() == 2);
  World<Real> restored(sewn_block());
  restored.restore(middle);
  CHECK(needle_figures(restored).front().inside == inside);
  play(restored, 30, 58);
  CHECK(same_bits(restored, hand));
  CHECK(sewn_thread(restored).bites.size() == 2);

  Setup setup = sewn_block();
  static_cast<ToolSetups&>(setup) = hand.tools().paths();
  REQUIRE(setup.needles.size() == 1);
  CHECK(setup.needles[0].thread == 3);
  World<Real> played(setup);
  play_frames(played, 58);
  CHECK(same_bits(played, hand));
  CHECK(sewn_thread(played).bites.size() == 2);
}

TEST_CASE("a hand that lets a needle go in mid-stitch leaves no needle in the tissue, and no bite") {
  World<double> world(sewn_block());
  const std::vector<PathPoint> way = turning(1, 0.5);
  world.apply(brought_needle(way.front()));
  for (int i = 0; i < 25; ++i) {
    const double time = (i + 1) * sewing_frame;
    world.apply(Lead{1, {path_at(way, time), orientation_at(way, time)}});
    REQUIRE(world.advance(sewing_frame).ok);
  }
  CHECK(needle_figures(world).front().inside > 0.003);
  world.apply(LetGo{1});
  play_frames(world, 3);
  CHECK(needle_figures(world).empty());
  CHECK(!term_of<Threads>(world.body().terms));
}

TEST_CASE("a needle without a thread leaves none") {
  Setup setup = sewn_by_needle();
  setup.needles[0].thread.reset();
  World<double> world(setup);
  play_frames(world, 55);
  CHECK(needle_figures(world).front().inside == 0);
  CHECK(!term_of<Threads>(world.body().terms));
}

TEST_CASE("a needle alone makes no contact") {
  World<double> world(sewn_by_needle());
  play_frames(world, 28);
  for (const auto& term : world.body().terms) CHECK(term->name() != "contact");
}

TEST_CASE("the thread of a needle is another than those of the scene's stitches") {
  Setup setup = sewn_by_needle();
  StitchSetup stitch;
  stitch.name = "of the scene";
  stitch.bites = {{0, Eigen::Vector4d::Constant(0.25)}, {1, Eigen::Vector4d::Constant(0.25)}};
  setup.stitches = {stitch};
  World<double> world(setup);
  play_frames(world, 55);
  const Threads<double>* threads = term_of<Threads>(world.body().terms);
  REQUIRE(threads);
  REQUIRE(threads->all().size() == 2);
  CHECK(threads->all()[0].name == "of the scene");
  CHECK(threads->all()[1].number == 3);
  CHECK(threads->all()[1].bites.size() == 2);
}

TEST_CASE("needles that make no sense are refused by name") {
  const auto fault = [](const auto& change) -> std::string {
    Setup setup = sewn_by_needle();
    change(setup, setup.needles[0]);
    try {
      World<double> world(setup);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const auto names = [&](const std::string& text, const auto& change) {
    CAPTURE(fault(change));
    CHECK(fault(change).find(text) != std::string::npos);
  };
  CHECK(fault([](Setup&, NeedleSetup&) {}) == "");
  names("\"needle\" needs a radius above 0 m", [](Setup&, NeedleSetup& n) { n.settings.shape.radius = 0; });
  names("needs a puncture force above 0 N", [](Setup&, NeedleSetup& n) { n.settings.puncture = 0; });
  names("needs a friction of at least 0 N/m", [](Setup&, NeedleSetup& n) { n.settings.friction = -1; });
  names("needs a thickness", [](Setup&, NeedleSetup& n) { n.settings.shape.thickness = 0.02; });
  names("has a thread of a number below 0", [](Setup&, NeedleSetup& n) { n.thread = -1; });
  names("needs a stiffness above 0 N", [](Setup&, NeedleSetup& n) { n.material.stiffness = 0; });
  names("has no path", [](Setup&, NeedleSetup& n) { n.path.clear(); });
  names("implicit", [](Setup& s, NeedleSetup&) { s.integrator = Integrator::generalised_alpha; });

  World<double> world(sewn_block());
  BringNeedle needle = brought_needle(turned(0, above_block, 3));
  needle.settings.puncture = std::nan("");
  CHECK_THROWS_AS(world.apply(needle), InputError);
  needle = brought_needle(turned(0, above_block, 3));
  needle.pose.orientation *= 2;
  CHECK_THROWS_AS(world.apply(needle), InputError);
}

// ---- What is around it

TEST_CASE("needles and then threads come after all other terms, since they predict the motion") {
  const std::span<const KindOfTerm<double>> kinds = kinds_of_terms<double>();
  REQUIRE(kinds.size() > 3);
  CHECK(kinds[kinds.size() - 2].name == Needles<double>::term_name);
  CHECK(kinds[kinds.size() - 1].name == Threads<double>::term_name);
  for (std::size_t i = 0; i < kinds.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) CHECK(kinds[i].name != kinds[k].name);
}

TEST_CASE("a world without needles has no term of them") {
  World<double> world(sewn_block());
  play_frames(world, 2);
  CHECK(world.body().terms.empty());
  CHECK(needle_figures(world).empty());
}

TEST_CASE_TEMPLATE("a needle tells where its tip goes in and comes out, with its force", Real, float,
                   double) {
  World<Real> world(sewn_by_needle());
  std::vector<Event> events = play_frames(world, 55);
  std::erase_if(events, [](const Event& event) { return event.kind == Event::Kind::drawn_out; });
  REQUIRE(events.size() == 2);
  CHECK(std::string(name(events[0].kind)) == "punctured");
  CHECK(std::string(name(events[1].kind)) == "exited");
  CHECK(events[0].text.find("needle \"needle\" has gone in, at 0.2") == 0);
  for (int i = 0; i < 2; ++i) {
    CHECK(events[std::size_t(i)].size >= 0.2);
    CHECK(events[std::size_t(i)].size == near(0.2, 0.1));
    REQUIRE(events[std::size_t(i)].place);
    const Vec3d place = *events[std::size_t(i)].place;
    CHECK((i == 0 ? place.x() < above_block.x() : place.x() > above_block.x()));
    CHECK(std::abs(place.z() - block_top) < 0.004);
    CHECK(events[std::size_t(i)].time > (i == 0 ? 0.02 : 0.2));
  }
}

TEST_CASE_TEMPLATE("a needle goes on where a blade or a cautery cuts beside it", Real, float, double) {
  Setup setup = sewn_by_needle();
  SUBCASE("a blade between its entry and its tip") {
    ScalpelSetup scalpel;
    scalpel.path = {{0.2, {0.0167, -0.01, 0.012}}, {0.3, {0.0167, 0.05, 0.012}}};
    scalpel.heels = {{0.0167, -0.01, 0.03}, {0.0167, 0.05, 0.03}};
    setup.scalpels = {scalpel};
  }
  SUBCASE("a cautery beside it") {
    CauterySetup cautery;
    cautery.radius = 0.001;
    cautery.path = {{0.2, {0.0155, 0.022, 0.019}}, {0.3, {0.0155, 0.03, 0.019}}};
    setup.cauteries = {cautery};
  }
  SUBCASE("a cautery on its way") {
    CauterySetup cautery;
    cautery.radius = 0.002;
    cautery.path = {{0.15, {0.014, 0.02, 0.016}}, {0.4, {0.03, 0.02, 0.016}}};
    setup.cauteries = {cautery};
  }
  World<Real> world(setup);
  play_frames(world, 22);
  const Checkpoint<Real> middle = world.save();
  double cut = 0;  // tetrahedra, and area [m²]
  for (int i = 0; i < 36; ++i) {
    const Report report = world.advance(sewing_frame);
    REQUIRE(report.ok);
    cut += report.tets_removed + report.cut_area;
    for (const NeedleFigures& needle : needle_figures(world))
      for (const EmbeddedPoint& hold : needle.holds) REQUIRE(exists(hold, world.elements().topology));
  }
  CHECK(cut > 0);
  CHECK(fault_of(world) == "");
  CHECK(needle_figures(world).front().inside == 0);
  if (const Threads<Real>* threads = term_of<Threads>(world.body().terms))
    for (const ThreadBite& bite : threads->all().front().bites)
      CHECK(exists(bite.point, world.elements().topology));
  World<Real> restored(setup);
  restored.restore(middle);
  play_frames(restored, 36);
  CHECK(same_bits(restored, world));
}

TEST_CASE("everything may be cut away while a needle is in it, and the needle be taken away after that") {
  World<double> world(sewn_block());
  const std::vector<PathPoint> way = turning(1, 0.5);
  world.apply(brought_needle(way.front()));
  const auto go_on = [&](int from, int to) {
    for (int i = from; i < to; ++i) {
      const double time = (i + 1) * sewing_frame;
      world.apply(Lead{1, {path_at(way, time), orientation_at(way, time)}});
      REQUIRE(world.advance(sewing_frame).ok);
    }
  };
  go_on(0, 25);
  REQUIRE(needle_figures(world).front().inside > 0.003);
  std::vector<Index> all(std::size_t(world.elements().topology.tet_count()));
  for (std::size_t t = 0; t < all.size(); ++t) all[t] = Index(t);
  world.apply(RemoveTets{all});
  CHECK(needle_figures(world).front().inside == 0);
  CHECK(needle_figures(world).front().holds.empty());
  go_on(25, 30);
  CHECK(needle_figures(world).front().force.norm() == 0);
  world.apply(LetGo{1});
  play_frames(world, 3);
  CHECK(needle_figures(world).empty());
  CHECK(fault_of(world) == "");
}

TEST_CASE("outside of steps the forces of a needle are those of its last step, wherever the tissue is") {
  World<double> world(sewn_by_needle());
  play_frames(world, 25);
  Needles<double>* needles = term_of<Needles>(world.body().terms);
  REQUIRE(needles);
  const auto forces_at = [&](const Mat3X<double>& u) {
    const ForceTerm<double>::At here = world.body().here();
    Mat3X<double> f = Mat3X<double>::Zero(3, u.cols());
    needles->add_forces({here.model, u, here.v, here.time}, f);
    return f;
  };
  const Mat3X<double> u = world.body().here().u;
  const Mat3X<double> f = forces_at(u), moved = forces_at(u + Mat3X<double>::Constant(3, u.cols(), 1e-3));
  CHECK(f.norm() > 0);
  CHECK(f == moved);
  CHECK((f.rowwise().sum() - needle_figures(world).front().force).norm() < 1e-12);
}

TEST_CASE("single steps sew, too") {
  World<double> world(sewn_by_needle());
  const double dt = 2e-4;
  while (world.time() < 0.55) REQUIRE(world.step(dt));
  CHECK(sewn_thread(world).bites.size() == 2);
}
