#include "lobe/forces/threads.h"

#include <doctest/doctest.h>

#include <cmath>
#include <map>

#include "joined_meshes.h"
#include "lobe/error.h"
#include "lobe/mesh/outer_faces.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/rebuild.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double thread_frame = 0.01;
const Elastic soft{2885, 1923, 1000};  // E = 5 kPa, ν = 0.3

TetMesh moved(TetMesh mesh, const Vec3d& by) {
  mesh.points.colwise() += by;
  return mesh;
}

EmbeddedPoint at(const Setup& setup, const Vec3d& X) {
  const FoundPoint found = embed(Locator(setup.mesh), X);
  REQUIRE(found.distance < 1e-9);
  return found.point;
}

StitchSetup stitch(const Setup& setup, const std::vector<Vec3d>& through, double friction = 0) {
  StitchSetup made;
  made.name = "3-0";
  made.material.friction = friction;
  for (const Vec3d& X : through) made.bites.push_back(at(setup, X));
  return made;
}

// A block of soft tissue, held at the bottom.
Setup block(int n = 4) {
  Setup setup = setup_of(box_mesh({0.04, 0.04, 0.02}, n, n, n / 2));
  setup.materials = {soft};
  setup.damping = 40;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) == 0) setup.prescribed.push_back({v});
  return setup;
}

const Threads<double>& threads_of(World<double>& world) {
  const Threads<double>* threads = term_of<Threads>(world.body().terms);
  REQUIRE(threads);
  return *threads;
}

// Forces of one term on the vertices now [N].
Mat3X<double> forces_of(World<double>& world, const std::string& term_name) {
  Mat3X<double> f = Mat3X<double>::Zero(3, world.body().motion.u.padded().cols());
  for (const auto& term : world.body().terms)
    if (term->name() == term_name) term->add_forces(world.body().here(), f);
  return f;
}

int run(World<double>& world, double duration, std::vector<Event>* said = nullptr) {
  int steps = 0;
  for (int i = 0; i < int(std::lround(duration / thread_frame)); ++i) {
    const Report report = world.advance(thread_frame);
    REQUIRE(report.ok);
    steps += report.steps;
    if (said) said->insert(said->end(), report.events.begin(), report.events.end());
  }
  return steps;
}

bool has_said(const std::vector<Event>& said, Event::Kind kind, const std::string& text) {
  for (const Event& event : said)
    if (event.kind == kind && event.text.find(text) != std::string::npos) return true;
  return false;
}

std::string refusal(World<double>& world, const Command& command) {
  try {
    world.apply(command);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// Two blocks that touch nowhere, 1 mm apart. The left one is held.
Setup two_blocks() {
  Setup setup = setup_of(joined(box_mesh({0.02, 0.02, 0.02}, 3, 3, 3),
                                moved(box_mesh({0.02, 0.02, 0.02}, 3, 3, 3), {0.021, 0, 0})));
  setup.materials = {soft};
  setup.damping = 60;
  setup.loose_pieces = LoosePieces::stay;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) == 0) setup.prescribed.push_back({v});
  return setup;
}

// A block of soft tissue, held at x = 0; with or without a slit at x = 20 mm to half of its depth.
Setup slit_block(bool has_slit) {
  TetMesh mesh = box_mesh({0.04, 0.04, 0.02}, 12, 6, 6);
  if (has_slit) {
    std::map<Index, Index> copies;
    const Index before = mesh.vertex_count();
    for (Index v = 0; v < before; ++v)
      if (std::abs(mesh.points(0, v) - 0.02) < 1e-9 && mesh.points(2, v) > 0.01 + 1e-9)
        copies.emplace(v, before + Index(copies.size()));
    mesh.points.conservativeResize(3, before + Index(copies.size()));
    for (const auto& [v, copy] : copies) mesh.points.col(copy) = mesh.points.col(v);
    for (Index t = 0; t < mesh.tet_count(); ++t) {
      if (barycentre(mesh, t).x() < 0.02) continue;
      for (Index& v : mesh.tets.col(t))
        if (const auto copy = copies.find(v); copy != copies.end()) v = copy->second;
    }
  }
  Setup setup = setup_of(mesh);
  setup.materials = {soft};
  setup.damping = 60;
  setup.contact.self = has_slit;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.points(0, v) == 0) setup.prescribed.push_back({v});
  return setup;
}

