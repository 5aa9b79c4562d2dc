// Parts of a body whose faces coincide at the start, as those of two organs of one label image do.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <map>

#include "joined_meshes.h"
#include "lobe/scene/material_constants.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double block_edge = 0.04;  // [m]

// A plate on a block, `gap` above it.
TetMesh plate_on_block(int cells, double gap = 0) {
  TetMesh plate = box_mesh({0.03, 0.03, 0.004}, cells, cells, 2);
  plate.points.colwise() += Vec3d(0.005, 0.005, block_edge + gap);
  return joined(box_mesh(Vec3d::Constant(block_edge), cells, cells, cells), plate);
}

// The tetrahedra of the second label get copies of the vertices that both labels have.
TetMesh part_by_labels(TetMesh mesh, const std::function<bool(const Vec3d&)>& is_second) {
  std::vector<bool> is_of_first(std::size_t(mesh.vertex_count()), false);
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    mesh.labels[std::size_t(t)] = is_second(barycentre(mesh, t)) ? 1 : 0;
    if (mesh.labels[std::size_t(t)] == 0)
      for (Index v : mesh.tets.col(t)) is_of_first[std::size_t(v)] = true;
  }
  std::map<Index, Index> copy_of;
  const Index before = mesh.vertex_count();
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    if (mesh.labels[std::size_t(t)] == 0) continue;
    for (Index& v : mesh.tets.col(t))
      if (is_of_first[std::size_t(v)])
        v = copy_of.emplace(v, before + static_cast<Index>(copy_of.size())).first->second;
  }
  mesh.points.conservativeResize(3, before + static_cast<Index>(copy_of.size()));
  for (const auto& [v, copy] : copy_of) mesh.points.col(copy) = mesh.points.col(v);
  return mesh;
}

Setup touching(const TetMesh& mesh, RegionModel model = RegionModel::nonlinear) {
  Setup setup = setup_of(mesh, model);
  setup.contact.self = true;
  setup.contact.friction = 0;
  return setup;
}

void hold_the_bottom(Setup& setup) {
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < 1e-9) setup.prescribed.push_back({v, Vec3d::Zero()});
}

struct Outcome {
  double least_volume_ratio = 1;
  double most_energy = 0, energy = 0;             // in the course; at the end [J]
  double contact_energy = 0, kinetic_energy = 0;  // at the end [J]
};

template <class Real>
Outcome play(World<Real>& world, int frames, double duration) {
  Outcome found;
  for (int i = 0; i < frames; ++i) {
    const Report report = world.advance(duration);
    REQUIRE(report.ok);
    found.least_volume_ratio = std::min(found.least_volume_ratio, report.smallest_volume_ratio);
    found.most_energy = std::max(found.most_energy, world.energies().total());
  }
  found.contact_energy = world.energies().applied;
  found.kinetic_energy = world.energies().kinetic;
  return found;
}

}  // namespace

TEST_CASE_TEMPLATE("faces that are apart by no more than rounding do not press on each other", Real, float,
                   double) {
  const Setup setup = touching(plate_on_block(8));
  const Index of_block = box_mesh(Vec3d::Constant(block_edge), 8, 8, 8).vertex_count();
  for (double gap : {0.0, 3e-13, 1.1e-12, 1.3e-12, 1.5e-12, 1.8e-12, 3e-12, 4e-12, 6e-12, 1e-11, 1e-9}) {
    CAPTURE(gap);
    Mat3X<Real> u = Mat3X<Real>::Zero(3, setup.mesh.vertex_count());
    u.bottomRows(1).rightCols(u.cols() - of_block).setConstant(Real(gap));
    World<Real> world = world_at<Real>(setup, u);
    CHECK(world.energies().applied == 0);
    CHECK(world.forces().norm() < (std::is_same_v<Real, float> ? 1e-6 : 1e-9));
  }
}

TEST_CASE_TEMPLATE("parts whose faces coincide stay at rest", Real, float, double) {
  const TetMesh block = box_mesh(Vec3d::Constant(block_edge), 6, 6, 6);
  for (const TetMesh& mesh :
       {plate_on_block(6), part_by_labels(block, [](const Vec3d& x) { return x[2] > block_edge / 2; }),
        part_by_labels(block,
                       [](const Vec3d& x) { return (x - Vec3d::Constant(block_edge / 2)).norm() < 0.015; }),
        part_by_labels(block, [](const Vec3d& x) { return x[2] > block_edge / 3 + x[0] / 3; })}) {
    World<Real> world(touching(mesh));
    const Outcome found = play(world, 3, 0.01);
    CHECK(found.contact_energy < 1e-25);
    CHECK(found.kinetic_energy < 1e-25);
    CHECK(world.forces().norm() < 1e-11);
  }
}

