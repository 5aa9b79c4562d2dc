// Tools as a scene gives them, with their paths. Each kind of tool has a list here, and a class in tool/.
#pragma once

#include <string>
#include <tuple>
#include <vector>

#include "lobe/setup/clip_setup.h"
#include "lobe/setup/rigid_shape.h"

namespace lobe {

struct PathPoint {
  double time = 0;                 // [s]
  Vec3d position = Vec3d::Zero();  // [m]; for a grasp the offset from where it took hold
  // For a grasp its turn since it took hold, about its centre there; a unit quaternion x, y, z, w.
  Eigen::Vector4d orientation{0, 0, 0, 1};
  double opening = 0;  // distance of jaws [m]
  static constexpr auto fields =
      std::tuple(&PathPoint::time, &PathPoint::position, &PathPoint::orientation, &PathPoint::opening);
};
// Whether times increase, values are finite and quaternions have length 1.
bool is_path(const std::vector<PathPoint>& path);

struct GraspSetup {
  static constexpr const char* type = "grasp";
  std::string name;
  // Vertices of the mesh, or copies that earlier cuts make. Those that do not exist when it takes hold are
  // left out.
  std::vector<Index> vertices;
  std::vector<PathPoint> path;  // offsets
  bool release = false;
  // Held share of each vertex, above 0 and up to 1 (PartlyHeldVertex); none: all wholly.
  std::vector<double> shares = {};
  bool any_partly() const;
  void check(const Expect& expect) const;
  static constexpr auto fields =
      std::tuple(&GraspSetup::vertices, &GraspSetup::path, &GraspSetup::release, &GraspSetup::shares);
};

struct CauterySetup {
  static constexpr const char* type = "cautery";
  std::string name;
  double radius = 0;            // [m]
  std::vector<PathPoint> path;  // positions of the tip, and turns of the hook
  // Vector from its tip to the end of a hook, which burns all along [m], before it turns; zero: it has none.
  Vec3d hook = Vec3d::Zero();
  double core = 0;  // radius of a rigid wire in it, which tissue feels [m]; 0: tissue feels nothing
  void check(const Expect& expect) const;
  static constexpr auto fields =
      std::tuple(&CauterySetup::radius, &CauterySetup::path, &CauterySetup::hook, &CauterySetup::core);
};

struct ScalpelSetup {
  static constexpr const char* type = "scalpel";
  std::string name;
  double snap = 0.1;            // share of its shortest edge: a vertex that is nearer to the cut lies on it
  std::vector<PathPoint> path;  // positions of the tip
  std::vector<Vec3d> heels;     // other end of the cutting edge in each row of the path [m]
  bool along_faces = false;     // whether it opens faces that the mesh has, and divides no tetrahedron
  void check(const Expect& expect) const;
  static constexpr auto fields =
      std::tuple(&ScalpelSetup::snap, &ScalpelSetup::path, &ScalpelSetup::heels, &ScalpelSetup::along_faces);
};
inline constexpr double least_snap = 0.02, most_snap = 0.3;

inline constexpr double default_friction = 0.1;  // friction of a wet instrument against tissue [-]

struct ProbeSetup {
  static constexpr const char* type = "probe";
  std::string name;
  RigidShape shape;
  double friction = default_friction;  // Coulomb's coefficient against tissue
  std::vector<PathPoint> path;         // positions and orientations
  bool release = false;                // whether it is taken away after the last row; else it stays there
  void check(const Expect& expect) const;
  static constexpr auto fields =
      std::tuple(&ProbeSetup::shape, &ProbeSetup::friction, &ProbeSetup::path, &ProbeSetup::release);
};

// Closes a clip at each row of its path.
struct ClipApplierSetup {
  static constexpr const char* type = "clip_applier";
  std::string name;
  ClipShape clip;
  std::vector<PathPoint> path;  // times, places and turns of the clips that close
  void check(const Expect& expect) const;
  static constexpr auto fields = std::tuple(&ClipApplierSetup::clip, &ClipApplierSetup::path);
};

struct ToolSetups {
  std::vector<GraspSetup> grasps;
  std::vector<CauterySetup> cauteries;
  std::vector<ScalpelSetup> scalpels;
  std::vector<ProbeSetup> probes;
  std::vector<ClipApplierSetup> clip_appliers;
  static constexpr auto fields =
      std::tuple(&ToolSetups::grasps, &ToolSetups::cauteries, &ToolSetups::scalpels, &ToolSetups::probes,
                 &ToolSetups::clip_appliers);
};

// Calls visit(list) for the list of each kind of tool, of ToolSetups or ToolLists (tool/tool_lists.h).
template <class Lists, class Visit>
void for_each_kind(Lists& lists, Visit&& visit) {
  std::apply([&](auto... list) { (visit(lists.*list), ...); }, Lists::fields);
}
// Calls visit(tool) for each tool.
template <class Lists, class Visit>
void for_each_tool(Lists& lists, Visit&& visit) {
  for_each_kind(lists, [&](auto& list) {
    for (auto& tool : list) visit(tool);
  });
}

}  // namespace lobe