// Of a pull on the face at x = 40 mm [N], in equal parts on its vertices.
SetForces pull_at_end(const Setup& setup, double force) {
  SetForces pull;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) > 0.04 - 1e-9) pull.forces.push_back({v, {force, 0, 0}});
  for (VertexLoad& load : pull.forces) load.force /= double(pull.forces.size());
  return pull;
}

double mean_end(World<double>& world, const Setup& setup) {  // how far that face has moved [m]
  double sum = 0;
  const SetForces pull = pull_at_end(setup, 1);
  for (const VertexLoad& load : pull.forces) sum += world.displacements()(0, load.vertex);
  return sum / double(pull.forces.size());
}

}  // namespace

TEST_CASE("a slit that three stitches close is as stiff as a block without one, under a small load") {
  const double load = 20 * 0.04 * 0.02;  // [N], 20 Pa
  const Setup whole = slit_block(false), open = slit_block(true);
  double longer[3];
  for (int i = 0; i < 3; ++i) {
    Setup setup = i == 0 ? whole : open;
    if (i == 2)
      for (const double y : {0.04 / 6, 0.02, 0.2 / 6}) {
        setup.stitches.push_back(stitch(
            setup, {{0.0143, y, 0.0199}, {0.0143, y, 0.014}, {0.0257, y, 0.014}, {0.0257, y, 0.0199}}));
        setup.stitches.back().ties = {{0, 3, 0, 0.002, 0.4}};
      }
    World<double> world(setup);
    run(world, 1.2);
    const double before = mean_end(world, setup);
    world.apply(pull_at_end(setup, load));
    run(world, 0.8);
    longer[i] = mean_end(world, setup) - before;
  }
  MESSAGE("longer by ", longer[0] * 1e3, " mm, open ", longer[1] / longer[0], ", sewn ",
          longer[2] / longer[0]);
  CHECK(longer[1] > 1.5 * longer[0]);
  CHECK(longer[2] == near(longer[0], 0.05));
}

TEST_CASE("a weight on a thread between two bites pulls with T = W / (2 sin alpha)") {
  // A cube hangs below a plate that is held.
  Setup setup = setup_of(joined(moved(box_mesh({0.06, 0.01, 0.004}, 6, 1, 1), {-0.03, -0.005, 0.03}),
                                moved(box_mesh({0.01, 0.01, 0.01}, 2, 2, 2), {-0.005, -0.005, 0})));
  setup.materials = {{4e4, 4e4, 1000}};
  setup.damping = 40;
  setup.gravity = {0, 0, -9.81};
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) > 0.02) setup.prescribed.push_back({v});
  setup.stitches = {stitch(setup, {{-0.025, 0, 0.032}, {0, 0, 0.008}, {0.025, 0, 0.032}})};
  setup.stitches[0].ties = {{0, 2, 0, 0, 0}};
  World<double> world(setup);
  run(world, 1.2);
  const std::vector<ThreadLine> lines = thread_lines(world);
  REQUIRE(lines.size() == 2);  // the thread, and what the knot has closed
  const Vec3d a = lines[0].points.col(0), b = lines[0].points.col(1), c = lines[0].points.col(2);
  const double sines = (a - b).normalized().z() + (c - b).normalized().z();
  const double weight = 9.81 * 1000 * 1e-6;
  REQUIRE(lines[0].tensions.size() == 2);
  for (const double tension : lines[0].tensions) CHECK(tension == near(weight / sines, 1e-4));
  CHECK(lines[1].tensions[0] == near(lines[0].tensions[0], 1e-9));
  CHECK((forces_of(world, "threads").rowwise().sum()).norm() < 1e-12 * weight);
}

