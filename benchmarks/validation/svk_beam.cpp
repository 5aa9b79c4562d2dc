// The cantilever of SofaCaribou's unit test (test_static.cpp): 15 × 15 × 80, E = 3000, traction −30 on its
// end. P1 tetrahedra against a quadratic solution, and locking as ν → ½.
#include <cmath>

#include "benchmarks/validation/bodies.h"
#include "benchmarks/validation/cases.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/material_constants.h"
#include "lobe/text.h"

namespace lobe::validation {
namespace {

constexpr double side = 15, bar = 80, modulus = 3000, traction = -30;

// Displacement of the centre of the end; `share` of λ's pressure is averaged at nodes.
Vec3d end_displacement(double poisson, int cells, double share = 0) {
  const LamePair lame = lame_from_young(modulus, poisson);
  Setup setup = body_of(box_mesh({side, side, bar}, cells, cells, 4 * cells),
                        {lame.lambda, lame.mu, 1, share}, RegionModel::nonlinear);
  prescribe(setup, vertices_where(setup.mesh, [](const Vec3d& X) { return X.z() == 0; }),
            [](const Vec3d&) { return Vec3d::Zero(); });
  load_faces(
      setup, [](const Vec3d& X) { return X.z() == bar; }, [](const Vec3d&) { return Vec3d(0, traction, 0); });
  const Vec3d centre(side / 2, side / 2, bar);
  const Index v =
      vertices_where(setup.mesh, [&](const Vec3d& X) { return (X - centre).norm() < 1e-9; }).front();
  return equilibrium(setup).col(v);
}

constexpr const char* quadratic = "Q2 hexahedra, 3 × 3 × 12";

constexpr const char* trial = "separate trial code";

void known_meshes(Findings& findings) {
  struct Known {
    double poisson;
    int cells;
    double uy, digit;  // the last digit that is known
  };
  for (const Known& k :
       {Known{0.3, 2, -34.5047, 1e-4}, Known{0.3, 4, -46.43, 1e-2}, Known{0.3, 6, -49.54, 1e-2},
        Known{0.45, 2, -24.09, 1e-2}, Known{0.499, 2, -4.49129, 1e-5}})
    findings.value("ν = " + rounded(k.poisson) + ", " + std::to_string(k.cells) + " cells across" +
                       (k.poisson > 0.4 ? ", locked" : ""),
                   "u_y of the end", "-", end_displacement(k.poisson, k.cells).y(), {k.uy, trial},
                   {k.digit / 2 / std::abs(k.uy), "digits of the reference"});
}

// Near ν = ½, with averaged nodal pressure.
void unlocked(Findings& findings) {
  struct Known {
    double share;
    int cells;
    double uy;
  };
  for (const Known& k : {Known{1, 2, -30.287}, Known{1, 4, -44.514}, Known{0.985, 2, -21.626}})
    findings.value(
        "ν = 0.499, " + std::to_string(k.cells) + " cells across, nodal pressure " + rounded(k.share),
        "u_y of the end", "-", end_displacement(0.499, k.cells, k.share).y(), {k.uy, trial},
        {0.0005 / std::abs(k.uy), "digits of the reference"});
}

// Q1 hexahedra on the same 3 × 3 × 9 nodes lock, too: −21.0164 where the limit is near −52. A share of 0.985
// is as stiff as they are, the whole of λ closer to the limit, which is known from quadratic elements at ν =
// 0.4.
void against_other_elements(Findings& findings, bool quick) {
  findings.value("ν = 0.499, 2 cells across, nodal pressure 0.985", "u_y of the end", "-",
                 end_displacement(0.499, 2, 0.985).y(), {-21.0164, "Q1 hexahedra, same nodes"},
                 {0.1, "another element"});
  if (quick) return;
  const Vec3d reference(0, -51.662, -23.599);
  std::vector<Vec3d> ends;
  for (int n : {2, 4, 8}) ends.push_back(end_displacement(0.4, n, 1));
  for (int axis : {1, 2})
    findings.value("ν = 0.4, nodal pressure 1, extrapolated", axis == 1 ? "u_y of the end" : "u_z of the end",
                   "-", romberg(ends[0][axis], ends[1][axis], ends[2][axis]),
                   {reference[axis], "Q2 hexahedra, 2 × 2 × 8"},
                   {0.015, "extrapolation, mesh of the reference"});
}

// Errors are even powers of h where the mesh is fine enough: two meshes remove h² (quick: a third removes
// h⁴).
void refined(Findings& findings, bool quick) {
  const std::vector<int> cells = quick ? std::vector{2, 4, 8} : std::vector{4, 6, 12};
  const Vec3d reference(0, -52.380, -24.201);
  std::vector<Vec3d> ends;
  for (int n : cells) ends.push_back(end_displacement(0.3, n));
  for (int axis : {1, 2}) {
    const std::string quantity = axis == 1 ? "u_y of the end" : "u_z of the end";
    std::vector<double> sizes, errors;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      sizes.push_back(1.0 / cells[i]);
      errors.push_back(std::abs(ends[i][axis] / reference[axis] - 1));
    }
    findings.study(quantity, sizes, errors);
    if (!quick)
      findings.order("ν = 0.3", quantity, observed_order(sizes, errors), 2,
                     {0.1, "meshes are not yet in the limit"});
    const double limit = quick ? romberg(ends[0][axis], ends[1][axis], ends[2][axis])
                               : extrapolate_order(ends[1][axis], ends[2][axis], 2).limit;
    findings.value("ν = 0.3, extrapolated", quantity, "-", limit, {reference[axis], quadratic},
                   {0.01, "extrapolation, mesh of the reference"});
    findings.value("ν = 0.3, " + std::to_string(cells[2]) + " cells across", quantity, "-", ends[2][axis],
                   {reference[axis], quadratic},
                   {std::abs(ends[2][axis] / limit - 1) + 0.01, "mesh error by extrapolation + 1 %"});
  }
}

}  // namespace

void svk_beam(Findings& findings, bool quick) {
  known_meshes(findings);
  unlocked(findings);
  against_other_elements(findings, quick);
  refined(findings, quick);
}

}  // namespace lobe::validation
