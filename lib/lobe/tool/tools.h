// Instruments: grasps that hold vertices, cauteries that sweep. Those of a scene follow their paths. Others
// are made, moved and taken away while the world runs: their path grows by a row per frame, so that what they
// did can be kept as the path of a scene, which gives the same bits.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "lobe/cut/tet_groups.h"
#include "lobe/scalpel/blades.h"
#include "lobe/setup/boundary_conditions.h"

namespace lobe {

using ToolId = int;  // above 0; of a grasp, the holder of its vertices (HeldVertices::Held)

struct ToolPose {
  Vec3d position = Vec3d::Zero();           // [m]
  Eigen::Vector4d orientation{0, 0, 0, 1};  // unit quaternion x, y, z, w; where it took hold: none

  bool operator==(const ToolPose&) const = default;
  static constexpr auto fields = std::tuple(&ToolPose::position, &ToolPose::orientation);
};

struct Grasp {
  enum class Phase : std::uint8_t { waiting, holding, released };
  ToolId id = 0;
  std::string name;
  std::vector<Index> vertices;
  std::vector<PathPoint> path;  // of its centre: offsets from where it took hold, and turns since
  bool release = false;         // after the last row
  bool is_live = false;         // its path grows
  Phase phase = Phase::waiting;
  Vec3d centre = Vec3d::Zero();         // mean of its vertices where it took hold [m]
  std::optional<ToolPose> target = {};  // at the end of the next frame
  // Means over the last frame of what it does to the body [N], and about where its centre is [N m].
  Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();

  static constexpr auto fields =
      std::tuple(&Grasp::id, &Grasp::name, &Grasp::vertices, &Grasp::path, &Grasp::release, &Grasp::is_live,
                 &Grasp::phase, &Grasp::centre, &Grasp::target, &Grasp::force, &Grasp::torque);
};

struct Cautery {
  ToolId id = 0;
  std::string name;
  double radius = 0;  // of its spherical tip [m]
  // Of its tip [m], from switching it on to switching it off; the last is the present one.
  std::vector<std::vector<PathPoint>> strokes;
  bool is_live = false;
  bool is_on = false;                // only of live ones
  bool is_away = false;              // of live ones: taken away, and nowhere since
  Vec3d position = Vec3d::Zero();    // of a live one [m]
  std::optional<Vec3d> target = {};  // at the end of the next frame

  static constexpr auto fields =
      std::tuple(&Cautery::id, &Cautery::name, &Cautery::radius, &Cautery::strokes, &Cautery::is_live,
                 &Cautery::is_on, &Cautery::is_away, &Cautery::position, &Cautery::target);
};

struct Scalpel {
  // From when it begins to cut to when it stops: positions of the tip, and of the heel in each row [m].
  struct Stroke {
    std::vector<PathPoint> tips;
    std::vector<Vec3d> heels;
    static constexpr auto fields = std::tuple(&Stroke::tips, &Stroke::heels);
  };
  ToolId id = 0;
  std::string name;
  double snap = 0.1;
  std::vector<Stroke> strokes;  // the last is the present one
  bool is_live = false;
  bool is_on = false;                   // only of live ones: it cuts
  bool is_away = false;                 // of live ones: taken away, and nowhere since
  BladePose pose;                       // of a live one
  Vec3d blade = Vec3d::Zero();          // of a live one: from tip to heel when it was brought [m]
  std::optional<ToolPose> target = {};  // at the end of the next frame, turned since it was brought

  static constexpr auto fields =
      std::tuple(&Scalpel::id, &Scalpel::name, &Scalpel::snap, &Scalpel::strokes, &Scalpel::is_live,
                 &Scalpel::is_on, &Scalpel::is_away, &Scalpel::pose, &Scalpel::blade, &Scalpel::target);
};

BladePose pose_at(const Scalpel::Stroke& stroke, double time);

class Tools {
 public:
  explicit Tools(const Setup& setup);

  // ---- Made, moved and taken away. Throws InputError for a tool that there is not, or that follows a path.

  ToolId next_id() const { return next_; }
  void add(Grasp grasp);                         // which takes hold at the start of the next frame
  void add(Cautery cautery);                     // off
  void add(Scalpel scalpel);                     // off
  void lead(ToolId id, const ToolPose& target);  // to be there at the end of the next frame
  void let_go(ToolId id);            // at the start of the next frame; a cautery or a scalpel is taken away
  void turn_on(ToolId id, bool on);  // a cautery burns, a scalpel cuts

