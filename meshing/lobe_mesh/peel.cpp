// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "lobe/mesh/quality.h"
#include "lobe_mesh/interfaces.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {

void peel_flat_tets(TetMesh& mesh) {
  constexpr double flat = 0.03;  // smallest altitude over longest edge
  std::set<std::pair<Index, Index>> boundary_edges;
  std::map<Index, std::vector<Index>>
      outer_corners;  // of each tetrahedron at the boundary: opposite to its faces there
  for (const InterfaceFace& face : interface_faces(mesh)) {
    const auto& c = face.corners;
    for (const auto& [a, b] : {std::pair{c[0], c[1]}, {c[1], c[2]}, {c[2], c[0]}})
      boundary_edges.insert(std::minmax(a, b));
    if (face.other >= 0) continue;
    for (const Index v : mesh.tets.col(face.tet)) {
      if (std::find(c.begin(), c.end(), v) == c.end()) outer_corners[face.tet].push_back(v);
    }
  }
  std::set<Index> peeled;
  for (const auto& [t, outer] : outer_corners) {
    if (outer.size() != 2) continue;
    const Mat34<double> corners = tet_points(mesh, t);
    const auto heights = altitudes(corners);
    double longest = 0;
    for (const auto& e : edge_corners)
      longest = std::max(longest, (corners.col(e[0]) - corners.col(e[1])).norm());
    const bool is_flat = *std::min_element(heights.begin(), heights.end()) < flat * longest;
    if (is_flat && boundary_edges.insert(std::minmax(outer[0], outer[1])).second) peeled.insert(t);
  }
  Index kept = 0;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    if (peeled.contains(t)) continue;
    if (!mesh.labels.empty()) mesh.labels[kept] = mesh.labels[t];
    mesh.tets.col(kept++) = mesh.tets.col(t).eval();
  }
  mesh.tets.conservativeResize(4, kept);
  if (!mesh.labels.empty()) mesh.labels.resize(kept);
}

}  // namespace lobe::meshing
