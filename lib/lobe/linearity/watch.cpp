#include "lobe/linearity/watch.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <utility>

#include "lobe/sort_unique.h"

namespace lobe {
namespace {

constexpr double leave_down_to = 0.7;       // of the tolerance: where zones stop to leave
constexpr double join_below = 0.4;          // where they may join
constexpr int patience = 8;                 // frames for which one must have been possible
constexpr double leave_above = 0.8;         // of the tolerance: where a pre-computed region is expanded
constexpr double relinearise_above = 0.25;  // where it is relinearised
constexpr double condense_below = 0.5;      // where it is condensed again
constexpr int patience_to_condense = 2;
constexpr double delay_per_tet = 8e-6;      // of its renewal [s]: what condensing takes on a slow machine
constexpr double influence_per_tet = 1e-4;  // until it is used [s]: what finding it takes on a slow machine

bool is_linear(const Elements& elements, Index tet) { return is_linear(elements.region_of[tet]); }

double volume_left(const Elements& elements, Index t) {
  return elements.topology.alive(t) ? elements.volume(t) : 0;
}

std::vector<double> tet_volumes(const Elements& elements) {
  std::vector<double> volume;
  for (Index t = 0; t < elements.topology.tet_count(); ++t) volume.push_back(volume_left(elements, t));
  return volume;
}

std::vector<double> vertex_volumes(const Topology& topology, const std::vector<double>& of_tets) {
  std::vector<double> volume(std::size_t(topology.vertex_count()), 0);
  for (Index t = 0; t < topology.tet_count(); ++t) {
    if (!topology.alive(t)) continue;
    const Eigen::Vector4i corners = topology.corners(t);
    for (int c = 0; c < 4; ++c) volume[std::size_t(corners[c])] += of_tets[std::size_t(t)] / 4;
  }
  return volume;
}

}  // namespace

template <class Real>
LinearityWatch<Real>::LinearityWatch(const World<Real>& world, const std::vector<std::vector<Index>>& grasps,
                                     LinearityOptions options)
    : options_(std::move(options)),
      grasps_(grasps),
      zones_(world.elements(),
             options_.zones > 0 ? options_.zones : usual_zone_count(world.elements().topology.tet_count())),
      defects_(world.elements(), zones_),
      frames_near_linear_(std::size_t(zones_.count()), 0),
      tet_volume_(tet_volumes(world.elements())),
      volume_(vertex_volumes(world.elements().topology, tet_volume_)),
      edits_(world) {
  influence_ = std::make_unique<Influence>(world.elements(), zones_, boundary_of(world), grasps_);
  find_shares(world.elements());
  double mass = 0;
  for (Index t = 0; t < world.elements().topology.tet_count(); ++t)
    mass += tet_volume_[std::size_t(t)] * world.elements().elastic_of(t).density;
  density_ = mass / std::accumulate(tet_volume_.begin(), tet_volume_.end(), 0.0);
}

template <class Real>
void LinearityWatch<Real>::find_shares(const Elements& elements) {
  share_.assign(std::size_t(zones_.count()), 0);
  any_precomputed_ = false;
  for (Index z = 0; z < zones_.count(); ++z)
    for (Index t : zones_.tets[std::size_t(z)])
      if (elements.topology.alive(t) && is_linear(elements, t)) {
        share_[std::size_t(z)] += tet_volume_[std::size_t(t)] / zones_.volume[std::size_t(z)];
        any_precomputed_ = any_precomputed_ || elements.region_of[t] == RegionModel::precomputed;
      }
}

// What the boundary conditions hold, without grasps.
template <class Real>
HeldVertices LinearityWatch<Real>::boundary_of(const World<Real>& world) const {
  HeldVertices boundary = world.held();
  for (std::size_t g = 0; g < grasps_.size(); ++g) boundary.release(HeldVertices::boundary + 1 + int(g));
  return boundary;
}

// Returns whether there was a cut. Cuts change the influence of zones on each other. It is computed again
// from a copy in another thread, because that takes as long as many frames.
template <class Real>
bool LinearityWatch<Real>::follow_edits(const World<Real>& world) {
  if (next_influence_.valid() && world.time() >= influence_due_) influence_ = next_influence_.get();
  const bool was_cut = follow_cuts(world);
  influence_is_stale_ = influence_is_stale_ || was_cut;
  if (!influence_is_stale_ || next_influence_.valid()) return was_cut;
  influence_is_stale_ = false;
  influence_due_ = world.time() + influence_per_tet * world.elements().topology.alive_count();
  next_influence_ = std::async(std::launch::async, [elements = world.elements(), zones = zones_,
                                                    boundary = boundary_of(world), grasps = grasps_] {
    return std::make_unique<Influence>(elements, zones, boundary, grasps);
  });
  return was_cut;
}

// Updates the means of zones that have lost tetrahedra since the last estimate, or whose tetrahedra were
// divided or have other vertices. If the world was restored, it updates all zones.
template <class Real>
bool LinearityWatch<Real>::follow_cuts(const World<Real>& world) {
  const Elements& elements = world.elements();
  const Topology& topology = elements.topology;
  const History& history = world.journal().edits;
  const EditReader::News news = edits_.read(world);
  const bool restored = news.was_restored;
  if (!news.any()) return false;
  std::vector<char> was_cut(std::size_t(zones_.count()), restored);
  const auto mark = [&](Index t) { was_cut[std::size_t(zones_.of[std::size_t(t)])] = 1; };
  const auto known = static_cast<Index>(tet_volume_.size());
  if (restored || known != topology.tet_count()) zones_.follow_copies(topology);
  for (Index t = known; t < topology.tet_count(); ++t) mark(t);
  for (auto v = static_cast<Index>(volume_.size()); v < topology.vertex_count(); ++v)
    for (Index t : topology.around(v)) mark(t);
  for (std::size_t i = news.first; i < history.size(); ++i)
    if (const auto* removal = std::get_if<RemoveTets>(&history[i]))
      for (Index t : removal->tets) mark(t);
  tet_volume_.resize(std::size_t(topology.tet_count()));
  for (Index z = 0; z < zones_.count(); ++z)
    if (was_cut[std::size_t(z)])
      for (Index t : zones_.tets[std::size_t(z)]) tet_volume_[std::size_t(t)] = volume_left(elements, t);
  find_shares(elements);
  if (std::count(was_cut.begin(), was_cut.end(), 1) == 0) return false;
  for (Index z = 0; z < zones_.count(); ++z)
    if (was_cut[std::size_t(z)]) defects_.find(elements, zones_, z);
  volume_ = vertex_volumes(topology, tet_volume_);
  return true;
}

// Notes which grasps hold. Returns whether they are others than before.
template <class Real>
bool LinearityWatch<Real>::hold(const HeldVertices& held) {
  std::vector<Index> holding;
  for (const HeldVertices::Held& item : held.all())
    if (item.holder != HeldVertices::boundary && item.holder <= static_cast<int>(grasps_.size()))
      holding.push_back(item.holder - 1);
  sort_unique(holding);
  influence_->hold(holding);
  return std::exchange(holding_, holding) != holding;
}

template <class Real>
double LinearityWatch<Real>::relative(const Eigen::VectorXd& error) const {
  return largest_ > 0 ? zones_.norm(error) / largest_ : 0;
}

template <class Real>
bool LinearityWatch<Real>::may_expand(const World<Real>& world) const {
  return options_.correct && world.body().regions.can_be_expanded();
}

template <class Real>
bool LinearityWatch<Real>::may_skip(const World<Real>& world, bool was_disturbed) const {
  if (world.is_unravelling()) return true;  // a tangle is linear on purpose
  if (any_precomputed_ ? world.body().regions.is_expanded() : was_disturbed) return false;
  const bool error_is_small = last_.error < join_below * options_.tolerance;
  const int every = !any_precomputed_    ? (error_is_small ? 2 : 1)
                    : !may_expand(world) ? options_.recover_every
                    : error_is_small     ? 6
                                         : 3;
  return (looks_ - 1) % every > 0;
}

// Repeats the last report in a frame without an estimate.
template <class Real>
LinearityReport LinearityWatch<Real>::report_without_estimate(const World<Real>& world) {
  last_.time = world.time();
  last_.to_nonlinear = last_.to_linear = 0;
  last_.is_expanded = world.body().regions.is_expanded();
  if (last_.is_expanded) last_.error = 0;
  last_.exceeded = last_.error > options_.tolerance;
  return last_;
}

// The defects of each linear zone; with `all`, of the others as well.
template <class Real>
Defects LinearityWatch<Real>::defects(const World<Real>& world, const Mat3X<double>& u, bool all) const {
  Defects defects = Defects::Zero(9, zones_.count());
  const Mat3X<double>& about = world.body().regions.linearised_about();
  for (Index z = 0; z < zones_.count(); ++z) {
    const double share = share_[std::size_t(z)];
    if (share == 0 && !all) continue;
    const bool is_linear = share > 0.5 && !world.body().regions.is_expanded();
    const auto gradient = defects_.gradient(z, u);
    defects.col(z) = about.size() > 0
                         ? defects_.beyond_tangent(z, gradient, defects_.gradient(z, about), is_linear)
                         : defects_.at(z, gradient, is_linear);
  }
  return defects;
}

// The displacement error of a condensed interior because it has no inertia, √Σ m |u|² [√kg m], at the last
// forces.
template <class Real>
double LinearityWatch<Real>::inertia_error_of(const World<Real>& world) const {
  const Dynamics<Real>& body = world.body();
  Vec3d sum = Vec3d::Zero();
  int count = 0;
  for (Index v : body.regions.shared()) {
    if (body.inertia.inverse_mass(v) == 0) continue;
    sum += body.inertia.inverse_mass(v) * body.motion.forces.col(v).template cast<double>();
    ++count;
  }
  return count > 0 ? body.regions.precomputed().inertia_error(sum / count) : 0;
}

template <class Real>
void LinearityWatch<Real>::place_worst(const Elements& elements, const Eigen::VectorXd& error,
                                       LinearityReport& report) const {
  Index worst = 0;
  error.reshaped(3, zones_.count()).colwise().norm().maxCoeff(&worst);
  report.worst = error.segment<3>(3 * worst).norm();
  const Index middle = zones_.tets[std::size_t(worst)][zones_.tets[std::size_t(worst)].size() / 2];
  report.place = elements.corner_points(middle).rowwise().mean();
}

template <class Real>
LinearityReport LinearityWatch<Real>::look(World<Real>& world, const CommandSink& send) {
  const auto start = std::chrono::steady_clock::now();
  const bool begins = looks_++ == 0, is_cut = follow_edits(world);
  const double frame = world.time() - std::exchange(time_, world.time());
  const bool holders_changed =
      hold(world.held()) || world.tools().next_grasp_change(world.time() - 2e-9) < world.time() + 1.5 * frame;
  const bool was_disturbed = begins || is_cut || holders_changed;
  const bool expandable = may_expand(world);
  if (expandable && was_disturbed && !world.is_unravelling()) {  // whatever the estimate is
    if (!world.body().regions.is_expanded()) send(Expand{});
    frames_condensable_ = 0;
    return report_without_estimate(world);
  }
  if (may_skip(world, was_disturbed)) return report_without_estimate(world);
  const Mat3X<double> u = world.displacements().template cast<double>();
  double sum = 0;
  for (std::size_t v = 0; v < volume_.size(); ++v) sum += volume_[v] * u.col(Eigen::Index(v)).squaredNorm();
  largest_ = std::max(largest_, std::sqrt(sum));
  const Defects of_zones = defects(world, u, options_.correct && !expandable);
  const Eigen::Map<const Eigen::RowVectorXd> shares(share_.data(), zones_.count());
  const Eigen::VectorXd error =
      influence_->displacement((of_zones.array().rowwise() * shares.array()).matrix());
  zone_errors_ = error.reshaped(3, zones_.count());
  LinearityReport report;
  report.time = world.time();
  const double inertia_error = largest_ > 0 ? inertia_error_of(world) / std::sqrt(density_) / largest_ : 0;
  const double estimate = relative(error) + inertia_error;
  report.is_expanded = world.body().regions.is_expanded();
  report.error = report.is_expanded ? 0 : estimate;
  report.exceeded = report.error > options_.tolerance;
  place_worst(world.elements(), error, report);
  looking_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (report.exceeded && options_.on_exceeded) options_.on_exceeded(report);
  if (expandable)
    correct_precomputed(world, send, estimate, report);
  else if (options_.correct)
    correct(world, send, of_zones, error, report);
  last_ = report;
  return report;
}

// Relinearises a pre-computed region while its error is small, and expands it if the error is large. It is
// also expanded, without an estimate, if a cut, a grasp or a release in the last frame or the next starts a
// motion that the estimate cannot predict. It is condensed again when the error has been small enough for
// some frames. Until then it is relinearised about the present state.
template <class Real>
void LinearityWatch<Real>::correct_precomputed(const World<Real>& world, const CommandSink& send,
                                               double estimate, LinearityReport& report) {
  const double delay = delay_per_tet * world.elements().topology.alive_count();
  const bool is_condensable = estimate < condense_below * options_.tolerance;
  if (world.body().regions.is_expanded()) {
    frames_condensable_ = is_condensable && world.body().regions.can_condense() ? frames_condensable_ + 1 : 0;
    if (frames_condensable_ >= patience_to_condense) send(Condense{});
  } else if (estimate > leave_above * options_.tolerance) {
    send(Expand{});
    frames_condensable_ = 0;
  }
  const bool is_far =
      estimate > relinearise_above * options_.tolerance || !world.body().regions.can_condense();
  if (is_far && !world.body().regions.is_condensing()) send(Relinearise{delay});
  report.is_expanded = world.body().regions.is_expanded();
}

// If the error is too large, the zones that lower it most become non-linear. If it is small, zones become
// linear that could have been so for some frames.
template <class Real>
void LinearityWatch<Real>::correct(const World<Real>& world, const CommandSink& send, const Defects& defects,
                                   Eigen::VectorXd error, LinearityReport& report) {
  Eigen::MatrixXd contributions(error.size(), zones_.count());
  for (Index z = 0; z < zones_.count(); ++z)
    contributions.col(z) = influence_->displacement(z, defects.col(z));
  const auto tets = [&](Index z) { return static_cast<Index>(zones_.tets[std::size_t(z)].size()); };
  bool leaves = report.exceeded;
  while (leaves && relative(error) > leave_down_to * options_.tolerance) {
    Index best = -1;
    double smallest = relative(error);
    for (Index z = 0; z < zones_.count(); ++z) {
      if (share_[std::size_t(z)] == 0 || report.to_nonlinear + tets(z) > options_.most_tets) continue;
      const double without = relative(error - share_[std::size_t(z)] * contributions.col(z));
      if (without >= smallest) continue;
      smallest = without;
      best = z;
    }
    leaves = best >= 0;
    if (!leaves) break;
    error -= share_[std::size_t(best)] * contributions.col(best);
    move(world, send, best, RegionModel::nonlinear, report);
  }
  Index next = -1;
  double smallest = join_below * options_.tolerance;
  for (Index z = 0; z < zones_.count(); ++z) {
    int& frames_near_linear = frames_near_linear_[std::size_t(z)];
    if (share_[std::size_t(z)] > 0) {
      frames_near_linear = 0;
      continue;
    }
    const double with = relative(error + contributions.col(z));
    frames_near_linear = with <= join_below * options_.tolerance ? frames_near_linear + 1 : 0;
    if (frames_near_linear < patience || with > smallest || tets(z) > options_.most_tets) continue;
    smallest = with;
    next = z;
  }
  if (next >= 0 && report.to_nonlinear == 0) move(world, send, next, options_.linear, report);
}

template <class Real>
void LinearityWatch<Real>::move(const World<Real>& world, const CommandSink& send, Index zone,
                                RegionModel model, LinearityReport& report) {
  std::vector<Index> tets;
  for (Index t : zones_.tets[std::size_t(zone)])
    if (world.elements().topology.alive(t) && world.elements().region_of[t] != model) tets.push_back(t);
  send(SetRegion{tets, model});
  (model == RegionModel::nonlinear ? report.to_nonlinear : report.to_linear) +=
      static_cast<Index>(tets.size());
  find_shares(world.elements());
  edits_.read(world);
  frames_near_linear_[std::size_t(zone)] = 0;
}

template class LinearityWatch<float>;
template class LinearityWatch<double>;

}  // namespace lobe
