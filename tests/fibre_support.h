// Bodies with fibres, and of the laws that scenes may ask for in place of St Venant-Kirchhoff.
#pragma once

#include <cmath>

#include "lobe/fem/transverse_isotropy.h"
#include "lobe/setup/setup.h"
#include "support.h"

namespace lobe::test {

inline constexpr TransverseConstants muscle{9e4, 3e4, 0.4, 0.35, 2e4};

inline Elastic fibrous() {
  Elastic elastic = seed_material;
  set_transverse(muscle, elastic);
  return elastic;
}

// A field that turns from place to place.
inline Vec3d direction_at(const Vec3d& X) {
  return Vec3d(1, std::sin(60 * X.x() + 1), std::cos(90 * X.y() + 40 * X.z())).normalized();
}

inline Setup fibrous_setup(const TetMesh& mesh, RegionModel model = RegionModel::nonlinear) {
  Setup setup = setup_of(mesh, model);
  setup.materials = {fibrous()};
  setup.mesh.fibres.resize(3, mesh.tet_count());
  for (Index t = 0; t < mesh.tet_count(); ++t) setup.mesh.fibres.col(t) = direction_at(barycentre(mesh, t));
  return setup;
}

inline Setup neo_hookean_setup(const TetMesh& mesh) {
  Setup setup = setup_of(mesh);
  setup.materials[0].law = MaterialLaw::neo_hookean;
  return setup;
}

inline Setup yeoh_setup(const TetMesh& mesh) {
  Setup setup = setup_of(mesh);
  setup.materials[0].law = MaterialLaw::yeoh;
  setup.materials[0].further = {-2e3, 9e3};
  return setup;
}

inline Setup mooney_rivlin_setup(const TetMesh& mesh) {
  Setup setup = setup_of(mesh);
  setup.materials[0].law = MaterialLaw::mooney_rivlin;
  setup.materials[0].further = {3e3, 0};
  return setup;
}

inline Setup holzapfel_setup(const TetMesh& mesh) {
  Setup setup = fibrous_setup(mesh);
  setup.materials = {seed_material};
  setup.materials[0].law = MaterialLaw::holzapfel;
  setup.materials[0].further = {2e4, 1.5};
  setup.materials[0].fibre_angle = 0.6;
  setup.materials[0].fibre_plane = {-1, 0.3, 2};
  return setup;
}

}  // namespace lobe::test
