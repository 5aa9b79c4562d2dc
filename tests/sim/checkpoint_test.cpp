#include "lobe/sim/checkpoint.h"

#include <doctest/doctest.h>

#include <fstream>
#include <functional>

#include "fibre_support.h"
#include "folder.h"
#include "lobe/error.h"
#include "lobe/file/scanner.h"
#include "lobe/file/sealed_file.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Everything that a world remembers: two regions, a grasp that lets go, a cautery, loads, pieces that fall.
Setup busy_setup() {
  Setup setup = hybrid_setup(irregular_box(3));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.gravity = Vec3d(0, 0, -9.81);
  setup.damping = 5;
  setup.grasps.push_back({"grasp",
                          {setup.mesh.vertex_count() - 1},
                          {{0.02, Vec3d::Zero()}, {0.1, Vec3d(0.002, 0, 0.003)}},
                          true});
  setup.cauteries.push_back(
      {"cautery", 0.004, {{0.03, Vec3d(-0.01, 0.015, 0.02)}, {0.12, Vec3d(0.04, 0.015, 0.02)}}});
  return setup;
}

// Pulled to 1.4 times its length in a fifth of a second, and heavy. Its lowest layer is linear or not.
Setup stretched_block(RegionModel lowest) {
  Setup setup = setup_of(irregular_box(5));
  setup.volume_penalty = 1e5;
  setup.damping = 10;
  setup.gravity = {0, 0, 60};
  setup.ramp = 0.2;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (const double z = setup.mesh.points(2, v); z < 0.003 || z > 0.047)
      setup.prescribed.push_back({v, {0, 0, z < 0.003 ? 0 : 0.02}});
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (barycentre(setup.mesh, t).z() < 0.01) setup.region_of[t] = lowest;
  return setup;
}

}  // namespace

TEST_CASE_TEMPLATE("a restored world goes on with the same bits, on one, two and seven threads", Real, float,
                   double) {
  const Setup setup = busy_setup();
  World<Real> world(setup);
  for (int i = 0; i < 4; ++i) world.advance(0.02);
  world.remove_tets({0, 1});
  world.apply(SetRegion{{20, 21, 22}, RegionModel::tensor_mass});
  const Checkpoint<Real> kept = world.save();
  CHECK(kept.history.size() > 2);
  const Folder folder;
  write_checkpoint(folder.path / "state", kept);
  World<Real> from_memory(setup, 2), from_file(setup, 7);
  from_memory.restore(kept);
  from_file.restore(read_checkpoint<Real>(folder.path / "state"));
  CHECK(same_bits(world, from_memory));
  for (int i = 0; i < 4; ++i) {
    for (World<Real>* each : {&world, &from_memory, &from_file}) each->advance(0.02);
    CHECK(same_bits(world, from_memory));
    CHECK(same_bits(world, from_file));
  }
  CHECK(world.elements().topology.alive_count() < setup.mesh.tet_count() - 2);  // the cautery cut on
  world.restore(kept);                                                          // back in time, across cuts
  World<Real> untouched(setup);
  CHECK_FALSE(same_bits(world, untouched));
  CHECK(world.state().u == kept.state.u);
  CHECK(world.journal().edits == kept.history);
}

TEST_CASE("a world that has measured its time step again goes on with the same bits, drawn or not") {
  for (RegionModel lowest : {RegionModel::nonlinear, RegionModel::precomputed}) {
    const Setup setup = stretched_block(lowest);
    World<float> world(setup), drawn(setup);
    for (int i = 0; i < 60; ++i) {
      world.advance(0.01);
      drawn.advance(0.01);
      drawn.state();
    }
    const Checkpoint<float> kept = world.save();
    CHECK(kept.ratios.limit != World<float>(setup).save().ratios.limit);
    World<float> other(setup, 2);
    other.restore(kept);
    for (int i = 0; i < 30; ++i)
      for (World<float>* each : {&world, &drawn, &other}) each->advance(0.01);
    CHECK(same_bits(world, drawn));
    CHECK(same_bits(world, other));
    CHECK(world.save().ratios.of_vertex == other.save().ratios.of_vertex);
  }
}

TEST_CASE_TEMPLATE("a world that was cut and changed goes back to its start, to the bit", Real, float,
                   double) {
  const Setup setup = busy_setup();
  World<Real> world(setup), untouched(setup);
  const Checkpoint<Real> start = world.save();
  for (Index t = 0; t < setup.mesh.tet_count(); t += 2) world.remove_tets({t});
  world.apply(SetRegion{{1, 3, 5}, RegionModel::tensor_mass});
  REQUIRE(world.elements().topology.copy_count() > 10);
  world.restore(start);
  CHECK(world.save().setup == start.setup);  // of a world built anew
  for (World<Real>* each : {&world, &untouched}) each->advance(0.02);
  CHECK(same_bits(world, untouched));
}

