#include "benchmarks/reduced/trial_run.h"

#include <cmath>

#include "benchmarks/timing.h"

namespace lobe::reduced {
namespace {

std::vector<std::pair<double, Vec3d>> pull(double begin, double reached, double end, const Vec3d& by) {
  return {{begin, Vec3d::Zero()}, {reached, by}, {end, by}};
}

// That of data/scenes/liver_undeclared.json until it is cut, and the same the other way round.
Gesture shipped(const std::string& name, double s) {
  return {name,
          6.6,
          {{{0.082, -0.045, 0.035}, 0.016, pull(0, 0.8, 1.0, s * Vec3d(0.004, -0.004, 0.04))},
           {{0.082, -0.045, 0.035}, 0.016, pull(1.6, 2.4, 2.6, s * Vec3d(0, 0.035, 0))},
           {{0.082, -0.055, 0.035}, 0.018, pull(3.2, 4.0, 4.2, s * Vec3d(0, 0, 0.02))},
           {{0.065, -0.015, 0.045}, 0.018, pull(3.2, 4.0, 4.2, s * Vec3d(0, 0, -0.015))},
           {{-0.09, -0.03, -0.02}, 0.025, pull(4.8, 5.4, 5.6, s * Vec3d(0.002, 0.006, 0.015))},
           {{0.082, -0.045, 0.035}, 0.016, pull(6.0, 6.6, 9.9, s * Vec3d(0.004, -0.004, 0.02))}}};
}

bool touches(double time, double event) { return std::abs(time - event) < 1e-6; }

struct Hands {  // which vertices are held by which grasp, from where
  std::vector<Index> vertices;
  std::vector<std::pair<int, Vec3d>> holds;
  std::vector<int> grasp_of;  // per vertex, -1: none

