#include "lobe/io/raw_mesh.h"

#include <algorithm>

#include "lobe/error.h"

namespace lobe::io {

MeshFile finish(RawMesh raw, const std::string& name) {
  if (raw.corners.empty() && raw.ignored_cells > 0)
    throw InputError(name, "has no 4-node tetrahedron, only " + std::to_string(raw.ignored_cells) +
                               " other cells; a surface is meshed by lobe-mesh, other volume cells must be "
                               "split into tetrahedra first");
  const std::size_t points = raw.coordinates.size() / 3, tets = raw.corners.size() / 4;
  if (std::max(points, tets) > static_cast<std::size_t>(max_index))
    throw InputError(name, "more than 2^31 - 1 vertices or tetrahedra");
  MeshFile file;
  file.mesh.points.resize(3, static_cast<Index>(points));
  std::copy_n(raw.coordinates.begin(), 3 * points, file.mesh.points.data());
  file.mesh.tets.resize(4, static_cast<Index>(tets));
  std::copy_n(raw.corners.begin(), 4 * tets, file.mesh.tets.data());
  file.mesh.labels = std::move(raw.labels);
  file.ignored_cells = raw.ignored_cells;
  file.prepared = prepare(file.mesh, name);
  return file;
}

}  // namespace lobe::io
