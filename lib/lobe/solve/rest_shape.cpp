#include "lobe/solve/rest_shape.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <deque>

#include "lobe/setup/check_setup.h"
#include "lobe/setup/pressures.h"
#include "lobe/solve/floating.h"
#include "lobe/solve/static_equations.h"
#include "lobe/text.h"

namespace lobe {
namespace {

constexpr int most_per_share = 40;       // iterations with one share of the loads
constexpr int most_without_gain = 8;     // iterations in a row that come no nearer
constexpr int most_halvings = 8;         // of one step that would invert a tetrahedron
constexpr double smallest_share = 1e-2;  // of the loads, in which they are taken off
constexpr double slow = 0.5;  // an iteration that leaves more of the distance asks for a new factor,
constexpr int young = 4;      // unless the factor is younger [iterations]
constexpr double share_of_tolerance =
    0.1;                           // of the tolerance, for |δ|: the rest is left to the last solution
constexpr double part_way = 1e-3;  // of the body's size, for |δ| under a share of the loads

// Solves X = X + r(X) from pairs of X and r(X): the step r, corrected by what the last pairs tell of r.
class Anderson {
 public:
  Eigen::VectorXd next(const Eigen::VectorXd& x, const Eigen::VectorXd& residual) {
    const Eigen::Index columns = static_cast<Eigen::Index>(former_.size());
    Eigen::VectorXd result = x + residual;
    if (columns > 0) {
      Eigen::MatrixXd dx(x.size(), columns), dr(x.size(), columns);
      for (Eigen::Index i = 0; i < columns; ++i) {
        dx.col(i) = x - former_[std::size_t(i)].x;
        dr.col(i) = residual - former_[std::size_t(i)].residual;
      }
      result -= (dx + dr) * dr.colPivHouseholderQr().solve(residual);
    }
    former_.push_back({x, residual});
    if (former_.size() > most) former_.pop_front();
    return result;
  }
  void forget() { former_.clear(); }

 private:
  static constexpr std::size_t most = 6;
  struct Pair {
    Eigen::VectorXd x, residual;
  };
  std::deque<Pair> former_;
};

// The first tetrahedron that is flat or inverted; −1: there is none.
Index first_inverted(const TetMesh& mesh) {
  for (Index t = 0; t < mesh.tet_count(); ++t)
    if (!(signed_volume(tet_points(mesh, t)) > 0)) return t;
  return -1;
}

double largest(const Mat3X<double>& columns) { return columns.colwise().norm().maxCoeff(); }

// ∂X/∂x at the vertices of a given shape: the mean over the tetrahedra around each, by their volumes.
class PullBack {
 public:
  explicit PullBack(const TetMesh& given) : tets_(given.tets), volumes_(given.vertex_count(), 0.0) {
    shapes_.reserve(std::size_t(given.tet_count()));
    for (Index t = 0; t < given.tet_count(); ++t) {
      shapes_.push_back(shape(tet_points(given, t)));
      for (const Index v : tets_.col(t)) volumes_[std::size_t(v)] += shapes_.back().volume;
    }
  }

  // (∂X/∂x) δ at each vertex, for rest positions X [m].
  Mat3X<double> operator()(const Mat3X<double>& points, const Mat3X<double>& delta) const {
    Mat3X<double> result = Mat3X<double>::Zero(3, delta.cols());
    for (Eigen::Index t = 0; t < tets_.cols(); ++t) {
      const Shape& s = shapes_[std::size_t(t)];
      Mat3<double> back = Mat3<double>::Zero();
      for (int c = 0; c < 4; ++c) back += points.col(tets_(c, t)) * s.gradients.col(c).transpose();
      for (const Index v : tets_.col(t)) result.col(v) += s.volume * (back * delta.col(v));
    }
    for (Eigen::Index v = 0; v < result.cols(); ++v)
      if (const double volume = volumes_[std::size_t(v)]; volume > 0) result.col(v) /= volume;
    return result;
  }

 private:
  Tets tets_;
  std::vector<Shape> shapes_;
  std::vector<double> volumes_;
};

// A body at rest in a trial shape, with the equations of its equilibrium.
struct Trial {
  explicit Trial(const Setup& setup) : elements(setup), equations(static_equations(setup, elements)) {}
  Elements elements;
  StaticEquations equations;
};

// The factorised tangent of a trial at a state.
struct Linearised {
  Linearised(std::unique_ptr<const Trial> of, const Mat3X<double>& at)
      : trial(std::move(of)), tangent(trial->elements, trial->equations.unknowns), u(at) {
    tangent.update(u);
    if (trial->equations.stiffness.cols() > 0) tangent.add_diagonal(trial->equations.stiffness);
  }
  std::unique_ptr<const Trial> trial;
  Tangent tangent;
  Mat3X<double> u;  // [m]
};

class Search {
 public:
  Search(const Setup& loaded, const RestShapeOptions& options)
      : given_(loaded.mesh.points),
        size_((given_.rowwise().maxCoeff() - given_.rowwise().minCoeff()).norm()),
        pull_back_(loaded.mesh),
        setup_(loaded),
        options_(options) {}

