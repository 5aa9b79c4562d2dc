#include "lobe/shared_chain.h"

#include <doctest/doctest.h>

#include <random>
#include <thread>
#include <vector>

using namespace lobe;

namespace {

std::vector<int> items_of(const SharedChain<int>& chain) {
  std::vector<int> items;
  chain.visit_backwards([&](int item) {
    items.insert(items.begin(), item);
    return true;
  });
  return items;
}

SharedChain<int> up_to(int count) {
  SharedChain<int> chain;
  for (int i = 0; i < count; ++i) chain.push_back(i);
  return chain;
}

}  // namespace

TEST_CASE("copies of a chain grow and shrink apart, as copies of a list do") {
  std::mt19937 random(7);
  std::vector<std::pair<SharedChain<int>, std::vector<int>>> all(4);
  for (int i = 0; i < 3000; ++i) {
    auto& [chain, list] = all[random() % all.size()];
    const auto toss = random() % 20;
    if (toss == 0) {
      auto& [other, others] = all[random() % all.size()];
      other = chain;
      others = list;
    } else if (toss < 8 && !list.empty()) {
      chain.pop_back();
      list.pop_back();
    } else {
      chain.push_back(i);
      list.push_back(i);
    }
    REQUIRE(chain.size() == list.size());
    REQUIRE(chain.empty() == list.empty());
    if (!list.empty()) REQUIRE(chain.back() == list.back());
    REQUIRE(items_of(chain) == list);
  }
}

TEST_CASE("a visit ends where the visitor says so") {
  int seen = 0;
  up_to(10).visit_backwards([&](int item) { return ++seen, item > 7; });
  CHECK(seen == 3);
}

TEST_CASE("a chain of a million items ends without filling the stack, also in several threads at once") {
  const SharedChain<int> whole = up_to(1'000'000);
  std::vector<SharedChain<int>> copies(4, whole);
  std::vector<std::thread> threads;
  for (SharedChain<int>& copy : copies) {
    threads.emplace_back([&copy] {
      for (int i = 0; i < 1000; ++i) copy.pop_back();
      for (int i = 0; i < 1000; ++i) copy.push_back(i);
      CHECK(copy.size() == 1'000'000);
      copy = {};
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(whole.size() == 1'000'000);
}
