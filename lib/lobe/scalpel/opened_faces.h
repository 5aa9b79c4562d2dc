// Finds the faces of grains that a step of a blade opens, and opens them.
#pragma once

#include <span>

#include "lobe/scalpel/incise.h"

namespace lobe {

inline constexpr double open_within = 0.3;  // largest distance of a face's middle from the sheet [mean edges]

// Opens the closed faces that lie on the sheets of a stroke that goes on, near what it has swept last. Others
// wait. `new_on`: the points that the last sheet has taken, ascending.
void open_on_sheets(Grains& grains, const PlacedTets& tets, const SweptSheets& swept, int stroke,
                    const std::vector<Index>& new_on, Incised& incised);

// Opens each closed face for which a sheet crosses the line between the barycentres of the two grains beside
// it. Then no path from grain to grain through closed faces crosses a sheet. `near`: grains near the sheets,
// ascending.
void open_between_sides(Grains& grains, const PlacedTets& tets, std::span<const Sheet* const> sheets,
                        const std::vector<Index>& near, Incised& incised);

// Opens these faces.
void open_faces(Grains& grains, const PlacedTets& tets, std::vector<Index> faces, Incised& incised);

}  // namespace lobe
