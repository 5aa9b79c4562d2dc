// Display holds what observers read: the surface of a body, which follows edits, and snapshots of its state
// for other threads (docs/threads.md).
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "lobe/body/motion.h"
#include "lobe/fem/elements.h"
#include "lobe/forces/term_lines.h"
#include "lobe/mesh/surface.h"
#include "lobe/organ/report.h"
#include "lobe/scalpel/grain_cells.h"
#include "lobe/snapshot/snapshot.h"
#include "lobe/snapshot/triple_buffer.h"
#include "lobe/tool/tool_pose.h"

namespace lobe {

// The observer is called after each edit of the mesh.
using CutObserver = std::function<void(const Topology&, const MeshEdit&)>;

template <class Real>
class Display {
 public:
  // ---- The surface. The first call makes it; each later edit costs O(edit). `grains` is null if no blade
  // has cut.

  const Surface& surface(const Elements& elements, const Grains* grains);
  void rebuild(const Elements& elements, const Grains* grains);
  void follow(const Elements& elements, Grains* grains, const MeshEdit& edit);
  void follow_regions(const Elements& elements, const Grains* grains, const std::vector<Index>& tets);

  // ---- Observers of edits

  void on_cut(CutObserver observer) { observers_.push_back(std::move(observer)); }
  void tell(const Topology& topology, const MeshEdit& edit) const {
    for (const CutObserver& observer : observers_) observer(topology, edit);
  }

  // ---- Snapshots

  // Makes a snapshot of this state with the surface, which must exist. Makes none if readers hold all slots.
  void publish(const Elements& elements, const StateView<Real>& state, const std::vector<PlacedTool>& tools,
               const std::vector<TermLines>& lines, const Report& report);
  const TripleBuffer<Snapshot<Real>>& snapshots() const { return published_->buffer; }  // for any thread

 private:
  struct Published {  // never moves in memory: others point to it
    TripleBuffer<Snapshot<Real>> buffer;
    SurfaceCopies surfaces;
    std::int64_t frames = 0;
  };

  std::unique_ptr<Surface> surface_;  // null until surface() is called
  std::vector<CutObserver> observers_;
  std::unique_ptr<Published> published_ = std::make_unique<Published>();
};

}  // namespace lobe
