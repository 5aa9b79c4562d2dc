// Natural frequencies of free bars against theory, from eigenproblems on refined meshes and from a run in time.
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "benchmarks/validation/bodies.h"
#include "benchmarks/validation/cases.h"
#include "benchmarks/validation/modes.h"
#include "lobe/mesh/generators.h"
#include "lobe/sim/world.h"

namespace lobe::validation {
namespace {

constexpr double young = 3e4, density = 1000;  // [Pa], [kg/m³]; ν = 0 but for torsion
constexpr double bar_length = 1, bar_height = 0.1, bar_depth = 0.05;
constexpr double cylinder_radius = 0.1, cylinder_length = 0.8;
constexpr Elastic no_poisson{0, young / 2, density}, with_poisson{4e4, 1e4, density};

Mat3X<double> at_vertices(const TetMesh& mesh, const Field& field) {
  Mat3X<double> u(3, mesh.vertex_count());
  for (Index v = 0; v < mesh.vertex_count(); ++v) u.col(v) = field(mesh.points.col(v));
  return u;
}

struct Bar {
  const char* name;
  double theory = 0;  // [rad/s]
  Reference reference;
  Field shape;  // by theory
  std::function<Setup(int cells)> body;
  int coarsest = 1;      // cells across
  double tolerance = 0;  // of the extrapolated frequency
  const char* basis = "";
};

Setup box_bar(int cells) {
  return body_of(box_mesh({bar_length, bar_height, bar_depth}, 10 * cells, cells, (cells + 1) / 2),
                 no_poisson, RegionModel::tensor_mass);
}

Setup round_bar(int rings) {
  return body_of(cylinder_mesh(cylinder_radius, cylinder_length, rings, 4 * rings), with_poisson,
                 RegionModel::tensor_mass);
}

Mode theory_mode(const Bar& bar, const Setup& setup) {
  Mode mode = mode_like(setup, at_vertices(setup.mesh, bar.shape));
  if (mode.overlap < 0.95) throw std::runtime_error(std::string(bar.name) + ": another mode was found");
  return mode;
}

// The first symmetric bending mode of a free Timoshenko beam: w = A cosh px + B cos qx with p², −q² the roots k² of
// k⁴ + (a + e) k² + a e − ρAω²/(EI) = 0, a = ρω²/(κG), e = ρω²/E, and no moment or shear force at x = ±L/2:
// (p² + a) p tan(qL/2) + (q² − a) q tanh(pL/2) = 0. κ = 5/6 (Cowper 1966, rectangle, ν = 0).
double timoshenko_condition(double omega) {
  const double kappa = 5.0 / 6, shear = young / 2, L = bar_length;
  const double a = density * omega * omega / (kappa * shear), e = density * omega * omega / young;
  const double bending = 12 * density * omega * omega / (young * bar_height * bar_height);  // ρAω²/(EI)
  const double root = std::sqrt((a + e) * (a + e) / 4 - a * e + bending);
  const double p = std::sqrt(root - (a + e) / 2), q = std::sqrt(root + (a + e) / 2);
  return (p * p + a) * p * std::sin(q * L / 2) + (q * q - a) * q * std::tanh(p * L / 2) * std::cos(q * L / 2);
}

constexpr double free_root = 4.730040744862704;  // β L of the first free-free mode, cosh βL cos βL = 1

double euler_bernoulli() {
  const double beta = free_root / bar_length;
  return beta * beta * bar_height * std::sqrt(young / (12 * density));
}

double timoshenko() {
  double low = 0.8 * euler_bernoulli(), high = euler_bernoulli();
  const double sign = timoshenko_condition(low);
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (timoshenko_condition(middle) * sign > 0 ? low : high) = middle;
  }
  return low;
}

// w of Euler-Bernoulli, ~ cosh βx / cosh(βL/2) + cos βx / cos(βL/2), and plane sections −(y − y₀) w'.
Vec3d bending_shape(const Vec3d& X) {
  const double beta = free_root / bar_length, x = X.x() - bar_length / 2, end = beta * bar_length / 2;
  const double w = std::cosh(beta * x) / std::cosh(end) + std::cos(beta * x) / std::cos(end);
  const double slope = beta * (std::sinh(beta * x) / std::cosh(end) - std::sin(beta * x) / std::cos(end));
  return {-(X.y() - bar_height / 2) * slope, w, 0};
}

std::vector<Bar> bars() {
  using std::numbers::pi;
  const auto longitudinal = [](int n) {
    return [n](const Vec3d& X) { return Vec3d(std::cos(n * pi * X.x() / bar_length), 0, 0); };
  };
  const auto torsion = [](const Vec3d& X) {
    return Vec3d(std::cos(pi * X.z() / cylinder_length) * Vec3d(-X.y(), X.x(), 0));
  };
  const double c = std::sqrt(young / density), shear = std::sqrt(with_poisson.mu / density);
  const char* mesh = "extrapolation of order 2";
  return {{"longitudinal, n = 1",
           pi * c / bar_length,
           {c / (2 * bar_length), "n/(2L) √(E/ρ)"},
           longitudinal(1),
           box_bar,
           1,
           1e-3,
           mesh},
          {"longitudinal, n = 2",
           2 * pi * c / bar_length,
           {c / bar_length, "n/(2L) √(E/ρ)"},
           longitudinal(2),
           box_bar,
           1,
           1e-3,
           mesh},
          {"torsion, n = 1",
           pi * shear / cylinder_length,
           {shear / (2 * cylinder_length), "n/(2L) √(μ/ρ)"},
           torsion,
           round_bar,
           2,
           5e-3,
           mesh},
          {"bending",
           timoshenko(),
           {timoshenko() / (2 * pi), "Timoshenko beam, κ = 5/6"},
           bending_shape,
           box_bar,
           1,
           5e-3,
           "extrapolation of order 2, beam theory"}};
}

void study(Findings& findings, const Bar& bar, int finer) {
  std::vector<double> sizes, errors, frequencies;
  for (int n : {finer * bar.coarsest, 2 * finer * bar.coarsest, 4 * finer * bar.coarsest}) {
    frequencies.push_back(theory_mode(bar, bar.body(n)).omega / (2 * std::numbers::pi));
    sizes.push_back(1.0 / n);
    errors.push_back(std::abs(frequencies.back() / bar.reference.value - 1));
  }
  const std::string name = bar.name;
  findings.study(name, sizes, errors);
  const Extrapolation e = extrapolate_order(frequencies[1], frequencies[2], 2);
  findings.order(name, "frequency", observed_order(sizes, errors), 2,
                 {0.1, "meshes are not yet in the limit"});
  findings.value(name, "frequency, extrapolated", "Hz", e.limit, bar.reference, {bar.tolerance, bar.basis});
}

// Frequency of a linear run [rad/s] that starts as a mode at its largest displacement: 20 periods between zero
// crossings of the mode's share in u.
double run_frequency(const Setup& setup, const Mode& mode, double dt) {
  World<double> world(setup);
  State<double> state = world.state();
  state.u = 1e-3 * mode.shape;
  state.v = mode.omega * std::sin(mode.omega * dt / 2) * state.u;  // at −Δt/2
  world.set_state(state);
  const auto share = [&] { return state.u.cwiseProduct(world.state().u).sum(); };
  double before = share(), first = -1;
  for (int crossings = 0;;) {
    world.step(dt);
    const double now = share();
    if (before > 0 && now <= 0) {
      const double time = world.time() - dt * now / (now - before);
      if (first < 0) first = time;
      if (crossings++ == 20) return 2 * std::numbers::pi * 20 / (time - first);
    }
    before = now;
  }
}

void compare_run(Findings& findings) {
  const Bar bar = bars().front();
  const Setup setup = bar.body(2);
  const Mode mode = theory_mode(bar, setup);
  const double dt = 0.5 * World<double>(setup).time_step_limit();
  const double expected = 2 / dt * std::asin(mode.omega * dt / 2);  // of central differences
  findings.value(bar.name, "frequency of an explicit run", "Hz",
                 run_frequency(setup, mode, dt) / (2 * std::numbers::pi),
                 {expected / (2 * std::numbers::pi), "eigenproblem, 2/Δt asin(ωΔt/2)"},
                 {1e-6, "interpolation of zero crossings"});
}

}  // namespace

void natural_frequencies(Findings& findings, bool quick) {
  for (const Bar& bar : bars()) study(findings, bar, quick ? 1 : 2);
  compare_run(findings);
}

}  // namespace lobe::validation
