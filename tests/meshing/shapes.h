// Surfaces of known volume, and a folder to write them to.
#pragma once

#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "folder.h"
#include "lobe/error.h"
#include "lobe/mesh/tet_mesh.h"
#include "lobe_mesh/surface.h"

namespace lobe::meshing {

Surface make_cube(double side);                                     // 12 triangles, corner at the origin
Surface make_sphere(double radius, int subdivisions);               // 20 · 4^n triangles
Surface make_cylinder(double radius, double height, int segments);  // sharp rims
Surface joined(const Surface& a, const Surface& b);
Surface moved(Surface surface, const Vec3d& by);
Surface scaled(Surface surface, double factor);
Surface inverted(Surface surface);
Surface without_triangle(const Surface& surface, Index triangle);

struct SurfaceFolder : test::Folder {
  using Folder::write;
  std::filesystem::path write(const std::string& name, const Surface& surface) const;
};

// The message of the InputError that `action` throws; "" if it throws none.
template <class Action>
std::string input_error(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != text.npos;
}

// Every face belongs to one or two tetrahedra, those with two lie on either side of it, and the volume is
// that of the boundary: nothing hangs, nothing overlaps.
void check_faces(const TetMesh& mesh);

// And the faces with one tetrahedron form a closed manifold surface.
void check_boundary(const TetMesh& mesh);

}  // namespace lobe::meshing