TEST_CASE("threads and contact bear what loads a block that nothing else holds") {
  Setup setup = two_blocks();
  setup.contact.self = true;
  for (const double y : {0.005, 0.01, 0.015}) {
    setup.stitches.push_back(
        stitch(setup, {{0.015, y, 0.019}, {0.015, y, 0.008}, {0.026, y, 0.008}, {0.026, y, 0.019}}, 0.2));
    setup.stitches.back().ties = {{0, 3, 0, 0.003, 0.1}};
  }
  const double load = 0.004;  // [N], on the free block, away from the other
  std::vector<Index> end;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) > 0.0409) end.push_back(v);
  for (const Index v : end) setup.vertex_loads.push_back({v, {load / double(end.size()), 0, 0}});
  World<double> world(setup);
  run(world, 7);
  const Mat3X<double> of_threads = forces_of(world, "threads"), of_contact = forces_of(world, "contact");
  double pull = 0, push = 0;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) > 0.0205) {
      pull -= of_threads(0, v);
      push += of_contact(0, v);
    }
  CHECK(push > 0.01);
  CHECK(pull == near(push + load, 1e-6));
  const Mat3X<double> x = world.displacements() + setup.mesh.points;
  double widest = -1;
  for (Index v = 0; v < x.cols(); ++v)
    if (std::abs(setup.mesh.points(0, v) - 0.021) < 1e-9) widest = std::max(widest, x(0, v) - 0.02);
  CHECK(widest < 1e-3);  // they were 1 mm apart
}

TEST_CASE("a thread that is pulled through the tissue has what the tissue holds, until it tears out") {
  Setup setup = block(6);
  World<double> world(setup);
  ThreadMaterial material;
  material.holds = 0.02;
  world.apply(BringThread{7, material});
  world.apply(Bite{7, at(setup, {0.0203, 0.0211, 0.012})});
  world.apply(Pull{7, true, {0.0203, 0.0211, 0.04}});
  std::vector<Event> said;
  double z = 0.04;
  int steady = 0;
  for (int i = 0; i < 200 && said.empty(); ++i) {
    z += 2e-4;
    const std::uint64_t structure = world.body().model.revisions.structure;
    world.apply(Pull{7, true, {0.0203, 0.0211, z}});
    CHECK(world.body().model.revisions.structure == structure);  // the hand is only led
    const double cut = threads_of(world).ledger().cut;
    run(world, thread_frame, &said);
    const std::vector<ThreadLine> lines = thread_lines(world);
    if (lines.empty() || !(threads_of(world).ledger().cut > cut)) continue;
    ++steady;
    // both ends are in the hand, so that the bite bears twice the tension
    CHECK(2 * lines[0].tensions[0] == near(material.holds, 1e-3));
  }
  CHECK(steady > 10);
  CHECK(has_said(said, Event::Kind::torn, "thread \"7\" has torn out of the tissue at bite 0"));
  CHECK(threads_of(world).all()[0].bites.empty());
  const double way = threads_of(world).ledger().cut / material.holds;
  CHECK(way == near(0.008, 0.03));  // from the bite to the surface
  run(world, 0.05);
  CHECK(thread_lines(world).empty());
}

