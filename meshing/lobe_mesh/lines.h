// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#pragma once

#include <utility>

#include "lobe_mesh/surface.h"

namespace lobe::meshing {

// The lines that edges (pairs of vertices, each once) make, from where other than two of them meet to the
// next such place; loops begin anywhere.
std::vector<Polyline> lines_of(const std::vector<std::pair<Index, Index>>& edges);

}  // namespace lobe::meshing
