#include "lobe/sim/scalpels.h"

#include <array>
#include <optional>
#include <utility>

#include "lobe/error.h"

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

}  // namespace

bool Scalpels::prepare(const Elements& elements) {
  if (blades_ || prepared_) return false;
  prepared_ = std::make_unique<Blades>(elements);
  return true;
}

BladeMove Scalpels::whole(const BladeMove& move, const Blades::BodyNow& body) const {
  if (!repeated_.empty() && has_repeated_all())
    throw InputError("frame", "has cuts of fewer blades than move in it");
  BladeMove whole = move;
  whole.from = repeated_.empty() ? blades_->start_of(move, body) : repeated_[cuts_.size()].from;
  return whole;
}

std::vector<Scalpels::Step> Scalpels::cut(const BladeMove& whole, BladeAhead ahead,
                                          const Blades::BodyNow& body) {
  const BladeCut* again = repeated_.empty() ? nullptr : &repeated_[cuts_.size()];
  const auto moves = again ? Blades::steps(whole, again->steps.size()) : blades_->steps(whole);
  BladeCut cut{whole.from, {}, {}, std::move(ahead)};
  std::vector<Step> steps;
  for (const BladeMove& move : moves) {
    std::optional<Incised> incised =
        again ? blades_->repeat(move, *again, steps.size(), body) : blades_->cut(move, body, &cut);
    if (!incised) break;
    steps.push_back({std::move(*incised), move.to.tip});
  }
  cuts_.push_back(again ? *again : std::move(cut));
  return steps;
}

// Tries them on a copy.
void Scalpels::check(const std::vector<Incision>& incisions) const {
  Grains trial = (blades_ ? blades_ : prepared_)->grains;
  open_again(incisions, trial);
}

std::vector<Index> Scalpels::open(const std::vector<Incision>& incisions) {
  return open_again(incisions, blades_->grains);
}

void Scalpels::hold_what_is_filled(const MeshEdit& edit, Model& model) const {
  std::vector<Index> empty;
  for (const VertexSplit& split : edit.splits)
    for (Index v : {split.vertex, split.copy})
      if (model.held.holds(v) && !blades_->grains.fills(v, model.elements) &&
          !lies_on_held_boundary(v, model))
        empty.push_back(v);
  for (Index v : empty) model.held.free(v);
}

// Whether a vertex belongs to a boundary face that one holder holds at all three corners.
bool Scalpels::lies_on_held_boundary(Index v, const Model& model) const {
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

void Scalpels::share_loads(const MeshEdit& edit, const Elements& elements, DeadLoads& loads) const {
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
