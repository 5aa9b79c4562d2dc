#include "lobe/solve/rest_shape.h"

#include <Eigen/QR>
#include <deque>

#include "lobe/text.h"

namespace lobe {
namespace {

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
  static constexpr std::size_t most = 5;
  struct Pair {
    Eigen::VectorXd x, residual;
  };
  std::deque<Pair> former_;
};

bool is_valid(const TetMesh& mesh) {
  for (Index t = 0; t < mesh.tet_count(); ++t)
    if (!(signed_volume(tet_points(mesh, t)) > 0)) return false;
  return true;
}

class Search {
 public:
  Search(const Setup& loaded, const RestShapeOptions& options)
      : given_(loaded.mesh.points), setup_(loaded), options_(options) {}

  RestShape run() {
    Mat3X<double> points = given_;
    while (best_.iterations < options_.most_iterations) {
      if (!evaluate(points)) {
        if (halvings_++ == most_halvings || best_.iterations <= 1) return fail();
        points = (best_.points + points) / 2;
        anderson_.forget();
        continue;
      }
      if (best_.converged) return best_;
      points = anderson_.next(points.reshaped(), residual_.reshaped()).reshaped(3, points.cols());
    }
    best_.reason = "the loaded shape is still " + rounded(best_.distance) + " m from the given one after " +
                   std::to_string(best_.iterations) + " static solutions";
    return best_;
  }

 private:
  // Finds the equilibrium of a body at rest in `points`. False: there is none.
  bool evaluate(const Mat3X<double>& points) {
    ++best_.iterations;
    setup_.mesh.points = points;
    if (!is_valid(setup_.mesh)) {
      trouble_ = "a tetrahedron of the unloaded shape is inverted";
      return false;
    }
    StaticOptions statics = options_.statics;
    if (best_.u.size() > 0) statics.start = &best_.u;
    const StaticResult found = solve_static(setup_, statics);
    if (!found.converged) {
      trouble_ = found.reason;
      return false;
    }
    residual_ = given_ - points - found.u;
    const double distance = residual_.colwise().norm().maxCoeff();
    if (options_.progress) options_.progress(best_.iterations, distance);
    if (best_.u.size() > 0 && distance >= best_.distance) return true;
    best_.points = points;
    best_.u = found.u;
    best_.distance = distance;
    best_.converged = distance <= options_.tolerance;
    return true;
  }

  RestShape fail() {
    best_.reason = trouble_ + (best_.u.size() > 0 ? "; the best shape so far is " + rounded(best_.distance) +
                                                        " m off when it is loaded"
                                                  : "");
    if (best_.u.size() == 0) {
      best_.points = given_;
      best_.u = Mat3X<double>::Zero(3, given_.cols());
    }
    return best_;
  }

  static constexpr int most_halvings = 8;
  const Mat3X<double> given_;
  Setup setup_;
  const RestShapeOptions& options_;
  Anderson anderson_;
  Mat3X<double> residual_;
  RestShape best_;
  std::string trouble_;
  int halvings_ = 0;
};

}  // namespace

RestShape find_rest_shape(const Setup& loaded, const RestShapeOptions& options) {
  return Search(loaded, options).run();
}

}  // namespace lobe
