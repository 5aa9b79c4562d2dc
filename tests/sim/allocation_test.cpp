// A step allocates nothing, and advance() what its report takes, however many steps it has. Every allocation
// of this program is counted: the C library's functions are replaced by ones that count and then call it.
// Other C libraries, and the sanitizers, have no such entry points: the test is then left out.
#include <doctest/doctest.h>

#include <atomic>
#include <cstdlib>
#include <string>

#include "condense/half_linear.h"
#include "fibre_support.h"
#include "lobe/forces/embedded.h"
#include "lobe/run/recording.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/world.h"
#include "support.h"

#if defined(__GLIBC__) && !defined(LOBE_SANITIZED)

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

// A frame in which the body has moved far enough searches anew for what may touch itself, which allocates.
const std::string searching = "in self contact, a probe far away";

// Every kind of region, of law, of frame, of mass and of force, with a name for messages.
std::vector<std::pair<std::string, Setup>> all_kinds() {
  const TetMesh mesh = irregular_box(10);  // large enough for several threads
  Setup held = hybrid_setup(mesh);
  held.prescribed = {{0, Vec3d(1e-4, 0, 0)}, {1, Vec3d::Zero(), {true, false, false}}};
  held.load_ramp = 1;
  held.gravity = Vec3d(0, 0, -9.81);
  std::vector<std::pair<std::string, Setup>> kinds{
      {"hybrid", hybrid_setup(mesh)}, {"nodal pressure", averaged(hybrid_setup(mesh))}, {"held", held}};
  const auto add = [&](const std::string& name, const Setup& from, auto&& change) {
    change(kinds.emplace_back(name, from).second);
  };
  add("guarded", held, [](Setup& s) { s.guard_below = 0.2; });
  add("selective masses", held, [](Setup& s) { s.selective_mass = 9; });
  add("sleeping", held, [](Setup& s) {
    s.gravity.setZero();
    s.prescribed.clear();
    s.sleep = 1e-4;
  });
  Setup precomputed = half_linear(RegionModel::precomputed, 10);
  precomputed.gravity = Vec3d(0, 0, -9.81);
  add("precomputed", precomputed, [](Setup&) {});
  add("in a frame, with loads", precomputed, [](Setup& s) { s.precomputed_frame = RegionFrame::corotated; });
  add("in a frame, without loads", precomputed, [](Setup& s) {
    s.precomputed_frame = RegionFrame::corotated;
    s.gravity.setZero();
  });
  add("expandable", precomputed, [](Setup& s) { s.expandable = true; });
  add("corotational", hybrid_setup(mesh),
      [](Setup& s) { s.region_of.assign(s.region_of.size(), RegionModel::corotational); });
  add("neo-Hookean", neo_hookean_setup(mesh), [](Setup&) {});
  add("fibres", fibrous_setup(mesh), [](Setup&) {});
  add("smoothed edges", smoothed(averaged(setup_of(mesh))), [](Setup&) {});
  add("reduced", held, [](Setup& s) {
    s.region_of.assign(s.region_of.size(), RegionModel::reduced);
    s.damping = 20;
  });
  const Vec3d above = mesh.points.rowwise().maxCoeff() - Vec3d(0.025, 0.025, -0.008);
  const Vec3d apart(0, 0, 0.05);
  add("a probe that presses", held, [&](Setup& s) {
    s.damping = 20;
    s.probes = {{"probe", RigidShape::sphere(0.01), 0.1, {{0, above}, {0.001, above}}, false}};
  });
  add(searching, held, [&](Setup& s) {
    s.contact.self = true;
    s.probes = {
        {"probe", RigidShape::sphere(0.01), 0.1, {{0, above + apart}, {0.001, above + apart}}, false}};
  });
  add("sewn, with tissue that gives way", held, [&](Setup& s) {
    StitchSetup stitch;
    stitch.material.holds = 1e-3;
    const Locator locator(mesh);
    for (const Vec3d& X : {Vec3d(0.03, 0.05, 0.07), Vec3d(0.05, 0.04, 0.06), Vec3d(0.07, 0.05, 0.07)})
      stitch.bites.push_back(embed(locator, X).point);
    stitch.ties = {{0, 2, 0, 0.01, 1}};
    s.stitches = {stitch};
  });
  add("a bed that tears", held, [&](Setup& s) {
    AttachmentSetup bed;
    bed.name = "bed";
    bed.holds_until = 1e-9;
    const Locator locator(mesh);
    for (int i = 0; i < 40; ++i) {
      StrandSetup& strand = bed.strands.emplace_back();
      const Vec3d X(0.03 + 0.001 * i, 0.05, 0.06);
      strand.from = embed(locator, X).point;
      strand.anchor = X;
      strand.stiffness = 1 + i;
    }
    s.attachments = {bed};
  });
  return kinds;
}

template <class Real>
long allocations_of_steps(const Setup& setup, int threads) {
  World<Real> world(setup, threads);
  world.apply(SetSprings{{{5, 10, setup.mesh.points.col(5)}}});
  const double dt = 0.1 * world.time_step_limit();
  world.advance(20 * dt);                       // tools are seen, a lattice takes over
  for (int i = 0; i < 20; ++i) world.step(dt);  // threads start, and take what they need
  const long before = allocations;
  for (int i = 0; i < 20; ++i) world.step(dt);
  return allocations - before;
}

template <class Real>
long allocations_of_a_frame(const Setup& setup, int steps) {
  World<Real> world(setup);
  const double frame = (steps - 0.5) * setup.safety * world.time_step_limit();
  REQUIRE(world.advance(frame).steps == steps);
  world.step_limit().forget();  // so that this frame looks for the limit, as longer ones do
  const long before = allocations;
  REQUIRE(world.advance(frame).steps == steps);
  return allocations - before;
}

}  // namespace

TEST_CASE("a step allocates nothing, on one, two and seven threads") {
  const long before = allocations;
  ::operator delete(::operator new(100));  // a call, which a compiler may not leave out
  REQUIRE(allocations > before);           // they are counted
  for (const auto& [name, setup] : all_kinds())
    for (int threads : {1, 2, 7}) {
      CAPTURE(name);
      CAPTURE(threads);
      CHECK(allocations_of_steps<float>(setup, threads) == 0);
      CHECK(allocations_of_steps<double>(setup, threads) == 0);
    }
}

TEST_CASE("what advance() allocates does not grow with its steps") {
  for (const auto& [name, setup] : all_kinds()) {
    if (name == searching) continue;
    CAPTURE(name);
    CHECK(allocations_of_a_frame<float>(setup, 60) == allocations_of_a_frame<float>(setup, 40));
    CHECK(allocations_of_a_frame<double>(setup, 60) == allocations_of_a_frame<double>(setup, 40));
  }
}

TEST_CASE("a recorder begins without a copy of the world") {
  const Setup setup = hybrid_setup(irregular_box(3));
  World<float> world(setup);
  const long before = allocations;
  const CommandRecorder<float> recorder(world);
  CHECK(allocations == before);
  CHECK(recorder.recording().setup == fingerprint(setup));
  const Checkpoint<float> copy = world.save();
  CHECK(allocations > before + 5);  // a copy would be seen
}

#endif