TEST_CASE("the work of a hand on a thread is found in the tissue, the thread and what friction took") {
  Setup setup = block();
  setup.damping = 2;
  World<double> world(setup);
  ThreadMaterial material;
  material.friction = 0.3;
  world.apply(BringThread{0, material});
  for (const Vec3d& X : {Vec3d(0.008, 0.02, 0.012), Vec3d(0.02, 0.02, 0.015), Vec3d(0.031, 0.022, 0.013)})
    world.apply(Bite{0, at(setup, X)});
  const Vec3d hand(0.02, 0.02, 0.05);
  world.apply(Pull{0, true, hand});
  for (int i = 1; i <= 100; ++i) {
    world.apply(Pull{0, true, hand + i / 100.0 * Vec3d(0.002, 0, 0.008)});
    run(world, thread_frame);
  }
  run(world, 2 * thread_frame);
  const ThreadLedger ledger = threads_of(world).ledger();
  CHECK(ledger.hand > 1e-5);
  CHECK(ledger.friction > 0.01 * ledger.hand);
  CHECK(ledger.cut == 0);
  CHECK(world.energies().total() + ledger.friction == near(ledger.hand, 0.01));
}

TEST_CASE("a thread that is a hundred times stiffer changes no step, and is as long as it was cut") {
  int steps[2];
  double longer[2];
  for (int i = 0; i < 2; ++i) {
    Setup setup = block(6);
    setup.stitches = {stitch(
        setup, {{0.01, 0.02, 0.015}, {0.011, 0.021, 0.008}, {0.03, 0.02, 0.007}, {0.029, 0.02, 0.014}})};
    setup.stitches[0].material.stiffness = i == 0 ? 98 : 9800;
    setup.stitches[0].ties = {{0, 3, 0, 0.0015, 0.2}};
    World<double> world(setup);
    const double before = world.time_step_limit();
    steps[i] = run(world, 0.6);
    CHECK(world.time_step_limit() > 0.9 * before);
    const Thread& thread = threads_of(world).all()[0];
    double length = thread.knots[0].closing.length;
    for (const ThreadSpan& span : thread.spans) length += span.length;
    double now = 0;
    for (const ThreadLine& line : thread_lines(world))
      for (Eigen::Index k = 0; k + 1 < line.points.cols(); ++k)
        now += (line.points.col(k + 1) - line.points.col(k)).norm();
    longer[i] = now - length;
    const double T = thread.spans[0].tension;
    CHECK(T > 1e-4);
    CHECK(longer[i] == near(T / thread.material.stiffness * length, 1e-3, 1e-6));
  }
  CHECK(steps[0] == steps[1]);
}

TEST_CASE("a world that is restored in the middle of a stitch goes on with the same bits") {
  const Setup setup = block();
  World<float> world(setup), other(setup);
  ThreadMaterial material;
  material.holds = 0.03;
  const auto run_frames = [](World<float>& w, int frames) {
    for (int i = 0; i < frames; ++i) REQUIRE(w.advance(thread_frame).ok);
  };
  world.apply(BringThread{3, material});
  for (const Vec3d& X : {Vec3d(0.008, 0.02, 0.012), Vec3d(0.02, 0.02, 0.015), Vec3d(0.031, 0.022, 0.013)})
    world.apply(Bite{3, at(setup, X)});
  world.apply(Pull{3, true, {0.02, 0.02, 0.03}});
  run_frames(world, 3);
  world.apply(Pull{3, true, {0.021, 0.02, 0.036}});
  run_frames(world, 2);
  other.restore(world.save());
  CHECK(same_bits(world, other));
  for (World<float>* w : {&world, &other}) {
    w->apply(Pull{3, true, {0.022, 0.02, 0.039}});
    run_frames(*w, 3);
    w->apply(Tie{3, 0, 2, 0.002, 0.05});
    run_frames(*w, 8);
  }
  CHECK(same_bits(world, other));
  CHECK(world.save().terms[0].saved == other.save().terms[0].saved);
}

