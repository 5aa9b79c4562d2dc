#include "lobe/sim/world.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "lobe/error.h"
#include "lobe/sim/check_setup.h"
#include "lobe/sim/integrator.h"

namespace lobe {
namespace {

using Clock = std::chrono::steady_clock;

// Adds the wall time of a scope to a phase.
class Timed {
 public:
  Timed(Report& report, Phase phase) : sum_(report.seconds[std::size_t(phase)]), start_(Clock::now()) {}
  ~Timed() { sum_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  double& sum_;
  Clock::time_point start_;
};

double mean_edge(const Elements& elements) {
  double sum = 0;
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    const Mat34<double> x = elements.corner_points(t);
    for (const auto& edge : edge_corners) sum += (x.col(edge[0]) - x.col(edge[1])).norm();
  }
  return sum / (6.0 * elements.topology.tet_count());
}

}  // namespace

const char* name(Condition::Kind kind) {
  switch (kind) {
    case Condition::Kind::diverged:
      return "diverged";
    case Condition::Kind::sub_stepped:
      return "sub_stepped";
    case Condition::Kind::near_inversion:
      return "near_inversion";
    case Condition::Kind::pieces:
      return "pieces";
    case Condition::Kind::everything_cut:
      return "everything_cut";
  }
  return "";
}

template <class Real>
World<Real>::World(const Setup& setup, int threads)
    : setup_((check_setup(setup), setup)),
      elements_(setup),
      nonlinear_(setup.evaluator),
      tools_(setup),
      parallel_(threads) {
  const Index n = elements_.topology.vertex_count();
  state_.u = Mat3X<Real>::Zero(3, n);
  state_.v = state_.u;
  longest_move_ = mean_edge(elements_);
  for (const PrescribedVertex& p : setup.prescribed)
    held_.hold({p.vertex, HeldVertices::boundary, Vec3d::Zero(), p.displacement});
  RegionEdit everything;
  everything.entered.resize(std::size_t(elements_.topology.tet_count()));
  std::iota(everything.entered.begin(), everything.entered.end(), 0);
  everything.vertices.resize(std::size_t(n));
  std::iota(everything.vertices.begin(), everything.vertices.end(), 0);
  tensor_mass_.follow(elements_, everything);
  nonlinear_.follow(elements_, everything);
  refresh_vertices(everything.vertices);
  find_bodies();
  const double vertex = highest_vertex().omega;
  if (vertex > 0) frequency_ratio_ = std::max(1.0, lanczos_frequency(elements_, inverse_mass_) / vertex);
  rest_frequency_ = frequency_ratio_ * vertex;
}

// ---- Stepping

template <class Real>
void World<Real>::step(double dt) {
  forces();
  integrate(dt);
}

template <class Real>
void World<Real>::integrate(double dt) {
  const Real fastest =
      central_difference(forces_, step_mass_, Real(dt), Real(setup_.damping), state_.u, state_.v);
  fastest_ = std::sqrt(double(fastest));
  state_.time += dt;
  move_held(dt);
}

template <class Real>
const Mat3X<Real>& World<Real>::forces() {
  forces_ = external_;
  const double missing = setup_.load_ramp > 0 ? std::max(0.0, 1 - state_.time / setup_.load_ramp) : 0;
  if (missing > 0) forces_ -= Real(missing) * dead_loads_;
  tensor_mass_.add_forces(state_.u, forces_, parallel_);
  nonlinear_.add_forces(state_.u, forces_, parallel_);
  return forces_;
}

template <class Real>
void World<Real>::move_held(double dt) {
  const double ramp = setup_.ramp > 0 ? std::min(1.0, state_.time / setup_.ramp) : 1.0;
  for (const HeldVertices::Held& item : held_.all()) {
    const Vec3d u = item.holder == HeldVertices::boundary
                        ? Vec3d(item.start + ramp * (item.goal - item.start))
                        : tools_.grasped(item, state_.time);
    const Vec3<Real> goal = u.cast<Real>();
    state_.v.col(item.vertex) = (goal - state_.u.col(item.vertex)) / Real(dt);
    state_.u.col(item.vertex) = goal;
  }
}

template <class Real>
bool World<Real>::run_steps(int steps, double dt, Report& report) {
  for (int i = 0; i < steps; ++i) {
    {
      const Timed timed(report, Phase::forces);
      forces();
    }
    const Timed timed(report, Phase::integration);
    integrate(dt);
    ++report.steps;
    if (!(fastest_ * dt < longest_move_)) return false;
  }
  return true;
}

template <class Real>
Report World<Real>::advance(double duration) {
  if (!(duration > 0) || !std::isfinite(duration))
    throw InputError("advance", "the duration must be above 0 s and finite, not " + std::to_string(duration));
  Report report;
  const double end = state_.time + duration, shortest = 1e-9 * duration;
  while (report.ok && state_.time < end - shortest) {
    const double next = tools_.next_grasp_change(state_.time + shortest);
    advance_to(next < end - shortest ? next : end, report);
  }
  return report;
}

template <class Real>
void World<Real>::advance_to(double end, Report& report) {
  const double duration = end - state_.time;
  play_tools(duration, report);
  {
    const Timed timed(report, Phase::time_step);
    report.time_step_limit = time_step_limit();
  }
  report.smallest_volume_ratio = std::min(report.smallest_volume_ratio, volume_ratio_);
  if (volume_ratio_ < 0.05)
    report.conditions.push_back({Condition::Kind::near_inversion,
                                 "tetrahedron " + std::to_string(volume_ratio_tet_) + " is at " +
                                     std::to_string(volume_ratio_) + " of its volume: raise volume_penalty",
                                 state_.time});
  constexpr int most_steps = 1 << 20, most_tries = 5;
  const double wanted = std::ceil(duration / (setup_.safety * report.time_step_limit) * (1 - 1e-12));
  int steps = static_cast<int>(std::clamp(wanted, 1.0, double(most_steps)));
  const State<Real> start = state_;
  double step = 0;
  for (int attempt = 0; attempt < most_tries && steps <= most_steps; ++attempt, steps *= 2) {
    step = duration / steps;
    if (run_steps(steps, step, report)) {
      state_.time = end;
      report.time_step = report.time_step > 0 ? std::min(report.time_step, step) : step;
      if (attempt > 0)
        report.conditions.push_back({Condition::Kind::sub_stepped,
                                     "it took " + std::to_string(1 << attempt) + " times smaller steps",
                                     start.time});
      return;
    }
    state_ = start;
  }
  report.ok = false;
  report.time_step = step;
  report.conditions.push_back(
      {Condition::Kind::diverged,
       "no step down to " + std::to_string(step) +
           " s was stable; displacements and velocities before it are kept. Use a smaller "
           "load or tool speed, more damping, or a volume_penalty",
       state_.time});
}

template <class Real>
void World<Real>::play_tools(double duration, Report& report) {
  const Timed timed(report, Phase::cutting);
  const auto displacement = [&](Index v) -> Vec3d { return state_.u.col(v).template cast<double>(); };
  const auto exists = [&](Index v) { return mass_[v] > 0; };
  if (tools_.update_grasps(state_.time, held_, displacement, exists)) {
    for (Index v = 0; v < elements_.topology.vertex_count(); ++v) refresh_inverse_mass(v);
    report.tets_removed += treat_loose_pieces();
  }
  for (const Sweep& sweep : tools_.sweeps(state_.time, state_.time + duration))
    report.tets_removed += remove_tets(touched_tets(elements_.topology, elements_.points, state_.u, sweep));
  report.conditions.insert(report.conditions.end(), pending_.begin(), pending_.end());
  pending_.clear();
}

template <class Real>
void World<Real>::set_state(const State<Real>& state) {
  if (state.u.cols() != state_.u.cols() || state.v.cols() != state_.v.cols())
    throw InputError("state",
                     "it must have one column per vertex of the world, " + std::to_string(state_.u.cols()));
  if (!state.u.allFinite() || !state.v.allFinite())
    throw InputError("state", "it holds values that are not finite");
  state_ = state;
}

// ---- What can be asked

template <class Real>
VertexFrequency World<Real>::highest_vertex() {
  stiffness_.setZero(6, elements_.topology.vertex_count());
  tensor_mass_.add_diagonal_stiffness(stiffness_);
  const auto found = nonlinear_.add_diagonal_stiffness(state_.u, stiffness_);
  volume_ratio_ = found.smallest_volume_ratio;
  volume_ratio_tet_ = found.smallest_tet;
  return vertex_frequency(stiffness_, inverse_mass_);
}

template <class Real>
double World<Real>::time_step_limit() {
  // SVK softens when crushed; a step far beyond that of the body at rest would still be rash.
  const double omega = std::max(frequency_ratio_ * highest_vertex().omega, rest_frequency_ / 4);
  return omega > 0 ? 2 / omega : std::numeric_limits<double>::infinity();
}

template <class Real>
Vec3d World<Real>::reaction(int holder) {
  forces();
  Vec3d sum = Vec3d::Zero();
  for (const HeldVertices::Held& item : held_.all())
    if (item.holder == holder) sum -= forces_.col(item.vertex).template cast<double>();
  return sum;
}

template <class Real>
Energies World<Real>::energies() {
  Energies e;
  for (Index v = 0; v < elements_.topology.vertex_count(); ++v) {
    e.kinetic += 0.5 * mass_[v] * state_.v.col(v).template cast<double>().squaredNorm();
    e.loads -= external_.col(v).template cast<double>().dot(state_.u.col(v).template cast<double>());
  }
  e.elastic_linear = tensor_mass_.energy(state_.u);
  e.elastic_nonlinear = nonlinear_.energy(state_.u);
  return e;
}

template <class Real>
std::vector<Tools::Pose> World<Real>::tool_poses() const {
  return tools_.poses(state_.time, held_, [&](Index v) -> Vec3d {
    return elements_.points.col(v) + state_.u.col(v).template cast<double>();
  });
}

// ---- Edits

template <class Real>
Index World<Real>::remove_tets(const std::vector<Index>& tets) {
  check_tets(tets);
  const MeshEdit edit = elements_.topology.remove(tets);
  if (edit.empty()) return 0;
  follow(edit);
  Index removed = static_cast<Index>(edit.removed.size());
  removed += treat_loose_pieces();
  if (elements_.topology.alive_count() == 0)
    pending_.push_back({Condition::Kind::everything_cut, "no tetrahedron is left", state_.time});
  return removed;
}

template <class Real>
void World<Real>::follow(const MeshEdit& mesh_edit) {
  const Index before = static_cast<Index>(state_.u.cols()), after = elements_.topology.vertex_count();
  elements_.points.conservativeResize(3, after);
  state_.u.conservativeResize(3, after);
  state_.v.conservativeResize(3, after);
  RegionEdit edit;
  edit.left = mesh_edit.removed;
  for (const VertexSplit& split : mesh_edit.splits) {
    elements_.points.col(split.copy) = elements_.points.col(split.vertex);
    state_.u.col(split.copy) = state_.u.col(split.vertex);
    state_.v.col(split.copy) = state_.v.col(split.vertex);
    held_.split(split.vertex, split.copy);
    edit.entered.insert(edit.entered.end(), split.tets.begin(), split.tets.end());
    edit.vertices.push_back(split.vertex);
  }
  for (Index v = before; v < after; ++v) edit.vertices.push_back(v);
  const auto make_unique = [](std::vector<Index>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  };
  make_unique(edit.entered);
  edit.left.insert(edit.left.end(), edit.entered.begin(), edit.entered.end());
  for (Index t : edit.left)
    for (int c = 0; c < 4; ++c) edit.vertices.push_back(elements_.topology.tets()(c, t));
  make_unique(edit.vertices);
  tensor_mass_.follow(elements_, edit);
  nonlinear_.follow(elements_, edit);
  refresh_vertices(edit.vertices);
}

template <class Real>
void World<Real>::refresh_vertices(const std::vector<Index>& vertices) {
  const auto n = std::size_t(elements_.topology.vertex_count());
  mass_.resize(n, 0);
  inverse_mass_.resize(n, 0);
  step_mass_.resize(n, 0);
  external_.conservativeResize(3, Eigen::Index(n));
  dead_loads_ = dead_loads(elements_, setup_.face_loads, setup_.vertex_loads).template cast<Real>();
  for (Index v : vertices) {
    mass_[v] = lumped_mass(elements_, v);
    refresh_inverse_mass(v);
    if (elements_.topology.around(v).empty()) state_.v.col(v).setZero();
  }
  for (Index v = 0; v < static_cast<Index>(n); ++v)
    external_.col(v) = dead_loads_.col(v) + (mass_[v] * setup_.gravity).template cast<Real>();
}

template <class Real>
void World<Real>::refresh_inverse_mass(Index v) {
  inverse_mass_[v] = mass_[v] > 0 && !held_.holds(v) ? 1 / mass_[v] : 0;
  step_mass_[v] = static_cast<Real>(inverse_mass_[v]);
}

template <class Real>
void World<Real>::set_region(const std::vector<Index>& tets, RegionModel model) {
  if (model == RegionModel::precomputed)
    throw InputError("region", "precomputed regions are not available yet; use tensor-mass");
  check_tets(tets);
  RegionEdit edit;
  for (Index t : tets) {
    if (!elements_.topology.alive(t) || elements_.region_of[t] == model) continue;
    elements_.region_of[t] = model;
    edit.left.push_back(t);
    for (int c = 0; c < 4; ++c) edit.vertices.push_back(elements_.topology.tets()(c, t));
  }
  edit.entered = edit.left;
  std::sort(edit.vertices.begin(), edit.vertices.end());
  edit.vertices.erase(std::unique(edit.vertices.begin(), edit.vertices.end()), edit.vertices.end());
  tensor_mass_.follow(elements_, edit);
  nonlinear_.follow(elements_, edit);
}

template <class Real>
bool World<Real>::is_held(const std::vector<Index>& piece) const {
  return std::any_of(piece.begin(), piece.end(), [&](Index t) {
    const Eigen::Vector4i v = elements_.topology.corners(t);
    return held_.holds(v[0]) || held_.holds(v[1]) || held_.holds(v[2]) || held_.holds(v[3]);
  });
}

template <class Real>
void World<Real>::find_bodies() {
  body_of_.assign(std::size_t(elements_.topology.tet_count()), 0);
  for (const std::vector<Index>& piece : elements_.topology.pieces()) {
    for (Index t : piece) body_of_[t] = static_cast<Index>(body_was_held_.size());
    body_was_held_.push_back(is_held(piece));
  }
}

// A piece that nothing holds is loose if its body was held, or if it is not the largest that is left of its
// body.
template <class Real>
Index World<Real>::treat_loose_pieces() {
  const std::vector<std::vector<Index>> pieces = elements_.topology.pieces();
  std::vector<std::size_t> largest(body_was_held_.size(), 0);
  for (const std::vector<Index>& piece : pieces)
    largest[body_of_[piece[0]]] = std::max(largest[body_of_[piece[0]]], piece.size());
  Index vanished = 0;
  for (const std::vector<Index>& piece : pieces) {
    const Index body = body_of_[piece[0]];
    if (is_held(piece) || (!body_was_held_[body] && piece.size() == largest[body])) continue;
    for (Index t : piece) body_of_[t] = static_cast<Index>(body_was_held_.size());
    body_was_held_.push_back(false);
    vanished += treat_loose_piece(piece);
  }
  return vanished;
}

template <class Real>
Index World<Real>::treat_loose_piece(const std::vector<Index>& piece) {
  const std::string text = std::to_string(piece.size()) + " tetrahedra came loose";
  pending_.push_back({Condition::Kind::pieces, text, state_.time});
  if (setup_.loose_pieces == LoosePieces::vanish) {
    follow(elements_.topology.remove(piece));
    return static_cast<Index>(piece.size());
  }
  if (setup_.loose_pieces == LoosePieces::fall) {
    set_region(piece, RegionModel::nonlinear);  // it will turn: a linear piece would grow
    return 0;
  }
  for (Index t : piece)
    for (int c = 0; c < 4; ++c) {
      const Index v = elements_.topology.tets()(c, t);
      const Vec3d u = state_.u.col(v).template cast<double>();
      held_.hold({v, HeldVertices::boundary, u, u});
      refresh_inverse_mass(v);
    }
  return 0;
}

template <class Real>
void World<Real>::check_tets(const std::vector<Index>& tets) const {
  for (Index t : tets)
    if (t < 0 || t >= elements_.topology.tet_count())
      throw InputError("tetrahedron " + std::to_string(t),
                       "there are " + std::to_string(elements_.topology.tet_count()) + ", numbered from 0");
}

template <class Real>
Setup World<Real>::current_setup(CompactMesh& c) const {
  c = compact(elements_.topology, elements_.points, elements_.labels);
  Setup setup = setup_;
  setup.mesh = c.mesh;
  setup.material_of.clear();
  setup.region_of.clear();
  for (Index t : c.tet_source) {
    setup.material_of.push_back(elements_.material_of[t]);
    setup.region_of.push_back(elements_.region_of[t]);
  }
  setup.prescribed.clear();
  for (const HeldVertices::Held& item : held_.all())
    if (c.vertex_target[item.vertex] >= 0)
      setup.prescribed.push_back({c.vertex_target[item.vertex], item.goal});
  std::erase_if(setup.face_loads, [&](const FaceLoad& load) { return c.tet_target[load.tet] < 0; });
  for (FaceLoad& load : setup.face_loads) load.tet = c.tet_target[load.tet];
  std::erase_if(setup.vertex_loads, [&](const VertexLoad& load) { return c.vertex_target[load.vertex] < 0; });
  for (VertexLoad& load : setup.vertex_loads) load.vertex = c.vertex_target[load.vertex];
  setup.grasps.clear();
  setup.cauteries.clear();
  return setup;
}

template class World<float>;
template class World<double>;

}  // namespace lobe
