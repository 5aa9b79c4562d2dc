// Options of one material that exclude each other. Two materials of a body may each have one of them.
// Scenes and setups are checked against the table, and docs/scene.md shows it beside that of exclusions.h.
#pragma once

#include "lobe/setup/exclusions.h"

namespace lobe {

std::span<const Exclusion> material_exclusions();

// `place` is for the faults.
std::vector<Fault> find_material_exclusions(MaterialLaw law, bool has_fibres, const std::string& place);

}  // namespace lobe
