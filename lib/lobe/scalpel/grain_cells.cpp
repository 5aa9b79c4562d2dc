#include "lobe/scalpel/grain_cells.h"

namespace lobe {

SurfaceCells::Cell GrainCells::cell(Index grain) const {
  const Grains::Grain& own = grains_[grain];
  if (!elements_.topology.alive(own.element)) return {};
  unsigned outer = 0;
  for (int f = 0; f < 4; ++f) outer |= unsigned(grains_.neighbour(grain, f) < 0) << f;
  return {own.element, own.points, outer};
}

std::vector<Index> GrainCells::outer_faces() const {
  std::vector<Index> codes;
  for (Index grain = 0; grain < count(); ++grain) {
    const Cell own = cell(grain);
    for (Index f = 0; f < 4 && own.tet >= 0; ++f)
      if (own.outer >> f & 1) codes.push_back(4 * grain + f);
  }
  return codes;
}

void GrainCells::append_cells_of(Index tet, std::vector<Index>& cells) const {
  cells.insert(cells.end(), grains_.of(tet).begin(), grains_.of(tet).end());
}

// The grains around a point agree where it is: they hang together by faces.
SurfacePlace GrainCells::place(Index point) const {
  const Index t = grains_[grains_.around(point).front()].element;
  const Eigen::Vector4i corners = elements_.topology.corners(t);
  const Vec3d& X = grains_.point(point);
  const Mat34<double> own = elements_.corner_points(t);
  for (int k = 0; k < 4; ++k)
    if (own.col(k) == X) return {corners[k]};
  SurfacePlace place{-1, corners};
  place.weights.tail<3>() = shape(own).gradients.rightCols<3>().transpose() * (X - own.col(0));
  place.weights[0] = 1 - place.weights.tail<3>().sum();
  return place;
}

void GrainCells::append_changed(const MeshEdit& edit, std::vector<Index>& cells) const {
  for (const VertexSplit& split : edit.splits)
    for (Index t : split.tets) append_cells_of(t, cells);
  for (const TetShare& own : edit.shares) append_cells_of(own.tet, cells);
}

std::unique_ptr<SurfaceCells> surface_cells(const Elements& elements, const Grains* grains) {
  if (grains) return std::make_unique<GrainCells>(*grains, elements);
  return std::make_unique<TetCells>(elements.topology);
}

}  // namespace lobe