TEST_CASE("a plate lies on a block whose face coincides with its own, in single precision as in double") {
  Setup setup = touching(plate_on_block(8));
  hold_the_bottom(setup);
  const LamePair soft = lame_from_young(5e3, 0.4), stiff = lame_from_young(5e4, 0.4);
  setup.materials = {{soft.lambda, soft.mu, 1000}, {stiff.lambda, stiff.mu, 1000}};
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    setup.material_of[std::size_t(t)] = barycentre(setup.mesh, t)[2] > block_edge ? 1 : 0;
  setup.gravity = {0, 0, -9.81};
  setup.damping = 20;
  World<float> single(setup);
  World<double> exact(setup);
  const Outcome found = play(single, 3, 1.0 / 60), expected = play(exact, 3, 1.0 / 60);
  MESSAGE("energy of contact " << found.contact_energy << " J, in double " << expected.contact_energy);
  CHECK(found.least_volume_ratio == near(expected.least_volume_ratio, 0.01));
  CHECK(found.contact_energy == near(expected.contact_energy, 0.05));
  CHECK(found.kinetic_energy == near(expected.kinetic_energy, 0.05));
}

namespace {

// A block is divided along a plane, and around a ball inside of it.
TetMesh halves() {
  return part_by_labels(box_mesh(Vec3d::Constant(block_edge), 6, 6, 6),
                        [](const Vec3d& x) { return x[2] > block_edge / 2; });
}

TetMesh shell_and_core() {
  return part_by_labels(box_mesh(Vec3d::Constant(block_edge), 6, 6, 6),
                        [](const Vec3d& x) { return (x - Vec3d::Constant(block_edge / 2)).norm() < 0.015; });
}

template <class Real>
double energy_of_pressed(const TetMesh& mesh) {
  Setup setup = touching(mesh, RegionModel::tensor_mass);
  hold_the_bottom(setup);
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.points(2, v) > block_edge - 1e-9) setup.prescribed.push_back({v, {0, 0, -block_edge / 20}});
  setup.damping = 60;
  World<Real> world(setup);
  play(world, 20, 0.02);
  return world.energies().elastic_linear;
}

template <class Real>
Outcome thrown_on_each_other(const TetMesh& mesh) {
  World<Real> world(touching(mesh));
  State<Real> state = world.state();
  for (Index t = 0; t < mesh.tet_count(); ++t)
    if (mesh.labels[std::size_t(t)] == 1)
      for (Index v : mesh.tets.col(t)) state.v.col(v) = Vec3<Real>(Real(0.02), 0, Real(-0.2));
  world.set_state(state);
  const double energy = world.energies().total();
  Outcome found = play(world, 40, 0.002);
  found.most_energy /= energy;
  found.energy = world.energies().total() / energy;
  return found;
}

}  // namespace

TEST_CASE("halves that coincide along a plane bear as much as the block that they make up") {
  const double whole = energy_of_pressed<double>(box_mesh(Vec3d::Constant(block_edge), 6, 6, 6));
  CHECK(energy_of_pressed<double>(halves()) == near(whole, 0.02));
  CHECK(energy_of_pressed<float>(halves()) == near(whole, 0.02));
}

TEST_CASE("a core that slides in its shell bears the same in single precision as in double") {
  CHECK(energy_of_pressed<float>(shell_and_core()) ==
        near(energy_of_pressed<double>(shell_and_core()), 1e-3));
}

// Without damping, contact may gain up to a hundredth where points enter and leave it (docs/contact.md).
TEST_CASE("halves that coincide and are thrown on each other gain next to no energy, in both precisions") {
  const Outcome single = thrown_on_each_other<float>(halves()),
                exact = thrown_on_each_other<double>(halves());
  MESSAGE("energy up to " << single.most_energy << ", then " << single.energy << " of that at the start");
  CHECK(single.most_energy == near(exact.most_energy, 1e-3));
  CHECK(single.energy == near(exact.energy, 1e-3));
  CHECK(single.most_energy < 1.05);
  CHECK(single.energy < 1.01);
  CHECK(single.least_volume_ratio == near(exact.least_volume_ratio, 1e-3));
}
