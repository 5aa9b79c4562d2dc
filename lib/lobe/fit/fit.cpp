#include "lobe/fit/fit.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "lobe/error.h"
#include "lobe/fit/motion.h"
#include "lobe/solve/modes.h"
#include "lobe/text.h"

namespace lobe {
namespace {

constexpr double force_step = 1e-4;      // on the scale of a parameter, of differences of forces
constexpr double frequency_step = 1e-3;  // of differences of frequencies
constexpr double motion_step = 1e-2;     // of differences of motions, far above what one more time step does
constexpr double longest_step = 1;       // of the search
constexpr double least_gain = 1e-6;      // of a step on the square of the misfit, relative
constexpr double least_seen = 1e-6;      // relative change of all measurements that a factor e must cause
constexpr double least_seen_in_motion = 1e-4;  // the same, above what one more time step does
constexpr double large_part = 0.3;             // of a direction that the measurements do not tell

// Student's t at 97.5 % (M. Abramowitz, I. A. Stegun, 26.7.5 from 11 degrees of freedom on).
double student(Eigen::Index freedom) {
  constexpr std::array<double, 10> few{12.7062, 4.3027, 3.1824, 2.7764, 2.5706,
                                       2.4469,  2.3646, 2.3060, 2.2622, 2.2281};
  if (freedom <= Eigen::Index(few.size())) return few[std::size_t(freedom - 1)];
  const double z = 1.959964, n = double(freedom), z3 = z * z * z, z5 = z3 * z * z;
  return z + (z3 + z) / (4 * n) + (5 * z5 + 16 * z3 + 3 * z) / (96 * n * n);
}

// The equilibrium of one case; empty if it is in motion.
struct Solved {
  Mat3X<double> u, reactions;
  Eigen::VectorXd omega;
};

bool is_in_motion(const FitCase& one) { return !one.observed.times().empty(); }

struct Point {
  Eigen::VectorXd x;  // on the scales of the parameters
  std::vector<Solved> solved;
  std::vector<Eigen::VectorXd> values;
  Eigen::VectorXd residual;  // (measured − computed) / weight, of all cases
};

class Search {
 public:
  Search(const std::vector<FitCase>& cases, const FitOptions& options) : cases_(cases), options_(options) {
    find_weights();
    const bool any_motion = std::any_of(cases.begin(), cases.end(), is_in_motion);
    tolerance_ = any_motion ? options.tolerance_in_motion : options.tolerance;
    least_seen_ = any_motion ? least_seen_in_motion : least_seen;
    if (measured_.size() < parameters())
      throw InputError("fit", rounded(double(parameters())) + " parameters cannot be found from " +
                                  rounded(double(measured_.size())) + " measurement(s)");
  }

  FitResult run();

 private:
  Eigen::Index parameters() const { return Eigen::Index(cases_[0].parameters.size()); }
  double misfit(const Point& at) const {
    return std::sqrt(at.residual.squaredNorm() / double(at.residual.size()));
  }
  void find_weights();
  Setup setup_of(const FitCase& one, const Eigen::VectorXd& x) const;
  std::optional<Point> evaluate(const Eigen::VectorXd& x, const Point* near, std::string& reason) const;
  std::optional<Eigen::VectorXd> values(const FitCase& one, const Setup& setup, const Mat3X<double>* start,
                                        Solved& solved, std::string& reason) const;
  Eigen::VectorXd frequencies(const FitCase& one, const Setup& setup, const Mat3X<double>& u) const;
  Eigen::MatrixXd slopes(const Point& at) const;
  Eigen::MatrixXd slopes(const FitCase& one, const Eigen::VectorXd& x, const Solved& solved) const;
  Eigen::MatrixXd slopes_in_motion(const FitCase& one, const Eigen::VectorXd& x) const;
  bool is_least(const Point& at, const Eigen::MatrixXd& slopes) const;
  bool improve(Point& at, FitResult& result);
  void judge(const Point& at, FitResult& result) const;
  void note(const Eigen::VectorXd& direction, FitResult& result) const;

