#include "benchmarks/reduced/trial_body.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "lobe/numerics/lanczos.h"
#include "lobe/sort_unique.h"

namespace lobe::reduced {
namespace {

double highest(const DiagonalStiffness& K, Index v) {  // eigenvalue of its 3 × 3 block
  Mat3<double> own;
  own << K(0, v), K(1, v), K(2, v), K(1, v), K(3, v), K(4, v), K(2, v), K(4, v), K(5, v);
  Eigen::SelfAdjointEigenSolver<Mat3<double>> solver;
  solver.computeDirect(own, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[2];
}

}  // namespace

template <class Real>
TrialBody<Real>::TrialBody(const Body& body, const std::vector<std::uint8_t>& held,
                           const TrialSettings& settings)
    : elements_(body),
      held_(held),
      settings_(settings),
      lattice_(make_lattice(elements_, settings.spacing)),
      law_{body.materials[0].lambda, body.materials[0].mu, body.volume_penalty, 2 / settings.spacing} {
  const Index vertices = elements_.topology.vertex_count();
  for (Mat3X<Real>* field : {&u_, &v_, &f_}) field->setZero(3, vertices);
  for (Nodes* nodes : {&q_, &vq_, &fq_}) nodes->assign(4 * std::size_t(lattice_.node_count), Real(0));
  whole_cells_.resize(lattice_.tets.size());
  for (Index v = 0; v < vertices; ++v) {
    mass_.push_back(lumped_mass(elements_, v));
    inverse_mass_.push_back(held_[v] ? Real(0) : Real(1 / mass_.back()));
  }
  membership_.motion.assign(vertices, Motion::own);
  membership_.full.assign(elements_.topology.tet_count(), 0);
  elements_.region_of.assign(elements_.region_of.size(), RegionModel::tensor_mass);
  set_zone(std::vector<std::uint8_t>(vertices, 1));
  transitions_ = {};
  stiffness_.setZero(6, vertices);
  rest_limit_ = limit();
}

// The ratio of what Lanczos iterations find about the present state to the vertex estimate there.
template <class Real>
void TrialBody<Real>::measure_limit(double estimate) {
  std::vector<double> inverse(held_.size(), 0);
  for (Index v : own_) inverse[v] = double(inverse_mass_[v]);
  Mat3X<Real> here = Mat3X<Real>::Zero(3, u_.cols()), moved = u_;
  patches_.add_forces(u_, here, ElementPart::all, parallel_);
  const auto found = highest_frequency<Real>(
      inverse, [&](Index v) { return inverse[v] == 0 ? 0 : highest(stiffness_, v) * inverse[v]; },
      1e-3 * lattice_.spacing,
      [&](const Mat3X<Real>& d, Mat3X<Real>& f) {
        moved = u_ + d;
        patches_.add_forces(moved, f, ElementPart::all, parallel_);
        f -= here;
      });
  ratio_ = found.omega / std::sqrt(estimate);
  measured_at_ = estimate;
}

template <class Real>
double TrialBody<Real>::limit() {
  for (Index v : used_) stiffness_.col(v).setZero();
  patches_.add_diagonal_stiffness(u_, stiffness_, parallel_);
  double most = 0;
  for (Index v : own_) most = std::max(most, highest(stiffness_, v) * double(inverse_mass_[v]));
  if (most > 1.1 * measured_at_ || most < 0.8 * measured_at_) measure_limit(most);
  return std::min(2 / (ratio_ * std::sqrt(most)), node_limit_);
}

template <class Real>
void TrialBody<Real>::set_zone(const std::vector<std::uint8_t>& wanted) {
  expand();
  const Membership before = std::move(membership_);
  membership_ = make_membership(elements_, lattice_, held_, wanted);
  std::vector<Index> left, entered, joining, embedded;
  for (Index t = 0; t < elements_.topology.tet_count(); ++t) {
    if (membership_.full[t] == before.full[t]) continue;
    elements_.region_of[t] = membership_.full[t] ? RegionModel::nonlinear : RegionModel::tensor_mass;
    (membership_.full[t] ? entered : left).push_back(t);
  }
  patches_.follow(elements_, left, entered);
  own_.clear();
  for (Index v = 0; v < u_.cols(); ++v) {
    if (membership_.motion[v] == Motion::own) own_.push_back(v);
    if (membership_.motion[v] != Motion::embedded) continue;
    embedded.push_back(v);
    if (before.motion[v] != Motion::embedded) joining.push_back(v);
  }
  list_interface();
  build_cells();
  find_masses();
  if (!joining.empty()) {
    const Mat3X<Real> old = u_;
    embed(embedded, u_, q_);
    embed(embedded, v_, vq_);
    expand();
    transitions_.largest_jump = std::max(transitions_.largest_jump, double((u_ - old).norm()));
  }
  unravel(entered);
  ++transitions_.changes;
}

template <class Real>
void TrialBody<Real>::list_interface() {
  std::vector<std::uint8_t> touched(held_.size(), 0);
  for (Index t = 0; t < elements_.topology.tet_count(); ++t)
    if (membership_.full[t])
      for (int c = 0; c < 4; ++c) touched[elements_.topology.tets()(c, t)] = 1;
  interface_.clear();
  used_.clear();
  for (Index v = 0; v < u_.cols(); ++v) {
    if (touched[v]) used_.push_back(v);
    if (!touched[v] || membership_.motion[v] != Motion::embedded) continue;
    Interface own{.vertex = v, .nodes = lattice_.nodes[lattice_.cell_of_vertex[v]], .weights = {}};
    for (int n = 0; n < 8; ++n) own.weights[n] = Real(lattice_.weights[v][n]), own.nodes[n] *= 4;
    interface_.push_back(own);
  }
}

template <class Real>
const Cell& TrialBody<Real>::whole_cell(Index cell) {
  if (whole_cells_[cell].volume == 0)
    whole_cells_[cell] = make_cell(elements_, lattice_, cell, lattice_.tets[cell], settings_.stiffening);
  return whole_cells_[cell];
}

template <class Real>
void TrialBody<Real>::build_cells() {
  constexpr int width = CellBlock<Real>::width;
  blocks_.clear();
  active_cells_ = 0;
  node_stiffness_.assign(lattice_.node_count, 0);
  for (std::size_t c = 0; c < lattice_.tets.size(); ++c) {
    const std::vector<Index>& tets = membership_.embedded[c];
    if (tets.empty()) continue;
    const Cell cell = tets.size() == lattice_.tets[c].size()
                          ? whole_cell(static_cast<Index>(c))
                          : make_cell(elements_, lattice_, static_cast<Index>(c), tets, settings_.stiffening);
    const std::size_t lane = active_cells_++ % width;
    if (lane == 0) blocks_.emplace_back();
    CellBlock<Real>& block = blocks_.back();
    for (int n = 0; n < 8; ++n) block.nodes[n][lane] = lattice_.nodes[c][n];
    block.V[lane] = Real(cell.volume);
    for (int i = 0; i < 12; ++i) block.mean[i][lane] = Real(cell.mean(i % 3, i / 3));
    for (int i = 0, entry = 0; i < 12; ++i)
      for (int j = i; j < 12; ++j) block.K[entry++][lane] = Real(cell.K(i, j));
    // A bound of what its nodes feel: |K| ≤ (λ + 2μ) V |N|² and the largest row of K of the hourglasses.
    const double rows = cell.K.cwiseAbs().rowwise().sum().maxCoeff() / 8;
    const double slopes = law_.slope * law_.slope * 3 / 8 + cell.mean.squaredNorm() / 8;
    for (int n = 0; n < 8; ++n)
      node_stiffness_[lattice_.nodes[c][n]] += (law_.lambda + 2 * law_.mu) * cell.volume * slopes + rows;
  }
}

// Row sums of the embedded masses, at least what keeps a node stable at nine tenths of the limit at rest.
template <class Real>
void TrialBody<Real>::find_masses() {
  node_mass_.assign(lattice_.node_count, 0);
  double all = 0, added = 0, highest = 1e-6;
  for (Index v = 0; v < u_.cols(); ++v)
    if (membership_.motion[v] == Motion::embedded)
      for (int n = 0; n < 8; ++n)
        node_mass_[lattice_.nodes[lattice_.cell_of_vertex[v]][n]] += mass_[v] * lattice_.weights[v][n];
  node_inverse_.assign(lattice_.node_count, Real(0));
  for (Index n = 0; n < lattice_.node_count; ++n) {
    const double dt = 0.9 * rest_limit_, least = node_stiffness_[n] * dt * dt / 4;
    all += node_mass_[n];
    if (node_stiffness_[n] == 0 && node_mass_[n] < 1e-9) continue;
    const double own = std::max(node_mass_[n], std::max(least, 1e-9));
    added += own - node_mass_[n];
    node_mass_[n] = own;
    node_inverse_[n] = Real(1 / own);
    highest = std::max(highest, node_stiffness_[n] / own);
  }
  node_limit_ = 2 / std::sqrt(highest);
  added_mass_ = all > 0 ? added / all : 0;
}

// From the affine displacements of the tetrahedra of its cells, the weighted mean at each node: exact where
// the body moves affinely, and smooth where no embedded vertex says what a node should do.
template <class Real>
Mat3X<double> TrialBody<Real>::extrapolate(const Mat3X<Real>& full) const {
  Mat3X<double> q = Mat3X<double>::Zero(3, lattice_.node_count);
  std::vector<double> sums(lattice_.node_count, 0);
  for (Index t = 0; t < elements_.topology.tet_count(); ++t) {
    const Shape shape = elements_.shape_of(t);
    const Mat34<double> X = elements_.corner_points(t);
    Mat34<double> u;
    for (int c = 0; c < 4; ++c) u.col(c) = full.col(elements_.topology.tets()(c, t)).template cast<double>();
    const Mat3<double> H = u * shape.gradients.transpose();
    const Vec3d centre = X.rowwise().mean(), mean = u.rowwise().mean();
    const Index cell = lattice_.cell_of_tet[t];
    for (int n = 0; n < 8; ++n) {
      const Vec3d node =
          lattice_.centres[cell] + lattice_.spacing / 2 * Vec3d(sign(1, n), sign(2, n), sign(3, n));
      const double weight =
          shape.volume / (1 + (node - centre).squaredNorm() * 8 / (lattice_.spacing * lattice_.spacing));
      q.col(lattice_.nodes[cell][n]) += weight * (mean + H * (node - centre));
      sums[lattice_.nodes[cell][n]] += weight;
    }
  }
  for (Index n = 0; n < lattice_.node_count; ++n) q.col(n) /= sums[n];
  return q;
}

// Least squares Σ m_i |u_i − Σ_n w_in q_n|² by conjugate gradients, preconditioned with the lumped masses, and
// one more step by these, after which Σ_n m_n q_n = Σ_i m_i u_i where no mass was added.
template <class Real>
void TrialBody<Real>::embed(const std::vector<Index>& vertices, const Mat3X<Real>& full, Nodes& nodes) {
  using Values = Mat3X<double>;
  Values q = extrapolate(full), r = Values::Zero(3, lattice_.node_count);
  const auto apply = [&](const Values& x, bool residual, Values& y) {
    y.setZero();
    for (Index v : vertices) {
      const auto& own = lattice_.nodes[lattice_.cell_of_vertex[v]];
      const auto& w = lattice_.weights[v];
      Vec3d sum = Vec3d::Zero();
      for (int n = 0; n < 8; ++n) sum += w[n] * x.col(own[n]);
      if (residual) sum = full.col(v).template cast<double>() - sum;
      for (int n = 0; n < 8; ++n) y.col(own[n]) += mass_[v] * w[n] * sum;
    }
  };
  const auto scaled = [&](const Values& x) {
    Values y(3, x.cols());
    for (Index n = 0; n < lattice_.node_count; ++n) y.col(n) = double(node_inverse_[n]) * x.col(n);
    return y;
  };
  apply(q, true, r);
  Values z = scaled(r), p = z, Ap(3, lattice_.node_count);
  double rz = r.cwiseProduct(z).sum();
  const double first = rz;
  for (int iteration = 0; iteration < 40 && rz > 1e-10 * first; ++iteration) {
    apply(p, false, Ap);
    const double alpha = rz / p.cwiseProduct(Ap).sum();
    q += alpha * p;
    r -= alpha * Ap;
    z = scaled(r);
    const double next = r.cwiseProduct(z).sum();
    p = z + next / rz * p;
    rz = next;
  }
  apply(q, true, r);
  q += scaled(r);
  for (Index n = 0; n < lattice_.node_count; ++n)
    for (int d = 0; d < 3; ++d) nodes[4 * std::size_t(n) + std::size_t(d)] = Real(q(d, n));
}

template <class Real>
void TrialBody<Real>::expand(const Nodes& nodes, Mat3X<Real>& full) const {
  for (Index v = 0; v < full.cols(); ++v) {
    if (membership_.motion[v] != Motion::embedded) continue;
    Vec3<Real> sum = Vec3<Real>::Zero();
    for (int n = 0; n < 8; ++n) {
      const Real* own = nodes.data() + 4 * std::size_t(lattice_.nodes[lattice_.cell_of_vertex[v]][n]);
      sum += Real(lattice_.weights[v][n]) * Vec3<Real>(own[0], own[1], own[2]);
    }
    full.col(v) = sum;
  }
}

template <class Real>
void TrialBody<Real>::expand() {
  expand(q_, u_);
  expand(vq_, v_);
}

// Tetrahedra that come out of the lattice crushed: their own corners move towards the mean of their
// neighbours until none has less than a tenth of its volume.
template <class Real>
void TrialBody<Real>::unravel(const std::vector<Index>& entered) {
  for (int sweep = 0; sweep < 50; ++sweep) {
    std::vector<Index> moved;
    Mat3X<double> sum = Mat3X<double>::Zero(3, u_.cols());
    std::vector<int> count(held_.size(), 0);
    for (Index t : entered) {
      const Shape shape = elements_.shape_of(t);
      Mat3<double> F = Mat3<double>::Identity();
      Vec3d mean = Vec3d::Zero();
      for (int c = 0; c < 4; ++c) {
        const Vec3d own = u_.col(elements_.topology.tets()(c, t)).template cast<double>();
        F += own * shape.gradients.col(c).transpose();
        mean += own / 4;
      }
      const bool crushed = F.determinant() < 0.1;
      for (int c = 0; c < 4; ++c) {
        const Index v = elements_.topology.tets()(c, t);
        sum.col(v) += mean;
        ++count[v];
        if (crushed && membership_.motion[v] == Motion::own) moved.push_back(v);
      }
    }
    if (moved.empty()) return;
    sort_unique(moved);
    for (Index v : moved) u_.col(v) = Real(0.5) * (u_.col(v) + (sum.col(v) / count[v]).template cast<Real>());
    if (sweep == 0) transitions_.relaxed_vertices += static_cast<int>(moved.size());
  }
}

template <class Real>
void TrialBody<Real>::step(double dt, const Mat3X<double>& targets) {
  for (const Interface& own : interface_) {
    Vec3<Real> sum = Vec3<Real>::Zero();
    for (int n = 0; n < 8; ++n) {
      const Real* q = q_.data() + own.nodes[n];
      sum += own.weights[n] * Vec3<Real>(q[0], q[1], q[2]);
    }
    u_.col(own.vertex) = sum;
  }
  for (Index v : used_) f_.col(v).setZero();
  patches_.add_forces(u_, f_, ElementPart::all, parallel_);
  if (active_cells_ > 0) {
    std::fill(fq_.begin(), fq_.end(), Real(0));
    add_cell_forces(blocks_, law_, q_.data(), fq_.data());
    for (const Interface& own : interface_)
      for (int n = 0; n < 8; ++n)
        for (int d = 0; d < 3; ++d) fq_[std::size_t(own.nodes[n] + d)] += own.weights[n] * f_(d, own.vertex);
  }
  const double half = settings_.damping * dt / 2;
  const Real keep = Real((1 - half) / (1 + half)), gain = Real(dt / (1 + half)), h = Real(dt);
  for (std::size_t g = 0; g < grasped_.size(); ++g) {
    const Vec3<Real> to = targets.col(static_cast<Index>(g)).template cast<Real>();
    v_.col(grasped_[g]) = (to - u_.col(grasped_[g])) / h;
  }
  std::size_t g = 0;  // both lists are sorted
  for (Index v : own_) {
    if (g < grasped_.size() && grasped_[g] == v)
      ++g;
    else
      v_.col(v) = keep * v_.col(v) + gain * inverse_mass_[v] * f_.col(v);
    u_.col(v) += h * v_.col(v);
  }
  if (active_cells_ == 0) return;
  for (Index n = 0; n < lattice_.node_count; ++n) {
    const Real scale = gain * node_inverse_[n];
    for (std::size_t i = 4 * std::size_t(n), end = i + 4; i < end; ++i) {
      vq_[i] = keep * vq_[i] + scale * fq_[i];
      q_[i] += h * vq_[i];
    }
  }
}

template <class Real>
Vec3d TrialBody<Real>::momentum() const {
  Vec3d sum = Vec3d::Zero();
  for (Index v : own_) sum += mass_[v] * v_.col(v).template cast<double>();
  for (Index n = 0; n < lattice_.node_count; ++n) {
    const Real* own = vq_.data() + 4 * std::size_t(n);
    if (node_inverse_[n] > 0) sum += node_mass_[n] * Vec3d(own[0], own[1], own[2]);
  }
  return sum;
}

template <class Real>
double TrialBody<Real>::full_share() const {
  double full = 0;
  for (std::uint8_t own : membership_.full) full += own;
  return full / double(membership_.full.size());
}

template class TrialBody<float>;
template class TrialBody<double>;

}  // namespace lobe::reduced
