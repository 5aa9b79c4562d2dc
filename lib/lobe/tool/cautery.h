// A cautery burns away the tetrahedra that its spherical tip touches, or its hook: a wire from the tip on.
// With a core, a thinner rigid wire inside, it also lifts and pushes tissue (contact/contact.h), on or off.
#pragma once

#include "lobe/tool/body_on_path.h"
#include "lobe/tool/tool_pose.h"

namespace lobe {

// Adds a cautery at a position, switched off. Its id is what tools().next_id() says before.
struct BringCautery {
  static constexpr bool needs_grains = false;
  std::string name;
  double radius = 0;               // radius of its tip and of its hook [m], > 0
  Vec3d position = Vec3d::Zero();  // place of its tip [m]
  Vec3d hook = Vec3d::Zero();      // vector from its tip to the end of the hook [m]; zero: it has none
  double core = 0;                 // radius of the rigid wire in it [m], below `radius`; 0: it has none
  void check(Index vertex_count, const Options& used) const;
  bool operator==(const BringCautery&) const = default;
  static constexpr auto fields =
      std::tuple(&BringCautery::name, &BringCautery::radius, &BringCautery::position, &BringCautery::hook,
                 &BringCautery::core);
};

struct Cautery {
  using Path = CauterySetup;
  using Bring = BringCautery;
  ToolId id = 0;
  std::string name;
  double radius = 0;  // radius of its spherical tip [m]
  // Positions of its tip [m], one list for each time it was on; the last is the present one.
  std::vector<GrowingPath> strokes;
  bool is_live = false;                 // brought by a command and led by hand; others follow a scene
  bool burns = false;                   // whether it is on; always false in a tool that is not live
  bool is_away = false;                 // whether a live one was taken away
  Vec3d hook = Vec3d::Zero();           // vector from its tip to the end of the hook [m], before it turns
  ToolPose pose;                        // pose of a live one
  std::optional<ToolPose> target = {};  // pose at the end of the next frame
  RigidShape core;                      // a capsule along z, or a sphere; of radius 0: there is none
  GrowingPath core_path;                // path of a core: positions, and turns of z
  bool has_left = false;                // whether nothing feels the core of a live one any more
  // Means over the last frame: the force of its core on the body [N], and its torque about the tip [N m].
  Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();

  Cautery() = default;
  explicit Cautery(const CauterySetup& setup);
  explicit Cautery(const BringCautery& command);

  void lead(const ToolPose& to) { target = to; }
  void let_go() { burns = false, is_away = true; }
  bool has_gone() const { return is_away; }
  bool has_ended(double time) const;
  void settle();
  void turn_on(bool on);
  bool is_on() const { return burns; }
  ToolShape shape() const { return {.radius = radius, .blade = hook}; }
  void begin_frame(double time, double end);
  std::vector<CauterySetup> paths() const;     // paths of a live one without its core
  std::vector<ProbeSetup> core_paths() const;  // paths of the core, as a probe with the same forces
  void add_work(double from, double to, ToolWork& work) const;
  void append_bodies(double from, double to, std::vector<ToolBody>& bodies) const;
  std::optional<PlacedTool> placed(double time, const HeldPoints& held) const;  // none: it is nowhere
  bool fits(Index vertex_count) const;
  Vec3d wire_at(const Eigen::Vector4d& orientation) const;  // vector from its tip to the end of its hook [m]

  static constexpr auto fields =
      std::tuple(&Cautery::id, &Cautery::name, &Cautery::radius, &Cautery::strokes, &Cautery::is_live,
                 &Cautery::burns, &Cautery::is_away, &Cautery::hook, &Cautery::pose, &Cautery::target,
                 &Cautery::core, &Cautery::core_path, &Cautery::has_left, &Cautery::force, &Cautery::torque);

 private:
  double core_goes() const;
  void move_core(double time, double end, const ToolPose& from);
  PathPoint core_at(double time, const ToolPose& at) const;
};

}  // namespace lobe
