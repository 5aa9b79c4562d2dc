#include "lobe/scalpel/grain_cells.h"

namespace lobe {

SurfaceCells::Cell GrainCells::cell(Index grain) const {
  const Grains::Grain& data = grains_[grain];
  if (!elements_.topology.alive(data.element)) return {};
  unsigned outer = 0;
  for (int f = 0; f < 4; ++f) outer |= unsigned(grains_.neighbour(grain, f) < 0) << f;
  return {data.element, data.points, outer};
}

std::vector<Index> GrainCells::outer_faces() const {
  std::vector<Index> codes;
  for (Index grain = 0; grain < count(); ++grain) {
    const Cell found_cell = cell(grain);
    for (Index f = 0; f < 4 && found_cell.tet >= 0; ++f)
      if (found_cell.outer >> f & 1) codes.push_back(4 * grain + f);
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
  const Mat34<double> corner_points = elements_.corner_points(t);
  for (int k = 0; k < 4; ++k)
    if (corner_points.col(k) == X) return {corners[k]};
  SurfacePlace place{-1, corners};
  place.weights.tail<3>() =
      shape(corner_points).gradients.rightCols<3>().transpose() * (X - corner_points.col(0));
  place.weights[0] = 1 - place.weights.tail<3>().sum();
  return place;
}

void GrainCells::append_changed(const MeshEdit& edit, std::vector<Index>& cells) const {
  for (const VertexSplit& split : edit.splits)
    for (Index t : split.tets) append_cells_of(t, cells);
  for (const TetShare& tet_share : edit.shares) append_cells_of(tet_share.tet, cells);
}

std::unique_ptr<SurfaceCells> surface_cells(const Elements& elements, const Grains* grains) {
  if (grains) return std::make_unique<GrainCells>(*grains, elements);
  return std::make_unique<TetCells>(elements.topology);
}

}  // namespace lobe
