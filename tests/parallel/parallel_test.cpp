#include "lobe/parallel.h"

#include <doctest/doctest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

using namespace lobe;

TEST_CASE("each item is done exactly once, whatever the numbers of threads and items") {
  for (const int threads : {1, 2, 3, 7}) {
    Parallel parallel(threads);
    CHECK(parallel.threads() == threads);
    for (const Index count : {0, 1, 2, 5, 64, 1000})
      for (const Index grain : {1, 3, 64}) {
        std::vector<int> times(static_cast<std::size_t>(count), 0);
        parallel.for_ranges(count, grain, [&](Index begin, Index end) {
          for (Index i = begin; i < end; ++i) ++times[static_cast<std::size_t>(i)];
        });
        CAPTURE(threads);
        CAPTURE(count);
        CAPTURE(grain);
        CHECK(times == std::vector<int>(static_cast<std::size_t>(count), 1));
      }
  }
}

TEST_CASE("what is written in one call is read in the next, ten thousand times") {
  Parallel parallel(3);
  std::vector<int> numbers(300, 0);
  for (int round = 0; round < 10'000; ++round)
    parallel.for_ranges(300, 100, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        const std::size_t from = static_cast<std::size_t>(i), to = (from + 100) % 300;
        // Reads what another thread has written in the round before.
        if (round % 2 == 0)
          numbers[from] += 1;
        else if (from < 100)
          numbers[from] = numbers[from] + numbers[to] - numbers[to + 100];
      }
    });
  for (const int number : numbers) CHECK(number == 5'000);
}

TEST_CASE("several threads may call the same object, and a part may call it again") {
  Parallel parallel(4);
  std::atomic<int> sum{0};
  std::vector<std::thread> callers;
  for (int c = 0; c < 3; ++c)
    callers.emplace_back([&] {
      for (int round = 0; round < 200; ++round)
        parallel.for_ranges(8, 1, [&](Index begin, Index end) {
          for (Index i = begin; i < end; ++i)
            parallel.for_ranges(10, 1, [&](Index first, Index last) { sum += last - first; });
        });
    });
  for (std::thread& caller : callers) caller.join();
  CHECK(sum == 3 * 200 * 8 * 10);
}

TEST_CASE("an exception of a part reaches the caller, and the threads go on working") {
  Parallel parallel(3);
  for (int round = 0; round < 50; ++round) {
    CHECK_THROWS_WITH_AS(parallel.for_ranges(3, 1,
                                             [&](Index begin, Index) {
                                               if (begin == round % 3) throw std::runtime_error("of a part");
                                             }),
                         "of a part", std::runtime_error);
    std::atomic<int> done{0};
    parallel.for_ranges(30, 1, [&](Index begin, Index end) { done += end - begin; });
    CHECK(done == 30);
  }
}

TEST_CASE("threads go with their owner, used or not, moved or not") {
  for (int round = 0; round < 50; ++round) {
    Parallel unused(4), used(2);
    used.for_ranges(4, 1, [](Index, Index) {});
    Parallel moved = std::move(used);
    int items[4] = {};
    moved.for_ranges(4, 1, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) items[i] = 1;
    });
    CHECK(items[0] + items[1] + items[2] + items[3] == 4);
  }
}
