// What tests of needles share: a block, and a half circle that is turned through its top.
#pragma once

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "lobe/mesh/generators.h"
#include "lobe/setup/setup.h"
#include "lobe/sim/world.h"
#include "support.h"

namespace lobe::test {

inline constexpr double needle_frame = 0.002, sewing_frame = 0.01;  // [s]
inline constexpr double needle_radius = 0.01;                       // [m]
inline constexpr double block_top = 0.02;                           // [m]
inline constexpr double half_chord = 0.009539392;  // where a needle at above_block enters, from it [m]
inline const Vec3d above_block(0.0203, 0.0198, block_top + 0.003);

// Turned by φ about the axis of the arc, which is along −y: the tip is at φ = π on the left, at 3π/2 deepest.
inline PathPoint turned(double time, const Vec3d& centre, double phi) {
  Mat3<double> axes;
  axes << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  const Eigen::Quaterniond q(Mat3<double>(axes * Eigen::AngleAxisd(phi, Vec3d::UnitZ()).toRotationMatrix()));
  return {time, centre, q.normalized().coeffs()};
}

// A turn from φ = π by `turns`, in a time.
inline std::vector<PathPoint> turning(double turns, double duration, const Vec3d& centre = above_block) {
  std::vector<PathPoint> path;
  const int rows = 1 + int(std::ceil(8 * turns));
  for (int i = 0; i <= rows; ++i)
    path.push_back(
        turned(duration * i / rows, centre, std::numbers::pi * (1 + 2 * turns * double(i) / rows)));
  return path;
}

// The tip goes down to a depth below the top of the block.
inline std::vector<PathPoint> pushed_down(double depth, double duration) {
  const Vec3d start = above_block + Vec3d(needle_radius, 0, 0.0005 - 0.003);
  return {turned(0, start, std::numbers::pi),
          turned(duration, start - Vec3d(0, 0, depth + 0.0005), std::numbers::pi)};
}

// Soft, held at the bottom.
inline Setup sewn_block(double young = 2e4) {
  Setup setup = setup_of(box_mesh({0.04, 0.04, block_top}, 8, 8, 4));
  setup.materials = {Elastic{young / 1.3 * 0.3 / 0.4, young / 2.6, 1000}};
  setup.damping = 40;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) == 0) setup.prescribed.push_back({v});
  return setup;
}

inline NeedleSetup half_circle_needle(std::vector<PathPoint> path) {
  NeedleSetup needle;
  needle.name = "needle";
  needle.settings = {{needle_radius, std::numbers::pi, 5e-4}, 0.2, 20};
  needle.thread = 3;
  needle.material.holds = 1.5;
  needle.path = std::move(path);
  return needle;
}

inline BringNeedle brought_needle(const PathPoint& at) {
  const NeedleSetup needle = half_circle_needle({at});
  return {needle.name, needle.settings, {at.position, at.orientation}, needle.thread, needle.material};
}

// Returns the events of the frames.
template <class Real>
std::vector<Event> play_frames(World<Real>& world, int frames) {
  std::vector<Event> events;
  for (int i = 0; i < frames; ++i) {
    const Report report = world.advance(sewing_frame);
    REQUIRE(report.ok);
    events.insert(events.end(), report.events.begin(), report.events.end());
  }
  return events;
}

// The only thread of a world.
template <class Real>
const Thread& sewn_thread(World<Real>& world) {
  const Threads<Real>* threads = term_of<Threads>(world.body().terms);
  REQUIRE(threads);
  REQUIRE(threads->all().size() == 1);
  return threads->all().front();
}

}  // namespace lobe::test
