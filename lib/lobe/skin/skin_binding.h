// How a skin (skin.h) lies on the tetrahedra at the start. That never changes.
#pragma once

#include <span>

#include "lobe/io/surface_io.h"
#include "lobe/skin/carriers.h"
#include "lobe/skin/skin_mesh.h"

namespace lobe {

struct SkinBinding {
  TetMesh start;                          // the body
  Mat3X<double> points;                   // carried vertices at rest [m]
  std::vector<Index> copied_from;         // originals of further vertices, which differ in texture alone
  Triangles corners;                      // 3 × #triangles of the file, carried vertices
  NumberLists lies_on, lying_on, around;  // tets of triangles, triangles of tets and of carried vertices

  Index carried_count() const { return static_cast<Index>(points.cols()); }
  Index first_cut() const { return carried_count() + static_cast<Index>(copied_from.size()); }
  Index file_count() const { return lies_on.count(); }  // number of triangles of the file
  std::span<const Index> corners_in(Index triangle) const { return {corners.col(triangle).data(), 3}; }
};

// Adds vertices, texture and all triangles to `drawn`. Throws InputError as Skin does.
SkinBinding bind(const TexturedSurface& surface, const TetMesh& mesh, SkinMesh& drawn);

}  // namespace lobe
