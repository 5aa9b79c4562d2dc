// The elastic benchmarks CSM1 … CSM3 of Turek and Hron (2006): a beam in plane strain on a cylinder, bent by
// gravity. A slab one cell thick, u_z = 0 at every vertex.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "benchmarks/validation/bodies.h"
#include "benchmarks/validation/cases.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/material_constants.h"
#include "lobe/sim/world.h"

namespace lobe::validation {
namespace {

constexpr double height = 0.02, right_end = 0.6;    // of the beam [m]
constexpr double centre = 0.2, disc_radius = 0.05;  // of the cylinder, (0.2, 0.2) [m]
constexpr double poisson = 0.4, beam_density = 1000, gravity = 2;

struct Slab {
  Setup setup;
  Index tip = 0;  // the point A = (0.6, 0.2)
};

// `cells` through the height, an even number; cells are twice as long as high. Their left ends lie on the
// arc.
Slab slab(double young, int cells) {
  const double cell = height / cells;
  const int along = int(std::lround((right_end - centre - disc_radius) / (2 * cell)));
  TetMesh mesh = box_mesh({1, height, cell}, along, cells, 1);
  Slab result;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    auto X = mesh.points.col(v);
    const double up = X.y() - height / 2;
    const double left = centre + std::sqrt(disc_radius * disc_radius - up * up);
    X.x() = left + X.x() * (right_end - left);
    X.y() = centre + up;
    if (v % (along + 1) == along && std::abs(up) < 1e-9 && X.z() == 0) result.tip = v;
  }
  const LamePair lame = lame_from_young(young, poisson);
  result.setup = body_of(std::move(mesh), {lame.lambda, lame.mu, beam_density}, RegionModel::nonlinear);
  result.setup.gravity = {0, -gravity, 0};
  for (Index v = 0; v < result.setup.mesh.vertex_count(); ++v) {
    const bool clamped = v % (along + 1) == 0;
    result.setup.prescribed.push_back({v, Vec3d::Zero(), {clamped, clamped, true}});
  }
  return result;
}

struct Published {
  const char* name;
  double young;  // [Pa]
  double u[2];   // of A [m]
};

constexpr Published csm1{"CSM1", 1.4e6, {-7.18767e-3, -66.1023e-3}};
constexpr Published csm2{"CSM2", 5.6e6, {-0.469000e-3, -16.9739e-3}};
constexpr const char* component[] = {"u_x(A)", "u_y(A)"};

void static_case(Findings& findings, const Published& published, const std::vector<int>& cells) {
  std::vector<Vec3d> tips;
  std::vector<double> sizes;
  for (int n : cells) {
    const Slab s = slab(published.young, n);
    tips.push_back(equilibrium(s.setup).col(s.tip));
    sizes.push_back(1.0 / n);
  }
  for (int i : {0, 1}) {
    std::vector<double> errors;
    for (const Vec3d& tip : tips) errors.push_back(std::abs(tip[i] / published.u[i] - 1));
    findings.study(std::string(published.name) + ", " + component[i], sizes, errors);
    const double limit = romberg(tips[0][i], tips[1][i], tips[2][i]);
    const Reference reference{published.u[i], "featflow, level 5+1"};
    findings.order(published.name, component[i], observed_order(sizes, errors), 2,
                   {0.2, "h⁴ terms of coarse meshes"});
    findings.value(published.name, std::string(component[i]) + ", extrapolated", "m", limit, reference,
                   {0.01, "extrapolation"});
    findings.value(std::string(published.name) + ", " + std::to_string(cells[2]) + " cells high",
                   component[i], "m", tips[2][i], reference,
                   {std::abs(tips[2][i] / limit - 1) + 0.01, "mesh error by extrapolation + 1 %"});
  }
}

// From rest under gravity at once, undamped: (max ± min)/2 over three periods, and their number per second.
struct Oscillation {
  double mean[2] = {}, amplitude[2] = {};  // of u_x, u_y of A [m]
  double frequency = 0;                    // [Hz]
  Vec3d rest = Vec3d::Zero();              // u of A in equilibrium on the same mesh [m]
};

constexpr int periods = 3;      // between upward crossings of the static deflection
constexpr double longest = 10;  // [s]

Oscillation oscillation(int cells) {
  const Slab s = slab(csm1.young, cells);
  Oscillation result;
  result.rest = equilibrium(s.setup).col(s.tip);
  const double middle = result.rest.y();
  World<double> world(s.setup);
  const double dt = 0.8 * world.time_step_limit();
  Vec3d low = Vec3d::Zero(), high = low;
  double before = 0, first = 0, last = 0;
  for (int crossings = 0; crossings <= periods;) {
    if (!(world.time() < longest)) throw std::runtime_error("CSM3 does not oscillate");
    world.step(dt);
    const Vec3d now = world.state().u.col(s.tip);
    low = low.cwiseMin(now);
    high = high.cwiseMax(now);
    if (before < middle && now.y() >= middle) {
      last = world.time() - dt * (now.y() - middle) / (now.y() - before);
      if (crossings++ == 0) first = last;
    }
    before = now.y();
  }
  for (int i : {0, 1}) {
    result.mean[i] = (high[i] + low[i]) / 2;
    result.amplitude[i] = (high[i] - low[i]) / 2;
  }
  result.frequency = periods / (last - first);
  return result;
}

struct Wanted {
  std::string quantity;
  const char* unit;
  double published;
  double scatter;  // of published values
  std::function<double(const Oscillation&)> of;
  std::function<double(const Oscillation&)> mesh_error;
};

// Two published solutions differ by 1.0 % (mean of u_y), 0.9 % (amplitude), 0.5 % (u_x) and 0.4 %
// (frequency): higher modes are excited, and extrema depend on their phase. How much a mesh is too stiff is
// known from CSM1.
std::vector<Wanted> wanted() {
  const double mean[] = {-14.384e-3, -64.271e-3}, amplitude[] = {14.389e-3, 64.595e-3};
  std::vector<Wanted> list;
  for (int i : {0, 1}) {
    const auto error = [i](const Oscillation& o) { return std::abs(o.rest[i] / csm1.u[i] - 1); };
    const std::string u = component[i];
    list.push_back(
        {"mean of " + u, "m", mean[i], 0.01, [i](const Oscillation& o) { return o.mean[i]; }, error});
    list.push_back({"amplitude of " + u, "m", amplitude[i], 0.01,
                    [i](const Oscillation& o) { return o.amplitude[i]; }, error});
  }
  list.push_back({"frequency", "Hz", 1.0956, 0.004, [](const Oscillation& o) { return o.frequency; },
                  [](const Oscillation& o) { return 1 - std::sqrt(o.rest.y() / csm1.u[1]); }});
  return list;
}

void dynamic_case(Findings& findings, const std::vector<int>& cells) {
  std::vector<Oscillation> runs;
  for (int n : cells) runs.push_back(oscillation(n));
  for (const Wanted& w : wanted()) {
    const Reference reference{w.published, "featflow, level 2+0"};
    findings.value(
        "CSM3, " + std::to_string(cells.back()) + " cells high", w.quantity, w.unit, w.of(runs.back()),
        reference,
        {w.scatter + 1.25 * w.mesh_error(runs.back()), "1¼ error of CSM1 on this mesh + published scatter"});
    if (runs.size() == 3)
      findings.value("CSM3", w.quantity + ", extrapolated", w.unit,
                     romberg(w.of(runs[0]), w.of(runs[1]), w.of(runs[2])), reference,
                     {w.scatter + 0.01, "extrapolation 1 % + published scatter"});
  }
}

}  // namespace

void turek_hron(Findings& findings, bool quick) {
  const std::vector<int> cells{8, 16, 32};
  static_case(findings, csm1, cells);
  static_case(findings, csm2, cells);
  dynamic_case(findings, quick ? std::vector{8} : std::vector{4, 8, 16});
}

}  // namespace lobe::validation
