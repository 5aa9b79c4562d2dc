// Blades in a world.
#include <doctest/doctest.h>

#include <map>

#include "at_once.h"
#include "fibre_support.h"
#include "folder.h"
#include "lobe/diagnostics/grain_frame.h"
#include "lobe/error.h"
#include "lobe/io/mesh_io.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/rebuild.h"
#include "lobe/sim/validate.h"
#include "near.h"
#include "strokes.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

TetMesh block() { return irregular_box(5, 0.02); }

// Several steps whose tetrahedra are divided once, against the same steps one by one. Numbers of vertices and
// tetrahedra differ.
void check_that_steps_in_turn_equal_single_ones(Setup setup) {
  setup.cut_step = 0;
  const std::vector<Incision> incisions = incisions_of(setup.mesh, 3);
  World<double> one_by_one = moving_world<double>(setup), together = moving_world<double>(setup);
  cut(one_by_one, incisions);
  incise(together, incisions);
  validate(together);
  CHECK(compare_with_rebuilt(together).largest() < 1e-12);
  const Grains &a = *one_by_one.grains(), &b = *together.grains();
  REQUIRE(a.count() == b.count());
  REQUIRE(a.point_count() == b.point_count());
  for (Index g = 0; g < a.count(); ++g) {
    CHECK(a[g].points == b[g].points);
    CHECK(a[g].share == b[g].share);
    CHECK(a[g].open == b[g].open);
  }
  const Topology &first = one_by_one.elements().topology, &second = together.elements().topology;
  CHECK(first.tet_count() == second.tet_count());
  CHECK(first.vertex_count() == second.vertex_count());
  CHECK(first.alive_count() == second.alive_count());
  std::map<Index, Index> match;  // grains of one tetrahedron are those of one there
  for (Index g = 0; g < a.count(); ++g)
    CHECK(match.emplace(a[g].element, b[g].element).first->second == b[g].element);
  const Whole expected = whole_of(one_by_one), found = whole_of(together);
  check_that_motion_is_the_same(found, expected);
  CHECK(found.elastic == near(expected.elastic, 1e-12));
  check_nearly_equal(found.forces, expected.forces);
  World<double> again(setup);
  again.restore(together.save());
  CHECK(again.state().u == together.state().u);
  CHECK(again.forces() == together.forces());
}

// A bar along x, held where x is least, and a blade that falls through its middle.
Setup bar_and_blade(double speed = 0.2) {
  Setup setup = setup_of(box_mesh({0.12, 0.03, 0.03}, 12, 3, 3));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) == 0) setup.prescribed.push_back({v});
  setup.materials = {{8e5, 2e5, 1000}};
  setup.gravity = {0, 0, -9.81};
  setup.damping = 5;
  const double depth = 0.08;
  setup.scalpels.push_back(
      {"blade",
       0.1,
       {{0.03, {0.063, -0.02, 0.05}}, {0.03 + depth / speed, {0.07, -0.02, 0.05 - depth}}},
       {{0.063, 0.05, 0.05}, {0.07, 0.05, 0.05 - depth}}});
  return setup;
}

}  // namespace

TEST_CASE("energies, momenta, masses and forces are the same before and after a cut") {
  check_that_a_cut_changes_nothing_at_once(setup_of(block()));
  check_that_a_cut_changes_nothing_at_once(hybrid_setup(block()));
  check_that_a_cut_changes_nothing_at_once(setup_of(block(), RegionModel::tensor_mass));
  check_that_a_cut_changes_nothing_at_once(fibrous_setup(block()));
  check_that_a_cut_changes_nothing_at_once(neo_hookean_setup(block()));
}

// Of the copies of a vertex each has the mean volume of its own tetrahedra.
TEST_CASE("with nodal pressure a cut changes the elastic energy, and no mass or momentum") {
  Setup setup = averaged(setup_of(block()));
  setup.cut_step = 0;
  World<double> world = moving_world<double>(setup);
  const Whole before = whole_of(world);
  cut(world, incisions_of(setup.mesh, 3));
  CHECK(world.elements().topology.tet_copy_count() > 50);
  const Whole after = whole_of(world);
  check_that_motion_is_the_same(after, before);
  CHECK(after.elastic > before.elastic * (1 + 1e-6));
}

