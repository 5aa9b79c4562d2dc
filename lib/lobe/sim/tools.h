// The instruments of a scene, played along their paths: grasps hold vertices, cauteries sweep.
#pragma once

#include <optional>
#include <vector>

#include "lobe/cut/cautery.h"
#include "lobe/setup/boundary_conditions.h"

namespace lobe {

class Tools {
 public:
  explicit Tools(const Setup& setup) : grasps_(setup.grasps), cauteries_(setup.cauteries) {
    state_.assign(grasps_.size(), GraspState::waiting);
  }

  // Takes hold of the vertices that exist(v), and lets go, as the paths say at this time. displacement(v)
  // gives u [m]. Returns whether anything changed.
  template <class Displacement, class Exists>
  bool update_grasps(double time, HeldVertices& held, Displacement&& displacement, Exists&& exists) {
    bool changed = false;
    for (std::size_t g = 0; g < grasps_.size(); ++g) {
      const GraspSetup& grasp = grasps_[g];
      if (state_[g] == GraspState::waiting && time >= grasp.path.front().time - just_before) {
        for (Index v : grasp.vertices)
          if (exists(v)) held.hold({v, holder(g), displacement(v), Vec3d::Zero()});
        state_[g] = GraspState::holding;
        changed = true;
      }
      if (state_[g] == GraspState::holding && grasp.release && time >= grasp.path.back().time - just_before) {
        held.release(holder(g));
        state_[g] = GraspState::released;
        changed = true;
      }
    }
    return changed;
  }

  // The next time after `time` at which a grasp takes hold or lets go, infinite if there is none. [s]
  double next_grasp_change(double time) const;

  // Displacement of a vertex that a grasp holds: the path's offset from where it was taken hold of. [m]
  Vec3d grasped(const HeldVertices::Held& item, double time) const {
    return item.start + path_at(grasps_[std::size_t(item.holder - 1)].path, time);
  }

  // What the grasps do, to be kept and given back.
  enum class GraspState : std::uint8_t { waiting, holding, released };
  const std::vector<GraspState>& grasp_states() const { return state_; }
  void set_grasp_states(const std::vector<GraspState>& states) { state_ = states; }

  // What the cauteries sweep between two times.
  std::vector<Sweep> sweeps(double from, double to) const;

  // Where the tools are, for pictures and recordings.
  struct Pose {
    std::string name;
    ToolType type = ToolType::grasp;
    double radius = 0;               // [m]
    Vec3d position = Vec3d::Zero();  // [m]
    std::vector<Index> vertices;     // held
  };
  template <class Position>
  std::vector<Pose> poses(double time, const HeldVertices& held, Position&& position_of) const {
    std::vector<Pose> poses;
    for (std::size_t g = 0; g < grasps_.size(); ++g) {
      Pose pose{grasps_[g].name, ToolType::grasp, 0, Vec3d::Zero(), {}};
      for (const HeldVertices::Held& item : held.all())
        if (item.holder == holder(g)) {
          pose.vertices.push_back(item.vertex);
          pose.position += position_of(item.vertex);
        }
      if (pose.vertices.empty()) continue;
      pose.position /= double(pose.vertices.size());
      poses.push_back(std::move(pose));
    }
    for (const CauterySetup& c : cauteries_)
      if (time >= c.path.front().time && time <= c.path.back().time)
        poses.push_back({c.name, ToolType::cautery, c.radius, path_at(c.path, time), {}});
    return poses;
  }

 private:
  static constexpr double just_before = 1e-9;  // times are sums of steps [s]
  static int holder(std::size_t grasp) { return 1 + static_cast<int>(grasp); }

  std::vector<GraspSetup> grasps_;
  std::vector<CauterySetup> cauteries_;
  std::vector<GraspState> state_;
};

}  // namespace lobe
