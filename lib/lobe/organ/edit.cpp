// Cuts of an Organ, and how its parts follow an edit around what changed.
#include <algorithm>
#include <cmath>

#include "lobe/assert.h"
#include "lobe/condense/supports.h"
#include "lobe/error.h"
#include "lobe/forces/pressure.h"
#include "lobe/forces/threads.h"
#include "lobe/organ/hinges.h"
#include "lobe/organ/organ.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

// What a cut means for the regions: the tetrahedra that went, have a copied vertex or another share, and all
// vertices of these, old and new.
RegionEdit region_edit_of(const MeshEdit& cut, const Topology& topology, Index vertices_before) {
  RegionEdit edit;
  edit.left = cut.removed;
  for (const VertexSplit& split : cut.splits) {
    edit.entered.insert(edit.entered.end(), split.tets.begin(), split.tets.end());
    edit.vertices.push_back(split.vertex);
    edit.copied.emplace_back(split.vertex, split.copy);
  }
  for (const TetShare& tet_share : cut.shares) edit.entered.push_back(tet_share.tet);
  for (Index v = vertices_before; v < topology.vertex_count(); ++v) edit.vertices.push_back(v);
  sort_unique(edit.entered);
  edit.left.insert(edit.left.end(), edit.entered.begin(), edit.entered.end());
  std::vector<bool> is_listed(std::size_t(topology.vertex_count()), false);
  for (Index v : edit.vertices) is_listed[std::size_t(v)] = true;
  for (Index t : edit.left)
    for (Index v : topology.corners(t)) {
      if (!is_listed[std::size_t(v)]) edit.vertices.push_back(v);
      is_listed[std::size_t(v)] = true;
    }
  sort_unique(edit.vertices);
  return edit;
}

// The present shares of tetrahedra that get another one; 0 for new copies.
std::vector<double> shares_of(const Elements& elements, const MeshEdit& edit) {
  Index first_new = elements.topology.tet_count();
  for (const TetCopy& copy : edit.copies) first_new = std::min(first_new, copy.copy);
  std::vector<double> shares;
  for (const TetShare& tet_share : edit.shares)
    shares.push_back(tet_share.tet >= first_new ? 0 : elements.share_of(tet_share.tet));
  return shares;
}

Index first_copy(const Topology& topology) { return topology.tet_count() - topology.tet_copy_count(); }

// Loads on faces of tetrahedra that are left, and of their copies.
std::vector<FaceLoad> loads_of_parts(const std::vector<FaceLoad>& loads, const DeadLoads& now,
                                     const Topology& topology, const CompactMesh& c) {
  std::vector<FaceLoad> found;
  for (const FaceLoad& load : loads)
    for (Index t = load.tet; t < topology.tet_count(); t = std::max(t + 1, first_copy(topology)))
      if (topology.parent(t) == load.tet && c.tet_target[t] >= 0)
        found.push_back({c.tet_target[t], load.face, load.traction, now.weights(t, load)});
  return found;
}

// What presses on faces of tetrahedra that are left, and of their copies.
template <class Real>
std::vector<FacePressure> pressures_now(const Dynamics<Real>& body, const CompactMesh& c) {
  std::vector<FacePressure> found;
  for (const auto& term : body.terms)
    if (term->name() == Pressure<Real>::term_name)
      for (const FacePressure& load : static_cast<const Pressure<Real>&>(*term).faces())
        if (c.tet_target[load.tet] >= 0) found.push_back({c.tet_target[load.tet], load.face, load.pressure});
  return found;
}

// Stitches whose bites are all left. They are sewn anew.
template <class Real>
std::vector<StitchSetup> stitches_now(const Dynamics<Real>& body, const CompactMesh& c) {
  std::vector<StitchSetup> found;
  for (const auto& term : body.terms)
    if (term->name() == Threads<Real>::term_name)
      for (StitchSetup stitch : static_cast<const Threads<Real>&>(*term).stitches(body.model.elements)) {
        for (EmbeddedPoint& bite : stitch.bites) bite.tet = c.tet_target[bite.tet];
        found.push_back(std::move(stitch));
      }
  return found;
}

// Strands whose ends are left, as damaged as they are.
template <class Real>
std::vector<AttachmentSetup> attachments_now(const Dynamics<Real>& body, const CompactMesh& c) {
  std::vector<AttachmentSetup> found;
  for (const auto& term : body.terms)
    if (term->name() == Attachments<Real>::term_name)
      found = static_cast<const Attachments<Real>&>(*term).as_setup();
  for (AttachmentSetup& attachment : found)
    for (StrandSetup& strand : attachment.strands)
      for (EmbeddedPoint* end : {&strand.from, &strand.to})
        if (end->tet >= 0) end->tet = c.tet_target[end->tet];
  return found;
}

}  // namespace

// ---- Cuts