TEST_CASE("steps whose tetrahedra are divided once equal the same steps one by one") {
  check_that_steps_in_turn_equal_single_ones(setup_of(block()));
  check_that_steps_in_turn_equal_single_ones(hybrid_setup(block()));
  check_that_steps_in_turn_equal_single_ones(setup_of(block(), RegionModel::tensor_mass));
}

TEST_CASE("a cut body equals one built afresh, also after removals and changes of region") {
  check_that_it_equals_one_built_afresh(setup_of(block()));
  check_that_it_equals_one_built_afresh(hybrid_setup(block()));
  check_that_it_equals_one_built_afresh(setup_of(block(), RegionModel::tensor_mass));
  check_that_it_equals_one_built_afresh(averaged(hybrid_setup(block())));
  check_that_it_equals_one_built_afresh(smoothed(setup_of(block())));
  check_that_it_equals_one_built_afresh(smoothed(averaged(setup_of(block()))));
  check_that_it_equals_one_built_afresh(fibrous_setup(block()));
  check_that_it_equals_one_built_afresh(neo_hookean_setup(block()));
}

TEST_CASE("strokes, removals and changes of region in any order leave what is built afresh") {
  Setup setup = hybrid_setup(block());
  setup.cut_step = 0;
  for (unsigned trial = 0; trial < 8; ++trial) {
    CAPTURE(trial);
    std::mt19937 random(trial);
    std::normal_distribution<double> normal;
    World<double> world = moving_world<double>(setup);
    const auto some_tets = [&](unsigned one_in) {
      std::vector<Index> tets;
      for (Index t = 0; t < world.elements().topology.tet_count(); ++t)
        if (world.elements().topology.alive(t) && random() % one_in == 0) tets.push_back(t);
      return tets;
    };
    for (int stroke = 0; stroke < 4; ++stroke) {
      const Vec3d n = Vec3d(normal(random), normal(random), normal(random)).normalized(),
                  along = n.unitOrthogonal(), edge = 0.2 * n.cross(along);
      const auto tip = [&](int k) { return Vec3d(Vec3d::Constant(0.05) + (0.03 * k - 0.09) * along - edge); };
      const ToolId id = world.tools().next_id();
      world.apply(BringScalpel{"blade", {tip(0), tip(0) + 2 * edge}, 0.1});
      world.apply(SwitchTool{id, true});
      for (int k = 1; k <= 4; ++k) {
        world.apply(Lead{id, {tip(k)}});
        world.advance(1e-5);
        const unsigned next = random() % 4;
        if (next == 0) world.remove_tets(some_tets(60));
        if (next == 1) world.apply(SetRegion{some_tets(5), RegionModel::tensor_mass});
        if (next == 2) world.apply(SetRegion{some_tets(5), RegionModel::nonlinear});
      }
      world.apply(LetGo{id});
    }
    validate(world);
    check_connections(world);
    CHECK(compare_with_rebuilt(world).largest() < 1e-12);
    CHECK(world.elements().topology.tet_copy_count() > 50);
  }
}

TEST_CASE("a blade through a hanging bar cuts its end off, which falls with all its mass") {
  const Setup setup = bar_and_blade();
  World<double> world(setup);
  double area = 0;
  bool came_loose = false;
  for (int i = 0; i < 24; ++i) {
    const Report report = world.advance(1.0 / 30);
    CHECK(report.ok);
    CHECK(report.tets_removed == 0);
    area += report.cut_area;
    for (const Condition& c : report.conditions) came_loose = came_loose || c.kind == Condition::Kind::pieces;
  }
  validate(world);
  CHECK(came_loose);
  CHECK(area > 0.9 * 0.03 * 0.03);                        // more where the end hangs aslant before it is off
  CHECK(world.elements().topology.pieces().size() >= 2);  // the blade meets what falls once more
  double mass = 0;
  for (Index v = 0; v < world.elements().topology.vertex_count(); ++v) mass += world.body().inertia.weighs(v);
  CHECK(mass == near(1000 * total_volume(setup.mesh), 1e-12));
  const Mat3X<double> u = world.state().u;
  double lowest = 0;
  for (Index v = 0; v < u.cols(); ++v) lowest = std::min(lowest, u(2, v));
  CHECK(lowest < -0.05);
}

