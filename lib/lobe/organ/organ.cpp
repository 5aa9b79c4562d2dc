#include "lobe/organ/organ.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <type_traits>
#include <utility>

#include "lobe/condense/supports.h"
#include "lobe/error.h"
#include "lobe/file/fields.h"
#include "lobe/organ/kinds_of_terms.h"
#include "lobe/organ/left_out_fields.h"
#include "lobe/setup/check_setup.h"
#include "lobe/tool/tool_lists.h"

namespace lobe {
namespace {

double mean_edge(const Elements& elements) {
  double sum = 0;
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    const Mat34<double> x = elements.corner_points(t);
    for (const auto& edge : edge_corners) sum += (x.col(edge[0]) - x.col(edge[1])).norm();
  }
  return sum / (6.0 * elements.topology.tet_count());
}

double diagonal(const Elements& elements) {  // of the bounding box [m]
  const auto points = elements.points.view();
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

RegionEdit everything(const Topology& topology) {
  RegionEdit edit;
  edit.entered.resize(std::size_t(topology.tet_count()));
  std::iota(edit.entered.begin(), edit.entered.end(), 0);
  edit.vertices.resize(std::size_t(topology.vertex_count()));
  std::iota(edit.vertices.begin(), edit.vertices.end(), 0);
  return edit;
}

template <class Real>
const Setup& checked(const Setup& setup) {
  check_setup(setup, std::is_same_v<Real, float> ? Options{Option::single_precision} : Options{});
  return setup;
}

}  // namespace

std::uint64_t fingerprint(const Setup& setup) { return io::digest_of_fields(setup); }

template <class Real>
Organ<Real>::Organ(const Setup& setup, int threads, const Progress& progress)
    : setup_(checked<Real>(setup)),
      journal_{fingerprint(setup), {}},
      body_(setup, threads, progress),
      limit_(mean_edge(elements())),
      unravelling_(elements(), diagonal(elements())) {
  setup_.mesh = {};
  setup_.material_of = {};
  body_.motion.longest_move = mean_edge(elements());
  body_.sleep = Sleep(setup.sleep, setup.sleep / 8 * body_.motion.longest_move / diagonal(elements()));
  if (setup.cut_frequency > 0)
    body_.inertia.set_floor({setup.cut_frequency * setup.cut_frequency, body_.regions.model_without_steps()});
  refuse_unsupported(elements(), held());
  Change built{.regions = everything(elements().topology)};
  follow(built);
  pieces_ = Pieces(body_.model);
  if (setup.integrator == Integrator::generalised_alpha)
    implicit_ = std::make_unique<ImplicitDynamics>(setup.spectral_radius);
  if (body_.regions.has_modes()) {
    follow_mode(true);
    limit_.measure_at_rest(body_);
    follow_mode(false);
  }
  limit_.measure_at_rest(body_);
  embed();
  if (setup.own_steps) begin_own_steps();
  if (need_grains(setup)) prepare_blades();
  for (const KindOfTerm<Real>& kind : kinds_of_terms<Real>())
    if (kind.follows_cuts && kind.is_needed(setup, {})) own_term(kind.name);
}

template <class Real>
void Organ<Real>::begin_own_steps() {
  limit_.find(body_);
  body_.own_steps.emplace();
  body_.own_steps->lay_out(body_, limit_.limiting_squares(body_), 1e-9 * body_.motion.longest_move);
  limit_.forget();
}

// ---- State

template <class Real>
StateView<Real> Organ<Real>::state() {
  body_.recover(Regions<Real>::Interior::all);
  const Motion<Real>& motion = body_.motion;
  return {motion.u.view(), motion.v.view(), motion.time, motion.velocity_lag};
}

template <class Real>
Eigen::Map<const Mat3X<Real>> Organ<Real>::displacements() {
  body_.recover(Regions<Real>::Interior::displacements);
  return std::as_const(body_.motion.u).view();
}

template <class Real>
void Organ<Real>::check(const State<Real>& state) {
  if (!state.u.allFinite() || !state.v.allFinite() || !std::isfinite(state.time))
    throw InputError("state", "it holds values that are not finite");
  if (!(state.velocity_lag >= 0) || !std::isfinite(state.velocity_lag))
    throw InputError("state", "velocity_lag must be 0 s or more and finite, not " +
                                  std::to_string(state.velocity_lag) +
                                  ": it says how much older velocities are than displacements");
}

template <class Real>
void Organ<Real>::set_state(const State<Real>& state) {
  check(state);
  if (state.u.cols() != body_.motion.u.count() || state.v.cols() != body_.motion.v.count())
    throw InputError("state", "it must have one column per vertex of the world, " +
                                  std::to_string(body_.motion.u.count()));
  Motion<Real>& motion = body_.motion;
  motion.u.view() = state.u;
  motion.v.view() = state.v;
  motion.time = state.time;
  motion.velocity_lag = implicit_ ? 0 : state.velocity_lag;
  body_.regions.reduced().settle_all(elements(), limit_.highest_at_rest(), motion);
  body_.regions.relax_all(elements(), motion.u.padded());
  body_.state_was_replaced();
  body_.sleep.wake_all(state.time);
  if (body_.own_steps) body_.own_steps->forget();
  limit_.restart(body_);
  unravelling_.restart(state.time);
}

template <class Real>
void Organ<Real>::take_nodes(const typename Regions<Real>::State& nodes, const State<Real>& state) {
  if (!body_.regions.any_roles()) return;
  LatticeRegion<Real>& region = body_.regions.reduced();
  region.set_zones(nodes.zones);
  region.holds_have_changed();
  const std::vector<Index> weighed = region.set_asked_mass(nodes.asked_mass);
  VertexRoles roles = region.roles(body_.model, nodes.is_embedded);
  if (region.has_roles(roles))
    edit({}, [&] { return Change{.weighed = weighed}; });
  else
    give(std::move(roles), {.followers = true});
  body_.motion.nodes.u = nodes.u;
  body_.motion.nodes.v = nodes.v;
  region.set_fading(elements(), nodes.fading);
  body_.motion.u.view() = state.u;
  body_.motion.v.view() = state.v;
  body_.state_was_replaced();
}

template <class Real>
void Organ<Real>::take_surroundings(Organ& former) {
  body_.terms = std::move(former.body_.terms);
  softening_ = std::move(former.softening_);
  display_ = std::move(former.display_);
  display_.rebuild(elements(), grains());
  edit({}, [&] { return Change{.former = former.body_.model.revisions}; });
}

// The setup before all edits, without copies.
template <class Real>
Setup Organ<Real>::initial_setup() const {
  const Topology& now = elements().topology;
  Setup setup = setup_;
  setup.mesh.points = elements().points.view().leftCols(now.vertex_count() - now.copy_count());
  const Index tets = now.tet_count() - now.tet_copy_count();
  setup.mesh.tets = now.tets().leftCols(tets).unaryExpr([&](Index v) { return now.origin(v); });
  setup.mesh.labels = elements().labels;
  setup.mesh.labels.resize(std::size_t(tets), 0);
  setup.mesh.bodies = elements().bodies;
  if (setup.mesh.bodies.any()) setup.mesh.bodies.of.resize(std::size_t(tets));
  setup.mesh.fibres = elements().fibres;
  if (setup.mesh.fibres.cols() > tets) setup.mesh.fibres.conservativeResize(Eigen::NoChange, tets);
  setup.material_of = elements().material_of;
  setup.material_of.resize(std::size_t(tets));
  return setup;
}

// ---- What tools see

// Computes where vertices are that follow others, before a tool searches them.
template <class Real>
void Organ<Real>::see_interior() {
  if (!body_.regions.any_following() || seen_ == body_.model.revisions) return;
  edit({}, [] { return Change{.interior_is_sought = true}; });
}

template <class Real>
std::vector<Index> Organ<Real>::meeting_as_seen(const SweptVolume& volume) {
  if (std::exchange(jumps_, body_.model.revisions.jumps) != body_.model.revisions.jumps) groups_.forget();
  return groups_.meeting(elements().topology, elements().points.padded(), body_.motion.u.padded(), volume);
}

// ---- Steps

template <class Real>
void Organ<Real>::end_step(double dt) {
  const Motion<Real>& motion = body_.motion;
  limit_.count_step();
  body_.end_step();
  const double farthest = (motion.speeds.fastest + motion.speeds.driven) * dt;
  moved(farthest, std::numeric_limits<Real>::epsilon());
  for (const auto& term : body_.terms) term->end_step(farthest, dt);
}

template <class Real>
void Organ<Real>::report_frame(const PatchCount& before, Report& report) {
  const PatchCount after = body_.regions.patch_count();
  report.patches_evaluated = after.evaluated - before.evaluated;
  report.patches_skipped = after.skipped - before.skipped;
  report.transitions = std::exchange(unreported_.transitions, {});
  report.events = std::exchange(unreported_.events, {});
  for (const auto& term : body_.terms) {
    std::vector<Event> events = term->take_events();
    std::move(events.begin(), events.end(), std::back_inserter(report.events));
  }
}

// ---- Edits

template <class Real>
void Organ<Real>::repeat(const JournalEntry& entry) {
  std::visit([this](const auto& any) { this->repeat(any); }, entry);
}

template <class Real>
void Organ<Real>::repeat(const RemoveTets& entry) {
  check_tets(entry.tets);
  cut(entry.tets);
}

template <class Real>
void Organ<Real>::repeat(const SetRegion& entry) {
  check_tets(entry.tets);
  change_region(entry.tets, entry.model);
}

template class Organ<float>;
template class Organ<double>;

}  // namespace lobe
