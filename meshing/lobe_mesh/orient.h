// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// Turns triangles without a geometry library, for surfaces that lack nothing else.
#pragma once

#include <optional>

#include "lobe_mesh/surface.h"

namespace lobe::meshing {

struct Turned {
  Index to_agree = 0;  // triangles that disagreed with the others about the outside
  Index outwards = 0;  // all of them, if the surface was inside out
};

// The surface, of one piece, with triangles that agree about the outside, which is where it is. None if an
// edge has other than two triangles, if there are several pieces, or if the surface has one side only.
// O(#triangles log #triangles).
std::optional<Surface> turned_outwards(const Surface& surface, Turned& turned);

}  // namespace lobe::meshing