TEST_CASE("a blade through a bar at rest opens its cross section") {
  Setup setup = bar_and_blade();
  setup.gravity.setZero();
  World<double> world(setup);
  double area = 0;
  for (int i = 0; i < 18; ++i) area += world.advance(1.0 / 30).cut_area;
  CHECK(area == near(0.03 * 0.03 * std::hypot(0.08, 0.007) / 0.08, 0.02));
  CHECK(world.elements().topology.pieces().size() == 2);
}

TEST_CASE("a cut body is evaluated in hardly more patches than one built afresh") {
  constexpr int n = 12, frames = 20;
  constexpr double frame = 1e-4;
  Setup setup = setup_of(box_mesh(Vec3d::Constant(0.1), n, n, n));
  std::fill(setup.region_of.begin(), setup.region_of.end(), RegionModel::nonlinear);
  setup.materials = {{4e4, 1e4, 1000}};
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (const double x = setup.mesh.points(0, v); x < 1e-9 || x > 0.1 - 1e-9) setup.prescribed.push_back({v});
  const Vec3d normal = Vec3d(1, 0.21, 0.13).normalized(), along = normal.unitOrthogonal(),
              edge = 0.1 * normal.cross(along), middle = Vec3d::Constant(0.05);
  const Vec3d from = middle - 0.1 * along, to = middle + 0.1 * along;
  setup.scalpels = {{"blade",
                     0.1,
                     {{frame / 2, from - edge}, {frame / 2 + frames * frame, to - edge}},
                     {from + edge, to + edge}}};
  World<float> world(setup);
  for (int i = 0; i <= frames; ++i) world.advance(frame);
  CHECK(world.elements().topology.tet_copy_count() > 500);
  CompactMesh compacted;
  World<float> fresh(world.current_setup(compacted));
  fresh.advance(frame);
  const Report cut = world.advance(frame), afresh = fresh.advance(frame);
  CHECK(cut.steps == afresh.steps);
  CHECK(double(cut.patches_evaluated) <= 1.12 * double(afresh.patches_evaluated));
}

TEST_CASE("the bits are the same on any number of threads") {
  const Setup setup = bar_and_blade();
  const Mat3X<float> one = after_run<float>(setup, 1, 18);
  CHECK(after_run<float>(setup, 2, 18) == one);
  CHECK(after_run<float>(setup, 3, 18) == one);
}

TEST_CASE("a world goes on with the same bits from a checkpoint within a stroke") {
  const Setup setup = bar_and_blade();
  World<float> world(setup);
  for (int i = 0; i < 8; ++i) world.advance(1.0 / 30);
  CHECK(world.grains());
  const auto checkpoint = world.save();
  World<float> other(setup);
  other.restore(checkpoint);
  for (int i = 0; i < 10; ++i) {
    world.advance(1.0 / 30);
    other.advance(1.0 / 30);
  }
  CHECK(world.state().u == other.state().u);
  CHECK(world.elements().topology.tets() == other.elements().topology.tets());
  world.restore(checkpoint);
  for (int i = 0; i < 10; ++i) world.advance(1.0 / 30);
  CHECK(world.state().u == other.state().u);
}

TEST_CASE("a scalpel in a hand cuts as the path of a scene that it leaves behind") {
  Setup setup = bar_and_blade();
  const ScalpelSetup blade = setup.scalpels[0];
  setup.scalpels.clear();
  World<float> hand(setup);
  const Vec3d tip = blade.path[0].position;
  const ToolId id = hand.tools().next_id();
  hand.apply(BringScalpel{"blade", {tip, blade.heels[0]}, 0.1});
  hand.apply(SwitchTool{id, true});
  for (int i = 0; i < 14; ++i) {
    hand.apply(Lead{id, {tip - Vec3d(0, 0, 0.006 * (i + 1))}});
    hand.advance(1.0 / 30);
  }
  hand.apply(LetGo{id});
  for (int i = 0; i < 3; ++i) hand.advance(1.0 / 30);
  CHECK(hand.elements().topology.pieces().size() == 2);
  setup.scalpels = hand.tools().paths().scalpels;
  CHECK(after_run<float>(setup, 1, 17) == hand.state().u);
}