TEST_CASE("a planned stitch comes to the same rest as one that is sewn by hand") {
  Setup planned = block();
  StitchSetup plan = stitch(planned, {{0.01, 0.02, 0.012}, {0.03, 0.02, 0.012}}, 0.2);
  plan.at = 3 * thread_frame;
  plan.ties = {{0, 1, 5 * thread_frame, 0.003, 0.05}};
  planned.stitches = {plan};
  World<double> scene(planned), hand(block());
  for (int i = 0; i < 70; ++i) {
    if (i == 3) {
      hand.apply(BringThread{0, plan.material});
      for (const EmbeddedPoint& bite : plan.bites) hand.apply(Bite{0, bite});
    }
    if (i == 5) hand.apply(Tie{0, 0, 1, 0.003, 0.05});
    scene.advance(thread_frame);
    hand.advance(thread_frame);
  }
  CHECK(threads_of(scene).all()[0].spans[0].tension > 0);
  CHECK((scene.displacements() - hand.displacements()).norm() < 1e-4 * hand.displacements().norm());
}

TEST_CASE("a loop opens where its tissue is removed, where it is cut, and where it breaks") {
  Setup setup = block();
  setup.stitches = {stitch(setup, {{0.01, 0.02, 0.012}, {0.03, 0.02, 0.012}})};
  setup.stitches[0].ties = {{0, 1, 0, 0.003, 0.02}};
  SUBCASE("removed") {
    World<double> world(setup);
    run(world, 0.1);
    CHECK(threads_of(world).all()[0].spans[0].tension > 0);
    world.remove_tets({setup.stitches[0].bites[1].tet});
    std::vector<Event> said;
    run(world, 0.1, &said);
    CHECK(has_said(said, Event::Kind::torn, "has lost the tissue around bite 1"));
    CHECK(threads_of(world).all()[0].knots.empty());
    CHECK(forces_of(world, "threads").norm() == 0);
    CHECK(fault_of(world) == "");
  }
  SUBCASE("cut") {
    World<double> world(setup);
    run(world, 0.1);
    world.apply(CutThread{0, 0});
    CHECK(forces_of(world, "threads").norm() == 0);
    CHECK(refusal(world, Tie{0, 0, 1}).find("what is cut cannot be tied") != std::string::npos);
  }
  SUBCASE("broken") {
    setup.stitches[0].material.strength = 0.002;
    World<double> world(setup);
    std::vector<Event> said;
    run(world, 0.1, &said);
    CHECK(has_said(said, Event::Kind::broken, "thread \"3-0\" broke"));
    CHECK(forces_of(world, "threads").norm() == 0);
  }
}

TEST_CASE("a running suture has loops at its ends, and one cable in between") {
  Setup setup = block(6);
  std::vector<Vec3d> through;
  for (int i = 0; i < 6; ++i) through.push_back({0.006 + 0.005 * i, i % 2 == 0 ? 0.012 : 0.028, 0.015});
  setup.stitches = {stitch(setup, through, 0.1)};
  setup.stitches[0].ties = {{0, 1, 0, 0.002, 0.05}, {4, 5, 0, 0.002, 0.05}};
  World<double> world(setup);
  run(world, 0.3);
  const Thread& thread = threads_of(world).all()[0];
  REQUIRE(thread.knots.size() == 2);
  CHECK(thread.spans[0].tension > 0);
  CHECK(thread.spans[4].tension > 0);
  CHECK(thread_lines(world).size() == 3);
  CHECK(forces_of(world, "threads").rowwise().sum().norm() < 1e-14);
}

TEST_CASE("the present setup has the stitches that are left, drawn together as they are") {
  Setup setup = block();
  setup.stitches = {stitch(setup, {{0.01, 0.02, 0.012}, {0.03, 0.02, 0.012}})};
  setup.stitches[0].ties = {{0, 1, 0, 0.003, 0.02}};
  World<double> world(setup);
  run(world, 0.1);
  CompactMesh compacted;
  const Setup now = world.current_setup(compacted);
  REQUIRE(now.stitches.size() == 1);
  REQUIRE(now.stitches[0].ties.size() == 1);
  CHECK(now.stitches[0].ties[0].tighten == near(0.003, 0.02));
  World<double> anew(now);
  run(anew, 0.05);
  CHECK(threads_of(anew).all()[0].spans[0].tension > 0);
}

