#include "benchmarks/step_schemes.h"

#include <cmath>
#include <random>
#include <utility>

#include "lobe/fem/hooke.h"
#include "lobe/fem/svk.h"
#include "lobe/mesh/generators.h"
#include "lobe/numerics/symmetric_eigen.h"

namespace lobe::bench {
namespace {

enum class Strain { small, green };

Mat3<double> gradient_in(const PlainTet& tet, const Mat3X<double>& u) {
  const Mat34<double> at_corners = u(Eigen::all, tet.corners);
  return displacement_gradient<double>(at_corners, tet.shape.gradients.rightCols<3>());
}

// f += times × the forces of a tetrahedron.
void add_force(const PlainTet& tet, const Mat3X<double>& u, Strain strain, double times, Mat3X<double>& f) {
  const Mat3<double> H = gradient_in(tet, u);
  Mat3<double> P = tet.mu * (H + H.transpose());
  P.diagonal().array() += tet.lambda * H.trace();
  if (strain == Strain::green) P = svk_stress(H, tet.lambda, tet.mu);
  const Mat34<double> forces =
      corner_forces<double>(times * tet.shape.volume * P, tet.shape.gradients.rightCols<3>());
  for (int c = 0; c < 4; ++c) f.col(tet.corners[c]) += forces.col(c);
}

// The highest frequency [rad/s] of some tetrahedra with all masses, by the power method, plus 0.2 %.
template <class Takes>
double highest_frequency_of(const PlainBody& body, Takes&& takes) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Mat3X<double> mode(3, body.points.cols()), f;
  for (double& x : mode.reshaped()) x = normal(random);
  double square = 0;
  for (int i = 0; i < 600; ++i) {
    const double twice = 2 * kinetic_energy(body, mode);
    if (!(twice > 0)) return 0;  // takes none
    mode /= std::sqrt(twice);
    f = Mat3X<double>::Zero(3, mode.cols());
    for (std::size_t t = 0; t < body.tets.size(); ++t)
      if (takes(t)) add_force(body.tets[t], mode, Strain::small, 1, f);
    square = -(mode.array() * f.array()).sum();
    for (Index v = 0; v < mode.cols(); ++v) mode.col(v) = -f.col(v) / body.mass[std::size_t(v)];
  }
  return 1.002 * std::sqrt(square);
}

void find_frequencies(PlainBody& body) {
  std::vector<Mat3<double>> K(body.mass.size(), Mat3<double>::Zero());
  for (const PlainTet& tet : body.tets)
    for (int c = 0; c < 4; ++c) {
      const Vec3d a = tet.shape.gradients.col(c);
      K[std::size_t(tet.corners[c])] += tet.shape.volume * hooke_block<double>(a, a, tet.lambda, tet.mu);
    }
  double highest = 0;
  for (std::size_t v = 0; v < K.size(); ++v) {
    body.squares.push_back(largest_eigenvalue(K[v]) / body.mass[v]);
    highest = std::max(highest, body.squares.back());
  }
  body.omega = highest_frequency_of(body, [](std::size_t) { return true; });
  for (double& square : body.squares) square *= body.omega * body.omega / highest;
}

class OwnSteps : public Scheme {
 public:
  OwnSteps(std::vector<Level> levels, double small_step) : small_step_(small_step) {
    top_ = *std::max_element(levels.begin(), levels.end());
    tets_.resize(std::size_t(top_) + 1);
    for (std::size_t t = 0; t < levels.size(); ++t) tets_[levels[t]].push_back(t);
  }
  double large_step() const override { return small_step_ * (1 << top_); }

  void step(const PlainBody& body, double damping, double share, bool moves, PlainState& state,
            Mat3X<double>& kicked) override {
    for (int i = 0; i < (1 << top_); ++i) {
      const double kick = i == 0 ? share : 1;
      f_ = Mat3X<double>::Zero(3, state.u.cols());
      for (Level l = 0; l <= top_; ++l) {
        if (i % (1 << l) != 0) continue;
        evaluations += static_cast<long long>(tets_[l].size());
        for (std::size_t t : tets_[l]) add_force(body.tets[t], state.u, Strain::green, kick * (1 << l), f_);
      }
      const double half = damping * kick * small_step_ / 2;
      for (Index v = 0; v < f_.cols(); ++v)
        state.v.col(v) =
            ((1 - half) * state.v.col(v) + small_step_ / body.mass[std::size_t(v)] * f_.col(v)) / (1 + half);
      if (i == 0) kicked = state.v;
      if (!moves) return;
      state.u += small_step_ * state.v;
    }
  }

