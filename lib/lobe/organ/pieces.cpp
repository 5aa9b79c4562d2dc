#include "lobe/organ/pieces.h"

#include <algorithm>
#include <map>

namespace lobe {
namespace {

bool is_held(const Model& model, Index tet) {
  const Eigen::Vector4i v = model.elements.topology.corners(tet);
  return std::any_of(v.begin(), v.end(), [&](Index corner) { return model.held.anchors(corner); });
}

bool is_held(const Model& model, const std::vector<Index>& piece) {
  return std::any_of(piece.begin(), piece.end(), [&](Index t) { return is_held(model, t); });
}

}  // namespace

Pieces::Pieces(Model& model) {
  for (const std::vector<Index>& piece : model.elements.topology.pieces())
    add(model, piece, is_held(model, piece));
}

void Pieces::add(const Model& model, const std::vector<Index>& piece, bool was_held) {
  if (!state_.was_held.empty()) state_.piece_of.resize(std::size_t(model.elements.topology.tet_count()), 0);
  if (!state_.piece_of.empty())
    for (Index t : piece) state_.piece_of[t] = static_cast<Index>(state_.was_held.size());
  state_.was_held.push_back(was_held);
}

// Whether an edit may have set more loose than the pieces that it has cut off. The rest of the body is held
// as before, unless these pieces took a vertex that holds it, or the tetrahedra around the last such vertex
// are gone. If there are held tetrahedra left, they are near, so the search for one is short.
bool Pieces::needs_all(Model& model, const MeshEdit& edit) const {
  Topology& topology = model.elements.topology;
  const auto gone = [&](Index v) { return model.held.anchors(v) && topology.around(v).empty(); };
  const bool lost_a_holder = std::any_of(edit.cut_off.begin(), edit.cut_off.end(),
                                         [&](const auto& p) { return is_held(model, p); }) ||
                             std::any_of(edit.removed.begin(), edit.removed.end(), [&](Index t) {
                               const Eigen::Vector4i corners = topology.corners(t);
                               return std::any_of(corners.begin(), corners.end(), gone);
                             });
  return lost_a_holder &&
         std::any_of(edit.next_to_removed.begin(), edit.next_to_removed.end(), [&](Index tet) {
           return was_held(tet) && !topology.visit_piece(tet, [&](Index t) { return is_held(model, t); });
         });
}

// The pieces to judge: those that were cut off. Of a body that nothing held from the start these are all its
// pieces, because the largest one stays the body.
std::vector<std::vector<Index>> Pieces::to_judge(Model& model, const MeshEdit& edit) const {
  std::vector<std::vector<Index>> pieces = edit.cut_off;
  const Index next_to_it = edit.next_to_removed.front();
  if (was_held(next_to_it)) return pieces;
  std::vector<Index>& other = pieces.emplace_back();
  model.elements.topology.visit_piece(next_to_it, [&](Index t) {
    other.push_back(t);
    return false;
  });
  return pieces;
}

std::vector<std::vector<Index>> Pieces::loosened_by(Model& model, const MeshEdit& edit) {
  if (needs_all(model, edit)) return loosened(model);
  if (edit.cut_off.empty()) return {};
  return judge(model, to_judge(model, edit));
}

std::vector<std::vector<Index>> Pieces::judge(const Model& model,
                                              const std::vector<std::vector<Index>>& pieces) {
  std::map<Index, std::size_t> largest_of;
  for (const std::vector<Index>& piece : pieces) {
    std::size_t& largest = largest_of[piece_of(piece[0])];
    largest = std::max(largest, piece.size());
  }
  std::vector<std::vector<Index>> loose;
  for (const std::vector<Index>& piece : pieces) {
    const bool held_before = was_held(piece[0]);
    const bool stays =
        is_held(model, piece) || (!held_before && piece.size() == largest_of[piece_of(piece[0])]);
    add(model, piece, stays && held_before);
    if (!stays) loose.push_back(piece);
  }
  return loose;
}

}  // namespace lobe
