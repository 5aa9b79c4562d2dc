// A clip applier closes clips on what lies between its jaws (forces/clips.h).
#pragma once

#include "lobe/tool/growing_path.h"
#include "lobe/tool/tool_pose.h"

namespace lobe {

// Adds a clip applier at a pose. Its id is what tools().next_id() says before. Each time it is switched on it
// closes a clip, where it is at the start of the next frame.
struct BringClipApplier {
  static constexpr bool needs_grains = false;
  std::string name;
  ClipShape clip;
  Vec3d position = Vec3d::Zero();           // place of the middle of the clip [m]
  Eigen::Vector4d orientation{0, 0, 0, 1};  // unit quaternion x, y, z, w: axes of ClipShape
  Eigen::Vector4d turn() const { return orientation; }
  void check(Index vertex_count, const Options& used) const;
  bool operator==(const BringClipApplier&) const = default;
  static constexpr auto fields = std::tuple(&BringClipApplier::name, &BringClipApplier::clip,
                                            &BringClipApplier::position, &BringClipApplier::orientation);
};

struct ClipApplier {
  using Path = ClipApplierSetup;
  using Bring = BringClipApplier;
  ToolId id = 0;
  std::string name;
  ClipShape clip;
  GrowingPath closed;  // times and places of closed clips; for an applier of a scene, of clips to close
  bool is_live = false;
  bool is_shut = false;                 // whether a live one is shut
  bool is_closing = false;              // whether a clip closes when the next frame begins
  bool is_away = false;                 // whether a live one was taken away
  ToolPose pose;                        // pose of a live one
  std::optional<ToolPose> target = {};  // pose at the end of the next frame

  ClipApplier() = default;
  explicit ClipApplier(const ClipApplierSetup& setup)
      : name(setup.name), clip(setup.clip), closed(setup.path) {}
  explicit ClipApplier(const BringClipApplier& command)
      : name(command.name), clip(command.clip), is_live(true), pose{command.position, command.orientation} {}

  void lead(const ToolPose& to) { target = to; }
  void let_go() { is_shut = is_closing = false, is_away = true; }
  bool has_gone() const { return is_away; }
  bool has_ended(double time) const { return is_away && (closed.empty() || closed.back().time < time); }
  void settle() { closed.settle(); }
  void turn_on(bool on);
  bool is_on() const { return is_shut; }
  ToolShape shape() const;
  void begin_frame(double time, double end);
  std::vector<ClipApplierSetup> paths() const;
  void add_work(double from, double to, ToolWork& work) const;
  std::optional<PlacedTool> placed(double time, const HeldPoints& held) const;  // none: it is nowhere
  bool fits(Index vertex_count) const;

  static constexpr auto fields =
      std::tuple(&ClipApplier::id, &ClipApplier::name, &ClipApplier::clip, &ClipApplier::closed,
                 &ClipApplier::is_live, &ClipApplier::is_shut, &ClipApplier::is_closing,
                 &ClipApplier::is_away, &ClipApplier::pose, &ClipApplier::target);
};

}  // namespace lobe
