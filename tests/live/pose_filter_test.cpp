#include "lobe/live/pose_filter.h"

#include <doctest/doctest.h>

#include <cmath>

#include "lobe/live/pace.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double frame = 1.0 / 120;

}  // namespace

TEST_CASE("a tool approaches a hand that jumps as a critically damped spring does, whatever the frames") {
  const HandLimits limits{.lag = 0.04, .top_speed = 1e3};
  for (int frames : {1, 4, 50}) {
    PoseFilter filter(Vec3d::Zero());
    filter.aim({Vec3d(0.01, 0, 0)});
    const double time = 0.05, omega = 2 / limits.lag;
    for (int i = 0; i < frames; ++i) CHECK(filter.step(time / frames, limits));
    const double exact = 0.01 * (1 - (1 + omega * time) * std::exp(-omega * time));
    CHECK(filter.pose().position.x() == near(exact, 1e-12));
  }
}

TEST_CASE("behind a hand that moves uniformly a tool is late by the lag") {
  const HandLimits limits;
  PoseFilter filter(Vec3d::Zero());
  const double speed = 0.1;
  double time = 0;
  for (int i = 0; i < 4000; ++i) {  // frames that are short beside the lag
    time += frame / 40;
    filter.aim({Vec3d(0, speed * time, 0)});
    filter.step(frame / 40, limits);
  }
  CHECK(speed * time - filter.pose().position.y() == near(speed * limits.lag, 0.01));
}

TEST_CASE("no tool moves or turns faster than it may, and it comes to rest where the hand is") {
  const HandLimits limits;
  PoseFilter filter(Vec3d::Zero());
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.5, Vec3d(1, 2, 3).normalized()));
  filter.aim({Vec3d(0.3, -0.2, 0.1), -turn.coeffs()});  // the same turn, the other way to write it
  int frames = 0;
  ToolPose before = filter.pose();
  while (filter.step(frame, limits)) {
    const ToolPose now = filter.pose();
    CHECK((now.position - before.position).norm() <= limits.top_speed * frame * (1 + 1e-12));
    const double angle =
        Eigen::Quaterniond(now.orientation).angularDistance(Eigen::Quaterniond(before.orientation));
    CHECK(angle <= limits.top_turn * frame * (1 + 1e-9));
    CHECK(std::abs(now.orientation.norm() - 1) < 1e-12);
    before = now;
    REQUIRE(++frames < 1000);
  }
  CHECK(frames * frame > 0.374 / limits.top_speed);
  CHECK((before.position - Vec3d(0.3, -0.2, 0.1)).norm() < 1e-6);
  CHECK(Eigen::Quaterniond(before.orientation).angularDistance(turn) < 1e-6);
}

TEST_CASE("where frames take longer than they may, time stretches, and the factor says so") {
  using Clock = Pace::Clock;
  using std::chrono::duration_cast;
  const auto seconds = [](double s) {
    return duration_cast<Clock::duration>(std::chrono::duration<double>(s));
  };
  Pace pace;
  Clock::time_point now{};
  pace.start(now);
  for (int i = 0; i < 100; ++i) now = pace.frame_done(now + seconds(0.002), 0.01, 1, seconds(0.002));
  CHECK(pace.frames_late() == 0);
  CHECK(pace.factor() == near(1, 0.02));
  CHECK(pace.possible_factor() == near(5, 1e-6));
  for (int i = 0; i < 100; ++i) now = pace.frame_done(now + seconds(0.04), 0.01, 1, seconds(0.04));
  CHECK(pace.frames_late() == 100);
  CHECK(pace.factor() == near(0.25, 0.02));
  CHECK(pace.possible_factor() == near(0.25, 1e-6));
  const auto late = now;  // it does not try to catch up with all of that
  int at_once = 0;
  for (int i = 0; i < 100; ++i) {
    const auto next = pace.frame_done(now + seconds(0.002), 0.01, 1, seconds(0.002));
    at_once += next == now + seconds(0.002);
    now = next;
  }
  CHECK(at_once < 15);
  CHECK(std::chrono::duration<double>(now - late).count() > 0.85);
  pace.start(now);
  for (int i = 0; i < 100; ++i) now = pace.frame_done(now + seconds(0.002), 0.01, 0.1, seconds(0.002));
  CHECK(pace.factor() == near(0.1, 0.02));
  CHECK(pace.possible_factor() == near(5, 1e-6));
}
