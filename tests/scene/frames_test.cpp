#include "lobe/scene/frames.h"

#include <doctest/doctest.h>

#include <limits>

#include "lobe/error.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("a scene is played to its end, no frame more, where sums of frames stop just short of it") {
  for (const auto& [duration, frame, count] :
       {std::tuple{4.4, 0.02, 220}, {3.0, 1.0 / 30, 90}, {2.5, 0.05, 50}, {0.01, 1.0 / 30, 1}}) {
    CAPTURE(duration);
    const Frames frames = frames_of({.duration = duration, .frame = frame});
    CHECK(frames.count == count);
    CHECK(frames.count * frames.length == near(duration, 1e-15));
  }
  int counted = 0;  // what a loop over time would play
  for (double time = 0; time < 4.4; time += 0.02) ++counted;
  CHECK(counted == 221);
}

TEST_CASE("frames are as long as asked but for what makes them a whole number") {
  const Frames frames = frames_of({.duration = 1, .frame = 0.3});
  CHECK(frames.count == 3);
  CHECK(frames.length == near(1.0 / 3, 1e-15));
}

TEST_CASE("a time without frames is refused") {
  for (const Time& time : {Time{.duration = 0}, Time{.frame = 0}, Time{.duration = 1, .frame = 1e-12},
                           Time{.duration = std::numeric_limits<double>::quiet_NaN()}})
    CHECK_THROWS_AS(frames_of(time), InputError);
}