template <class Real>
Index Organ<Real>::remove_tets(const std::vector<Index>& tets) {
  check_tets(tets);
  if (std::none_of(tets.begin(), tets.end(), [&](Index t) { return elements().topology.alive(t); })) return 0;
  free_ahead(tets);
  const MeshEdit edit = cut(tets);
  if (edit.empty()) return 0;
  const auto removed = static_cast<Index>(edit.removed.size());
  change_region(hinged_tets(body_.model, edit), RegionModel::nonlinear);
  const Index vanished = treat_loose(pieces_.loosened_by(body_.model, edit));
  if (elements().topology.alive_count() == 0)
    notice(Condition::Kind::everything_cut, "no tetrahedron is left");
  return removed + vanished;
}

template <class Real>
MeshEdit Organ<Real>::cut(const std::vector<Index>& tets) {
  synchronise();
  MeshEdit edit = body_.model.elements.topology.remove(tets);
  if (edit.empty()) return edit;
  blades_.forget(edit.removed);
  follow(edit);
  journal_.edits.push_back(RemoveTets{edit.removed});
  return edit;
}

template <class Real>
void Organ<Real>::follow(const MeshEdit& edit) {
  Elements& elements = body_.model.elements;
  Motion<Real>& motion = body_.motion;
  blades_.forget_prepared();
  const Index before = motion.u.count();
  const std::vector<double> shares_before = shares_of(elements, edit);
  elements.follow(edit);
  pieces_.follow(edit);
  for (const TetCopy& copy : edit.copies) groups_.add_copy(copy.tet, copy.copy);
  motion.extend(elements.topology.vertex_count());
  for (const VertexSplit& split : edit.splits) {
    lobe_assert(split.copy >= before && split.copy < motion.u.count(),
                "a copy of a vertex is not a new vertex");
    motion.u.col(split.copy) = motion.u.col(split.vertex);
    motion.v.col(split.copy) = motion.v.col(split.vertex);
    body_.model.held.split(split.vertex, split.copy);
  }
  if (!edit.shares.empty()) {
    blades_.hold_what_is_filled(edit, body_.model);
    blades_.share_loads(edit, elements, body_.loads.dead_loads());
  }
  limit_.follow(body_, edit, shares_before);
  follow_with_surface(edit);
  display_.tell(elements.topology, edit);
  for (const auto& term : body_.terms) {
    term->follow(elements.topology, edit);
    if (grains()) term->follow_grains(elements, *grains(), edit);
  }
  follow(region_edit_of(edit, elements.topology, before));
}

