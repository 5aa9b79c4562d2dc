#include "lobe_mesh/relax.h"

#include <cmath>

#include "lobe/mesh/generators.h"
#include "lobe/mesh/quality.h"
#include "lobe/sim/rest_time_step.h"
#include "meshing/shapes.h"
#include "near.h"

using namespace lobe;
using namespace lobe::meshing;
using test::near;

namespace {

constexpr double edge = 0.2;

// A cube of 6 × 6 × 6 cells whose interior vertices were shaken by up to a quarter of a cell.
TetMesh shaken_cube() {
  TetMesh mesh = box_mesh({1, 1, 1}, 6, 6, 6);
  unsigned random = 1;
  const auto next = [&] { return (random = random * 1664525u + 1013904223u) / 4294967296.0 - 0.5; };
  for (auto p : mesh.points.colwise()) {
    if (p.minCoeff() > 1e-6 && p.maxCoeff() < 1 - 1e-6) p += 0.09 * Vec3d(next(), next(), next());
  }
  REQUIRE(prepare(mesh, "shaken").reoriented == 0);
  return mesh;
}

double step_star(const TetMesh& mesh) {
  return rest_time_step(mesh, {4e4, 1e4, 1000}) * std::sqrt(6e4 / 1000) / edge;
}

}  // namespace

TEST_CASE(
    "relaxation lengthens the time step and opens the angles, and moves no vertex of a flat face off it") {
  TetMesh mesh = shaken_cube();
  const TetMesh before = mesh;
  const Surface cube = make_cube(1);
  const NearestPoint surface(cube);
  const Interfaces interfaces{{{-1, 0}, &surface}};
  std::vector<Mat3X<double>> lines;
  for (const Polyline& line : feature_lines(cube, 60, 0, 0).lines)
    lines.push_back(cube.points(Eigen::all, line));
  const Freedom freedom = find_freedom(mesh, interfaces, lines, 1e-6);
  relax(mesh, freedom, {.edge = edge});
  CHECK(step_star(mesh) > 1.2 * step_star(before));
  CHECK(mesh_quality(mesh).min_dihedral > mesh_quality(before).min_dihedral + 3);
  CHECK(total_volume(mesh) == near(1, 1e-12));
  CHECK(mesh.tets == before.tets);
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (freedom.is_fixed[v]) CHECK(mesh.points.col(v) == before.points.col(v));
  }
  CHECK(slowest_vertex(mesh, {.edge = edge}).tets > 0);
}

TEST_CASE("a mesh that reaches the goal is left alone, bit for bit") {
  TetMesh mesh = shaken_cube();
  const TetMesh before = mesh;
  const Freedom free{std::vector<std::vector<const NearestPoint*>>(mesh.vertex_count()),
                     std::vector<bool>(mesh.vertex_count(), false)};
  relax(mesh, free, {.edge = edge, .time_step_star = 1e-3, .min_dihedral = 1e-3});
  CHECK(mesh.points == before.points);
}

TEST_CASE("a mesh that cannot reach the goal is given up after the work that is allowed") {
  const RelaxGoal hopeless{.edge = edge, .time_step_star = 10, .min_dihedral = 80};
  const auto work = [&](std::size_t most) {
    TetMesh mesh = shaken_cube();
    const Freedom free{std::vector<std::vector<const NearestPoint*>>(mesh.vertex_count()),
                       std::vector<bool>(mesh.vertex_count(), false)};
    RelaxGoal goal = hopeless;
    goal.most_work = most;
    const double each = double(relax(mesh, free, goal)) / mesh.tet_count();
    CHECK(mesh_quality(mesh).smallest_altitude_ratio > 0);
    return each;
  };
  const double enough = work(3000), little = work(20);
  CHECK(enough > 100);  // it would go on
  CHECK(little >= 20);
  CHECK(little < 21);
}

TEST_CASE("the vertex that bounds the step is the one whose neighbourhood was squeezed") {
  TetMesh mesh = box_mesh({1, 1, 1}, 4, 4, 4);
  Index squeezed = 0;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if ((mesh.points.col(v) - Vec3d(0.5, 0.5, 0.5)).norm() < 1e-9) squeezed = v;
  }
  mesh.points.col(squeezed) += Vec3d(0.23, 0, 0);
  const Bottleneck slowest = slowest_vertex(mesh, {.edge = 0.25});
  // It, or the neighbour that it came close to.
  CHECK((slowest.position - Vec3d(0.75, 0.5, 0.5)).norm() < 0.03);
}

TEST_CASE("restoring the volume leaves an error of higher order than that of chords") {
  // Octants of a ball: a box whose vertices were mapped to the sphere; vertices lie on it exactly.
  const Surface fine = make_sphere(1, 5);
  const NearestPoint surface(fine);
  const Interfaces interfaces{{{-1, 0}, &surface}};
  double last = 0;
  for (const int n : {4, 8}) {
    TetMesh mesh = box_mesh({2, 2, 2}, n, n, n);
    for (auto p : mesh.points.colwise()) {
      const Vec3d q = p - Vec3d::Ones();
      const double size = q.cwiseAbs().maxCoeff();
      p = size > 0 ? Vec3d(q * size / q.norm()) : Vec3d(q);
    }
    prepare(mesh, "ball");
    const double exact = enclosed_volume(fine), chords = total_volume(mesh) / exact - 1;
    restore_volume(mesh, interfaces, find_freedom(mesh, interfaces, {}, 0));
    const double error = total_volume(mesh) / exact - 1;
    CAPTURE(n);
    CHECK(chords < -0.01);
    CHECK(std::abs(error) < 0.1 * std::abs(chords));
    if (last != 0) CHECK(std::abs(error) < 0.3 * std::abs(last));
    last = error;
  }
}
