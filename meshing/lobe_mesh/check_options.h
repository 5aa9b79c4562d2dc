// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#pragma once

#include <cmath>
#include <numbers>

#include "lobe_mesh/model.h"
#include "lobe_mesh/tetrahedralise.h"

namespace lobe::meshing {

// Throws InputError for numbers out of range, and for edges that would give next to nothing or too much.
void check_options(const MeshOptions& options, const Model& model);

inline double regular_volume(double edge) { return edge * edge * edge / (6 * std::numbers::sqrt2); }
inline double regular_edge(double volume) { return std::cbrt(volume * 6 * std::numbers::sqrt2); }

}  // namespace lobe::meshing
