#include "benchmarks/stress/play.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <type_traits>

#include "benchmarks/timing.h"
#include "lobe/error.h"
#include "lobe/fem/volume_term.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/rebuild.h"
#include "lobe/sim/world.h"

namespace lobe::stress {
namespace {

template <class Real>
class Player {
 public:
  explicit Player(const Plan& plan) : plan_(plan), world_(plan.setup) {
    verdict_.in_double = std::is_same_v<Real, double>;
    State<Real> state = world_.state();
    if (plan.u.size() > 0) state.u = plan.u.cast<Real>();
    if (plan.v.size() > 0) state.v = plan.v.cast<Real>();
    for (const HeldVertices::Held& item : world_.held().all()) state.v.col(item.vertex).setZero();
    world_.set_state(state);
    momentum_ = momentum();
    verdict_.energy_start = energy();
    if (plan.must == Must::flag) frame_ = 20 * plan.setup.safety * world_.time_step_limit();
    to_cut_.resize(std::size_t(plan.setup.mesh.tet_count()));
    std::iota(to_cut_.begin(), to_cut_.end(), 0);
    std::shuffle(to_cut_.begin(), to_cut_.end(), std::mt19937(3));
  }

  Verdict play() {
    const bench::Stopwatch watch(true);
    if (plan_.steps > 0)
      bare_steps();
    else
      while (ok_ && world_.time() < plan_.seconds * (1 - 1e-9)) frame();
    verdict_.seconds = watch.seconds();
    verdict_.farthest = farthest();
    if (verdict_.in_double && finite_ && world_.grains()) compare();
    verdict_.why = judge();
    verdict_.passed = verdict_.why.empty();
    if (verdict_.passed) verdict_.why = reported_;
    return verdict_;
  }

 private:
  void bare_steps();
  void frame();
  void cut();
  void compare();
  void measure();
  std::string judge();
  std::string judge_blades() const;

  double energy() { return world_.energies().total(); }
  double farthest() {
    return world_.state().u.size() == 0 ? 0 : double(world_.state().u.colwise().norm().maxCoeff()) / size();
  }
  double size() const {
    const Mat3X<double>& X = plan_.setup.mesh.points;
    return (X.rowwise().maxCoeff() - X.rowwise().minCoeff()).maxCoeff();
  }
  template <class Visit>  // visit(mass, velocity) of vertices and of the nodes of a lattice
  void visit_masses(Visit&& visit) {
    const Mat3X<double> v = world_.state().v.template cast<double>();
    const std::vector<double>& mass = world_.body().inertia.mass();
    for (std::size_t i = 0; i < mass.size(); ++i) visit(mass[i], Vec3d(v.col(Index(i))));
    const std::vector<double>& of_nodes = world_.body().regions.reduced().embedding().mass;
    for (std::size_t n = 0; n < of_nodes.size(); ++n)
      visit(of_nodes[n], Vec3d(world_.body().motion.nodes.v.col(Index(n)).template cast<double>()));
  }
  Vec3d momentum() {
    Vec3d sum = Vec3d::Zero();
    visit_masses([&](double mass, const Vec3d& v) { sum += mass * v; });
    return sum;
  }
  bool is_free() const { return world_.held().all().empty() && plan_.setup.gravity.isZero(0); }

