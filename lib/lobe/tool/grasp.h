// A grasp moves vertices along a path. The path is relative to where it took hold.
#pragma once

#include "lobe/tool/growing_path.h"
#include "lobe/tool/tool_pose.h"

namespace lobe {

// Adds a grasp that takes hold of vertices at the start of the next frame. Its id is what tools().next_id()
// says before.
struct TakeHold {
  static constexpr bool needs_grains = false;
  std::string name;
  std::vector<Index> vertices;
  void check(Index vertex_count, const Options& used) const;
  bool operator==(const TakeHold&) const = default;
  static constexpr auto fields = std::tuple(&TakeHold::name, &TakeHold::vertices);
};

struct Grasp {
  using Path = GraspSetup;
  using Bring = TakeHold;
  enum class Phase : std::uint8_t { waiting, holding, released };
  ToolId id = 0;
  std::string name;
  std::vector<Index> vertices;
  std::vector<double> shares;  // held share of each vertex, as in GraspSetup
  GrowingPath path;            // path of its centre: offsets from where it took hold, and turns since
  bool release = false;        // whether it lets go after the last row
  bool is_live = false;        // whether its path grows
  Phase phase = Phase::waiting;
  Vec3d centre = Vec3d::Zero();         // mean of its vertices where it took hold [m]
  std::optional<ToolPose> target = {};  // pose at the end of the next frame
  // Means over the last frame: force on the body [N], and torque about its present centre [N m].
  Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();

  Grasp() = default;
  explicit Grasp(const GraspSetup& setup)
      : name(setup.name),
        vertices(setup.vertices),
        shares(setup.shares),
        path(setup.path),
        release(setup.release) {}
  explicit Grasp(const TakeHold& command) : name(command.name), vertices(command.vertices), is_live(true) {}

  void lead(const ToolPose& to) { target = to; }
  void let_go() { release = true; }
  bool has_gone() const { return release; }
  void settle() { path.settle(); }
  bool has_ended(double time) const { return phase == Phase::released && path.back().time < time; }
  bool is_on() const { return phase == Phase::holding; }
  ToolShape shape() const { return {}; }
  void begin_frame(double time, double end);
  std::vector<GraspSetup> paths() const;
  void add_work(double, double, ToolWork&) const {}
  std::optional<PlacedTool> placed(double time, const HeldPoints& held) const;  // none: it holds nothing
  bool fits(Index vertex_count) const;

  double share_of(std::size_t place) const { return shares.empty() ? 1 : shares[place]; }

  // The times when it takes hold and lets go by its present path; infinite if the path does not say.
  double takes_hold_at() const;
  double lets_go_at() const;

  static constexpr auto fields = std::tuple(&Grasp::id, &Grasp::name, &Grasp::vertices, &Grasp::shares,
                                            &Grasp::path, &Grasp::release, &Grasp::is_live, &Grasp::phase,
                                            &Grasp::centre, &Grasp::target, &Grasp::force, &Grasp::torque);
};

}  // namespace lobe