// Treats loose pieces as the setup says. Returns how many tetrahedra vanished.
template <class Real>
Index Organ<Real>::treat_loose(const std::vector<std::vector<Index>>& pieces) {
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
void Organ<Real>::freeze(const std::vector<Index>& piece) {
  body_.recover_followers();
  std::vector<Index> vertices;
  for (Index t : piece)
    for (Index v : elements().topology.corners(t)) vertices.push_back(v);
  for (Index v : vertices) {
    const Vec3d u = body_.motion.u.col(v).template cast<double>();
    body_.model.held.hold({v, HeldVertices::boundary, u, u});
  }
  update_inverse_masses(vertices);
  body_.regions.holds_have_changed();
  embed();
}

template <class Real>
void Organ<Real>::check_tets(const std::vector<Index>& tets) const {
  for (Index t : tets)
    if (t < 0 || t >= elements().topology.tet_count())
      throw InputError("tetrahedron " + std::to_string(t),
                       "there are " + std::to_string(elements().topology.tet_count()) + ", numbered from 0");
}

// ---- What follows an edit

// Every part follows an edit, in this order.
template <class Real>
void Organ<Real>::follow(RegionEdit edit) {
  add_unsupported(edit);
  body_.regions.follow(elements(), edit);
  update_vertices_apart(edit.vertices);
  const std::vector<Index> mechanism = body_.regions.follow_condensed(body_.model, edit, body_.loads);
  if (body_.regions.is_expanded()) {
    update_vertices(edit.vertices);
  } else if (body_.regions.condensed_has_changed()) {
    find_carried();
    take_over(edit.vertices);
    update_inverse_masses(edit.vertices);
  }
  ++body_.model.revisions.structure;
  if (body_.regions.any_condensed()) ++body_.model.revisions.condensed;
  body_.sleep.wake(edit.vertices, body_);
  if (!body_.terms.empty()) report_lost_forces(body_.acted_on_by_terms());
  if (!mechanism.empty()) follow(change_of_region(mechanism, RegionModel::nonlinear));
  embed();
}

// Adds parts of the pre-computed region that nothing holds in place after an edit. They will turn, so they
// become non-linear.
template <class Real>
void Organ<Real>::add_unsupported(RegionEdit& edit) {
  if (std::none_of(edit.left.begin(), edit.left.end(),
                   [&](Index t) { return body_.regions.is_condensed(t); }))
    return;
  const std::vector<Index> tets = unsupported_tets(elements(), held());
  if (tets.empty()) return;
  const RegionEdit change = change_of_region(tets, RegionModel::nonlinear);
  for (auto list : {&RegionEdit::left, &RegionEdit::entered, &RegionEdit::vertices}) {
    (edit.*list).insert((edit.*list).end(), (change.*list).begin(), (change.*list).end());
    sort_unique(edit.*list);
  }
  notice(Condition::Kind::pieces,
         std::to_string(tets.size()) + " precomputed tetrahedra are no longer held and became nonlinear");
}

// Computes masses and loads of these vertices from the tetrahedra around them, as if nothing were condensed
// and nothing followed a lattice. take_over() must follow, unless nothing of a region is condensed there.
template <class Real>
void Organ<Real>::update_masses(const std::vector<Index>& vertices) {
  body_.inertia.update(body_.model, vertices);
  body_.loads.update(elements(), vertices, [this](Index v) { return body_.inertia.weighs(v); });
}

// In the middle of an edit, which the condensed region has not followed yet.
template <class Real>
void Organ<Real>::update_vertices_apart(const std::vector<Index>& vertices) {
  const Topology& topology = elements().topology;
  body_.motion.extend(topology.vertex_count());
  body_.sleep.extend(topology.vertex_count(), time());
  limit_.extend(topology.vertex_count());
  update_masses(vertices);
  body_.regions.raise_masses(vertices, body_.inertia.masses());
  for (Index v : vertices)
    if (topology.around(v).empty()) body_.motion.v.col(v).setZero();
  update_inverse_masses(vertices);
}

template <class Real>
void Organ<Real>::update_vertices(const std::vector<Index>& vertices) {
  update_vertices_apart(vertices);
  take_over(vertices);
}

// Call it when masses of vertices have changed, or what holds them.
template <class Real>
void Organ<Real>::update_inverse_masses(const std::vector<Index>& vertices) {
  for (Index v : vertices) {
    body_.inertia.update_inverse(body_.model, v);
    limit_.update(body_, v);
  }
}

// Of these vertices, those of a condensed region get the masses and loads with which it moves.
template <class Real>
void Organ<Real>::take_over(const std::vector<Index>& vertices) {
  const std::vector<Index> taken =
      body_.regions.take_over(elements(), vertices, body_.inertia.masses(), body_.loads);
  body_.inertia.raise_to_floor(body_.model, taken);
  update_inverse_masses(taken);
}

// The condensed region has changed, and carries other masses everywhere at its interface.
template <class Real>
void Organ<Real>::find_carried() {
  body_.regions.find_carried(elements());
  take_over(body_.regions.shared());
}

// ---- The present body

template <class Real>
Setup Organ<Real>::current_setup(CompactMesh& c) const {
  const Elements& body = elements();
  c = compact(body.topology, body.points.view(), body.labels);
  Setup setup = setup_;
  setup.mesh = c.mesh;
  setup.mesh.bodies.names = body.bodies.names;
  if (body.fibres.cols() > 0) setup.mesh.fibres = body.fibres(Eigen::all, c.tet_source);
  setup.material_of.clear();
  setup.region_of.clear();
  setup.shares.clear();
  for (Index t : c.tet_source) {
    setup.material_of.push_back(body.material_of[t]);
    setup.region_of.push_back(body.region_of[t]);
    if (body.bodies.any()) setup.mesh.bodies.of.push_back(body.bodies.of[t]);
    if (!body.shares.empty()) setup.shares.push_back(body.shares[t]);
  }
  setup.prescribed.clear();
  for (const HeldVertices::Held& item : held().all()) {
    const bool grasped = item.holder != HeldVertices::boundary;
    const Vec3d goal = grasped ? body_.motion.u.col(item.vertex).template cast<double>() : item.goal;
    if (c.vertex_target[item.vertex] >= 0)
      setup.prescribed.push_back({c.vertex_target[item.vertex], goal, item.axes});
  }
  setup.partly_held.clear();
  for (const HeldVertices::Held& item : held().partly()) {
    const bool grasped = item.holder != HeldVertices::boundary;
    const Vec3d goal = grasped ? body_.hold_springs.target(item) : item.goal;
    if (c.vertex_target[item.vertex] >= 0)
      setup.partly_held.push_back({c.vertex_target[item.vertex], item.share, goal, item.axes});
  }
  setup.face_loads = loads_of_parts(setup_.face_loads, body_.loads.dead_loads(), body.topology, c);
  setup.pressures = pressures_now(body_, c);
  setup.stitches = stitches_now(body_, c);
  setup.attachments = attachments_now(body_, c);
  setup.cut_frequency = std::sqrt(body_.inertia.floor().square);
  std::erase_if(setup.vertex_loads, [&](const VertexLoad& load) { return c.vertex_target[load.vertex] < 0; });
  for (VertexLoad& load : setup.vertex_loads) load.vertex = c.vertex_target[load.vertex];
  static_cast<ToolSetups&>(setup) = {};
  return setup;
}

}  // namespace lobe
