#include "lobe/lattice/settle.h"

#include <algorithm>

#include "lobe/numerics/symmetric_eigen.h"

namespace lobe {
namespace {

// A = Σ_i m_i w_i w_iᵀ + S/ω², part by part, of the parts that have a node that is touched. One matrix for
// all three components.
class NormalEquations {
 public:
  NormalEquations(const Elements& elements, const Lattice& lattice, const Embedding& embedding,
                  const std::vector<LatticeCell>& whole, const std::vector<double>& mass, double omega,
                  const std::vector<std::uint8_t>& touched)
      : elements_(elements), lattice_(lattice), mass_(mass), touched_(touched) {
    for (std::size_t p = 0; p < lattice.parts.size(); ++p) {
      const auto& nodes = lattice.parts[p].nodes;
      if (std::none_of(nodes.begin(), nodes.end(), [&](Index n) { return is_touched(n); })) continue;
      if (slot_.empty()) slot_.assign(lattice.parts.size(), -1);
      slot_[p] = static_cast<Index>(parts_.size());
      parts_.push_back({nodes, CellMatrix::Zero(), CellMatrix::Zero()});
    }
    if (parts_.empty()) return;
    for (Index v : embedding.vertices) {
      const Index slot = slot_[std::size_t(part_of(v))];
      if (slot < 0) continue;
      vertices_.push_back(v);
      const CellWeights w = lattice.weights(v, elements.points.col(v));
      parts_[std::size_t(slot)].matrix += mass[std::size_t(v)] * w * w.transpose();
    }
    for (const LatticeCell& cell : whole) {
      const Index slot = slot_[std::size_t(cell.part)];
      if (slot < 0) continue;
      Part& part = parts_[std::size_t(slot)];
      part.fluctuation = cell.fluctuation / (omega * omega);
      part.matrix += part.fluctuation;
    }
  }

  // What is left of Σ_i m_i w_i u_i, from differences, which are small.
  Mat3X<double> residual(const Mat3X<double>& u, const Mat3X<double>& q) const {
    Mat3X<double> r = Mat3X<double>::Zero(3, q.cols());
    for (Index v : vertices_) {
      const CellWeights w = lattice_.weights(v, elements_.points.col(v));
      const auto& nodes = lattice_.parts[std::size_t(part_of(v))].nodes;
      Vec3d left = u.col(v);
      for (int n = 0; n < 8; ++n) left -= w[n] * q.col(nodes[std::size_t(n)]);
      left *= mass_[std::size_t(v)];
      for (int n = 0; n < 8; ++n) r.col(nodes[std::size_t(n)]) += w[n] * left;
    }
    for (const Part& part : parts_) add(part, -part.fluctuation, q, r);
    return leave_untouched(std::move(r));
  }
  Mat3X<double> times(const Mat3X<double>& q) const {
    Mat3X<double> r = Mat3X<double>::Zero(3, q.cols());
    for (const Part& part : parts_) add(part, part.matrix, q, r);
    return leave_untouched(std::move(r));
  }
  Mat3X<double> diagonal() const {  // 1 where there is none
    Mat3X<double> d = Mat3X<double>::Zero(3, lattice_.node_count());
    for (const Part& part : parts_)
      for (int n = 0; n < 8; ++n) d.col(part.nodes[std::size_t(n)]).array() += part.matrix(n, n);
    return (d.array() > 0).select(d, 1);
  }

 private:
  struct Part {
    std::array<Index, 8> nodes;
    CellMatrix matrix, fluctuation;
  };
  bool is_touched(Index node) const { return touched_[std::size_t(node)] != 0; }
  Index part_of(Index vertex) const { return lattice_.part_of_vertex[std::size_t(vertex)]; }
  static void add(const Part& part, const CellMatrix& A, const Mat3X<double>& q, Mat3X<double>& r) {
    Eigen::Matrix<double, 3, 8> at;
    for (int n = 0; n < 8; ++n) at.col(n) = q.col(part.nodes[std::size_t(n)]);
    const Eigen::Matrix<double, 3, 8> image = at * A;
    for (int n = 0; n < 8; ++n) r.col(part.nodes[std::size_t(n)]) += image.col(n);
  }
  Mat3X<double> leave_untouched(Mat3X<double> r) const {
    for (Index n = 0; n < lattice_.node_count(); ++n)
      if (!is_touched(n)) r.col(n).setZero();
    return r;
  }

  const Elements& elements_;
  const Lattice& lattice_;
  const std::vector<double>& mass_;
  const std::vector<std::uint8_t>& touched_;
  std::vector<Index> slot_;  // per part of the lattice, in parts_; −1: not touched
  std::vector<Part> parts_;
  std::vector<Index> vertices_;
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
  const auto [inertias, axes] = symmetric_eigen(inertia);
  const Vec3d torque = axes.transpose() * (momentum.angular - at.cross(momentum.linear));
  Vec3d spin = Vec3d::Zero();
  for (int i = 0; i < 3; ++i)
    if (inertias[i] > 1e-9 * inertias[2]) spin[i] = torque[i] / inertias[i];
  return {at, momentum.linear / mass, axes * spin};
}

}  // namespace lobe
