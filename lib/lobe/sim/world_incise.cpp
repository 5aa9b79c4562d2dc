// Blades in a World.
#include <algorithm>
#include <array>
#include <cmath>

#include "lobe/error.h"
#include "lobe/scalpel/grain_cells.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/hinges.h"

namespace lobe {
namespace {

bool is_held_by_one(const HeldVertices& held, const std::array<Index, 3>& vertices) {
  std::array<int, 3> holders{};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!held.holds(vertices[i])) return false;
    holders[i] = held.holder_of(vertices[i]);
  }
  return holders[0] == holders[1] && holders[1] == holders[2];
}

}  // namespace

template <class Real>
Blades& World<Real>::blades() {
  if (!blades_) {
    prepare_blades();
    blades_ = std::move(prepared_);
    begin_floor();
    journal_.edits.push_back(Incise{});
    display_.rebuild(elements(), grains());
  }
  return *blades_;
}

// Makes ahead of the first cut, because it takes longer than a frame: the grains, the groups of tetrahedra
// for its search, and what the mass floor needs.
template <class Real>
void World<Real>::prepare_blades() {
  if (blades_ || prepared_) return;
  prepared_ = std::make_unique<Blades>(elements());
  tools_.meeting(elements().topology, elements().points.padded(), body_.motion.u.padded(), {});
  if (has_floor()) body_.inertia.prepare_floor(elements());
}

// Sets the mass floor, so that the stable step of the cut body is not much shorter than that of the whole
// one.
template <class Real>
void World<Real>::begin_floor() {
  const double omega = limit_.highest_at_rest();
  if (!has_floor() || body_.inertia.floor().square > 0 || !(omega > 0)) return;
  const double highest = omega / setup_.cut_step;
  body_.inertia.set_floor({highest * highest, setup_.expandable});
}

template <class Real>
Blades::BodyNow World<Real>::body_now() {
  see_interior();
  const auto placement = [this](Index t) {
    const Elements& body = elements();
    const Eigen::Vector4i corners = body.topology.corners(t);
    const Mat34<double> u = body_.motion.u.padded()(Eigen::all, corners).template cast<double>();
    const Mat3<double> alpha = body.shape_of(t).gradients.template rightCols<3>();
    const Vec3d start = body.points.col(corners[0]);
    return Placement{start, start + u.col(0), Mat3<double>::Identity() + displacement_gradient(u, alpha)};
  };
  const auto tets_in = [this](const SweptVolume& volume) {
    return tools_.meeting(elements().topology, elements().points.padded(), body_.motion.u.padded(), volume);
  };
  const auto corners = [this](Index t) {
    const Eigen::Vector4i v = elements().topology.corners(t);
    return Mat34<double>(elements().corner_points(t) +
                         body_.motion.u.padded()(Eigen::all, v).template cast<double>());
  };
  return {placement, tets_in, corners};
}

// A frame of a recording. If its cuts do not fit the grains, the world goes back to its start.
template <class Real>
void World<Real>::perform(const Advance& command) {
  if (command.cuts.empty()) {
    advance(command.duration);
    return;
  }
  const Checkpoint<Real> start = save();
  decided_ = command.cuts;
  try {
    advance(command.duration);
    if (cuts_.size() != decided_.size()) throw InputError("frame", "has cuts of more blades than move in it");
  } catch (const InputError&) {
    decided_ = {};
    journal_.edits.push_back(Superseded{});  // so that the grains are made again
    restore(start);
    throw;
  }
  decided_ = {};
}

// What the next move has cut in a frame that is repeated. Null: the blade decides.
template <class Real>
const BladeCut* World<Real>::decided_cut() const {
  if (decided_.empty()) return nullptr;
  if (cuts_.size() == decided_.size()) throw InputError("frame", "has cuts of fewer blades than move in it");
  return &decided_[cuts_.size()];
}

// Grains are cut step by step. Tetrahedra are divided once, after the last step: until then a tetrahedron is
// where its parts will be, and a step asks only where the tissue is.
template <class Real>
void World<Real>::incise(const BladeMove& move, Report& report) {
  blades();  // the first move makes them
  const BladeCut* decided = decided_cut();
  BladeMove whole = move;
  whole.from = decided ? decided->from : blades_->start_of(move, body_now());
  expand_ahead(whole);
  const auto steps = decided ? Blades::steps(whole, decided->steps.size()) : blades_->steps(whole);
  BladeCut cut{whole.from, {}};
  Index crumbs = 0;
  std::vector<Incision> incisions;
  std::vector<Index> opened;
  for (const BladeMove& step : steps) {
    std::optional<Incised> incised = decided ? blades_->repeat(decided->steps[cut.steps.size()], body_now())
                                             : blades_->cut(step, body_now());
    if (!incised) break;
    if (incised->refused > 0)
      notice(Condition::Kind::scalpel, std::to_string(incised->refused) +
                                           " edges were not cut: a tetrahedron has at most " +
                                           std::to_string(most_grains) + " grains");
    crumbs += incised->crumbs;
    for (const Incision* made : {&incised->caught_up, &incised->incision})
      if (!made->empty()) incisions.push_back(*made);
    opened.insert(opened.end(), incised->opened.begin(), incised->opened.end());
    report.cut_area += incised->area;
    tools_.cut_by(move.tool, work_of(*incised), incised->way, step.to.tip);
    cut.steps.push_back({std::move(incised->caught_up), std::move(incised->incision), incised->way,
                         incised->crumbs, incised->refused});
  }
  if (cut.steps.empty()) notice(Condition::Kind::scalpel, "more than 32 blades cut at once: one waits");
  cuts_.push_back(std::move(cut));
  if (!incisions.empty()) {
    journal_.edits.push_back(Incise{std::move(incisions)});
    const MeshEdit edit = divide(opened);
    report.tets_copied += static_cast<Index>(edit.copies.size());
    report.tets_removed += settle(edit);
  }
  if (crumbs > 0)
    notice(Condition::Kind::scalpel, std::to_string(crumbs) +
                                         " crumbs stay attached by a face each, since they are "
                                         "below a thousandth of a tetrahedron; nothing to do");
}

