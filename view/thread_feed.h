// The threads with which a body is sewn, for pages: their bites and knots, and whose hand has them.
#pragma once

#include <algorithm>
#include <mutex>
#include <nlohmann/json.hpp>
#include <vector>

#include "lobe/live/sewing.h"

namespace lobe::view {

class ThreadFeed {
 public:
  // Call it between frames, on the thread that advances the world. O(#bites).
  template <class Real>
  void update(const World<Real>& world) {
    const Threads<Real>* threads = term_of<Threads>(world.body().terms);
    const std::lock_guard lock(mutex_);
    threads_ = threads ? threads->all() : std::vector<Thread>();
  }

  // ---- Any thread

  bool is_held() const {
    const std::lock_guard lock(mutex_);
    return std::any_of(threads_.begin(), threads_.end(),
                       [](const Thread& thread) { return thread.hand.holds; });
  }

  // As docs/live_protocol.md has them.
  nlohmann::json figures() const {
    const std::lock_guard lock(mutex_);
    nlohmann::json list = nlohmann::json::array();
    for (const Thread& thread : threads_) {
      nlohmann::json bites = nlohmann::json::array(), knots = nlohmann::json::array();
      for (const ThreadBite& bite : thread.bites) bites.push_back(bite.number);
      for (const ThreadKnot& knot : thread.knots)
        knots.push_back({bites[std::size_t(knot.from)], bites[std::size_t(knot.to)]});
      const bool is_cut = std::any_of(thread.spans.begin(), thread.spans.end(),
                                      [](const ThreadSpan& span) { return span.is_cut; });
      list.push_back({{"thread", thread.number},
                      {"sewn", thread.is_sewn},
                      {"bites", bites},
                      {"knots", knots},
                      {"cut", is_cut},
                      {"held", thread.hand.holds && !thread.is_on_needle()},
                      {"needle", thread.hand.needle},
                      {"pull", hand_pull(thread)}});
    }
    return list;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<Thread> threads_;
};

}  // namespace lobe::view
