// From a mesh file to the deformed surface that is drawn.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include "request.h"

namespace picture {

// The surface of a panel's mesh, moved by the point data `displacement` if there is one, with the point and
// cell data of the file. Faces that a cut has exposed carry 1 in the cell array `exposed`: faces that are
// inside in panel.first, or faces of tetrahedra with a non-zero cell array `cut`. With panel.fibres the cell
// array `fibre line` has the part of a tetrahedron's `fibre` that lies in the face, moved with it [m]. Throws
// std::runtime_error for a file that cannot be read, is empty, or has coordinates that are not finite.
vtkSmartPointer<vtkPolyData> read_surface(const Panel& panel, const std::optional<Clip>& clip);

}  // namespace picture
