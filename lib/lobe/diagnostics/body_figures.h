// What each body of a mesh of several has in itself.
#pragma once

#include <string>
#include <vector>

#include "lobe/fem/elements.h"

namespace lobe {

struct BodyFigures {
  std::string name;
  Index tets = 0;                  // tetrahedra that are left
  double mass = 0;                 // [kg]
  double volume = 0;               // volume of the deformed body [m³]
  double kinetic = 0;              // energy of motion, ½ Σ m v² of its vertices [J]
  double elastic = 0;              // elastic energy of its tetrahedra by the models of their regions [J]
  Vec3d centre = Vec3d::Zero();    // centre of mass of the deformed body [m]
  Vec3d momentum = Vec3d::Zero();  // [kg m/s]
};

// One entry per body, none where the mesh is one body. The elastic energies add up to that of the world, but
// for what follows a lattice, and pre-computed regions that are corotated, relinearised or expanded: there
// they are those of the tetrahedra's models.
// O(#tets).
std::vector<BodyFigures> body_figures(const Elements& elements,
                                      const Mat3X<double>& u,   // 3 × #vertices [m]
                                      const Mat3X<double>& v);  // 3 × #vertices [m/s]

}  // namespace lobe
