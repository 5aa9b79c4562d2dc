#include "benchmarks/step_chains.h"

#include <cmath>
#include <numeric>

#include "lobe/numerics/symmetric_eigen.h"

namespace lobe::bench {
namespace {

using Eigen::MatrixXd;

constexpr Index soft = 14, stiff = 6, springs = soft + stiff;

struct Chain {
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(springs), stiffness = Eigen::VectorXd::Zero(springs);
};

// Spring i ends at node i, and begins at node i − 1 or where the chain is held.
Chain chain_of(const ChainCase& chain) {
  Chain made;
  for (Index i = 0; i < springs; ++i) {
    const bool is_stiff = i >= soft;
    const double mass = is_stiff ? chain.mass * chain.length : 1;
    made.stiffness[i] = is_stiff ? chain.stiffness / chain.length : 1;
    made.mass[i] += mass / 2;
    if (i > 0) made.mass[i - 1] += mass / 2;
  }
  return made;
}

// M^-½ K M^-½ of the springs, each times its weight.
MatrixXd scaled_stiffness(const Chain& chain, const Eigen::VectorXd& weights) {
  MatrixXd K = MatrixXd::Zero(springs, springs);
  for (Index i = 0; i < springs; ++i) {
    Eigen::VectorXd stretch = Eigen::VectorXd::Zero(springs);
    stretch[i] = 1 / std::sqrt(chain.mass[i]);
    if (i > 0) stretch[i - 1] = -1 / std::sqrt(chain.mass[i - 1]);
    K += weights[i] * chain.stiffness[i] * stretch * stretch.transpose();
  }
  return K;
}

double highest(const MatrixXd& K) { return std::sqrt(symmetric_eigenvalues(K).maxCoeff()); }

std::vector<Level> levels_of_springs(const MatrixXd& K, double omega) {
  const double highest_node = K.diagonal().maxCoeff();
  std::vector<double> squares;
  for (Index v = 0; v < springs; ++v) squares.push_back(K(v, v) / highest_node * omega * omega);
  const auto nodes_of = [](Index i) {
    std::vector<Index> nodes{i};
    if (i > 0) nodes.push_back(i - 1);
    return nodes;
  };
  return levels_of_parts(springs, nodes_of, levels_of_vertices(squares, omega * omega));
}

// Displacements and velocities after v⁺ = keep v − push K u, u⁺ = u + dt v⁺, as a matrix.
MatrixXd step_matrix(const MatrixXd& K, double dt, double damping) {
  const double keep = (1 - damping * dt / 2) / (1 + damping * dt / 2), push = dt / (1 + damping * dt / 2);
  const MatrixXd I = MatrixXd::Identity(springs, springs);
  MatrixXd step(2 * springs, 2 * springs);
  step << I - dt * push * K, dt * keep * I, -push * K, keep * I;
  return step;
}

MatrixXd own_steps_matrix(const Chain& chain, const std::vector<Level>& levels, Level top, double dt,
                          double damping) {
  MatrixXd large = MatrixXd::Identity(2 * springs, 2 * springs);
  for (int i = 0; i < (1 << top); ++i) {
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(springs);
    for (Index s = 0; s < springs; ++s)
      if (const int steps = 1 << levels[std::size_t(s)]; i % steps == 0) weights[s] = steps;
    large = step_matrix(scaled_stiffness(chain, weights), dt, damping) * large;
  }
  return large;
}

// −2 y_p/Δt² of the recurrence, as a matrix that acts on u.
MatrixXd averaged_stiffness(const MatrixXd& slow, const MatrixXd& fast, double dt,
                            const StageFactors& stages) {
  const MatrixXd all = slow + fast;
  const std::vector<double>& T = stages.T;
  MatrixXd y = MatrixXd::Zero(springs, springs), before = y;
  for (std::size_t k = 0; k + 1 < T.size(); ++k) {
    const MatrixXd f = -dt * dt * (all + fast * y);
    const MatrixXd after =
        k == 0 ? MatrixXd(f / (stages.alpha * T[1]))
               : MatrixXd((2 * stages.delta * T[k] * y - T[k - 1] * before + 2 * T[k] / stages.alpha * f) /
                          T[k + 1]);
    before = y;
    y = after;
  }
  return -2 / (dt * dt) * y;
}

double growth_of(MatrixXd large) {
  for (int i = 0; i < 17 && large.allFinite(); ++i) large = (large * large).eval();
  return large.allFinite() ? large.cwiseAbs().maxCoeff() : INFINITY;
}

}  // namespace

ChainFigures play_chain(const ChainCase& chain_case, ChainScheme scheme, double safety, double damping,
                        double stabilisation) {
  const Chain chain = chain_of(chain_case);
  const MatrixXd K = scaled_stiffness(chain, Eigen::VectorXd::Ones(springs));
  const double omega = highest(K), dt = safety * 2 / omega;
  std::vector<Level> levels = levels_of_springs(K, omega);
  const Level top = scheme == ChainScheme::one_step ? 0 : *std::max_element(levels.begin(), levels.end());
  if (scheme == ChainScheme::one_step) levels.assign(springs, 0);
  if (scheme == ChainScheme::two_levels)
    for (Index i = 0; i < springs; ++i) levels[std::size_t(i)] = i >= soft ? 0 : top;
  const double large = dt * (1 << top), per_second = damping / large;
  if (scheme != ChainScheme::leapfrog_chebyshev)
    return {growth_of(own_steps_matrix(chain, levels, top, dt, per_second)), evaluated_share(levels, {})};
  Eigen::VectorXd is_fast(springs);
  for (Index i = 0; i < springs; ++i) is_fast[i] = levels[std::size_t(i)] < top ? 1 : 0;
  const MatrixXd fast = scaled_stiffness(chain, is_fast);
  const StageFactors stages = fewest_stages(highest(fast) * large, safety, stabilisation);
  const MatrixXd averaged = averaged_stiffness(K - fast, fast, large, stages);
  const double evaluated = double(stages.T.size() - 1) * is_fast.sum() + springs - is_fast.sum();
  return {growth_of(step_matrix(averaged, large, per_second)), evaluated / (springs * (1 << top))};
}

}  // namespace lobe::bench
