// Forces between frames, against the same body in frames of 1 ms (docs/haptics.md).
#include <doctest/doctest.h>

#include <memory>

#include "benchmarks/haptic_rig.h"
#include "lobe/io/mesh_io.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;
using namespace lobe::bench;

namespace {

constexpr double ms = 1e-3;

struct Case {
  Setup setup;
  std::vector<Index> vertices;
  Vec3d in, along;
};

Case block_case() {
  Case made{.setup = hybrid_setup(irregular_box(5)), .vertices = {}, .in = {0, 0, -1}, .along = {1, 0, 0}};
  made.setup.damping = 20;
  for (Index v = 0; v < made.setup.mesh.vertex_count(); ++v) {
    if (made.setup.mesh.points(2, v) < 0.003) made.setup.prescribed.push_back({v, Vec3d::Zero()});
    if ((made.setup.mesh.points.col(v) - Vec3d(0.025, 0.025, 0.05)).norm() < 0.012)
      made.vertices.push_back(v);
  }
  return made;
}

struct Errors {
  PredictionError constant, time, position, servo;
};

Errors errors_of(const Case& what, const HandPath& path, double frame, double delay, double tick) {
  const auto frames = feel(what.setup, what.vertices, path, frame, true);
  const auto reference = feel(what.setup, what.vertices, path, ms, false);
  const auto error = [&](const Predict& predict) {
    return error_of(frames, reference, delay, tick, predict);
  };
  return {error(constant(frames)), error(linear_in_time(frames)), error(linear_in_position(frames, path)),
          error(by_servo(frames, path, tick))};
}

void tell(const char* name, const Errors& e) {
  MESSAGE(name << ": rms % constant " << 100 * e.constant.rms << ", time " << 100 * e.time.rms
               << ", position " << 100 * e.position.rms << ", servo " << 100 * e.servo.rms << "; max % "
               << 100 * e.constant.highest << ", " << 100 * e.time.highest << ", " << 100 * e.position.highest
               << ", " << 100 * e.servo.highest << "; jump % " << 100 * e.constant.jump << ", "
               << 100 * e.servo.jump << "; peak " << e.servo.peak << " N");
}

}  // namespace

TEST_CASE(
    "between frames of 1/120 s the force is near that of frames of 1 ms, nearer than by simpler means") {
  const Case block = block_case();
  for (double speed : {0.02, 0.05, 0.1}) {
    CAPTURE(speed);
    const HandPath path = press_and_pull(block.in, block.along, 0.008, speed);
    const Errors errors = errors_of(block, path, 1.0 / 120, 2 * ms, ms);
    tell("120 Hz", errors);
    CHECK(errors.servo.rms <= 0.05);
    CHECK(errors.servo.highest <= 0.12);
    CHECK(errors.servo.jump <= 0.02);
    CHECK(errors.servo.rms <= 0.5 * errors.constant.rms);
    CHECK(errors.servo.rms <= errors.time.rms);
  }
}

// Lombardo and Picinbono (1999), of the paper's group.
TEST_CASE(
    "a model at 20 Hz, a force at 500 Hz: constant is worse than linear in time, that than in position") {
  const Case block = block_case();
  const HandPath path = press_and_pull(block.in, block.along, 0.008, 0.1);
  const Errors errors = errors_of(block, path, 0.05, 0, 2 * ms);
  tell("20 Hz", errors);
  CHECK(errors.constant.rms > errors.time.rms);
  CHECK(errors.time.rms > errors.position.rms);
}
