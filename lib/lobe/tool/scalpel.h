// A scalpel cuts with an edge that leads from its tip to its heel (scalpel/blades.h).
#pragma once

#include "lobe/tool/tool_pose.h"

namespace lobe {

// Brings a scalpel, which does not cut yet, to a pose; its id is tools().next_id() before.
struct BringScalpel {
  std::string name;
  BladePose pose;
  double snap = 0.1;  // setup/tool_setups.h
  void check(Index vertex_count, const Options& used) const;
  bool operator==(const BringScalpel&) const = default;
  static constexpr auto fields = std::tuple(&BringScalpel::name, &BringScalpel::pose, &BringScalpel::snap);
};

struct Scalpel {
  using Path = ScalpelSetup;
  using Bring = BringScalpel;
  // From when it begins to cut to when it stops: positions of the tip, and of the heel in each row [m].
  struct Stroke {
    std::vector<PathPoint> tips;
    std::vector<Vec3d> heels;
    BladePose at(double time) const;
    static constexpr auto fields = std::tuple(&Stroke::tips, &Stroke::heels);
  };
  ToolId id = 0;
  std::string name;
  double snap = 0.1;
  std::vector<Stroke> strokes;  // the last is the present one
  bool is_live = false;
  bool cuts = false;                    // only of live ones
  bool is_away = false;                 // of live ones: taken away, and nowhere since
  BladePose pose;                       // of a live one
  Vec3d blade = Vec3d::Zero();          // of a live one: from tip to heel when it was brought [m]
  std::optional<ToolPose> target = {};  // at the end of the next frame, turned since it was brought

  Scalpel() = default;
  explicit Scalpel(const ScalpelSetup& setup)
      : name(setup.name), snap(setup.snap), strokes{{setup.path, setup.heels}} {}
  explicit Scalpel(const BringScalpel& command)
      : name(command.name),
        snap(command.snap),
        is_live(true),
        pose(command.pose),
        blade(command.pose.heel - command.pose.tip) {}

  void lead(const ToolPose& to) { target = to; }
  void let_go() { cuts = false, is_away = true; }
  bool has_gone() const { return is_away; }
  void turn_on(bool on);
  bool is_on() const { return cuts; }
  ToolShape shape() const { return {.blade = pose.heel - pose.tip}; }
  void begin_frame(double time, double end);
  std::vector<ScalpelSetup> paths() const;
  void add_work(double from, double to, ToolWork& work) const;
  std::optional<PlacedTool> placed(double time, const HeldPoints& held) const;  // none: it is nowhere
  bool fits(Index vertex_count) const;

  static constexpr auto fields =
      std::tuple(&Scalpel::id, &Scalpel::name, &Scalpel::snap, &Scalpel::strokes, &Scalpel::is_live,
                 &Scalpel::cuts, &Scalpel::is_away, &Scalpel::pose, &Scalpel::blade, &Scalpel::target);
};

}  // namespace lobe
