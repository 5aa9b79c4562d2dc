// A body at rest: what it is made of, and which model each of its tetrahedra follows.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "lobe/fem/law_moduli.h"
#include "lobe/fem/prony.h"
#include "lobe/mesh/tet_mesh.h"

namespace lobe {

enum class RegionModel : std::uint8_t {
  tensor_mass = 0,
  precomputed = 1,
  nonlinear = 2,
  reduced = 3,
  corotational = 4
};
// The names of models in scenes and reports.
inline constexpr std::array<const char*, 5> region_model_names{"tensor-mass", "precomputed", "nonlinear",
                                                               "reduced", "corotational"};
inline const char* name(RegionModel model) { return region_model_names[std::size_t(model)]; }
// Whether tetrahedra of this model follow the linear law.
inline constexpr bool is_linear(RegionModel model) {
  return model == RegionModel::tensor_mass || model == RegionModel::precomputed;
}

enum class RegionFrame : std::uint8_t {
  fixed,     // a linear region's displacements are those in space
  corotated  // it is measured from a rigid motion that follows the region (condense/rigid_frame.h)
};

// Where the strain is evaluated: in each tetrahedron, or averaged around each edge (fem/smoothed_edge.h).
enum class ElementType : std::uint8_t { tetrahedron, edge_smoothed };

struct Elastic {
  double lambda = 4e4, mu = 1e4;  // [Pa]
  double density = 1000;          // [kg/m³]
  double nodal_pressure = 0;  // χ: share of λ whose pressure is averaged at nodes, 0…1 (nodal_pressure.h)
  MaterialLaw law = MaterialLaw::svk;  // law of the non-linear model
  ElementType element = ElementType::tetrahedron;
  FibreModuli<double> fibre{};          // [Pa], zero: isotropic; λ and μ are then those across the fibre
  double fracture_energy = 0;           // G_c: work of a blade per area that it opens [J/m²]
  std::array<double, 2> further{};      // constants of the law beside λ and μ (law_rows)
  double fibre_angle = 0;               // angle of both families of a law with fibres to the direction [rad]
  std::array<double, 3> fibre_plane{};  // a vector at rest in their plane; not read if the angle is 0
  std::array<PronyTerm, most_prony_terms> viscosity{};  // the first terms, beside the slow moduli above

  std::span<const PronyTerm> prony_series() const {
    std::size_t terms = 0;
    while (terms < viscosity.size() && viscosity[terms] != PronyTerm{}) ++terms;
    return {viscosity.data(), terms};
  }
  bool is_viscous() const { return !prony_series().empty(); }
  bool relaxes_in_volume() const {
    const auto in_volume = [](const PronyTerm& term) { return term.bulk > 0; };
    return std::any_of(viscosity.begin(), viscosity.end(), in_volume);
  }
  // The solid as which it answers to what is sudden: with all of the moduli that relax.
  Elastic at_once() const;
  bool has_direction() const { return fibre.any() || has_families(law); }
  bool is_smoothed() const { return element == ElementType::edge_smoothed; }
  double nodal_lambda() const { return nodal_pressure * lambda; }    // χλ [Pa]
  double element_lambda() const { return lambda - nodal_lambda(); }  // (1 − χ)λ [Pa]
  double guard_modulus() const {  // M of fem/guard.h [Pa]: the stiffer one of both directions
    return element_lambda() + 2 * mu + std::max(0.0, fibre_excess());
  }
  // By how much uniaxial strain along the fibre is stiffer than across it: C_LL − C_TT [Pa].
  double fibre_excess() const { return 2 * fibre.coupling + 4 * fibre.shear + fibre.stretch; }

  static constexpr auto fields =
      std::tuple(&Elastic::lambda, &Elastic::mu, &Elastic::density, &Elastic::nodal_pressure, &Elastic::law,
                 &Elastic::element, &Elastic::fibre, &Elastic::fracture_energy, &Elastic::further,
                 &Elastic::fibre_angle, &Elastic::fibre_plane, &Elastic::viscosity);
};

inline Elastic Elastic::at_once() const {
  Elastic stiff = *this;
  if (!is_viscous()) return stiff;
  const double K = (lambda + 2 * mu / 3) * lobe::at_once(prony_series(), &PronyTerm::bulk);
  stiff.mu = mu * lobe::at_once(prony_series(), &PronyTerm::shear);
  stiff.lambda = K - 2 * stiff.mu / 3;
  return stiff;
}

inline bool any_nodal_pressure(const std::vector<Elastic>& materials) {
  return std::any_of(materials.begin(), materials.end(),
                     [](const Elastic& e) { return e.nodal_lambda() > 0; });
}

inline bool any_smoothed(const std::vector<Elastic>& materials) {
  return std::any_of(materials.begin(), materials.end(), [](const Elastic& e) { return e.is_smoothed(); });
}
// Whether the energy has averages of several tetrahedra.
inline bool any_averages(const std::vector<Elastic>& materials) {
  return any_nodal_pressure(materials) || any_smoothed(materials);
}

inline bool any_viscous(const std::vector<Elastic>& materials) {
  return std::any_of(materials.begin(), materials.end(), [](const Elastic& e) { return e.is_viscous(); });
}

inline bool any_fibre(const std::vector<Elastic>& materials) {
  return std::any_of(materials.begin(), materials.end(), [](const Elastic& e) { return e.has_direction(); });
}
inline bool any_other_law(const std::vector<Elastic>& materials) {  // other than St Venant-Kirchhoff
  return std::any_of(materials.begin(), materials.end(),
                     [](const Elastic& e) { return e.law != MaterialLaw::svk; });
}

struct Body {
  TetMesh mesh;
  std::vector<Elastic> materials;
  std::vector<std::uint16_t> material_of;  // material of each tetrahedron
  std::vector<RegionModel> region_of;      // model of each tetrahedron
  // φ per tetrahedron, the share of its volume that is filled, above 0 and at most 1. Empty: 1 for all.
  std::vector<double> shares = {};
  RegionFrame precomputed_frame = RegionFrame::fixed;
  double volume_penalty = 0;  // κ [Pa], of the non-linear region
  double guard_below = 0;     // J₀ of fem/guard.h, of the non-linear region, 0…1; 0: no guard

  static constexpr auto fields =
      std::tuple(&Body::mesh, &Body::materials, &Body::material_of, &Body::region_of, &Body::shares,
                 &Body::precomputed_frame, &Body::volume_penalty, &Body::guard_below);
};

}  // namespace lobe
