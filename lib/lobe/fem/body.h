// A body at rest: what it is made of, and which model each of its tetrahedra follows.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

#include "lobe/mesh/tet_mesh.h"

namespace lobe {

enum class RegionModel : std::uint8_t { tensor_mass = 0, precomputed = 1, nonlinear = 2 };
// As scenes and reports name them.
inline constexpr std::array<const char*, 3> region_model_names{"tensor-mass", "precomputed", "nonlinear"};
inline const char* name(RegionModel model) { return region_model_names[std::size_t(model)]; }

enum class RegionFrame : std::uint8_t {
  fixed,     // a linear region's displacements are those in space
  corotated  // those from a rigid motion that follows the region (condense/rigid_frame.h)
};
enum class Evaluator : std::uint8_t { direct, stored };  // of the non-linear model: closed form, or B, C, D

struct Elastic {
  double lambda = 4e4, mu = 1e4;  // [Pa]
  double density = 1000;          // [kg/m³]
  double nodal_pressure = 0;  // w: share of λ whose pressure is averaged at nodes, 0…1 (nodal_pressure.h)

  double nodal_lambda() const { return nodal_pressure * lambda; }     // wλ [Pa]
  double element_lambda() const { return lambda - nodal_lambda(); }   // (1 − w)λ [Pa]
  double guard_modulus() const { return element_lambda() + 2 * mu; }  // M of fem/guard.h [Pa]

  static constexpr auto fields =
      std::tuple(&Elastic::lambda, &Elastic::mu, &Elastic::density, &Elastic::nodal_pressure);
};

inline bool any_nodal_pressure(const std::vector<Elastic>& materials) {
  return std::any_of(materials.begin(), materials.end(),
                     [](const Elastic& e) { return e.nodal_lambda() > 0; });
}

struct Body {
  TetMesh mesh;
  std::vector<Elastic> materials;
  std::vector<std::uint16_t> material_of;  // per tetrahedron: which of the materials
  std::vector<RegionModel> region_of;      // per tetrahedron
  // Per tetrahedron: φ, the share of its volume that is filled, above 0 and at most 1. None: all are full.
  std::vector<double> shares = {};
  RegionFrame precomputed_frame = RegionFrame::fixed;
  double volume_penalty = 0;  // κ [Pa], of the non-linear region
  double guard_below = 0;     // J₀ of fem/guard.h, of the non-linear region, 0…1; 0: no guard

  static constexpr auto fields =
      std::tuple(&Body::mesh, &Body::materials, &Body::material_of, &Body::region_of, &Body::shares,
                 &Body::precomputed_frame, &Body::volume_penalty, &Body::guard_below);
};

}  // namespace lobe
