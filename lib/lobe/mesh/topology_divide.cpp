// Tetrahedra that a blade has cut: copies, new corners, and several neighbours across a face.
#include <algorithm>

#include "lobe/mesh/topology.h"

namespace lobe {

void Topology::take_corners(Index tet, const Eigen::Vector4i& corners) {
  for (int c = 0; c < 4; ++c) {
    if (tets_(c, tet) == corners[c]) continue;
    if (tets_(c, tet) >= 0) around_.erase_value(tets_(c, tet), tet);
    tets_(c, tet) = corners[c];
    around_.append(corners[c], tet);
  }
}

// Records which tetrahedra have each new vertex for a corner.
void Topology::split_vertices(const TetDivision& division, MeshEdit& edit) {
  const Index before = vertex_count() - static_cast<Index>(division.vertices.size());
  for (std::size_t i = 0; i < division.vertices.size(); ++i) {
    const Index copy = before + static_cast<Index>(i);
    edit.splits.push_back({division.vertices[i], copy, {around(copy).begin(), around(copy).end()}});
    std::sort(edit.splits.back().tets.begin(), edit.splits.back().tets.end());
  }
}

MeshEdit Topology::divide(const TetDivision& division) {
  MeshEdit edit;
  for (Index v : division.vertices) {
    origins_.push_back(origin(v));
    around_.add_vertex();
  }
  Index tets = tet_count();
  std::vector<Index> parents;
  for (const TetDivision::Part& part : division.parts) {
    tets = std::max(tets, part.tet + 1);
    if (part.tet >= tet_count()) parents.push_back(parent(part.of));
  }
  const Index before = tet_count(), added = tets - before;
  tets_.extend(tets);
  neighbours_.extend(tets);
  tets_.padded().middleCols(before, added).setConstant(-1);
  alive_.resize(std::size_t(tets), 1);
  found_by_.resize(std::size_t(tets), -1);
  parents_.insert(parents_.end(), parents.begin(), parents.end());
  alive_count_ += added;
  for (const TetDivision::Part& part : division.parts) {
    if (part.tet >= before) {
      edit.copies.push_back({part.of, part.tet});
      for (int f = 0; f < 4; ++f) open_face(4 * part.tet + f);
    }
    edit.shares.push_back({part.tet, part.share});
    take_corners(part.tet, part.corners);
  }
  for (const TetDivision::Neighbours& around : division.neighbours)
    for (int f = 0; f < 4; ++f) set_neighbours(around.tet, f, division.across(around, std::size_t(f)));
  split_vertices(division, edit);
  if (!division.may_part) return edit;
  std::vector<Index> rim;
  rim.reserve(division.neighbours.size());
  for (const TetDivision::Neighbours& listed : division.neighbours) rim.push_back(listed.tet);
  find_cut_off(rim, {static_cast<Index>(rim.size())}, edit);
  return edit;
}

}  // namespace lobe
