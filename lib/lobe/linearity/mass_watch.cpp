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
constexpr int most_where_cut = 5;  // degree: tissue under tension may come loose in any frame
constexpr int iterations = 12;

struct Mode {
  double omega = 0;      // [rad/s]
  Mat3X<double> forces;  // of that shape, 3 × #vertices [N]
};

// Found by inverse iterations; none if a piece floats.
Mode lowest_mode(const Elements& elements, const HeldVertices& held, const std::vector<double>& mass) {
  const Unknowns unknowns = free_components(elements, held);
  const auto is_prescribed = [&](Index v, int axis) { return unknowns.number(axis, v) < 0; };
  for (const std::vector<Index>& piece : elements.topology.pieces())
    if (!is_held(elements, piece, is_prescribed)) return {};
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
double norm(World<Real>& world) {  // √Σ m |u|²
  const auto u = world.displacements();
  double sum = 0;
  for (Index v = 0; v < static_cast<Index>(world.body().inertia.mass().size()); ++v)
    sum += world.body().inertia.mass()[std::size_t(v)] * double(u.col(v).squaredNorm());
  return std::sqrt(sum);
}

template <class Real>
void make_smooth(Dynamics<Real>& body, int degree, Mat3X<Real>& f) {
  body.prepare_inertia();
  body.inertia.apply(degree, body.parallel, f);
}

}  // namespace

template <class Real>
typename SelectiveMass<Real>::Acceleration smooth_acceleration(Dynamics<Real>& body, int degree) {
  if (body.inertia.is_selective()) return body.inertia.acceleration();
  Mat3X<Real> smooth = body.motion.forces.view();
  make_smooth(body, degree, smooth);
  return body.inertia.acceleration();
}

namespace {

// By how much C lets these forces [N] accelerate less than M⁻¹ does, as a share of the power f·M⁻¹f, at the
// highest degree.
template <class Real>
double missing_mobility(Dynamics<Real>& body, const Mat3X<Real>& f) {
  Mat3X<Real> smooth = f;
  make_smooth(body, body.inertia.degrees().back(), smooth);
  double all = 0, left = 0;
  for (const MovingVertex<Real>& moving : body.inertia.moving()) {
    all += double(moving.inverse_mass) * double(f.col(moving.vertex).squaredNorm());
    left += double(moving.inverse_mass) * double(f.col(moving.vertex).dot(smooth.col(moving.vertex)));
  }
  return all > 0 ? 1 - left / all : 0;
}

}  // namespace

template <class Real>
MassWatch<Real>::MassWatch(World<Real>& world, double tolerance, OnExceeded on_exceeded)
    : tolerance_(tolerance),
      on_exceeded_(std::move(on_exceeded)),
      decay_rate_(0.3 * world.body().damping),
      edits_(world) {
  const Mode mode = lowest_mode(world.elements(), world.held(), world.body().inertia.mass());
  if (mode.forces.size() == 0) {
    slowness_ = std::numeric_limits<double>::infinity();
    return;
  }
  const double missing = missing_mobility<Real>(world.body(), mode.forces.template cast<Real>());
  const double off = 1 - std::sqrt(std::max(0.0, 1 - missing));  // of the frequency
  const double time = std::min(longest, 2 / (std::exp(1.0) * world.body().damping));
  slowness_ = caution * off * time / mode.omega;
}

template <class Real>
double MassWatch<Real>::slowness(const World<Real>& world, int degree) const {
  if (degree == 1) return 0;
  return slowness_ * world.body().inertia.dispersion(degree) /
         world.body().inertia.dispersion(world.body().inertia.degrees().back());
}

template <class Real>
MassReport MassWatch<Real>::look(World<Real>& world, const CommandSink& send) {
  const auto start = std::chrono::steady_clock::now();
  const double frame = world.time() - std::exchange(time_, world.time());
  const bool begins = !(frame > 0);  // or goes back to what it was
  largest_ = std::max(largest_, norm(world));
  const int now = world.body().inertia.degree();
  typename SelectiveMass<Real>::Acceleration moving;
  if (now > 1 && !begins) moving = smooth_acceleration(world.body(), now);
  const auto costs = [&](int degree) {
    if (degree == 1 || begins) return 0.0;
    return slowness(world, degree) * (now > 1 ? moving : smooth_acceleration(world.body(), degree)).norm;
  };
  const double made = costs(now), left = begins ? 0 : error_ * std::exp(-decay_rate_ * frame);
  error_ = std::max(left, made);
  if (made > left && moving.vertex >= 0) place_ = world.elements().points.col(moving.vertex);
  MassReport report;
  report.time = world.time();
  report.error = largest_ > 0 ? error_ / largest_ : 0;
  report.place = place_;
  report.exceeded = report.error > tolerance_;
  const bool was_disturbed =
      begins || world.tools().next_grasp_change(world.time() - 2e-9) < world.time() + 1.5 * frame;
  const bool is_cut = edits_.read(world).any();
  if (!was_disturbed)
    for (int degree : world.body().inertia.degrees()) {
      if (is_cut && degree > most_where_cut) break;
      if (!(costs(degree) < share * tolerance_ * largest_)) break;
      report.degree = degree;
    }
  if (report.error > alarm * tolerance_)
    report.degree = std::min(report.degree, world.body().inertia.degree());
  if (report.degree != world.body().inertia.degree()) send(SetMassDegree{report.degree});
  looking_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (report.exceeded && on_exceeded_) on_exceeded_(report);
  return report;
}

template typename SelectiveMass<float>::Acceleration smooth_acceleration(Dynamics<float>&, int);
template typename SelectiveMass<double>::Acceleration smooth_acceleration(Dynamics<double>&, int);
template class MassWatch<float>;
template class MassWatch<double>;

}  // namespace lobe
