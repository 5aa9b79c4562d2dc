#include "lobe/fit/sensitivity.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "lobe/error.h"
#include "lobe/fit/parameters.h"
#include "lobe/linearity/gestures.h"
#include "lobe/region/averages.h"
#include "lobe/region/energy_density.h"
#include "lobe/solve/static_sensitivity.h"

namespace lobe {
namespace {

const double ten_percent = std::log(1.1);
constexpr double scale_step = 1e-4;  // on the scale of a parameter
constexpr double nearly_held = 0.9;  // share by which a held part is held that gives way

// Not what another one says as well, nor a modulus that may be zero or negative, nor what an equilibrium does
// not depend on.
bool is_of_its_own(const Parameter& parameter, const Scene& scene) {
  if (parameter.in_motion || parameter.scale == ParameterScale::linear) return false;
  const Material& material = scene.materials[parameter.number];
  const bool is_factor = parameter.name == material.name + ".stiffness";
  return !is_factor || material.transverse;
}

// What is asked: the displacement, and the force on what is moved.
struct Answer {
  Mat3X<double> u;
  Vec3d force = Vec3d::Zero();
  std::string trouble;
};

class Question {
 public:
  Question(const Scene& scene, const Resolved& resolved, const StaticLoad& load,
           const SparseFactorMaker& factor)
      : scene_(scene), resolved_(resolved), load_(load), factor_(factor) {
    const Elements elements(load.setup);
    mass_.resize(load.setup.mesh.vertex_count());
    for (Index v = 0; v < mass_.size(); ++v) mass_[v] = lumped_mass(elements, v);
    here_ = solve(load.setup, nullptr);
  }

  Sensitivity answer();

 private:
  Answer solve(const Setup& setup, const Mat3X<double>* start) const;
  Vec3d force_on_moved(const Mat3X<double>& reactions) const;
  double norm(const Mat3X<double>& u) const { return std::sqrt((u.colwise().squaredNorm() * mass_).value()); }
  Effect effect_of(const std::string& name, const Setup& changed) const;
  Effect effect_of(const Parameter& parameter, const StaticSensitivity& sensitivity) const;
  void add_held(std::vector<Effect>& effects) const;
  void add_models(std::vector<Effect>& effects) const;
  std::vector<double> of_tets(const StaticSensitivity& sensitivity) const;