TEST_CASE("a blade that moves with the tissue opens nothing, and one at rest cuts tissue that moves") {
  Setup setup = setup_of(block());
  for (const bool moves_along : {true, false}) {
    World<double> world(setup);
    State<double> state = world.state();
    state.v.row(0).setConstant(0.5);
    world.set_state(state);
    const Vec3d tip(0.05, 0.051, -0.1), heel = tip + Vec3d(0, 0, 0.3);
    const ToolId id = world.tools().next_id();
    world.apply(BringScalpel{"blade", {tip, heel}, 0.1});
    world.apply(SwitchTool{id, true});
    double area = 0;
    for (int i = 0; i < 10; ++i) {
      // Tools go ahead of the body: what a frame sweeps is cut at its start.
      if (moves_along) world.apply(Lead{id, {tip + Vec3d(0.5 * i / 30, 0, 0)}});
      area += world.advance(1.0 / 30).cut_area;
    }
    if (moves_along)
      CHECK(area == 0);
    else
      CHECK(area > 0.004);  // of 0.005 that lie behind it
  }
}

TEST_CASE("a frame of a cut body has grains for cells, which fill it and do not overlap where it is open") {
  Setup setup = bar_and_blade();
  setup.gravity.setZero();
  World<double> world(setup);
  for (int i = 0; i < 18; ++i) world.advance(1.0 / 30);
  const Folder folder;
  write_grain_frame(folder.path / "frame.vtu", world.elements(), *world.grains(), world.state().u,
                    world.state().v);
  const MeshFile frame = read_mesh(folder.path / "frame.vtu");
  CHECK(frame.mesh.tet_count() == world.grains()->count());
  CHECK(total_volume(frame.mesh) == near(total_volume(setup.mesh), 1e-12));
  CHECK(Topology(frame.mesh).pieces().size() == 2);
}

TEST_CASE(
    "a frame says which stroke has opened a face of a grain; so does one of a world that was restored") {
  Setup setup = bar_and_blade();
  setup.gravity.setZero();
  setup.scalpels.push_back(setup.scalpels.front());  // a second blade, later and further on
  setup.scalpels.back().name = "other";
  for (PathPoint& row : setup.scalpels.back().path) {
    row.time += 0.2;
    row.position.x() -= 0.04;
  }
  for (Vec3d& heel : setup.scalpels.back().heels) heel.x() -= 0.04;
  World<double> world(setup), restored(setup);
  for (int i = 0; i < 24; ++i) {
    REQUIRE(world.advance(1.0 / 30).ok);
    if (i == 9) restored.restore(world.save());  // amid the first stroke and the second
  }
  for (int i = 10; i < 24; ++i) REQUIRE(restored.advance(1.0 / 30).ok);
  for (World<double>* simulated : {&world, &restored}) {
    const Folder folder;
    const Grains& grains = *simulated->grains();
    write_grain_frame(folder.path / "frame.vtu", simulated->elements(), grains, simulated->state().u,
                      simulated->state().v);
    const MeshFile frame = read_mesh(folder.path / "frame.vtu");
    const Eigen::MatrixXd& stroke = frame.cell_data.at("stroke");
    REQUIRE(stroke.cols() == grains.count());
    std::array<int, 3> count{};
    for (Index g = 0; g < grains.count(); ++g) {
      const int number = static_cast<int>(stroke(0, g));
      REQUIRE(number >= -1);
      REQUIRE(number <= 1);
      ++count[std::size_t(number + 1)];
      bool is_open = false;
      for (int f = 0; f < 4; ++f) is_open = is_open || grains.is_open(g, f);
      CHECK(is_open == (number >= 0));
      if (number < 0) continue;
      double middle = 0;
      for (Index p : grains[g].points) middle += grains.point(p).x() / 4;
      CHECK(std::abs(middle - (number == 0 ? 0.0665 : 0.0265)) < 0.015);  // at rest, an edge around the blade
    }
    for (const int own_count : count) CHECK(own_count > 20);
  }
}

