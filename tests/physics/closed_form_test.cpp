// Whole bodies against closed forms: positions are prescribed everywhere, nothing is solved.
#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

#include "lobe/diagnostics/fields.h"
#include "lobe/fem/svk.h"
#include "lobe/sim/world.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double radius = 0.1, length = 0.1, twist = std::numbers::pi / 2;  // [m], [m], [rad/m]

// Torque that turns the upper end of a twisted cylinder [N m].
double end_torque(RegionModel model, int rings, int layers) {
  const TetMesh mesh = cylinder_mesh(radius, length, rings, layers);
  World<double> world(setup_of(mesh, model));
  State<double> state = world.state();
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3d X = mesh.points.col(v);
    const double angle = twist * X.z();
    if (model == RegionModel::tensor_mass)
      state.u.col(v) = angle * Vec3d(-X.y(), X.x(), 0);
    else
      state.u.col(v) = Eigen::AngleAxisd(angle, Vec3d::UnitZ()) * X - X;
  }
  world.set_state(state);
  const Mat3X<double>& f = world.forces();
  double torque = 0;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (std::abs(mesh.points(2, v) - length) > 1e-9) continue;
    const Vec3d x = mesh.points.col(v) + state.u.col(v);
    const Vec3d arm = model == RegionModel::tensor_mass ? Vec3d(mesh.points.col(v)) : x;
    torque -= arm.x() * f(1, v) - arm.y() * f(0, v);
  }
  return torque;
}

}  // namespace

TEST_CASE("torsion of a cylinder: the end torque converges to 2.4674 N m (linear) and 2.5892 N m (SVK)") {
  const double a = radius, lambda = 4e4, mu = 1e4;
  const double linear = 2 * std::numbers::pi * mu * twist * std::pow(a, 4) / 4;
  const double svk =
      linear + 2 * std::numbers::pi * (lambda / 2 + mu) * std::pow(twist, 3) * std::pow(a, 6) / 6;
  CHECK(linear == doctest::Approx(2.4674).epsilon(1e-4));
  CHECK(svk == doctest::Approx(2.5892).epsilon(1e-4));
  for (const auto& [model, exact] :
       {std::pair(RegionModel::tensor_mass, linear), std::pair(RegionModel::nonlinear, svk)}) {
    const double coarse = std::abs(end_torque(model, 6, 6) / exact - 1);
    const double fine = std::abs(end_torque(model, 12, 12) / exact - 1);
    CHECK(fine < 0.02);
    CHECK(std::log2(coarse / fine) > 0.9);
  }
}

TEST_CASE("code_aster SSNV122: stretch 1.1 in plane strain, one side free, gives 26610.3 MPa") {
  const double young = 2e5, poisson = 0.3, stretch = 1.1;
  const double lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson)),
               mu = young / (2 * (1 + poisson));
  // S_yy = λ (E_xx + E_yy) + 2μ E_yy = 0 with E_xx = (s² − 1)/2
  const double Exx = (stretch * stretch - 1) / 2, Eyy = -lambda * Exx / (lambda + 2 * mu);
  const double side = std::sqrt(1 + 2 * Eyy);
  CHECK(side == doctest::Approx(0.953939).epsilon(1e-6));
  const Mat3<double> H = Vec3d(stretch - 1, side - 1, 0).asDiagonal();
  const Mat3<double> P = svk_stress(H, lambda, mu);
  CHECK(std::abs(P(1, 1)) < 1e-9 * young);
  CHECK(P(0, 0) / side == doctest::Approx(26610.307).epsilon(1e-7));  // Cauchy: σ = P Fᵀ / det F
}

TEST_CASE("an infinitesimal rotation, free for the linear model, inflates the body by θ²") {
  const TetMesh mesh = irregular_box();
  World<double> world(setup_of(mesh, RegionModel::tensor_mass));
  for (const auto& [degrees, inflation] :
       {std::pair(15., 0.0685), std::pair(30., 0.2742), std::pair(45., 0.6169)}) {
    const double theta = degrees * std::numbers::pi / 180;
    State<double> state = world.state();
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      state.u.col(v) = theta * Vec3d(-mesh.points(1, v), mesh.points(0, v), 0);
    world.set_state(state);
    CHECK(world.forces().norm() < 1e-13);
    const double growth = current_volume(world.elements(), state.u) / total_volume(mesh) - 1;
    CHECK(growth == doctest::Approx(theta * theta).epsilon(1e-10));
    CHECK(growth == doctest::Approx(inflation).epsilon(1e-3));
  }
}
