// What several tests need: a body ready to simulate, a mesh without symmetries, displacements of a known
// kind.
#pragma once

#include <random>

#include "lobe/mesh/generators.h"
#include "lobe/setup/setup.h"

namespace lobe::test {

inline constexpr Elastic seed_material{4e4, 1e4, 1000};  // λ, μ of the paper's liver

// A box whose inner and outer vertices are moved at random by up to a fifth of a cell.
inline TetMesh irregular_box(int n = 3, double edge = 0.01, unsigned seed = 1) {
  TetMesh mesh = box_mesh(Vec3d::Constant(n * edge), n, n, n);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> jitter(-0.2 * edge, 0.2 * edge);
  for (double& x : mesh.points.reshaped()) x += jitter(random);
  return mesh;
}

inline Setup setup_of(const TetMesh& mesh, RegionModel model = RegionModel::nonlinear) {
  Setup setup;
  setup.mesh = mesh;
  setup.materials = {seed_material};
  setup.material_of.assign(std::size_t(mesh.tet_count()), 0);
  setup.region_of.assign(std::size_t(mesh.tet_count()), model);
  return setup;
}

// The half of the tetrahedra with the smaller x tensor-mass, the others non-linear, two materials, a volume
// term.
inline Setup hybrid_setup(const TetMesh& mesh) {
  Setup setup = setup_of(mesh);
  setup.materials.push_back({7e4, 2e4, 1100});
  const double middle = mesh.points.row(0).mean();
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    if (barycentre(mesh, t).x() < middle) setup.region_of[t] = RegionModel::tensor_mass;
    setup.material_of[t] = t % 3 == 0;
  }
  setup.volume_penalty = 1e5;
  return setup;
}

// The same body with nodal pressure of the given share in the first material, in the others of shares below.
inline Setup averaged(Setup setup, double share = 1) {
  for (Elastic& elastic : setup.materials) {
    elastic.nodal_pressure = share;
    share *= 0.6;
  }
  return setup;
}

// The same body of edge-smoothed tetrahedra.
inline Setup smoothed(Setup setup) {
  for (Elastic& elastic : setup.materials) elastic.element = ElementType::edge_smoothed;
  return setup;
}

template <class Real = double>
Mat3X<Real> random_displacement(Index count, double size, unsigned seed = 7) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  Mat3X<Real> u(3, count);
  for (Real& x : u.reshaped()) x = static_cast<Real>(uniform(random));
  return u;
}

// u = (F − I) X
inline Mat3X<double> affine_displacement(const Mat3X<double>& X, const Mat3<double>& F) {
  return (F - Mat3<double>::Identity()) * X;
}

}  // namespace lobe::test
