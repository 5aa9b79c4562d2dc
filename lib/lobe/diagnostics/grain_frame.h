// A frame of a body that a blade has cut: its grains, so that what is drawn is open where it is cut. Whole
// tetrahedra would lie over each other.
#pragma once

#include <filesystem>

#include "lobe/scalpel/grains.h"

namespace lobe {

// As write_frame(), with the grains for cells. `source` is the tetrahedron of the simulation that a grain is
// part of, `parent` that of the mesh at the start. `skin` has a bit for the face opposite to each corner: set
// where it was on the boundary at the start. `stroke` is the last stroke that has opened a face of a grain,
// counted from 0 in the order in which they began; −1: none has.
void write_grain_frame(const std::filesystem::path& file, const Elements& elements, const Grains& grains,
                       const Mat3X<double>& u,  // 3 × #vertices [m]
                       const Mat3X<double>& v,  // 3 × #vertices [m/s]
                       const std::vector<std::uint8_t>& is_embedded = {});

}  // namespace lobe
