// How far two displacement fields of one mesh are apart.
#pragma once

#include "lobe/mesh/tet_mesh.h"

namespace lobe {

struct Difference {
  double l2 = 0;            // ‖a − b‖ / ‖b‖ in L2 over the rest volume
  double h1 = 0;            // the same of the gradients
  double max = 0;           // largest distance of a vertex [m]
  double relative_max = 0;  // to the largest displacement of b
  Index worst_vertex = -1;
  double volume_a = 0, volume_b = 0;  // of the deformed bodies [m³]
};

// Integrals are exact for P1 fields. Relative figures are infinite if b is zero and a is not. Throws InputError if the
// sizes differ.
Difference compare_displacements(const TetMesh& mesh, const Mat3X<double>& a,
                                 const Mat3X<double>& b);  // 3 × #vertices [m]

}  // namespace lobe
