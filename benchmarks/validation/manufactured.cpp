// Manufactured solutions: static equilibria of known displacement, on refined meshes; order 2 in L2, 1 in H1.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "benchmarks/validation/bodies.h"
#include "benchmarks/validation/cases.h"
#include "benchmarks/validation/exact_field.h"
#include "benchmarks/validation/quadrature.h"
#include "lobe/fem/shape.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/select.h"

namespace lobe::validation {
namespace {

// Consistent nodal forces ∫ φ_v b of the body force [N].
void load_volume(Setup& setup, const ExactField& field, const Law& law) {
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const Mat34<double> X = tet_points(setup.mesh, t);
    const double volume = signed_volume(X);
    Mat34<double> force = Mat34<double>::Zero();
    for (const TetPoint& q : tet_quadrature())
      force += volume * q.weight * body_force(field, law, X * q.barycentric) * q.barycentric.transpose();
    for (int c = 0; c < 4; ++c) setup.vertex_loads.push_back({setup.mesh.tets(c, t), force.col(c)});
  }
}

// Consistent nodal forces ∫ φ_v P N on the faces of a plane z = height, N = (0, 0, 1) [N].
void load_top(Setup& setup, const ExactField& field, const Law& law, double height) {
  const TetMesh& mesh = setup.mesh;
  for (const TetFace& face : outer_faces(mesh)) {
    Eigen::Vector3i v;
    for (int i = 0; i < 3; ++i) v[i] = mesh.tets(face_corners[face.face][i], face.tet);
    Mat3<double> X;
    for (int i = 0; i < 3; ++i) X.col(i) = mesh.points.col(v[i]);
    if ((X.row(2).array() - height).abs().maxCoeff() > 1e-9 * height) continue;
    const double area = (X.col(1) - X.col(0)).cross(X.col(2) - X.col(0)).norm() / 2;
    for (const TrianglePoint& q : triangle_quadrature()) {
      const Vec3d traction = law.stress(field.gradient(X * q.barycentric), X * q.barycentric).col(2);
      for (int i = 0; i < 3; ++i)
        setup.vertex_loads.push_back({v[i], area * q.weight * q.barycentric[i] * traction});
    }
  }
}

struct Errors {
  double l2 = 0, h1 = 0;  // relative to the exact field
};

Errors errors_of(const TetMesh& mesh, const Mat3X<double>& u, const ExactField& field) {
  double l2 = 0, h1 = 0, size = 0, slope = 0;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Mat34<double> X = tet_points(mesh, t);
    const Shape s = shape(X);
    Mat34<double> at;
    for (int c = 0; c < 4; ++c) at.col(c) = u.col(mesh.tets(c, t));
    const Mat3<double> H = at * s.gradients.transpose();
    for (const TetPoint& q : tet_quadrature()) {
      const Vec3d x = X * q.barycentric, exact = field.displacement(x);
      const Mat3<double> exact_gradient = field.gradient(x);
      const double weight = s.volume * q.weight;
      l2 += weight * (at * q.barycentric - exact).squaredNorm();
      h1 += weight * (H - exact_gradient).squaredNorm();
      size += weight * exact.squaredNorm();
      slope += weight * exact_gradient.squaredNorm();
    }
  }
  return {std::sqrt(l2 / size), std::sqrt(h1 / slope)};
}

struct Problem {
  const char* name;
  Law law;
  double amplitude = 1e-3;
  bool cylinder = true;  // radius 1, length 3; else a box 1 × 1 × 2, its inner vertices moved at random
  bool traction_top = false;  // P N on the upper end in place of displacements
};

constexpr double manufactured_cylinder_length = 3, box_length = 2;

Errors solve(const Problem& problem, int cells) {
  const double length = problem.cylinder ? manufactured_cylinder_length : box_length;
  const TetMesh mesh = problem.cylinder ? cylinder_mesh(1, length, cells, 3 * cells)
                                        : jittered(box_mesh({1, 1, length}, cells, cells, 2 * cells),
                                                   1.0 / cells, 0.15, 5, false);
  const ExactField field{problem.amplitude,
                         problem.cylinder ? Vec3d(0, 0, length / 2) : Vec3d(0.5, 0.5, length / 2)};
  Setup setup = body_of(mesh, {problem.law.lambda, problem.law.mu, 1}, problem.law.model);
  setup.volume_penalty = problem.law.volume_penalty;
  if (problem.law.fibre.any()) {
    setup.materials[0].fibre = problem.law.fibre;
    setup.mesh.fibres.resize(3, mesh.tet_count());
    for (Index t = 0; t < mesh.tet_count(); ++t)
      setup.mesh.fibres.col(t) = problem.law.direction(tet_points(mesh, t).rowwise().mean());
  }
  load_volume(setup, field, problem.law);
  std::vector<Index> held = outer_vertices(mesh);
  if (problem.traction_top) {
    load_top(setup, field, problem.law, length);
    std::erase_if(held, [&](Index v) {
      const Vec3d X = mesh.points.col(v);
      const double away =
          problem.cylinder ? X.head<2>().norm() - 1 : (X.head<2>().array() - 0.5).abs().maxCoeff() - 0.5;
      return X.z() > length * (1 - 1e-9) && away < -1e-9;
    });
  }
  prescribe(setup, held, [&](const Vec3d& X) { return field.displacement(X); });
  return errors_of(mesh, equilibrium(setup), field);
}

void study(Findings& findings, const Problem& problem, const std::vector<int>& cells) {
  std::vector<double> sizes, l2, h1;
  for (int n : cells) {
    const Errors e = solve(problem, n);
    sizes.push_back(1.0 / n);
    l2.push_back(e.l2);
    h1.push_back(e.h1);
  }
  const std::string name = problem.name;
  findings.study(name + ", L2", sizes, l2);
  findings.study(name + ", H1", sizes, h1);
  const Tolerance two{0.1, "meshes are not yet in the limit"}, one{0.05, two.basis};
  findings.order(name, "L2 error of u", observed_order(sizes, l2), 2, two);
  findings.order(name, "H1 error of u", observed_order(sizes, h1), 1, one);
}

}  // namespace

void manufactured_solutions(Findings& findings, bool quick) {
  const Law linear{RegionModel::tensor_mass}, svk{RegionModel::nonlinear},
      with_volume_term{RegionModel::nonlinear, 1.25, 1, 2.5};
  const std::vector<int> cylinder = quick ? std::vector{2, 4, 8} : std::vector{3, 5, 10};
  const std::vector<int> box = quick ? std::vector{3, 6, 12} : std::vector{4, 8, 16};
  study(findings, {"cylinder, linear", linear}, cylinder);
  study(findings, {"cylinder, SVK, ∇u up to 0.4", svk, 0.05}, cylinder);
  study(findings, {"cylinder, SVK, traction on an end", svk, 0.05, true, true}, cylinder);
  study(findings, {"box, linear, traction on an end", linear, 1e-3, false, true}, box);
  study(findings, {"box, SVK with volume term", with_volume_term, 0.1, false}, box);
  Law fibrous = svk, linear_fibrous = linear;
  fibrous.fibre = linear_fibrous.fibre = {0.5, 0.8, 3};
  study(findings, {"box, linear, fibres that turn, traction on an end", linear_fibrous, 1e-3, false, true},
        box);
  study(findings, {"box, SVK, fibres that turn", fibrous, 0.1, false}, box);
}

}  // namespace lobe::validation
