#include "lobe/mesh/surface_cells.h"

#include <algorithm>

namespace lobe {

SurfaceCells::Cell TetCells::cell(Index tet) const {
  if (!topology_.alive(tet)) return {};
  unsigned outer = 0;
  for (int f = 0; f < 4; ++f) outer |= unsigned(topology_.neighbour(tet, f) < 0) << f;
  return {tet, topology_.corners(tet), outer};
}

TetCells::FaceAtStart TetCells::key_of(const Topology& topology, Index code) {
  const Eigen::Vector3i face = topology.face(code);
  FaceAtStart key{topology.origin(face[0]), topology.origin(face[1]), topology.origin(face[2])};
  std::sort(key.begin(), key.end());
  return key;
}

TetCells::TetCells(const Topology& topology, std::span<const Index> removed) : topology_(topology) {
  for (const Index t : removed) add_gone(t);
  std::sort(gone_.begin(), gone_.end());
}

void TetCells::add_gone(Index tet) {
  for (Index f = 0; f < 4; ++f) gone_.push_back(key_of(topology_, 4 * tet + f));
}

bool TetCells::is_behind_gone(Index code) const {
  return std::binary_search(gone_.begin(), gone_.end(), key_of(topology_, code));
}

TetCells TetCells::since_start(const Topology& topology) {
  TetCells cells(topology);
  cells.knows_start_ = true;
  if (topology.alive_count() == topology.tet_count()) return cells;
  for (Index t = 0; t < topology.tet_count(); ++t)
    if (!topology.alive(t)) cells.add_gone(t);
  std::sort(cells.gone_.begin(), cells.gone_.end());
  return cells;
}

bool TetCells::is_cut(Index code, bool was_cut) const {
  return knows_start_ ? is_behind_gone(code) : was_cut;
}

bool TetCells::is_burnt(Index code, bool was_burnt) const { return was_burnt || is_behind_gone(code); }

}  // namespace lobe
