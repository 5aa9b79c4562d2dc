// Grains as cells of a surface. The drawn surface is open where the blade has cut, and nowhere else.
#pragma once

#include <memory>

#include "lobe/mesh/surface_cells.h"
#include "lobe/scalpel/grains.h"

namespace lobe {

class GrainCells : public SurfaceCells {
 public:
  GrainCells(const Grains& grains, const Elements& elements) : grains_(grains), elements_(elements) {}
  Index count() const override { return grains_.count(); }
  Index point_count() const override { return grains_.point_count(); }
  Cell cell(Index grain) const override;
  std::vector<Index> outer_faces() const override;  // O(#grains)
  std::span<const Index> around(Index point) const override { return grains_.around(point); }
  void append_cells_of(Index tet, std::vector<Index>& cells) const override;
  bool is_cut(Index code, bool) const override { return !grains_.was_boundary(code / 4, int(code % 4)); }
  Index stroke_of(Index code) const override { return grains_.stroke_of(code); }
  SurfacePlace place(Index point) const override;  // place of a point that a grain has

  // Tells the cells which tetrahedra an edit of the topology has given other corners. Grains do not know of
  // these.
  void append_changed(const MeshEdit& edit, std::vector<Index>& cells) const;

 private:
  const Grains& grains_;
  const Elements& elements_;
};

// The cells whose boundary is the surface of a body: its tetrahedra, or grains if a blade has cut. Valid
// until the next edit.
std::unique_ptr<SurfaceCells> surface_cells(const Elements& elements, const Grains* grains);

}  // namespace lobe
