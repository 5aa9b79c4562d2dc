#include "lobe/solve/static_solver.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <iostream>  // Eigen's MetisSupport needs it
#include <limits>

#include <Eigen/MetisSupport>

#include "lobe/error.h"
#include "lobe/sim/boundary_conditions.h"
#include "lobe/sim/check_setup.h"
#include "lobe/solve/tangent.h"

namespace lobe {
namespace {

using Vector = Eigen::VectorXd;

// The equations of one setup: which displacements are unknown, what loads them.
class Equations {
 public:
  explicit Equations(const Setup& setup) : elements((check_setup(setup), setup)) {
    const Index n = elements.topology.vertex_count();
    unknown.assign(std::size_t(n), 0);
    prescribed.setZero(3, n);
    for (auto p = setup.prescribed.rbegin(); p != setup.prescribed.rend();
         ++p) {  // the first entry of a vertex wins
      unknown[p->vertex] = -1;
      prescribed.col(p->vertex) = p->displacement;
    }
    for (Index v = 0; v < n; ++v) {
      if (elements.topology.around(v).empty()) unknown[v] = -1;
      if (unknown[v] < 0) continue;
      unknown[v] = unknowns;
      unknowns += 3;
    }
    refuse_what_floats(setup);
    loads = dead_loads(elements, setup.face_loads, setup.vertex_loads);
    for (Index v = 0; v < n; ++v) loads.col(v) += lumped_mass(elements, v) * setup.gravity;
  }

  Vector gather(const Mat3X<double>& full) const {
    Vector x(unknowns);
    for (std::size_t v = 0; v < unknown.size(); ++v)
      if (unknown[v] >= 0) x.segment<3>(unknown[v]) = full.col(Eigen::Index(v));
    return x;
  }
  Mat3X<double> scatter(const Vector& x) const {
    Mat3X<double> full = Mat3X<double>::Zero(3, Eigen::Index(unknown.size()));
    for (std::size_t v = 0; v < unknown.size(); ++v)
      if (unknown[v] >= 0) full.col(Eigen::Index(v)) = x.segment<3>(unknown[v]);
    return full;
  }

  Elements elements;
  std::vector<Index> unknown;  // per vertex: the first of its three unknowns, −1 where prescribed
  Index unknowns = 0;
  Mat3X<double> prescribed, loads;  // at full load [m], [N]

 private:
  void refuse_what_floats(const Setup& setup) const;
};

// A piece is held if three of its prescribed vertices span a plane.
void Equations::refuse_what_floats(const Setup& setup) const {
  std::vector<std::uint8_t> is_prescribed(unknown.size(), 0);
  for (const PrescribedVertex& p : setup.prescribed) is_prescribed[p.vertex] = 1;
  for (const std::vector<Index>& piece : elements.topology.pieces()) {
    std::vector<Vec3d> held;
    for (Index t : piece)
      for (int c = 0; c < 4; ++c)
        if (const Index v = elements.topology.tets()(c, t); is_prescribed[v])
          held.push_back(elements.points.col(v));
    Vec3d axis = Vec3d::Zero();
    double spread = 0;
    for (const Vec3d& p : held)
      if ((p - held[0]).norm() > axis.norm()) axis = p - held[0];
    for (const Vec3d& p : held) spread = std::max(spread, axis.cross(p - held[0]).norm());
    if (spread > 1e-9 * axis.squaredNorm() && axis.norm() > 0) continue;
    throw InputError("static solution",
                     "a piece of " + std::to_string(piece.size()) + " tetrahedra, among them " +
                         std::to_string(piece[0]) +
                         ", is not held and could move freely; fix at least three of its vertices "
                         "that do not lie on a line");
  }
}

class Newton {
 public:
  Newton(const Equations& equations, const StaticOptions& options, StaticResult& result)
      : eq_(equations), options_(options), result_(result) {}

  // Equilibrium at a load fraction, from the equilibrium u at another; u is changed only on success.
  bool equilibrate(double fraction, Mat3X<double>& u);

 private:
  using Factor = Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::MetisOrdering<int>>;

  void factorise(const Mat3X<double>& u);
  double potential(const EnergyAndForces& e, const Mat3X<double>& u, double fraction) const {
    return e.energy - fraction * eq_.loads.cwiseProduct(u).sum();
  }
  bool line_search(double fraction, const Vector& residual, const Vector& step, Mat3X<double>& u,
                   EnergyAndForces& e);
  Vector moved_boundary(const Mat3X<double>& u, const Mat3X<double>& move) const;

