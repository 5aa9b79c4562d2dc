// Selections of a scene. A tetrahedron is selected by its barycentre, a vertex by its rest position, a
// boundary face when its three vertices are, or if a surface that the mesh's file names has it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "lobe/types.h"

namespace lobe {

struct Selector;
struct SelectAll {};
struct SelectBox {
  Vec3d min, max;
};  // [m]
struct SelectSphere {
  Vec3d center;
  double radius = 0;
};  // [m]
struct SelectPlane {
  enum class Side { within, above, below };
  Vec3d point, normal;  // `above` is where the normal points
  Side side = Side::within;
  double within = 0;  // [m], for Side::within
};
struct SelectNearest {
  Vec3d point;
  int count = 1;
};  // the `count` nearest vertices (or tetrahedra)
struct SelectLabel {
  std::vector<int> labels;
  std::vector<std::string> names = {};  // names in the mesh's file of further labels, until bind_groups()
};                                      // tetrahedra; vertices of such tetrahedra
struct SelectBody {
  std::vector<std::string> names;
};  // tetrahedra of these bodies; their vertices
struct SelectSurface {
  std::vector<std::string> names;  // names or numbers of groups of triangles in the mesh's file
  std::vector<std::array<Index, 3>> triangles = {};  // triangles that bind_groups() finds for them
  bool is_bound = false;
};  // boundary faces; their vertices; tetrahedra that have such a face
struct SelectPatch {
  Vec3d point;        // the boundary face nearest to it is the first
  double angle = 40;  // largest turn [degrees]
};  // boundary faces connected with it by edges at which they turn by less than the angle; their vertices
struct SelectVertices {
  std::vector<Index> vertices;
};
struct SelectTetrahedra {
  std::vector<Index> tetrahedra;
};
struct SelectAnyOf {
  std::vector<Selector> parts;
};
struct SelectAllOf {
  std::vector<Selector> parts;
};
struct SelectNot {
  std::vector<Selector> part;
};  // exactly one
struct Selector {
  std::variant<SelectAll, SelectBox, SelectSphere, SelectPlane, SelectNearest, SelectLabel, SelectVertices,
               SelectTetrahedra, SelectSurface, SelectPatch, SelectBody, SelectAnyOf, SelectAllOf, SelectNot>
      value;
};

// The held part of a selection: the vertices in it, each wholly; or each vertex by the share of its volume,
// or of its area of the surface, that lies in it (select_shares.h).
enum class HoldBy : std::uint8_t { vertices, volume, area };
inline constexpr std::array<const char*, 3> hold_by_names{"vertices", "volume", "area"};

// What an entry of a scene takes of a selection; shares are of vertices (HoldBy).
enum class Selects : std::uint8_t { vertices, shares, faces, tets };

}  // namespace lobe
