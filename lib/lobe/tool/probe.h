// A probe is a rigid body that presses on the organ and rubs along it (contact/contact.h), or a pair of jaws
// that close on the organ. Jaws that are moved by hand close while the probe is on, until they meet or their
// force reaches most_grip. Switched off, they open to where they were.
#pragma once

#include "lobe/tool/body_on_path.h"
#include "lobe/tool/tool_pose.h"

namespace lobe {

// Adds a probe at a pose. Its id is what tools().next_id() says before.
struct BringProbe {
  static constexpr bool needs_grains = false;
  std::string name;
  RigidShape shape;
  ToolPose pose;
  double friction = default_friction;
  Eigen::Vector4d turn() const { return pose.orientation; }
  void check(Index vertex_count, const Options& used) const;
  bool operator==(const BringProbe&) const = default;
  static constexpr auto fields =
      std::tuple(&BringProbe::name, &BringProbe::shape, &BringProbe::pose, &BringProbe::friction);
};

inline constexpr double jaw_speed = 0.02;  // speed at which hands close and open jaws [m/s]
inline constexpr double most_grip = 6;     // force at which hands stop closing them [N]

struct Probe {
  using Path = ProbeSetup;
  using Bring = BringProbe;
  ToolId id = 0;
  std::string name;
  RigidShape shape_of_tip;
  double friction = default_friction;
  GrowingPath path;                     // positions and orientations
  bool release = false;                 // whether it is taken away after the last row
  bool is_live = false;                 // whether its path grows
  bool is_away = false;                 // whether a live one was taken away
  bool closes = false;                  // whether live jaws close
  ToolPose pose;                        // pose where a live one was brought
  std::optional<ToolPose> target = {};  // pose at the end of the next frame
  double grip = 0;                      // force of jaws on what is between them, mean over the last frame [N]
  // Means over the last frame of its force on the body [N], and of the torque about its position [N m].
  Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();

  Probe() = default;
  explicit Probe(const ProbeSetup& setup)
      : name(setup.name),
        shape_of_tip(setup.shape),
        friction(setup.friction),
        path(setup.path),
        release(setup.release) {}
  explicit Probe(const BringProbe& command)
      : name(command.name),
        shape_of_tip(command.shape),
        friction(command.friction),
        is_live(true),
        pose(command.pose) {}

  void lead(const ToolPose& to) { target = to; }
  void let_go() { release = true; }
  bool has_gone() const { return release; }
  void settle() { path.settle(); }
  bool has_ended(double time) const { return is_away && (path.empty() || path.back().time < time); }
  void turn_on(bool on) { closes = on; }
  bool is_on() const { return closes; }
  ToolShape shape() const;  // present shape
  void begin_frame(double time, double end);
  std::vector<ProbeSetup> paths() const;
  void add_work(double, double, ToolWork&) const {}
  void append_bodies(double from, double to, std::vector<ToolBody>& bodies) const;
  std::optional<PlacedTool> placed(double time, const HeldPoints& held) const;  // none: it is nowhere
  bool fits(Index vertex_count) const;

  static constexpr auto fields =
      std::tuple(&Probe::id, &Probe::name, &Probe::shape_of_tip, &Probe::friction, &Probe::path,
                 &Probe::release, &Probe::is_live, &Probe::is_away, &Probe::closes, &Probe::pose,
                 &Probe::target, &Probe::grip, &Probe::force, &Probe::torque);

 private:
  double goes() const;
  double opening_now() const { return path.empty() ? pose.opening.value_or(0) : path.back().opening; }
  double next_opening(const PathPoint& from, double duration) const;
};

}  // namespace lobe
