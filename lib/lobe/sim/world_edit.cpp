// Edits of a World: everything follows a cut or a change of regions around what changed.
#include <algorithm>

#include "lobe/condense/anchors.h"
#include "lobe/error.h"
#include "lobe/sim/world.h"

namespace lobe {
namespace {

void make_unique(std::vector<Index>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

// What a cut means for the regions: the tetrahedra that went or have a copied vertex, and all vertices of these, old and new.
RegionEdit region_edit_of(const MeshEdit& cut, const Topology& topology, Index vertices_before) {
  RegionEdit edit;
  edit.left = cut.removed;
  for (const VertexSplit& split : cut.splits) {
    edit.entered.insert(edit.entered.end(), split.tets.begin(), split.tets.end());
    edit.vertices.push_back(split.vertex);
  }
  for (Index v = vertices_before; v < topology.vertex_count(); ++v) edit.vertices.push_back(v);
  make_unique(edit.entered);
  edit.left.insert(edit.left.end(), edit.entered.begin(), edit.entered.end());
  for (Index t : edit.left)
    for (Index v : topology.corners(t)) edit.vertices.push_back(v);
  make_unique(edit.vertices);
  return edit;
}

}  // namespace

template <class Real>
void World<Real>::apply(const Command& command) {
  std::visit([&](const auto& own) { perform(own); }, command);
}

// ---- Cuts

template <class Real>
Index World<Real>::remove_tets(const std::vector<Index>& tets) {
  check_tets(tets);
  if (std::none_of(tets.begin(), tets.end(), [&](Index t) { return elements().topology.alive(t); })) return 0;
  const MeshEdit edit = cut(tets);
  if (edit.empty()) return 0;
  const auto removed = static_cast<Index>(edit.removed.size());
  const Index vanished = treat_loose(pieces_.loosened_by(body_.model, edit));
  if (elements().topology.alive_count() == 0)
    notice(Condition::Kind::everything_cut, "no tetrahedron is left");
  return removed + vanished;
}

template <class Real>
MeshEdit World<Real>::cut(const std::vector<Index>& tets) {
  catch_up();
  state();
  MeshEdit edit = body_.model.elements.topology.remove(tets);
  if (edit.empty()) return edit;
  follow(edit);
  history_.push_back(RemoveTets{edit.removed});
  return edit;
}

template <class Real>
void World<Real>::follow(const MeshEdit& edit) {
  Elements& elements = body_.model.elements;
  Motion<Real>& motion = body_.motion;
  const Index before = motion.u.count();
  elements.points.extend(elements.topology.vertex_count());
  motion.extend(elements.topology.vertex_count());
  for (const VertexSplit& split : edit.splits) {
    elements.points.col(split.copy) = elements.points.col(split.vertex);
    motion.u.col(split.copy) = motion.u.col(split.vertex);
    motion.v.col(split.copy) = motion.v.col(split.vertex);
    body_.model.held.split(split.vertex, split.copy);
    body_.inertia.copy(split.vertex, split.copy);
  }
  limit_.follow(body_, edit);
  if (surface_) surface_->follow(elements.topology, edit, elements.region_of);
  for (const CutObserver& observer : cut_observers_) observer(elements.topology, edit);
  for (const auto& term : body_.terms) term->follow(elements.topology, edit);
  follow(region_edit_of(edit, elements.topology, before));
}

// What came loose; how many tetrahedra vanished.
template <class Real>
Index World<Real>::treat_loose(const std::vector<std::vector<Index>>& pieces) {
  Index vanished = 0;
  for (const std::vector<Index>& piece : pieces) {
    notice(Condition::Kind::pieces, std::to_string(piece.size()) + " tetrahedra came loose");
    switch (setup_.loose_pieces) {
      case LoosePieces::vanish:
        cut(piece);
        vanished += static_cast<Index>(piece.size());
        break;
      case LoosePieces::fall:
        change_region(piece, RegionModel::nonlinear);  // it will turn: a linear piece would grow
        break;
      case LoosePieces::stay:
        freeze(piece);
    }
  }
  return vanished;
}

template <class Real>
void World<Real>::freeze(const std::vector<Index>& piece) {
  std::vector<Index> vertices;
  for (Index t : piece)
    for (Index v : elements().topology.corners(t)) vertices.push_back(v);
  for (Index v : vertices) {
    const Vec3d u = body_.motion.u.col(v).template cast<double>();
    body_.model.held.hold({v, HeldVertices::boundary, u, u});
  }
  release(vertices);
}

// ---- Regions

template <class Real>
void World<Real>::perform(const SetRegion& command) {
  check_tets(command.tets);
  if (command.model == RegionModel::precomputed) refuse_precomputed(command.tets);
  std::vector<Index> own = command.tets;
  make_unique(own);
  std::erase_if(own, [&](Index t) { return !elements().topology.alive(t); });
  unravelling_.leave_alone(own);
  if (std::all_of(own.begin(), own.end(), [&](Index t) { return elements().region_of[t] == command.model; }))
    return;
  change_region(command.tets, command.model);
}

template <class Real>
void World<Real>::refuse_precomputed(const std::vector<Index>& tets) const {
  if (implicit_)
    throw InputError("region", "the implicit integrator has no precomputed regions; use tensor-mass");
  if (setup_.mass_scaling > 0)
    throw InputError("region", "mass scaling is not available beside precomputed regions; use tensor-mass");
  Elements changed = elements();
  for (Index t : tets) changed.region_of[t] = RegionModel::precomputed;
  refuse_unanchored(changed, held());
  body_.regions.refuse_large(changed, held());
}

template <class Real>
void World<Real>::change_region(const std::vector<Index>& tets, RegionModel model) {
  catch_up();
  state();
  RegionEdit edit = change_of_region(tets, model);
  if (edit.left.empty()) return;
  history_.push_back(SetRegion{edit.left, model});
  follow(std::move(edit));
}

template <class Real>
RegionEdit World<Real>::change_of_region(const std::vector<Index>& tets, RegionModel model) {
  RegionEdit edit;
  Elements& elements = body_.model.elements;
  for (Index t : tets) {
    if (!elements.topology.alive(t) || elements.region_of[t] == model) continue;
    limit_.follow_region(body_, t, [&] { elements.region_of[t] = model; });
    edit.left.push_back(t);
    for (Index v : elements.topology.corners(t)) edit.vertices.push_back(v);
  }
  if (surface_) surface_->follow_regions(edit.left, elements.region_of);
  edit.entered = edit.left;
  make_unique(edit.vertices);
  return edit;
}

// Every part follows an edit, in this order.
template <class Real>
void World<Real>::follow(RegionEdit edit) {
  add_unanchored(edit);
  body_.regions.follow(elements(), edit);
  refresh(edit.vertices);
  const std::vector<Index> mechanism = body_.regions.follow_condensed(body_.model, edit, body_.loads);
  if (const std::string text = body_.regions.take_notice(); !text.empty())
    notice(Condition::Kind::cache, text);
  if (body_.regions.is_expanded()) {
    refresh(edit.vertices);
  } else if (body_.regions.condensed_has_changed()) {
    move_mass();
    release(edit.vertices);
  }
  ++body_.model.revisions.structure;
  if (body_.regions.any_condensed()) limit_.forget();
  body_.sleep.wake(edit.vertices, body_);
  if (!body_.terms.empty()) report_lost_forces(body_.touched_by_terms());
  if (!mechanism.empty()) follow(change_of_region(mechanism, RegionModel::nonlinear));
}

// What nothing keeps in place within the precomputed region after an edit will turn: it becomes non-linear.
template <class Real>
void World<Real>::add_unanchored(RegionEdit& edit) {
  if (std::none_of(edit.left.begin(), edit.left.end(),
                   [&](Index t) { return body_.regions.is_condensed(t); }))
    return;
  const std::vector<Index> tets = unanchored_tets(elements(), held());
  if (tets.empty()) return;
  const RegionEdit change = change_of_region(tets, RegionModel::nonlinear);
  for (auto list : {&RegionEdit::left, &RegionEdit::entered, &RegionEdit::vertices}) {
    (edit.*list).insert((edit.*list).end(), (change.*list).begin(), (change.*list).end());
    make_unique(edit.*list);
  }
  notice(Condition::Kind::pieces,
         std::to_string(tets.size()) + " precomputed tetrahedra are no longer held and became nonlinear");
}

// Masses and loads of these vertices, as the tetrahedra around them give them.
template <class Real>
void World<Real>::refresh(const std::vector<Index>& vertices) {
  const Topology& topology = elements().topology;
  body_.motion.extend(topology.vertex_count());
  body_.sleep.extend(topology.vertex_count(), time());
  limit_.extend(topology.vertex_count());
  body_.inertia.refresh(body_.model, vertices);
  body_.loads.refresh(elements(), vertices, mass());
  for (Index v : vertices)
    if (topology.around(v).empty()) body_.motion.v.col(v).setZero();
  release(vertices);
}

// Their masses or holds have changed.
template <class Real>
void World<Real>::release(const std::vector<Index>& vertices) {
  for (Index v : vertices) {
    body_.inertia.release(body_.model, v);
    limit_.refresh(body_, v);
  }
}

// The mass of a condensed interior goes to its shared vertices.
template <class Real>
void World<Real>::move_mass() {
  release(body_.regions.move_mass(elements(), body_.inertia.masses()));
}

template <class Real>
void World<Real>::perform(const TakeHold& command) {
  for (Index v : command.vertices)
    if (v < 0 || v >= elements().topology.vertex_count())
      throw InputError(
          "vertex " + std::to_string(v),
          "there are " + std::to_string(elements().topology.vertex_count()) + ", numbered from 0");
  if (command.vertices.empty()) throw InputError("grasp", "needs at least one vertex");
  tools_.add(Grasp{.name = command.name, .vertices = command.vertices, .path = {}});
}

template <class Real>
void World<Real>::perform(const BringCautery& command) {
  tools_.add(
      Cautery{.name = command.name, .radius = command.radius, .strokes = {}, .position = command.position});
}

// ---- Forces from outside

// It is among the terms from the first time on that somebody asks for it.
template <class Real>
AppliedForces<Real>& World<Real>::applied() {
  for (const auto& term : body_.terms)
    if (auto* own = dynamic_cast<AppliedForces<Real>*>(term.get())) return *own;
  auto own = std::make_shared<AppliedForces<Real>>();
  body_.terms.push_back(own);
  return *own;
}

template <class Real>
void World<Real>::add(std::shared_ptr<ForceTerm<Real>> term) {
  if (implicit_) throw InputError("force term", "the implicit integrator has none but external forces");
  const bool is_known = std::any_of(body_.terms.begin(), body_.terms.end(),
                                    [&](const auto& own) { return own->name() == term->name(); });
  if (is_known) throw InputError("force term", "there is one of the name \"" + term->name() + "\" already");
  body_.terms.push_back(std::move(term));
  terms_have_changed({});
}

template <class Real>
void World<Real>::perform(const SetForces& command) {
  AppliedForces<Real>().set(command.forces,
                            elements().topology.vertex_count());  // throws before anything changes
  const std::vector<Index> before = body_.touched_by_terms();
  catch_up();
  applied().set(command.forces, elements().topology.vertex_count());
  terms_have_changed(before);
}

template <class Real>
void World<Real>::perform(const SetSprings& command) {
  if (implicit_) throw InputError("springs", "are available with the explicit integrator only");
  AppliedForces<Real>().set(command.springs,
                            elements().topology.vertex_count());  // throws before anything changes
  const std::vector<Index> before = body_.touched_by_terms();
  catch_up();
  applied().set(command.springs, elements().topology.vertex_count());
  terms_have_changed(before);
}

// What they act on now, and did before, wakes; the step limit has to do with their stiffness.
template <class Real>
void World<Real>::terms_have_changed(const std::vector<Index>& touched_before) {
  const std::vector<Index> now = body_.touched_by_terms();
  body_.sleep.wake(touched_before, body_);
  body_.sleep.wake(now, body_);
  limit_.forget();
  ++body_.model.revisions.structure;
  report_lost_forces(now);
}

// The interior of a condensed region follows its interface: a force on it would act on nothing.
template <class Real>
void World<Real>::report_lost_forces(const std::vector<Index>& touched) {
  if (body_.regions.is_expanded()) return;
  for (Index v : touched)
    if (body_.regions.is_interior(v))
      return notice(
          Condition::Kind::lost_force,
          "a force on vertex " + std::to_string(v) +
              ", in the interior of a precomputed region, has no effect: expand the region, make it "
              "tensor-mass, or take hold of the vertex");
}

// Somebody has taken hold of vertices, or let go.
template <class Real>
void World<Real>::perform(const Hold& command) {
  RegionEdit edit;
  for (const HeldVertices::Held& item : held().all()) edit.vertices.push_back(item.vertex);
  for (const HeldVertices::Held& item : command.held.all()) edit.vertices.push_back(item.vertex);
  make_unique(edit.vertices);
  body_.model.held = command.held;
  if (body_.regions.any_condensed()) history_.push_back(command);
  follow(std::move(edit));
}

// ---- Precomputed regions that are condensed afresh, linearised anew, and non-linear for a while (theory, section 14)

template <class Real>
void World<Real>::perform(const BeginRefresh& command) {
  body_.regions.begin_refresh(elements(), command.due,
                              command.about ? *command.about : std::vector<double>{});
  history_.push_back(command);
}

template <class Real>
void World<Real>::perform(const EndRefresh& command) {
  catch_up();
  body_.regions.end_refresh(elements());
  if (!body_.regions.is_expanded()) move_mass();
  ++body_.model.revisions.structure;
  limit_.forget();
  history_.push_back(command);
}

template <class Real>
void World<Real>::perform(const Renew& command) {
  if (!(command.delay > 0)) throw InputError("region", "the delay of its renewal must be above 0 s");
  if (body_.regions.is_refreshing() || !body_.regions.any_condensed()) return;
  const Mat3X<double> u = displacements().template cast<double>();
  perform(BeginRefresh{time() + command.delay,
                       std::make_shared<std::vector<double>>(u.data(), u.data() + u.size())});
}

template <class Real>
void World<Real>::perform(const Expand& command) {
  if (!setup_.expandable) throw InputError("region", "the setup does not say that it may be expanded");
  if (body_.regions.is_expanded() || !body_.regions.any_condensed()) return;
  catch_up();
  state();
  set_expanded(true);
  history_.push_back(command);
}

template <class Real>
void World<Real>::perform(const Condense& command) {
  if (!body_.regions.is_expanded()) return;
  if (!body_.regions.can_condense())
    throw InputError("region",
                     "it was edited while it was expanded, and must be renewed before it is condensed");
  catch_up();
  set_expanded(false);
  history_.push_back(command);
}

template <class Real>
void World<Real>::set_expanded(bool is_expanded) {
  body_.regions.set_expanded(is_expanded);
  if (body_.inertia.may_be_selective())  // also around those that are held
    for (Index t = 0; t < elements().topology.tet_count(); ++t)
      if (body_.regions.is_condensed(t)) {
        const Eigen::Vector4i corners = elements().topology.corners(t);
        body_.inertia.add_edits({corners.begin(), corners.end()});
      }
  const std::vector<Index> vertices = body_.regions.condensed_vertices(elements().topology.vertex_count());
  refresh(vertices);
  if (!is_expanded) {
    body_.regions.take_over_loads(body_.loads);
    move_mass();
    release(vertices);
  }
  body_.sleep.wake_all(time());
  if (!body_.terms.empty()) report_lost_forces(body_.touched_by_terms());
  limit_.restart(body_);
  ++body_.model.revisions.structure;
}

// ---- Inertia

template <class Real>
void World<Real>::perform(const SetMassDegree& command) {
  body_.inertia.check_degree(command.degree);
  body_.inertia.ask_for(command.degree);
  if (!unravelling_.is_lumped()) use_mass_degree(command.degree);
}

template <class Real>
void World<Real>::use_mass_degree(int degree) {
  const int before = body_.inertia.degree_now();
  if (degree == before) return;
  catch_up();
  body_.inertia.use(degree);
  if (degree > before) {
    body_.prepare_inertia();
    body_.inertia.slow_short_waves(body_.parallel, body_.motion);
  }
  limit_.restart_for_degree(body_);
  ++body_.model.revisions.velocities;
}

// ---- What it has become

template <class Real>
void World<Real>::check_tets(const std::vector<Index>& tets) const {
  for (Index t : tets)
    if (t < 0 || t >= elements().topology.tet_count())
      throw InputError("tetrahedron " + std::to_string(t),
                       "there are " + std::to_string(elements().topology.tet_count()) + ", numbered from 0");
}

template <class Real>
Setup World<Real>::current_setup(CompactMesh& c) const {
  const Elements& own = elements();
  c = compact(own.topology, own.points.view(), own.labels);
  Setup setup = setup_;
  setup.mesh = c.mesh;
  setup.material_of.clear();
  setup.region_of.clear();
  for (Index t : c.tet_source) {
    setup.material_of.push_back(own.material_of[t]);
    setup.region_of.push_back(own.region_of[t]);
  }
  setup.prescribed.clear();
  for (const HeldVertices::Held& item : held().all()) {
    const bool grasped = item.holder != HeldVertices::boundary;
    const Vec3d goal = grasped ? body_.motion.u.col(item.vertex).template cast<double>() : item.goal;
    if (c.vertex_target[item.vertex] >= 0)
      setup.prescribed.push_back({c.vertex_target[item.vertex], goal, item.axes});
  }
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
