// What a session has in memory after hours. The allocator counts it to the byte. Other C libraries, and the
// sanitizers, do not count so: the test is then left out.
#include "live/hands_support.h"

#if defined(__GLIBC__) && !defined(LOBE_SANITIZED)
#include <malloc.h>

#include <cmath>

using namespace lobe;
using namespace lobe::test;

namespace {

double allocated_bytes() {
  const auto info = mallinfo2();
  return double(info.uordblks) + double(info.hblkhd);
}

Setup small_body() {
  Setup setup = setup_of(box_mesh(Vec3d::Constant(0.04), 2, 2, 2));
  setup.damping = 20;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < 1e-4) setup.prescribed.push_back({v});
  return setup;
}

// The growth of a session per frame in 20,000 frames, after the states to go back to have filled their room.
template <class BeforeFrame>
double bytes_per_frame(Session<float>& session, BeforeFrame&& before_frame) {
  constexpr int first = 6000, frames = 20000;
  double before = 0;
  for (int i = 0; i < first + frames; ++i) {
    if (i == first) before = allocated_bytes();
    before_frame(i);
    REQUIRE(session.step_frame());
  }
  return (allocated_bytes() - before) / frames;
}

SessionOptions with_little_memory() {
  SessionOptions options;
  options.back_memory = 100'000;
  return options;
}

}  // namespace

TEST_CASE("a session in which nothing is done does not grow") {
  const Setup setup = small_body();
  Session<float> session(setup, with_little_memory());
  CHECK(bytes_per_frame(session, [](int) {}) < 1);
  CHECK(session.recording().commands.size() == 26000);
  CHECK(replays(session, setup));
}

TEST_CASE("a tool that is led costs a session 40 bytes per frame") {
  const Setup setup = small_body();
  Session<float> session(setup, with_little_memory());
  Controller mouse = session.connect("mouse");
  const Vec3d corner = Vec3d::Constant(0.04);
  mouse.send(take_at(corner, 0.005));
  CHECK(bytes_per_frame(session, [&](int i) {
          const double angle = 0.05 * i;
          mouse.send(lead_to(corner + 0.002 * Vec3d(std::sin(angle), std::cos(angle), 0)));
        }) < 40);
  CHECK(replays(session, setup));
}

TEST_CASE("a tool that was taken away leaves the lists that a frame looks at, and costs at most 1200 bytes") {
  const Setup setup = small_body();
  Session<float> session(setup, with_little_memory());
  Controller mouse = session.connect("mouse");
  const Vec3d corner = Vec3d::Constant(0.04);
  const double per_frame = bytes_per_frame(session, [&](int i) {
    if (i % 10 == 0) mouse.send(take_at(corner, 0.005));
    if (i % 10 == 5) mouse.send(lead_to(corner + Vec3d(0, 0, 1e-3)));
    if (i % 10 == 9) mouse.send(ask(Kind::let_go));
  });
  CHECK(10 * per_frame < 1200);
  CHECK(session.world().tools().lists().grasps.size() <= 2);
  const auto paths = session.world().tools().live_paths().grasps;
  CHECK(paths.size() == 2600);
  CHECK(paths[1000].path.size() > 1);
  CHECK(replays(session, setup));
}

#endif
