// Persistent threads that sleep when idle. Each item of work writes to its own place and sums in its own
// order. So results have the same bits on any number of threads, however the work is divided into ranges.
#pragma once

#include <memory>
#include <type_traits>
#include <utility>

#include "lobe/types.h"

namespace lobe {

class Parallel {
 public:
  explicit Parallel(int threads = 1);
  ~Parallel();
  Parallel(Parallel&&) noexcept;
  Parallel& operator=(Parallel&&) noexcept;

  int threads() const { return threads_; }

  // Calls body(begin, end) for ranges of about `grain` items that make up [0, count). If there is one range
  // only, the calling thread does it.
  template <class Body>
  void for_ranges(Index count, Index grain, Body&& body) {
    if (threads_ == 1 || count <= grain) {
      if (count > 0) body(Index(0), count);
      return;
    }
    using B = std::remove_reference_t<Body>;
    run(
        count, grain, [](void* b, Index begin, Index end) { (*static_cast<B*>(b))(begin, end); },
        const_cast<void*>(static_cast<const void*>(&body)));
  }

 private:
  using Function = void (*)(void*, Index, Index);
  void run(Index count, Index grain, Function function, void* body);

  struct Arena;
  std::unique_ptr<Arena> arena_;
  int threads_ = 1;
};

}  // namespace lobe
