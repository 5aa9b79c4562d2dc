// A tick of the haptic loop allocates nothing, whatever happens: every allocation of this program is counted,
// as in tests/sim/allocation_test.cpp.
#include <doctest/doctest.h>

#include <cstdlib>
#include <limits>

#include "lobe/haptic/devices.h"

#if defined(__GLIBC__) && !defined(LOBE_SANITIZED)

namespace {
thread_local long allocations = 0;
}

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  ++allocations;
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
}

using namespace lobe;

namespace {

long allocated_by_ticks(HapticDevice& device, HapticLink& link, int ticks) {
  LinkedServo servo(link, device.limits(), {});
  const long before = allocations;
  for (int i = 0; i < ticks; ++i) {
    DeviceState state;
    const bool is_there = device.read(state);
    if (i % 90 == 0) state.position.x() = std::numeric_limits<double>::quiet_NaN();
    if (i % 8 == 0 && i % 400 < 300) {
      LocalModel* model = link.model.writable();
      if (!model) return -1;
      *model = {.is_engaged = i % 1000 < 800,
                .engagement = std::uint32_t(1 + i / 500),
                .is_bilateral = i % 600 < 300};
      model->time = i;
      model->force = {0, 0, 0.01 * (i % 200)};
      model->K = 300 * Mat3<double>::Identity();
      link.model.publish();
    }
    const HapticState& felt = servo.tick(is_there && i % 700 > 20 ? &state : nullptr, 1e-3);
    device.write(felt.force, felt.torque);
  }
  return allocations - before;
}

}  // namespace

TEST_CASE("a tick allocates nothing: with new models, old ones, none, bad poses and without a device") {
  HapticLink link;
  SimulatedHand hand({}, [](double t) -> Vec3d { return {0.01 * t, 0, 0}; });
  CHECK(allocated_by_ticks(hand, link, 4000) == 0);
  MouseDevice mouse;
  mouse.aim(Vec3d::Zero());
  CHECK(allocated_by_ticks(mouse, link, 4000) == 0);
  const long before = allocations;
  std::free(std::malloc(100));  // the counter counts
  CHECK(allocations > before);
}

#endif
