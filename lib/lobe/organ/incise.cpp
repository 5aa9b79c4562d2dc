// Blades in an Organ.
#include <algorithm>
#include <cmath>

#include "lobe/organ/hinges.h"
#include "lobe/organ/organ.h"
#include "lobe/scalpel/grain_cells.h"

namespace lobe {

template <class Real>
void Organ<Real>::prepare_blades() {
  if (!blades_.prepare(elements())) return;
  meeting_as_seen({});
  if (has_floor()) body_.inertia.prepare_floor(elements());
}

// Called before each cut by a blade.
template <class Real>
void Organ<Real>::start_blades() {
  if (grains()) return;
  prepare_blades();
  blades_.start();
  begin_floor();
  journal_.edits.push_back(Incise{});
  display_.rebuild(elements(), grains());
}

// Sets the mass floor, so that the stable step of the cut body is not much shorter than that of the whole
// one.
template <class Real>
void Organ<Real>::begin_floor() {
  const double omega = limit_.highest_at_rest();
  if (!has_floor() || body_.inertia.floor().square > 0 || !(omega > 0)) return;
  const double highest = omega / setup_.cut_step;
  body_.inertia.set_floor({highest * highest, body_.regions.model_without_steps()});
}

template <class Real>
Blades::BodyNow Organ<Real>::body_now() {
  see_interior();
  const auto placement = [this](Index t) {
    const Elements& body = elements();
    const Eigen::Vector4i corners = body.topology.corners(t);
    const Mat34<double> u = body_.motion.u.padded()(Eigen::all, corners).template cast<double>();
    const Mat3<double> alpha = body.shape_of(t).gradients.template rightCols<3>();
    const Vec3d start = body.points.col(corners[0]);
    return Placement{start, start + u.col(0), Mat3<double>::Identity() + displacement_gradient(u, alpha)};
  };
  const auto tets_in = [this](const SweptVolume& volume) { return meeting_as_seen(volume); };
  const auto corners = [this](Index t) {
    const Eigen::Vector4i v = elements().topology.corners(t);
    return Mat34<double>(elements().corner_points(t) +
                         body_.motion.u.padded()(Eigen::all, v).template cast<double>());
  };
  return {placement, tets_in, corners};
}

// Grains are cut step by step. Tetrahedra are divided once, after the last step.
template <class Real>
typename Organ<Real>::Cut Organ<Real>::cut(const BladeMove& move) {
  start_blades();
  const BladeMove whole = blades_.whole(move, body_now());
  make_way(whole);
  Cut made{blades_.cut(whole, body_now())};
  Index crumbs = 0;
  std::vector<Index> opened;
  std::vector<Incision> incisions;
  for (const BladeWork::Step& step : made.steps) {
    const Incised& incised = step.incised;
    if (incised.refused > 0)
      notice(Condition::Kind::scalpel, std::to_string(incised.refused) +
                                           " edges were not cut: a tetrahedron has at most " +
                                           std::to_string(most_grains) + " grains");
    crumbs += incised.crumbs;
    opened.insert(opened.end(), incised.opened.begin(), incised.opened.end());
    made.area += incised.area;
    for (const Incision* incision : {&incised.caught_up, &incised.incision})
      if (!incision->empty()) incisions.push_back(*incision);
  }
  for (const std::string& text : blades_.unfit(move, !incisions.empty(), elements(), body_now()))
    notice(Condition::Kind::scalpel, text);
  if (made.steps.empty())
    notice(Condition::Kind::scalpel,
           "32 other blades cut: this one waits until one of them stops or is lifted");
  if (!incisions.empty()) {
    journal_.edits.push_back(Incise{std::move(incisions)});
    const MeshEdit edit = divide(opened);
    made.copied = static_cast<Index>(edit.copies.size());
    made.removed = settle(edit);
  }
  if (crumbs > 0)
    notice(Condition::Kind::scalpel, std::to_string(crumbs) +
                                         " crumbs stay attached by a face each, since they are "
                                         "below a thousandth of a tetrahedron; nothing to do");
  return made;
}

template <class Real>
Index Organ<Real>::burn(const SweptVolume& volume) {
  see_interior();
  std::vector<Index> burnt = meeting_as_seen(volume);
  if (grains()) blades_.keep_filled(volume, elements(), body_now(), burnt);
  note_burnt(burnt);
  return remove_tets(burnt);
}

// Before they are gone.
template <class Real>
void Organ<Real>::note_burnt(const std::vector<Index>& tets) {
  if (tets.empty()) return;
  Event event{Event::Kind::burnt, time()};
  Vec3d centre = Vec3d::Zero();
  for (const Index t : tets) {
    const Eigen::Vector4i corners = elements().topology.corners(t);
    const Mat34<double> x =
        elements().corner_points(t) + body_.motion.u.padded()(Eigen::all, corners).template cast<double>();
    const double volume = elements().shape_of(t).volume;
    event.size += volume;
    centre += volume * x.rowwise().mean();
  }
  event.place = centre / event.size;
  unreported_.events.push_back(std::move(event));
}

// Lets regions that a blade comes near change before it cuts them.
template <class Real>
void Organ<Real>::make_way(const BladeMove& move) {
  if (!body_.regions.heeds_blades()) return;
  Eigen::AlignedBox3d box(move.from.tip);
  for (const Vec3d& end : {move.from.heel, move.to.tip, move.to.heel}) box.extend(end);
  const Vec3d reach = Vec3d::Constant(3 * grains()->mean_edge());
  grant({Moment::blade_comes, body_now().tets_in({{box.min() - reach, box.max() + reach}, {}, {}})});
}

// Divides these tetrahedra where faces next to them were opened.
template <class Real>
MeshEdit Organ<Real>::divide(const std::vector<Index>& opened) {
  // Velocities stay half a step old: the next step has the forces of the cut body. With own steps they are of
  // several times, and levels are chosen anew.
  const Before before{.velocities = body_.any_own_steps(), .followers = !opened.empty()};
  const Change change = edit(before, [&] {
    Topology& topology = body_.model.elements.topology;
    return Change{.mesh = opened.empty() ? MeshEdit{} : topology.divide(blades_.parts_of(topology, opened))};
  });
  return *change.mesh;
}

// Treats what has come apart. Returns how many tetrahedra vanished.
template <class Real>
Index Organ<Real>::settle(const MeshEdit& edit) {
  if (edit.empty()) return 0;
  if (const std::vector<Index> hinged = hinged_tets(body_.model, edit); !hinged.empty())
    change_region(hinged, RegionModel::nonlinear);
  const auto loose = pieces_.loosened_by(body_.model, edit);
  return treat_loose(loose);
}

// Makes incisions without their consequences.
template <class Real>
MeshEdit Organ<Real>::make_again(const std::vector<Incision>& incisions) {
  start_blades();
  const std::vector<Index> opened = blades_.open(incisions);
  const Incise entry{incisions};
  if (!entry.is_empty()) journal_.edits.push_back(entry);
  return divide(opened);
}

template <class Real>
void Organ<Real>::incise(const std::vector<Incision>& incisions) {
  prepare_blades();
  blades_.check(incisions);  // so that what does not fit changes nothing
  settle(make_again(incisions));
}

}  // namespace lobe