TEST_CASE("a blade cuts with every option of a scene") {
  std::vector<Setup> setups(7, bar_and_blade(0.4));
  setups[0].materials[0].nodal_pressure = 1;
  setups[1].selective_mass = 3;
  setups[2].sleep = 1e-6;
  setups[3].guard_below = 0.3;
  setups[3].volume_penalty = 1e5;
  setups[4].integrator = Integrator::generalised_alpha;
  setups[4].implicit_step = 1.0 / 60;
  setups[5].scalpels[0].along_faces = true;
  setups[6].materials[0].element = ElementType::edge_smoothed;
  for (const Setup& setup : setups) {
    CAPTURE(&setup - setups.data());
    World<double> world(setup);
    double area = 0;
    for (int i = 0; i < 12; ++i) {
      const Report report = world.advance(1.0 / 30);
      CHECK(report.ok);
      CHECK(report.tets_removed == 0);
      area += report.cut_area;
    }
    validate(world);
    CHECK(area > 8e-4);
    CHECK(world.elements().topology.pieces().size() >= 2);
    double volume = 0;
    for (Index t = 0; t < world.elements().topology.tet_count(); ++t) volume += world.elements().volume(t);
    CHECK(volume == near(1.08e-4, 1e-12));
    CHECK(world.state().u.row(2).minCoeff() < -0.01);  // the end falls
  }
}

TEST_CASE("a blade cuts what sleeps, and wakes it") {
  Setup setup = setup_of(box_mesh(Vec3d::Constant(0.1), 10, 10, 10));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) == 0) setup.prescribed.push_back({v});
  setup.sleep = 1e-5;
  setup.gravity = {0, 0, -9.81};
  setup.load_ramp = 0.2;
  setup.damping = 40;
  const double start = 0.8;
  setup.scalpels.push_back({"blade",
                            0.1,
                            {{start, {0.031, -0.02, 0.12}}, {start + 0.1, {0.036, -0.02, 0.05}}},
                            {{0.031, 0.12, 0.12}, {0.036, 0.12, 0.05}}});
  World<double> world(setup);
  Report report;
  while (world.time() < start - 0.04) report = world.advance(1.0 / 30);
  CHECK(report.patches_evaluated == 0);
  CHECK(report.patches_skipped > 0);
  double area = 0;
  long long evaluated = 0;
  while (world.time() < start + 0.15) {
    report = world.advance(1.0 / 30);
    area += report.cut_area;
    evaluated += report.patches_evaluated;
  }
  CHECK(area > 0.004);
  CHECK(evaluated > 0);
  validate(world);
  const Mat3X<double> u = world.state().u;
  Setup awake = setup;
  awake.sleep = 0;
  CHECK((u - after_run<double>(awake, 1, 29)).norm() < 0.02 * u.norm());
}

TEST_CASE("a piece that a blade cuts off vanishes, or stays where it is, if a scene says so") {
  for (const LoosePieces loose : {LoosePieces::vanish, LoosePieces::stay}) {
    Setup setup = bar_and_blade(0.4);
    setup.loose_pieces = loose;
    World<double> world(setup);
    Index removed = 0;
    for (int i = 0; i < 20; ++i) {
      const Report report = world.advance(1.0 / 30);
      CHECK(report.ok);
      removed += report.tets_removed;
    }
    validate(world);
    const Topology& topology = world.elements().topology;
    double left = 0, lowest = 0;  // volume, displacement
    for (Index t = 0; t < topology.tet_count(); ++t) {
      if (!topology.alive(t)) continue;
      left += world.elements().volume(t);
      for (Index v : topology.corners(t)) lowest = std::min(lowest, world.state().u(2, v));
    }
    if (loose == LoosePieces::vanish) {
      CHECK(topology.pieces().size() == 1);
      CHECK(removed > 100);
      CHECK(left == near(0.065 / 0.12 * total_volume(setup.mesh), 0.03));
    } else {
      CHECK(topology.pieces().size() >= 2);
      CHECK(removed == 0);
      CHECK(left == near(total_volume(setup.mesh), 1e-12));
    }
    CHECK(lowest > -0.01);  // in 0.4 s what falls does so by 0.5 m
  }
}

