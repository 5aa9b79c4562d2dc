// Pieces of a World that come loose: which they are, and what becomes of them.
#include <algorithm>
#include <map>

#include "lobe/sim/world.h"

namespace lobe {

template <class Real>
bool World<Real>::is_held(Index tet) const {
  const Eigen::Vector4i v = elements_.topology.corners(tet);
  return held_.holds(v[0]) || held_.holds(v[1]) || held_.holds(v[2]) || held_.holds(v[3]);
}

template <class Real>
bool World<Real>::is_held(const std::vector<Index>& piece) const {
  return std::any_of(piece.begin(), piece.end(), [&](Index t) { return is_held(t); });
}

template <class Real>
void World<Real>::find_bodies() {
  for (const std::vector<Index>& piece : elements_.topology.pieces()) add_body(piece, is_held(piece));
}

template <class Real>
void World<Real>::add_body(const std::vector<Index>& piece, bool was_held) {
  if (!body_was_held_.empty()) body_of_.resize(std::size_t(elements_.topology.tet_count()), 0);
  if (!body_of_.empty())
    for (Index t : piece) body_of_[t] = static_cast<Index>(body_was_held_.size());
  body_was_held_.push_back(was_held);
}

// Whether an edit may have set more loose than the body that it is known to have cut: what is left of it is held as
// before, unless its pieces took a vertex that holds it, or the tetrahedra around the last such vertex are gone. Held
// tetrahedra are near then, if there are any left: the search for one is short.
template <class Real>
bool World<Real>::needs_all_pieces(const MeshEdit& edit) {
  const auto gone = [&](Index v) { return held_.holds(v) && elements_.topology.around(v).empty(); };
  const bool lost_a_holder =
      std::any_of(edit.cut_off.begin(), edit.cut_off.end(), [&](const auto& p) { return is_held(p); }) ||
      std::any_of(edit.removed.begin(), edit.removed.end(), [&](Index t) {
        const Eigen::Vector4i corners = elements_.topology.corners(t);
        return std::any_of(corners.begin(), corners.end(), gone);
      });
  return lost_a_holder && std::any_of(edit.beside.begin(), edit.beside.end(), [&](Index tet) {
           return body_was_held_[body_of(tet)] &&
                  !elements_.topology.visit_piece(tet, [&](Index t) { return is_held(t); });
         });
}

// What was cut off; of a body that nothing held from the start all there is, since the largest piece stays the body.
template <class Real>
std::vector<std::vector<Index>> World<Real>::pieces_to_judge(const MeshEdit& edit) {
  std::vector<std::vector<Index>> pieces = edit.cut_off;
  const Index beside = edit.beside.front();
  if (body_was_held_[body_of(beside)]) return pieces;
  std::vector<Index>& other = pieces.emplace_back();
  elements_.topology.visit_piece(beside, [&](Index t) {
    other.push_back(t);
    return false;
  });
  return pieces;
}

// A piece that nothing holds is loose if its body was held, or if a larger one is left of its body. Every piece is a
// body of its own from then on, so that a later cut has to judge no others than those that it cuts.
template <class Real>
Index World<Real>::treat_loose_pieces(const std::vector<std::vector<Index>>& pieces) {
  std::map<Index, std::size_t> largest_of;
  for (const std::vector<Index>& piece : pieces) {
    std::size_t& largest = largest_of[body_of(piece[0])];
    largest = std::max(largest, piece.size());
  }
  Index vanished = 0;
  for (const std::vector<Index>& piece : pieces) {
    const Index body = body_of(piece[0]);
    const bool was_held = body_was_held_[body];
    const bool stays = is_held(piece) || (!was_held && piece.size() == largest_of[body]);
    add_body(piece, stays && was_held);
    if (!stays) vanished += treat_loose_piece(piece);
  }
  return vanished;
}

template <class Real>
Index World<Real>::treat_loose_piece(const std::vector<Index>& piece) {
  const std::string text = std::to_string(piece.size()) + " tetrahedra came loose";
  pending_.push_back({Condition::Kind::pieces, text, state_.time});
  if (setup_.loose_pieces == LoosePieces::vanish) {
    cut(piece);
    return static_cast<Index>(piece.size());
  }
  if (setup_.loose_pieces == LoosePieces::fall) {
    change_region(piece, RegionModel::nonlinear);  // it will turn: a linear piece would grow
    return 0;
  }
  for (Index t : piece)
    for (int c = 0; c < 4; ++c) {
      const Index v = elements_.topology.tets()(c, t);
      const Vec3d u = state_.u.col(v).template cast<double>();
      held_.hold({v, HeldVertices::boundary, u, u});
      refresh_inverse_mass(v);
    }
  return 0;
}

template class World<float>;
template class World<double>;

}  // namespace lobe