  const Equations& eq_;
  const StaticOptions& options_;
  StaticResult& result_;
  Factor factor_;
  bool analysed_ = false;
};

// The tangent, damped by growing multiples of its diagonal until it is positive definite.
void Newton::factorise(const Mat3X<double>& u) {
  Eigen::SparseMatrix<double> K = tangent(eq_.elements, u, eq_.unknown, eq_.unknowns);
  if (!analysed_) factor_.analyzePattern(K);
  analysed_ = true;
  factor_.factorize(K);
  const Vector diagonal = K.diagonal().cwiseAbs();
  double shift = 1e-3;
  if (factor_.info() != Eigen::Success) ++result_.damped;
  for (; factor_.info() != Eigen::Success && shift < 1e6; shift *= 4) {
    Eigen::SparseMatrix<double> damped = K;
    damped.diagonal() += shift * diagonal;
    factor_.factorize(damped);
  }
  result_.factor_nonzeros = factor_.matrixL().nestedExpression().nonZeros();
}

// K times a displacement of prescribed vertices, on the unknowns.
Vector Newton::moved_boundary(const Mat3X<double>& u, const Mat3X<double>& move) const {
  Mat3X<double> f = Mat3X<double>::Zero(3, u.cols());
  for (Index t = 0; t < eq_.elements.topology.tet_count(); ++t) {
    if (!eq_.elements.topology.alive(t)) continue;
    const Eigen::Vector4i v = eq_.elements.topology.corners(t);
    Mat34<double> at, by;
    for (int c = 0; c < 4; ++c) {
      at.col(c) = u.col(v[c]);
      by.col(c) = move.col(v[c]);
    }
    if (by.isZero(0)) continue;
    const Eigen::Matrix<double, 12, 1> force = tet_stiffness(eq_.elements, t, at) * by.reshaped();
    for (int c = 0; c < 4; ++c) f.col(v[c]) += force.segment<3>(3 * c);
  }
  return eq_.gather(f);
}

// Halves the step until no tetrahedron is inverted and the potential falls (or the residual does, where rounding hides
// the potential).
bool Newton::line_search(double fraction, const Vector& residual, const Vector& step, Mat3X<double>& u,
                         EnergyAndForces& e) {
  const double before = potential(e, u, fraction), slope = -residual.dot(step);
  const Mat3X<double> direction = eq_.scatter(step);
  for (double length = 1; length > 1e-10; length /= 2) {
    const Mat3X<double> trial = u + length * direction;
    const EnergyAndForces at = energy_and_forces(eq_.elements, trial);
    result_.worst_tet = at.smallest_tet;
    if (!(at.smallest_volume_ratio > 0)) continue;
    const bool falls = potential(at, trial, fraction) <= before + 1e-4 * length * slope;
    const Vector r = eq_.gather(fraction * eq_.loads + at.forces);
    if (!falls && !(r.norm() < 0.9 * residual.norm())) continue;
    u = trial;
    e = at;
    return true;
  }
  return false;
}

bool Newton::equilibrate(double fraction, Mat3X<double>& u) {
  Mat3X<double> x = u;
  EnergyAndForces e = energy_and_forces(eq_.elements, x);
  Mat3X<double> move = Mat3X<double>::Zero(3, x.cols());
  for (std::size_t v = 0; v < eq_.unknown.size(); ++v)
    if (eq_.unknown[v] < 0)
      move.col(Eigen::Index(v)) = fraction * eq_.prescribed.col(Eigen::Index(v)) - x.col(Eigen::Index(v));
  if (!move.isZero(0)) {  // the body follows its boundary linearly first
    factorise(x);
    x += move +
         eq_.scatter(factor_.solve(eq_.gather(fraction * eq_.loads + e.forces) - moved_boundary(x, move)));
    e = energy_and_forces(eq_.elements, x);
    result_.worst_tet = e.smallest_tet;
    if (!(e.smallest_volume_ratio > 0)) return false;
  }
  for (int i = 0; i < options_.most_iterations; ++i) {
    const Mat3X<double> all = fraction * eq_.loads + e.forces;
    const Vector residual = eq_.gather(all);
    const double scale =
        std::max(fraction * eq_.loads.norm(), all.norm());  // loads, or the reactions where held
    const double relative = scale > 0 ? residual.norm() / scale : 0;
    if (relative <= options_.tolerance) {
      u = x;
      result_.residual = relative;
      result_.energy = e.energy;
      result_.smallest_volume_ratio = e.smallest_volume_ratio;
      result_.worst_tet = e.smallest_tet;
      return true;
    }
    ++result_.iterations;
    factorise(x);
    if (factor_.info() != Eigen::Success) return false;
    if (!line_search(fraction, residual, factor_.solve(residual), x, e)) return false;
  }
  return false;
}

}  // namespace

StaticResult solve_static(const Setup& setup, const StaticOptions& options) {
  const Equations equations(setup);
  StaticResult result;
  result.unknowns = equations.unknowns;
  result.u.setZero(3, equations.elements.topology.vertex_count());
  Newton newton(equations, options, result);
  double step = 1;
  while (result.load_fraction < 1) {
    const double fraction = std::min(1.0, result.load_fraction + step);
    if (newton.equilibrate(fraction, result.u)) {
      result.load_fraction = fraction;
      ++result.load_steps;
      step *= 2;
      if (options.progress) options.progress(fraction);
      continue;
    }
    step = std::min(step, 1 - result.load_fraction) / 2;
    if (step >= options.smallest_load_step) continue;
    result.reason = "no equilibrium beyond " + std::to_string(100 * result.load_fraction) +
                    " % of the load; tetrahedron " + std::to_string(result.worst_tet) +
                    " is the most compressed: a volume_penalty, smaller loads or a "
                    "finer mesh there may help";
    return result;
  }
  result.converged = true;
  return result;
}

}  // namespace lobe
