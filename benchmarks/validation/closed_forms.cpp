// Closed forms of the St Venant-Kirchhoff model, found by the static solver: mean stress and torque.
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "benchmarks/validation/bodies.h"
#include "benchmarks/validation/cases.h"
#include "lobe/fem/svk.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/material_constants.h"
#include "lobe/text.h"

namespace lobe::validation {
namespace {

constexpr Elastic liver{4e4, 1e4, 1000};  // of [PDA]
constexpr double edge = 0.03;             // of the cube [m]
const Tolerance solver{1e-8, "the solver's residual"};

Setup cube(const Elastic& elastic) {
  return body_of(jittered(box_mesh(Vec3d::Constant(edge), 3, 3, 3), edge / 3, 0.2, 3, false), elastic,
                 RegionModel::nonlinear);
}

bool at(double coordinate, double plane) { return std::abs(coordinate - plane) < 1e-9 * edge; }

// F = I + γ e₁⊗e₂: lower and upper plane (y) prescribed, the exact traction as a dead load on the other
// sides.
Mat3<double> sheared(double gamma) {
  Mat3<double> H = Mat3<double>::Zero();
  H(0, 1) = gamma;
  Setup setup = cube(liver);
  const Mat3<double> P = svk_stress(H, liver.lambda, liver.mu);
  const auto plates = [](const Vec3d& X) { return at(X.y(), 0) || at(X.y(), edge); };
  prescribe(setup, vertices_where(setup.mesh, plates), [&](const Vec3d& X) { return H * X; });
  for (int axis : {0, 2})
    for (double plane : {0.0, edge})
      load_faces(
          setup, [&](const Vec3d& X) { return at(X[axis], plane); }, [&](const Vec3d& N) { return P * N; });
  return mean_stress(setup, equilibrium(setup));
}

void simple_shear(Findings& findings) {
  const double g_known[] = {0.1, 0.5, 1.0};
  for (double g : g_known) {
    const Mat3<double> P = sheared(g);
    const std::string name = "simple shear, γ = " + std::to_string(g).substr(0, 3);
    const double modulus = liver.lambda / 2 + liver.mu;
    findings.value(name, "P_xy", "Pa", P(0, 1), {liver.mu * g + modulus * g * g * g, "μγ + (λ/2 + μ)γ³"},
                   solver);
    findings.value(name, "P_yx", "Pa", P(1, 0), {liver.mu * g, "μγ"}, solver);
    findings.value(name, "P_yy", "Pa", P(1, 1), {modulus * g * g, "(λ/2 + μ)γ²"}, solver);
    findings.value(name, "P_zz", "Pa", P(2, 2), {liver.lambda * g * g / 2, "λγ²/2"}, solver);
  }
}

// Mean stress of a cube whose whole surface follows F.
Mat3<double> prescribed_stress(const Elastic& elastic, const Mat3<double>& F) {
  Setup setup = cube(elastic);
  prescribe(setup, outer_vertices(setup.mesh), [&](const Vec3d& X) { return F * X - X; });
  return mean_stress(setup, equilibrium(setup));
}

void hydrostatic(Findings& findings) {
  for (double s : {0.8, 1.2}) {
    const double expected = (3 * liver.lambda + 2 * liver.mu) * s * (s * s - 1) / 2;
    findings.value("hydrostatic, stretch " + std::to_string(s).substr(0, 3), "P_xx", "Pa",
                   prescribed_stress(liver, s * Mat3<double>::Identity())(0, 0),
                   {expected, "(3λ + 2μ) s (s² − 1)/2"}, solver);
  }
}

// Rollers on three planes, the opposite end of the x axis displaced, the other sides free.
void uniaxial(Findings& findings) {
  const double E = young_modulus(liver.lambda, liver.mu), nu = poisson_ratio(liver.lambda, liver.mu);
  for (double s : {0.58, 0.7, 0.9, 1.1, 1.3, 1.5}) {
    Setup setup = cube(liver);
    for (int axis : {0, 1, 2}) slide(setup, axis, 0);
    slide(setup, 0, edge, (s - 1) * edge);
    const Mat3X<double> u = equilibrium(setup);
    const std::string name = "uniaxial, free sides, stretch " + rounded(s);
    findings.value(name, "P_xx", "Pa", mean_stress(setup, u)(0, 0),
                   {E * s * (s * s - 1) / 2, "E s (s² − 1)/2"}, solver);
    findings.value(name, "lateral stretch", "-", 1 + u.row(1).minCoeff() / edge + u.row(1).maxCoeff() / edge,
                   {std::sqrt(1 - nu * (s * s - 1)), "√(1 − ν(s² − 1))"}, solver);
  }
}

Elastic steel() {  // of code_aster's tests [MPa]
  const LamePair lame = lame_from_young(2e5, 0.3);
  return {lame.lambda, lame.mu, 1};
}

// Turned by 30°; the Cauchy stress along the turned axis.
void ssnv121(Findings& findings) {
  const Mat3<double> R = Eigen::AngleAxisd(std::numbers::pi / 6, Vec3d::UnitZ()).toRotationMatrix();
  const Mat3<double> F = R * Vec3d(1.1, 1, 1).asDiagonal();
  const Mat3<double> cauchy = prescribed_stress(steel(), F) * F.transpose() / F.determinant();
  findings.value("code_aster SSNV121, uniaxial strain", "σ", "MPa", R.col(0).dot(cauchy * R.col(0)),
                 {31096.154, "code_aster V6.04.121"}, {1e-7, "digits of the reference"});
}

// Plane strain, one side free; the Cauchy stress is the reaction on the deformed end.
void ssnv122(Findings& findings) {
  Setup setup = cube(steel());
  for (int axis : {0, 1, 2}) slide(setup, axis, 0);
  slide(setup, 0, edge, 0.1 * edge);
  slide(setup, 2, edge);
  const Mat3X<double> u = equilibrium(setup);
  const double side = 1 + u.row(1).minCoeff() / edge;
  findings.value("code_aster SSNV122, plane strain, side free", "lateral stretch", "-", side,
                 {0.953939, "closed form"}, {1e-6, "digits of the reference"});
  findings.value("code_aster SSNV122, plane strain, side free", "σ", "MPa",
                 mean_stress(setup, u)(0, 0) / side, {26610.3, "code_aster V6.04.122"},
                 {2e-6, "digits of the reference"});
}

constexpr double radius = 0.1, length = 0.1, twist = std::numbers::pi / 2;  // [m], [m], [rad/m]

// Torque on the upper end of a twisted cylinder [N m]. Linear: the ends are prescribed, the sides free. SVK:
// nothing is solved, since the displacement is no equilibrium without loads.
double end_torque(RegionModel model, int rings) {
  const bool linear = model == RegionModel::tensor_mass;
  Setup setup = body_of(cylinder_mesh(radius, length, rings, rings), liver, model);
  const auto turned = [&](const Vec3d& X) -> Vec3d {
    const double angle = twist * X.z();
    if (linear) return angle * Vec3d(-X.y(), X.x(), 0);
    return Eigen::AngleAxisd(angle, Vec3d::UnitZ()) * X - X;
  };
  Mat3X<double> u(3, setup.mesh.vertex_count());
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) u.col(v) = turned(setup.mesh.points.col(v));
  const auto ends = [](const Vec3d& X) { return X.z() == 0 || std::abs(X.z() - length) < 1e-9; };
  if (linear) {
    prescribe(setup, vertices_where(setup.mesh, ends), turned);
    u = equilibrium(setup);
  }
  const Mat3X<double> f = internal_forces(setup, u);
  double torque = 0;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
    const Vec3d X = setup.mesh.points.col(v);
    if (std::abs(X.z() - length) > 1e-9) continue;
    const Vec3d arm = linear ? X : Vec3d(X + u.col(v));
    torque -= arm.x() * f(1, v) - arm.y() * f(0, v);
  }
  return torque;
}

