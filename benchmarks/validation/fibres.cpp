// Bodies with fibres against exact solutions: code_aster's SSLV121, whose axis is that of the material, and a
// bar that is pulled at an angle to its fibres.
#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <utility>

#include "benchmarks/validation/bodies.h"
#include "benchmarks/validation/cases.h"
#include "lobe/fem/transverse_isotropy.h"
#include "lobe/mesh/generators.h"
#include "lobe/mesh/tet_mesh.h"

namespace lobe::validation {
namespace {

Index vertex_at(const TetMesh& mesh, const Vec3d& X) {
  return vertices_where(mesh, [&](const Vec3d& Y) { return (X - Y).norm() < 1e-9; }).front();
}

// ---- SSLV121: a parallelepiped hangs from a point of its upper face, under its own weight, held up by the
// uniform stress ρgL there. It stretches along the material's axis and shrinks across.

constexpr double block_weight = 7800 * 9.81, block_height = 3, block_width = 1;  // ρg [N/m³], [m]
constexpr double young_plane = 5e11, young_axis = 2e11;  // E_L, E_N of the manual [Pa]
// The manual's solution has ν_NL = ν_LN E_N/E_L, with ν_LN = 0.3.
constexpr TransverseConstants parallelepiped{young_axis, young_plane, 0.3 * young_axis / young_plane, 0.1,
                                             7.69231e10};

Mat3X<double> hanging(const TetMesh& mesh) {
  Elastic elastic{0, 0, 7800};
  set_transverse(parallelepiped, elastic);
  Setup setup = body_of(mesh, elastic, RegionModel::tensor_mass);
  setup.mesh.fibres = Vec3d(0, 0, 1).replicate(1, mesh.tet_count());
  setup.gravity.z() = -9.81;
  load_faces(
      setup, [](const Vec3d& X) { return X.z() == block_height; },
      [](const Vec3d&) { return Vec3d(0, 0, block_weight * block_height); });
  for (int axis : {0, 1}) slide(setup, axis, 0);  // the planes of symmetry of a quarter
  setup.prescribed.push_back({vertex_at(mesh, {0, 0, block_height}), Vec3d::Zero(), {false, false, true}});
  return equilibrium(setup);
}

Vec3d hanging_exactly(const Vec3d& X) {
  const double slope = block_weight / young_axis, nu = parallelepiped.poisson_along;
  const double across = X.head<2>().squaredNorm(), along = X.z() * X.z() - block_height * block_height;
  return slope * Vec3d(-nu * X.x() * X.z(), -nu * X.y() * X.z(), (along + nu * across) / 2);
}

void sslv121(Findings& findings) {
  std::vector<Mat3X<double>> u;
  std::vector<TetMesh> meshes;
  for (int n : {4, 8, 16}) {
    meshes.push_back(box_mesh({block_width / 2, block_width / 2, block_height}, n, n, 6 * n));
    u.push_back(hanging(meshes.back()));
  }
  const double half = block_width / 2;
  const std::pair<const char*, Vec3d> points[] = {{"B", {0, 0, 0}},
                                                  {"C", {half, 0, 0}},
                                                  {"D", {half, 0, block_height}},
                                                  {"E", {0, 0, block_height / 2}},
                                                  {"X", {0, half, block_height}}};
  for (const auto& [name, X] : points) {
    Vec3d limit;
    for (int axis : {0, 1, 2}) {
      const auto on = [&](std::size_t i) { return u[i](axis, vertex_at(meshes[i], X)); };
      limit[axis] = romberg(on(0), on(1), on(2));
    }
    findings.value("code_aster SSLV121, extrapolated",
                   std::string("distance from the displacement of ") + name, "-",
                   (limit - hanging_exactly(X)).norm() / hanging_exactly(X).norm(),
                   {0, "code_aster V3.04.121, closed form"}, {2.5e-3, "extrapolation"});
  }
}

// ---- A bar along x is pulled by dead loads P on both ends, with fibres in the plane xy at an angle to x.
// Its sides are free and nothing holds it but against rigid motions, so that the strain is the same
// everywhere: the compliance in the material's axes times the stress, turned back (R. M. Jones, Mechanics of
// Composite Materials, section 2.6). It shears as it stretches.

constexpr TransverseConstants muscle{9e4, 3e4, 0.4, 0.35, 2e4};

Mat3<double> strain_per_stress(double angle) {  // of a stress along x [1/Pa]
  const auto& m = muscle;
  const double c = std::cos(angle), s = std::sin(angle);
  const double along = (c * c - m.poisson_along * s * s) / m.young_along,
               across = s * s / m.young_across - m.poisson_along * c * c / m.young_along,
               shear = -c * s / m.shear_along,  // γ
      thick = -m.poisson_along * c * c / m.young_along - m.poisson_across * s * s / m.young_across;
  Mat3<double> strain = Mat3<double>::Zero();
  strain(0, 0) = c * c * along + s * s * across - c * s * shear;
  strain(1, 1) = s * s * along + c * c * across + c * s * shear;
  strain(0, 1) = strain(1, 0) = c * s * (along - across) + (c * c - s * s) * shear / 2;
  strain(2, 2) = thick;
  return strain;
}

// Of an upper triangle, since the x axis keeps its direction and the plane xy its own.
//   linear: ε = P × strain_per_stress.  SVK: P = F S with one entry makes S₁₁ = P/l the only one of S, and
//   FᵀF = I + 2 S₁₁ × strain_per_stress, l² = 1 + 2 S₁₁/E_x.
struct Pulled {
  Mat3<double> gradient;  // ∇u
  double load;            // P [Pa]
};
Pulled pulled(double angle, double stretch, RegionModel model) {
  const Mat3<double> strain = strain_per_stress(angle);
  if (model == RegionModel::tensor_mass) {
    const double stress = (stretch - 1) / strain(0, 0);
    Mat3<double> H = stress * strain;
    H(0, 1) *= 2;
    H(1, 0) = 0;
    return {H, stress};
  }
  const double S = (stretch * stretch - 1) / (2 * strain(0, 0));
  const Mat3<double> C = Mat3<double>::Identity() + 2 * S * strain;
  const Mat3<double> F = C.llt().matrixU();
  return {F - Mat3<double>::Identity(), stretch * S};
}

double off_axis_error(double angle, double stretch, RegionModel model) {
  const Vec3d size(0.1, 0.02, 0.02);
  const TetMesh mesh = box_mesh(size, 10, 2, 2);
  Elastic elastic;
  set_transverse(muscle, elastic);
  Setup setup = body_of(mesh, elastic, model);
  setup.mesh.fibres = Vec3d(std::cos(angle), std::sin(angle), 0).replicate(1, mesh.tet_count());
  const Pulled exact = pulled(angle, stretch, model);
  const auto is_end = [&](const Vec3d& X) { return X.x() == 0 || X.x() > size.x() - 1e-9; };
  load_faces(setup, is_end, [&](const Vec3d& N) { return Vec3d(exact.load * N); });
  setup.prescribed = {{vertex_at(mesh, Vec3d::Zero())},
                      {vertex_at(mesh, {size.x(), 0, 0}), Vec3d::Zero(), {false, true, true}},
                      {vertex_at(mesh, {0, size.y(), 0}), Vec3d::Zero(), {false, false, true}}};
  return relative_maximum(equilibrium(setup), exact.gradient * mesh.points);
}

void off_axis_bar(Findings& findings) {
  for (int degrees : {0, 15, 30, 45, 60, 90})
    for (bool is_large : {false, true}) {
      const auto model = is_large ? RegionModel::nonlinear : RegionModel::tensor_mass;
      findings.value("bar pulled at " + std::to_string(degrees) + "° to its fibres, " +
                         (is_large ? "SVK, stretch 1.3" : "linear"),
                     "largest distance of a vertex, relative", "-",
                     off_axis_error(degrees * std::numbers::pi / 180, is_large ? 1.3 : 1.001, model),
                     {0, "closed form, turned compliance"}, {1e-8, "residual of the solver"});
    }
}

}  // namespace

void fibre_benchmarks(Findings& findings, bool quick) {
  sslv121(findings);
  off_axis_bar(findings);
  if (!quick) land_beam(findings);
}

}  // namespace lobe::validation
