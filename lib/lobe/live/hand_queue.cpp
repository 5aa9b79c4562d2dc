#include "lobe/live/hand_queue.h"

#include "lobe/error.h"

namespace lobe {

HandCommand bring_tool(HandNumber hand, const Vec3d& position, BringTool tool) {
  return {.kind = HandCommand::Kind::bring,
          .hand = hand,
          .position = position,
          .tool = std::make_shared<const BringTool>(std::move(tool))};
}

const char* name(HandCommand::Kind kind) {
  static constexpr const char* names[] = {"take_at_ray", "take_at_point", "bring", "lead", "turn_on",
                                          "let_go",      "edit",          "run",   "step", "speed",
                                          "restart",     "back",          "alive"};
  const auto index = static_cast<std::size_t>(kind);
  return index < std::size(names) ? names[index] : "unknown";
}

int HandQueue::connect(const std::string& name) {
  const std::lock_guard lock(senders_);
  for (int i = 0; i < most_controllers; ++i) {
    std::atomic<Place>& place = places_[std::size_t(i)];
    if (place.load(std::memory_order_acquire) != Place::free) continue;
    names_[std::size_t(i)] = name;
    place.store(Place::connected, std::memory_order_release);
    return i;
  }
  throw InputError("session", "has " + std::to_string(most_controllers) + " controllers, and takes no more");
}

void HandQueue::disconnect(int controller) {
  const std::lock_guard lock(senders_);
  std::erase_if(last_pose_, [&](const auto& item) { return item.first.first == controller; });
  places_[std::size_t(controller)].store(Place::gone, std::memory_order_release);
  wake();
}

bool HandQueue::send(int controller, const HandCommand& command) {
  const std::lock_guard lock(senders_);
  const std::pair hand(controller, command.hand);
  const auto last = last_pose_.find(hand);
  const bool is_pose = command.kind == HandCommand::Kind::lead;
  if (is_pose && last != last_pose_.end() && ring_.is_recent(last->second) &&
      ring_.replace(last->second, {controller, command}))
    return true;
  const std::optional<std::uint64_t> number = ring_.put({controller, command});
  if (!number) return false;
  if (is_pose)
    last_pose_[hand] = *number;
  else if (last != last_pose_.end())
    last_pose_.erase(last);
  wake();
  return true;
}

std::vector<int> HandQueue::gone() const {
  std::vector<int> controllers;
  for (int i = 0; i < most_controllers; ++i)
    if (places_[std::size_t(i)].load(std::memory_order_acquire) == Place::gone) controllers.push_back(i);
  return controllers;
}

void HandQueue::forget(int controller) {
  places_[std::size_t(controller)].store(Place::free, std::memory_order_release);
}

std::string HandQueue::name(int controller) const {
  const bool is_there = places_[std::size_t(controller)].load(std::memory_order_acquire) != Place::free;
  return is_there ? names_[std::size_t(controller)] : "";
}

void HandQueue::wake() {
  signal_.fetch_add(1, std::memory_order_release);
  signal_.notify_all();
}

}  // namespace lobe
