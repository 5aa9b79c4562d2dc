// What cuts change of a skin (skin.h).
#pragma once

#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "lobe/mesh/vertex_lists.h"
#include "lobe/types.h"

namespace lobe {

struct SkinState {
  // The tetrahedra that carry vertices, one for each carried vertex.
  std::vector<Index> carrier, element;           // tetrahedron of the start, and which copy of it
  std::vector<Eigen::Vector4f> weights;          // barycentric coordinates in it
  std::vector<Eigen::Vector4i> carrier_corners;  // vertices of the mesh
  VertexLists<Index> carried_by;                 // vertices on each tetrahedron of the start

  // What is shown. Triangles are numbered as in the file; then comes one without area, then the cut parts.
  std::vector<Eigen::Vector3i> shown;  // corners of SkinMesh::triangles: carried vertices, then cut vertices
  std::vector<Index> slot_of;          // place there of each number; −1: it is not shown
  std::vector<Index> number_of;        // number of each slot

  // What blades have divided.
  using Edge = std::pair<Index, Index>;  // carried vertices, ascending
  struct Gap {                           // a gap of an edge, seen from its vertex of the lower number
    double share;                        // place as a share of the edge
    Index before, after;                 // what the edge lies on before and behind it; −1: it is gone
    bool operator==(const Gap&) const = default;
  };
  using Place = std::tuple<Index, Index, double, Index>;  // edge as drawn, share, element of a cut vertex
  struct CutVertex {                                      // vertex that blades have made
    Place place;
    Index element = -1;
    Eigen::Vector4i corners = Eigen::Vector4i::Zero();
    Eigen::Vector4f weights = Eigen::Vector4f::Zero();
    int uses = 0;  // number of corners of parts
  };
  struct Divided {             // divided triangle of the file
    Eigen::Vector3i corners;   // corners as they are drawn
    std::vector<Index> parts;  // numbers of its parts
  };
  std::map<Index, std::vector<Index>> copies_of;  // copies of the tetrahedra that a blade has cut
  std::map<Edge, std::vector<Gap>> gaps;
  std::map<Index, Divided> divided;
  std::vector<CutVertex> cut;
  std::map<Place, Index> cut_at;                // places in `cut`
  std::vector<Index> unused_parts, unused_cut;  // free numbers of parts; free places in `cut`
};

}  // namespace lobe