 private:
  double small_step_;
  Level top_;
  std::vector<std::vector<std::size_t>> tets_;  // per level
  Mat3X<double> f_;
};

class LeapfrogChebyshev : public Scheme {
 public:
  LeapfrogChebyshev(const PlainBody& body, const std::vector<bool>& is_fast, double large_step, double safety,
                    double stabilisation)
      : large_step_(large_step) {
    for (std::size_t t = 0; t < is_fast.size(); ++t) (is_fast[t] ? fast_ : slow_).push_back(t);
    const double omega = highest_frequency_of(body, [&](std::size_t t) { return is_fast[t]; });
    stages_ = fewest_stages(omega * large_step, safety, stabilisation);
  }
  double large_step() const override { return large_step_; }

  void step(const PlainBody& body, double damping, double share, bool moves, PlainState& state,
            Mat3X<double>& kicked) override {
    const Mat3X<double> moved = averaged(body, state.u);  // 2 (z(Δt) − u)
    const double kick = share * large_step_, half = damping * kick / 2;
    state.v = ((1 - half) * state.v + kick / (large_step_ * large_step_) * moved) / (1 + half);
    kicked = state.v;
    if (moves) state.u += large_step_ * state.v;
  }

 private:
  // y = z − u obeys the recurrence of the Chebyshev polynomials.
  Mat3X<double> averaged(const PlainBody& body, const Mat3X<double>& u) {
    Mat3X<double> slow = Mat3X<double>::Zero(3, u.cols()), f;
    for (std::size_t t : slow_) add_force(body.tets[t], u, Strain::green, 1, slow);
    evaluations += static_cast<long long>(slow_.size());
    const std::vector<double>& T = stages_.T;
    Mat3X<double> y = Mat3X<double>::Zero(3, u.cols()), before = y;
    for (std::size_t k = 0; k + 1 < T.size(); ++k) {
      const Mat3X<double> z = u + y;
      f = slow;
      for (std::size_t t : fast_) add_force(body.tets[t], z, Strain::green, 1, f);
      evaluations += static_cast<long long>(fast_.size());
      for (Index v = 0; v < f.cols(); ++v) f.col(v) *= large_step_ * large_step_ / body.mass[std::size_t(v)];
      Mat3X<double> after = k == 0 ? Mat3X<double>(f / (stages_.alpha * T[1]))
                                   : Mat3X<double>((2 * stages_.delta * T[k] * y - T[k - 1] * before +
                                                    2 * T[k] / stages_.alpha * f) /
                                                   T[k + 1]);
      before = std::move(y);
      y = std::move(after);
    }
    return 2 * y;
  }

  double large_step_;
  std::vector<std::size_t> fast_, slow_;
  StageFactors stages_;
};

// Makes the squares of the vertices of some tetrahedra as much higher as their frequency is above `most`, and
// at least the highest so high that its level falls [rad/s].
template <class Takes>
void raise_squares(const PlainBody& body, Takes&& takes, double most, double omega,
                   std::vector<double>& squares) {
  std::vector<bool> is_corner(squares.size(), false);
  for (std::size_t t = 0; t < body.tets.size(); ++t)
    if (takes(t))
      for (Index v : body.tets[t].corners) is_corner[std::size_t(v)] = true;
  double highest = 0;
  for (std::size_t v = 0; v < squares.size(); ++v)
    if (is_corner[v]) highest = std::max(highest, squares[v]);
  const double times = std::max(omega * omega / (most * most), 1.1 * most * most / highest);
  for (std::size_t v = 0; v < squares.size(); ++v)
    if (is_corner[v]) squares[v] *= times;
}

}  // namespace

