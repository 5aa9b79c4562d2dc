#include "lobe/sim/frequency.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "lobe/fem/hooke.h"

namespace lobe {
namespace {

Mat3<double> unpack(const DiagonalStiffness& K, Index v) {
  Mat3<double> block;
  block << K(0, v), K(1, v), K(2, v), K(1, v), K(3, v), K(4, v), K(2, v), K(4, v), K(5, v);
  return block;
}

// y = M^-½ K M^-½ x with the stiffness at rest, element by element.
void apply_scaled_stiffness(const Elements& elements, const std::vector<Shape>& shapes,
                            const std::vector<double>& root, const Mat3X<double>& x, Mat3X<double>& y) {
  y.setZero();
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    if (!elements.topology.alive(t)) continue;
    const Eigen::Vector4i v = elements.topology.corners(t);
    Mat34<double> u;
    for (int c = 0; c < 4; ++c) u.col(c) = root[v[c]] * x.col(v[c]);
    const Mat3<double> alpha = shapes[t].gradients.rightCols<3>();
    const Elastic& elastic = elements.elastic_of(t);
    const Mat3<double> stress = hooke_stress(displacement_gradient(u, alpha), elastic.lambda, elastic.mu);
    const Mat34<double> f = corner_forces<double>(shapes[t].volume * stress, alpha);
    for (int c = 0; c < 4; ++c) y.col(v[c]) -= root[v[c]] * f.col(c);
  }
}

DiagonalStiffness rest_diagonal(const Elements& elements) {
  DiagonalStiffness K = DiagonalStiffness::Zero(6, elements.topology.vertex_count());
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    if (!elements.topology.alive(t)) continue;
    const Shape s = elements.shape_of(t);
    const Elastic& elastic = elements.elastic_of(t);
    for (int c = 0; c < 4; ++c) {
      const Vec3d a = s.gradients.col(c);
      const Mat3<double> B = s.volume * hooke_block<double>(a, a, elastic.lambda, elastic.mu);
      K.col(elements.topology.tets()(c, t)) +=
          Eigen::Matrix<double, 6, 1>(B(0, 0), B(0, 1), B(0, 2), B(1, 1), B(1, 2), B(2, 2));
    }
  }
  return K;
}

}  // namespace

VertexFrequency vertex_frequency(const DiagonalStiffness& K, const std::vector<double>& inverse_mass) {
  VertexFrequency highest;
  double highest_square = 0;
  for (Index v = 0; v < K.cols(); ++v) {
    if (inverse_mass[v] == 0) continue;
    // The trace bounds the largest eigenvalue, and saves most of the eigenvalue problems.
    if ((K(0, v) + K(3, v) + K(5, v)) * inverse_mass[v] <= highest_square) continue;
    Eigen::SelfAdjointEigenSolver<Mat3<double>> solver;
    solver.computeDirect(unpack(K, v), Eigen::EigenvaluesOnly);
    const double square = solver.eigenvalues()[2] * inverse_mass[v];
    if (square > highest_square) {
      highest_square = square;
      highest.vertex = v;
    }
  }
  highest.omega = std::sqrt(highest_square);
  return highest;
}

double lanczos_frequency(const Elements& elements, const std::vector<double>& inverse_mass, int iterations) {
  const Index n = elements.topology.vertex_count();
  std::vector<double> root(inverse_mass.size());
  for (std::size_t i = 0; i < root.size(); ++i) root[i] = std::sqrt(inverse_mass[i]);
  std::vector<Shape> shapes(std::size_t(elements.topology.tet_count()));
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    if (elements.topology.alive(t)) shapes[t] = elements.shape_of(t);
  const VertexFrequency start = vertex_frequency(rest_diagonal(elements), inverse_mass);
  if (start.vertex < 0) return 0;
  Mat3X<double> q = Mat3X<double>::Zero(3, n), previous = q, w = q;
  q.col(start.vertex).setConstant(1 / std::sqrt(3.0));
  std::vector<double> alpha, beta;
  for (int i = 0; i < iterations; ++i) {
    apply_scaled_stiffness(elements, shapes, root, q, w);
    if (i > 0) w -= beta.back() * previous;
    alpha.push_back(w.cwiseProduct(q).sum());
    w -= alpha.back() * q;
    const double norm = w.norm();
    if (norm < 1e-12 * alpha.front()) break;
    beta.push_back(norm);
    previous = q;
    q = w / norm;
  }
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  const Eigen::Index m = static_cast<Eigen::Index>(alpha.size());
  const Eigen::VectorXd diagonal = Eigen::Map<Eigen::VectorXd>(alpha.data(), m);
  const Eigen::VectorXd off_diagonal = Eigen::Map<Eigen::VectorXd>(beta.data(), m - 1);
  solver.computeFromTridiagonal(diagonal, off_diagonal, Eigen::EigenvaluesOnly);
  return std::max(start.omega, std::sqrt(solver.eigenvalues().maxCoeff()));
}

double rest_time_step(const TetMesh& mesh, const Elastic& elastic) {
  Body body;
  body.mesh = mesh;
  body.materials = {elastic};
  body.material_of.assign(std::size_t(mesh.tet_count()), 0);
  body.region_of.assign(std::size_t(mesh.tet_count()), RegionModel::nonlinear);
  const Elements elements(body);
  std::vector<double> inverse_mass;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const double mass = lumped_mass(elements, v);
    inverse_mass.push_back(mass > 0 ? 1 / mass : 0);
  }
  return 2 / lanczos_frequency(elements, inverse_mass);
}

}  // namespace lobe
