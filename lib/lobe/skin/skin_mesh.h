// What a skin (skin.h) shows: its triangles, and what does not move of its vertices.
#pragma once

#include <cstdint>
#include <vector>

#include "lobe/mesh/slot_log.h"
#include "lobe/types.h"

namespace lobe {

// All of the skin but positions and normals. A vertex of the file that has several texture coordinates or
// normals is several vertices here, so that the skin is creased as it is in the file.
struct SkinMesh {
  std::uint64_t revision = 0;              // grows by one with each change of what is shown
  std::vector<Eigen::Vector3i> triangles;  // those that are shown; counter-clockwise seen from outside
  std::vector<Index> file_triangle;        // per triangle: that of the file which it is, or is a part of
  SlotLog changed_triangles;               // as in Surface: arrays without gaps

  // One per vertex. Vertices of the file never change. Behind them are those that blades have made. One that
  // no triangle uses any more stays until another takes its place.
  std::vector<Index> file_vertex;        // its number in the file; of one between two, the nearer
  std::vector<Eigen::Vector2f> texture;  // 0 where the file has none
  struct Between {                       // at rest on the line from a to b, which are vertices of the file
    Index a, b;
    float share;
  };
  std::vector<Between> between;  // the last vertices
  SlotLog changed_vertices;

  Index vertex_count() const { return static_cast<Index>(file_vertex.size()); }
  Index triangle_count() const { return static_cast<Index>(triangles.size()); }
};

}  // namespace lobe
