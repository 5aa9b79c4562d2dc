// The queue by which any thread sends hand commands to the thread of a session. Senders may wait for each
// other while one copies a command. The session never waits.
#pragma once

#include <array>
#include <atomic>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "lobe/live/hand_command.h"
#include "lobe/live/ring.h"

namespace lobe {

class HandQueue {
 public:
  static constexpr int most_controllers = 64;

  explicit HandQueue(std::uint32_t size = 1024) : ring_(size) {}

  // ---- Any thread

  // Registers a controller and returns its number. Throws InputError if there are too many.
  int connect(const std::string& name);
  void disconnect(int controller);  // what it sent before is still done
  // Queues a command. False if the queue is full: the session has not taken a command for a long time, and
  // nothing was queued. A newer pose of a hand replaces a queued one, if that is the hand's last command.
  bool send(int controller, const HandCommand& command);

  // ---- The thread of the session

  struct Sent {
    int controller = 0;
    HandCommand command;
  };
  std::optional<Sent> take() { return ring_.take(); }
  // The controllers that have gone since the last call. All that they sent can be taken now. Their numbers
  // are used again after forget().
  std::vector<int> gone() const;
  void forget(int controller);
  std::string name(int controller) const;

  // Changes with each command that is sent. A session that has nothing to do waits for that.
  std::uint32_t signal() const { return signal_.load(std::memory_order_acquire); }
  void wait(std::uint32_t signal) const { signal_.wait(signal, std::memory_order_acquire); }
  void wake();

 private:
  enum class Place : std::uint8_t { free, connected, gone };

  std::mutex senders_;
  Ring<Sent> ring_;
  std::map<std::pair<int, HandNumber>, std::uint64_t>
      last_pose_;  // numbers in the ring; none: something else was asked since
  std::array<std::atomic<Place>, most_controllers> places_{};
  std::array<std::string, most_controllers> names_;  // written while a place is free
  std::atomic<std::uint32_t> signal_{0};
};

}  // namespace lobe
