// The threads with which a body is sewn, for the pages: their lines of the newest picture.
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "lobe/forces/threads.h"
#include "lobe/sim/world.h"
#include "protocol.h"

namespace lobe::view {

template <class Real>
class ThreadFeed {
 public:
  explicit ThreadFeed(World<Real>& world) { update(world); }

  // Call it between frames.
  void update(World<Real>& world) {
    auto lines = std::make_shared<const std::vector<ThreadLine>>(thread_lines(world));
    const std::lock_guard lock(mutex_);
    lines_ = std::move(lines);
  }

  // Any thread.
  void write(BlockWriter& out) const {
    std::shared_ptr<const std::vector<ThreadLine>> lines;
    {
      const std::lock_guard lock(mutex_);
      lines = lines_;
    }
    write_threads(*lines, out);
  }

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const std::vector<ThreadLine>> lines_;
};

}  // namespace lobe::view
