// Private to io/: parts of the legacy VTK reader.
#pragma once

#include <map>

#include "lobe/io/numeric.h"
#include "lobe/io/vtk_cells.h"

namespace lobe::io {

// Numbers of one array, after the line that announces them.
std::vector<double> read_legacy_array(Scanner& scan, std::string_view type, std::size_t count,
                                      const std::string& what);

// Skips the METADATA block, if there is one, that follows an array of so many components.
void skip_legacy_metadata(Scanner& scan, std::size_t components);

// FIELD name n, and n arrays; those with one value per cell go to `cell_arrays`, if not null.
using LegacyArrays = std::vector<CellArray>;
void read_legacy_field(Scanner& scan, LegacyArrays* arrays);

Polygons read_vtk_legacy_surface(const std::string& name, std::string_view bytes);

// From POINT_DATA or CELL_DATA to the end of the file: keeps the scalars of cells.
LegacyArrays read_legacy_attributes(Scanner& scan, std::string keyword, std::size_t points,
                                    std::size_t cells);

}  // namespace lobe::io