TEST_CASE("what cannot be done to a thread is refused by name, and nothing has changed") {
  const Setup setup = block();
  World<double> world(setup);
  CHECK(refusal(world, Bite{4, at(setup, {0.01, 0.02, 0.012})}) == "thread 4: there is none of this number");
  CHECK(world.body().terms.empty());
  CHECK(refusal(world, BringThread{-1, {}}).find("at least 0") != std::string::npos);
  ThreadMaterial limp;
  limp.stiffness = 0;
  CHECK(refusal(world, BringThread{1, limp}).find("stiffness above 0 N") != std::string::npos);
  world.apply(BringThread{1, {}});
  CHECK(refusal(world, BringThread{1, {}}).find("already") != std::string::npos);
  CHECK(refusal(world, Bite{1, {5, {0.5, 0.5, 0.5, 0.5}}}).find("sum 1") != std::string::npos);
  CHECK(refusal(world, Bite{1, {100000, {1, 0, 0, 0}}}).find("100000") != std::string::npos);
  CHECK(refusal(world, Pull{1, true, Vec3d::Zero()}).find("passes no tissue yet") != std::string::npos);
  world.apply(Bite{1, at(setup, {0.01, 0.02, 0.012})});
  CHECK(refusal(world, Tie{1, 0, 1}).find("has no bite 1") != std::string::npos);
  world.apply(Bite{1, at(setup, {0.03, 0.02, 0.012})});
  CHECK(refusal(world, Tie{1, 1, 0}).find("in their order") != std::string::npos);
  CHECK(refusal(world, Tie{1, 0, 1, 0.03}).find("more than half of its loop of 0.04 m") != std::string::npos);
  world.apply(Tie{1, 0, 1});
  CHECK(refusal(world, Tie{1, 0, 1}).find("has a knot there already") != std::string::npos);
  CHECK(refusal(world, CutThread{1, 9}).find("has no bite 9") != std::string::npos);
  CHECK(threads_of(world).all().size() == 1);
}

TEST_CASE("a setup whose stitches cannot be sewn is refused") {
  const auto fault = [](Setup setup) -> std::string {
    try {
      World<double> world(setup);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  Setup setup = block();
  setup.stitches = {stitch(setup, {{0.01, 0.02, 0.012}, {0.03, 0.02, 0.012}})};
  CHECK(fault(setup) == "");
  Setup one = setup;
  one.stitches[0].bites.pop_back();
  CHECK(fault(one).find("needs at least two bites") != std::string::npos);
  Setup early = setup;
  early.stitches[0].at = 1;
  early.stitches[0].ties = {{0, 1, 0.5}};
  CHECK(fault(early).find("is tied before it is sewn") != std::string::npos);
  Setup condensed = setup;
  condensed.region_of.assign(condensed.region_of.size(), RegionModel::precomputed);
  CHECK(fault(condensed).find("precomputed region, where nothing can pull") != std::string::npos);
  Setup implicit = setup;
  implicit.integrator = Integrator::generalised_alpha;
  CHECK(fault(implicit).find("a thread") != std::string::npos);
}

TEST_CASE("a loop keeps its length where a bite is taken out of it") {
  for (Index at : {0, 1, 2}) {
    Thread thread;
    for (Index number : {0, 1, 2}) thread.bites.push_back({{}, number});
    thread.spans.resize(2);
    thread.spans[0].length = 0.01;
    thread.spans[1].length = 0.02;
    thread.tie(0, 2, 0.03, 0, 0);
    thread.remove_bite(at);
    REQUIRE(thread.knots.size() == 1);
    REQUIRE(thread.spans.size() == 1);
    CHECK(thread.knots[0].closing.length + thread.spans[0].length == near(0.06, 1e-14));
  }
}
