// A million steps of a small free body: what must be conserved is, what is at rest stays, nothing drifts.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "benchmarks/validation/bodies.h"
#include "benchmarks/validation/cases.h"
#include "lobe/fem/svk.h"
#include "lobe/mesh/generators.h"
#include "lobe/sim/world.h"

namespace lobe::validation {
namespace {

constexpr double cell = 0.01;      // [m]
constexpr double step_part = 0.2;  // of the stability limit
constexpr double speed = 1;        // of the deformation [m/s]
constexpr double spin = 30;        // [rad/s]

Setup small_body() {
  TetMesh mesh = box_mesh(Vec3d::Constant(2 * cell), 2, 2, 2);
  mesh.points.array() -= cell;
  return body_of(jittered(std::move(mesh), cell, 0.2, 1, true), Elastic{}, RegionModel::nonlinear);
}

template <class Real>
std::string in_precision(const std::string& name) {
  return name + (sizeof(Real) == 4 ? ", single" : ", double");
}

// Errors of ε per step that add up as a random walk does.
template <class Real>
Tolerance rounding_after(int steps) {
  return {4 * std::sqrt(double(steps)) * std::numeric_limits<Real>::epsilon(), "rounding, 4 ε √steps"};
}

// Largest component of E over all tetrahedra.
template <class Real>
double largest_strain(World<Real>& world) {
  double largest = 0;
  for (Index t = 0; t < world.elements().topology.tet_count(); ++t) {
    Mat34<double> u;
    for (int c = 0; c < 4; ++c)
      u.col(c) = world.state().u.col(world.elements().topology.tets()(c, t)).template cast<double>();
    const Mat3<double> alpha = world.elements().shape_of(t).gradients.template rightCols<3>();
    largest = std::max(largest, green_strain(displacement_gradient(u, alpha)).cwiseAbs().maxCoeff());
  }
  return largest;
}

struct Momenta {
  Vec3d linear = Vec3d::Zero(), angular = Vec3d::Zero();  // about the origin [kg m/s], [kg m²/s]
  double linear_sum = 0, angular_sum = 0;                 // of the magnitudes of all vertices
};

template <class Real>
Momenta momenta(World<Real>& world) {
  Momenta sum;
  for (Index v = 0; v < world.elements().points.count(); ++v) {
    const Vec3d p = world.body().inertia.mass()[v] * world.state().v.col(v).template cast<double>();
    const Vec3d x = world.elements().points.col(v) + world.state().u.col(v).template cast<double>();
    sum.linear += p;
    sum.angular += x.cross(p);
    sum.linear_sum += p.norm();
    sum.angular_sum += x.norm() * p.norm();
  }
  return sum;
}

// Deforms and spins about the origin, without travelling.
template <class Real>
World<Real> moving_body() {
  const Setup setup = small_body();
  World<Real> world(setup);
  State<double> state{Mat3X<double>::Zero(3, setup.mesh.vertex_count()), setup.mesh.points, 0};
  for (auto v : state.v.colwise()) {
    const Vec3d X = v, wave(std::sin(300 * X.y()), std::sin(300 * X.z()), std::sin(300 * X.x()));
    v = speed * wave + spin * Vec3d::UnitZ().cross(X);
  }
  const Eigen::Map<const Eigen::VectorXd> mass(world.body().inertia.mass().data(), setup.mesh.vertex_count());
  const Vec3d mean = state.v * mass / mass.sum();
  state.v.colwise() -= mean;
  world.set_state({state.u.template cast<Real>(), state.v.template cast<Real>(), 0});
  return world;
}

// ½ Σ m v(−Δt/2)·v(+Δt/2) + W(u): what central differences keep exactly if the model is linear. Takes a step.
template <class Real>
double energy_and_step(World<Real>& world, double dt) {
  const double elastic = world.energies().elastic_nonlinear;
  const Mat3X<Real> before = world.state().v;
  world.step(dt);
  double kinetic = 0;
  for (Index v = 0; v < before.cols(); ++v)
    kinetic += world.body().inertia.mass()[v] / 2 * double(before.col(v).dot(world.state().v.col(v)));
  return kinetic + elastic;
}

template <class Real>
void conservation(Findings& findings, int steps) {
  World<Real> world = moving_body<Real>();
  const double dt = step_part * world.time_step_limit();
  const Momenta start = momenta(world);
  constexpr int samples = 1000;
  std::vector<double> energies;
  double strain = 0;
  for (int i = 0; i < samples; ++i) {
    energies.push_back(energy_and_step(world, dt));
    for (int j = 1; j < steps / samples; ++j) world.step(dt);
    strain = std::max(strain, largest_strain(world));
  }
  const Momenta end = momenta(world);
  const Tolerance random_walk = rounding_after<Real>(steps);
  const std::string name =
      in_precision<Real>("free body, strain up to " + std::to_string(strain).substr(0, 4));
  findings.value(name, "change of linear momentum, to Σ|p|", "-",
                 (end.linear - start.linear).norm() / start.linear_sum, {0, "conserved"}, random_walk);
  findings.value(name, "change of angular momentum, to Σ|x||p|", "-",
                 (end.angular - start.angular).norm() / start.angular_sum, {0, "conserved"}, random_walk);
  const auto mean = [&](int first, int last) {
    double sum = 0;
    for (int i = first; i < last; ++i) sum += energies[i];
    return sum / (last - first);
  };
  const auto [low, high] = std::minmax_element(energies.begin(), energies.end());
  const double scale = mean(0, samples);
  const double bound = step_part * step_part / 2;  // (ωΔt)²/8 at ω_max, Δt = step_part · 2/ω_max
  findings.value(name, "energy, spread over the run, relative", "-", (*high - *low) / scale, {0, "bounded"},
                 {bound, "(ω_max Δt)²/8"});
  findings.value(name, "energy, last tenth to first tenth, relative", "-",
                 mean(samples - samples / 10, samples) / mean(0, samples / 10) - 1, {0, "no drift"},
                 {bound / 10, "a tenth of the spread allowed"});
}

template <class Real>
double strain_after(World<Real>& world, const State<Real>& state, int steps) {
  world.set_state(state);
  const double dt = step_part * world.time_step_limit();
  double largest = 0;
  for (int i = 0; i < steps; ++i) {
    world.step(dt);
    if (i % (steps / 100) == 0) largest = std::max(largest, largest_strain(world));
  }
  return largest;
}

template <class Real>
void rigid_motion(Findings& findings, int steps) {
  const Setup setup = small_body();
  World<Real> world(setup);
  const State<Real> rest = world.state();
  findings.value(in_precision<Real>("at rest"), "largest strain", "-", strain_after(world, rest, steps),
                 {0, "exactly 0"}, {0, "exact"});
  State<Real> state = rest;
  state.v.colwise() = Vec3<Real>(Real(0.25), Real(-0.5), Real(0.125));
  findings.value(in_precision<Real>("moving at 0.57 m/s"), "largest strain", "-",
                 strain_after(world, state, steps), {0, "rigid motion"}, rounding_after<Real>(steps));
  state = rest;
  const Eigen::AngleAxisd turn(2 * std::numbers::pi / 3, Vec3d(1, 2, 3).normalized());
  state.u = (turn.toRotationMatrix() * setup.mesh.points - setup.mesh.points).template cast<Real>();
  findings.value(in_precision<Real>("turned by 120°"), "largest strain", "-",
                 strain_after(world, state, steps), {0, "rigid motion"}, rounding_after<Real>(steps));
}

}  // namespace

void long_runs(Findings& findings, bool) {
  const int steps = 1000000;
  conservation<double>(findings, steps);
  conservation<float>(findings, steps);
  rigid_motion<double>(findings, steps);
  rigid_motion<float>(findings, steps);
}

}  // namespace lobe::validation
