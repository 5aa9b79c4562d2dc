#include "lobe/solve/quadratic_solver.h"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>

#include "lobe/error.h"
#include "lobe/fem/refined_body.h"
#include "lobe/mesh/outer_faces.h"
#include "lobe/solve/quadratic_tangent.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

using Field = std::function<Vec3d(const Vec3d&)>;

Mat3X<double> at_nodes(const QuadraticMesh& mesh, const Mat3X<double>& points, const Field& field) {
  Mat3X<double> u = mesh.joined_linearly(points);
  for (Eigen::Index n = 0; n < u.cols(); ++n) u.col(n) = field(u.col(n));
  return u;
}

std::vector<char> outer_nodes(const TetMesh& mesh, const QuadraticMesh& quadratic) {
  std::vector<char> outer(std::size_t(quadratic.node_count()), 0);
  for (const TetFace& face : outer_faces(mesh))
    for (int n = 0; n < 10; ++n) {
      const bool touches_corner =
          n < 4 ? n == face.face : edge_corners[n - 4][0] == face.face || edge_corners[n - 4][1] == face.face;
      if (!touches_corner) outer[std::size_t(quadratic.nodes(n, face.tet))] = 1;
    }
  return outer;
}

// The solution of a body all of whose surface is given a field.
StaticResult solve_within(const Setup& setup, const Field& field) {
  const QuadraticMesh mesh(setup.mesh);
  const std::vector<char> outer = outer_nodes(setup.mesh, mesh);
  StaticEquations equations = quadratic_equations(setup, mesh);
  equations.unknowns =
      Unknowns(mesh.node_count(), [&](Index node, int) { return !outer[std::size_t(node)]; });
  equations.prescribed = at_nodes(mesh, setup.mesh.points, field);
  for (Index n = 0; n < mesh.node_count(); ++n)
    if (!outer[std::size_t(n)]) equations.prescribed.col(n).setZero();
  return solve_static_quadratic(setup, mesh, equations);
}

double relative_error(const StaticResult& result, const Setup& setup, const Field& field) {
  const Mat3X<double> exact = at_nodes(QuadraticMesh(setup.mesh), setup.mesh.points, field);
  return (result.u - exact).norm() / exact.norm();
}

std::vector<Setup> all_laws(const TetMesh& mesh) {
  Setup hybrid = hybrid_setup(mesh), guarded = hybrid, neo_hookean = setup_of(mesh), fibrous = hybrid;
  guarded.guard_below = 0.5;
  neo_hookean.materials[0].law = MaterialLaw::neo_hookean;
  fibrous.materials[0].fibre = {3e4, 1e4, 6e4};
  fibrous.mesh.fibres = Vec3d(0.6, 0, 0.8).replicate(1, mesh.tet_count());
  return {setup_of(mesh, RegionModel::tensor_mass), setup_of(mesh), hybrid, guarded, neo_hookean, fibrous};
}

Unknowns all_of(const QuadraticMesh& mesh) {
  return Unknowns(mesh.node_count(), [](Index, int) { return true; });
}

// A cantilever under its weight.
Setup cantilever(int cells) {
  Setup setup = setup_of(box_mesh({0.08, 0.02, 0.02}, 4 * cells, cells, cells));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) == 0) setup.prescribed.push_back({v});
  setup.gravity = {0, 0, -9.81};
  return setup;
}

}  // namespace

TEST_CASE("an affine motion of the surface of quadratic tetrahedra is that of all nodes, for every law") {
  Mat3<double> H;
  H << 0.1, -0.15, 0.05, 0.2, -0.05, 0.1, 0, 0.1, 0.15;
  for (Setup setup : all_laws(irregular_box(3))) {
    std::fill(setup.material_of.begin(), setup.material_of.end(), std::uint16_t(0));
    std::fill(setup.region_of.begin(), setup.region_of.end(), setup.region_of.back());
    const Field affine = [&](const Vec3d& X) { return H * X; };
    const StaticResult result = solve_within(setup, affine);
    REQUIRE(result.converged);
    CHECK(relative_error(result, setup, affine) < 1e-9);
  }
}

// u_i = X·A_i X is in the space of functions. The load that it needs is uniform, and so a weight:
// −Div σ = −2 (λ + μ) Σ_k A_k e_k − 2 μ tr A.
TEST_CASE("a quadratic displacement under a uniform load is found exactly by linear quadratic tetrahedra") {
  Setup setup = setup_of(irregular_box(3), RegionModel::tensor_mass);
  std::array<Mat3<double>, 3> A;
  for (int i = 0; i < 3; ++i) {
    A[i] = random_displacement(3, 1, unsigned(i));
    A[i] = (A[i] + A[i].transpose()).eval();
  }
  const Elastic& e = setup.materials[0];
  Vec3d load = Vec3d::Zero();
  for (int i = 0; i < 3; ++i) {
    load -= 2 * (e.lambda + e.mu) * A[i].row(i).transpose();
    load[i] -= 2 * e.mu * A[i].trace();
  }
  setup.gravity = load / e.density;
  const Field field = [&](const Vec3d& X) {
    return Vec3d(X.dot(A[0] * X), X.dot(A[1] * X), X.dot(A[2] * X));
  };
  CHECK(relative_error(solve_within(setup, field), setup, field) < 1e-10);
}

