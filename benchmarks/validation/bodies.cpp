#include "benchmarks/validation/bodies.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <stdexcept>

#include "lobe/scene/select.h"
#include "lobe/sim/world.h"
#include "lobe/solve/static_solver.h"
#include "lobe/sort_unique.h"

namespace lobe::validation {

Setup body_of(TetMesh mesh, const Elastic& elastic, RegionModel model) {
  Setup setup;
  const auto tets = std::size_t(mesh.tet_count());
  setup.mesh = std::move(mesh);
  setup.materials = {elastic};
  setup.material_of.assign(tets, 0);
  setup.region_of.assign(tets, model);
  return setup;
}

TetMesh jittered(TetMesh mesh, double cell, double part, unsigned seed, bool boundary_too) {
  std::vector<bool> fixed(std::size_t(mesh.vertex_count()), false);
  if (!boundary_too)
    for (Index v : outer_vertices(mesh)) fixed[v] = true;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> jitter(-part * cell, part * cell);
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (!fixed[v])
      for (double& x : mesh.points.col(v)) x += jitter(random);
  return mesh;
}

std::vector<Index> outer_vertices(const TetMesh& mesh) {
  std::vector<Index> vertices;
  for (const TetFace& face : outer_faces(mesh))
    for (int c : face_corners[face.face]) vertices.push_back(mesh.tets(c, face.tet));
  sort_unique(vertices);
  return vertices;
}

std::vector<Index> vertices_where(const TetMesh& mesh, const Condition& holds) {
  std::vector<Index> vertices;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (holds(mesh.points.col(v))) vertices.push_back(v);
  return vertices;
}

void prescribe(Setup& setup, const std::vector<Index>& vertices, const Field& u) {
  for (Index v : vertices) setup.prescribed.push_back({v, u(setup.mesh.points.col(v))});
}

void slide(Setup& setup, int axis, double place, double displacement) {
  const double size = setup.mesh.points.cwiseAbs().maxCoeff();
  std::array<bool, 3> across{};
  across[std::size_t(axis)] = true;
  for (Index v :
       vertices_where(setup.mesh, [&](const Vec3d& X) { return std::abs(X[axis] - place) < 1e-9 * size; }))
    setup.prescribed.push_back({v, displacement * Vec3d::Unit(axis), across});
}

void load_faces(Setup& setup, const Condition& holds, const Field& traction) {
  const TetMesh& mesh = setup.mesh;
  for (const TetFace& face : outer_faces(mesh)) {
    Mat3<double> X;
    for (int i = 0; i < 3; ++i) X.col(i) = mesh.points.col(mesh.tets(face_corners[face.face][i], face.tet));
    if (!holds(X.col(0)) || !holds(X.col(1)) || !holds(X.col(2))) continue;
    const Vec3d N = (X.col(1) - X.col(0)).cross(X.col(2) - X.col(0)).normalized();
    setup.face_loads.push_back({face.tet, face.face, traction(N)});
  }
}

namespace {
std::function<Mat3X<double>(const Setup&)> other_solver;
}  // namespace

void solve_equilibria_by(std::function<Mat3X<double>(const Setup&)> solver) {
  other_solver = std::move(solver);
}

Mat3X<double> equilibrium(const Setup& setup) {
  if (other_solver) return other_solver(setup);
  StaticResult result = solve_static(setup);
  if (!result.converged) throw std::runtime_error("static solver: " + result.reason);
  return std::move(result.u);
}

Mat3X<double> internal_forces(const Setup& setup, const Mat3X<double>& u) {
  Setup bare;
  static_cast<Body&>(bare) = setup;
  World<double> world(bare);
  world.set_state({u, 0 * u, 0});
  return world.forces();
}

Mat3<double> mean_stress(const Setup& setup, const Mat3X<double>& u) {
  return -internal_forces(setup, u) * setup.mesh.points.transpose() / total_volume(setup.mesh);
}

double relative_maximum(const Mat3X<double>& a, const Mat3X<double>& b) {
  return (a - b).colwise().norm().maxCoeff() / b.colwise().norm().maxCoeff();
}

}  // namespace lobe::validation
