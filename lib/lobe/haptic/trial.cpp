#include "lobe/haptic/trial.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "lobe/haptic/approach.h"
#include "lobe/sim/world.h"

namespace lobe {
namespace {

// Vertices about the free place of the surface that is furthest from all that is held.
template <class Real>
std::vector<Index> place_to_pull(World<Real>& world) {
  const auto X = world.elements().points.view();
  const std::vector<Index>& surface = world.surface().mesh().mesh_vertex;
  Index furthest = -1;
  double distance = -1;
  for (Index v : surface) {
    double nearest = 1e30;
    for (const HeldVertices::Held& item : world.held().all())
      nearest = std::min(nearest, (X.col(v) - X.col(item.vertex)).norm());
    if (nearest > distance && !world.held().fixes(v)) distance = nearest, furthest = v;
  }
  if (furthest < 0) return {};
  std::vector<Index> vertices(surface);
  std::erase_if(vertices, [&](Index v) { return world.held().fixes(v); });
  const auto by_distance = [&](Index a, Index b) {
    return (X.col(a) - X.col(furthest)).squaredNorm() < (X.col(b) - X.col(furthest)).squaredNorm();
  };
  const std::size_t count = std::min<std::size_t>(8, vertices.size());
  std::partial_sort(vertices.begin(), vertices.begin() + std::ptrdiff_t(count), vertices.end(), by_distance);
  vertices.resize(count);
  std::sort(vertices.begin(), vertices.end());
  return vertices;
}

}  // namespace

template <class Real>
HapticTrial try_direct(const Setup& setup, int threads, int frames) {
  World<Real> world(setup, threads);
  const std::vector<Index> vertices = place_to_pull(world);
  const ToolId tool = world.tools().next_id();
  if (!vertices.empty()) world.apply(TakeHold{"trial", vertices});
  const RigidShape ball = RigidShape::sphere(0.008);
  std::vector<double> times;
  Vec3d centre = Vec3d::Zero();
  for (int i = 0; i < frames; ++i) {
    if (const Grasp* grasp = world.tools().grasp(tool); grasp && grasp->phase == Grasp::Phase::holding) {
      centre = grasp->centre;
      const double angle = 0.02 * i;
      world.apply(Lead{tool, {centre + 0.002 * Vec3d(std::sin(angle), 0, 1 - std::cos(angle))}});
    }
    const auto begun = std::chrono::steady_clock::now();
    world.advance(direct_frame);
    if (!vertices.empty()) approach_of(world, ball, 0, {.position = centre}, 1e-3);
    times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count());
  }
  std::sort(times.begin(), times.end());
  HapticTrial trial{.frames = frames};
  trial.p50 = times[times.size() / 2];
  trial.p99 = times[std::min(times.size() - 1, times.size() * 99 / 100)];
  // Waves that are shorter than a lattice's cells stay in what is full, and the force would chatter.
  const bool is_reduced = world.body().regions.any_reduced();
  trial.is_direct = !is_reduced && trial.p99 < direct_share * direct_frame;
  return trial;
}

template HapticTrial try_direct<float>(const Setup&, int, int);
template HapticTrial try_direct<double>(const Setup&, int, int);

}  // namespace lobe
