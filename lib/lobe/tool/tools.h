// All tools of a world. Tools of a scene follow their paths. Others are added, moved and taken away while the
// world runs: by commands (tool_lists.h), which an application gives to World::apply().
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "lobe/body/model.h"
#include "lobe/tool/gone_tools.h"
#include "lobe/tool/tool_lists.h"

namespace lobe {

class Tools {
 public:
  explicit Tools(const ToolSetups& setups);

  // ---- To make, move and remove tools. These throw InputError for a tool that does not exist or follows a
  // path.

  ToolId next_id() const { return next_; }
  // Adds the tool of a command: TakeHold, BringCautery, … A grasp takes hold at the start of the next frame.
  // Other tools are off at first.
  template <class Bring>
  void bring(const Bring& command);
  void lead(ToolId id, const ToolPose& target);  // moves it there by the end of the next frame
  // Takes a cautery or scalpel away now. At the start of the next frame a grasp lets go, or a probe vanishes.
  void let_go(ToolId id);
  void turn_on(ToolId id, bool on);  // a cautery burns, a scalpel cuts, jaws close; throws for a grasp

  // The tools that do something, or did in the last frame.
  const ToolLists& lists() const { return lists_; }
  const Grasp* grasp(ToolId id) const;  // null if there is none
  // Calls visit(tool) for the tool of this id. False if there is none.
  template <class Visit>
  bool visit(ToolId id, Visit&& visit) const {
    return visit_in(lists_, id, visit) || (id > 0 && !is_present(id) && gone_.visit(id, visit));
  }
  std::vector<ToolId> held_by_hands() const;  // live tools that have not been let go
  // What the tools have done so far, as the tools of a setup.
  ToolSetups paths() const;
  ToolSetups live_paths() const;  // the paths of live tools alone

  // ---- A frame

  // Extends the paths of tools that are moved by hand, from `time` on for the duration [s]. Sets those aside
  // that do nothing any more.
  void begin_frame(double time, double duration);
  // Takes hold of the vertices that exist(v), and lets go, as the paths say at this time. position(v) gives x
  // [m], displacement(v) gives u [m]. Returns whether anything changed.
  template <class Displacement, class Position, class Exists>
  bool update_grasps(double time, HeldVertices& held, Displacement&& displacement, Position&& position,
                     Exists&& exists);
  // The next time after `time` at which a grasp takes hold or lets go, infinite if there is none. [s]
  double next_grasp_change(double time) const;
  ToolWork work(double from, double to) const;
  // The rigid bodies with which tools touch the organ between two times. Valid until tools change.
  const std::vector<ToolBody>& bodies(double from, double to);
  const std::vector<NeedleBody>& needles(double from, double to);  // needles between two times, likewise
  void cut_by(ToolId id, const CutWork& work, const Vec3d& way, const Vec3d& tip);

  // ---- A step

  // Places the grasps at a time, at most the end of the frame, so that no later row of a path matters.
  void place(double time);
  // Displacement of a vertex that a grasp holds [m]; `rest`: its rest position [m].
  Vec3d displacement(const HeldVertices::Held& item, const Vec3d& rest) const;
  Vec3d position(const Grasp& grasp) const { return grasp.centre + placed_[place_of(grasp.id)].offset; }
  // Forces of grasps on the body: −f of the grasped vertices, summed over steps of dt [s]. A frame in which a
  // grasp takes hold or lets go has several parts. begin_forces() begins a part, or repeats it.
  void begin_forces();
  void add_force(ToolId holder, const Vec3d& force, const Vec3d& x, double dt);
  void add_force(const OnTool& on_tool, double dt);
  void end_forces(double duration);  // duration of the part [s]; means are then those from the frame's start

  // ---- For checkpoints

  struct State : ToolLists {
    ToolId next = 1;
    GoneTools gone = {};
    static constexpr auto fields = std::tuple_cat(ToolLists::fields, std::tuple(&State::next, &State::gone));
  };
  State state() const { return {lists_, next_, gone_}; }
  void set_state(const State& state);
  // Whether a state can belong to a world whose setup has these tools, and which has so many vertices now.
  static bool fits(const State& state, Index vertex_count, const ToolSetups& setups);

