// Instruments as VTK actors: a metal shaft that comes from outside the picture, and what is at its tip.
#pragma once

#include <vtkRenderer.h>

#include "request.h"

namespace picture {

// `away` is where the shaft of a tool without a direction of its own leads; `eye` points to the camera: jaws
// open across the line of sight; `length` is that of the shaft [m].
void add_tool(vtkRenderer* renderer, const Tool& tool, const Vec3& away, const Vec3& eye, double length);
void add_body(vtkRenderer* renderer, const Body& body);

}  // namespace picture
