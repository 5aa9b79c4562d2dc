#include "lobe/tool/tools.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lobe/assert.h"
#include "lobe/error.h"

namespace lobe {
namespace {

[[noreturn]] void refuse(ToolId id, const std::string& why) {
  throw InputError("tool " + std::to_string(id), why);
}

// visit(a list, that of the same kind in other lists).
template <class Lists, class Others, class Visit>
void for_each_pair(Lists& lists, Others& others, Visit&& visit) {
  constexpr std::size_t kinds = std::tuple_size_v<decltype(Others::fields)>;
  [&]<std::size_t... i>(std::index_sequence<i...>) {
    (visit(lists.*std::get<i>(std::remove_cvref_t<Lists>::fields),
           others.*std::get<i>(std::remove_cvref_t<Others>::fields)),
     ...);
  }
  (std::make_index_sequence<kinds>());
}

}  // namespace

Tools::Tools(const ToolSetups& setups) {
  for_each_pair(lists_, setups, [this](auto& tools, const auto& paths) {
    for (const auto& path : paths) tools.emplace_back(path).id = next_++;
  });
  list_present();
}

// ---- Made, moved and taken away

const Grasp* Tools::grasp(ToolId id) const {
  const Grasp* found = nullptr;
  visit(id, [&]<class Kind>(const Kind& tool) {
    if constexpr (std::is_same_v<Kind, Grasp>) found = &tool;
  });
  return found;
}

template <class Visit>
void Tools::visit_live(ToolId id, Visit&& visit) {
  const bool found = visit_in(lists_, id, [&](auto& tool) {
    if (!tool.is_live) refuse(id, "follows the path of its scene");
    if (tool.has_gone()) refuse(id, "was let go already");
    visit(tool);
  });
  if (!found) refuse(id, id > 0 && id < next_ ? "was let go already" : "is not there");
}

void Tools::lead(ToolId id, const ToolPose& target) {
  if (!target.position.allFinite() || !(std::abs(target.orientation.norm() - 1) < 1e-6))
    refuse(id, "needs a finite position and a unit quaternion for its orientation");
  if (target.opening && !(*target.opening >= 0 && std::isfinite(*target.opening)))
    refuse(id, "needs an opening of at least 0 m, and finite");
  visit_live(id, [&](auto& tool) { tool.lead(target); });
}

void Tools::let_go(ToolId id) {
  visit_live(id, [](auto& tool) { tool.let_go(); });
}

void Tools::turn_on(ToolId id, bool on) {
  visit_live(id, [&](auto& tool) {
    if constexpr (requires { tool.turn_on(on); })
      tool.turn_on(on);
    else
      refuse(id, "has nothing to turn on or off");
  });
}

std::vector<ToolId> Tools::held_by_hands() const {
  std::vector<ToolId> ids;
  for_each_tool(lists_, [&](const auto& tool) {
    if (tool.is_live && !tool.has_gone()) ids.push_back(tool.id);
  });
  return ids;
}

// In the order in which they came.
template <class IsWanted>
ToolSetups Tools::paths_of(IsWanted&& is_wanted) const {
  ToolLists all = gone_.lists();
  for_each_pair(all, lists_, [](auto& tools, const auto& present) {
    const auto middle = tools.insert(tools.end(), present.begin(), present.end());
    std::inplace_merge(tools.begin(), middle, tools.end(),
                       [](const auto& a, const auto& b) { return a.id < b.id; });
  });
  ToolSetups setups;
  for_each_tool(all, [&](const auto& tool) {  // the cores of hooks come before other bodies: bodies()
    if constexpr (requires { tool.core_paths(); })
      if (is_wanted(tool))
        for (ProbeSetup& path : tool.core_paths()) setups.probes.push_back(std::move(path));
  });
  for_each_pair(all, setups, [&](const auto& tools, auto& paths) {
    for (const auto& tool : tools)
      if (is_wanted(tool))
        for (auto& path : tool.paths()) paths.push_back(std::move(path));
  });
  return setups;
}

ToolSetups Tools::paths() const {
  return paths_of([](const auto&) { return true; });
}

ToolSetups Tools::live_paths() const {
  return paths_of([](const auto& tool) { return tool.is_live; });
}

void Tools::list_present() {
  present_.clear();
  for_each_tool(lists_, [&](const auto& tool) { present_.push_back(tool.id); });
  std::sort(present_.begin(), present_.end());
  placed_.assign(present_.size(), {});
}

// What it did until now is no work of the frame that begins: it ended before.
void Tools::set_aside(double time) {
  for_each_kind(lists_, [&](auto& tools) {
    std::erase_if(tools, [&](auto& tool) {
      if (!tool.is_live || !tool.has_ended(time - just_before)) return false;
      const auto place = std::ptrdiff_t(place_of(tool.id));
      present_.erase(present_.begin() + place);
      placed_.erase(placed_.begin() + place);
      tool.settle();
      gone_.add(std::move(tool));
      return true;
    });
  });
}

// ---- A frame

void Tools::begin_frame(double time, double duration) {
  lobe_assert(placed_.size() == present_.size(), "tools: one place per tool");
  set_aside(time);
  frame_end_ = time + duration;
  time_felt_ = 0;
  impulses_.assign(placed_.size(), {});
  for_each_tool(lists_, [&](auto& tool) { tool.begin_frame(time, frame_end_); });
}

double Tools::next_grasp_change(double time) const {
  double next = std::numeric_limits<double>::infinity();
  for (const Grasp& grasp : lists_.grasps)
    for (const double change : {grasp.takes_hold_at(), grasp.lets_go_at()})
      if (change > time) next = std::min(next, change);
  return next;
}

ToolWork Tools::work(double from, double to) const {
  ToolWork work;
  for_each_tool(lists_, [&](const auto& tool) { tool.add_work(from, to, work); });
  return work;
}

const std::vector<ToolBody>& Tools::bodies(double from, double to) {
  bodies_.clear();
  for_each_tool(lists_, [&](const auto& tool) {
    if constexpr (requires { tool.append_bodies(from, to, bodies_); }) tool.append_bodies(from, to, bodies_);
  });
  return bodies_;
}

const std::vector<NeedleBody>& Tools::needles(double from, double to) {
  needles_.clear();
  for_each_tool(lists_, [&](const auto& tool) {
    if constexpr (requires { tool.append_needles(from, to, needles_); })
      tool.append_needles(from, to, needles_);
  });
  return needles_;
}

// ---- A step

void Tools::cut_by(ToolId id, const CutWork& work, const Vec3d& way, const Vec3d& tip) {
  bool is_there = false;
  visit_in(lists_, id, [&](auto& tool) {
    if constexpr (HasBlade<decltype(tool)>) tool.cut_by(work, way, tip), is_there = true;
  });
  lobe_assert(is_there, "tools: a cut of a blade that there is not");
}

void Tools::place(double time) {
  const double now = std::min(time, frame_end_);
  for (const Grasp& grasp : lists_.grasps) {
    if (grasp.phase != Grasp::Phase::holding) continue;
    Placed& placed = placed_[place_of(grasp.id)];
    placed.offset = path_at(grasp.path.recent(), now);
    const Eigen::Vector4d orientation = orientation_at(grasp.path.recent(), now);
    placed.is_rotated = orientation != Eigen::Vector4d(0, 0, 0, 1);
    if (placed.is_rotated) placed.rotation = Eigen::Quaterniond(orientation).normalized().toRotationMatrix();
  }
}

Vec3d Tools::displacement(const HeldVertices::Held& item, const Vec3d& rest) const {
  const Placed& placed = placed_[place_of(item.holder)];
  if (!placed.is_rotated) return item.start + placed.offset;
  const Vec3d& centre = grasp(item.holder)->centre;
  const Vec3d arm = rest + item.start - centre;
  return centre + placed.offset + placed.rotation * arm - rest;
}

void Tools::begin_forces() { impulses_of_part_.assign(placed_.size(), {}); }

void Tools::add_force(ToolId holder, const Vec3d& force, const Vec3d& x, double dt) {
  Impulse& impulse = impulses_of_part_[place_of(holder)];
  impulse.linear += dt * force;
  impulse.angular += dt * (x - position(*grasp(holder))).cross(force);
}

void Tools::add_force(const OnTool& on_tool, double dt) {
  lobe_assert(is_present(on_tool.tool), "tools: a force on a tool that is not there");
  Impulse& impulse = impulses_of_part_[place_of(on_tool.tool)];
  impulse.linear += dt * on_tool.force;
  impulse.angular += dt * on_tool.torque;
  impulse.grip += dt * on_tool.grip;
}

void Tools::end_forces(double duration) {
  time_felt_ += duration;
  for_each_tool(lists_, [&](auto& tool) {
    // The force on a blade is that of the tissue that it opens: Scalpel::cut_by().
    if constexpr (requires { tool.force; } && !HasBlade<decltype(tool)>) {
      Impulse& impulse = impulses_[place_of(tool.id)];
      const Impulse& of_part = impulses_of_part_[place_of(tool.id)];
      impulse.linear += of_part.linear;
      impulse.angular += of_part.angular;
      tool.force = impulse.linear / time_felt_;
      tool.torque = impulse.angular / time_felt_;
      impulse.grip += of_part.grip;
      if constexpr (requires { tool.grip; }) tool.grip = impulse.grip / time_felt_;
    }
  });
}

// ---- For checkpoints

void Tools::set_state(const State& state) {
  lists_ = state;
  gone_ = state.gone;
  next_ = state.next;
  frame_end_ = std::numeric_limits<double>::infinity();  // until a frame begins
  list_present();
}

bool Tools::fits(const State& state, Index vertex_count, const ToolSetups& setups) {
  if (state.next < 1) return false;
  bool fits = true;
  ToolLists gone = state.gone.lists();
  for_each_tool(gone, [&](const auto& tool) { fits = fits && tool.is_live && tool.has_gone(); });
  const ToolLists& lists = state;
  for_each_pair(gone, lists, [](auto& tools, const auto& present) {
    tools.insert(tools.end(), present.begin(), present.end());
    std::sort(tools.begin(), tools.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  });
  for_each_pair(gone, setups, [&](const auto& tools, const auto& paths) {
    ToolId last = 0;
    std::size_t of_scene = 0;
    for (const auto& tool : tools) {
      fits =
          fits && tool.id > std::exchange(last, tool.id) && tool.id < state.next && tool.fits(vertex_count);
      of_scene += !tool.is_live;
    }
    fits = fits && of_scene == paths.size();
  });
  return fits;
}

}  // namespace lobe
