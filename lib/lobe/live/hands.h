// The hands of all controllers. Their commands (live/hand_command.h) become commands of the world
// (sim/command.h).
#pragma once

#include <string>
#include <vector>

#include "lobe/linearity/command_sink.h"
#include "lobe/live/hand_queue.h"
#include "lobe/live/messages.h"
#include "lobe/live/pose_filter.h"
#include "lobe/sim/world.h"

namespace lobe {

template <class Real>
class Hands {
 public:
  Hands(World<Real>& world, CommandSink apply, const HandQueue& controllers, Messages& messages,
        const HandLimits& limits)
      : world_(world),
        apply_(std::move(apply)),
        controllers_(controllers),
        messages_(messages),
        limits_(limits) {}

  // Performs take_at_ray, take_at_point, bring, lead, turn_on or let_go. Throws InputError for a command that
  // is malformed, and then has done nothing. A grasp that finds nothing gives the message `missed`; the hand
  // is then empty.
  void perform_command(int controller, const HandCommand& command);
  // Puts a hand at a pose, without the lag of a lead command. Does nothing if the hand has no tool.
  void place(int controller, HandNumber number, const ToolPose& pose);
  struct LedTool {
    ToolId tool = 0;  // 0: the hand is empty, or its grasp has not taken hold yet
    ToolPose pose = {};
  };
  LedTool led_tool(int controller, HandNumber number) const;
  int drop(int controller);          // lets a controller's hands let go; returns how many held something
  void forget() { hands_.clear(); }  // call it after the world went back: its tools are gone

  // Empties hands whose tools the application has let go of between two frames, and says so.
  void notice_gone_tools();
  void before_frame(double duration);  // leads the tools [s]
  void after_frame();                  // notes which grasps hold and which slip

  void say(const std::string& name, const std::string& text) { messages_.say(world_.time(), name, text); }
  void tell(std::vector<HandStatus>& hands) const;  // appends the status of each hand that holds a tool
  // The controllers that have hands, each once.
  std::vector<int> controllers() const;

 private:
  struct Hand {
    int controller = 0;
    HandNumber number = 0;
    ToolId tool = 0;                   // 0: empty
    bool is_placed = false;            // poses act at once, without lag
    bool is_leading = false;           // poses move the tool; a grasp first takes hold
    Vec3d arm = Vec3d::Zero();         // arm from where it took hold to the centre of what it holds [m]
    Eigen::Vector4d turn{0, 0, 0, 1};  // orientation when it was brought: a quaternion x, y, z, w
    Index vertices = 0;                // vertices that it holds
    double looked = 0;                 // when its blade was last looked at [s]
    bool is_told = false;              // whether it was said that its blade cuts inside the body
    PoseFilter filter = {};
  };

  void take_hold(int controller, const HandCommand& command);
  void bring(int controller, const HandCommand& command);
  void lead(const HandCommand& command, Hand& hand);
  void turn_on(const HandCommand& command, Hand& hand);
  void let_go(Hand& hand);
  void warn_of_inside(const Hand& hand, const Vec3d& position);
  void watch_blade(Hand& hand);
  bool lies_in_body(const Vec3d& point) const;
  Hand* find(int controller, HandNumber number);
  const Hand* find(int controller, HandNumber number) const;
  Hand& empty_hand(int controller, HandNumber number);
  Hand& full_hand(int controller, const HandCommand& command);
  std::string name_of(int controller, HandNumber number) const;
  std::vector<Index> free_within(const Vec3d& point, double radius);
  std::vector<Index> free_corners(Index triangle);
  std::vector<std::uint8_t> taken_vertices() const;
  void begin_to_lead(Hand& hand);

  World<Real>& world_;
  CommandSink apply_;
  const HandQueue& controllers_;
  Messages& messages_;
  HandLimits limits_;
  std::vector<Hand> hands_;
  Mat3X<Real> x_;  // surface when a ray is cast
};

}  // namespace lobe
