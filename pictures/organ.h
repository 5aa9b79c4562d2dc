// An organ's surface as VTK actors.
#pragma once

#include <vtkLookupTable.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <array>
#include <string>
#include <vector>

#include "lobe/fem/body.h"
#include "request.h"

namespace picture {

using Color = std::array<double, 3>;

// Names and colours of the values of the cell array `region`, which are the numbers of RegionModel. Where the
// cell array `embedded` is given, a reduced face is on its lattice (4) or full (5).
struct RegionStyle {
  const char* name;
  Color color;
};
using RegionStyles = std::array<RegionStyle, lobe::region_model_names.size() + 2>;
const RegionStyles& region_styles();

// The styles that occur on the surface, ascending.
std::vector<int> regions_shown(vtkPolyData* surface);

// True for the colours that are an array of the file: not "none", "region" or "body".
bool shows_array(const Panel& panel);

// Smallest and largest value (magnitude of vectors) of the panel's array. Throws std::runtime_error if the
// surface has no such array; the message lists those it has.
Eigen::Vector2d array_range(vtkPolyData* surface, const Panel& panel);

// From dark blue over green to yellow, over the range.
vtkSmartPointer<vtkLookupTable> color_map(const Eigen::Vector2d& range);

// `colors` is used only if shows_array(panel).
void add_organ(vtkRenderer* renderer, vtkPolyData* surface, const Panel& panel, vtkLookupTable* colors);

}  // namespace picture
