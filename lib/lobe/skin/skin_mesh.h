// What a skin (skin.h) shows: its triangles, and what does not move of its vertices.
#pragma once

#include <cstdint>
#include <vector>

#include "lobe/mesh/slot_log.h"
#include "lobe/types.h"

namespace lobe {

// All of a skin but positions and normals. A vertex of the file that has several texture coordinates or
// normals is several vertices here, so that the skin is creased as it is in the file.
struct SkinMesh {
  std::uint64_t revision = 0;              // grows by one with each change of what is shown
  std::vector<Eigen::Vector3i> triangles;  // triangles that are shown; counter-clockwise seen from outside
  std::vector<Index> file_triangle;        // triangle of the file of which each is one, or a part
  SlotLog changed_triangles;               // slots of changed triangles, as in Surface: arrays without gaps

  // One per vertex. Vertices of the file never change. Behind them are those that blades have made. A vertex
  // that no triangle uses any more stays until another takes its place.
  std::vector<Index> file_vertex;        // number in the file; between two vertices, that of the nearer
  std::vector<Eigen::Vector2f> texture;  // 0 where the file has none
  struct Between {                       // place at rest on the line from a to b, vertices of the file
    Index a, b;
    float share;
  };
  std::vector<Between> between;  // places of the last vertices
  SlotLog changed_vertices;

  Index vertex_count() const { return static_cast<Index>(file_vertex.size()); }
  Index triangle_count() const { return static_cast<Index>(triangles.size()); }
};

}  // namespace lobe