  const std::vector<FitCase>& cases_;
  const FitOptions& options_;
  Eigen::VectorXd measured_, weights_;
  bool knows_sigma_ = false;
  double tolerance_ = 0, least_seen_ = 0;
  double damping_ = 1e-3;
};

void Search::find_weights() {
  std::vector<double> values, weights;
  std::array<double, 3> squares{};
  std::array<int, 3> counts{};
  std::vector<std::size_t> kinds;
  std::size_t told = 0;
  for (const FitCase& one : cases_)
    for (const Measurement& m : one.observed.measurements()) {
      values.push_back(m.value);
      weights.push_back(m.sigma);
      kinds.push_back(std::size_t(m.quantity));
      squares[kinds.back()] += m.value * m.value;
      ++counts[kinds.back()];
      told += m.sigma > 0;
    }
  knows_sigma_ = told == values.size();
  if (told > 0 && !knows_sigma_)
    throw InputError("fit", "sigma must be told for every measurement of all cases, or for none");
  for (std::size_t i = 0; i < values.size() && !knows_sigma_; ++i)
    weights[i] = squares[kinds[i]] > 0 ? std::sqrt(squares[kinds[i]] / counts[kinds[i]]) : 1;
  measured_ = Eigen::Map<Eigen::VectorXd>(values.data(), Eigen::Index(values.size()));
  weights_ = Eigen::Map<Eigen::VectorXd>(weights.data(), Eigen::Index(weights.size()));
}

Setup Search::setup_of(const FitCase& one, const Eigen::VectorXd& x) const {
  Setup setup = one.setup;
  for (std::size_t j = 0; j < one.parameters.size(); ++j) {
    const Parameter& first = cases_[0].parameters[j];
    Parameter own = one.parameters[j];
    own.at_start = first.at_start;
    set(own, first.from_scale(x[Eigen::Index(j)]), setup);
  }
  return setup;
}

Eigen::VectorXd Search::frequencies(const FitCase& one, const Setup& setup, const Mat3X<double>& u) const {
  const int count = one.observed.frequencies();
  return count > 0 ? lowest_frequencies(setup, u, count, options_.statics.factor) : Eigen::VectorXd();
}

// What the case shows; nothing if it has no equilibrium, or cannot be played.
std::optional<Eigen::VectorXd> Search::values(const FitCase& one, const Setup& setup,
                                              const Mat3X<double>* start, Solved& solved,
                                              std::string& reason) const {
  if (is_in_motion(one)) return values_in_motion(setup, one.observed, one.frame, reason);
  StaticOptions statics = options_.statics;
  statics.start = start;
  StaticResult found = solve_static(setup, statics);
  reason = found.reason;
  if (!found.converged) return {};
  solved = {std::move(found.u), std::move(found.reactions), {}};
  solved.omega = frequencies(one, setup, solved.u);
  return one.observed.values(solved.u, solved.reactions, solved.omega);
}

// Nothing if a case cannot be computed.
std::optional<Point> Search::evaluate(const Eigen::VectorXd& x, const Point* near,
                                      std::string& reason) const {
  Point at{.x = x, .residual = measured_};
  Eigen::Index row = 0;
  for (std::size_t c = 0; c < cases_.size(); ++c) {
    Solved solved;
    try {
      const Mat3X<double>* start = near && !is_in_motion(cases_[c]) ? &near->solved[c].u : nullptr;
      auto found = values(cases_[c], setup_of(cases_[c], x), start, solved, reason);
      if (!found) return {};
      at.values.push_back(*std::move(found));
    } catch (const InputError& error) {  // beyond the range of a parameter, or not stable
      if (!near) throw;
      reason = error.what();
      return {};
    }
    at.solved.push_back(std::move(solved));
    at.residual.segment(row, at.values.back().size()) -= at.values.back();
    row += at.values.back().size();
  }
  at.residual.array() /= weights_.array();
  return at;
}

Eigen::MatrixXd Search::slopes_in_motion(const FitCase& one, const Eigen::VectorXd& x) const {
  Eigen::MatrixXd J(Eigen::Index(one.observed.measurements().size()), parameters());
  const auto beside = [&](Eigen::Index j, double step) {
    Eigen::VectorXd there = x;
    there[j] += step;
    std::string trouble;
    auto found = values_in_motion(setup_of(one, there), one.observed, one.frame, trouble);
    if (!found)
      throw InputError(cases_[0].parameters[std::size_t(j)].name,
                       "a small change of it makes a motion that cannot be computed: " + trouble);
    return *std::move(found);
  };
  for (Eigen::Index j = 0; j < J.cols(); ++j)
    J.col(j) = (beside(j, motion_step) - beside(j, -motion_step)) / (2 * motion_step);
  return J;
}

Eigen::MatrixXd Search::slopes(const FitCase& one, const Eigen::VectorXd& x, const Solved& solved) const {
  if (is_in_motion(one)) return slopes_in_motion(one, x);
  Eigen::MatrixXd J(Eigen::Index(one.observed.measurements().size()), parameters());
  const StaticSensitivity sensitivity(setup_of(one, x), solved.u, options_.statics.factor);
  for (Eigen::Index j = 0; j < J.cols(); ++j) {
    const auto at = [&](double value) {
      Eigen::VectorXd there = x;
      there[j] = value;
      return setup_of(one, there);
    };
    const StaticDerivative by = sensitivity.by(at, x[j], force_step);
    Eigen::VectorXd omega_by;
    if (one.observed.any_frequency()) {
      const Mat3X<double> way = frequency_step * by.u;
      omega_by = (frequencies(one, at(x[j] + frequency_step), solved.u + way) -
                  frequencies(one, at(x[j] - frequency_step), solved.u - way)) /
                 (2 * frequency_step);
    }
    J.col(j) = one.observed.derivatives(solved.u, solved.reactions, by, omega_by);
  }
  return J;
}

Eigen::MatrixXd Search::slopes(const Point& at) const {
  Eigen::MatrixXd J(measured_.size(), parameters());
  Eigen::Index row = 0;
  for (std::size_t c = 0; c < cases_.size(); ++c) {
    const Eigen::MatrixXd own = slopes(cases_[c], at.x, at.solved[c]);
    J.middleRows(row, own.rows()) = own;
    row += own.rows();
  }
  return weights_.cwiseInverse().asDiagonal() * J;
}

// Whether a step without damping would be below the tolerance, or lower the misfit by next to nothing. A
// damped step says nothing of this: damping makes any step short.
bool Search::is_least(const Point& at, const Eigen::MatrixXd& J) const {
  const Eigen::VectorXd slope = J.transpose() * at.residual;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> seen;
  seen.setThreshold(least_seen_);  // leaves out what the measurements do not tell
  seen.compute(J);
  const Eigen::VectorXd step = seen.solve(at.residual);
  return step.cwiseAbs().maxCoeff() <= tolerance_ ||
         slope.dot(step) <= least_gain * at.residual.squaredNorm();
}

// One step that lowers the misfit. False if there is none, or if it is below the tolerance.
bool Search::improve(Point& at, FitResult& result) {
  const Eigen::MatrixXd J = slopes(at);
  const Eigen::MatrixXd square = J.transpose() * J;
  const double size = std::max(square.diagonal().maxCoeff(), std::numeric_limits<double>::min());
  bool any_lost = false;
  for (; damping_ < 1e12; damping_ *= 10) {
    Eigen::MatrixXd damped = square;
    for (Eigen::Index j = 0; j < square.cols(); ++j)
      damped(j, j) += damping_ * std::max(square(j, j), least_seen_ * size);
    Eigen::VectorXd step = damped.ldlt().solve(J.transpose() * at.residual);
    if (const double length = step.cwiseAbs().maxCoeff(); length > longest_step)
      step *= longest_step / length;
    if (step.cwiseAbs().maxCoeff() <= tolerance_) {
      result.converged = !any_lost && is_least(at, J);
      if (!result.converged) break;
      return false;
    }
    auto next = evaluate(at.x + step, &at, result.reason);
    any_lost |= !next;
    if (!next || !(next->residual.squaredNorm() < at.residual.squaredNorm())) continue;
    at = std::move(*next);
    result.reason.clear();
    damping_ = std::max(damping_ / 10, 1e-9);
    return true;
  }
  result.reason = "no step lowers the misfit";
  return false;
}

void Search::note(const Eigen::VectorXd& direction, FitResult& result) const {
  std::string names;
  int count = 0;
  for (Eigen::Index j = 0; j < direction.size(); ++j) {
    if (std::abs(direction[j]) < large_part) continue;
    result.parameters[std::size_t(j)].is_identifiable = false;
    names += (count++ > 0 ? " and " : "") + result.parameters[std::size_t(j)].name;
  }
  result.notes.push_back(count > 1 ? "the measurements tell no difference between changes of " + names +
                                         " that cancel each other: keep one of them, or measure more"
                                   : "the measurements do not depend on " + names +
                                         " beyond their noise: it keeps no meaning, whatever its value");
}

void Search::judge(const Point& at, FitResult& result) const {
  const Eigen::Index freedom = measured_.size() - parameters();
  const double spread = freedom > 0 ? std::sqrt(at.residual.squaredNorm() / double(freedom)) : 0;
  const double noise = knows_sigma_ ? std::max(1.0, spread) : spread;
  const bool is_unknown = freedom == 0 && !knows_sigma_;
  const double quantile = knows_sigma_ ? 1.959964 : freedom > 0 ? student(freedom) : 0;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(slopes(at), Eigen::ComputeThinU | Eigen::ComputeThinV);
  const double least =
      std::max(quantile * noise, least_seen_ * (measured_.array() / weights_.array()).matrix().norm());
  for (std::size_t j = 0; j < cases_[0].parameters.size(); ++j) {
    const Parameter& parameter = cases_[0].parameters[j];
    result.parameters.push_back({.name = parameter.name,
                                 .start = parameter.start,
                                 .value = parameter.from_scale(at.x[Eigen::Index(j)])});
  }
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(parameters());
  for (Eigen::Index k = 0; k < svd.singularValues().size(); ++k) {
    const Eigen::VectorXd direction = svd.matrixV().col(k);
    const double seen = svd.singularValues()[k];
    if (seen <= least) note(direction, result);
    variance += (direction * (noise / std::max(seen, least_seen_ * least))).cwiseAbs2();
  }
  for (std::size_t j = 0; j < result.parameters.size(); ++j) {
    FittedParameter& found = result.parameters[j];
    const Parameter& parameter = cases_[0].parameters[j];
    const double half = found.is_identifiable && !is_unknown ? quantile * std::sqrt(variance[Eigen::Index(j)])
                                                             : std::numeric_limits<double>::infinity();
    const double a = parameter.from_scale(at.x[Eigen::Index(j)] - half),
                 b = parameter.from_scale(at.x[Eigen::Index(j)] + half);
    found.low = std::min(a, b);
    found.high = std::max(a, b);
  }
  if (is_unknown)
    result.notes.push_back(
        "there are as many parameters as measurements, and no sigma: intervals are unknown");
}

FitResult Search::run() {
  FitResult result;
  Eigen::VectorXd x(parameters());
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    const Parameter& parameter = cases_[0].parameters[std::size_t(j)];
    x[j] = parameter.on_scale(parameter.start);
  }
  std::string reason;
  std::optional<Point> at = evaluate(x, nullptr, reason);
  if (!at) throw InputError("fit", "the scene as it is cannot be computed, to start from: " + reason);
  result.misfit_at_start = misfit(*at);
  for (; result.iterations < options_.most_iterations; ++result.iterations) {
    if (options_.progress) options_.progress(result.iterations, misfit(*at));
    if (!improve(*at, result)) break;
  }
  if (result.converged)
    result.reason.clear();
  else if (result.reason.empty())
    result.reason = "it did not converge in " + std::to_string(result.iterations) + " iterations";
  result.misfit = misfit(*at);
  judge(*at, result);
  result.values = at->values;
  return result;
}

}  // namespace

FitResult fit(const std::vector<FitCase>& cases, const FitOptions& options) {
  if (cases.empty() || cases[0].parameters.empty()) throw InputError("fit", "needs a parameter");
  const auto names = [](const FitCase& one) {
    std::vector<std::string> all;
    for (const Parameter& parameter : one.parameters) all.push_back(parameter.name);
    return all;
  };
  for (const FitCase& one : cases)
    if (names(one) != names(cases[0])) throw InputError("fit", "all cases must have the same parameters");
  return Search(cases, options).run();
}

}  // namespace lobe
