// Natural frequencies of free bars against theory, from eigenproblems on refined meshes and from a run in
// time.
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

// Bars lie along z: vertices are numbered layer by layer, which keeps the factor's fill within a narrow band.
constexpr double young = 3e4, density = 1000;  // [Pa], [kg/m³]; ν = 0 but for torsion
constexpr double bar_length = 1, bar_height = 0.1, bar_depth = 0.05;
constexpr double cylinder_radius = 0.1, cylinder_length = 0.6;
constexpr Elastic no_poisson{0, young / 2, density}, with_poisson{4e4, 1e4, density};
// Fibres along z: without λ and ε, E_L = 2μ + 4η + β; G_LT = μ + η.
constexpr FibreModuli<double> fibre_moduli{0, 5e3, 4e4};  // [Pa]
constexpr double young_along = young + 4 * fibre_moduli.shear + fibre_moduli.stretch;

Mat3X<double> at_vertices(const TetMesh& mesh, const Field& field) {
  Mat3X<double> u(3, mesh.vertex_count());
  for (Index v = 0; v < mesh.vertex_count(); ++v) u.col(v) = field(mesh.points.col(v));
  return u;
}

struct Bar {
  const char* name;
  Reference frequency;  // [Hz]
  Field shape;          // by theory
  std::function<Setup(int cells)> body;
  Tolerance tolerance;  // of the extrapolated frequency
};

Setup box_bar(int cells) {
  return body_of(box_mesh({bar_depth, bar_height, bar_length}, cells / 2, cells, 10 * cells), no_poisson,
                 RegionModel::tensor_mass);
}

Setup round_bar(int rings) {
  return body_of(cylinder_mesh(cylinder_radius, cylinder_length, rings, 6 * rings), with_poisson,
                 RegionModel::tensor_mass);
}

Setup with_fibres(Setup setup) {
  setup.materials[0].fibre = fibre_moduli;
  setup.mesh.fibres = Vec3d(0, 0, 1).replicate(1, setup.mesh.tet_count());
  return setup;
}

Mode theory_mode(const Bar& bar, const Setup& setup) {
  Mode mode = mode_like(setup, at_vertices(setup.mesh, bar.shape));
  if (mode.overlap < 0.95) throw std::runtime_error(std::string(bar.name) + ": another mode was found");
  return mode;
}

// The first symmetric bending mode of a free Timoshenko beam: w = A cosh pz + B cos qz with p², −q² the roots
// k² of k⁴ + (a + e) k² + a e − ρAω²/(EI) = 0, a = ρω²/(κG), e = ρω²/E, and no moment or shear force at z =
// ±L/2: (p² + a) p tan(qL/2) + (q² − a) q tanh(pL/2) = 0. κ = 5/6 (Cowper 1966, rectangle, ν = 0).
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

// w of Euler-Bernoulli, ~ cosh βz / cosh(βL/2) + cos βz / cos(βL/2), and plane sections −(y − y₀) w'.
Vec3d bending_shape(const Vec3d& X) {
  const double beta = free_root / bar_length, z = X.z() - bar_length / 2, end = beta * bar_length / 2;
  const double w = std::cosh(beta * z) / std::cosh(end) + std::cos(beta * z) / std::cos(end);
  const double slope = beta * (std::sinh(beta * z) / std::cosh(end) - std::sin(beta * z) / std::cos(end));
  return {0, w, -(X.y() - bar_height / 2) * slope};
}

std::vector<Bar> bars() {
  using std::numbers::pi;
  const auto longitudinal = [](int n) {
    return [n](const Vec3d& X) { return Vec3d(0, 0, std::cos(n * pi * X.z() / bar_length)); };
  };
  const auto torsion = [](const Vec3d& X) {
    return Vec3d(std::cos(pi * X.z() / cylinder_length) * Vec3d(-X.y(), X.x(), 0));
  };
  const double c = std::sqrt(young / density), shear = std::sqrt(with_poisson.mu / density);
  const char *mesh = "extrapolation", *beam = "extrapolation, beam theory";
  std::vector<Bar> list;
  list.push_back({"longitudinal, n = 1",
                  {c / (2 * bar_length), "n/(2L) √(E/ρ)"},
                  longitudinal(1),
                  box_bar,
                  {1e-3, mesh}});
  list.push_back(
      {"longitudinal, n = 2", {c / bar_length, "n/(2L) √(E/ρ)"}, longitudinal(2), box_bar, {1e-3, mesh}});
  list.push_back(
      {"torsion, n = 1", {shear / (2 * cylinder_length), "n/(2L) √(μ/ρ)"}, torsion, round_bar, {5e-3, mesh}});
  list.push_back({"longitudinal, fibres along",
                  {std::sqrt(young_along / density) / (2 * bar_length), "n/(2L) √(E_L/ρ)"},
                  longitudinal(1),
                  [](int cells) { return with_fibres(box_bar(cells)); },
                  {1e-3, mesh}});
  list.push_back({"torsion, fibres along",
                  {std::sqrt((with_poisson.mu + fibre_moduli.shear) / density) / (2 * cylinder_length),
                   "n/(2L) √(G_LT/ρ)"},
                  torsion,
                  [](int rings) { return with_fibres(round_bar(rings)); },
                  {5e-3, mesh}});
  list.push_back({"bending, n = 1",
                  {timoshenko() / (2 * pi), "Timoshenko beam, κ = 5/6"},
                  bending_shape,
                  box_bar,
                  {5e-3, beam}});
  return list;
}

// ω² is what has an error of h² (a Rayleigh quotient), and what is extrapolated.
void study(Findings& findings, const Bar& bar) {
  std::vector<double> sizes, errors, squares;
  const double exact = 2 * std::numbers::pi * bar.frequency.value;
  for (int n : {2, 4, 8}) {
    const double omega = theory_mode(bar, bar.body(n)).omega;
    squares.push_back(omega * omega);
    sizes.push_back(1.0 / n);
    errors.push_back(std::abs(squares.back() / (exact * exact) - 1));
  }
  const std::string name = bar.name;
  findings.study(name + ", ω²", sizes, errors);
  findings.order(name, "ω²", observed_order(sizes, errors), 2, {0.2, "h⁴ terms of coarse meshes"});
  findings.value(name, "frequency, extrapolated", "Hz",
                 std::sqrt(romberg(squares[0], squares[1], squares[2])) / (2 * std::numbers::pi),
                 bar.frequency, bar.tolerance);
}

// Frequency of a linear run [rad/s] that starts as a mode at its largest displacement: 20 periods between
// zero crossings of the mode's share in u.
double run_frequency(const Setup& setup, const Mode& mode, double dt) {
  World<double> world(setup);
  State<double> state = world.state();
  state.u = 1e-3 * mode.shape;
  world.set_state(state);
  const auto share = [&] { return state.u.cwiseProduct(world.state().u).sum(); };
  double before = share(), first = -1;
  for (int crossings = 0; world.time() < 25 * 2 * std::numbers::pi / mode.omega;) {
    world.step(dt);
    const double now = share();
    if (before > 0 && now <= 0) {
      const double time = world.time() - dt * now / (now - before);
      if (first < 0) first = time;
      if (crossings++ == 20) return 2 * std::numbers::pi * 20 / (time - first);
    }
    before = now;
  }
  throw std::runtime_error("the run of the longitudinal mode does not oscillate");
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

void natural_frequencies(Findings& findings, bool) {
  for (const Bar& bar : bars()) study(findings, bar);
  compare_run(findings);
}

}  // namespace lobe::validation
