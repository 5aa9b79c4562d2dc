// What is written on a picture: titles, the legend of the regions, the scale of a colour map.
#pragma once

#include <vtkLookupTable.h>
#include <vtkRenderer.h>

#include <string>
#include <vector>

namespace picture {

// Sizes of letters follow the smaller of the panel's height and width [pixels].
struct PanelSize {
  int width = 0;
  int height = 0;
  int letter() const;
};

void add_title(vtkRenderer* renderer, const std::string& title, const PanelSize& size);

// Along the lower edge, one entry per style of region_styles() that is shown.
void add_region_legend(vtkRenderer* renderer, const std::vector<int>& regions, const PanelSize& size);

// Along the lower edge.
void add_color_scale(vtkRenderer* renderer, vtkLookupTable* colors, const std::string& name,
                     const PanelSize& size);

}  // namespace picture
