// 10-node tetrahedra, which are the truth for errors of plain ones: a manufactured solution, of order 3 in L2
// and 2 in H1, and the SVK beam of svk_beam.cpp against quadratic hexahedra.
#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>

#include "benchmarks/validation/bodies.h"
#include "benchmarks/validation/cases.h"
#include "benchmarks/validation/exact_field.h"
#include "benchmarks/validation/quadrature.h"
#include "lobe/mesh/generators.h"
#include "lobe/mesh/outer_faces.h"
#include "lobe/scene/material_constants.h"
#include "lobe/solve/quadratic_element.h"
#include "lobe/solve/quadratic_solver.h"

namespace lobe::validation {
namespace {

Mat3X<double> node_solution(const Setup& setup, const QuadraticMesh& mesh, const StaticEquations& equations) {
  StaticResult result = solve_static_quadratic(setup, mesh, equations);
  if (!result.converged) throw std::runtime_error("quadratic solver: " + result.reason);
  return std::move(result.u);
}

// The nodes of the surface have the exact field.
void prescribe_surface(const TetMesh& mesh, const QuadraticMesh& nodes, const ExactField& field,
                       StaticEquations& equations) {
  const Mat3X<double> X = nodes.joined_linearly(mesh.points);
  std::vector<char> outer(std::size_t(nodes.node_count()), 0);
  for (const TetFace& face : outer_faces(mesh))
    for (int n = 0; n < 10; ++n) {
      const bool away =
          n < 4 ? n == face.face : edge_corners[n - 4][0] == face.face || edge_corners[n - 4][1] == face.face;
      if (!away) outer[std::size_t(nodes.nodes(n, face.tet))] = 1;
    }
  equations.unknowns =
      Unknowns(nodes.node_count(), [&](Index node, int) { return !outer[std::size_t(node)]; });
  equations.prescribed.setZero();
  for (Index n = 0; n < nodes.node_count(); ++n)
    if (outer[std::size_t(n)]) equations.prescribed.col(n) = field.displacement(X.col(n));
}

// ∫ N_n b of the body force [N].
void load_nodes(const TetMesh& mesh, const QuadraticMesh& nodes, const ExactField& field, const Law& law,
                Mat3X<double>& loads) {
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Mat34<double> X = tet_points(mesh, t);
    for (const TetPoint& q : tet_quadrature()) {
      const Vec3d force = signed_volume(X) * q.weight * body_force(field, law, X * q.barycentric);
      const NodeValues N = quadratic_values(q.barycentric);
      for (int n = 0; n < 10; ++n) loads.col(nodes.nodes(n, t)) += N[n] * force;
    }
  }
}

struct NodeErrors {
  double l2 = 0, h1 = 0;  // relative to the exact field
};

NodeErrors node_errors(const TetMesh& mesh, const QuadraticMesh& nodes, const Mat3X<double>& u,
                       const ExactField& field) {
  double l2 = 0, h1 = 0, size = 0, slope = 0;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Mat34<double> X = tet_points(mesh, t);
    const Shape s = shape(X);
    Eigen::Matrix<double, 3, 10> at;
    for (int n = 0; n < 10; ++n) at.col(n) = u.col(nodes.nodes(n, t));
    for (const TetPoint& q : tet_quadrature()) {
      const Vec3d x = X * q.barycentric, exact = field.displacement(x);
      const Mat3<double> H = at * quadratic_gradients(s.gradients, q.barycentric).transpose();
      const double weight = s.volume * q.weight;
      l2 += weight * (at * quadratic_values(q.barycentric) - exact).squaredNorm();
      h1 += weight * (H - field.gradient(x)).squaredNorm();
      size += weight * exact.squaredNorm();
      slope += weight * field.gradient(x).squaredNorm();
    }
  }
  return {std::sqrt(l2 / size), std::sqrt(h1 / slope)};
}

NodeErrors manufactured_nodes(const Law& law, double amplitude, int cells) {
  const TetMesh mesh = jittered(box_mesh({1, 1, 2}, cells, cells, 2 * cells), 1.0 / cells, 0.15, 5, false);
  const ExactField field{amplitude, {0.5, 0.5, 1}};
  Setup setup = body_of(mesh, {law.lambda, law.mu, 1}, law.model);
  setup.volume_penalty = law.volume_penalty;
  const QuadraticMesh nodes(mesh);
  StaticEquations equations = quadratic_equations(setup, nodes);
  load_nodes(mesh, nodes, field, law, equations.loads);
  prescribe_surface(mesh, nodes, field, equations);
  return node_errors(mesh, nodes, node_solution(setup, nodes, equations), field);
}

void quadratic_study(Findings& findings, const std::string& name, const Law& law, double amplitude,
                     bool quick) {
  std::vector<double> sizes, l2, h1;
  for (int cells : quick ? std::vector{2, 4} : std::vector{2, 4, 8}) {
    const NodeErrors e = manufactured_nodes(law, amplitude, cells);
    sizes.push_back(1.0 / cells);
    l2.push_back(e.l2);
    h1.push_back(e.h1);
  }
  findings.study("quadratic, " + name + ", L2", sizes, l2);
  const Tolerance slack{0.15, "meshes are not yet in the limit"};
  findings.order(name, "L2 error of u", observed_order(sizes, l2), 3, slack);
  findings.order(name, "H1 error of u", observed_order(sizes, h1), 2, slack);
}

// SofaCaribou's cantilever, 15 × 15 × 80, E = 3000, ν = 0.3, traction −30 on its end.
void quadratic_beam(Findings& findings, int cells) {
  constexpr double width = 15, length = 80;
  const LamePair lame = lame_from_young(3000, 0.3);
  Setup setup = body_of(box_mesh({width, width, length}, cells, cells, 4 * cells), {lame.lambda, lame.mu, 1},
                        RegionModel::nonlinear);
  prescribe(setup, vertices_where(setup.mesh, [](const Vec3d& X) { return X.z() == 0; }),
            [](const Vec3d&) { return Vec3d::Zero(); });
  load_faces(
      setup, [](const Vec3d& X) { return X.z() == length; }, [](const Vec3d&) { return Vec3d(0, -30, 0); });
  const Vec3d centre(width / 2, width / 2, length);
  const Index v =
      vertices_where(setup.mesh, [&](const Vec3d& X) { return (X - centre).norm() < 1e-9; }).front();
  const QuadraticMesh nodes(setup.mesh);
  const Vec3d end = node_solution(setup, nodes, quadratic_equations(setup, nodes)).col(v);
  const Reference uy{-52.380, "Q2 hexahedra, 3 × 3 × 12"}, uz{-24.201, uy.source};
  const Tolerance mesh{0.012, "mesh error of both"};
  const std::string name = "SVK beam, ν = 0.3, " + std::to_string(cells) + " cells across";
  findings.value(name, "u_y of the end", "-", end.y(), uy, mesh);
  findings.value(name, "u_z of the end", "-", end.z(), uz, mesh);
}

}  // namespace

void quadratic_tetrahedra(Findings& findings, bool quick) {
  quadratic_study(findings, "box, linear", {RegionModel::tensor_mass}, 1e-3, quick);
  quadratic_study(findings, "box, SVK with volume term", {RegionModel::nonlinear, 1.25, 1, 2.5}, 0.1, quick);
  quadratic_beam(findings, quick ? 2 : 4);
}

}  // namespace lobe::validation
