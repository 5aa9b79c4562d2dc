// The one door through which any thread sends hand commands to the thread of a session. Senders may wait for
// each other, for as long as it takes to copy a command; the session waits for nobody.
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

  // Its number; throws InputError where there are too many.
  int connect(const std::string& name);
  void disconnect(int controller);  // what it sent before is still done
  // False where the queue is full, with nothing queued: the session has not taken a command for a long time.
  // A newer pose of a hand takes the place of one that is queued, if that is the last that was asked of the
  // hand.
  bool send(int controller, const HandCommand& command);

  // ---- The thread of the session

  struct Sent {
    int controller = 0;
    HandCommand command;
  };
  std::optional<Sent> take() { return ring_.take(); }
  // Those that have gone since it was last asked: everything that they sent can be taken now. Their numbers
  // are used again after forget().
  std::vector<int> gone() const;
  void forget(int controller);
  std::string name(int controller) const;

  // What changes with each thing that is sent; for a session that has nothing to do.
  std::uint32_t signal() const { return signal_.load(std::memory_order_acquire); }
  void wait(std::uint32_t signal) const { signal_.wait(signal, std::memory_order_acquire); }
  void wake();

 private:
  enum class Place : std::uint8_t { free, connected, gone };

  std::mutex senders_;
  Ring<Sent> ring_;
  std::map<std::pair<int, HandNumber>, std::uint64_t>
      last_pose_;  // in the ring; none: something else was asked since
  std::array<std::atomic<Place>, most_controllers> places_{};
  std::array<std::string, most_controllers> names_;  // written while a place is free
  std::atomic<std::uint32_t> signal_{0};
};

}  // namespace lobe
