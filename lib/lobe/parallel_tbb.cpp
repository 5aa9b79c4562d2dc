// Parallel by oneTBB (LOBE_TBB).
#include "lobe/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace lobe {

struct Parallel::Arena {
  tbb::task_arena tasks;
};

Parallel::Parallel(int threads) : threads_(std::max(1, threads)) {
  if (threads_ > 1) arena_ = std::make_unique<Arena>(Arena{tbb::task_arena(threads_)});
}
Parallel::~Parallel() = default;
Parallel::Parallel(Parallel&&) noexcept = default;
Parallel& Parallel::operator=(Parallel&&) noexcept = default;

void Parallel::run(Index count, Index grain, Function function, void* body) {
  arena_->tasks.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<Index>(0, count, grain),
        [&](const tbb::blocked_range<Index>& range) { function(body, range.begin(), range.end()); },
        tbb::static_partitioner());
  });
}

}  // namespace lobe