  const Scene& scene_;
  const Resolved& resolved_;
  const StaticLoad& load_;
  const SparseFactorMaker& factor_;
  Eigen::VectorXd mass_;  // of vertices [kg]
  Answer here_;
};

Vec3d Question::force_on_moved(const Mat3X<double>& reactions) const {
  Vec3d sum = Vec3d::Zero();
  for (const Index v : load_.moved) sum += reactions.col(v);
  return sum;
}

// What the changed body does not go with is a trouble of this change alone.
Answer Question::solve(const Setup& setup, const Mat3X<double>* start) const {
  StaticOptions options;
  options.factor = factor_;
  options.start = start;
  try {
    StaticResult found = solve_static(setup, options);
    return {std::move(found.u), force_on_moved(found.reactions), found.reason};
  } catch (const InputError& error) {
    if (!start) throw;
    return {.trouble = error.what()};
  }
}

Effect Question::effect_of(const std::string& name, const Setup& changed) const {
  Effect effect{.of = name};
  const Answer there = solve(changed, &here_.u);
  effect.trouble = there.trouble;
  if (!effect.trouble.empty()) return effect;
  effect.displacement = norm(there.u - here_.u) / norm(here_.u);
  effect.largest = there.u.colwise().norm().maxCoeff() / here_.u.colwise().norm().maxCoeff() - 1;
  if (here_.force.norm() > 0) effect.force = there.force.norm() / here_.force.norm() - 1;
  return effect;
}

Effect Question::effect_of(const Parameter& parameter, const StaticSensitivity& sensitivity) const {
  const double x = parameter.on_scale(parameter.start);
  const double way = parameter.scale == ParameterScale::below_half ? -ten_percent : ten_percent;
  const auto at = [&](double value) {
    Setup setup = load_.setup;
    set(parameter, parameter.from_scale(value), setup);
    return setup;
  };
  const StaticDerivative by = sensitivity.by(at, x, scale_step);
  Effect effect{.of = parameter.name + (way < 0 ? " 10 % nearer to 1/2" : " + 10 %")};
  Eigen::Index most = 0;
  const double largest = here_.u.colwise().norm().maxCoeff(&most);
  effect.displacement = ten_percent * norm(by.u) / norm(here_.u);
  effect.largest = way * here_.u.col(most).dot(by.u.col(most)) / (largest * largest);
  if (const double force = here_.force.norm(); force > 0)
    effect.force = way * here_.force.dot(force_on_moved(by.reactions)) / (force * force);
  return effect;
}

void Question::add_held(std::vector<Effect>& effects) const {
  for (const HeldEntry& entry : resolved_.held) {
    Setup changed = load_.setup;
    std::vector<PrescribedVertex> kept;
    for (const PrescribedVertex& held : changed.prescribed) {
      const bool is_of_entry =
          std::binary_search(entry.vertices.begin(), entry.vertices.end(), held.vertex) &&
          std::find(load_.moved.begin(), load_.moved.end(), held.vertex) == load_.moved.end();
      if (is_of_entry && held.displacement == Vec3d::Zero())
        changed.partly_held.push_back({held.vertex, nearly_held, held.displacement, held.axes});
      else
        kept.push_back(held);
    }
    if (kept.size() == changed.prescribed.size()) continue;
    changed.prescribed = std::move(kept);
    effects.push_back(effect_of(entry.pointer + " held by nine tenths", changed));
  }
}

void Question::add_models(std::vector<Effect>& effects) const {
  const auto& models = load_.setup.region_of;
  const auto as = [&](RegionModel from, RegionModel to, const std::string& name) {
    if (std::find(models.begin(), models.end(), from) == models.end()) return;
    Setup changed = load_.setup;
    std::replace(changed.region_of.begin(), changed.region_of.end(), from, to);
    effects.push_back(effect_of(name, changed));
  };
  for (const RegionModel model :
       {RegionModel::tensor_mass, RegionModel::precomputed, RegionModel::corotational})
    as(model, RegionModel::nonlinear, std::string(name(model)) + " regions as non-linear");
  as(RegionModel::nonlinear, RegionModel::tensor_mass, "non-linear regions as linear");
}

// The energy of each tetrahedron [J]: its own, and its share of its smoothing domains' by volume.
std::vector<double> tet_energies(const Elements& elements, const Averages& averages, const Mat3X<double>& u) {
  const std::vector<double> pressures = tet_pressures(elements, averages.nodes, u);
  const std::vector<Mat3<double>> gradients = domain_gradients(averages.edges, u);
  const std::vector<double> of_ends = domain_pressures(averages.edges, averages.edge_pressures, gradients);
  std::vector<double> energies(std::size_t(elements.topology.tet_count()));
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    const Mat34<double> corners = u(Eigen::all, elements.topology.corners(t));
    const Shape shape = elements.shape_of(t);
    const Mat3<double> H = displacement_gradient<double>(corners, shape.gradients.rightCols<3>());
    double density = unsmoothed_energy_density(elements, t, H, elements.region_of[std::size_t(t)],
                                               pressures[std::size_t(t)]);
    for (const Index e : averages.edges.of(t))
      if (e >= 0) {
        const SmoothedEdge& edge = averages.edges[e];
        density +=
            energy_density(elements, edge, gradients[std::size_t(e)], edge.model, of_ends[std::size_t(e)]) /
            6;
      }
    energies[std::size_t(t)] = shape.volume * density;
  }
  return energies;
}

// The answer's derivative by the moduli of one tetrahedron is that of its energy along one field: the
// response of the body to the answer's own gradient.
std::vector<double> Question::of_tets(const StaticSensitivity& sensitivity) const {
  const Setup& setup = load_.setup;
  Mat3X<double> field = Mat3X<double>::Zero(3, here_.u.cols());
  double scale = 1;
  if (const double force = here_.force.norm(); force > 0) {
    for (const Index v : load_.moved) field.col(v) = here_.force / force;
    field = sensitivity.response_to_move(field);
    scale = 1 / force;
  } else {
    const double size = norm(here_.u);
    field = sensitivity.response(here_.u * mass_.asDiagonal() / (size * size));
    scale = -1;
  }
  const Elements elements(setup);
  const Averages averages(elements);
  const double step = 1e-4 * here_.u.colwise().norm().maxCoeff() / field.colwise().norm().maxCoeff();
  const std::vector<double> more = tet_energies(elements, averages, here_.u + step * field),
                            less = tet_energies(elements, averages, here_.u - step * field);
  double volume = 0;
  for (Index t = 0; t < elements.topology.tet_count(); ++t) volume += elements.volume(t);
  std::vector<double> found(more.size());
  for (std::size_t t = 0; t < found.size(); ++t)
    found[t] = scale * (more[t] - less[t]) / (2 * step) * volume / elements.volume(Index(t));
  return found;
}

Sensitivity Question::answer() {
  Sensitivity found{.gesture = load_.name, .trouble = here_.trouble};
  if (!found.trouble.empty()) return found;
  found.largest = here_.u.colwise().norm().maxCoeff();
  found.force = here_.force.norm();
  if (!(found.largest > 0)) {
    found.trouble = "nothing moves";
    return found;
  }
  const StaticSensitivity sensitivity(load_.setup, here_.u, factor_);
  for (const Parameter& parameter : all_parameters(scene_))
    if (is_of_its_own(parameter, scene_)) found.effects.push_back(effect_of(parameter, sensitivity));
  add_held(found.effects);
  add_models(found.effects);
  found.of_tets = of_tets(sensitivity);
  const auto size = [&](const Effect& e) { return found.force > 0 ? std::abs(e.force) : e.displacement; };
  std::stable_sort(found.effects.begin(), found.effects.end(),
                   [&](const Effect& a, const Effect& b) { return size(a) > size(b); });
  return found;
}

}  // namespace

