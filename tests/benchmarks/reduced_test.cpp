// The trial of `lobe bench reduced`: its lattice, cells, kernels and transitions.
#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "benchmarks/bench_results.h"
#include "benchmarks/reduced/trial_body.h"
#include "lobe/mesh/generators.h"
#include "near.h"

using namespace lobe;
using namespace lobe::reduced;
using namespace lobe::test;

namespace {

Body block_body(const TetMesh& mesh = box_mesh({0.05, 0.04, 0.06}, 5, 4, 6)) {
  Body body{.mesh = mesh, .materials = {Elastic{}}, .material_of = {}, .region_of = {}};
  const auto tets = std::size_t(body.mesh.tet_count());
  body.material_of.assign(tets, 0);
  body.region_of.assign(tets, RegionModel::nonlinear);
  body.volume_penalty = 1e5;
  return body;
}

constexpr double spacing = 0.017;

CellLaw law_of(const Body& body) {
  return {body.materials[0].lambda, body.materials[0].mu, body.volume_penalty, 2 / spacing};
}

// One cell per block, in double precision.
CellBlock<double> block_of(const Lattice& lattice, Index number, const Cell& cell) {
  CellBlock<double> block;
  for (int n = 0; n < 8; ++n) block.nodes[n][0] = lattice.nodes[number][n];
  block.V[0] = cell.volume;
  for (int i = 0; i < 12; ++i) block.mean[i][0] = cell.mean(i % 3, i / 3);
  for (int i = 0, entry = 0; i < 12; ++i)
    for (int j = i; j < 12; ++j) block.K[entry++][0] = cell.K(i, j);
  return block;
}

std::vector<CellBlock<double>> blocks_of(const Elements& elements, const Lattice& lattice, Stiffening s) {
  std::vector<CellBlock<double>> blocks;
  for (Index c = 0; c < Index(lattice.tets.size()); ++c)
    blocks.push_back(block_of(lattice, c, make_cell(elements, lattice, c, lattice.tets[c], s)));
  return blocks;
}

// The energy that cell.h states, from the formula alone [J].
double energy(const Elements& elements, const Lattice& lattice, Stiffening stiffening,
              const std::vector<double>& q) {
  double W = 0;
  const Law<double> law = nonlinear_law(elements, 0);
  for (Index c = 0; c < Index(lattice.tets.size()); ++c) {
    const Cell cell = make_cell(elements, lattice, c, lattice.tets[c], stiffening);
    Eigen::Matrix<double, 3, 8> amplitudes = Eigen::Matrix<double, 3, 8>::Zero();
    for (int m = 0; m < 8; ++m)
      for (int n = 0; n < 8; ++n)
        amplitudes.col(m) += sign(m, n) / 8 * Eigen::Map<const Vec3d>(q.data() + 4 * lattice.nodes[c][n]);
    const Mat3<double> H =
        2 / lattice.spacing * amplitudes.middleCols<3>(1) + amplitudes.rightCols<4>() * cell.mean.transpose();
    const Eigen::Matrix<double, 3, 4> h =
        (Mat3<double>::Identity() + H).transpose() * amplitudes.rightCols<4>();
    const Eigen::Map<const Eigen::Matrix<double, 12, 1>> all(h.data());
    W += cell.volume * law_energy_density(law, H) + 0.5 * all.dot(cell.K * all);
  }
  return W;
}

std::vector<double> any_nodes(const Lattice& lattice, double size) {
  std::vector<double> q(4 * std::size_t(lattice.node_count), 0);
  for (std::size_t i = 0; i < q.size(); ++i)
    if (i % 4 != 3) q[i] = size * std::sin(1.7 * double(i) + 0.3);
  return q;
}

std::vector<Vec3d> node_places(const Lattice& lattice) {
  std::vector<Vec3d> places(lattice.node_count);
  for (std::size_t c = 0; c < lattice.nodes.size(); ++c)
    for (int n = 0; n < 8; ++n)
      places[lattice.nodes[c][n]] =
          lattice.centres[c] + lattice.spacing / 2 * Vec3d(sign(1, n), sign(2, n), sign(3, n));
  return places;
}

}  // namespace

TEST_CASE("embedded vertices follow affine displacements of the nodes exactly") {
  const Elements elements(block_body());
  const Lattice lattice = make_lattice(elements, spacing);
  const std::vector<Vec3d> places = node_places(lattice);
  for (Index v = 0; v < elements.topology.vertex_count(); ++v) {
    Vec3d sum = Vec3d::Zero();
    for (int n = 0; n < 8; ++n)
      sum += lattice.weights[v][n] * places[lattice.nodes[lattice.cell_of_vertex[v]][n]];
    CHECK((sum - elements.points.col(v)).norm() < 1e-15);
  }
}

TEST_CASE("forces of cells are the slopes of their energy, in both precisions") {
  const Elements elements(block_body());
  const Lattice lattice = make_lattice(elements, spacing);
  for (Stiffening s : {Stiffening::fluctuation, Stiffening::relaxed, Stiffening::homogenised}) {
    std::vector<double> q = any_nodes(lattice, 0.002), f(q.size(), 0);
    add_cell_forces(blocks_of(elements, lattice, s), law_of(block_body()), q.data(), f.data());
    double norm = 0;
    for (double x : f) norm = std::max(norm, std::abs(x));
    for (std::size_t i = 0; i < q.size(); i += 7) {
      if (i % 4 == 3) continue;
      const double at = q[i], step = 1e-7;
      q[i] = at + step;
      const double above = energy(elements, lattice, s, q);
      q[i] = at - step;
      const double below = energy(elements, lattice, s, q);
      q[i] = at;
      CHECK(f[i] == near(-(above - below) / (2 * step), 1e-6, norm));
    }
  }
}