TEST_CASE("a world with fibres is restored to the bit across cuts, and not into one with another fibre") {
  Setup setup = busy_setup();
  setup.materials[0] = fibrous();
  setup.mesh.fibres = fibrous_setup(setup.mesh).mesh.fibres;
  World<float> world(setup), other(setup, 2);
  for (int i = 0; i < 4; ++i) world.advance(0.02);
  world.remove_tets({0, 1});
  const Checkpoint<float> kept = world.save();
  const Folder folder;
  write_checkpoint(folder.path / "state", kept);
  other.restore(read_checkpoint<float>(folder.path / "state"));
  for (World<float>* each : {&world, &other}) each->advance(0.04);
  CHECK(same_bits(world, other));
  CHECK(other.elements().fibres == world.elements().fibres);
  setup.mesh.fibres.col(7) = setup.mesh.fibres.col(7).unitOrthogonal();
  World<float> turned(setup);
  CHECK_THROWS_WITH_AS(turned.restore(kept), doctest::Contains("another scene"), InputError);
}

TEST_CASE("an implicit world is restored with its accelerations") {
  Setup setup = busy_setup();
  setup.integrator = Integrator::generalised_alpha;
  World<double> world(setup), other(setup);
  for (int i = 0; i < 2; ++i) world.advance(0.005);
  other.restore(world.save());
  for (World<double>* each : {&world, &other}) each->advance(0.005);
  CHECK(same_bits(world, other));
}

TEST_CASE("a checkpoint of another setup is refused, and leaves the world as it was") {
  Setup setup = busy_setup();
  World<double> world(setup);
  world.advance(0.01);
  setup.gravity.z() = -9.8;
  World<double> other(setup);
  const Mat3X<double> before = other.state().u;
  CHECK_THROWS_WITH_AS(other.restore(world.save()),
                       "checkpoint: is of another scene, mesh or version of them", InputError);
  CHECK(other.state().u == before);
}

TEST_CASE("a checkpoint whose numbers do not fit its setup is refused") {
  World<double> world(busy_setup());
  world.advance(0.01);
  const Checkpoint<double> good = world.save();
  const auto refused = [&](const char* what, const std::function<void(Checkpoint<double>&)>& damage) {
    Checkpoint<double> bad = good;
    damage(bad);
    CHECK_THROWS_WITH_AS(world.restore(bad), doctest::Contains(what), InputError);
    CHECK(world.state().u == good.state.u);
  };
  refused("displacements of other vertices", [](auto& c) { c.state.u.conservativeResize(3, 5); });
  refused("not finite", [](auto& c) { c.state.v.setConstant(std::nan("")); });
  refused("velocity_lag must be 0 s or more", [](auto& c) { c.state.velocity_lag = -0.1; });
  refused("-1", [](auto& c) { c.history.push_back(RemoveTets{{-1}}); });
  refused("1073741824", [](auto& c) { c.history.push_back(SetRegion{{1 << 30}, RegionModel::tensor_mass}); });
  refused("pieces", [](auto& c) { c.pieces.piece_of.assign(busy_setup().region_of.size(), 7); });
  refused("tools", [](auto& c) { c.tools.grasps.clear(); });
  refused("crushed tetrahedra", [](auto& c) { c.unravelling.tets = {1 << 30}; });
  refused("frequencies of other vertices", [](auto& c) { c.ratios.of_vertex.pop_back(); });
  refused("selective masses", [](auto& c) { c.mass_degree = 3; });
  refused("accelerations", [](auto& c) { c.acceleration.resize(3, 1); });
  refused("held vertices", [](auto& c) { c.held.hold({40, 9, Vec3d::Zero(), Vec3d::Zero()}); });
}

TEST_CASE("a checkpoint file cut off at any byte, or with any byte changed, is refused by name") {
  Setup setup = setup_of(box_mesh(Vec3d::Constant(0.01), 1, 1, 1));
  World<float> world(setup);
  world.remove_tets({0});
  const Folder folder;
  const auto file = folder.path / "state";
  write_checkpoint(file, world.save());
  const std::string whole = io::read_file(file);
  CHECK_NOTHROW(parse_checkpoint<float>("state", whole));
  CHECK_THROWS_WITH_AS(parse_checkpoint<double>("state", whole),
                       "state: is not the state of a world in double precision", InputError);
  for (std::size_t size = 0; size < whole.size(); ++size)
    CHECK_THROWS_AS(parse_checkpoint<float>("state", whole.substr(0, size)), InputError);
  for (std::size_t at = 0; at < whole.size(); ++at)
    for (int flip : {1, 0x80, 0xff}) {
      std::string bytes = whole;
      bytes[at] = static_cast<char>(bytes[at] ^ flip);
      CHECK_THROWS_AS(parse_checkpoint<float>("state", bytes), InputError);
    }
  CHECK_THROWS_AS(parse_checkpoint<float>("state", whole + "x"), InputError);
}