  RestShape run();

 private:
  bool find(double share, Mat3X<double>& points);
  bool take_step(double share, Mat3X<double>& points);
  bool is_possible(Mat3X<double>& points);
  Mat3X<double> newton_step(double share, const Mat3X<double>& points);
  bool factorise(std::unique_ptr<const Trial> trial, const Mat3X<double>& u);
  void load(const Mat3X<double>& points);
  std::string shortfall() const;

  const Mat3X<double> given_;
  const double size_;  // diagonal of the bounding box [m]
  const PullBack pull_back_;
  Setup setup_;
  const RestShapeOptions& options_;
  std::unique_ptr<SparseFactor> factor_;
  std::unique_ptr<Linearised> linearised_;
  bool is_factor_old_ = true;
  int age_ = 0;  // iterations with the factor
  Anderson anderson_;
  Mat3X<double> former_;    // the last shape at which δ was found, or no column
  double distance_ = 0;     // |δ| there [m]
  bool is_stable_ = false;  // whether the equilibrium under all loads is
  std::string trouble_;
  RestShape found_;
};

// Returns whether the tangent is positive definite there.
bool Search::factorise(std::unique_ptr<const Trial> trial, const Mat3X<double>& u) {
  linearised_ = std::make_unique<Linearised>(std::move(trial), u);
  if (!factor_) factor_ = linearised_->tangent.make_factor(options_.statics.factor);
  bool damped = false;
  ++found_.factorisations;
  if (!linearised_->tangent.factorise(*factor_, damped)) linearised_.reset();
  is_factor_old_ = false;
  age_ = 0;
  anderson_.forget();
  return linearised_ && !damped;
}

// δ, and where displacements are given what is left of them. No column: there is none.
Mat3X<double> Search::newton_step(double share, const Mat3X<double>& points) {
  setup_.mesh.points = points;
  auto trial = std::make_unique<const Trial>(setup_);
  const StaticEquations& equations = trial->equations;
  const Mat3X<double> u = given_ - points;
  const EnergyAndForces inner = energy_and_forces(trial->elements, u);
  Mat3X<double> forces = equations.loads;
  add_pressures(setup_.pressures, trial->elements, 1, u, forces);
  forces = share * forces + inner.forces;
  if (equations.stiffness.cols() > 0)
    forces += equations.stiffness.cwiseProduct(share * equations.spring_targets - u);
  Mat3X<double> step = share * equations.prescribed - u;
  for (Eigen::Index i = 0; i < step.size(); ++i)
    if (equations.unknowns.number.data()[i] >= 0) step.data()[i] = 0;
  const Eigen::VectorXd unbalanced = equations.unknowns.gather(forces);
  if (is_factor_old_) factorise(std::move(trial), u);
  if (!linearised_) return Mat3X<double>(3, 0);
  const Unknowns& unknowns = linearised_->trial->equations.unknowns;
  const Tangent& tangent = linearised_->tangent;
  step += unknowns.scatter(step.isZero(0) ? tangent.solve(*factor_, unbalanced)
                                          : tangent.solve(*factor_, unbalanced, linearised_->u, step));
  return step.allFinite() ? step : Mat3X<double>(3, 0);
}

// Draws a shape with an inverted tetrahedron back to the last one. False if that does not help.
bool Search::is_possible(Mat3X<double>& points) {
  for (int i = 0;; ++i) {
    setup_.mesh.points = points;
    const Index inverted = first_inverted(setup_.mesh);
    if (inverted < 0) return true;
    trouble_ = "tetrahedron " + std::to_string(inverted) + " of the unloaded shape would be inverted";
    if (former_.cols() == 0 || i == most_halvings) return false;
    points = (former_ + points) / 2;
    anderson_.forget();
  }
}

// One iteration: finds δ at `points`, and takes the step. False if it cannot be taken.
bool Search::take_step(double share, Mat3X<double>& points) {
  if (!is_possible(points)) return false;
  const Mat3X<double> delta = newton_step(share, points);
  ++found_.iterations;
  ++age_;
  if (delta.cols() == 0) {
    trouble_ = "the tangent is singular there (a mechanism, or a collapsed tetrahedron)";
    return false;
  }
  distance_ = largest(delta);
  if (options_.progress) options_.progress(found_.iterations, distance_);
  Mat3X<double> step = -pull_back_(points, delta);
  const Unknowns& unknowns = linearised_->trial->equations.unknowns;
  const auto set_given = [&](Mat3X<double>& to, const Mat3X<double>& values) {
    for (Eigen::Index i = 0; i < to.size(); ++i)
      if (unknowns.number.data()[i] < 0) to.data()[i] = values.data()[i];
  };
  set_given(step, -delta);
  former_ = points;
  points = anderson_.next(points.reshaped(), step.reshaped()).reshaped(3, points.cols());
  set_given(points, given_ - share * linearised_->trial->equations.prescribed);
  return true;
}

// Goes on from `points` to the rest shape of a share of the loads. They are left as they are if it is not
// found; when no iteration is left, they are the nearest so far.
bool Search::find(double share, Mat3X<double>& points) {
  const double enough = share < 1 ? std::max(share_of_tolerance * options_.tolerance, part_way * size_)
                                  : share_of_tolerance * options_.tolerance;
  Mat3X<double> trial = points, nearest;
  double least = std::numeric_limits<double>::infinity(), last = least;
  anderson_.forget();
  former_.resize(3, 0);
  is_factor_old_ = true;
  for (int i = 0, without_gain = 0; i < most_per_share && without_gain < most_without_gain; ++i) {
    if (found_.iterations == options_.most_iterations) break;
    if (!take_step(share, trial)) return false;
    if (distance_ > size_) {
      trouble_ = "the loaded shape leaves the given one by more than its size";
      return false;
    }
    without_gain = distance_ < least ? 0 : without_gain + 1;
    if (distance_ < least) {
      least = distance_;
      nearest = former_;
    }
    if (least <= enough) break;
    if (distance_ > slow * last && age_ >= young) is_factor_old_ = true;
    last = distance_;
  }
  trouble_ = "the loaded shape stays about " + rounded(least) + " m from the given one";
  const bool is_found = least <= (share < 1 ? enough : options_.tolerance);
  if (is_found || (found_.iterations == options_.most_iterations && nearest.cols() > 0)) points = nearest;
  return is_found;
}

// Puts all loads on the body at rest in `points`.
void Search::load(const Mat3X<double>& points) {
  found_.points = points;
  found_.u = given_ - points;
  setup_.mesh.points = points;
  StaticOptions statics = options_.statics;
  statics.start = nullptr;
  const StaticResult loaded = solve_static(setup_, statics);
  found_.factorisations += loaded.iterations;
  if (!loaded.converged) {
    trouble_ = loaded.reason;
    return;
  }
  found_.u = loaded.u;
  const Eigen::RowVectorXd distances = (points + loaded.u - given_).colwise().norm();
  Eigen::Index farthest = 0;
  found_.distance = distances.maxCoeff(&farthest);
  found_.mean_distance = distances.mean();
  found_.farthest = static_cast<Index>(farthest);
  is_stable_ = loaded.damped == 0 || factorise(std::make_unique<const Trial>(setup_), loaded.u);
}

std::string Search::shortfall() const {
  const std::string after = std::to_string(found_.iterations) + " iterations";
  const bool is_far = !std::isfinite(found_.distance);
  if (found_.load_fraction < 1 && found_.iterations == options_.most_iterations)
    return is_far ? "no rest shape was found in " + after
                  : "the loaded shape is still " + rounded(found_.distance) + " m from the given one after " +
                        after;
  if (found_.load_fraction < 1)
    return "no rest shape with more than " + rounded(100 * found_.load_fraction) +
           " % of the loads taken off: " + trouble_ +
           "; smaller loads, a stiffer material or a finer mesh there may have one";
  const std::string found = "the given shape is an equilibrium of the unloaded one that was found, but ";
  if (is_far) return found + "the loads do not lead there from rest: " + trouble_;
  if (found_.distance <= options_.tolerance)
    return found + "would not stay there: the body buckles under the loads";
  return found + "from rest the loads lead to another one, " + rounded(found_.distance) +
         " m away: the body buckles or snaps through";
}

RestShape Search::run() {
  check_setup(setup_, {Option::static_solution});
  const Trial image(setup_);
  refuse_floating_pieces(image.elements, image.equations.unknowns, image.equations.stiffness);
  Mat3X<double> points = options_.start ? *options_.start : given_;
  for (double step = 1; found_.load_fraction < 1;) {
    const double share = std::min(1.0, found_.load_fraction + step);
    if (find(share, points)) {
      found_.load_fraction = share;
      step *= 2;
      continue;
    }
    step = (share - found_.load_fraction) / 2;
    if (step < smallest_share || found_.iterations == options_.most_iterations) break;
  }
  const std::string why = trouble_;
  load(points);
  found_.converged = found_.load_fraction == 1 && found_.distance <= options_.tolerance && is_stable_;
  if (found_.load_fraction < 1) trouble_ = why;
  if (!found_.converged) found_.reason = shortfall();
  return std::move(found_);
}

}  // namespace

RestShape find_rest_shape(const Setup& loaded, const RestShapeOptions& options) {
  return Search(loaded, options).run();
}

}  // namespace lobe
