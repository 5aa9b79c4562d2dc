#include "lobe/snapshot/triple_buffer.h"

#include <doctest/doctest.h>

#include <memory>
#include <set>
#include <vector>

using namespace lobe;

namespace {

bool write(TripleBuffer<int>& buffer, int value) {
  int* const to = buffer.writable();
  if (to == nullptr) return false;
  *to = value;
  buffer.publish();
  return true;
}

}  // namespace

TEST_CASE("a reader gets nothing before the first value, and then the latest") {
  TripleBuffer<int> buffer;
  CHECK_FALSE(buffer.latest());
  REQUIRE(write(buffer, 1));
  CHECK(*buffer.latest() == 1);
  CHECK(*buffer.latest() == 1);
  REQUIRE(write(buffer, 2));
  REQUIRE(write(buffer, 3));
  CHECK(*buffer.latest() == 3);
}

TEST_CASE("what is being written is not seen until it is published, and keeps its place until then") {
  TripleBuffer<int> buffer;
  write(buffer, 1);
  int* const to = buffer.writable();
  *to = 2;
  CHECK(*buffer.latest() == 1);
  CHECK(buffer.writable() == to);
  buffer.publish();
  CHECK(*buffer.latest() == 2);
}

TEST_CASE("a view keeps its value while others are written, as many views as were planned for") {
  TripleBuffer<int> buffer(3);
  std::vector<TripleBuffer<int>::View> views;
  for (int value = 0; value < 3; ++value) {
    REQUIRE(write(buffer, value));
    views.push_back(buffer.latest());
  }
  for (int value = 3; value < 100; ++value) REQUIRE(write(buffer, value));
  for (int value = 0; value < 3; ++value) CHECK(*views[value] == value);
  CHECK(*buffer.latest() == 99);
}

TEST_CASE(
    "more views than were planned for leave a value out, and neither wait nor overwrite; giving one back "
    "helps") {
  TripleBuffer<int> buffer(1);
  std::vector<TripleBuffer<int>::View> views;
  for (int value = 0; value < 3; ++value) {
    REQUIRE(write(buffer, value));
    views.push_back(buffer.latest());
  }
  CHECK(buffer.writable() == nullptr);
  for (int value = 0; value < 3; ++value) CHECK(*views[value] == value);
  views.erase(views.begin() + 1);
  REQUIRE(write(buffer, 3));
  CHECK(*buffer.latest() == 3);
  CHECK(*views[0] == 0);
  CHECK(*views[1] == 2);
}

TEST_CASE(
    "views that are taken and given back any number of times, before and after a value is replaced, leave no "
    "trace") {
  TripleBuffer<int> buffer(1);
  for (int value = 0; value < 50; ++value) {
    REQUIRE(write(buffer, value));
    auto kept = buffer.latest();
    for (int i = 0; i < value; ++i) CHECK(*buffer.latest() == value);
    REQUIRE(write(buffer, -value));
    CHECK(*kept == value);
    auto moved = std::move(kept);
    CHECK_FALSE(kept);
    kept = std::move(moved);
    CHECK(*kept == value);
  }
}

TEST_CASE("one reader needs three slots: storage is used again") {
  TripleBuffer<int> buffer(5);
  std::set<const int*> used;
  for (int value = 0; value < 100; ++value) {
    REQUIRE(write(buffer, value));
    used.insert(&*buffer.latest());
  }
  CHECK(used.size() == 2);  // nothing was held while it was written
  for (int value = 0; value < 100; ++value) {
    const auto held = buffer.latest();
    for (int newer = 0; newer < 3; ++newer) {
      REQUIRE(write(buffer, value + newer));
      used.insert(&*buffer.latest());
    }
  }
  CHECK(used.size() == 3);
}

TEST_CASE("a view outlives its buffer") {
  auto buffer = std::make_unique<TripleBuffer<std::vector<int>>>();
  buffer->writable()->assign(1000, 7);
  buffer->publish();
  const auto view = buffer->latest();
  buffer.reset();
  CHECK(*view == std::vector<int>(1000, 7));
}