  const std::vector<Grasp>& grasps() const { return grasps_; }
  const std::vector<Cautery>& cauteries() const { return cauteries_; }
  const std::vector<Scalpel>& scalpels() const { return scalpels_; }
  const Grasp* grasp(ToolId id) const;  // null if there is none
  const Cautery* cautery(ToolId id) const;
  const Scalpel* scalpel(ToolId id) const;

  // What has been done so far, as the tools of a setup.
  std::vector<GraspSetup> grasp_paths() const;
  std::vector<CauterySetup> cautery_paths() const;
  std::vector<ScalpelSetup> scalpel_paths() const;

  // ---- A frame

  // Paths of live tools grow by what they are to do from `time` on for the duration [s].
  void begin_frame(double time, double duration);
  // Takes hold of the vertices that exist(v), and lets go, as the paths say at this time. position(v) gives x
  // [m], displacement(v) gives u [m]. Returns whether anything changed.
  template <class Displacement, class Position, class Exists>
  bool update_grasps(double time, HeldVertices& held, Displacement&& displacement, Position&& position,
                     Exists&& exists);
  // The next time after `time` at which a grasp takes hold or lets go, infinite if there is none. [s]
  double next_grasp_change(double time) const;
  // What the cauteries sweep between two times.
  std::vector<Sweep> sweeps(double from, double to) const;
  // How blades move between two times.
  std::vector<BladeMove> blade_moves(double from, double to) const;
  // The tetrahedra that meet a box, in ascending order.
  template <class Real>
  std::vector<Index> meeting(const Topology& topology, const Mat3X<double>& points, const Mat3X<Real>& u,
                             const Eigen::AlignedBox3d& box) {
    return groups_.meeting(topology, points, u, box);
  }
  void add_copies(const std::vector<TetCopy>& copies) {
    for (const TetCopy& own : copies) groups_.add_copy(own.tet, own.copy);
  }
  // The tetrahedra that a sweep touches, in ascending order.
  template <class Real>
  std::vector<Index> touched(const Topology& topology, const Mat3X<double>& points, const Mat3X<Real>& u,
                             const Sweep& sweep) {
    return groups_.touched(topology, points, u, sweep);
  }

  // ---- A step

  // Where grasps are at a time; not later than the end of the frame, so that no row of a path that comes
  // later matters.
  void place(double time);
  // Displacement of a vertex that a grasp holds [m]; `rest`: its rest position [m].
  Vec3d displacement(const HeldVertices::Held& item, const Vec3d& rest) const;
  Vec3d position(const Grasp& grasp) const { return grasp.centre + placed_[std::size_t(grasp.id)].offset; }
  // What grasps do to the body: -f of the vertices that they hold, added up over steps of dt [s]. A frame in
  // which a grasp takes hold or lets go has several parts; begin_forces() begins one, or begins it again.
  void begin_forces();
  void add_force(ToolId holder, const Vec3d& force, const Vec3d& x, double dt);
  void end_forces(double duration);  // of the part [s]; the means are then those from the frame's start

  // Every vertex has moved by at most this in one more step [m], but for rounding; or the state is another
  // one.
  void moved(double distance, double rounding) { groups_.moved(distance, rounding); }
  void state_was_given() { groups_.forget(); }

  // ---- Kept

  struct State {
    std::vector<Grasp> grasps;
    std::vector<Cautery> cauteries;
    std::vector<Scalpel> scalpels;
    ToolId next = 1;
    static constexpr auto fields =
        std::tuple(&State::grasps, &State::cauteries, &State::scalpels, &State::next);
  };
  State state() const { return {grasps_, cauteries_, scalpels_, next_}; }
  void set_state(const State& state);
  // Whether it can be one of a world of this setup, with so many vertices now.
  static bool fits(const State& state, Index vertices, const Setup& setup);

  // Where the tools are, for pictures and recordings.
  struct Pose {
    std::string name;
    ToolType type = ToolType::grasp;
    double radius = 0;                                    // [m]
    Vec3d position = Vec3d::Zero();                       // [m]
    std::vector<Index> vertices;                          // held
    Eigen::Vector4d orientation{0, 0, 0, 1};              // unit quaternion x, y, z, w
    Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();  // on the body, means over the last frame [N], [N m]
    std::optional<Vec3d> heel = {};                       // of a scalpel, whose tip is its position [m]
  };
  template <class Position>
  std::vector<Pose> poses(double time, const HeldVertices& held, Position&& position_of) const;

