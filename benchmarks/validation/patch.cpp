// Patch tests: affine displacements of the boundary of irregular meshes give affine displacements inside.
#include <Eigen/Geometry>
#include <algorithm>
#include <random>

#include "benchmarks/validation/bodies.h"
#include "benchmarks/validation/cases.h"
#include "lobe/mesh/generators.h"
#include "lobe/numerics/symmetric_eigen.h"

namespace lobe::validation {
namespace {

Mat3<double> random_matrix(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Mat3<double> A;
  for (double& x : A.reshaped()) x = uniform(random);
  return A;
}

// Large: principal stretches between 0.75 and 1.25, turned by up to 40° (the solver follows chords of the
// rotation).
Mat3<double> random_gradient(bool large, std::mt19937& random) {
  const Mat3<double> A = random_matrix(random);
  if (!large) return 1e-3 * A;
  const Mat3<double> V = symmetric_eigen<Mat3<double>>(A + A.transpose()).vectors;
  const Vec3d stretches = 1 + 0.25 * random_matrix(random).col(0).array();
  const double angle = random_matrix(random)(0, 0) * 0.7;
  const Mat3<double> R =
      Eigen::AngleAxisd(angle, random_matrix(random).col(0).normalized()).toRotationMatrix();
  return R * V * stretches.asDiagonal() * V.transpose() - Mat3<double>::Identity();
}

struct Patch {
  const char* name;
  RegionModel model;
  double volume_penalty;  // [Pa]
};

struct PatchErrors {
  double displacement = 0;  // of the solution, relative
  double force = 0;         // largest inner force of the affine state, to the largest on the boundary
};

PatchErrors patch_errors(const Patch& patch, unsigned seed) {
  const int n = 4;
  const double edge = 0.01;
  std::mt19937 random(seed);
  Setup setup = body_of(jittered(box_mesh(Vec3d::Constant(n * edge), n, n, n), edge, 0.2, seed, true),
                        Elastic{}, patch.model);
  setup.volume_penalty = patch.volume_penalty;
  const Mat3<double> H = random_gradient(patch.model == RegionModel::nonlinear, random);
  const Mat3X<double> exact = H * setup.mesh.points;
  const std::vector<Index> outer = outer_vertices(setup.mesh);
  prescribe(setup, outer, [&](const Vec3d& X) { return H * X; });
  PatchErrors errors;
  errors.displacement = relative_maximum(equilibrium(setup), exact);
  Mat3X<double> forces = internal_forces(setup, exact);
  const double largest = forces.colwise().norm().maxCoeff();
  for (Index v : outer) forces.col(v).setZero();
  errors.force = forces.colwise().norm().maxCoeff() / largest;
  return errors;
}

}  // namespace

void patch_tests(Findings& findings, bool quick) {
  const unsigned maps = quick ? 3 : 20;
  for (const Patch& patch :
       {Patch{"linear, small", RegionModel::tensor_mass, 0}, Patch{"SVK, large", RegionModel::nonlinear, 0},
        Patch{"SVK with volume term, large", RegionModel::nonlinear, 1e5}}) {
    PatchErrors worst;
    for (unsigned seed = 1; seed <= maps; ++seed) {
      const PatchErrors e = patch_errors(patch, seed);
      worst.displacement = std::max(worst.displacement, e.displacement);
      worst.force = std::max(worst.force, e.force);
    }
    const std::string name = std::string(patch.name) + ", " + std::to_string(maps) + " maps";
    findings.value(name, "largest error of u, relative", "-", worst.displacement, {0, "affine field"},
                   {1e-9, "ten times the solver's residual"});
    findings.value(name, "largest inner force, relative", "-", worst.force, {0, "affine field"},
                   {1e-12, "rounding"});
  }
}

}  // namespace lobe::validation
