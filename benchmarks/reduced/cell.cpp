#include "benchmarks/reduced/cell.h"

#include <Eigen/Cholesky>
#include <Eigen/Dense>

#include "lobe/sort_unique.h"

namespace lobe::reduced {
namespace {

// Of e_i ⊗ g and e_j ⊗ g', of Hooke's law: entry (i, j).
Mat3<double> product(const Elastic& elastic, const Vec3d& g, const Vec3d& other) {
  return elastic.lambda * g * other.transpose() + elastic.mu * other * g.transpose() +
         elastic.mu * g.dot(other) * Mat3<double>::Identity();
}

constexpr int fields = 7;  // the four trilinear functions that are not affine; ξ², η², ζ²

struct Gradients {
  std::vector<Eigen::Matrix<double, 3, fields>> of_tet;  // less their mean [1/m]
  Eigen::Matrix<double, 3, fields> mean = Eigen::Matrix<double, 3, fields>::Zero();
  double volume = 0;
};

Gradients gradients(const Elements& elements, const Lattice& lattice, Index cell,
                    const std::vector<Index>& tets) {
  Gradients g;
  for (Index t : tets) {
    const Shape shape = elements.shape_of(t);
    Eigen::Matrix<double, 3, fields> own = Eigen::Matrix<double, 3, fields>::Zero();
    for (int p = 0; p < 4; ++p) {
      const Vec3d xi = lattice.local(cell, elements.points.col(elements.topology.tets()(p, t)));
      const auto phi = trilinear_functions(xi);
      for (int k = 0; k < 4; ++k) own.col(k) += phi[4 + k] * shape.gradients.col(p);
      for (int d = 0; d < 3; ++d) own.col(4 + d) += xi[d] * xi[d] * shape.gradients.col(p);
    }
    g.of_tet.push_back(own);
    g.mean += shape.volume * own;
    g.volume += shape.volume;
  }
  g.mean /= g.volume;
  for (auto& own : g.of_tet) own -= g.mean;
  return g;
}

using Stiffness = Eigen::Matrix<double, 3 * fields, 3 * fields>;

Stiffness stiffness(const Elements& elements, const std::vector<Index>& tets, const Gradients& g) {
  Stiffness K = Stiffness::Zero();
  for (std::size_t n = 0; n < tets.size(); ++n)
    for (int k = 0; k < fields; ++k)
      for (int l = 0; l < fields; ++l)
        K.block<3, 3>(3 * k, 3 * l) +=
            elements.volume(tets[n]) *
            product(elements.elastic_of(tets[n]), g.of_tet[n].col(k), g.of_tet[n].col(l));
  return K;
}

// Of a full cube of volume 1 m³, of the four functions: they are orthogonal to each other in it.
Stiffness cube(const Elastic& elastic, double spacing) {
  Stiffness K = Stiffness::Zero();
  const double s = 2 / spacing, at = 1 / std::sqrt(3.0);
  for (int q = 0; q < 8; ++q) {
    const Vec3d xi(q & 1 ? at : -at, q & 2 ? at : -at, q & 4 ? at : -at);
    Eigen::Matrix<double, 3, fields> g;
    g << 0, xi[2], xi[1], xi[1] * xi[2], 2 * xi[0], 0, 0,  //
        xi[2], 0, xi[0], xi[2] * xi[0], 0, 2 * xi[1], 0,   //
        xi[1], xi[0], 0, xi[0] * xi[1], 0, 0, 2 * xi[2];
    g *= s;
    for (int k = 0; k < fields; ++k)
      for (int l = 0; l < fields; ++l)
        K.block<3, 3>(3 * k, 3 * l) += product(elastic, g.col(k), g.col(l)) / 8;
  }
  return K;
}

Eigen::Matrix<double, 12, 12> condensed(const Stiffness& K) {
  const Eigen::Matrix<double, 9, 9> inner = K.bottomRightCorner<9, 9>();
  const Eigen::Matrix<double, 9, 9> shifted =
      inner + 1e-9 * inner.trace() * Eigen::Matrix<double, 9, 9>::Identity();
  return K.topLeftCorner<12, 12>() -
         K.topRightCorner<12, 9>() * shifted.ldlt().solve(K.bottomLeftCorner<9, 12>());
}

// All vertices of the tetrahedra move so that their energy is the least, while the sums Σ m_i φ_n(X_i) w_i of
// what they move beyond the eight functions are zero: moments that a lattice can see.
Eigen::Matrix<double, 12, 12> homogenised(const Elements& elements, const Lattice& lattice, Index cell,
                                          const std::vector<Index>& tets, const Gradients& g) {
  std::vector<Index> vertices;
  for (Index t : tets)
    for (int p = 0; p < 4; ++p) vertices.push_back(elements.topology.tets()(p, t));
  sort_unique(vertices);
  const auto n = static_cast<Index>(vertices.size()), size = 3 * n + 24 + 9;
  const auto number = [&](Index v) {
    return static_cast<Index>(std::lower_bound(vertices.begin(), vertices.end(), v) - vertices.begin());
  };
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(size, size), B = Eigen::MatrixXd::Zero(size, 12);
  double scale = 0;
  for (std::size_t q = 0; q < tets.size(); ++q) {
    const Shape shape = elements.shape_of(tets[q]);
    const Elastic& elastic = elements.elastic_of(tets[q]);
    for (int a = 0; a < 4; ++a) {
      const Index row = number(elements.topology.tets()(a, tets[q]));
      const Vec3d xi = lattice.local(cell, elements.points.col(vertices[row]));
      const auto phi = trilinear_functions(xi);
      for (int m = 0; m < 8; ++m)
        for (int d = 0; d < 3; ++d) A(3 * n + 3 * m + d, 3 * row + d) += shape.volume / 4 * phi[m];
      for (int d = 0; d < 3; ++d)
        for (int e = 0; e < 3; ++e)
          A(3 * n + 24 + 3 * d + e, 3 * row + d) += shape.volume * shape.gradients(e, a);
      for (int b = 0; b < 4; ++b)
        A.block<3, 3>(3 * row, 3 * number(elements.topology.tets()(b, tets[q]))) +=
            shape.volume * product(elastic, shape.gradients.col(a), shape.gradients.col(b));
      for (int k = 0; k < 4; ++k)
        B.block<3, 3>(3 * row, 3 * k) +=
            shape.volume * product(elastic, shape.gradients.col(a), g.of_tet[q].col(k));
    }
  }
  scale = A.topLeftCorner(3 * n, 3 * n).diagonal().mean();
  const double length = lattice.spacing / 2;
  Eigen::MatrixXd C = A.bottomLeftCorner(33, 3 * n);
  C.topRows(24) *= scale / (g.volume / n);
  C.bottomRows(9) *= scale * length / g.volume;
  A.bottomLeftCorner(33, 3 * n) = C;
  A.topRightCorner(3 * n, 33) = C.transpose();
  A.bottomRightCorner(33, 33) = -1e-7 * scale * Eigen::MatrixXd::Identity(33, 33);
  A.topLeftCorner(3 * n, 3 * n) += 1e-9 * scale * Eigen::MatrixXd::Identity(3 * n, 3 * n);
  const Eigen::MatrixXd w = A.partialPivLu().solve(B);
  return -B.transpose() * w;
}

}  // namespace

Cell make_cell(const Elements& elements, const Lattice& lattice, Index cell, const std::vector<Index>& tets,
               Stiffening stiffening, double hold) {
  const Gradients g = gradients(elements, lattice, cell, tets);
  Cell made{.volume = g.volume, .mean = g.mean.leftCols<4>(), .K = Eigen::Matrix<double, 12, 12>::Zero()};
  if (stiffening == Stiffening::none) return made;
  const Elastic& elastic = elements.elastic_of(tets.front());
  const Stiffness K = stiffness(elements, tets, g);
  const double empty = std::max(0.0, std::pow(lattice.spacing, 3) - g.volume);
  const Stiffness full = hold * empty * cube(elastic, lattice.spacing);
  if (stiffening == Stiffening::fluctuation) {
    for (std::size_t n = 0; n < tets.size(); ++n)
      for (int k = 0; k < 4; ++k)
        for (int l = 0; l < 4; ++l)
          made.K.block<3, 3>(3 * k, 3 * l) += 2 * elastic.mu * elements.volume(tets[n]) *
                                              g.of_tet[n].col(k).dot(g.of_tet[n].col(l)) *
                                              Mat3<double>::Identity();
    made.K += full.topLeftCorner<12, 12>();
  }
  if (stiffening == Stiffening::galerkin) made.K = (K + full).topLeftCorner<12, 12>();
  if (stiffening == Stiffening::relaxed) made.K = condensed(K + full);
  if (stiffening == Stiffening::homogenised)
    made.K = (K + full).topLeftCorner<12, 12>() + homogenised(elements, lattice, cell, tets, g);
  return made;
}

}  // namespace lobe::reduced
