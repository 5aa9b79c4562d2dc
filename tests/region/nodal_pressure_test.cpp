#include "lobe/region/nodal_pressure.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <map>
#include <numeric>

#include "fibre_support.h"
#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/fem/svk.h"
#include "lobe/region/nonlinear.h"
#include "lobe/scene/material_constants.h"
#include "lobe/scene/select.h"
#include "lobe/sim/rebuild.h"
#include "lobe/solve/static_solver.h"
#include "lobe/solve/tangent.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Three materials side by side, of shares 1, 0.6 and 0, the first partly linear; a volume term.
Setup mixed_setup(const TetMesh& mesh) {
  Setup setup = averaged(hybrid_setup(mesh));
  setup.materials.push_back({2e5, 1e4, 900});
  for (Index t = 0; t < mesh.tet_count(); t += 5) setup.material_of[t] = 2;
  return setup;
}

// The energy as the formula of the header reads, for a body of non-linear tetrahedra alone.
double energy_by_definition(const Setup& setup, const Mat3X<double>& u) {
  struct Node {
    double volume = 0, weighted = 0;
  };
  std::map<std::pair<Index, int>, Node> nodes;
  double W = 0;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const Elastic& m = setup.materials[setup.material_of[t]];
    const Shape s = shape(tet_points(setup.mesh, t));
    const Mat34<double> corners = u(Eigen::all, setup.mesh.tets.col(t));
    const Mat3<double> E =
        green_strain<double>(displacement_gradient<double>(corners, s.gradients.rightCols<3>()));
    const double theta = E.trace();
    W += s.volume * ((1 - m.nodal_pressure) * m.lambda / 2 * theta * theta + m.mu * (E * E).trace());
    for (Index v : setup.mesh.tets.col(t)) {
      Node& node = nodes[{v, setup.material_of[t]}];
      node.volume += s.volume / 4;
      node.weighted += s.volume / 4 * theta;
    }
  }
  for (const auto& [key, node] : nodes) {
    const Elastic& m = setup.materials[key.second];
    W += m.nodal_pressure * m.lambda / 2 * node.weighted * node.weighted / node.volume;
  }
  return W;
}

// One material per law, side by side, of different shares; with a volume term.
Setup setup_of_all_laws(const TetMesh& mesh) {
  Setup setup = holzapfel_setup(mesh);
  const Elastic with_fibres = setup.materials[0];
  setup.materials.clear();
  for (int law = 0; law < law_count; ++law) {
    Elastic elastic = with_fibres;
    elastic.law = MaterialLaw(law);
    if (law != int(MaterialLaw::holzapfel)) elastic.further = {};
    if (law == int(MaterialLaw::mooney_rivlin)) elastic.further[0] = elastic.mu / 5;
    elastic.nodal_pressure = 1 - 0.1 * law;
    setup.materials.push_back(elastic);
  }
  for (Index t = 0; t < mesh.tet_count(); ++t)
    setup.material_of[std::size_t(t)] = std::uint16_t(t / 3 % law_count);
  setup.volume_penalty = 1e5;
  return setup;
}

// W = Σ V_T W_T((1 − χ)λ) + Σ χλ/2 V_n θ_n², θ = J − 1 of all laws but the first.
double energy_of_all_laws(const Setup& setup, const Mat3X<double>& u) {
  const Elements elements(setup);
  std::map<std::pair<Index, int>, std::pair<double, double>> nodes;  // volume, and that times θ
  double W = 0;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const Shape s = elements.shape_of(t);
    const Mat34<double> corners = u(Eigen::all, setup.mesh.tets.col(t));
    const Mat3<double> H = displacement_gradient<double>(corners, s.gradients.rightCols<3>());
    const int material = setup.material_of[std::size_t(t)];
    const double theta =
        material == 0 ? green_strain<double>(H).trace() : (Mat3<double>::Identity() + H).determinant() - 1;
    W += s.volume * law_energy_density(nonlinear_law(elements, t), H);
    for (Index v : setup.mesh.tets.col(t)) {
      nodes[{v, material}].first += s.volume / 4;
      nodes[{v, material}].second += s.volume / 4 * theta;
    }
  }
  for (const auto& [key, node] : nodes)
    W += setup.materials[std::size_t(key.second)].nodal_lambda() / 2 * node.second * node.second / node.first;
  return W;
}

// A beam of 15 × 15 × 80 m held at one end, E = 3000 Pa, with a traction of 30 Pa across the other.
Setup bent_beam(double nu, double share) {
  Setup setup = setup_of(box_mesh({15, 15, 80}, 2, 2, 8));
  const LamePair lame = lame_from_young(3000, nu);
  setup.materials = {{lame.lambda, lame.mu, 1, share}};
  setup.damping = 0.27;  // about critical for the first mode
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) == 0) setup.prescribed.push_back({v, Vec3d::Zero()});
  for (const TetFace& face : outer_faces(setup.mesh)) {
    const Mat34<double> X = tet_points(setup.mesh, face.tet);
    const bool at_end = X.row(2).sum() - X(2, face.face) > 3 * 80 - 1e-9;
    if (at_end) setup.face_loads.push_back({face.tet, face.face, {0, -30, 0}});
  }
  return setup;
}

