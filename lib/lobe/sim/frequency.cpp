#include "lobe/sim/frequency.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "lobe/fem/hooke.h"
#include "lobe/region/nodal_pressure.h"

namespace lobe {
namespace {

Mat3<double> unpack(const DiagonalStiffness& K, Index v) {
  Mat3<double> block;
  block << K(0, v), K(1, v), K(2, v), K(1, v), K(3, v), K(4, v), K(2, v), K(4, v), K(5, v);
  return block;
}

// The stiffness of a body at rest, element by element.
class RestStiffness {
 public:
  explicit RestStiffness(const Elements& elements);
  DiagonalStiffness diagonal() const;
  // y = M^-½ K M^-½ x, root = M^-½.
  void apply_scaled(const std::vector<double>& root, const Mat3X<double>& x, Mat3X<double>& y);

 private:
  template <class Body>
  void for_alive(Body&& body) const {
    for (Index t = 0; t < elements_.topology.tet_count(); ++t)
      if (elements_.topology.alive(t)) body(t);
  }
  Mat3<double> gradient(Index t, const std::vector<double>& root, const Mat3X<double>& x) const;
  double lambda(Index t) const {  // without the share of nodal pressure [Pa]
    const Elastic& elastic = elements_.elastic_of(t);
    return elements_.region_of[t] == RegionModel::nonlinear ? elastic.element_lambda() : elastic.lambda;
  }

  const Elements& elements_;
  std::vector<Shape> shapes_;
  PressureNodes nodes_;
  std::vector<double> volume_strain_, pressure_;
};

RestStiffness::RestStiffness(const Elements& elements)
    : elements_(elements),
      shapes_(std::size_t(elements.topology.tet_count())),
      nodes_(elements),
      volume_strain_(shapes_.size()),
      pressure_(std::size_t(nodes_.count())) {
  for_alive([&](Index t) { shapes_[t] = elements_.shape_of(t); });
}

DiagonalStiffness RestStiffness::diagonal() const {
  DiagonalStiffness K = DiagonalStiffness::Zero(6, elements_.topology.vertex_count());
  Mat3X<double> slopes = Mat3X<double>::Zero(3, 4 * Eigen::Index(shapes_.size()));
  for_alive([&](Index t) {
    const Shape& s = shapes_[t];
    slopes.middleCols<4>(4 * t) = s.volume * s.gradients;
    for (int c = 0; c < 4; ++c) {
      const Vec3d a = s.gradients.col(c);
      const Mat3<double> B = s.volume * hooke_block<double>(a, a, lambda(t), elements_.elastic_of(t).mu);
      K.col(elements_.topology.tets()(c, t)) +=
          Eigen::Matrix<double, 6, 1>(B(0, 0), B(0, 1), B(0, 2), B(1, 1), B(1, 2), B(2, 2));
    }
  });
  nodes_.add_diagonal_stiffness(slopes, K);
  return K;
}

Mat3<double> RestStiffness::gradient(Index t, const std::vector<double>& root, const Mat3X<double>& x) const {
  Mat34<double> u;
  for (int c = 0; c < 4; ++c) {
    const Index v = elements_.topology.tets()(c, t);
    u.col(c) = root[v] * x.col(v);
  }
  return displacement_gradient<double>(u, shapes_[t].gradients.rightCols<3>());
}

void RestStiffness::apply_scaled(const std::vector<double>& root, const Mat3X<double>& x, Mat3X<double>& y) {
  if (nodes_.any()) {
    for_alive([&](Index t) { volume_strain_[t] = shapes_[t].volume * gradient(t, root, x).trace(); });
    Parallel one_thread;
    nodes_.gather(volume_strain_, pressure_, one_thread);
  }
  y.setZero();
  for_alive([&](Index t) {
    Mat3<double> stress = hooke_stress(gradient(t, root, x), lambda(t), elements_.elastic_of(t).mu);
    stress.diagonal().array() += nodes_.mean(pressure_, t);
    const Mat34<double> f =
        corner_forces<double>(shapes_[t].volume * stress, shapes_[t].gradients.rightCols<3>());
    for (int c = 0; c < 4; ++c) {
      const Index v = elements_.topology.tets()(c, t);
      y.col(v) -= root[v] * f.col(c);
    }
  });
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
  RestStiffness K(elements);
  const VertexFrequency start = vertex_frequency(K.diagonal(), inverse_mass);
  if (start.vertex < 0) return 0;
  Mat3X<double> q = Mat3X<double>::Zero(3, n), previous = q, w = q;
  q.col(start.vertex).setConstant(1 / std::sqrt(3.0));
  std::vector<double> alpha, beta;
  for (int i = 0; i < iterations; ++i) {
    K.apply_scaled(root, q, w);
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