 private:
  static constexpr double just_before = 1e-9;  // times are sums of steps [s]
  struct Placed {
    Vec3d offset = Vec3d::Zero();
    bool is_turned = false;
    Mat3<double> turn = Mat3<double>::Identity();
  };

  struct Impulse {
    Vec3d linear = Vec3d::Zero(), angular = Vec3d::Zero();  // [N s], [N m s]
  };

  Grasp& live_grasp(ToolId id);
  Cautery& live_cautery(ToolId id);
  Scalpel* live_scalpel(ToolId id);  // null: it is another tool
  void continue_strokes(double time);
  bool has_grasp(ToolId id) const { return grasp(id) != nullptr; }

  std::vector<Grasp> grasps_;
  std::vector<Cautery> cauteries_;
  std::vector<Scalpel> scalpels_;
  ToolId next_ = 1;
  double frame_end_ = 0;                              // [s]
  std::vector<Placed> placed_;                        // by id, as what follows
  std::vector<Impulse> impulses_, impulses_of_part_;  // since the start of the frame, and of the present part
  double time_felt_ = 0;                              // in which impulses_ were found [s]
  TetGroups groups_;
};

template <class Displacement, class Position, class Exists>
bool Tools::update_grasps(double time, HeldVertices& held, Displacement&& displacement, Position&& position,
                          Exists&& exists) {
  bool changed = false;
  for (Grasp& grasp : grasps_) {
    if (grasp.path.empty()) continue;
    if (grasp.phase == Grasp::Phase::waiting && time >= grasp.path.front().time - just_before) {
      Index count = 0;
      grasp.centre.setZero();
      for (Index v : grasp.vertices) {
        if (!exists(v)) continue;
        held.hold({v, grasp.id, displacement(v), Vec3d::Zero()});
        grasp.centre += position(v);
        ++count;
      }
      if (count > 0) grasp.centre /= count;
      grasp.phase = Grasp::Phase::holding;
      changed = true;
    }
    if (grasp.phase == Grasp::Phase::holding && grasp.release &&
        time >= grasp.path.back().time - just_before) {
      held.release(grasp.id);
      grasp.phase = Grasp::Phase::released;
      changed = true;
    }
  }
  return changed;
}

template <class Position>
std::vector<Tools::Pose> Tools::poses(double time, const HeldVertices& held, Position&& position_of) const {
  std::vector<Pose> poses;
  for (const Grasp& grasp : grasps_) {
    Pose pose{.name = grasp.name, .type = ToolType::grasp, .vertices = {}};
    for (const HeldVertices::Held& item : held.all())
      if (item.holder == grasp.id) {
        pose.vertices.push_back(item.vertex);
        pose.position += position_of(item.vertex);
      }
    if (pose.vertices.empty()) continue;
    pose.position /= double(pose.vertices.size());
    pose.orientation = turn_at(grasp.path, time);
    pose.force = grasp.force;
    pose.torque = grasp.torque;
    poses.push_back(std::move(pose));
  }
  for (const Cautery& c : cauteries_) {
    const bool burns = !c.strokes.empty() && !c.strokes.back().empty() &&
                       time >= c.strokes.back().front().time && time <= c.strokes.back().back().time;
    if ((c.is_live && !c.is_away) || burns)
      poses.push_back({.name = c.name,
                       .type = ToolType::cautery,
                       .radius = c.radius,
                       .position = c.is_live ? c.position : path_at(c.strokes.back(), time),
                       .vertices = {}});
  }
  for (const Scalpel& s : scalpels_) {
    const bool cuts = !s.strokes.empty() && !s.strokes.back().tips.empty() &&
                      time >= s.strokes.back().tips.front().time && time <= s.strokes.back().tips.back().time;
    if (!(s.is_live && !s.is_away) && !cuts) continue;
    const BladePose pose = s.is_live ? s.pose : pose_at(s.strokes.back(), time);
    poses.push_back(
        {.name = s.name, .type = ToolType::scalpel, .position = pose.tip, .vertices = {}, .heel = pose.heel});
  }
  return poses;
}

}  // namespace lobe
