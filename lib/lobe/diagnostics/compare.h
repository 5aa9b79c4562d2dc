// How far two displacement fields of one body are apart, on one mesh or on two.
#pragma once

#include <filesystem>

#include "lobe/mesh/tet_mesh.h"

namespace lobe {

struct Field {
  std::string name;  // name in messages, usually that of its file
  TetMesh mesh;
  Mat3X<double> u;              // 3 × #vertices [m]
  std::vector<double> density;  // density of each tetrahedron [kg/m³]; empty: not known
};

// Reads a file with point data "displacement", and cell data "density" if it has any, as frames of `lobe run`
// are. Throws InputError for anything else.
Field read_field(const std::filesystem::path& file);

struct Difference {
  double l2 = 0;            // ‖a − b‖ / ‖b‖ in L2 over the rest volume, weighted with b's density
  double h1 = 0;            // the same norm of the gradients, without the density
  double max = 0;           // largest distance of a vertex of b [m]
  double relative_max = 0;  // ratio of that to the largest displacement of b
  Index worst_vertex = -1;
  double volume_a = 0, volume_b = 0;            // volumes of the deformed bodies [m³]
  double rest_volume_a = 0, rest_volume_b = 0;  // [m³]
  bool by_mass = false;                         // b has a density
  bool same_mesh = true;
  double outside_fraction = 0;  // share of b's rest volume that lies outside a's mesh
  double largest_gap = 0;       // largest distance of a point of b's rest body from a's [m]
};

// Compares two fields on one mesh. Integrals are exact for P1 fields. Relative figures are infinite if b is
// zero and a is not. Throws InputError if the sizes differ.
Difference compare_displacements(
    const TetMesh& mesh, const Mat3X<double>& a,
    const Mat3X<double>& b,                    // 3 × #vertices [m]
    const std::vector<double>& density = {});  // density of each tetrahedron [kg/m³], or none

// Compares two fields, each with its mesh. On equal meshes it is compare_displacements(). Otherwise a is
// interpolated, and integrals go over b's body by a quadrature of degree two on its tetrahedra, refined until
// their edges are about half of a's: exact where a is linear on such a piece, approximate where a has a kink
// inside it. Parts of b outside a, as between two chords of one curved surface, take the linear extension of
// a's nearest tetrahedron. Throws InputError if more than 1 % of b is further from a than an edge of a, or if
// the rest volumes differ by more than a factor of two.
Difference compare_fields(const Field& a, const Field& b);

}  // namespace lobe