  template <class Real>
  void follow(const Body& body, const Gesture& gesture, const std::vector<std::uint8_t>& held, double time,
              const Mat3X<Real>& u) {
    std::vector<Vec3d> from(grasp_of.size());
    for (std::size_t n = 0; n < vertices.size(); ++n) from[vertices[n]] = holds[n].second;
    for (std::size_t g = 0; g < gesture.grasps.size(); ++g) {
      const Grasp& grasp = gesture.grasps[g];
      for (std::size_t v = 0; v < grasp_of.size(); ++v) {
        if (touches(time, grasp.path.back().first) && grasp_of[v] == int(g)) grasp_of[v] = -1;
        if (!touches(time, grasp.path.front().first) || held[v] || grasp_of[v] >= 0 ||
            (body.mesh.points.col(Index(v)) - grasp.centre).norm() > grasp.radius)
          continue;
        grasp_of[v] = int(g);
        from[v] = u.col(Index(v)).template cast<double>();
      }
    }
    vertices.clear();
    holds.clear();
    for (std::size_t v = 0; v < grasp_of.size(); ++v)
      if (grasp_of[v] >= 0) vertices.push_back(Index(v)), holds.emplace_back(grasp_of[v], from[v]);
  }
  void find_targets(const Gesture& gesture, double time, Mat3X<double>& targets) const {
    for (std::size_t n = 0; n < holds.size(); ++n)
      targets.col(Index(n)) = holds[n].second + gesture.grasps[std::size_t(holds[n].first)].at(time);
  }
};

std::vector<std::uint8_t> zone(const Body& body, const Gesture& gesture, const Policy& policy, double time) {
  const Index vertices = body.mesh.vertex_count();
  std::vector<std::uint8_t> wanted(vertices, !policy.is_reduced);
  for (const Grasp& grasp : gesture.grasps) {
    const double begin = grasp.path.front().first, end = grasp.path.back().first;
    if (time > end - 1e-6 && time < end + policy.burst - 1e-6) wanted.assign(vertices, 1);
    if (time < begin - 1e-6 || time > end + policy.after - 1e-6) continue;
    for (Index v = 0; v < vertices; ++v)
      if ((body.mesh.points.col(v) - grasp.centre).norm() <= grasp.radius + policy.margin) wanted[v] = 1;
  }
  return wanted;
}

}  // namespace

Vec3d Grasp::at(double time) const {
  if (time <= path.front().first) return path.front().second;
  for (std::size_t k = 1; k < path.size(); ++k)
    if (time <= path[k].first) {
      const double part = (time - path[k - 1].first) / (path[k].first - path[k - 1].first);
      return (1 - part) * path[k - 1].second + part * path[k].second;
    }
  return path.back().second;
}

Organ liver() {
  return {"liver",
          [](const Vec3d& X) { return X[0] >= -0.12 && X[0] <= -0.02 && X[1] >= 0.015; },
          {shipped("shipped", 1),
           shipped("reversed", -1),
           {"elsewhere",
            5.0,
            {{{0.05, -0.03, 0.03}, 0.014, pull(0, 0.6, 0.8, {-0.01, -0.02, 0.015})},
             {{-0.05, -0.05, -0.03}, 0.018, pull(1.4, 2.0, 2.2, {0, -0.025, 0})},
             {{0.09, -0.035, 0.04}, 0.014, pull(2.8, 3.4, 3.5, {0.01, 0, -0.03})}}}}};
}

Organ kidney() {
  return {"kidney",
          [](const Vec3d& X) { return X[2] < -0.03; },
          {{"bend and twist",
            5.0,
            {{{0, 0, 0.045}, 0.014, pull(0, 0.6, 0.8, {0.02, 0.005, 0})},
             {{0.012, 0, 0.04}, 0.01, pull(1.4, 2.0, 2.2, {0, 0.01, 0})},
             {{-0.012, 0, 0.04}, 0.01, pull(1.4, 2.0, 2.2, {0, -0.01, 0})},
             {{0.02, 0, 0.01}, 0.01, pull(2.8, 3.4, 3.6, {-0.008, 0, 0.003})}}}}};
}

std::vector<std::uint8_t> held_vertices(const Body& body, const Organ& organ) {
  std::vector<std::uint8_t> held;
  for (Index v = 0; v < body.mesh.vertex_count(); ++v) held.push_back(organ.is_held(body.mesh.points.col(v)));
  return held;
}

template <class Real>
Played play(const Body& body, const Organ& organ, const Gesture& gesture, const TrialSettings& settings,
            const Policy& policy, double safety, Index compared) {
  const std::vector<std::uint8_t> held = held_vertices(body, organ);
  TrialBody<Real> trial(body, held, settings);
  Hands hands;
  hands.grasp_of.assign(held.size(), -1);
  Played played;
  std::vector<std::uint8_t> current(held.size(), 1);
  const int frames = static_cast<int>(std::lround(gesture.duration / frame_duration));
  constexpr int parts = 3;  // of a frame, between which the limit is found anew
  for (int frame = 0; frame < frames; ++frame) {
    const bench::Stopwatch watch(true);
    double time = frame * frame_duration;
    const auto wanted = zone(body, gesture, policy, time);
    if (wanted != current) {
      if (frame > 0 || policy.is_reduced) trial.set_zone(wanted);
      current = wanted;
      played.changing += watch.seconds();
    }
    hands.follow(body, gesture, held, time, trial.u());
    trial.grasp(hands.vertices);
    Mat3X<double> targets(3, hands.vertices.size());
    for (int part = 0; part < parts; ++part) {
      const double left = frame_duration / parts, limit = trial.limit();
      if (!(limit > 0)) break;  // not finite any more
      const int steps = static_cast<int>(std::ceil(left / (safety * limit)));
      const double begin = time + part * left, dt = left / steps;
      for (int step = 0; step < steps; ++step) {
        hands.find_targets(gesture, begin + (step + 1) * dt, targets);
        trial.step(dt, targets);
      }
      played.steps += steps;
      played.full_share += steps * trial.full_share();
    }
    trial.expand();
    const double seconds = watch.seconds();
    played.seconds += seconds;
    played.slowest = std::max(played.slowest, seconds);
    played.frames.push_back(trial.u().leftCols(compared).template cast<float>());
    if (!trial.u().allFinite()) break;
  }
  while (int(played.frames.size()) < frames) played.frames.push_back(played.frames.back());
  played.full_share /= double(played.steps);
  played.transitions = trial.transitions();
  return played;
}

template Played play<float>(const Body&, const Organ&, const Gesture&, const TrialSettings&, const Policy&,
                            double, Index);
template Played play<double>(const Body&, const Organ&, const Gesture&, const TrialSettings&, const Policy&,
                             double, Index);

Errors compare(const Played& played, const Played& reference) {
  Errors errors;
  double norm = 0;
  const auto vertices = std::min(played.frames.front().cols(), reference.frames.front().cols());
  for (std::size_t k = 0; k < reference.frames.size(); ++k) {
    const auto exact = reference.frames[k].leftCols(vertices);
    norm = std::max(norm, double(exact.norm()));
    const double error = double((played.frames[k].leftCols(vertices) - exact).norm()) / norm;
    errors.mean += error / double(reference.frames.size());
    errors.above += error > 0.02;
    if (error > errors.largest || std::isnan(error))
      errors.largest = error, errors.largest_at = double(k + 1) * frame_duration;
  }
  return errors;
}

}  // namespace lobe::reduced
