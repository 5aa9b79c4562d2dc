// Blades in a World.
#include "lobe/error.h"
#include "lobe/scalpel/grain_cells.h"
#include "lobe/setup/exclusions.h"
#include "lobe/sim/world.h"

namespace lobe {

template <class Real>
Blades& World<Real>::blades() {
  if (!blades_) {
    refuse_excluded(Option::scalpel, options_of(setup_), "scalpel");
    blades_ = std::make_unique<Blades>(elements());
    journal_.edits.push_back(Incise{});
    display_.rebuild(elements(), grains());
  }
  return *blades_;
}

template <class Real>
Blades::BodyNow World<Real>::body_now() {
  see_interior();
  const auto placement = [this](Index t) {
    const Elements& own = elements();
    const Eigen::Vector4i corners = own.topology.corners(t);
    const Mat34<double> u = body_.motion.u.padded()(Eigen::all, corners).template cast<double>();
    const Mat3<double> alpha = own.shape_of(t).gradients.template rightCols<3>();
    const Vec3d start = own.points.col(corners[0]);
    return Placement{start, start + u.col(0), Mat3<double>::Identity() + displacement_gradient(u, alpha)};
  };
  const auto tets_in = [this](const Eigen::AlignedBox3d& box) {
    return tools_.meeting(elements().topology, elements().points.padded(), body_.motion.u.padded(), {box});
  };
  return {placement, tets_in};
}

template <class Real>
void World<Real>::incise(const BladeMove& move, Report& report) {
  BladeMove whole = move;
  whole.from = blades().start_of(move, body_now());
  const int steps = blades_->steps(whole);
  BladeMove step = whole;
  for (int i = 1; i <= steps; ++i) {
    const double share = double(i) / steps;
    step.to = {whole.from.tip + share * (whole.to.tip - whole.from.tip),
               whole.from.heel + share * (whole.to.heel - whole.from.heel)};
    const std::optional<Incised> incised = blades_->cut(step, body_now());
    step.from = step.to;
    if (!incised) return notice(Condition::Kind::scalpel, "more than 32 blades cut at once: one waits");
    if (incised->refused > 0)
      notice(Condition::Kind::scalpel, std::to_string(incised->refused) + " edges were not cut: there are " +
                                           std::to_string(most_grains) + " grains in a tetrahedron already");
    if (incised->incision.empty()) continue;
    journal_.edits.push_back(Incise{incised->incision});
    report.cut_area += incised->area;
    const MeshEdit edit = divide(incised->opened);
    report.tets_copied += static_cast<Index>(edit.copies.size());
    if (!edit.empty()) report.tets_removed += treat_loose(pieces_.loosened_by(body_.model, edit));
  }
}

// What has been opened beside these tetrahedra.
template <class Real>
MeshEdit World<Real>::divide(const std::vector<Index>& opened) {
  if (opened.empty()) {
    follow_with_surface({});
    return {};
  }
  catch_up();
  state();
  Topology& topology = body_.model.elements.topology;
  MeshEdit edit = topology.divide(blades_->grains.divide(topology, opened));
  if (edit.empty())
    follow_with_surface(edit);  // it has been opened, and nothing has come apart yet
  else
    follow(edit);
  return edit;
}

template <class Real>
void World<Real>::follow_with_surface(const MeshEdit& edit) {
  display_.follow(elements(), blades_ ? &blades_->grains : nullptr, edit);
}

// Of a vertex and its copy only those are held on to which lie in the tissue: the other is a corner of
// tetrahedra of which there is a part elsewhere.
template <class Real>
void World<Real>::hold_what_is_filled(const MeshEdit& edit) {
  for (const VertexSplit& split : edit.splits)
    for (Index v : {split.vertex, split.copy})
      if (held().holds(v) && !blades_->grains.fills(v, elements())) body_.model.held.free(v);
}

// As it was done, without what followed from it.
template <class Real>
MeshEdit World<Real>::repeat_incision(const Incise& command) {
  Blades& own = blades();
  if (!own.grains.can_bisect(command.incision.bisections))
    throw InputError("incision", "names a point that there is not, or divides an edge at its end");
  own.grains.bisect(command.incision.bisections);
  if (!own.grains.can_open(command.incision.opened))
    throw InputError("incision", "opens a face that there is not");
  if (!command.incision.empty()) journal_.edits.push_back(command);
  return divide(own.grains.open(command.incision.opened));
}

template <class Real>
void World<Real>::perform(const Incise& command) {
  const MeshEdit edit = repeat_incision(command);
  if (!edit.empty()) treat_loose(pieces_.loosened_by(body_.model, edit));
}

}  // namespace lobe
