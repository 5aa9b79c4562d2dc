#include "lobe/sim/checkpoint.h"

#include <algorithm>
#include <utility>

#include "lobe/error.h"
#include "lobe/io/sealed_file.h"

namespace lobe {
namespace {

class Fingerprint {
 public:
  template <class Value>
  void add(const Value& value) {
    writer_.put(value);
  }
  template <class Matrix>
  void add_matrix(const Matrix& values) {
    writer_.put_all(std::span(values.data(), std::size_t(values.size())));
  }
  template <class Value>
  void add_enums(const std::vector<Value>& values) {
    for (Value value : values) add(value);
  }
  void add_path(const std::vector<PathPoint>& path) {
    for (const PathPoint& point : path) {
      add(point.time);
      add_matrix(point.position);
    }
  }
  std::uint64_t value() const { return io::digest(writer_.bytes()); }

 private:
  io::ByteWriter writer_;
};

void add_body(Fingerprint& print, const Body& body) {
  print.add_matrix(body.mesh.points);
  print.add_matrix(body.mesh.tets);
  for (const Elastic& e : body.materials)
    for (double value : {e.lambda, e.mu, e.density, e.nodal_pressure}) print.add(value);
  print.add_enums(body.material_of);
  print.add_enums(body.region_of);
  print.add(body.precomputed_frame);
  print.add(body.volume_penalty);
  print.add(body.guard_below);
}

void add_boundary(Fingerprint& print, const Setup& setup) {
  for (const PrescribedVertex& p : setup.prescribed) {
    print.add(p.vertex);
    print.add_matrix(p.displacement);
    for (bool axis : p.axes) print.add(axis);
  }
  for (const FaceLoad& load : setup.face_loads) {
    print.add(4 * load.tet + load.face);
    print.add_matrix(load.traction);
  }
  for (const VertexLoad& load : setup.vertex_loads) {
    print.add(load.vertex);
    print.add_matrix(load.force);
  }
  print.add_matrix(setup.gravity);
}

void add_tools(Fingerprint& print, const Setup& setup) {
  for (const GraspSetup& grasp : setup.grasps) {
    print.add_enums(grasp.vertices);
    print.add_path(grasp.path);
    print.add(grasp.release);
  }
  for (const CauterySetup& cautery : setup.cauteries) {
    print.add(cautery.radius);
    print.add_path(cautery.path);
  }
}

}  // namespace

std::uint64_t fingerprint(const Setup& setup) {
  Fingerprint print;
  add_body(print, setup);
  add_boundary(print, setup);
  add_tools(print, setup);
  print.add(setup.evaluator);
  print.add(setup.loose_pieces);
  print.add(setup.integrator);
  print.add(setup.expandable);
  print.add(setup.selective_mass);
  for (double value : {setup.damping, setup.safety, setup.mass_scaling, setup.implicit_step,
                       setup.spectral_radius, setup.ramp, setup.load_ramp, setup.sleep})
    print.add(value);
  return print.value();
}

template <class Real>
Checkpoint<Real> World<Real>::save() const {
  Checkpoint<Real> c;
  c.setup = fingerprint_;
  c.history = history_;
  c.state = state();
  c.held = held_;
  c.grasps = tools_.grasp_states();
  c.body_of = body_of_;
  c.body_was_held.assign(body_was_held_.begin(), body_was_held_.end());
  c.sleep = sleep_.state();
  c.unravelling = unravelling_;
  c.ratios = ratios_;
  c.mass_degree = mass_degree_;
  c.implicit_is_stale = implicit_is_stale_;
  c.acceleration = acceleration_;
  c.pending = pending_;
  return c;
}

template <class Real>
void World<Real>::restore(const Checkpoint<Real>& c) {
  if (c.setup != fingerprint_) throw InputError("checkpoint", "is of another scene, mesh or version of them");
  if (c.history != history_) {  // what was removed does not grow back
    World fresh(initial_setup(), parallel_.threads());
    for (const Edit& edit : c.history) fresh.repeat(edit);
    fresh.check_fits(c);
    *this = std::move(fresh);
  }
  check_fits(c);
  mass_degree_ = c.mass_degree;
  selective_mass_.set_degree(c.unravelling.is_lumped ? 1 : c.mass_degree);
  set_state(c.state);
  sleep_.set_state(c.sleep);
  unravelling_ = c.unravelling;
  held_ = c.held;
  tools_.set_grasp_states(c.grasps);
  body_of_ = c.body_of;
  body_was_held_.assign(c.body_was_held.begin(), c.body_was_held.end());
  pending_ = c.pending;
  for (Index v = 0; v < elements_.topology.vertex_count(); ++v) refresh_inverse_mass(v);
  ratios_ = c.ratios;
  acceleration_ = c.acceleration;
  implicit_is_stale_ = c.implicit_is_stale;
}

// The mesh before all edits: no vertex has moved, and copies are what they were.
template <class Real>
Setup World<Real>::initial_setup() const {
  const Topology& now = elements_.topology;
  Setup setup = setup_;
  setup.mesh.points = elements_.points.view().leftCols(now.vertex_count() - now.copy_count());
  setup.mesh.tets = now.tets().unaryExpr([&](Index v) { return now.origin(v); });
  setup.mesh.labels = elements_.labels;
  setup.mesh.labels.resize(std::size_t(now.tet_count()), 0);
  setup.material_of = elements_.material_of;
  return setup;
}

template <class Real>
void World<Real>::repeat(const Edit& edit) {
  check_tets(edit.tets);
  for (const HeldVertices::Held& item : edit.held.all())
    if (item.vertex >= elements_.topology.vertex_count())
      throw InputError("checkpoint", "does not fit the scene that it says it is of");
  if (edit.kind == Edit::Kind::removal) cut(edit.tets);
  if (edit.kind == Edit::Kind::region) change_region(edit.tets, edit.model);
  if (edit.kind == Edit::Kind::held) refresh_held(std::exchange(held_, edit.held));
  const bool begins = edit.kind == Edit::Kind::begin_refresh, ends = edit.kind == Edit::Kind::end_refresh;
  const bool fits = edit.about.empty() || edit.about.size() == std::size_t(3 * state_.u.count());
  const bool has_region = precomputed_.tet_count() > 0 || ends;  // it may be cut away while it is condensed
  if ((begins || ends) && (ends != precomputed_.is_refreshing() || !has_region || !fits))
    throw InputError("checkpoint", "does not fit the scene that it says it is of");
  if (begins) begin_refresh(edit.due, edit.about);
  if (ends) end_refresh();
  if (edit.kind == Edit::Kind::expand) expand();
  if (edit.kind == Edit::Kind::condense) condense();
}

template <class Real>
void World<Real>::check_fits(const Checkpoint<Real>& c) const {
  const Index vertices = elements_.topology.vertex_count();
  const auto tets = std::size_t(elements_.topology.tet_count());
  const auto is_known = [&](Index body) { return body >= 0 && std::size_t(body) < c.body_was_held.size(); };
  const std::vector<int> degrees = mass_degrees();
  bool fits =
      std::count(degrees.begin(), degrees.end(), c.mass_degree) == 1 && c.state.u.cols() == vertices &&
      c.state.v.cols() == vertices && (c.body_of.empty() || c.body_of.size() == tets) &&
      c.grasps.size() == setup_.grasps.size() && c.sleep.asleep.size() == sleep_.state().asleep.size() &&
      c.sleep.restless_till.size() == c.sleep.asleep.size() && c.ratios.own.size() == std::size_t(vertices) &&
      (c.acceleration.size() == 0 ? c.implicit_is_stale : c.acceleration.cols() == vertices);
  fits = fits && is_known(0);
  for (Index body : c.body_of) fits = fits && is_known(body);
  for (Index t : c.unravelling.tets) fits = fits && t >= 0 && std::size_t(t) < tets;
  for (const HeldVertices::Held& item : c.held.all())
    fits = fits && item.vertex >= 0 && item.vertex < vertices && item.holder >= 0 &&
           std::size_t(item.holder) <= setup_.grasps.size();
  if (!fits) throw InputError("checkpoint", "does not fit the scene that it says it is of");
}

template <class Real>
void CheckpointRing<Real>::keep(const World<Real>& world) {
  if (!kept_.empty() && world.time() < kept_.back().state.time + apart_) return;
  if (kept_.size() == most_) kept_.pop_front();
  kept_.push_back(world.save());
}

template <class Real>
bool CheckpointRing<Real>::roll_back(World<Real>& world, double seconds) {
  const double latest = world.time() - seconds;
  while (!kept_.empty() && kept_.back().state.time > latest) kept_.pop_back();
  if (kept_.empty()) return false;
  world.restore(kept_.back());
  return true;
}

template Setup World<float>::initial_setup() const;
template Setup World<double>::initial_setup() const;
template Checkpoint<float> World<float>::save() const;
template Checkpoint<double> World<double>::save() const;
template void World<float>::restore(const Checkpoint<float>&);
template void World<double>::restore(const Checkpoint<double>&);
template void World<float>::repeat(const Edit&);
template void World<double>::repeat(const Edit&);
template void World<float>::check_fits(const Checkpoint<float>&) const;
template void World<double>::check_fits(const Checkpoint<double>&) const;
template class CheckpointRing<float>;
template class CheckpointRing<double>;

}  // namespace lobe
