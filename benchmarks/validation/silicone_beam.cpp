// A real beam of silicone that bends under its weight and a load (data/measurements/README.md). Young's
// modulus is fitted to one case, the others are predicted.
#include <cmath>
#include <stdexcept>

#include "benchmarks/validation/bodies.h"
#include "benchmarks/validation/cases.h"
#include "benchmarks/validation/silicone_specimen.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/material_constants.h"
#include "lobe/solve/quadratic_solver.h"
#include "lobe/text.h"

namespace lobe::validation {
namespace {

struct BeamMesh {
  int along = 13, across = 4, up = 6;
  bool is_quadratic = true;
  ElementType element = ElementType::tetrahedron;  // if it is not
};

// Loads of a line of nodes at distances h, as its functions share a uniform one.
double share_of_node(bool is_vertex, bool is_end, int cells, bool is_quadratic) {
  if (!is_quadratic) return (is_end ? 0.5 : 1.0) / cells;
  if (!is_vertex) return 2.0 / 3 / cells;
  return (is_end ? 1.0 : 2.0) / 6 / cells;
}

class SiliconeBeam {
 public:
  explicit SiliconeBeam(const BeamMesh& size)
      : size_(size),
        mesh_(box_mesh({silicone::length, silicone::side, silicone::side}, size.along, size.across, size.up)),
        nodes_(mesh_) {}

  // Displacement of the marker [m] with a modulus [Pa] and a load on the upper edge of the free end [N].
  double marker(double modulus, double load) const {
    const LamePair lame = lame_from_young(modulus, silicone::poisson);
    Setup setup = body_of(mesh_, {lame.lambda, lame.mu, silicone::density}, RegionModel::nonlinear);
    setup.materials[0].element = size_.element;
    prescribe(setup, vertices_where(mesh_, [](const Vec3d& X) { return X.x() == 0; }),
              [](const Vec3d&) { return Vec3d::Zero(); });
    setup.gravity = {0, 0, -silicone::gravity};
    if (!size_.is_quadratic) {
      hang(load, mesh_.points, [&](Index v, double force) {
        setup.vertex_loads.push_back({v, {0, 0, force}});
      });
      return at_marker(equilibrium(setup));
    }
    StaticEquations equations = quadratic_equations(setup, nodes_);
    hang(load, nodes_.joined_linearly(mesh_.points),
         [&](Index n, double force) { equations.loads(2, n) += force; });
    const StaticResult result = solve_static_quadratic(setup, nodes_, equations);
    if (!result.converged) throw std::runtime_error("quadratic solver: " + result.reason);
    return at_marker(result.u);
  }

  // The modulus that gives the marker's displacement under the weight alone: the secant method in 1/E, of
  // which the displacement is almost a linear function.
  double fitted(double displacement) const {
    double before = 1 / 2e5, now = 1 / 2.5e5;
    double of_before = marker(1 / before, 0);
    for (int i = 0; i < 20; ++i) {
      const double of_now = marker(1 / now, 0);
      if (std::abs(of_now / displacement - 1) < 1e-9) return 1 / now;
      const double next = now + (displacement - of_now) * (now - before) / (of_now - of_before);
      before = now;
      of_before = of_now;
      now = next;
    }
    throw std::runtime_error("no modulus gives the measured displacement");
  }

 private:
  template <class Add>
  void hang(double load, const Mat3X<double>& X, const Add& add) const {
    for (Index n = 0; n < X.cols(); ++n) {
      const bool on_edge =
          std::abs(X(0, n) - silicone::length) < 1e-9 && std::abs(X(2, n) - silicone::side) < 1e-9;
      const bool is_end = X(1, n) < 1e-9 || X(1, n) > silicone::side - 1e-9;
      if (on_edge && (size_.is_quadratic || n < mesh_.vertex_count()))
        add(n, -load * share_of_node(n < mesh_.vertex_count(), is_end, size_.across, size_.is_quadratic));
    }
  }

  double at_marker(const Mat3X<double>& u) const { return silicone::at_marker(mesh_, u).norm(); }

  BeamMesh size_;
  TetMesh mesh_;
  QuadraticMesh nodes_;
};

std::map<std::string, double> measured_displacements() {  // [m]
  auto found = silicone::measured("silicone_beam.csv", "equilibrium_mm");
  for (auto& [name, displacement] : found) displacement /= 1000;
  return found;
}

constexpr const char* motion_capture = "motion capture";

// What lobe predicted for the load whose displacement was kept back, with the mesh of a full run [m]. It was
// committed before the measurement was known.
constexpr double predicted_unseen = 0.025668;

void predict(Findings& findings, const std::string& name, const SiliconeBeam& beam, double modulus,
             const Tolerance& tolerance) {
  const auto measured = measured_displacements();
  findings.value(name, "displacement, gravity_b", "m", beam.marker(modulus, 0),
                 {measured.at("gravity_b"), motion_capture}, tolerance);
  findings.value(
      name, "displacement, 0.51 N", "m", beam.marker(modulus, silicone::seen_load),
      {(measured.at("load_0.51N_a") + measured.at("load_0.51N_b")) / 2, "motion capture, two repeats"},
      tolerance);
}

}  // namespace

void silicone_beam(Findings& findings, bool quick) {
  const SiliconeBeam best(quick ? BeamMesh{7, 2, 3} : BeamMesh{});
  const double modulus = best.fitted(measured_displacements().at("gravity_a"));
  findings.value("quadratic tetrahedra, fitted to gravity_a", "Young's modulus", "Pa", modulus,
                 {263824, "the source's own fit to all cases, at ν = 0.499"},
                 {0.06, "fits of other cases and another ν"});
  const std::string name = "quadratic tetrahedra, predicted";
  predict(findings, name, best, modulus,
          {0.06, "asked; repeats differ by 1.2 %, the clamp slips by 1 to 4 %"});
  findings.value(name, "displacement, 1.00062 N", "m", best.marker(modulus, silicone::unseen_load),
                 {predicted_unseen, "the prediction that was committed; no measurement"},
                 {quick ? 0.01 : 1e-4, quick ? "a coarser mesh" : "digits"});
  predict(findings, "P1, 1,248 tetrahedra, with that modulus", SiliconeBeam({13, 4, 4, false}), modulus,
          {0.45, "known limit: P1 tetrahedra are too stiff in bending"});
  const SiliconeBeam smoothed({13, 4, 4, false, ElementType::edge_smoothed});
  predict(findings, "edge-smoothed, with that modulus", smoothed, modulus,
          {0.12, "what quadratic ones are off, and the mesh"});
  predict(findings, "edge-smoothed, fitted to gravity_a", smoothed,
          smoothed.fitted(measured_displacements().at("gravity_a")),
          {0.06, "asked; repeats differ by 1.2 %, the clamp slips by 1 to 4 %"});
}

}  // namespace lobe::validation
