// Options that exclude each other, in one table: scenes, setups and running worlds are checked against it,
// and docs/scene.md shows it. A second table has options of one material: two materials of a body may each
// have one of them. All others can be combined.
#pragma once

#include <bitset>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "lobe/error.h"
#include "lobe/setup/setup.h"

namespace lobe {

// The models of regions come first, in the order of their numbers: option_of().
enum class Option : std::uint8_t {
  corotated = region_model_names.size(),
  expandable,  // Setup::expandable
  automatic,   // regions chosen by their estimated error
  nodal_pressure,
  other_law,  // any law but St Venant-Kirchhoff
  fibres,
  sleep,
  selective_mass,
  force_terms,  // World::add(), springs
  implicit,
  single_precision,
  static_solution,
  edge_smoothed,
  viscous,     // a material with a Prony series
  own_steps,   // Setup::own_steps
  partly_held  // Setup::partly_held, GraspSetup::shares
};
inline constexpr std::size_t option_count = std::size_t(Option::partly_held) + 1;
constexpr Option option_of(RegionModel model) { return Option(int(model)); }  // the option of its tetrahedra
std::string name(Option option);  // name in scenes: "model": "precomputed"

class Options {  // a set of options
 public:
  Options() = default;
  Options(std::initializer_list<Option> options) {
    for (const Option option : options) add(option);
  }
  void add(Option option, bool is_used = true) {
    if (is_used) bits_.set(std::size_t(option));
  }
  bool has(Option option) const { return bits_[std::size_t(option)]; }
  Options operator|(const Options& other) const {
    Options both = *this;
    both.bits_ |= other.bits_;
    return both;
  }

 private:
  std::bitset<option_count> bits_;
};

struct Exclusion {
  Option option, other;
  const char* reason;
  const char* remedy;  // remedy for whoever asked for `option`
};
std::span<const Exclusion> exclusions();
std::span<const Exclusion> material_exclusions();

bool any_partly_held(const Setup& setup);  // whether the boundary or a grasp holds vertices by shares
Options options_of(const Setup& setup);

// Returns a fault for each exclusion of which both options are used, and for each place of the first one.
using PlacesOf = std::function<std::vector<std::string>(Option)>;
std::vector<Fault> find_exclusions(const Options& used, const PlacesOf& places_of);
// Returns a fault for each exclusion within one material, at `place`.
std::vector<Fault> find_material_exclusions(MaterialLaw law, bool has_fibres, const std::string& place);
bool goes_with(Option wanted, const Options& used);
// Throws InputError if something that is used excludes `wanted`.
void refuse_excluded(Option wanted, const Options& used, const std::string& place);

}  // namespace lobe
