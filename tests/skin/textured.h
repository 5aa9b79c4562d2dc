// Fine surfaces of bodies for tests.
#pragma once

#include "lobe/mesh/refine.h"
#include "lobe/skin/skin.h"
#include "support.h"

namespace lobe::test {

// Of the refined mesh, blown up from its middle.
inline TexturedSurface fine_boundary_of(const TetMesh& mesh, int refined, double factor) {
  TetMesh fine = mesh;
  for (int i = 0; i < refined; ++i) fine = refine(fine).mesh;
  const Vec3d middle = fine.points.rowwise().mean();
  fine.points = (factor * (fine.points.colwise() - middle)).colwise() + middle;
  return textured_boundary(fine);
}

}  // namespace lobe::test
