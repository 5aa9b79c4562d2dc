// Cuts of an Organ, and the body that is left as a setup.
#include <algorithm>
#include <cmath>

#include "lobe/error.h"
#include "lobe/organ/hinges.h"
#include "lobe/organ/organ.h"

namespace lobe {
namespace {

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

}  // namespace

// ---- Cuts

template <class Real>
Index Organ<Real>::remove_tets(const std::vector<Index>& tets) {
  check_tets(tets);
  if (std::none_of(tets.begin(), tets.end(), [&](Index t) { return elements().topology.alive(t); })) return 0;
  grant({Moment::tets_go, tets});
  const MeshEdit made = cut(tets);
  if (made.empty()) return 0;
  const auto removed = static_cast<Index>(made.removed.size());
  change_region(hinged_tets(body_.model, made), RegionModel::nonlinear);
  const Index vanished = treat_loose(pieces_.loosened_by(body_.model, made));
  if (elements().topology.alive_count() == 0)
    notice(Condition::Kind::everything_cut, "no tetrahedron is left");
  return removed + vanished;
}

template <class Real>
MeshEdit Organ<Real>::cut(const std::vector<Index>& tets) {
  const Change change = edit({.velocities = true, .followers = true}, [&] {
    const MeshEdit removed = body_.model.elements.topology.remove(tets);
    if (removed.empty()) return Change{};
    blades_.forget(removed.removed);
    return Change{.mesh = removed, .entry = RemoveTets{removed.removed}};
  });
  return change.mesh.value_or(MeshEdit{});
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
  edit({.velocities = true, .followers = true}, [&] {
    Change change;
    for (Index t : piece)
      for (Index v : elements().topology.corners(t)) change.frozen.push_back(v);
    for (Index v : change.frozen) {
      const Vec3d u = body_.motion.u.col(v).template cast<double>();
      body_.model.held.hold({v, HeldVertices::boundary, u, u});
    }
    return change;
  });
}

template <class Real>
void Organ<Real>::check_tets(const std::vector<Index>& tets) const {
  for (Index t : tets)
    if (t < 0 || t >= elements().topology.tet_count())
      throw InputError("tetrahedron " + std::to_string(t),
                       "there are " + std::to_string(elements().topology.tet_count()) + ", numbered from 0");
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
  setup.pressures.clear();
  setup.carriers.clear();
  static_cast<ForceSetups&>(setup) = {};
  for (const auto& term : body_.terms) term->add_to_setup(body, c, setup);
  setup.cut_frequency = std::sqrt(body_.inertia.floor().square);
  std::erase_if(setup.vertex_loads, [&](const VertexLoad& load) { return c.vertex_target[load.vertex] < 0; });
  for (VertexLoad& load : setup.vertex_loads) load.vertex = c.vertex_target[load.vertex];
  static_cast<ToolSetups&>(setup) = {};
  return setup;
}

}  // namespace lobe