TEST_CASE("a linear end that a cut leaves on one vertex becomes non-linear, and swings without growing") {
  Setup setup = bar_and_blade(0.4);
  std::fill(setup.region_of.begin(), setup.region_of.end(), RegionModel::tensor_mass);
  const Index corner = setup.mesh.vertex_count() - 1;  // at the end that falls
  setup.grasps.push_back({"hand", {corner}, {{0, Vec3d::Zero()}, {10, Vec3d::Zero()}}, true});
  World<double> world(setup);
  for (int i = 0; i < 45; ++i) CHECK(world.advance(1.0 / 30).ok);
  validate(world);
  CHECK(world.elements().topology.pieces().size() >= 2);
  const Topology& topology = world.elements().topology;
  for (Index t : topology.around(corner)) CHECK(world.elements().region_of[t] == RegionModel::nonlinear);
  for (Index v = 0; v < topology.vertex_count(); ++v) {
    const Vec3d x = world.elements().points.col(v) + world.state().u.col(v);
    if (!topology.around(v).empty() &&
        world.elements().region_of[topology.around(v)[0]] == RegionModel::nonlinear)
      CHECK((x - setup.mesh.points.col(corner)).norm() < 0.1);  // which is 0.075 long
  }
}

TEST_CASE("half a cut is pulled open, and its tip stays whole") {
  Setup setup = bar_and_blade(0.4);
  setup.scalpels[0].path[1].position.z() = setup.scalpels[0].heels[1].z() = 0.014;
  World<double> world(setup);
  for (int i = 0; i < 20; ++i) CHECK(world.advance(1.0 / 30).ok);
  CHECK(world.elements().topology.copy_count() > 0);
  CHECK(world.elements().topology.pieces().size() == 1);
}

TEST_CASE("only the vertex that lies in the tissue stays held") {
  Setup setup = setup_of(box_mesh(Vec3d::Constant(0.1), 5, 5, 5));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) == 0) setup.prescribed.push_back({v});
  World<double> world(setup);
  Knife knife(setup.mesh);
  knife.begin();
  const auto row = [](double x) { return std::vector<Vec3d>{{x, -0.1, 0.008}, {x, 0.2, 0.008}}; };
  const Incised incised = knife.sweep(row(-0.1), row(0.2));
  cut(world, {incised.incision});
  CHECK(world.elements().topology.pieces().size() == 2);
  CHECK(world.held().all().size() == 36);
  for (const HeldVertices::Held& item : world.held().all()) {
    const auto around = world.elements().topology.around(item.vertex);
    for (Index t : around)
      for (Index grain : world.grains()->of(t))
        for (Index p : (*world.grains())[grain].points) CHECK(world.grains()->point(p).z() < 0.008 + 1e-9);
  }
}

TEST_CASE(
    "a vertex keeps its number where it lies in the tissue, and a grasp takes it there and nowhere else") {
  Setup setup = setup_of(box_mesh(Vec3d::Constant(0.1), 5, 5, 5));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) == 0) setup.prescribed.push_back({v});
  std::vector<Index> layer;  // below which the blade passes by a tenth of an edge
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (std::abs(setup.mesh.points(2, v) - 0.04) < 1e-9) layer.push_back(v);
  setup.grasps.push_back({"hand", layer, {{0.04, Vec3d::Zero()}, {0.1, {0, 0, 0.001}}}, true});
  World<double> world(setup);
  Knife knife(setup.mesh, 0.02);
  knife.begin();
  const auto row = [](double x) { return std::vector<Vec3d>{{x, -0.1, 0.038}, {x, 0.2, 0.038}}; };
  cut(world, {knife.sweep(row(-0.1), row(0.2)).incision});
  REQUIRE(world.elements().topology.pieces().size() == 2);
  world.advance(0.08);
  Index taken = 0;
  for (const HeldVertices::Held& item : world.held().all()) {
    if (item.holder == HeldVertices::boundary) continue;
    ++taken;
    CHECK(world.grains()->fills(item.vertex, world.elements()));
    for (Index t : world.elements().topology.around(item.vertex))  // all that is around is above the cut
      for (Index grain : world.grains()->of(t))
        for (Index p : (*world.grains())[grain].points) CHECK(world.grains()->point(p).z() > 0.038 - 1e-9);
  }
  CHECK(taken == Index(layer.size()));
}

