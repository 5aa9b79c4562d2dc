// Boundary conditions: dead loads, and vertices whose motion is prescribed.
#pragma once

#include <map>
#include <vector>

#include "lobe/fem/elements.h"
#include "lobe/setup/setup.h"

namespace lobe {

// Consistent nodal forces of the dead loads. A traction t on a face of rest area A gives t A/3 to each of its
// vertices. If a blade has left only a part of the face, that part has the force on its area, with its
// moment. Loads on faces of removed tetrahedra vanish.
class DeadLoads {
 public:
  DeadLoads(const Elements& elements, const std::vector<FaceLoad>& face_loads,
            const std::vector<VertexLoad>& vertex_loads);

  Vec3d at(const Elements& elements, Index vertex) const;  // [N], O(tetrahedra around it)

  // Faces of a tetrahedron of the start that bear a load.
  std::vector<int> loaded_faces(Index tet) const;
  // Sets the load of each corner of a face (FaceLoad::weights), of a tetrahedron or a copy of one.
  void set_weights(Index tet, int face, const Vec3d& weights) { weights_[4 * tet + face] = weights; }
  Vec3d weights(Index tet, const FaceLoad& load) const;

 private:
  std::vector<FaceLoad> face_loads_;
  std::vector<VertexLoad> vertex_loads_;
  VertexLists<Index> of_tet_, of_vertex_;  // numbers of loads; empty if there are none of the kind
  std::map<Index, Vec3d> weights_;         // weights of faces 4 × tetrahedron + face that a blade has cut
};

// Loads of all vertices, 3 × #vertices [N].
Mat3X<double> dead_loads(const Elements& elements, const std::vector<FaceLoad>& face_loads,
                         const std::vector<VertexLoad>& vertex_loads);

// Position on a path at a time, linear between its points, constant before and after. [m]
Vec3d path_at(const std::vector<PathPoint>& path, double time);
// Orientation on a path at a time: a unit quaternion x, y, z, w. Between two points it turns at a constant
// rate, the shortest way.
Eigen::Vector4d orientation_at(const std::vector<PathPoint>& path, double time);
double opening_at(const std::vector<PathPoint>& path, double time);  // distance of jaws [m]

// Held vertices: boundary conditions (holder 0) or a grasp (holder: its ToolId, above 0) prescribe their
// displacement. The first holder of a component of a vertex keeps it: a grasp moves the components that no
// boundary condition holds. Vertices of which a share below 1 is held are listed apart: they move by
// themselves, and several holders may draw the same one.
class HeldVertices {
 public:
  struct Held {
    Index vertex = 0;
    int holder = 0;
    Vec3d start = Vec3d::Zero();  // displacement at the time of taking hold [m]
    Vec3d goal = Vec3d::Zero();   // displacement after the ramp [m], of holder 0
    Axes axes = all_axes;         // the components that are held
    double share = 1;             // share of the vertex that is held, above 0; 1: wholly
    bool operator==(const Held&) const = default;
    bool is_valid() const {  // a file's numbers: no memory for vertices that no mesh has
      return vertex >= 0 && vertex < 100'000'000 && start.allFinite() && goal.allFinite() && share > 0 &&
             share <= 1;
    }
    static constexpr auto fields =
        std::tuple(&Held::vertex, &Held::holder, &Held::start, &Held::goal, &Held::axes, &Held::share);
  };
  static constexpr int boundary = 0;

  bool holds(Index v) const { return axes_of(v) != 0; }
  bool fixes(Index v) const { return axes_of(v) == 7; }  // in all components
  // Whether anything keeps it near a place: it is held, wholly or by a share.
  bool anchors(Index v) const { return v < static_cast<Index>(held_.size()) && held_[v] != 0; }
  int holder_of(Index v) const;  // holder of a held vertex; O(#held)
  const std::vector<Held>& all() const { return items_; }
  const std::vector<Held>& partly() const { return partly_; }  // items with a share below 1

  bool operator==(const HeldVertices&) const = default;
  std::vector<Held> as_saved() const;
  static HeldVertices from_saved(const std::vector<Held>& items) {
    HeldVertices held;
    for (const Held& item : items) held.hold(item);
    return held;
  }

  void hold(Held item);  // takes the components that are free; with a share below 1 all of the item
  void release(int holder);
  void free(Index vertex);
  void split(Index vertex, Index copy);  // holds the copy as the vertex is held

 private:
  bool joins(const Held& item);
  void find_drawn();
  std::uint8_t axes_of(Index v) const {
    return v < static_cast<Index>(held_.size()) ? held_[v] & all_components : 0;
  }

  static constexpr std::uint8_t all_components = 7, is_drawn = 8;
  std::vector<Held> items_, partly_;
  std::vector<std::uint8_t> held_;  // bits of each vertex: its held components, and whether it is partly held
};

// Returns what the boundary conditions hold wholly; and that with what they hold by a share.
HeldVertices held_by(const std::vector<PrescribedVertex>& prescribed);
HeldVertices held_by(const Setup& setup);

}  // namespace lobe
