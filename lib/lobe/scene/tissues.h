// Organs, tissues and phantoms whose stiffness has been published, for "tissue" in a scene's materials
// (docs/tissues.md).
#pragma once

#include <span>
#include <string_view>

namespace lobe {

// Tissues hold their volume: their Poisson's ratio is near 0.5. Linear tetrahedra lock above this one.
inline constexpr double tissue_poisson_ratio = 0.45;

struct Tissue {
  std::string_view name;      // name in scenes
  double young_modulus = 0;   // E [Pa], for small strains; where a shear modulus G was measured, 2 (1 + ν) G
  double spread = 0;          // standard deviation of E [Pa]; 0: the source has none
  double density = 0;         // [kg/m³]
  std::string_view measured;  // tissue that was measured, and how
  std::string_view source;    // source of E
  std::string_view density_source;
};

std::span<const Tissue> tissues();                 // tissues in the order of their names
const Tissue* find_tissue(std::string_view name);  // null: none has this name

}  // namespace lobe
