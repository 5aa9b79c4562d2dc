#include "haptic_tools.h"

#include <algorithm>
#include <thread>

#include "lobe/error.h"

namespace lobe::c {

bool HapticTools::has(std::uint32_t tool) const {
  return std::any_of(places_.begin(), places_.end(),
                     [&](const Place& place) { return place.number.load() == number_of(tool); });
}

void HapticTools::add(std::unique_ptr<HapticTool> made) {
  const auto free = std::find_if(places_.begin(), places_.end(),
                                 [](const Place& place) { return place.number.load() == 0; });
  if (free == places_.end())
    throw InputError("tool", std::to_string(places_.size()) + " have devices, and no more can");
  free->tool = std::move(made);
  free->number = number_of(free->tool->tool);
}

bool HapticTools::remove(std::uint32_t tool) {
  const auto found = std::find_if(places_.begin(), places_.end(),
                                  [&](const Place& place) { return place.number.load() == number_of(tool); });
  if (found == places_.end()) return false;
  empty(*found);
  return true;
}

void HapticTools::clear() {
  for (Place& place : places_) empty(place);
}

void HapticTools::empty(Place& place) {
  place.number = 0;
  while (place.users.load() != 0) std::this_thread::yield();
  place.tool.reset();
}

}  // namespace lobe::c
