// A step allocates nothing. Every allocation of this program is counted: the C library's functions are replaced by ones
// that count and then call it. Other C libraries, and the sanitizers, have no such entry points: the test is then left out.
#include <doctest/doctest.h>

#include <atomic>
#include <cstdlib>

#include "lobe/sim/world.h"
#include "support.h"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)

namespace {
std::atomic<long> allocations{0};
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
using namespace lobe::test;

namespace {

template <class Real>
long allocations_of_steps(const Setup& setup, int threads) {
  World<Real> world(setup, threads);
  const double dt = 0.1 * world.time_step_limit();
  for (int i = 0; i < 20; ++i) world.step(dt);  // threads start, and take what they need
  const long before = allocations;
  for (int i = 0; i < 20; ++i) world.step(dt);
  return allocations - before;
}

}  // namespace

TEST_CASE("a step allocates nothing, whatever the regions, on one thread and on two") {
  const long before = allocations;
  const std::vector<int> something(100);
  REQUIRE(allocations > before);           // they are counted
  const TetMesh mesh = irregular_box(10);  // large enough for both threads
  Setup stored = hybrid_setup(mesh);
  stored.evaluator = Evaluator::stored;
  Setup held = hybrid_setup(mesh);
  held.prescribed = {{0, Vec3d(1e-4, 0, 0)}, {1, Vec3d::Zero(), {true, false, false}}};
  held.load_ramp = 1;
  held.gravity = Vec3d(0, 0, -9.81);
  Setup selective = held;
  selective.selective_mass = 9;
  for (const Setup& setup : {hybrid_setup(mesh), averaged(hybrid_setup(mesh)), stored, held, selective})
    for (int threads : {1, 2}) {
      CAPTURE(threads);
      CHECK(allocations_of_steps<float>(setup, threads) == 0);
      CHECK(allocations_of_steps<double>(setup, threads) == 0);
    }
}

#endif
