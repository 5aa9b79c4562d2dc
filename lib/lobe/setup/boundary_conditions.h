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
  std::map<Index, Vec3d> weights_;         // of faces 4 × tetrahedron + face that a blade has cut
};

// The same for all vertices, 3 × #vertices [N].
Mat3X<double> dead_loads(const Elements& elements, const std::vector<FaceLoad>& face_loads,
                         const std::vector<VertexLoad>& vertex_loads);

// Position on a path at a time, linear between its points, constant before and after. [m]
Vec3d path_at(const std::vector<PathPoint>& path, double time);
// Orientation on a path at a time: a unit quaternion x, y, z, w. Between two points it turns at a constant
// rate, the shortest way.
Eigen::Vector4d orientation_at(const std::vector<PathPoint>& path, double time);
double opening_at(const std::vector<PathPoint>& path, double time);  // of jaws [m]

// Held vertices: boundary conditions (holder 0) or a grasp (holder: its ToolId, above 0) prescribe their
// displacement. The first holder of a component of a vertex keeps it: a grasp moves the components that no
// boundary condition holds.
class HeldVertices {
 public:
  struct Held {
    Index vertex = 0;
    int holder = 0;
    Vec3d start = Vec3d::Zero();  // displacement when it was taken hold of [m]
    Vec3d goal = Vec3d::Zero();   // holder 0: displacement after the ramp [m]
    Axes axes = all_axes;         // the components that are held
    bool operator==(const Held&) const = default;
    bool is_valid() const {  // as read back: no memory for vertices that no mesh has
      return vertex >= 0 && vertex < 100'000'000 && start.allFinite() && goal.allFinite();
    }
    static constexpr auto fields =
        std::tuple(&Held::vertex, &Held::holder, &Held::start, &Held::goal, &Held::axes);
  };
  static constexpr int boundary = 0;

  bool holds(Index v) const { return axes_of(v) != 0; }
  bool fixes(Index v) const { return axes_of(v) == 7; }  // in all components
  int holder_of(Index v) const;                          // of one that is held; O(#held)
  const std::vector<Held>& all() const { return items_; }

  bool operator==(const HeldVertices& other) const { return items_ == other.items_; }
  const std::vector<Held>& as_saved() const { return items_; }
  static HeldVertices from_saved(const std::vector<Held>& items) {
    HeldVertices held;
    for (const Held& item : items) held.hold(item);
    return held;
  }

  void hold(Held item);  // those of its components that are free
  void release(int holder);
  void free(Index vertex);
  void split(Index vertex, Index copy);  // the copy is held as the vertex is

 private:
  bool joins(const Held& item);
  std::uint8_t axes_of(Index v) const { return v < static_cast<Index>(held_.size()) ? held_[v] : 0; }

  std::vector<Held> items_;
  std::vector<std::uint8_t> held_;  // per vertex: one bit per component
};

// What the boundary conditions hold.
HeldVertices held_by(const std::vector<PrescribedVertex>& prescribed);

}  // namespace lobe