TEST_CASE("a checkpoint with a right checksum over wrong contents gives a checkpoint or a message") {
  World<float> world(setup_of(box_mesh(Vec3d::Constant(0.01), 1, 1, 1)));
  world.remove_tets({0});
  const Folder folder;
  write_checkpoint(folder.path / "state", world.save());
  const std::string whole = io::read_file(folder.path / "state");
  const io::Format format{"lobestaf", 32, "state of a world in single precision"};
  const std::string contents(io::unseal("state", whole, format));
  CHECK_THROWS_WITH_AS(
      parse_checkpoint<float>("state",
                              io::seal({"lobestaf", 19, "state of a world in single precision"}, contents)),
      "state: is the state of a world in single precision in version 19; this program knows version 32",
      InputError);
  int refused = 0;
  for (std::size_t at = 0; at < contents.size(); ++at)
    for (int now : {0, 0x7f, 0xff}) {
      std::string bytes = contents;
      bytes[at] = static_cast<char>(now);
      try {
        world.restore(parse_checkpoint<float>("state", io::seal(format, bytes)));
      } catch (const InputError&) {
        ++refused;
      }
    }
  CHECK(refused > 100);
  CHECK(world.advance(0.001).ok);
}

TEST_CASE("a ring keeps the last checkpoints and goes back to one that is old enough, across cuts") {
  const Setup setup = busy_setup();
  World<float> world(setup);
  CheckpointRing<float> ring(3, 0.02);
  CHECK_FALSE(ring.roll_back(world, 0));
  for (int i = 0; i < 10; ++i) {
    ring.keep(world);
    world.advance(0.01);
  }
  CHECK(ring.size() == 3);
  const Index left = world.elements().topology.alive_count();
  CHECK(ring.roll_back(world, 0.03));
  CHECK(world.time() == near(0.06, 1e-12));
  CHECK(world.elements().topology.alive_count() > left);
  CHECK(ring.size() == 2);
  CHECK_FALSE(ring.roll_back(world, 1));
}

TEST_CASE("a state that is not finite is refused before the world is changed, also where its edits differ") {
  World<double> world(busy_setup());
  world.advance(0.01);
  Checkpoint<double> bad = world.save();
  bad.state.u(0, 0) = std::nan("");
  world.remove_tets({0, 1});
  const Index left = world.elements().topology.alive_count();
  CHECK_THROWS_WITH_AS(world.restore(bad), doctest::Contains("not finite"), InputError);
  CHECK(world.elements().topology.alive_count() == left);
}

TEST_CASE("a ring of no checkpoints keeps none") {
  World<float> world(setup_of(box_mesh(Vec3d::Constant(0.01), 1, 1, 1)));
  CheckpointRing<float> ring(0, 0.1);
  ring.keep(world);
  ring.keep(world);
  CHECK(ring.size() == 0);
  CHECK_FALSE(ring.roll_back(world, 0));
}

TEST_CASE("checkpoints share what edits refer to by much: a renewal's displacements are kept once") {
  Setup setup = hybrid_setup(irregular_box(3));
  for (RegionModel& region : setup.region_of)
    if (region == RegionModel::tensor_mass) region = RegionModel::precomputed;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.expandable = true;
  World<double> world(setup);
  world.apply(Relinearise{0.01});
  const Checkpoint<double> first = world.save(), second = world.save();
  const auto& begin = std::get<BeginCondensing>(first.history.front());
  CHECK(begin.about);
  CHECK(begin.about == std::get<BeginCondensing>(second.history.front()).about);
}

TEST_CASE("checkpoints share the commands of a history, and see none that comes later") {
  World<double> world(hybrid_setup(irregular_box(3)));
  for (Index t = 0; t < 20; ++t) world.remove_tets({t});
  const Checkpoint<double> first = world.save();
  const std::size_t edits = first.history.size();
  REQUIRE(edits >= 10);
  world.apply(SetRegion{{40}, RegionModel::tensor_mass});
  world.apply(SetRegion{{40}, RegionModel::nonlinear});
  const Checkpoint<double> second = world.save();
  CHECK(first.history.size() == edits);
  CHECK(second.history.size() > edits);
  for (std::size_t i = 0; i < edits; ++i) CHECK(&first.history[i] == &second.history[i]);

  History changed = second.history;
  CHECK(changed == second.history);
  changed.supersede(0);
  CHECK_FALSE(changed == second.history);
  CHECK(std::holds_alternative<RemoveTets>(second.history[0]));
}

TEST_CASE("restore() keeps mesh and commands if nothing was edited since, and else repeats all commands") {
  World<double> world(hybrid_setup(irregular_box(3)));
  for (Index t = 0; t < 20; ++t) world.remove_tets({t});
  const Checkpoint<double> kept = world.save();
  const double* points = world.elements().points.view().data();
  const std::uint64_t structure = world.body().model.revisions.structure;
  REQUIRE(world.advance(0.01).ok);
  world.restore(kept);
  CHECK(world.elements().points.view().data() == points);
  CHECK(world.body().model.revisions.structure == structure);
  REQUIRE(world.journal().edits.size() == kept.history.size());
  for (std::size_t i = 0; i < kept.history.size(); ++i) CHECK(&world.journal().edits[i] == &kept.history[i]);

  world.remove_tets({40});
  world.restore(kept);
  CHECK(world.body().model.revisions.structure > structure);
  CHECK(world.journal().edits == kept.history);
  CHECK(world.elements().topology.alive(40));
  CHECK_FALSE(world.elements().topology.alive(0));
}
