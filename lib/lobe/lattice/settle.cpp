#include "lobe/lattice/settle.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace lobe {
namespace {

// Σ_i m_i w_i w_iᵀ + S/ω², of the nodes that are touched.
class NormalEquations {
 public:
  NormalEquations(const Elements& elements, const Lattice& lattice, const Embedding& embedding,
                  const std::vector<LatticeCell>& whole, const std::vector<double>& mass, double omega,
                  const std::vector<std::uint8_t>& touched)
      : lattice_(lattice), touched_(touched), square_(omega * omega) {
    const auto is_touched = [&](Index part) {
      const auto& nodes = lattice.parts[std::size_t(part)].nodes;
      return std::any_of(nodes.begin(), nodes.end(), [&](Index n) { return touched[std::size_t(n)] != 0; });
    };
    for (Index v : embedding.vertices)
      if (const Index part = lattice.part_of_vertex[std::size_t(v)]; is_touched(part))
        rows_.push_back({v, part, mass[std::size_t(v)], lattice.weights(v, elements.points.col(v))});
    for (const LatticeCell& cell : whole)
      if (is_touched(cell.part)) cells_.push_back(&cell);
  }

  Mat3X<double> residual(const Mat3X<double>& u, const Mat3X<double>& q) const {
    Mat3X<double> r = Mat3X<double>::Zero(3, q.cols());
    for (const Row& row : rows_) add(row, row.mass * (u.col(row.vertex) - value(row, q)), r);
    add_fluctuation(q, -1, r);
    return leave_untouched(std::move(r));
  }
  Mat3X<double> times(const Mat3X<double>& q) const {
    Mat3X<double> r = Mat3X<double>::Zero(3, q.cols());
    for (const Row& row : rows_) add(row, row.mass * value(row, q), r);
    add_fluctuation(q, 1, r);
    return leave_untouched(std::move(r));
  }
  Mat3X<double> diagonal() const {  // 1 where there is none
    Mat3X<double> d = Mat3X<double>::Zero(3, lattice_.node_count());
    for (const Row& row : rows_)
      for (int n = 0; n < 8; ++n)
        d.col(node(row.part, n)).array() += row.mass * row.weights[n] * row.weights[n];
    for (const LatticeCell* cell : cells_)
      for (int n = 0; n < 8; ++n) d.col(node(cell->part, n)).array() += cell->fluctuation(n, n) / square_;
    return (d.array() > 0).select(d, 1);
  }

 private:
  struct Row {
    Index vertex, part;
    double mass;
    CellWeights weights;
  };
  Index node(Index part, int n) const { return lattice_.parts[std::size_t(part)].nodes[std::size_t(n)]; }
  Vec3d value(const Row& row, const Mat3X<double>& q) const {
    Vec3d sum = Vec3d::Zero();
    for (int n = 0; n < 8; ++n) sum += row.weights[n] * q.col(node(row.part, n));
    return sum;
  }
  void add(const Row& row, const Vec3d& value, Mat3X<double>& r) const {
    for (int n = 0; n < 8; ++n) r.col(node(row.part, n)) += row.weights[n] * value;
  }
  void add_fluctuation(const Mat3X<double>& q, double sign, Mat3X<double>& r) const {
    for (const LatticeCell* cell : cells_)
      for (int n = 0; n < 8; ++n)
        for (int m = 0; m < 8; ++m)
          r.col(node(cell->part, n)) += sign / square_ * cell->fluctuation(n, m) * q.col(node(cell->part, m));
  }
  Mat3X<double> leave_untouched(Mat3X<double> r) const {
    for (Index n = 0; n < lattice_.node_count(); ++n)
      if (!touched_[std::size_t(n)]) r.col(n).setZero();
    return r;
  }

  const Lattice& lattice_;
  const std::vector<std::uint8_t>& touched_;
  double square_;
  std::vector<Row> rows_;
  std::vector<const LatticeCell*> cells_;
};

}  // namespace

// By conjugate gradients, in all three components at once.
void settle(const Elements& elements, const Lattice& lattice, const Embedding& embedding,
            const std::vector<LatticeCell>& whole, const std::vector<double>& mass, double omega,
            const std::vector<std::uint8_t>& touched, const Mat3X<double>& u, double tolerance,
            Mat3X<double>& q) {
  constexpr int most = 200;
  const NormalEquations equations(elements, lattice, embedding, whole, mass, omega, touched);
  const Mat3X<double> scale = equations.diagonal().cwiseInverse();
  Mat3X<double> left = equations.residual(u, q), along = scale.cwiseProduct(left);
  double square = left.cwiseProduct(along).sum();
  const double first = square;
  for (int i = 0; i < most && square > tolerance * first; ++i) {
    const Mat3X<double> image = equations.times(along);
    const double step = square / along.cwiseProduct(image).sum();
    q += step * along;
    left -= step * image;
    const Mat3X<double> scaled = scale.cwiseProduct(left);
    const double next = left.cwiseProduct(scaled).sum();
    along = scaled + next / square * along;
    square = next;
  }
}

MovingMasses::Momentum MovingMasses::momentum() const {
  Momentum sum;
  for (const Mass& own : own_) {
    sum.linear += own.mass * own.v;
    sum.angular += own.mass * own.x.cross(own.v);
  }
  return sum;
}

// Directions in which the masses do not resist a rotation, as those of a line do, are left out.
MovingMasses::Motion MovingMasses::moved_by(const Momentum& momentum) const {
  double mass = 0;
  Vec3d at = Vec3d::Zero();
  for (const Mass& own : own_) {
    mass += own.mass;
    at += own.mass * own.x;
  }
  if (!(mass > 0)) return {};
  at /= mass;
  Mat3<double> inertia = Mat3<double>::Zero();
  for (const Mass& own : own_) {
    const Vec3d arm = own.x - at;
    inertia += own.mass * (arm.squaredNorm() * Mat3<double>::Identity() - arm * arm.transpose());
  }
  const Eigen::SelfAdjointEigenSolver<Mat3<double>> solver(inertia);
  const Vec3d torque = solver.eigenvectors().transpose() * (momentum.angular - at.cross(momentum.linear));
  Vec3d spin = Vec3d::Zero();
  for (int i = 0; i < 3; ++i)
    if (solver.eigenvalues()[i] > 1e-9 * solver.eigenvalues()[2])
      spin[i] = torque[i] / solver.eigenvalues()[i];
  return {at, momentum.linear / mass, solver.eigenvectors() * spin};
}

}  // namespace lobe