void check_diagonal_stiffness(Setup setup) {
  const TetMesh& mesh = setup.mesh;
  setup.region_of.assign(std::size_t(mesh.tet_count()), RegionModel::nonlinear);
  const Elements elements(setup);
  RegionEdit everything;
  everything.entered.resize(std::size_t(mesh.tet_count()));
  std::iota(everything.entered.begin(), everything.entered.end(), 0);
  NonlinearRegion<double> region;
  region.follow(elements, everything);
  const Mat3X<double> u = random_displacement(mesh.vertex_count(), 2e-3);
  DiagonalStiffness K = DiagonalStiffness::Zero(6, mesh.vertex_count());
  Parallel one_thread;
  region.add_diagonal_stiffness(u, K, one_thread);
  const int packed[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  const double h = 1e-7, scale = K.cwiseAbs().maxCoeff();
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    for (int i = 0; i < 3; ++i) {
      Mat3X<double> plus = u, minus = u;
      plus(i, v) += h;
      minus(i, v) -= h;
      const Mat3X<double> slope = (forces<double>(setup, plus) - forces<double>(setup, minus)) / (2 * h);
      for (int j = 0; j < 3; ++j) CHECK(std::abs(K(packed[i][j], v) + slope(j, v)) < 1e-6 * scale);
    }
}

}  // namespace

TEST_CASE("the energy is the formula's, with several materials") {
  const TetMesh mesh = irregular_box();
  Setup setup = mixed_setup(mesh);
  setup.volume_penalty = 0;
  setup.region_of.assign(std::size_t(mesh.tet_count()), RegionModel::nonlinear);
  const Mat3X<double> u = random_displacement(mesh.vertex_count(), 2e-3);
  CHECK(elastic_energy(setup, u) == near(energy_by_definition(setup, u), 1e-13));
  const Setup plain = averaged(setup, 0);
  CHECK(elastic_energy(setup, u) < 0.9 * elastic_energy(plain, u));  // Jensen
}

TEST_CASE("of the other laws nodes average J - 1, in the energy, in its slope, and in statics") {
  const TetMesh mesh = irregular_box(2);
  const Setup setup = setup_of_all_laws(mesh);
  const Mat3X<double> u = random_displacement(mesh.vertex_count(), 1.5e-3);
  CHECK(elastic_energy(setup, u) == near(energy_of_all_laws(setup, u), 1e-12));
  check_that_forces_are_minus_the_slope_of_the_energy(setup, u);
  const Mat3X<double> f = forces<double>(setup, u), in_statics = energy_and_forces(Elements(setup), u).forces;
  CHECK((f - in_statics).norm() < 1e-11 * f.norm());
  const Mat3X<float> single = forces<float>(setup, u.cast<float>());
  CHECK((single.cast<double>() - f).norm() < 1e-4 * f.norm());
}

TEST_CASE("no law locks: a bent beam of nu 0.499 gives way as of St Venant-Kirchhoff") {
  const auto tip = [](MaterialLaw law, double share) {
    Setup setup = bent_beam(0.499, share);
    for (auto& load : setup.face_loads) load.traction *= 0.01;
    setup.materials[0].law = law;
    if (law == MaterialLaw::mooney_rivlin) setup.materials[0].further = {200, 0};
    if (law == MaterialLaw::holzapfel) setup.materials[0].further = {1, 1};
    if (law == MaterialLaw::holzapfel)
      setup.mesh.fibres = Vec3d(0, 0, 1).replicate(1, setup.mesh.tet_count());
    const StaticResult result = solve_static(setup);
    REQUIRE(result.converged);
    return -result.u.row(1).minCoeff();
  };
  const double of_svk = tip(MaterialLaw::svk, 1);
  for (int law = 1; law < law_count; ++law) {
    CAPTURE(law);
    const double free = tip(MaterialLaw(law), 1), locked = tip(MaterialLaw(law), 0);
    CHECK(free == near(of_svk, 0.01));
    CHECK(free > 6 * locked);
  }
}

TEST_CASE("with nodal pressure forces are minus the slope of the energy, in every region and at interfaces") {
  const TetMesh mesh = irregular_box(2);
  check_that_forces_are_minus_the_slope_of_the_energy(mixed_setup(mesh),
                                                      random_displacement(mesh.vertex_count(), 2e-3));
}

TEST_CASE("with nodal pressure an affine map gives the forces and the energy of plain SVK") {
  const TetMesh mesh = irregular_box(4);
  Mat3<double> F;
  F << 1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.2, 0.1, 1.1;
  const Mat3X<double> u = affine_displacement(mesh.points, F);
  const Setup plain = hybrid_setup(mesh), setup = averaged(plain, 0.8);
  const Mat3X<double> expected = forces<double>(plain, u);
  CHECK((forces<double>(setup, u) - expected).norm() < 1e-13 * expected.norm());
  CHECK(elastic_energy(setup, u) == near(elastic_energy(plain, u), 1e-13));
}