TEST_CASE("the tangent of quadratic tetrahedra is the derivative of their forces, for every law") {
  for (const Setup& setup : all_laws(irregular_box(1))) {
    const Elements elements(setup);
    const QuadraticMesh mesh(setup.mesh);
    const Unknowns everything = all_of(mesh);
    QuadraticTangent tangent(elements, mesh, everything);
    const Mat3X<double> u = random_displacement(mesh.node_count(), 3e-4);
    tangent.update(u);
    const Eigen::MatrixXd K = Eigen::MatrixXd(tangent.matrix()).selfadjointView<Eigen::Lower>();
    const double h = 1e-8;
    for (Index i = 0; i < u.size(); ++i) {
      Mat3X<double> plus = u, minus = u;
      plus(i) += h;
      minus(i) -= h;
      const EnergyAndForces above = tangent.energy_and_forces(plus), below = tangent.energy_and_forces(minus);
      CHECK((K.col(i) - (below.forces - above.forces).reshaped() / (2 * h)).norm() < 1e-6 * K.norm());
      CHECK((below.energy - above.energy) / (2 * h) ==
            near(tangent.energy_and_forces(u).forces(i), 1e-5, tangent.energy_and_forces(u).forces.norm()));
    }
  }
}

TEST_CASE("a single quadratic tetrahedron has six rigid motions and no other zero mode") {
  TetMesh one = irregular_box(1);
  one.tets = one.tets.leftCols(1).eval();
  one.labels.resize(1);
  const Setup setup = setup_of(one);
  const Elements elements(setup);
  QuadraticMesh mesh(setup.mesh);
  const std::vector<Index> corners(one.tets.data(), one.tets.data() + 4);
  const Unknowns unknowns(mesh.node_count(), [&](Index node, int) {
    return node >= mesh.vertices || std::find(corners.begin(), corners.end(), node) != corners.end();
  });
  QuadraticTangent tangent(elements, mesh, unknowns);
  tangent.update(Mat3X<double>::Zero(3, mesh.node_count()));
  const Eigen::MatrixXd K = Eigen::MatrixXd(tangent.matrix()).selfadjointView<Eigen::Lower>();
  const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues();
  REQUIRE(values.size() == 30);
  CHECK(std::abs(values[5]) < 1e-12 * values[29]);
  CHECK(values[6] > 1e-3 * values[29]);
}

TEST_CASE("what holds a body bears all of its loads, with linear and with quadratic tetrahedra") {
  Setup setup = cantilever(2);
  for (const TetFace& face : outer_faces(setup.mesh))
    if (barycentre(setup.mesh, face.tet).x() > 0.06)
      setup.face_loads.push_back({face.tet, face.face, {100, 0, 50}});
  for (const StaticResult& result : {solve_static(setup), solve_static_quadratic(setup)}) {
    REQUIRE(result.converged);
    Vec3d load = 0.08 * 0.02 * 0.02 * 1000 * setup.gravity;
    for (const FaceLoad& one : setup.face_loads) {
      const Mat34<double> X = tet_points(setup.mesh, one.tet);
      const int* c = face_corners[one.face];
      load += (X.col(c[1]) - X.col(c[0])).cross(X.col(c[2]) - X.col(c[0])).norm() / 2 * one.traction;
    }
    CHECK((result.reactions.rowwise().sum() + load).norm() < 1e-9 * load.norm());
  }
}

TEST_CASE("quadratic tetrahedra are far closer than plain ones on the same mesh") {
  const auto sag = [](const StaticResult& result) { return result.u.row(2).minCoeff(); };
  const double truth = sag(solve_static_quadratic(cantilever(3)));
  CHECK(sag(solve_static_quadratic(cantilever(2))) == near(truth, 0.02));
  CHECK(sag(solve_static(cantilever(2))) / truth < 0.75);
}

TEST_CASE("nodes of quadratic tetrahedra have the order of the vertices of the refined mesh") {
  const Setup setup = hybrid_setup(irregular_box(2));
  const RefinedMesh refined = refine(setup.mesh);
  const QuadraticMesh mesh(setup.mesh);
  CHECK(mesh.ends == refined.ends);
  CHECK((mesh.joined_linearly(setup.mesh.points) - refined.mesh.points).norm() == 0);
  const Body fine = refined_body(setup, refined);
  for (Index t = 0; t < fine.mesh.tet_count(); ++t) {
    CHECK(fine.material_of[std::size_t(t)] == setup.material_of[std::size_t(t / 8)]);
    CHECK(fine.region_of[std::size_t(t)] == setup.region_of[std::size_t(t / 8)]);
  }
}

TEST_CASE("quadratic tetrahedra of a body that can move freely are refused") {
  Setup setup = setup_of(irregular_box(2));
  CHECK_THROWS_WITH_AS(solve_static_quadratic(setup), doctest::Contains("is not held"), InputError);
  setup.mesh.tets(0, 0) = -1;
  CHECK_THROWS_WITH_AS(solve_static_quadratic(setup), doctest::Contains("names no vertex"), InputError);
}
