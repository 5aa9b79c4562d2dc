#include "lobe/live/hands.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "lobe/error.h"
#include "lobe/live/pick.h"
#include "lobe/text.h"

namespace lobe {
namespace {

using Kind = HandCommand::Kind;

bool is_unit(const Eigen::Vector4d& orientation) { return std::abs(orientation.norm() - 1) < 1e-6; }

void check(const HandCommand& command) {
  const auto expect = [&](bool is_right, const char* what) {
    if (!is_right) throw InputError(name(command.kind), what);
  };
  expect(command.position.allFinite(), "its position must be three finite numbers [m]");
  expect(is_unit(command.orientation), "its orientation must be a unit quaternion");
  const bool takes = command.kind == Kind::take_at_ray || command.kind == Kind::take_at_point;
  if (takes)
    expect(command.radius > 0 && std::isfinite(command.radius), "its radius must be above 0 m, and finite");
  if (command.kind == Kind::bring) expect(command.tool != nullptr, "it must say which tool");
  if (command.kind == Kind::take_at_ray)
    expect(command.direction.allFinite() && command.direction.norm() > 0,
           "its direction must be three finite numbers, not all 0");
}

// The pose of a tool whose centre was at `arm` from where the hand took hold, and which was turned by `turn`.
ToolPose of_tool(const ToolPose& hand, const Vec3d& arm, const Eigen::Vector4d& turn) {
  const Eigen::Quaterniond turned(hand.orientation);
  return {hand.position + turned * arm, (turned * Eigen::Quaterniond(turn)).coeffs()};
}

}  // namespace

template <class Real>
void Hands<Real>::perform_command(int controller, const HandCommand& command) {
  check(command);
  if (command.kind == Kind::take_at_ray || command.kind == Kind::take_at_point)
    return take_hold(controller, command);
  if (command.kind == Kind::bring) return bring(controller, command);
  Hand& hand = full_hand(controller, command);
  if (hand.tool == 0) return;
  if (command.kind == Kind::lead) return lead(command, hand);
  if (command.kind == Kind::turn_on) return turn_on(command, hand);
  let_go(hand);
}

// ---- To take hold and to let go

// The command for the world has the vertices, so recordings do not depend on the ray.
template <class Real>
void Hands<Real>::take_hold(int controller, const HandCommand& command) {
  Hand& hand = empty_hand(controller, command.hand);
  Vec3d point = command.position;
  std::optional<RayHit> hit;
  if (command.kind == Kind::take_at_ray) {
    const SurfaceMesh& surface = world_.surface().mesh();
    update_positions(surface, world_.elements().points.view(), world_.displacements(), x_);
    hit = cast_ray(surface, x_, command.position, command.direction);
    if (!hit) return say("missed", name_of(controller, command.hand) + ": the ray meets nothing");
    point = hit->point;
  }
  std::vector<Index> vertices = free_within(point, command.radius);  // in ascending order
  if (vertices.empty() && hit) vertices = free_corners(hit->triangle);
  if (vertices.empty())
    return say("missed", name_of(controller, command.hand) + ": no free vertex lies within " +
                             rounded(command.radius) + " m of the point");
  hand.tool = world_.tools().next_id();
  hand.filter = PoseFilter(point);
  apply_(TakeHold{name_of(controller, command.hand), std::move(vertices)});
}

template <class Real>
void Hands<Real>::bring(int controller, const HandCommand& command) {
  Hand& hand = empty_hand(controller, command.hand);
  const ToolId tool = world_.tools().next_id();
  std::visit(
      [&](auto brought) {
        brought.name = name_of(controller, command.hand);
        apply_(brought);
        if constexpr (requires { brought.turn(); }) hand.turn = brought.turn();
        if constexpr (std::is_same_v<decltype(brought), BringProbe>)
          warn_of_inside(hand, brought.pose.position);
      },
      *command.tool);
  hand.tool = tool;
  hand.is_leading = true;
  hand.filter = PoseFilter(command.position);
  hand.looked = -std::numeric_limits<double>::infinity();
}

template <class Real>
bool Hands<Real>::lies_in_body(const Vec3d& point) const {
  const Elements& elements = world_.elements();
  return lies_in<Real>(elements.topology, elements.points.view(), world_.displacements(), point);
}

template <class Real>
void Hands<Real>::warn_of_inside(const Hand& hand, const Vec3d& position) {
  if (lies_in_body(position))
    say("inside", name_of(hand.controller, hand.number) +
                      ": its probe begins inside the body, and feels nothing of it where it touches no "
                      "surface: take it out");
}

// What a blade cuts that is wholly inside is a closed pocket: nothing opens. It is looked for ten times a
// second, since that asks every tetrahedron.
template <class Real>
void Hands<Real>::watch_blade(Hand& hand) {
  constexpr double between = 0.1;  // [s]
  if (hand.is_told || world_.time() < hand.looked + between) return;
  hand.looked = world_.time();
  world_.tools().visit(hand.tool, [&]<class Kind>(const Kind& tool) {
    if constexpr (HasBlade<Kind>)
      hand.is_told = tool.is_on() && lies_in_body(tool.pose.tip) && lies_in_body(tool.pose.heel);
  });
  if (hand.is_told)
    say("blade_inside", name_of(hand.controller, hand.number) +
                            ": its blade is wholly inside the body: what it cuts opens nowhere; draw the "
                            "heel out, or make the blade longer");
}

template <class Real>
void Hands<Real>::let_go(Hand& hand) {
  if (hand.tool != 0) apply_(LetGo{hand.tool});
  hand = {.controller = hand.controller, .number = hand.number};
}

template <class Real>
int Hands<Real>::drop(int controller) {
  int full = 0;
  for (Hand& hand : hands_) {
    if (hand.controller != controller) continue;
    full += hand.tool != 0;
    let_go(hand);
  }
  std::erase_if(hands_, [&](const Hand& hand) { return hand.controller == controller; });
  return full;
}

template <class Real>
std::vector<int> Hands<Real>::controllers() const {
  std::vector<int> all;
  for (const Hand& hand : hands_)
    if (std::count(all.begin(), all.end(), hand.controller) == 0) all.push_back(hand.controller);
  return all;
}

// Per vertex: 1 if it is held and nobody else can take hold of it. A grasp that lets go does so before the
// next frame, in which others take hold.
template <class Real>
std::vector<std::uint8_t> Hands<Real>::taken_vertices() const {
  const Topology& topology = world_.elements().topology;
  std::vector<std::uint8_t> taken(std::size_t(topology.vertex_count()), 0);
  for (Index v = 0; v < topology.vertex_count(); ++v) taken[std::size_t(v)] = topology.around(v).empty();
  for (const HeldVertices::Held& item : world_.held().all()) {
    const Grasp* grasp = world_.tools().grasp(item.holder);
    const bool lets_go = grasp && grasp->is_live && grasp->release;
    if (!lets_go && world_.held().fixes(item.vertex)) taken[std::size_t(item.vertex)] = 1;
  }
  return taken;
}

template <class Real>
std::vector<Index> Hands<Real>::free_within(const Vec3d& point, double radius) {
  const auto u = world_.displacements();
  const auto X = world_.elements().points.view();
  const std::vector<std::uint8_t> taken = taken_vertices();
  std::vector<Index> vertices;
  for (Index v = 0; v < static_cast<Index>(taken.size()); ++v) {
    const Vec3d x = X.col(v) + u.col(v).template cast<double>();
    if (!taken[std::size_t(v)] && (x - point).squaredNorm() <= radius * radius) vertices.push_back(v);
  }
  return vertices;
}

template <class Real>
std::vector<Index> Hands<Real>::free_corners(Index triangle) {
  const SurfaceMesh& surface = world_.surface().mesh();
  const std::vector<std::uint8_t> taken = taken_vertices();
  std::vector<Index> vertices;
  for (Index corner : surface.triangles[std::size_t(triangle)])
    if (const Index v = surface.mesh_vertex[std::size_t(corner)]; !taken[std::size_t(v)])
      vertices.push_back(v);
  std::sort(vertices.begin(), vertices.end());
  return vertices;
}

// ---- Leading

template <class Real>
void Hands<Real>::lead(const HandCommand& command, Hand& hand) {
  hand.filter.aim({command.position, command.orientation});
  hand.is_placed = false;
}

template <class Real>
void Hands<Real>::place(int controller, HandNumber number, const ToolPose& pose) {
  Hand* hand = find(controller, number);
  if (!hand || !hand->is_leading) return;
  hand->filter.aim(pose);
  hand->is_placed = true;
}

template <class Real>
auto Hands<Real>::led_tool(int controller, HandNumber number) const -> LedTool {
  const Hand* hand = find(controller, number);
  if (!hand || !hand->is_leading) return {};
  return {hand->tool, hand->filter.pose()};
}

template <class Real>
void Hands<Real>::turn_on(const HandCommand& command, Hand& hand) {
  if (world_.tools().grasp(hand.tool))
    throw InputError("turn_on", name_of(hand.controller, hand.number) + " has nothing to turn on or off");
  apply_(SwitchTool{hand.tool, command.on});
}

template <class Real>
void Hands<Real>::notice_gone_tools() {
  for (Hand& hand : hands_) {
    if (hand.tool == 0) continue;
    bool is_there = false;
    world_.tools().visit(hand.tool, [&](const auto& tool) { is_there = !tool.has_gone(); });
    if (is_there) continue;
    say("tool_gone", name_of(hand.controller, hand.number) + ": its tool was let go of by the application");
    hand = {.controller = hand.controller, .number = hand.number};
  }
}

template <class Real>
void Hands<Real>::before_frame(double duration) {
  for (Hand& hand : hands_) {
    if (hand.tool == 0 || !hand.is_leading) continue;
    const bool moves = hand.is_placed ? hand.filter.step_without_lag(duration, limits_)
                                      : hand.filter.step(duration, limits_);
    if (moves) apply_(Lead{hand.tool, of_tool(hand.filter.pose(), hand.arm, hand.turn)});
  }
}

template <class Real>
void Hands<Real>::begin_to_lead(Hand& hand) {
  const Grasp& grasp = *world_.tools().grasp(hand.tool);
  if (grasp.phase != Grasp::Phase::holding) return;
  const auto& held = world_.held().all();
  hand.vertices = static_cast<Index>(
      std::count_if(held.begin(), held.end(), [&](const auto& item) { return item.holder == hand.tool; }));
  hand.arm = grasp.centre - hand.filter.pose().position;
  hand.is_leading = true;
}

template <class Real>
void Hands<Real>::after_frame() {
  for (Hand& hand : hands_) {
    if (hand.tool == 0) continue;
    watch_blade(hand);
    const Grasp* grasp = world_.tools().grasp(hand.tool);
    if (!grasp) continue;
    if (!hand.is_leading) begin_to_lead(hand);
    const double force = grasp->force.norm();
    if (force <= limits_.force_cap) continue;
    say("slipped", name_of(hand.controller, hand.number) + ": it slipped off, pulled with " + rounded(force) +
                       " N, more than " + rounded(limits_.force_cap) + " N");
    let_go(hand);
  }
}

// ---- Which

template <class Real>
auto Hands<Real>::find(int controller, HandNumber number) const -> const Hand* {
  const auto at = std::find_if(hands_.begin(), hands_.end(), [&](const Hand& hand) {
    return hand.controller == controller && hand.number == number;
  });
  return at == hands_.end() ? nullptr : &*at;
}

template <class Real>
auto Hands<Real>::find(int controller, HandNumber number) -> Hand* {
  return const_cast<Hand*>(std::as_const(*this).find(controller, number));
}

template <class Real>
auto Hands<Real>::empty_hand(int controller, HandNumber number) -> Hand& {
  constexpr std::size_t most = 256;
  if (Hand* hand = find(controller, number)) {
    let_go(*hand);
    return *hand;
  }
  if (hands_.size() == most) throw InputError("hand", "there are " + std::to_string(most) + ", and no more");
  return hands_.emplace_back(Hand{.controller = controller, .number = number});
}

// A controller may send poses to a hand that is empty, because the grasp slipped for example, until it has
// noticed.
template <class Real>
auto Hands<Real>::full_hand(int controller, const HandCommand& command) -> Hand& {
  Hand* hand = find(controller, command.hand);
  if (!hand)
    throw InputError(name_of(controller, command.hand), "has no tool to " + std::string(name(command.kind)));
  return *hand;
}

template <class Real>
std::string Hands<Real>::name_of(int controller, HandNumber number) const {
  return "hand " + std::to_string(number) + " of " + controllers_.name(controller);
}

template <class Real>
void Hands<Real>::tell(std::vector<HandStatus>& hands) const {
  hands.clear();
  for (const Hand& hand : hands_) {
    if (hand.tool == 0) continue;
    HandStatus status{.controller = hand.controller, .hand = hand.number, .tool = hand.tool};
    world_.tools().visit(hand.tool, [&]<class Kind>(const Kind& tool) {
      status.type = Kind::Path::type;
      status.holds = hand.is_leading && tool.is_on();
      status.shape = tool.shape();
      if constexpr (requires { tool.force; }) {
        status.force = -tool.force;
        status.torque = -tool.torque;
      }
    });
    status.vertices = hand.vertices;
    status.pose = of_tool(hand.filter.pose(), Vec3d::Zero(), hand.turn);
    hands.push_back(status);
  }
}

template class Hands<float>;
template class Hands<double>;

}  // namespace lobe
