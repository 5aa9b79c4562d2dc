// A needle sews: an arc whose tip punctures the surface of the body, and which guides the tissue that it goes
// through (forces/needles.h). Its position is the centre of its circle. A thread at its end goes through the
// bites that it has made.
#pragma once

#include "lobe/tool/growing_path.h"
#include "lobe/tool/needle_body.h"
#include "lobe/tool/tool_pose.h"

namespace lobe {

// Adds a needle at a pose. Its id is what tools().next_id() says before.
struct BringNeedle {
  static constexpr bool needs_grains = false;
  std::string name;
  NeedleSettings settings;
  ToolPose pose;
  std::optional<int> thread = {};  // as in setup/needle_setup.h
  ThreadMaterial material = {};
  double thread_length = 0.45;
  Eigen::Vector4d turn() const { return pose.orientation; }
  void check(Index vertex_count, const Options& used) const;
  bool operator==(const BringNeedle&) const = default;
  static constexpr auto fields =
      std::tuple(&BringNeedle::name, &BringNeedle::settings, &BringNeedle::pose, &BringNeedle::thread,
                 &BringNeedle::material, &BringNeedle::thread_length);
};

struct Needle {
  using Path = NeedleSetup;
  using Bring = BringNeedle;
  ToolId id = 0;
  std::string name;
  NeedleSettings settings;
  std::optional<int> thread = {};
  ThreadMaterial material = {};
  double thread_length = 0.45;          // [m]
  std::vector<TieSetup> ties = {};      // as in setup/needle_setup.h
  GrowingPath path;                     // centres and orientations
  bool release = false;                 // whether it is taken away after the last row
  bool is_live = false;                 // whether its path grows
  bool is_away = false;                 // whether a live one was taken away
  ToolPose pose;                        // pose where a live one was brought
  std::optional<ToolPose> target = {};  // pose at the end of the next frame
  // Means over the last frame of its force on the body [N], and of the torque about its centre [N m].
  Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();

  Needle() = default;
  explicit Needle(const NeedleSetup& setup)
      : name(setup.name),
        settings(setup.settings),
        thread(setup.thread),
        material(setup.material),
        thread_length(setup.thread_length),
        ties(setup.ties),
        path(setup.path),
        release(setup.release) {}
  explicit Needle(const BringNeedle& command)
      : name(command.name),
        settings(command.settings),
        thread(command.thread),
        material(command.material),
        thread_length(command.thread_length),
        is_live(true),
        pose(command.pose) {}

  void lead(const ToolPose& to) { target = to; }
  void let_go() { release = true; }
  bool has_gone() const { return release; }
  void settle() { path.settle(); }
  bool has_ended(double time) const { return is_away && (path.empty() || path.back().time < time); }
  bool is_on() const { return false; }
  ToolShape shape()
      const;  // a spoke from the centre to the needle's end; the arc is a line of the force term
  void begin_frame(double time, double end);
  std::vector<NeedleSetup> paths() const;
  void add_work(double, double, ToolWork&) const {}
  void append_needles(double from, double to, std::vector<NeedleBody>& needles) const;
  std::optional<PlacedTool> placed(double time, const HeldPoints& held) const;  // none: it is nowhere
  bool fits(Index vertex_count) const;

  static constexpr auto fields =
      std::tuple(&Needle::id, &Needle::name, &Needle::settings, &Needle::thread, &Needle::material,
                 &Needle::thread_length, &Needle::ties, &Needle::path, &Needle::release, &Needle::is_live,
                 &Needle::is_away, &Needle::pose, &Needle::target, &Needle::force, &Needle::torque);

 private:
  double goes() const;
};

}  // namespace lobe
