// A scalpel cuts with an edge that leads from its tip to its heel (scalpel/blades.h).
#pragma once

#include "lobe/tool/growing_path.h"
#include "lobe/tool/tool_pose.h"

namespace lobe {

// Adds a scalpel at a pose, switched off. Its id is what tools().next_id() says before.
struct BringScalpel {
  static constexpr bool needs_grains = true;  // grains of the body, before it cuts (scalpel/grains.h)
  std::string name;
  BladePose pose;
  double snap = 0.1;         // share, as in setup/tool_setups.h
  bool along_faces = false;  // as in setup/tool_setups.h
  void check(Index vertex_count, const Options& used) const;
  bool operator==(const BringScalpel&) const = default;
  static constexpr auto fields =
      std::tuple(&BringScalpel::name, &BringScalpel::pose, &BringScalpel::snap, &BringScalpel::along_faces);
};

struct Scalpel {
  using Path = ScalpelSetup;
  using Bring = BringScalpel;
  // The way from where it begins to cut to where it stops: tip and heel at the same times [m].
  struct Stroke {
    GrowingPath tips, heels;
    void push_back(double time, const BladePose& at);
    BladePose at(double time) const;  // takes the rows at hand
    static constexpr auto fields = std::tuple(&Stroke::tips, &Stroke::heels);
  };
  ToolId id = 0;
  std::string name;
  double snap = 0.1;
  bool along_faces = false;
  std::vector<Stroke> strokes;  // the last is the present one
  bool is_live = false;
  bool cuts = false;                    // whether a live one cuts
  bool is_away = false;                 // whether a live one was taken away
  BladePose pose;                       // pose of a live one
  Vec3d blade = Vec3d::Zero();          // vector from tip to heel when a live one was brought [m]
  std::optional<ToolPose> target = {};  // pose at the end of the next frame, turned since it was brought
  // Force of the blade on the body, and its torque about the tip: means over the last frame [N], [N m]. The
  // force is the energy that the opened area takes (Elastic::fracture_energy), divided by the way of the
  // blade through the tissue.
  Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();

  Scalpel() = default;
  explicit Scalpel(const ScalpelSetup& setup);
  explicit Scalpel(const BringScalpel& command)
      : name(command.name),
        snap(command.snap),
        along_faces(command.along_faces),
        is_live(true),
        pose(command.pose),
        blade(command.pose.heel - command.pose.tip) {}

  void lead(const ToolPose& to) { target = to; }
  void let_go() { cuts = false, is_away = true; }
  bool has_gone() const { return is_away; }
  bool has_ended(double time) const;
  void settle();
  void turn_on(bool on);
  bool is_on() const { return cuts; }
  ToolShape shape() const { return {.blade = pose.heel - pose.tip}; }
  void begin_frame(double time, double end);
  // Adds the work of one step. The blade has moved by `way` [m]; at the end its tip is at `tip` [m].
  void cut_by(const CutWork& work, const Vec3d& way, const Vec3d& tip);
  std::vector<ScalpelSetup> paths() const;
  void add_work(double from, double to, ToolWork& work) const;
  std::optional<PlacedTool> placed(double time, const HeldPoints& held) const;  // none: it is nowhere
  bool fits(Index vertex_count) const;

  // Sums over the present frame.
  CutWork work = {};
  double length = 0;          // length of the way [m]
  Vec3d way = Vec3d::Zero();  // [m]

  static constexpr auto fields =
      std::tuple(&Scalpel::id, &Scalpel::name, &Scalpel::snap, &Scalpel::along_faces, &Scalpel::strokes,
                 &Scalpel::is_live, &Scalpel::cuts, &Scalpel::is_away, &Scalpel::pose, &Scalpel::blade,
                 &Scalpel::target, &Scalpel::force, &Scalpel::torque);
};

}  // namespace lobe
