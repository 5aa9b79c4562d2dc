#include "lobe/scalpel/blade_work.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "lobe/scalpel/far_move.h"
#include "lobe/text.h"

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

std::vector<Index> open_again(const std::vector<Incision>& incisions, Grains& grains) {
  std::vector<Index> opened;
  for (const Incision& incision : incisions) {
    divide_again(incision, grains);
    const std::vector<Index> beside = grains.open(incision.opened, incision.stroke);
    opened.insert(opened.end(), beside.begin(), beside.end());
  }
  return opened;
}

// Of the tetrahedra that a blade meets on its way, at rest [m]. None: it meets none.
std::optional<double> mean_edge_along(const BladeMove& move, const Elements& elements,
                                      const Blades::BodyNow& body) {
  const Sheet sheet({move.from.tip, move.from.heel}, {move.to.tip, move.to.heel});
  const auto is_met = [&](const auto& x) { return sheet.may_reach(x, 0); };
  double sum = 0;
  const std::vector<Index> met = body.tets_in({sheet.box(), is_met, is_met});
  for (Index t : met) {
    const Mat34<double> X = elements.corner_points(t);
    for (const auto& edge : edge_corners) sum += (X.col(edge[0]) - X.col(edge[1])).norm() / 6;
  }
  return met.empty() ? std::nullopt : std::optional(sum / double(met.size()));
}

bool is_in(const std::vector<int>& tools, int tool) {
  return std::find(tools.begin(), tools.end(), tool) != tools.end();
}

}  // namespace

bool BladeWork::prepare(const Elements& elements) {
  if (blades_ || prepared_) return false;
  prepared_ = std::make_unique<Blades>(elements);
  return true;
}

BladeMove BladeWork::whole(const BladeMove& move, const Blades::BodyNow& body) const {
  BladeMove whole = move;
  whole.from = blades_->start_of(move, body);
  return whole;
}

std::vector<BladeWork::Step> BladeWork::cut(const BladeMove& whole, const Blades::BodyNow& body) {
  std::vector<Step> steps;
  for (const BladeMove& move : blades_->steps(whole)) {
    std::optional<Incised> incised = blades_->cut(move, body);
    if (!incised) break;
    steps.push_back({std::move(*incised), move.to.tip});
  }
  return steps;
}

// A scene is warned of the same before it runs (scene/scalpel_kind.cpp).
std::vector<std::string> BladeWork::unfit(const BladeMove& move, bool has_cut, const Elements& elements,
                                          const Blades::BodyNow& body) {
  std::vector<std::string> texts;
  const double length = (move.to.heel - move.to.tip).norm(), edge = grains()->mean_edge();
  if (gone_.tool != move.tool) gone_ = {move.tool};
  gone_.way += std::max((move.to.tip - move.from.tip).norm(), (move.to.heel - move.from.heel).norm());
  if (length < grains()->longest_edge() && !is_in(told_.narrow, move.tool)) {
    const std::optional<double> there = mean_edge_along(move, elements, body);
    if (there && length < *there) {
      told_.narrow.push_back(move.tool);
      texts.push_back("a blade of " + rounded(length) +
                      " m is shorter than the edges of the tetrahedra that it meets, " + rounded(*there) +
                      " m in the mean, and may open nothing. Remedy: a longer blade, a finer mesh there");
    }
  }
  if (gone_.way > far_move * edge && !is_in(told_.far, move.tool) && has_cut) {
    told_.far.push_back(move.tool);
    texts.push_back("a blade went " + rounded(gone_.way) + " m in a frame, more than three mean edges of " +
                    rounded(edge) +
                    " m, and cut the tissue where that was at the start of the frame. Remedy: shorter "
                    "frames, a slower blade");
  }
  return texts;
}

// Tries them on a copy.
void BladeWork::check(const std::vector<Incision>& incisions) const {
  Grains trial = (blades_ ? blades_ : prepared_)->grains;
  open_again(incisions, trial);
}

std::vector<Index> BladeWork::open(const std::vector<Incision>& incisions) {
  return open_again(incisions, blades_->grains);
}

void BladeWork::keep_filled(const SweptVolume& volume, const Elements& elements, const Blades::BodyNow& body,
                            std::vector<Index>& meeting) const {
  if (!blades_ || !volume.meets) return;
  std::vector<Index> divided;
  for (Index t : meeting)
    if (elements.share_of(t) < 1) divided.push_back(t);
  const PlacedTets placed(blades_->grains, divided, body.placement, body.corners);
  std::vector<Index> apart;  // in ascending order, as those that meet it
  for (const PlacedTets::Placed& tet : placed) {
    const auto own = placed.grains_of(tet);
    if (std::none_of(own.begin(), own.end(), [&](const auto& grain) { return volume.meets(grain.x); }))
      apart.push_back(tet.tet);
  }
  std::erase_if(meeting, [&](Index t) { return std::binary_search(apart.begin(), apart.end(), t); });
}

void BladeWork::hold_what_is_filled(const MeshEdit& edit, Model& model) const {
  std::vector<Index> empty;
  for (const VertexSplit& split : edit.splits)
    for (Index v : {split.vertex, split.copy})
      if (model.held.holds(v) && !blades_->grains.fills(v, model.elements) &&
          !lies_on_held_boundary(v, model))
        empty.push_back(v);
  for (Index v : empty) model.held.free(v);
}

// Whether a vertex belongs to a boundary face that one holder holds at all three corners.
bool BladeWork::lies_on_held_boundary(Index v, const Model& model) const {
  const Topology& topology = model.elements.topology;
  for (Index t : topology.around(v)) {
    const Eigen::Vector4i corners = topology.corners(t);
    for (int f = 0; f < 4; ++f) {
      const int* c = face_corners[f];
      if (corners[f] == v || !is_held_by_one(model.held, {corners[c[0]], corners[c[1]], corners[c[2]]}))
        continue;
      if (blades_->grains.boundary_share_of(t, f, model.elements).sum() > 0) return true;
    }
  }
  return false;
}

void BladeWork::share_loads(const MeshEdit& edit, const Elements& elements, DeadLoads& loads) const {
  for (const TetShare& share : edit.shares)
    for (int f : loads.loaded_faces(elements.topology.parent(share.tet)))
      loads.set_weights(share.tet, f, blades_->grains.boundary_share_of(share.tet, f, elements));
}

CutWork work_of(const Incised& incised, const Elements& elements) {
  CutWork work;
  for (const Incised::Face& face : incised.faces) {
    const double energy = face.area / 2 *
                          (elements.elastic_of(face.element).fracture_energy +
                           elements.elastic_of(face.neighbour).fracture_energy);
    work.energy += energy;
    work.moment += energy * face.middle;
  }
  return work;
}

}  // namespace lobe
