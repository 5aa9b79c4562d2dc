// Pieces finds which pieces of a body come loose by a cut.
#pragma once

#include "lobe/body/model.h"

namespace lobe {

class Pieces {
 public:
  struct State {  // part of a checkpoint
    // The piece to which each tetrahedron belonged at the start, or since; empty: all to piece 0.
    std::vector<Index> piece_of;
    std::vector<std::uint8_t> was_held;  // flag of each piece
    static constexpr auto fields = std::tuple(&State::piece_of, &State::was_held);
  };

  Pieces() = default;
  explicit Pieces(Model& model);

  bool was_held(Index tet) const { return state_.was_held[piece_of(tet)] != 0; }
  const State& state() const { return state_; }
  void set_state(const State& state) { state_ = state; }

  // Returns the pieces that an edit has set loose. A piece that nothing holds is loose if the piece that it
  // was cut from was held, or if a larger part of that one is left. All pieces that were judged are
  // remembered, so that a later cut judges only the pieces that it cuts.
  std::vector<std::vector<Index>> loosened_by(Model& model, const MeshEdit& edit);
  void follow(const MeshEdit& edit) {  // a copy belongs to the piece of its original
    if (state_.piece_of.empty()) return;
    for (const TetCopy& tet_copy : edit.copies) state_.piece_of.push_back(state_.piece_of[tet_copy.tet]);
  }
  // Returns the pieces that a grasp or a release has set loose.
  std::vector<std::vector<Index>> loosened(Model& model) {
    return judge(model, model.elements.topology.pieces());
  }

 private:
  Index piece_of(Index tet) const { return state_.piece_of.empty() ? 0 : state_.piece_of[tet]; }
  void add(const Model& model, const std::vector<Index>& piece, bool was_held);
  bool needs_all(Model& model, const MeshEdit& edit) const;
  std::vector<std::vector<Index>> to_judge(Model& model, const MeshEdit& edit) const;
  std::vector<std::vector<Index>> judge(const Model& model, const std::vector<std::vector<Index>>& pieces);

  State state_;
};

}  // namespace lobe
