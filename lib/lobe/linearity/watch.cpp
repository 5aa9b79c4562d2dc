#include "lobe/linearity/watch.h"

#include <algorithm>
#include <chrono>

namespace lobe {
namespace {

constexpr double leave_down_to = 0.7;  // of the tolerance: where zones stop to leave
constexpr double join_below = 0.4;     // where they may join
constexpr int patience = 8;            // looks for which one must have been welcome
constexpr int looks_for_influence = 30;

bool is_linear(const Elements& elements, Index tet) {
  return elements.region_of[tet] != RegionModel::nonlinear;
}

std::vector<double> vertex_volumes(const Elements& elements) {
  std::vector<double> volume(std::size_t(elements.topology.vertex_count()), 0);
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    if (!elements.topology.alive(t)) continue;
    const double share = signed_volume(elements.corner_points(t)) / 4;
    for (Index v : elements.topology.corners(t)) volume[std::size_t(v)] += share;
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
      calm_(std::size_t(zones_.count()), 0),
      volume_(vertex_volumes(world.elements())),
      edits_(world.history().size()) {
  influence_ = std::make_unique<Influence>(world.elements(), zones_, boundary_of(world), grasps_);
  find_shares(world.elements());
}

template <class Real>
void LinearityWatch<Real>::find_shares(const Elements& elements) {
  share_.assign(std::size_t(zones_.count()), 0);
  for (Index z = 0; z < zones_.count(); ++z)
    for (Index t : zones_.tets[std::size_t(z)])
      if (elements.topology.alive(t) && is_linear(elements, t))
        share_[std::size_t(z)] += signed_volume(elements.corner_points(t)) / zones_.volume[std::size_t(z)];
}

template <class Real>
bool LinearityWatch<Real>::any_precomputed(const Elements& elements) const {
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    if (elements.region_of[t] == RegionModel::precomputed && elements.topology.alive(t)) return true;
  return false;
}

// What is held without any grasp.
template <class Real>
HeldVertices LinearityWatch<Real>::boundary_of(const World<Real>& world) const {
  HeldVertices boundary = world.held();
  for (std::size_t g = 0; g < grasps_.size(); ++g) boundary.release(HeldVertices::boundary + 1 + int(g));
  return boundary;
}

// A cut changes what zones do to each other: found anew from a copy, since it takes as long as many frames.
template <class Real>
void LinearityWatch<Real>::follow_edits(const World<Real>& world) {
  if (next_influence_.valid() && --looks_to_wait_ <= 0) influence_ = next_influence_.get();
  const std::vector<Edit>& history = world.history();
  if (history.size() != edits_) {
    const auto is_cut = [](const Edit& edit) { return edit.kind == Edit::Kind::removal; };
    const bool restored = history.size() < edits_;
    if (restored || std::any_of(history.begin() + std::ptrdiff_t(edits_), history.end(), is_cut)) {
      defects_ = MeanDefects(world.elements(), zones_);
      volume_ = vertex_volumes(world.elements());
      influence_is_stale_ = true;
    }
    edits_ = history.size();
    find_shares(world.elements());
  }
  if (!influence_is_stale_ || next_influence_.valid()) return;
  influence_is_stale_ = false;
  looks_to_wait_ = looks_for_influence;
  next_influence_ =
      std::async(std::launch::async, [elements = world.elements(), boundary = boundary_of(world), this] {
        return std::make_unique<Influence>(elements, zones_, boundary, grasps_);
      });
}

template <class Real>
void LinearityWatch<Real>::hold(const HeldVertices& held) {
  std::vector<Index> holding;
  for (const HeldVertices::Held& item : held.all())
    if (item.holder != HeldVertices::boundary && item.holder <= static_cast<int>(grasps_.size()))
      holding.push_back(item.holder - 1);
  std::sort(holding.begin(), holding.end());
  holding.erase(std::unique(holding.begin(), holding.end()), holding.end());
  influence_->hold(holding);
}

template <class Real>
double LinearityWatch<Real>::relative(const Eigen::VectorXd& error) const {
  return largest_ > 0 ? zones_.norm(error) / largest_ : 0;
}

template <class Real>
LinearityReport LinearityWatch<Real>::look(World<Real>& world, const SetRegion& set_region) {
  const auto start = std::chrono::steady_clock::now();
  follow_edits(world);
  if (looks_++ % options_.recover_every != 0 && any_precomputed(world.elements())) {
    last_.time = world.time();
    last_.to_nonlinear = last_.to_linear = 0;
    last_.energy_change = 0;
    return last_;
  }
  hold(world.held());
  const Mat3X<double> u = world.state().u.template cast<double>();
  double sum = 0;
  for (std::size_t v = 0; v < volume_.size(); ++v) sum += volume_[v] * u.col(Eigen::Index(v)).squaredNorm();
  largest_ = std::max(largest_, std::sqrt(sum));
  const auto gradients = defects_.gradients(u);
  Columns contributions(3 * zones_.count(), zones_.count());
  Eigen::VectorXd error = Eigen::VectorXd::Zero(3 * zones_.count());
  for (Index z = 0; z < zones_.count(); ++z) {
    const double share = share_[std::size_t(z)];
    if (share == 0 && !options_.correct) continue;
    contributions.col(z) = influence_->displacement(z, defects_.at(z, gradients.col(z), share > 0.5));
    error += share * contributions.col(z);
  }
  LinearityReport report;
  report.time = world.time();
  report.error = relative(error);
  report.exceeded = report.error > options_.tolerance;
  Index worst = 0;
  error.reshaped(3, zones_.count()).colwise().norm().maxCoeff(&worst);
  report.worst = error.segment<3>(3 * worst).norm();
  const Index middle = zones_.tets[std::size_t(worst)][zones_.tets[std::size_t(worst)].size() / 2];
  report.place = world.elements().corner_points(middle).rowwise().mean();
  looking_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (report.exceeded && options_.on_exceeded) options_.on_exceeded(report);
  const auto directly = [&](const std::vector<Index>& tets, RegionModel model) {
    return world.set_region(tets, model);
  };
  if (options_.correct) correct(world, set_region ? set_region : directly, contributions, error, report);
  last_ = report;
  return report;
}

// Zones leave that lower the error most; where it is small, those join that have long been welcome.
template <class Real>
void LinearityWatch<Real>::correct(const World<Real>& world, const SetRegion& set_region,
                                   const Columns& contributions, Eigen::VectorXd error,
                                   LinearityReport& report) {
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
    move(world, set_region, best, RegionModel::nonlinear, report);
  }
  Index next = -1;
  double smallest = join_below * options_.tolerance;
  for (Index z = 0; z < zones_.count(); ++z) {
    int& calm = calm_[std::size_t(z)];
    if (share_[std::size_t(z)] > 0) {
      calm = 0;
      continue;
    }
    const double with = relative(error + contributions.col(z));
    calm = with <= join_below * options_.tolerance ? calm + 1 : 0;
    if (calm < patience || with > smallest || tets(z) > options_.most_tets) continue;
    smallest = with;
    next = z;
  }
  if (next >= 0 && report.to_nonlinear == 0) move(world, set_region, next, options_.linear, report);
}

template <class Real>
void LinearityWatch<Real>::move(const World<Real>& world, const SetRegion& set_region, Index zone,
                                RegionModel model, LinearityReport& report) {
  std::vector<Index> tets;
  for (Index t : zones_.tets[std::size_t(zone)])
    if (world.elements().topology.alive(t) && world.elements().region_of[t] != model) tets.push_back(t);
  report.energy_change += set_region(tets, model);
  (model == RegionModel::nonlinear ? report.to_nonlinear : report.to_linear) +=
      static_cast<Index>(tets.size());
  find_shares(world.elements());
  edits_ = world.history().size();
  calm_[std::size_t(zone)] = 0;
}

template class LinearityWatch<float>;
template class LinearityWatch<double>;

}  // namespace lobe
