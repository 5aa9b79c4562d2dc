#include "lobe/linearity/mass_watch.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>

#include "lobe/numerics/supernodal_factor.h"
#include "lobe/solve/floating.h"
#include "lobe/solve/tangent.h"

namespace lobe {
namespace {

constexpr double share = 0.75;     // of the tolerance, that may be added
constexpr double alarm = 1.2;      // above which the degree does not grow
constexpr double caution = 3;      // higher modes are off by more than the lowest
constexpr double longest = 1;      // for which errors grow where nothing damps them [s]
constexpr int most_where_cut = 5;  // degree: what is under tension may come loose in any frame
constexpr int iterations = 12;

struct Mode {
  double omega = 0;      // [rad/s]
  Mat3X<double> forces;  // of that shape, 3 × #vertices [N]
};

// By inverse iteration; none where a piece floats.
Mode lowest_mode(const Elements& elements, const HeldVertices& held, const std::vector<double>& mass) {
  const Unknowns unknowns = free_components(elements, held);
  const auto is_given = [&](Index v, int axis) { return unknowns.number(axis, v) < 0; };
  for (const std::vector<Index>& piece : elements.topology.pieces())
    if (!is_held(elements, piece, is_given)) return {};
  Tangent K(elements, unknowns);
  const Index vertices = elements.topology.vertex_count();
  K.update(Mat3X<double>::Zero(3, vertices));
  const std::unique_ptr<SparseFactor> factor = K.make_factor(make_supernodal);
  bool damped = false;
  if (!K.factorise(*factor, damped) || damped) return {};
  Mat3X<double> x(3, vertices);
  std::minstd_rand random;
  for (double& value : x.reshaped()) value = double(random()) / double(random.max()) - 0.5;
  Mode mode;
  for (int i = 0; i < iterations; ++i) {
    mode.forces = x;
    for (Index v = 0; v < vertices; ++v) mode.forces.col(v) *= mass[std::size_t(v)];
    const Mat3X<double> y = unknowns.scatter(K.solve(*factor, unknowns.gather(mode.forces)));
    const double size = std::sqrt(mode.forces.cwiseProduct(x).sum());
    mode.omega = std::sqrt(size * size / mode.forces.cwiseProduct(y).sum());
    x = y / y.norm();
  }
  return mode;
}

template <class Real>
double norm(const World<Real>& world) {  // √Σ m |u|²
  const auto u = world.displacements();
  double sum = 0;
  for (Index v = 0; v < static_cast<Index>(world.mass().size()); ++v)
    sum += world.mass()[std::size_t(v)] * double(u.col(v).squaredNorm());
  return std::sqrt(sum);
}

}  // namespace

template <class Real>
MassWatch<Real>::MassWatch(World<Real>& world, double tolerance, OnExceeded on_exceeded)
    : tolerance_(tolerance),
      on_exceeded_(std::move(on_exceeded)),
      calming_(0.3 * world.damping()),
      edits_(world.history().size()) {
  const Mode mode = lowest_mode(world.elements(), world.held(), world.mass());
  if (mode.forces.size() == 0) {
    slowness_ = std::numeric_limits<double>::infinity();
    return;
  }
  const double missing = world.missing_mobility(mode.forces.template cast<Real>());
  const double off = 1 - std::sqrt(std::max(0.0, 1 - missing));  // of the frequency
  const double time = std::min(longest, 2 / (std::exp(1.0) * world.damping()));
  slowness_ = caution * off * time / mode.omega;
}

template <class Real>
double MassWatch<Real>::slowness(const World<Real>& world, int degree) const {
  if (degree == 1) return 0;
  return slowness_ * world.mass_lag(degree) / world.mass_lag(world.mass_degrees().back());
}

template <class Real>
MassReport MassWatch<Real>::look(World<Real>& world, const Steering& steering) {
  const auto start = std::chrono::steady_clock::now();
  const double frame = world.time() - std::exchange(time_, world.time());
  const bool begins = !(frame > 0);  // or goes back to what it was
  largest_ = std::max(largest_, norm(world));
  const int now = world.mass_degree();
  typename SelectiveMass<Real>::Acceleration moving;
  if (now > 1 && !begins) moving = world.smooth_acceleration(now);
  const auto costs = [&](int degree) {
    if (degree == 1 || begins) return 0.0;
    return slowness(world, degree) * (now > 1 ? moving : world.smooth_acceleration(degree)).norm;
  };
  const double made = costs(now), left = begins ? 0 : error_ * std::exp(-calming_ * frame);
  error_ = std::max(left, made);
  if (made > left && moving.vertex >= 0) place_ = world.elements().points.col(moving.vertex);
  MassReport report;
  report.time = world.time();
  report.error = largest_ > 0 ? error_ / largest_ : 0;
  report.place = place_;
  report.exceeded = report.error > tolerance_;
  const bool is_startled = begins || world.next_grasp_change() < world.time() + 1.5 * frame;
  const bool is_cut = std::exchange(edits_, world.history().size()) != world.history().size();
  if (!is_startled)
    for (int degree : world.mass_degrees()) {
      if (is_cut && degree > most_where_cut) break;
      if (!(costs(degree) < share * tolerance_ * largest_)) break;
      report.degree = degree;
    }
  if (report.error > alarm * tolerance_) report.degree = std::min(report.degree, world.mass_degree());
  if (report.degree != world.mass_degree()) steering.set_mass_degree(report.degree);
  looking_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (report.exceeded && on_exceeded_) on_exceeded_(report);
  return report;
}

template class MassWatch<float>;
template class MassWatch<double>;

}  // namespace lobe
