// The tools of a session that devices lead. Servo loops use them while another thread adds and removes tools.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>

#include "lobe/haptic/devices.h"

namespace lobe::c {

// A tool that a device leads.
struct HapticTool {
  HapticTool(std::uint32_t number, const DeviceLimits& limits) : tool(number), device(link, limits) {}
  const std::uint32_t tool;
  HapticLink link;
  ExternalDevice device;
  std::shared_ptr<void> hand;  // HapticHand of the session's precision
};

class HapticTools {
 public:
  HapticTools() = default;
  ~HapticTools() { clear(); }

  // ---- One thread at a time

  bool has(std::uint32_t tool) const;
  void add(std::unique_ptr<HapticTool> made);  // throws InputError if there are 8
  // Waits until nobody uses the tool, and destroys it. False if there is none.
  bool remove(std::uint32_t tool);
  void clear();

  // ---- Any thread

  // Calls work(tool), which is not destroyed meanwhile. False if there is none. Never waits.
  template <class Work>
  bool use(std::uint32_t tool, Work&& work) {
    for (Place& place : places_) {
      if (place.number.load() != number_of(tool)) continue;
      const User user(place);
      if (place.number.load() != number_of(tool)) continue;  // it was removed between both looks
      work(*place.tool);
      return true;
    }
    return false;
  }

 private:
  // The number is 0 from before remove() looks for users. Whoever is counted before that look is waited for.
  // Whoever is counted after it sees the 0, and leaves the tool alone.
  struct Place {
    std::atomic<std::uint64_t> number = 0;  // number of the tool, from 1; 0: the place is free
    std::atomic<int> users = 0;
    std::unique_ptr<HapticTool> tool;
  };
  struct User {
    explicit User(Place& used) : place(used) { ++place.users; }
    ~User() { --place.users; }
    User(const User&) = delete;
    User& operator=(const User&) = delete;
    Place& place;
  };
  static std::uint64_t number_of(std::uint32_t tool) { return std::uint64_t{tool} + 1; }
  static void empty(Place& place);

  std::array<Place, 8> places_;
};

}  // namespace lobe::c