PlainBody two_part_block(const Solid& soft, const Solid& stiff, unsigned seed) {
  constexpr int across = 2, along = 6;
  constexpr double edge = 0.01;  // [m]
  TetMesh mesh = box_mesh({across * edge, across * edge, along * edge}, across, across, along);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> jitter(-0.15 * edge, 0.15 * edge);
  for (double& x : mesh.points.reshaped()) x += jitter(random);
  PlainBody body;
  body.points = mesh.points;
  body.mass.assign(std::size_t(mesh.vertex_count()), 0);
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Solid& solid = t < 6 * across * across * (along - 2) ? soft : stiff;
    PlainTet& tet = body.tets.emplace_back(PlainTet{mesh.tets.col(t), shape(tet_points(mesh, t))});
    tet.lambda = solid.young * solid.poisson / ((1 + solid.poisson) * (1 - 2 * solid.poisson));
    tet.mu = solid.young / (2 * (1 + solid.poisson));
    for (Index v : tet.corners) body.mass[std::size_t(v)] += solid.density * tet.shape.volume / 4;
  }
  find_frequencies(body);
  return body;
}

std::vector<Level> safe_levels(const PlainBody& body, std::vector<double> squares) {
  const auto corners_of = [&](Index t) { return body.tets[std::size_t(t)].corners; };
  while (true) {
    const std::vector<Level> levels = levels_of_parts(static_cast<Index>(body.tets.size()), corners_of,
                                                      levels_of_vertices(squares, body.omega * body.omega));
    bool is_safe = true;
    for (Level l = 1; l <= highest_level; ++l) {
      const auto takes = [&](std::size_t t) { return levels[t] == l; };
      const double omega = highest_frequency_of(body, takes);
      if ((1 << l) * omega <= body.omega) continue;
      is_safe = false;
      raise_squares(body, takes, body.omega / (1 << l), omega, squares);
    }
    if (is_safe) return levels;
  }
}

std::unique_ptr<Scheme> own_steps(std::vector<Level> levels, double small_step) {
  return std::make_unique<OwnSteps>(std::move(levels), small_step);
}

std::unique_ptr<Scheme> leapfrog_chebyshev(const PlainBody& body, const std::vector<bool>& is_fast,
                                           double large_step, double safety, double stabilisation) {
  return std::make_unique<LeapfrogChebyshev>(body, is_fast, large_step, safety, stabilisation);
}

StageFactors stage_factors(int stages, double stabilisation) {
  StageFactors factors;
  factors.delta = 1 + stabilisation / (stages * stages);
  factors.T = {1, factors.delta};
  double U_before = 1, U = 2 * factors.delta;  // of the second kind: T_p' = p U_(p−1)
  for (int k = 2; k <= stages; ++k) {
    factors.T.push_back(2 * factors.delta * factors.T[std::size_t(k) - 1] - factors.T[std::size_t(k) - 2]);
    if (k < stages) U_before = std::exchange(U, 2 * factors.delta * U - U_before);
  }
  factors.alpha = 2 * stages * (stages == 1 ? 1 : U) / factors.T.back();
  return factors;
}

StageFactors fewest_stages(double omega_dt, double safety, double stabilisation) {
  for (int stages = 1;; ++stages) {
    StageFactors factors = stage_factors(stages, stabilisation);
    if (omega_dt * omega_dt <= safety * safety * factors.longest()) return factors;
  }
}

double kinetic_energy(const PlainBody& body, const Mat3X<double>& v) {
  double twice = 0;
  for (Index i = 0; i < v.cols(); ++i) twice += body.mass[std::size_t(i)] * v.col(i).squaredNorm();
  return twice / 2;
}

double elastic_energy(const PlainBody& body, const Mat3X<double>& u) {
  double sum = 0;
  for (const PlainTet& tet : body.tets)
    sum += tet.shape.volume * svk_energy_density<double>(gradient_in(tet, u), tet.lambda, tet.mu);
  return sum;
}

Vec3d momentum(const PlainBody& body, const Mat3X<double>& v) {
  Vec3d sum = Vec3d::Zero();
  for (Index i = 0; i < v.cols(); ++i) sum += body.mass[std::size_t(i)] * v.col(i);
  return sum;
}

Vec3d angular_momentum(const PlainBody& body, const PlainState& state, const Mat3X<double>& v) {
  Vec3d sum = Vec3d::Zero();
  for (Index i = 0; i < v.cols(); ++i)
    sum += body.mass[std::size_t(i)] * Vec3d(body.points.col(i) + state.u.col(i)).cross(Vec3d(v.col(i)));
  return sum;
}

}  // namespace lobe::bench