  // Where the tools are, for pictures and recordings. position(v) gives x [m].
  template <class Position>
  std::vector<PlacedTool> placed(double time, const HeldVertices& held, Position&& position) const;

 private:
  struct Placed {
    Vec3d offset = Vec3d::Zero();
    bool is_rotated = false;
    Mat3<double> rotation = Mat3<double>::Identity();
  };

  struct Impulse {
    Vec3d linear = Vec3d::Zero(), angular = Vec3d::Zero();  // [N s], [N m s]
    double grip = 0;                                        // [N s]
  };

  template <class Lists, class Visit>
  static bool visit_in(Lists& lists, ToolId id, Visit&& visit) {
    bool found = false;
    for_each_tool(lists, [&](auto& tool) {
      if (tool.id != id) return;
      found = true;
      visit(tool);
    });
    return found;
  }
  template <class Visit>
  void visit_live(ToolId id, Visit&& visit);
  void set_aside(double time);
  void list_present();
  std::size_t place_of(ToolId id) const {
    return std::size_t(std::lower_bound(present_.begin(), present_.end(), id) - present_.begin());
  }
  bool is_present(ToolId id) const { return std::binary_search(present_.begin(), present_.end(), id); }
  template <class IsWanted>
  ToolSetups paths_of(IsWanted&& is_wanted) const;

  ToolLists lists_;
  GoneTools gone_;
  std::vector<ToolId> present_;  // ids of lists_, in ascending order
  ToolId next_ = 1;
  double frame_end_ = 0;                              // [s]
  std::vector<Placed> placed_;                        // places in the order of present_, as the impulses
  std::vector<Impulse> impulses_, impulses_of_part_;  // sums over the frame, and over the present part
  double time_felt_ = 0;                              // time in which impulses_ were found [s]
  std::vector<ToolBody> bodies_;
  std::vector<NeedleBody> needles_;
};

template <class Bring>
void Tools::bring(const Bring& command) {
  for_each_kind(lists_, [&](auto& tools) {
    using Kind = typename std::remove_reference_t<decltype(tools)>::value_type;
    if constexpr (std::is_same_v<typename Kind::Bring, Bring>) tools.emplace_back(command).id = next_++;
  });
  present_.push_back(next_ - 1);
  placed_.emplace_back();
}

template <class Displacement, class Position, class Exists>
bool Tools::update_grasps(double time, HeldVertices& held, Displacement&& displacement, Position&& position,
                          Exists&& exists) {
  bool changed = false;
  for (Grasp& grasp : lists_.grasps) {
    if (grasp.phase == Grasp::Phase::waiting && time >= grasp.takes_hold_at() - just_before) {
      double sum = 0;
      grasp.centre.setZero();
      for (std::size_t i = 0; i < grasp.vertices.size(); ++i) {
        const Index v = grasp.vertices[i];
        if (!exists(v)) continue;
        held.hold({v, grasp.id, displacement(v), Vec3d::Zero(), all_axes, grasp.share_of(i)});
        grasp.centre += grasp.share_of(i) * position(v);
        sum += grasp.share_of(i);
      }
      if (sum > 0) grasp.centre /= sum;
      grasp.phase = Grasp::Phase::holding;
      changed = true;
    }
    if (grasp.phase == Grasp::Phase::holding && time >= grasp.lets_go_at() - just_before) {
      held.release(grasp.id);
      grasp.phase = Grasp::Phase::released;
      changed = true;
    }
  }
  return changed;
}

template <class Position>
std::vector<PlacedTool> Tools::placed(double time, const HeldVertices& held, Position&& position) const {
  const HeldPoints points_of = [&](ToolId id) {
    std::vector<std::pair<Index, Vec3d>> points;
    for (const auto* items : {&held.all(), &held.partly()})
      for (const HeldVertices::Held& item : *items)
        if (item.holder == id) points.emplace_back(item.vertex, position(item.vertex));
    return points;
  };
  std::vector<PlacedTool> all;
  for_each_tool(lists_, [&](const auto& tool) {
    if (std::optional<PlacedTool> placed = tool.placed(time, points_of)) all.push_back(*std::move(placed));
  });
  return all;
}

}  // namespace lobe
