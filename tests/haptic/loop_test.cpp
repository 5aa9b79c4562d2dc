#include "lobe/haptic/loop.h"

#include <doctest/doctest.h>

#include <chrono>
#include <thread>

#include "lobe/haptic/devices.h"
#include "near.h"

#if defined(__linux__)
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#endif

using namespace lobe;
using namespace lobe::test;

namespace {

// However late a busy machine lets the loop begin.
void wait_for_ticks(const HapticLoop& loop) {
  for (int i = 0; i < 60000 && (loop.times().lateness.total() == 0 || loop.times().compute.total() == 0); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace

TEST_CASE("a loop ticks a thousand times a second, feels the model, and leaves the device without a force") {
  class Noting final : public HapticDevice {
   public:
    std::string name() const override { return "noting"; }
    DeviceLimits limits() const override { return {.damping = 1}; }
    bool read(DeviceState& state) noexcept override {
      state.position = {0.001, 0, 0};
      return true;
    }
    void write(const Vec3d& force, const Vec3d&) noexcept override {
      last = force;
      highest = std::max(highest, force.norm());
    }
    Vec3d last = Vec3d::Ones();
    double highest = 0;
  } device;
  HapticLink link;
  HapticLoop loop(device, link);
  loop.start();
  LocalModel model{.is_engaged = true, .engagement = 1};
  model.K = 500 * Mat3<double>::Identity();
  model.tool_at_end = {0.001, 0, 0};
  const auto half_a_second_of_frames = [&] {
    for (int i = 0; i < 60; ++i) {
      model.time += 1.0 / 120;
      *link.model.writable() = model;
      link.model.publish();
      std::this_thread::sleep_for(std::chrono::microseconds(8333));
    }
  };
  half_a_second_of_frames();
  const auto state = link.state.latest();
  REQUIRE(state);
  CHECK(state->engagement == 1);
  CHECK(state->is_there);
  loop.stop();
  const std::uint64_t ticks = loop.times().compute.total(), missed = loop.times().missed;
  CHECK(ticks + missed > 300);  // however busy the machine is, time passes
  CHECK(ticks + missed < 30000);
  CHECK(device.last.norm() == 0);
  CHECK(device.highest > 0.1);
#ifndef LOBE_SANITIZED  // whose code is several times as slow
  // On a machine that is busy with something else a tick may be interrupted: the best of some trials counts.
  double highest_99 = loop.times().compute.quantile(0.99);
  for (int trial = 0; trial < 9 && highest_99 > 20; ++trial) {
    loop.forget_times();
    loop.start();
    half_a_second_of_frames();
    loop.stop();
    highest_99 = std::min(highest_99, double(loop.times().compute.quantile(0.99)));
  }
  CHECK(highest_99 <= 20);  // [us]
#endif
  if (!loop.is_real_time()) {
    REQUIRE(!loop.warnings().empty());
    CHECK(loop.warnings().front().find("rtprio") != std::string::npos);
  }
}

TEST_CASE("an ordinary thread is what one gets by asking for it, without a warning") {
  SimulatedHand hand({}, [](double) -> Vec3d { return Vec3d::Zero(); });
  HapticLink link;
  HapticLoop loop(hand, link, {.priority = 0, .lock_memory = false});
  loop.start();
  loop.start();  // nothing more
  loop.stop();
  CHECK_FALSE(loop.is_real_time());
  CHECK(loop.warnings().empty());
  loop.start();
  wait_for_ticks(loop);
  loop.stop();
  CHECK(loop.times().lateness.total() > 0);
  loop.forget_times();
  CHECK(loop.times().lateness.total() == 0);
}

#if defined(__linux__)
namespace {

// Of a loop in a process of an ordinary user who may neither have a priority nor lock memory: one line each.
// "-" if this process cannot become one.
std::string warnings_without_permission() {
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    const rlimit nothing{0, 0};
    std::string said;
    if (setrlimit(RLIMIT_RTPRIO, &nothing) != 0 || setrlimit(RLIMIT_MEMLOCK, &nothing) != 0 ||
        (geteuid() == 0 && setresuid(65534, 65534, 65534) != 0)) {
      said = "-";
    } else {
      SimulatedHand hand({}, [](double) -> Vec3d { return Vec3d::Zero(); });
      HapticLink link;
      HapticLoop loop(hand, link);
      loop.start();
      wait_for_ticks(loop);
      loop.stop();
      for (const std::string& warning : loop.warnings()) said += warning + '\n';
      said += loop.is_real_time() ? "real time\n" : "ordinary\n";
      said += loop.times().compute.total() > 0 ? "ticks\n" : "stands still\n";
    }
    const auto written = write(ends[1], said.data(), said.size());
    _exit(written == static_cast<ssize_t>(said.size()) ? 0 : 1);
  }
  close(ends[1]);
  std::string said;
  char part[512];
  for (ssize_t size = 0; (size = read(ends[0], part, sizeof part)) > 0;)
    said.append(part, static_cast<std::size_t>(size));
  close(ends[0]);
  int status = -1;
  REQUIRE(waitpid(child, &status, 0) == child);
  REQUIRE(status == 0);
  return said;
}

}  // namespace

TEST_CASE(
    "without permission the loop runs as an ordinary thread, and says what comes of it and what to do") {
  const std::string said = warnings_without_permission();
  if (said == "-") {
    MESSAGE("this process cannot give up its permissions");
    return;
  }
  CAPTURE(said);
  const auto says = [&](const char* text) { return said.find(text) != std::string::npos; };
  CHECK(says("the haptic loop is an ordinary thread (SCHED_FIFO: "));
  CHECK(says("some ticks in a thousand come milliseconds late, and stiff contacts may vibrate"));
  CHECK(says("allow rtprio 50 in /etc/security/limits.conf"));
#ifndef LOBE_SANITIZED  // sanitizers let no memory be locked, and say that it is
  CHECK(says("the memory of the haptic loop is not locked (mlockall: "));
  CHECK(says("a tick may wait for the disk; allow memlock unlimited in /etc/security/limits.conf"));
#endif
  CHECK(says("\nordinary\nticks\n"));
}
#endif

TEST_CASE("quantiles of a histogram") {
  Histogram histogram;
  for (int i = 0; i < 100; ++i) histogram.add(1e-6 * i + 5e-7);
  histogram.add(1);
  CHECK(histogram.total() == 101);
  CHECK(histogram.quantile(0.5) == near(51, 1e-12));
  CHECK(histogram.longest() == near(1e6, 1e-12));
  CHECK(histogram[Histogram::buckets - 1] == 1);
}