  const Plan& plan_;
  World<Real> world_;
  double frame_ = plan_.frame;  // [s]
  Verdict verdict_;
  Vec3d momentum_;
  std::vector<Index> to_cut_;
  std::size_t cut_ = 0;
  bool ok_ = true, finite_ = true, everything_cut_ = false;
  double largest_move_ = 0;  // of a vertex, relative to the size
  std::string reported_;
};

template <class Real>
void Player<Real>::bare_steps() {
  const double limit = world_.time_step_limit(), dt = plan_.step_factor * limit;
  verdict_.smallest_step = verdict_.largest_step = dt;
  const long between = std::max(1L, plan_.steps / 200);
  for (; verdict_.steps < plan_.steps && finite_; ++verdict_.steps) {
    world_.step(dt);
    if (verdict_.steps % between == 0) measure();
  }
  measure();
}

// At random, and compared with what would be built from the cut mesh.
template <class Real>
void Player<Real>::cut() {
  const auto count = std::size_t(std::ceil(plan_.cut_share * double(to_cut_.size())));
  const std::size_t end = std::min(to_cut_.size(), cut_ + count);
  if (end == cut_) return;
  world_.remove_tets({to_cut_.begin() + std::ptrdiff_t(cut_), to_cut_.begin() + std::ptrdiff_t(end)});
  cut_ = end;
  if (verdict_.in_double) compare();
}

// With a world that is built afresh. A reduced region is compared as a non-linear one, in a copy: a lattice
// depends on what was embedded before.
template <class Real>
void Player<Real>::compare() {
  const auto note = [&](World<Real>& world) {
    verdict_.cut_error = std::max(verdict_.cut_error, compare_with_rebuilt(world).largest());
  };
  const LatticeRegion<Real>& reduced = world_.body().regions.reduced();
  if (!reduced.any()) return note(world_);
  World<Real> copy(plan_.setup);
  copy.restore(world_.save());
  SetRegion all{{}, RegionModel::nonlinear};
  for (Index t = 0; t < world_.elements().topology.tet_count(); ++t)
    if (reduced.has(t)) all.tets.push_back(t);
  copy.apply(all);
  note(copy);
}

template <class Real>
void Player<Real>::frame() {
  cut();
  const Report report = world_.advance(frame_);
  ok_ = report.ok;
  verdict_.steps += report.steps;
  verdict_.reruns += report.reruns;
  if (world_.is_unravelling()) verdict_.unravelling += frame_;
  verdict_.largest_step = std::max(verdict_.largest_step, report.time_step);
  if (report.time_step > 0 && (verdict_.smallest_step == 0 || report.time_step < verdict_.smallest_step)) {
    verdict_.smallest_step = report.time_step;
    verdict_.limited_by =
        report.limiting_vertex < 0 ? "" : "vertex " + std::to_string(report.limiting_vertex);
  }
  for (const Condition& c : report.conditions) {
    everything_cut_ = everything_cut_ || c.kind == Condition::Kind::everything_cut;
    if (!report.ok) reported_ = c.text;
  }
  measure();
}

template <class Real>
void Player<Real>::measure() {
  finite_ = world_.state().u.allFinite() && world_.state().v.allFinite();
  if (!finite_) return;
  largest_move_ = std::max(largest_move_, farthest());
  const Elements& elements = world_.elements();
  verdict_.last_ratio = std::numeric_limits<double>::infinity();
  const Mat3X<double> u = world_.state().u.template cast<double>();
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    const auto may_be_large = [](RegionModel model) {
      return model == RegionModel::nonlinear || model == RegionModel::reduced;
    };
    const bool is_nonlinear =
        may_be_large(elements.region_of[t]) ||
        may_be_large(plan_.setup.region_of[elements.topology.parent(t)]);  // but for a tangle
    if (!elements.topology.alive(t) || !is_nonlinear) continue;
    const Mat34<double> corners = u(Eigen::all, elements.topology.corners(t));
    const double ratio = 1 + volume_change<double>(displacement_gradient<double>(
                                 corners, elements.shape_of(t).gradients.template rightCols<3>()));
    verdict_.last_ratio = std::min(verdict_.last_ratio, ratio);
    verdict_.largest_ratio = std::max(verdict_.largest_ratio, ratio);
  }
  verdict_.smallest_ratio = std::min(verdict_.smallest_ratio, verdict_.last_ratio);
  const bool early = plan_.steps > 0 ? verdict_.steps < plan_.steps / 2 : world_.time() < plan_.seconds / 2;
  double& largest = early ? verdict_.energy_early : verdict_.energy_late;
  largest = std::max(largest, energy());
  if (!is_free()) return;
  double scale = 0;
  visit_masses([&](double mass, const Vec3d& v) { scale += mass * v.norm(); });
  if (scale > 0)
    verdict_.momentum_drift = std::max(verdict_.momentum_drift, (momentum() - momentum_).norm() / scale);
}

// What blades must have left; empty: they have.
template <class Real>
std::string Player<Real>::judge_blades() const {
  const Topology& topology = world_.elements().topology;
  if (topology.tet_copy_count() == 0) return "the blades cut nothing";
  double volume = 0;
  for (Index t = 0; t < topology.tet_count(); ++t) volume += world_.elements().volume(t);
  const double whole = total_volume(plan_.setup.mesh);
  return topology.alive_count() == topology.tet_count() && std::abs(volume - whole) < 1e-9 * whole
             ? ""
             : "the blades lost tissue";
}

template <class Real>
std::string Player<Real>::judge() {
  if (plan_.must == Must::be_flagged)
    return finite_ && verdict_.energy_late < 1e3 * verdict_.energy_start ? "did not grow" : "";
  if (!finite_) return "not finite";
  if (!(verdict_.cut_error < 1e-9)) return "the cut world differs from one built afresh";
  if (!ok_) return plan_.must == Must::report && !reported_.empty() ? "" : "stopped: " + reported_;
  const double drift_per_step = verdict_.in_double ? 1e-13 : 1e-6;
  if (verdict_.momentum_drift > drift_per_step * double(verdict_.steps)) return "momentum drifts";
  if (!plan_.setup.scalpels.empty())
    if (const std::string why = judge_blades(); !why.empty()) return why;
  switch (plan_.must) {
    case Must::recover:
      if (!(verdict_.last_ratio > 0.5)) return "a tetrahedron stays inverted or crushed";
      return verdict_.farthest < 0.01 ? "" : "does not come back to rest";
    case Must::flag:
      if (verdict_.reruns == 0) return "was not noticed";
      return largest_move_ < 0.01 ? "" : "was noticed late";
    case Must::keep_energy:
      return verdict_.energy_late <= 1.5 * verdict_.energy_early &&
                     verdict_.energy_early <= 20 * verdict_.energy_start
                 ? ""
                 : "gains energy";
    case Must::stay:
      return world_.state().u.isZero(0) && world_.state().v.isZero(0) ? "" : "moves";
    case Must::vanish:
      return world_.elements().topology.alive_count() == 0 && everything_cut_ ? "" : "something is left";
    default:
      return "";
  }
}

}  // namespace

const char* name(Must must) {
  static constexpr const char* names[] = {
      "recover", "survive", "survive or report", "keep energy", "stay", "be noticed", "grow", "vanish"};
  return names[static_cast<int>(must)];
}

template <class Real>
Verdict play(const Plan& plan) {
  try {
    return Player<Real>(plan).play();
  } catch (const InputError& error) {  // of a model that does not go with the body or with a tool
    Verdict refused;
    refused.in_double = std::is_same_v<Real, double>;
    refused.passed = plan.must == Must::report;
    refused.why = std::string("refused: ") + error.what();
    return refused;
  }
}

template Verdict play<float>(const Plan&);
template Verdict play<double>(const Plan&);

}  // namespace lobe::stress
