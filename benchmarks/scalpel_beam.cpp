// Statics of a beam with a slit, cut by a blade and on a mesh that follows the slit.
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "benchmarks/scalpel.h"
#include "lobe/mesh/generators.h"
#include "lobe/solve/static_solver.h"

namespace lobe::bench {
namespace {

Setup slit_beam(int n) {
  Setup setup;
  setup.mesh = box_mesh({0.16, 0.04, 0.04}, 16 * n, 4 * n, 4 * n);
  setup.materials = {{4e5, 1e5, 1000}};
  return setup;
}

double sag(Setup setup) {
  const auto tets = std::size_t(setup.mesh.tet_count());
  setup.scalpels.clear();
  setup.gravity = {0, 0, -9.81};
  setup.material_of.assign(tets, 0);
  setup.region_of.assign(tets, RegionModel::tensor_mass);
  setup.prescribed.clear();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < 1e-9) setup.prescribed.push_back({v});
  const StaticResult solved = solve_static(setup);
  if (!solved.converged) throw WrongResult("the beam has no equilibrium: " + solved.reason);
  double sum = 0;
  int count = 0;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) > 0.16 - 1e-9) {
      sum -= solved.u(2, v);
      ++count;
    }
  return sum / count;
}

TetMesh conforming_mesh(const Grains& grains) {
  TetMesh mesh{Mat3X<double>(3, grains.point_count()), Tets(4, grains.count()), {}};
  for (Index p = 0; p < grains.point_count(); ++p) mesh.points.col(p) = grains.point(p);
  for (Index g = 0; g < grains.count(); ++g) mesh.tets.col(g) = grains[g].points;
  mesh.labels.assign(std::size_t(grains.count()), 0);
  return mesh;
}

}  // namespace

BeamRow measure_beam(int n) {
  Setup setup = slit_beam(n);
  const auto tets = std::size_t(setup.mesh.tet_count());
  setup.material_of.assign(tets, 0);
  setup.region_of.assign(tets, RegionModel::tensor_mass);
  BeamRow row{10.0 / n, setup.mesh.tet_count()};
  row.whole = sag(setup);
  setup.scalpels = {on_path(
      {{{0.068, -0.02, 0.06}, {0.068, 0.06, 0.06}}, {{0.083, -0.02, 0.02}, {0.083, 0.06, 0.02}}}, 20)};
  World<double> world(setup);
  const double swept = 0.04 * std::hypot(0.0075, 0.02);  // within the beam [m²]
  row.rim = (play_cut(world, 20).area - swept) / (0.04 * world.grains()->mean_edge());
  CompactMesh compacted;
  row.cut = sag(world.current_setup(compacted));
  row.grains = world.grains()->count();
  Setup fine = slit_beam(n);
  fine.mesh = conforming_mesh(*world.grains());
  row.conforming = sag(fine);
  return row;
}

namespace {

SagOrders least_squares(const std::vector<BeamRow>& rows) {
  const auto n = Eigen::Index(rows.size());
  Eigen::MatrixXd powers = Eigen::MatrixXd::Zero(2 * n, 3);
  Eigen::VectorXd sags(2 * n);
  powers.col(0).setOnes();
  for (Eigen::Index i = 0; i < n; ++i) {
    sags[i] = rows[std::size_t(i)].cut;
    sags[n + i] = rows[std::size_t(i)].conforming;
  }
  SagOrders best;
  best.rms = std::numeric_limits<double>::infinity();
  constexpr int most = 300;  // hundredths
  for (int p = 10; p <= most; ++p)
    for (int q = 10; q <= most; ++q) {
      for (Eigen::Index i = 0; i < n; ++i) {
        const double h = rows[std::size_t(i)].cell_mm;
        powers(i, 1) = -std::pow(h, 0.01 * p);
        powers(n + i, 2) = -std::pow(h, 0.01 * q);
      }
      const Eigen::Vector3d fit = powers.householderQr().solve(sags);
      const double rms = (powers * fit - sags).norm() / std::sqrt(double(2 * n));
      if (rms < best.rms) best = {fit[0], 0.01 * p, 0.01 * q, rms};
    }
  return best;
}

}  // namespace

SagOrders fit_orders(const std::vector<BeamRow>& rows) {
  SagOrders found = least_squares(rows);
  if (rows.size() < 4) return found;
  found.least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::vector<BeamRow> others = rows;
    others.erase(others.begin() + std::ptrdiff_t(i));
    const SagOrders without = least_squares(others);
    found.least = std::min({found.least, without.cut, without.conforming});
    found.most = std::max({found.most, without.cut, without.conforming});
  }
  return found;
}

}  // namespace lobe::bench