// To edit a condensed region costs milliseconds per tetrahedron. So an expandable one is expanded before a
// blade reaches it. Reduced tetrahedra near the blade become non-linear.
template <class Real>
void World<Real>::expand_ahead(const BladeMove& move) {
  const Regions<Real>& regions = body_.regions;
  const bool may_expand = setup_.expandable && !regions.is_expanded() && regions.any_condensed();
  if (!may_expand && !regions.reduced().any()) return;
  Eigen::AlignedBox3d box(move.from.tip);
  for (const Vec3d& end : {move.from.heel, move.to.tip, move.to.heel}) box.extend(end);
  const Vec3d reach = Vec3d::Constant(3 * blades_->grains.mean_edge());
  const std::vector<Index> near = body_now().tets_in({{box.min() - reach, box.max() + reach}, {}, {}});
  if (may_expand && std::any_of(near.begin(), near.end(), [&](Index t) { return regions.is_condensed(t); }))
    perform(Expand{});
  free_ahead(near);
}

// The work that opened the faces.
template <class Real>
CutWork World<Real>::work_of(const Incised& incised) const {
  CutWork work;
  for (const Incised::Face& face : incised.faces) {
    const double energy = face.area / 2 *
                          (elements().elastic_of(face.element).fracture_energy +
                           elements().elastic_of(face.neighbour).fracture_energy);
    work.energy += energy;
    work.moment += energy * face.middle;
  }
  return work;
}

// Divides these tetrahedra where faces next to them were opened.
template <class Real>
MeshEdit World<Real>::divide(const std::vector<Index>& opened) {
  if (opened.empty()) {
    follow_with_surface({});
    return {};
  }
  state();  // velocities stay half a step old: the next step has the forces of the cut body
  Topology& topology = body_.model.elements.topology;
  MeshEdit edit = topology.divide(blades_->grains.divide(topology, opened));
  if (edit.empty())
    follow_with_surface(edit);  // faces were opened, but nothing has come apart yet
  else
    follow(edit);
  return edit;
}

template <class Real>
void World<Real>::follow_with_surface(const MeshEdit& edit) {
  display_.follow(elements(), blades_ ? &blades_->grains : nullptr, edit);
}

// Of a vertex and its copy only one that lies in the tissue stays held. The other is only a corner of
// tetrahedra whose part lies elsewhere.
template <class Real>
void World<Real>::hold_what_is_filled(const MeshEdit& edit) {
  std::vector<Index> empty;
  for (const VertexSplit& split : edit.splits)
    for (Index v : {split.vertex, split.copy})
      if (held().holds(v) && !blades_->grains.fills(v, elements()) && !lies_on_held_boundary(v))
        empty.push_back(v);
  for (Index v : empty) body_.model.held.free(v);
}

// Whether a vertex belongs to a boundary face that one holder holds at all three corners.
template <class Real>
bool World<Real>::lies_on_held_boundary(Index v) const {
  const Topology& topology = elements().topology;
  for (Index t : topology.around(v)) {
    const Eigen::Vector4i corners = topology.corners(t);
    for (int f = 0; f < 4; ++f) {
      const int* c = face_corners[f];
      if (corners[f] == v || !is_held_by_one(held(), {corners[c[0]], corners[c[1]], corners[c[2]]})) continue;
      if (blades_->grains.boundary_share_of(t, f, elements()).sum() > 0) return true;
    }
  }
  return false;
}

// Divides the load on a face among its parts.
template <class Real>
void World<Real>::share_loads(const MeshEdit& edit) {
  for (const TetShare& tet_share : edit.shares)
    for (int f : body_.loads.dead_loads().loaded_faces(elements().topology.parent(tet_share.tet)))
      body_.loads.dead_loads().set_weights(tet_share.tet, f,
                                           blades_->grains.boundary_share_of(tet_share.tet, f, elements()));
}

// Treats what has come apart. Returns how many tetrahedra vanished.
template <class Real>
Index World<Real>::settle(const MeshEdit& edit) {
  if (edit.empty()) return 0;
  if (const std::vector<Index> hinged = hinged_tets(body_.model, edit); !hinged.empty())
    change_region(hinged, RegionModel::nonlinear);
  const auto loose = pieces_.loosened_by(body_.model, edit);
  if (loose.empty()) return 0;
  synchronise_velocities();
  return treat_loose(loose);
}

// Repeats a cut without its consequences.
template <class Real>
MeshEdit World<Real>::repeat_incisions(const Incise& command) {
  Grains& grains = blades().grains;
  std::vector<Index> opened;
  for (const Incision& incision : command.incisions) {
    divide_again(incision, grains);
    const std::vector<Index> beside = grains.open(incision.opened, incision.stroke);
    opened.insert(opened.end(), beside.begin(), beside.end());
  }
  if (!command.is_empty()) journal_.edits.push_back(command);
  return divide(opened);
}

// Tries the cut on a copy first, so that an invalid command changes nothing.
template <class Real>
void World<Real>::perform(const Incise& command) {
  Grains trial = blades().grains;
  for (const Incision& incision : command.incisions) {
    divide_again(incision, trial);
    trial.open(incision.opened, incision.stroke);
  }
  settle(repeat_incisions(command));
}

}  // namespace lobe
