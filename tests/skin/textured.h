// Fine surfaces of bodies for tests.
#pragma once

#include "lobe/io/surface_io.h"
#include "lobe/mesh/refine.h"
#include "lobe/mesh/topology.h"
#include "support.h"

namespace lobe::test {

// The boundary of a mesh; its points are all of the mesh.
inline TexturedSurface boundary_of(const TetMesh& mesh) {
  const Topology topology(mesh);
  TexturedSurface surface;
  surface.points = mesh.points;
  surface.triangles.resize(3, Eigen::Index(topology.boundary_faces().size()));
  for (std::size_t i = 0; i < topology.boundary_faces().size(); ++i)
    surface.triangles.col(Eigen::Index(i)) = topology.face(topology.boundary_faces()[i]);
  surface.texture_of = surface.normal_of = Triangles::Constant(3, surface.triangles.cols(), -1);
  return surface;
}

// Of the refined mesh, blown up from its middle.
inline TexturedSurface fine_boundary_of(const TetMesh& mesh, int refined, double factor) {
  TetMesh fine = mesh;
  for (int i = 0; i < refined; ++i) fine = refine(fine).mesh;
  const Vec3d middle = fine.points.rowwise().mean();
  fine.points = (factor * (fine.points.colwise() - middle)).colwise() + middle;
  return boundary_of(fine);
}

}  // namespace lobe::test
