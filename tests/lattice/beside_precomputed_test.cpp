// Reduced regions beside pre-computed ones: the mass of the condensed interior moves in any case.
#include <doctest/doctest.h>

#include <numeric>
#include <vector>

#include "lattice_worlds.h"
#include "lobe/sim/checkpoint.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr int cells_along = 15, cells_across = 5;  // cells

// A bar along x, pre-computed between two places [m], the rest of another model.
Setup part_precomputed(double from, double to, RegionModel rest, RegionFrame frame = RegionFrame::corotated) {
  Setup setup = bar(cells_along, cells_across, true, rest);
  setup.precomputed_frame = frame;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (const double x = barycentre(setup.mesh, t).x(); x > from && x < to)
      setup.region_of[std::size_t(t)] = RegionModel::precomputed;
  return setup;
}

double moving_mass(const World<double>& world) {  // [kg]
  const std::vector<double>& of_vertices = world.body().inertia.mass();
  const std::vector<double>& of_nodes = region_of(world).embedding().mass;
  const double sum = std::accumulate(of_vertices.begin(), of_vertices.end(), 0.0);
  return std::accumulate(of_nodes.begin(), of_nodes.end(), sum);
}

// Less what the lattice asks for besides [kg].
double mass_of_body(const World<double>& world) {
  return moving_mass(world) - (region_of(world).any_embedded() ? region_of(world).mass_added() : 0);
}

double mass_of_tets(const Setup& setup) {  // [kg]
  const Elements elements(setup);
  double sum = 0;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    sum += elements.elastic_of(t).density * elements.volume(t);
  return sum;
}

Index corner_of(const Setup& setup) {  // far from what is held
  Index tip = 0;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points.col(v).sum() > setup.mesh.points.col(tip).sum()) tip = v;
  return tip;
}

// A frame of each: held by a tool, other models, burnt, let go. The mass after each [kg].
std::vector<double> masses_while_edited(const Setup& setup) {
  World<double> world(setup);
  std::vector<double> masses{mass_of_body(world)};
  const auto then = [&](const Command& command) {
    world.apply(command);
    CHECK(test::fault_of(world) == "");
    world.advance(0.005);
    CHECK(test::fault_of(world) == "");
    masses.push_back(mass_of_body(world));
    World<double> other(setup);
    other.restore(world.save());
    CHECK(test::fault_of(other) == "");
    CHECK(moving_mass(other) == near(moving_mass(world), 1e-12));
  };
  const Index last = setup.mesh.tet_count() - 1;
  then(TakeHold{"grasp", {corner_of(setup)}});
  then(SetRegion{{last - 8, last - 9}, RegionModel::nonlinear});
  then(SetRegion{{0, 1, 2}, RegionModel::tensor_mass});
  then(RemoveTets{{last / 2, last / 2 + 1}});
  then(LetGo{1});
  then(RemoveTets{{last - 20}});
  return masses;
}

// When a bar that was bent slightly and let go passes through rest [s].
std::vector<double> first_crossings(const Setup& setup, int count) {
  World<double> world(setup);
  const Eigen::RowVectorXd shape = (setup.mesh.points.row(0) / (cells_along * edge)).cwiseAbs2();
  State<double> state = world.state();
  state.u.row(2) = 5e-4 * shape;
  world.set_state(state);
  std::vector<double> found;
  for (double last = 1; int(found.size()) < count && world.time() < 1;) {
    REQUIRE(world.advance(0.002).ok);
    const double now = world.displacements().row(2).dot(shape);  // of the first mode, mostly
    if (last * now < 0) found.push_back(world.time() - 0.002 * now / (now - last));
    last = now;
  }
  return found;
}

}  // namespace

TEST_CASE("beside a pre-computed region a reduced bar has the mass of a non-linear one, whatever is edited") {
  struct Part {
    double from, to;
    RegionFrame frame;
  };
  for (const auto& [from, to, frame] :
       {Part{0.1, 1, RegionFrame::corotated}, Part{0.05, 0.1, RegionFrame::corotated},
        Part{-1, 0.075, RegionFrame::corotated}, Part{-1, 0.075, RegionFrame::fixed}}) {
    CAPTURE(from);
    const Setup setup = part_precomputed(from, to, RegionModel::reduced, frame);
    const std::vector<double> reduced = masses_while_edited(setup),
                              nonlinear = masses_while_edited(
                                  part_precomputed(from, to, RegionModel::nonlinear, frame));
    for (std::size_t i = 0; i < reduced.size(); ++i) {
      CAPTURE(i);
      CHECK(reduced[i] == near(nonlinear[i], 1e-9));
    }
    if (from > 0) CHECK(reduced[0] == near(mass_of_tets(setup), 1e-6));
  }
}

TEST_CASE("beside a pre-computed region a reduced bar swings as a non-linear one") {
  struct Part {
    double from, to;
  };
  for (const auto& [from, to] : {Part{0.1, 1}, Part{0.05, 0.1}}) {
    const std::vector<double> reduced = first_crossings(part_precomputed(from, to, RegionModel::reduced), 3),
                              exact = first_crossings(part_precomputed(from, to, RegionModel::nonlinear), 3);
    REQUIRE(reduced.size() == 3);
    REQUIRE(exact.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
      MESSAGE("from " << from << " m: " << reduced[i] << " s, non-linear " << exact[i] << " s");
      CHECK(reduced[i] == near(exact[i], 0.03));
    }
  }
}

// What falls freely has the momentum of its weight, whichever regions carry it.
TEST_CASE("reduced tetrahedra that become pre-computed keep their momentum, and their weight acts once") {
  Setup setup = bar(cells_along, cells_across, false);
  setup.precomputed_frame = RegionFrame::corotated;
  setup.gravity = {0, 0, -9.81};
  World<double> world(setup);
  std::vector<Index> tets;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (barycentre(setup.mesh, t).x() > 0.1) tets.push_back(t);
  const auto check_momentum = [&] {
    CHECK(test::fault_of(world) == "");
    const double expected = -9.81 * mass_of_tets(setup) * (world.time() - world.state().velocity_lag);
    CHECK(momentum_of(world).linear.z() == near(expected, 0.002));
  };
  world.advance(0.005);
  check_momentum();
  world.apply(SetRegion{tets, RegionModel::precomputed});
  world.advance(0.005);
  check_momentum();
}
