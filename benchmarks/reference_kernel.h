// The plain reference kernel: the internal force of SVK tetrahedra as the formula reads, one element after
// the other, in double precision, on one thread.
//
// NEVER OPTIMISE IT: no SIMD, no threads, no reordering, no clever algebra. Every ratio that a benchmark
// prints is a time divided by the time of this loop in the same run, which is what makes figures of
// different machines and different years comparable. It is also what every kernel's forces are checked
// against, so it shares no code with them.
#pragma once

#include <array>
#include <vector>

#include "lobe/setup/setup.h"

namespace lobe::bench {

struct ReferenceTet {
  Eigen::Vector4i corners;
  Mat34<double> alpha;     // α_j [1/m], one column per corner
  double V = 0;            // [m³]
  double lambda = 0;       // [Pa]
  double mu = 0;           // [Pa]
  double corner_mass = 0;  // ρV/4 [kg]
};

std::vector<ReferenceTet> reference_tets(const Setup& setup);

// f_j += −V F S α_j with F = I + Σ u_j ⊗ α_j, E = ½(FᵀF − I), S = λ tr(E) I + 2μE. This is the loop that is
// timed.
void add_reference_forces(const std::vector<ReferenceTet>& tets,
                          const Mat3X<double>& u,  // 3 × #vertices [m]
                          Mat3X<double>& f);       // 3 × #vertices [N]

// The same for small displacements: f_j += −V (λ tr(ε) I + 2με) α_j, ε = ½(∇u + ∇uᵀ). Only to check.
void add_reference_linear_forces(const std::vector<ReferenceTet>& tets, const Mat3X<double>& u,
                                 Mat3X<double>& f);

// The volume term, f_p += −κ v|v| ∂V/∂x_p (lobe/fem/volume_term.h), from area vectors. Only to check.
void add_reference_volume_forces(const std::vector<ReferenceTet>& tets,
                                 const Mat3X<double>& x,  // 3 × #vertices, current positions [m]
                                 double kappa,            // [Pa]
                                 Mat3X<double>& f);

// SVK whose whole pressure is averaged around vertices (lobe/region/nodal_pressure.h, w = 1), of bodies of
// one material. Only to check.
void add_reference_nodal_pressure_forces(const std::vector<ReferenceTet>& tets, const Mat3X<double>& u,
                                         Mat3X<double>& f);

// SVK of edge-smoothed tetrahedra (lobe/fem/smoothed_edge.h), of bodies of one material; with nodal pressure,
// the whole pressure is averaged around vertices (lobe/region/edge_pressures.h). Only to check.
void add_reference_smoothed_forces(const std::vector<ReferenceTet>& tets, const Mat3X<double>& u,
                                   bool nodal_pressure, Mat3X<double>& f);

// What a fibre adds to SVK, S = ε (I₄ I + tr(E) A) + 2η (A E + E A) + β I₄ A with A = a⊗a, and the forces of
// a neo-Hookean body, P = μ (F − cof F) + (λ + μ)(det F − 1) cof F. Only to check.
void add_reference_fibre_forces(const std::vector<ReferenceTet>& tets, const Mat3X<double>& u,
                                const FibreModuli<double>& fibre, const Vec3d& a, Mat3X<double>& f);
void add_reference_neo_hookean_forces(const std::vector<ReferenceTet>& tets, const Mat3X<double>& u,
                                      Mat3X<double>& f);
// Yeoh's: P = 2w′ J^(−2/3) (F − I₁/3 F⁻ᵀ) + K (J − 1) J F⁻ᵀ, w′ = μ/2 + 2c₂ q + 3c₃ q². Only to check.
void add_reference_yeoh_forces(const std::vector<ReferenceTet>& tets, const Mat3X<double>& u,
                               const std::array<double, 2>& c, Mat3X<double>& f);
// Mooney and Rivlin's: P = 2c₁₀ J^(−2/3) (F − I₁/3 F⁻ᵀ) + 2c₀₁ J^(−4/3) (I₁ F − F C − 2I₂/3 F⁻ᵀ)
// + K (J − 1) J F⁻ᵀ. Holzapfel's, of both families a: the first and last of these with c₁₀ = μ/2, and
// 2k₁ E exp(k₂ E²) F a⊗a, E = max(|F a|² − 1, 0). Only to check.
void add_reference_mooney_rivlin_forces(const std::vector<ReferenceTet>& tets, const Mat3X<double>& u,
                                        double c01, Mat3X<double>& f);
void add_reference_holzapfel_forces(const std::vector<ReferenceTet>& tets, const Mat3X<double>& u,
                                    const std::array<double, 2>& k, const std::array<Vec3d, 2>& families,
                                    Mat3X<double>& f);
// Corotational: P = 2μ (F − R) + λ tr(RᵀF − I) R, R from a singular value decomposition. Only to check.
void add_reference_corotational_forces(const std::vector<ReferenceTet>& tets, const Mat3X<double>& u,
                                       Mat3X<double>& f);

}  // namespace lobe::bench