TEST_CASE("no tetrahedron is divided into more than 256 grains, which is said, and nothing is lost") {
  Setup setup = setup_of(box_mesh(Vec3d::Constant(0.1), 1, 1, 1));
  setup.gravity.setZero();
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 0.1);
  double time = 0;
  for (int i = 0; i < 250; ++i) {  // short blades: what they meet stays in one piece
    const Vec3d n = Vec3d(normal(random), normal(random), normal(random)).normalized(),
                along = n.unitOrthogonal();
    const Vec3d edge = 0.02 * n.cross(along), from = Vec3d(uniform(random), uniform(random), uniform(random));
    setup.scalpels.push_back({"blade",
                              0.02,
                              {{time, from - edge}, {time + 1e-3, from - edge + 0.04 * along}},
                              {from + edge, from + edge + 0.04 * along}});
    time += 2e-3;
  }
  World<double> world(setup);
  bool was_said = false;
  for (int i = 0; i < 250; ++i) {
    const Report report = world.advance(2e-3);
    CHECK(report.ok);
    for (const Condition& c : report.conditions)
      was_said =
          was_said || (c.kind == Condition::Kind::scalpel && c.text.find("256 grains") != std::string::npos);
  }
  CHECK(was_said);
  validate(world);
  std::vector<Index> grains(std::size_t(setup.mesh.tet_count()), 0);
  for (Index g = 0; g < world.grains()->count(); ++g)
    ++grains[std::size_t(world.elements().topology.parent((*world.grains())[g].element))];
  for (std::size_t t = 0; t < grains.size(); ++t) {
    CHECK(grains[t] <= 256);
    CHECK(world.grains()->divided(Index(t)) == grains[t]);
  }
  CHECK(*std::max_element(grains.begin(), grains.end()) > 200);
  double volume = 0;
  for (Index t = 0; t < world.elements().topology.tet_count(); ++t) volume += world.elements().volume(t);
  CHECK(volume == near(1e-3, 1e-12));
}

TEST_CASE("whatever is said of points and faces, an incision is made and nothing is lost, or it is refused") {
  const Setup setup = setup_of(irregular_box(2, 0.03));
  const std::vector<Incision> good = incisions_of(setup.mesh, 3);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto number = [&](Index below) {
    const bool is_below = uniform(random) < 0.02;
    return Index(uniform(random) * 1.1 * below) - Index(is_below);
  };
  int refused = 0, made = 0;
  for (int trial = 0; trial < 400; ++trial) {
    World<double> world(setup);
    for (Incision incision : good) {
      const Index points = world.grains() ? world.grains()->point_count() : 27, grains = 8 * points;
      for (auto& edge : incision.bisections)
        if (uniform(random) < 0.1) edge = {number(points), number(points), 1.05 * uniform(random)};
      for (Index& code : incision.opened)
        if (uniform(random) < 0.1) code = number(grains);
      const Index before = world.grains() ? world.grains()->count() : 0;
      try {
        incise(world, {incision});
        ++made;
      } catch (const InputError&) {
        ++refused;
        if (before > 0) CHECK(world.grains()->count() == before);
      }
      validate(world);
    }
    double volume = 0;
    for (Index t = 0; t < world.elements().topology.tet_count(); ++t) volume += world.elements().volume(t);
    CHECK(volume == near(total_volume(setup.mesh), 1e-9));
    CHECK(world.forces().allFinite());
  }
  CHECK(refused > 10);
  CHECK(made > 10);
}

TEST_CASE("a blade that is no blade is refused") {
  Setup setup = bar_and_blade();
  setup.scalpels[0].heels[0] = setup.scalpels[0].path[0].position;
  CHECK_THROWS_WITH(World<double>{setup}, doctest::Contains("row 0 has a blade without length"));
  setup = bar_and_blade();
  setup.scalpels[0].snap = 0.5;
  CHECK_THROWS_WITH(World<double>{setup}, doctest::Contains("snap must be in [0.02, 0.3]"));
}