void torsion(Findings& findings, bool quick) {
  const double a = radius;
  const double linear = 2 * std::numbers::pi * liver.mu * twist * std::pow(a, 4) / 4;
  const double svk =
      linear + 2 * std::numbers::pi * (liver.lambda / 2 + liver.mu) * std::pow(twist, 3) * std::pow(a, 6) / 6;
  struct Torsion {
    const char* name;
    RegionModel model;
    Reference torque;
  };
  for (const Torsion& t :
       {Torsion{"torsion of a cylinder, linear", RegionModel::tensor_mass, {linear, "2πμψa⁴/4"}},
        Torsion{
            "torsion of a cylinder, SVK", RegionModel::nonlinear, {svk, "2π(μψa⁴/4 + (λ/2 + μ)ψ³a⁶/6)"}}}) {
    std::vector<double> sizes, errors, torques;
    for (int rings : quick ? std::vector{3, 6, 12} : std::vector{4, 8, 16}) {
      torques.push_back(end_torque(t.model, rings));
      sizes.push_back(1.0 / rings);
      errors.push_back(std::abs(torques.back() / t.torque.value - 1));
    }
    findings.study(t.name, sizes, errors);
    findings.order(t.name, "torque", observed_order(sizes, errors), 2,
                   {0.1, "meshes are not yet in the limit"});
    findings.value(t.name, "torque, extrapolated", "N m", extrapolate_order(torques[1], torques[2], 2).limit,
                   t.torque, {0.005, "extrapolation"});
  }
}

}  // namespace

void closed_forms(Findings& findings, bool quick) {
  simple_shear(findings);
  hydrostatic(findings);
  uniaxial(findings);
  ssnv121(findings);
  ssnv122(findings);
  torsion(findings, quick);
}

}  // namespace lobe::validation
