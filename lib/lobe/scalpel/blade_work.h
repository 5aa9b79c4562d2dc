// The blades of a world: the grains into which they have cut its body, and what they cut in this frame.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lobe/body/model.h"
#include "lobe/scalpel/blades.h"
#include "lobe/scalpel/cut_work.h"

namespace lobe {

class BladeWork {
 public:
  const Grains* grains() const { return blades_ ? &blades_->grains : nullptr; }  // null: no blade has cut
  Grains* grains() { return blades_ ? &blades_->grains : nullptr; }

  // Makes the grains ahead of the first cut, because it takes longer than a frame. False if they are there
  // already.
  bool prepare(const Elements& elements);
  void forget_prepared() { prepared_.reset(); }  // call it when the mesh is no longer what it was
  void start() { blades_ = std::move(prepared_); }

  // ---- Cuts of a frame

  void begin_frame() { gone_ = {}; }
  // Ends the strokes that did not go on in this frame.
  void end_strokes() {
    if (blades_) blades_->end_strokes();
  }
  // The move from where its edge really starts: tissue may have carried it along.
  BladeMove whole(const BladeMove& move, const Blades::BodyNow& body) const;
  struct Step {
    Incised incised;
    Vec3d tip = Vec3d::Zero();  // tip of the blade at its end [m]
  };
  // Performs a whole move. It cuts grains alone; tetrahedra, which hold these parts, are divided later.
  // No step: the blade waits, because 32 others cut.
  std::vector<Step> cut(const BladeMove& whole, const Blades::BodyNow& body);
  // Warnings of a move that was made: the blade is narrower than the tetrahedra that it meets, or it has gone
  // far in this frame and `has_cut`. Each is told once per tool.
  std::vector<std::string> unfit(const BladeMove& move, bool has_cut, const Elements& elements,
                                 const Blades::BodyNow& body);

  // ---- Edits

  // Throws InputError if the incisions do not fit the grains.
  void check(const std::vector<Incision>& incisions) const;
  // Makes incisions again. Returns the tetrahedra beside the faces that were opened.
  std::vector<Index> open(const std::vector<Incision>& incisions);
  // The parts of tetrahedra beside faces that were opened.
  auto parts_of(const Topology& topology, const std::vector<Index>& opened) {
    return blades_->grains.divide(topology, opened);
  }
  // Takes out of tetrahedra that meet a volume the copies whose own grains do not.
  void keep_filled(const SweptVolume& volume, const Elements& elements, const Blades::BodyNow& body,
                   std::vector<Index>& meeting) const;
  void forget(const std::vector<Index>& removed) {
    if (blades_) blades_->grains.forget(removed);
  }
  // Where a vertex is split, only the copies that lie in tissue stay held. Others are only corners of
  // tetrahedra whose part lies elsewhere.
  void hold_what_is_filled(const MeshEdit& edit, Model& model) const;
  // Divides the load on a face among its parts.
  void share_loads(const MeshEdit& edit, const Elements& elements, DeadLoads& loads) const;

  // ---- Checkpoints

  Blades::State state() const { return blades_ ? blades_->state() : Blades::State{}; }
  void set_state(const Blades::State& state) {
    if (blades_) blades_->set_state(state);
    told_ = {};  // it may have told of other tools
  }

 private:
  bool lies_on_held_boundary(Index v, const Model& model) const;

  std::unique_ptr<Blades> blades_;    // none until a blade cuts
  std::unique_ptr<Blades> prepared_;  // what they will be then, as long as the mesh stays as it is
  struct {
    std::vector<int> narrow, far;  // tools of which unfit() has told it
  } told_;
  struct {
    int tool = 0;
    double way = 0;  // way of the last tool that has moved in this frame [m]
  } gone_;           // the last tool that has moved in this frame
};

// The work that opened the faces of a step.
CutWork work_of(const Incised& incised, const Elements& elements);

}  // namespace lobe