std::vector<Sensitivity> sensitivities(const Scene& scene, const Resolved& resolved,
                                       const SensitivityOptions& options) {
  const std::vector<StaticLoad> loads = static_loads(resolved.setup);
  std::vector<Sensitivity> found;
  for (const StaticLoad& load : loads) {
    if (options.progress) options.progress(double(found.size()) / double(loads.size()));
    try {
      found.push_back(Question(scene, resolved, load, options.factor).answer());
    } catch (const InputError& error) {  // of this load: its equilibrium is not stable
      if (found.empty()) throw;
      found.push_back({.gesture = load.name, .trouble = error.what()});
    }
  }
  return found;
}

std::string sensitivity_table(const std::vector<Sensitivity>& found) {
  std::string text;
  char line[256];
  for (const Sensitivity& one : found) {
    text += one.gesture;
    if (!one.trouble.empty()) {
      text += ": " + one.trouble + '\n';
      continue;
    }
    std::snprintf(line, sizeof line, ": largest displacement %.4g mm", 1e3 * one.largest);
    text += line;
    if (one.force > 0) {
      std::snprintf(line, sizeof line, ", force %.4g N", one.force);
      text += line;
    }
    std::snprintf(line, sizeof line, "\n  %-44s %12s %12s %12s\n", "change", "displacement", "largest",
                  "force");
    text += line;
    for (const Effect& effect : one.effects) {
      if (!effect.trouble.empty()) {
        text += "  " + effect.of + ": " + effect.trouble + '\n';
        continue;
      }
      std::snprintf(line, sizeof line, "  %-44s %10.2f %% %+10.2f %%", effect.of.c_str(),
                    100 * effect.displacement, 100 * effect.largest);
      text += line;
      if (one.force > 0) {
        std::snprintf(line, sizeof line, " %+10.2f %%", 100 * effect.force);
        text += line;
      }
      text += '\n';
    }
  }
  return text;
}

}  // namespace lobe