TEST_CASE("with nodal pressure there is no net force, no net moment, and no force in a rigid motion") {
  const TetMesh mesh = irregular_box(4);
  Setup setup = mixed_setup(mesh);
  setup.region_of.assign(std::size_t(mesh.tet_count()), RegionModel::nonlinear);
  Mat3X<double> u = random_displacement(mesh.vertex_count(), 2e-3);
  const Mat3X<double> f = forces<double>(setup, u);
  CHECK(f.rowwise().sum().norm() < 1e-13 * f.norm());
  Vec3d moment = Vec3d::Zero();
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    moment += Vec3d(mesh.points.col(v) + u.col(v)).cross(Vec3d(f.col(v)));
  CHECK(moment.norm() < 1e-12 * f.norm() * 0.04);
  const Mat3<double> R = Eigen::AngleAxisd(2.0, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
  CHECK(forces<double>(setup, affine_displacement(mesh.points, R)).norm() < 1e-11 * 1e4 * 0.01 * 0.01);
  u = Vec3d(0.25, -0.5, 0.125).replicate(1, mesh.vertex_count());
  CHECK(forces<double>(setup, u).norm() == 0);
}

TEST_CASE("with nodal pressure single precision follows double, and threads do not change a bit") {
  const TetMesh mesh = irregular_box(14);  // 16,464 tetrahedra: more than one range of work
  const Setup setup = mixed_setup(mesh);
  const Mat3X<float> u = random_displacement<float>(mesh.vertex_count(), 2e-3);
  const Mat3X<double> exact = forces<double>(setup, u.cast<double>());
  const Mat3X<float> single = forces<float>(setup, u);
  CHECK((single.cast<double>() - exact).norm() < 1e-6 * exact.norm());
  CHECK(single == forces<float>(setup, u, 2));
  CHECK(exact == forces<double>(setup, u.cast<double>(), 2));
}

TEST_CASE("the diagonal stiffness is exact: minus the slope of the force on a vertex that moves alone") {
  check_diagonal_stiffness(mixed_setup(irregular_box(2)));
  check_diagonal_stiffness(setup_of_all_laws(irregular_box(2)));
}

TEST_CASE("tetrahedra that change region back and forth take their pressure nodes along") {
  const TetMesh mesh = irregular_box();
  World<double> world = world_at(mixed_setup(mesh), random_displacement(mesh.vertex_count(), 1e-3));
  const Mat3X<double> before = world.forces();
  std::vector<Index> linear, moved;
  for (Index t = 0; t < mesh.tet_count(); ++t)
    if (world.elements().region_of[t] == RegionModel::tensor_mass) linear.push_back(t);
  for (Index t = 0; t < mesh.tet_count(); t += 2) moved.push_back(t);
  for (RegionModel model : {RegionModel::tensor_mass, RegionModel::nonlinear}) {
    world.apply(SetRegion{moved, model});
    CHECK(compare_with_rebuilt(world).largest() < 1e-12);
  }
  world.apply(SetRegion{linear, RegionModel::tensor_mass});
  CHECK((world.forces() - before).norm() < 1e-13 * before.norm());
}

TEST_CASE("pressure nodes are vertices with a material, and numbers are used again") {
  const TetMesh mesh = irregular_box(2);
  Elements elements(mixed_setup(mesh));
  PressureNodes nodes(elements);
  double volume = 0, expected = 0;
  for (Index n = 0; n < nodes.count(); ++n) {
    volume += nodes.volume(n);
    for (Index t : nodes.tets(n)) CHECK(elements.elastic_of(t).nodal_lambda() == nodes.lambda(n));
  }
  std::vector<Index> part;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const bool takes_part = elements.region_of[t] == RegionModel::nonlinear && elements.material_of[t] != 2;
    CHECK((nodes.of(t).array() != PressureNodes::none).all() == takes_part);
    if (!takes_part) continue;
    part.push_back(t);
    expected += signed_volume(tet_points(mesh, t));
  }
  CHECK(volume == near(expected, 1e-14));
  const Index count = nodes.count();
  for (int i = 0; i < 3; ++i) {
    nodes.follow(elements, part, {});
    CHECK(!nodes.any());
    nodes.follow(elements, {}, part);
    CHECK(nodes.count() == count);
  }
  CHECK(nodes.tets(PressureNodes::none).empty());
}

// Static solutions of an independent Newton trial, deflection of the middle of the end.
TEST_CASE("a nearly incompressible beam settles where an independent static solution has it") {
  struct Case {
    double nu, share, deflection;  // [-], [-], [m]
  };
  for (const Case& c : {Case{0.3, 0, -34.5047}, Case{0.3, 1, -38.4205}, Case{0.45, 1, -36.6035},
                        Case{0.499, 0.98, -19.911}, Case{0.499, 0.985, -21.626}, Case{0.499, 1, -30.287}}) {
    World<double> world(bent_beam(c.nu, c.share));
    for (int i = 0; i < 15; ++i) REQUIRE(world.advance(10).ok);
    const Index middle = world.elements().topology.vertex_count() - 5;
    CHECK(world.state().u(1, middle) == near(c.deflection, 2e-5));
  }
}