TEST_CASE("cells exert no force and no torque on themselves, and none where they turn") {
  const Elements elements(block_body());
  const Lattice lattice = make_lattice(elements, spacing);
  const auto blocks = blocks_of(elements, lattice, Stiffening::relaxed);
  const std::vector<Vec3d> places = node_places(lattice);
  const std::vector<double> q = any_nodes(lattice, 0.002);
  std::vector<double> f(q.size(), 0), turned(q.size(), 0), none(q.size(), 0);
  add_cell_forces(blocks, law_of(block_body()), q.data(), f.data());
  Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();
  double norm = 0;
  const Mat3<double> R = Eigen::AngleAxisd(2, Vec3d(1, 2, -1).normalized()).toRotationMatrix();
  for (Index n = 0; n < lattice.node_count; ++n) {
    const Eigen::Map<const Vec3d> own(f.data() + 4 * n), u(q.data() + 4 * n);
    force += own;
    torque += (places[n] + u).cross(own);
    norm += own.norm();
    Eigen::Map<Vec3d>(turned.data() + 4 * n) = R * places[n] - places[n];
  }
  CHECK(force.norm() < 1e-14 * norm);
  CHECK(torque.norm() < 1e-15 * norm);
  add_cell_forces(blocks, law_of(block_body()), turned.data(), none.data());
  for (double x : none) CHECK(std::abs(x) < 1e-12 * norm);
}

TEST_CASE("of relaxed cells no hourglass is stiffer than the tetrahedra that follow it") {
  const Elements elements(block_body());
  const Lattice lattice = make_lattice(elements, spacing);
  for (Index c = 0; c < Index(lattice.tets.size()); ++c) {
    const auto stiffness = [&](Stiffening s) {
      return make_cell(elements, lattice, c, lattice.tets[c], s, 0).K;
    };
    const Eigen::Matrix<double, 12, 12> galerkin = stiffness(Stiffening::galerkin);
    for (Stiffening s : {Stiffening::relaxed, Stiffening::homogenised}) {
      const Eigen::Matrix<double, 12, 12> K = stiffness(s);
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 12, 12>> less(galerkin - K), own(K);
      CHECK(less.eigenvalues()[0] > -1e-6 * galerkin.trace());
      CHECK(own.eigenvalues()[0] > -1e-6 * galerkin.trace());
    }
    CHECK((galerkin - stiffness(Stiffening::relaxed)).trace() > 0.01 * galerkin.trace());
  }
}

TEST_CASE("embedding keeps linear momentum; freeing moves no vertex") {
  const Body body = block_body(box_mesh({0.06, 0.04, 0.08}, 6, 4, 8));  // as wide as 3, 2, 4 cells
  std::vector<std::uint8_t> held, zone;
  for (Index v = 0; v < body.mesh.vertex_count(); ++v) {
    held.push_back(body.mesh.points(2, v) < 0.001);
    zone.push_back(body.mesh.points(2, v) > 0.065);
  }
  TrialBody<double> trial(body, held, {.spacing = 0.02});
  std::vector<Index> top;
  for (Index v = 0; v < body.mesh.vertex_count(); ++v)
    if (body.mesh.points(2, v) > 0.0799) top.push_back(v);
  Mat3X<double> targets(3, top.size());
  const auto pull = [&](int steps, double speed) {
    trial.grasp(top);
    for (int n = 0; n < steps; ++n) {
      for (std::size_t k = 0; k < top.size(); ++k)
        targets.col(Index(k)) = trial.u().col(top[k]) + Vec3d(speed * 1e-4, 0, 0);
      trial.step(1e-4, targets);
    }
    trial.grasp({});
  };
  pull(200, 0.2);
  const Vec3d before = trial.momentum();
  trial.set_zone(zone);
  CHECK(trial.added_mass() < 1e-12);
  CHECK((trial.momentum() - before).norm() < 1e-12 * before.norm());
  const double share = trial.full_share();
  CHECK((share > 0.2 && share < 0.9));
  pull(200, -0.2);
  trial.expand();
  const Mat3X<double> u = trial.u();
  trial.set_zone(std::vector<std::uint8_t>(held.size(), 1));
  CHECK((trial.u() - u).norm() == 0);
  CHECK(trial.full_share() == 1);
}

TEST_CASE("lobe bench reduced writes frequencies and errors, and is near the body that is all non-linear") {
  const BenchResults results("reduced", "--quick");
  CHECK(results.rows("reduced_frequencies").size() == 4);
  const std::vector<Record> rows = results.rows("reduced");
  REQUIRE(rows.size() == 10);
  for (const Record& row : rows) {
    CHECK((number(row, "largest_error") > 0 && number(row, "largest_error") < 0.3));
    CHECK(number(row, "full_share") <= 1);
  }
}
