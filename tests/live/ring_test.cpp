#include "lobe/live/ring.h"

#include <doctest/doctest.h>

#include <deque>
#include <random>

#include "lobe/live/hand_queue.h"

using namespace lobe;

namespace {

using Kind = HandCommand::Kind;

HandCommand pose(HandNumber hand, double x) {
  return {.kind = Kind::lead, .hand = hand, .position = Vec3d(x, 0, 0)};
}
HandCommand asked(Kind kind, HandNumber hand = 1) { return {.kind = kind, .hand = hand}; }

}  // namespace

TEST_CASE("a ring gives values back in order, is full at its size, and empty at the end") {
  Ring<int> ring(3);
  CHECK_FALSE(ring.take());
  for (int lap = 0; lap < 5; ++lap) {
    for (int i = 0; i < 3; ++i) REQUIRE(ring.put(10 * lap + i));
    CHECK_FALSE(ring.put(99));
    for (int i = 0; i < 3; ++i) CHECK(ring.take() == 10 * lap + i);
    CHECK_FALSE(ring.take());
  }
}

TEST_CASE("a value can be replaced until it is taken, any number of times") {
  Ring<int> ring(2);
  const auto first = ring.put(1), second = ring.put(2);
  CHECK(ring.replace(*first, 11));
  CHECK(ring.replace(*first, 12));
  CHECK(ring.replace(*first, 13));
  CHECK(ring.take() == 13);
  CHECK_FALSE(ring.replace(*first, 14));
  CHECK(ring.replace(*second, 21));
  CHECK(ring.take() == 21);
  CHECK_FALSE(ring.take());
}

TEST_CASE("a ring under any order of putting, replacing and taking is a queue whose values change") {
  std::mt19937 random(1);
  Ring<int> ring(5);
  std::deque<std::pair<std::uint64_t, int>> model;
  std::uint64_t last = 0;
  for (int i = 0; i < 20000; ++i) {
    const int value = int(random() % 1000);
    const auto dice = random() % 3;
    if (dice == 0) {
      const auto number = ring.put(value);
      REQUIRE(number.has_value() == (model.size() < ring.size()));
      if (number) model.emplace_back(last = *number, value);
    } else if (dice == 1 && ring.is_recent(last)) {
      const bool is_there = !model.empty();
      REQUIRE(ring.replace(last, value) == is_there);
      if (is_there) model.back().second = value;
    } else if (dice == 2) {
      const auto taken = ring.take();
      REQUIRE(taken.has_value() == !model.empty());
      if (taken) CHECK(*taken == model.front().second);
      if (taken) model.pop_front();
    }
  }
}

TEST_CASE("a newer pose of a hand takes the place of the queued one; nothing else is ever replaced") {
  HandQueue queue(16);
  const int mouse = queue.connect("mouse");
  for (int i = 0; i < 1000; ++i) REQUIRE(queue.send(mouse, pose(1, i)));
  REQUIRE(queue.send(mouse, pose(2, -1)));
  REQUIRE(queue.send(mouse, pose(1, 1000)));
  REQUIRE(queue.send(mouse, asked(Kind::let_go)));
  REQUIRE(queue.send(mouse, asked(Kind::take_at_point)));
  REQUIRE(queue.send(mouse, pose(1, 1001)));
  REQUIRE(queue.send(mouse, pose(1, 1002)));
  const auto next = [&] { return queue.take()->command; };
  CHECK(next().position.x() == 1000);
  CHECK(next().hand == 2);
  CHECK(next().kind == Kind::let_go);
  CHECK(next().kind == Kind::take_at_point);
  CHECK(next().position.x() == 1002);
  CHECK_FALSE(queue.take());
}

TEST_CASE("a full queue says so to the sender, and has lost nothing") {
  HandQueue queue(4);
  const int mouse = queue.connect("mouse");
  for (int i = 0; i < 4; ++i) REQUIRE(queue.send(mouse, asked(Kind::turn_on, HandNumber(i))));
  CHECK_FALSE(queue.send(mouse, asked(Kind::let_go)));
  CHECK_FALSE(queue.send(mouse, pose(1, 0)));
  for (HandNumber i = 0; i < 4; ++i) CHECK(queue.take()->command.hand == i);
  CHECK(queue.send(mouse, asked(Kind::let_go)));
}

TEST_CASE("poses of the same hand number of two controllers are two hands") {
  HandQueue queue;
  const int a = queue.connect("a"), b = queue.connect("b");
  queue.send(a, pose(1, 1));
  queue.send(b, pose(1, 2));
  CHECK(queue.take()->controller == a);
  CHECK(queue.take()->controller == b);
}

TEST_CASE("the place of a controller that has gone is free only when that was noticed") {
  HandQueue queue;
  const int a = queue.connect("a");
  queue.disconnect(a);
  CHECK(queue.connect("b") != a);
  CHECK(queue.gone() == std::vector<int>{a});
  CHECK(queue.name(a) == "a");
  queue.forget(a);
  CHECK(queue.gone().empty());
  CHECK(queue.connect("c") == a);
}
