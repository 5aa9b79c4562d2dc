// Order of convergence in time: a linear eigenmode against cos ωt, and SVK against itself with halved steps.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "benchmarks/validation/bodies.h"
#include "benchmarks/validation/cases.h"
#include "benchmarks/validation/modes.h"
#include "lobe/mesh/generators.h"
#include "lobe/sim/world.h"

namespace lobe::validation {
namespace {

struct Scheme {
  const char* name;
  void (*choose)(Setup& setup);
};

constexpr Scheme schemes[] = {
    {"central differences", [](Setup&) {}},
    {"generalised-α", [](Setup& setup) { setup.integrator = lobe::Integrator::generalised_alpha; }}};

Setup clamped_bar(RegionModel model, const Scheme& scheme) {
  Setup setup = body_of(box_mesh({0.1, 0.02, 0.02}, 10, 2, 2), Elastic{}, model);
  prescribe(setup, vertices_where(setup.mesh, [](const Vec3d& X) { return X.x() == 0; }),
            [](const Vec3d&) { return Vec3d::Zero(); });
  scheme.choose(setup);
  return setup;
}

// Twice as many steps each time, from the stability limit of central differences on.
std::vector<int> step_counts(const Setup& setup, double duration, int runs) {
  std::vector<int> steps{int(std::ceil(duration / (0.8 * World<double>(setup).time_step_limit())))};
  while (int(steps.size()) < runs) steps.push_back(2 * steps.back());
  return steps;
}

// Largest error over a period and a half, relative to the amplitude.
double eigenmode_error(const Setup& setup, const Mode& mode, double duration, int steps) {
  const double dt = duration / steps;
  World<double> world(setup);
  State<double> state = world.state();
  state.u = 1e-3 * mode.shape;
  world.set_state(state);
  double worst = 0;
  for (int i = 1; i <= steps; ++i) {
    world.step(dt);
    const Mat3X<double> error = world.state().u - std::cos(mode.omega * i * dt) * state.u;
    worst = std::max(worst, error.norm());
  }
  return worst / state.u.norm();
}

void eigenmode(Findings& findings, const Scheme& scheme) {
  const Setup setup = clamped_bar(RegionModel::tensor_mass, scheme);
  Mat3X<double> guess = Mat3X<double>::Zero(3, setup.mesh.vertex_count());
  guess.row(2) = setup.mesh.points.row(0).array().square();
  const Mode mode = mode_like(setup, guess);
  const double duration = 1.5 * 2 * std::numbers::pi / mode.omega;
  std::vector<double> sizes, errors;
  for (int steps : step_counts(setup, duration, 3)) {
    sizes.push_back(1.0 / steps);
    errors.push_back(eigenmode_error(setup, mode, duration, steps));
  }
  const std::string name = std::string(scheme.name) + ", linear eigenmode";
  findings.study(name, sizes, errors);
  findings.order(name, "u against cos ωt", observed_order(sizes, errors), 2,
                 {0.1, "steps are not yet in the limit"});
}

// A bar bent by its weight is let go.
Mat3X<double> released(const Setup& setup, const Mat3X<double>& start, double duration, int steps) {
  const double dt = duration / steps;
  World<double> world(setup);
  State<double> state = world.state();
  state.u = start;
  world.set_state(state);
  for (int i = 0; i < steps; ++i) world.step(dt);
  return world.state().u;
}

void large_motion(Findings& findings, const Scheme& scheme) {
  Setup setup = clamped_bar(RegionModel::nonlinear, scheme);
  setup.gravity = {0, 0, -3};
  const Mat3X<double> start = equilibrium(setup);
  setup.gravity = Vec3d::Zero();
  const double duration = 0.1;
  const std::vector<int> steps = step_counts(setup, duration, 4);
  std::vector<Mat3X<double>> ends;
  for (int n : steps) ends.push_back(released(setup, start, duration, n));
  std::vector<double> sizes, differences;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    sizes.push_back(1.0 / steps[i]);
    differences.push_back((ends[i] - ends[i + 1]).norm() / start.norm());
  }
  const std::string name = std::string(scheme.name) + ", SVK, large motion";
  findings.study(name, sizes, differences);
  findings.order(name, "u against half the step", observed_order(sizes, differences), 2,
                 {0.1, "steps are not yet in the limit"});
}

}  // namespace

void orders_in_time(Findings& findings, bool) {
  for (const Scheme& scheme : schemes) {
    eigenmode(findings, scheme);
    large_motion(findings, scheme);
  }
}

}  // namespace lobe::validation
