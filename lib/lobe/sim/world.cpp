#include "lobe/sim/world.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "lobe/error.h"
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

void check(const Setup& setup) {
  std::vector<Fault> faults;
  const auto tets = std::size_t(setup.mesh.tet_count());
  if (tets == 0) faults.push_back({"setup", "the mesh has no tetrahedron"});
  if (setup.material_of.size() != tets || setup.region_of.size() != tets || setup.mesh.labels.size() != tets)
    faults.push_back({"setup", "materials, regions and labels must have one entry per tetrahedron"});
  for (std::uint16_t m : setup.material_of)
    if (m >= setup.materials.size()) {
      faults.push_back({"setup", "material number out of range"});
      break;
    }
  for (const Elastic& e : setup.materials)
    if (!(e.mu > 0) || !(3 * e.lambda + 2 * e.mu > 0) || !(e.density > 0))
      faults.push_back({"setup", "a material needs mu > 0, 3 lambda + 2 mu > 0 and density > 0"});
  if (std::count(setup.region_of.begin(), setup.region_of.end(), RegionModel::precomputed))
    faults.push_back({"setup", "precomputed regions are not available yet; use tensor-mass"});
  if (!(setup.volume_penalty >= 0) || !(setup.damping >= 0) || !(setup.safety > 0 && setup.safety <= 1))
    faults.push_back({"setup", "volume penalty and damping must not be negative, safety in (0, 1]"});
  if (!faults.empty()) throw InputError(std::move(faults));
}

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
    : setup_((check(setup), setup)),
      elements_(setup),
      nonlinear_(setup.evaluator),
      tools_(setup),
      parallel_(threads) {
  const Index n = elements_.topology.vertex_count();
  state_.u = Mat3X<Real>::Zero(3, n);
  state_.v = state_.u;
  floating_ = setup.prescribed.empty();
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
  const double vertex = highest_vertex().omega;
  if (vertex > 0) frequency_ratio_ = std::max(1.0, lanczos_frequency(elements_, inverse_mass_) / vertex);
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
  Report report;
  play_tools(duration, report);
  {
    const Timed timed(report, Phase::time_step);
    report.time_step_limit = time_step_limit();
  }
  report.smallest_volume_ratio = volume_ratio_;
  if (volume_ratio_ < 0.05)
    report.conditions.push_back({Condition::Kind::near_inversion,
                                 "tetrahedron " + std::to_string(volume_ratio_tet_) + " is at " +
                                     std::to_string(volume_ratio_) + " of its volume: raise volume_penalty",
                                 state_.time});
  constexpr int most_steps = 1 << 20, most_tries = 5;
  const double wanted = std::ceil(duration / (setup_.safety * report.time_step_limit) * (1 - 1e-12));
  int steps = static_cast<int>(std::clamp(wanted, 1.0, double(most_steps)));
  const State<Real> start = state_;
  for (int attempt = 0; attempt < most_tries; ++attempt, steps *= 2) {
    report.time_step = duration / steps;
    if (run_steps(steps, report.time_step, report)) {
      if (attempt > 0)
        report.conditions.push_back(
            {Condition::Kind::sub_stepped,
             "the frame needed " + std::to_string(1 << attempt) + " times smaller steps", start.time});
      return report;
    }
    state_ = start;
    if (steps > most_steps / 2) break;
  }
  report.ok = false;
  report.conditions.push_back(
      {Condition::Kind::diverged,
       "no step down to " + std::to_string(report.time_step) +
           " s was stable; the state before it is kept. Use a smaller load or tool speed, "
           "more damping, or a volume_penalty",
       state_.time});
  return report;
}

template <class Real>
void World<Real>::play_tools(double duration, Report& report) {
  const Timed timed(report, Phase::cutting);
  const auto displacement = [&](Index v) -> Vec3d { return state_.u.col(v).template cast<double>(); };
  if (tools_.update_grasps(state_.time, held_, displacement))
    for (Index v = 0; v < elements_.topology.vertex_count(); ++v) refresh_inverse_mass(v);
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
  const double omega = frequency_ratio_ * highest_vertex().omega;
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

// Pieces that nothing holds. If nothing was fixed from the start, the largest piece is the body.
template <class Real>
Index World<Real>::treat_loose_pieces() {
  std::vector<std::vector<Index>> pieces = elements_.topology.pieces();
  if (pieces.size() < 2) return 0;
  const auto largest = std::max_element(pieces.begin(), pieces.end(),
                                        [](const auto& a, const auto& b) { return a.size() < b.size(); });
  if (floating_) pieces.erase(largest);
  Index vanished = 0;
  for (const std::vector<Index>& piece : pieces) {
    if (is_held(piece)) continue;
    if (setup_.loose_pieces == LoosePieces::vanish) {
      follow(elements_.topology.remove(piece));
      vanished += static_cast<Index>(piece.size());
    } else if (setup_.loose_pieces == LoosePieces::fall) {
      set_region(piece, RegionModel::nonlinear);  // it will turn: a linear piece would grow
    } else {
      for (Index t : piece)
        for (int c = 0; c < 4; ++c) {
          const Index v = elements_.topology.tets()(c, t);
          const Vec3d u = state_.u.col(v).template cast<double>();
          held_.hold({v, HeldVertices::boundary, u, u});
          refresh_inverse_mass(v);
        }
    }
  }
  return vanished;
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
