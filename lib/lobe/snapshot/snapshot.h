// A snapshot is a copy of one moment of a running simulation, for other threads. It has all that a viewer, a
// haptic loop or a script needs. It goes through a TripleBuffer, which recycles its storage. To make one
// allocates nothing while nothing is cut.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include "lobe/forces/event.h"
#include "lobe/mesh/surface.h"

namespace lobe {

template <class Real>
struct SurfaceSnapshot {
  std::shared_ptr<const SurfaceMesh> mesh;  // shared by all snapshots of the same revision
  Mat3X<Real> x;                            // 3 × #vertices of the surface, current positions [m]
  Mat3X<Real> normals;                      // 3 × #vertices of the surface, unit length, outwards
};

struct ToolSnapshot {
  std::string name, type;          // name and type, as in the scene: "left hand", "grasp"
  Vec3d position = Vec3d::Zero();  // [m]
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  Vec3d force = Vec3d::Zero();   // force on the tool, by the body [N]
  Vec3d torque = Vec3d::Zero();  // torque on the tool, by the body, about its position [N m]
  double radius = 0;             // radius of its spherical tip [m]
  Vec3d blade = Vec3d::Zero();   // blade of a scalpel, from its tip, which is the position, to its heel [m]
  double opening = 0;            // distance of jaws [m]
  Vec3d jaw = Vec3d::Zero();     // width, thickness and length of each jaw [m]; 0: it has none
};

struct FigureSnapshot {  // figures of the frame before the snapshot
  bool ok = true;        // false: the simulation stands still
  int steps = 0, reruns = 0;
  double time_step = 0;     // smallest step that was taken [s]
  double wall_seconds = 0;  // time that the frame took [s]
  Index tets = 0, tets_removed = 0;
  std::vector<std::string> conditions;  // lines on what there is to say
  std::vector<Event> events;
};

struct LinesSnapshot {          // straight segments of one thread, or the strands of one attachment
  std::string term, name;       // "threads" or "attachments"; name of the thread or attachment
  Mat3X<float> ends{3, 0};      // 3 × 2 #segments: begin and end of each [m]
  std::vector<float> tensions;  // tension of each segment [N]
  std::vector<float> damages;   // damage of each segment: 0 whole … 1 torn; empty: none has any
};

template <class Real>
struct Snapshot {
  double time = 0;         // [s]
  std::int64_t frame = 0;  // number, counted from the start
  Mat3X<Real> u, v;        // 3 × #vertices of the mesh, displacements [m] and velocities [m/s]
  SurfaceSnapshot<Real> surface;
  std::vector<ToolSnapshot> tools;
  std::vector<LinesSnapshot> lines;
  FigureSnapshot figures;
};

// Copies one surface into snapshots, one after the other. What does not change while nothing is cut is copied
// only once.
class SurfaceCopies {
 public:
  // O(#vertices + #triangles of the surface); it allocates where the revision or the number of vertices has
  // changed.
  template <class Real>
  void copy(const Surface& surface,                                        // one surface at all calls
            const Eigen::Ref<const Mat3X<double>>& X,                      // 3 × #vertices of the mesh [m]
            const Eigen::Ref<const Mat3X<std::type_identity_t<Real>>>& u,  // 3 × #vertices of the mesh [m]
            SurfaceSnapshot<Real>& to) {
    if (!shared_ || shared_->revision != surface.revision())
      shared_ = std::make_shared<const SurfaceMesh>(surface.mesh());
    to.mesh = shared_;
    update_positions(*shared_, X, u, to.x);
    update_normals(*shared_, to.x, to.normals);
  }

 private:
  std::shared_ptr<const SurfaceMesh> shared_;
};

}  // namespace lobe
