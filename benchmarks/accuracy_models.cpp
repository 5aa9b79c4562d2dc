#include "benchmarks/accuracy_models.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "lobe/error.h"
#include "lobe/fem/shape.h"
#include "lobe/setup/exclusions.h"
#include "lobe/solve/static_solver.h"

namespace lobe::bench {
namespace {

constexpr int smoothings = 2;

Setup all(Setup setup, RegionModel model) {
  std::fill(setup.region_of.begin(), setup.region_of.end(), model);
  return setup;
}

// Distance of each barycentre to the nearest vertex that the boundary conditions hold, else that a grasp
// holds.
std::vector<double> distance_to_held(const Setup& setup) {
  std::vector<Index> held;
  for (const PrescribedVertex& p : setup.prescribed) held.push_back(p.vertex);
  if (held.empty())
    for (const GraspSetup& grasp : setup.grasps)
      held.insert(held.end(), grasp.vertices.begin(), grasp.vertices.end());
  std::vector<double> distances;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    double nearest = std::numeric_limits<double>::infinity();
    for (Index v : held)
      nearest = std::min(nearest, (barycentre(setup.mesh, t) - setup.mesh.points.col(v)).norm());
    distances.push_back(nearest);
  }
  return distances;
}

Model hybrid(const char* name, Setup setup, const std::vector<double>& score, double fraction) {
  Model model{name, std::move(setup), 0};
  model.linear_fraction = make_linear(model.setup, score, fraction);
  return model;
}

double linear_fraction(const Setup& setup) {
  double linear = 0;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (setup.region_of[std::size_t(t)] != RegionModel::nonlinear)
      linear += signed_volume(tet_points(setup.mesh, t));
  return linear / total_volume(setup.mesh);
}

void add_trial_hybrids(const Setup& setup, std::vector<Model>& models, std::vector<std::string>& warnings) {
  try {
    const Mat3X<double> trial = linear_trial(setup);
    const auto strain = smoothed_norm(setup.mesh, trial, Measure::strain);
    models.push_back(hybrid("hybrid_strain_50", setup, strain, 0.5));
    models.push_back(hybrid("hybrid_strain_80", setup, strain, 0.8));
    models.push_back(
        hybrid("hybrid_gradient_50", setup, smoothed_norm(setup.mesh, trial, Measure::gradient), 0.5));
  } catch (const InputError& error) {
    warnings.push_back("no hybrid of a trial solution, because there is none: " + std::string(error.what()));
  }
}

void add_reduced(const Setup& nonlinear, std::vector<Model>& models, std::vector<std::string>& warnings) {
  try {
    refuse_excluded(option_of(RegionModel::reduced), options_of(nonlinear), "the scene");
    for (bool is_corrected : {false, true})
      models.push_back({is_corrected ? "reduced_corrected" : "reduced", all(nonlinear, RegionModel::reduced),
                        0, is_corrected});
  } catch (const InputError& error) {
    warnings.push_back("no reduced model: " + std::string(error.what()));
  }
}

void add_selective(Setup nonlinear, std::vector<Model>& models, std::vector<std::string>& warnings) {
  try {
    refuse_excluded(Option::selective_mass, options_of(nonlinear), "the scene");
    nonlinear.selective_mass = mass_degree;
    models.push_back({"selective_mass_corrected", std::move(nonlinear), 0, true});
  } catch (const InputError& error) {
    warnings.push_back("no selective masses: " + std::string(error.what()));
  }
}

}  // namespace

Setup reference_setup(Setup setup) { return all(std::move(setup), RegionModel::nonlinear); }

std::vector<Model> make_models(const Setup& setup, std::vector<std::string>& warnings) {
  std::vector<Model> models;
  models.push_back({"tensor_mass", all(setup, RegionModel::tensor_mass), 1});
  const Setup with_volume = reference_setup(setup);
  Setup svk = with_volume;
  svk.volume_penalty = 0;
  models.push_back({"svk", std::move(svk), 0});
  if (setup.volume_penalty > 0) models.push_back({"svk_volume", with_volume, 0});
  Setup averaged = with_volume;
  for (Elastic& elastic : averaged.materials) elastic.nodal_pressure = elastic.lambda > 0;
  models.push_back({"svk_nodal_pressure", std::move(averaged), 0});
  add_reduced(with_volume, models, warnings);
  add_selective(with_volume, models, warnings);
  if (const double fraction = linear_fraction(setup); fraction > 0)
    models.push_back({"hybrid_scene", setup, fraction});
  add_trial_hybrids(setup, models, warnings);
  if (setup.prescribed.empty() && setup.grasps.empty())
    warnings.push_back("no hybrid by the distance from what is held: nothing is");
  else
    models.push_back(hybrid("hybrid_held_50", setup, distance_to_held(setup), 0.5));
  return models;
}

Setup at_the_end(Setup setup) {
  std::vector<char> held(std::size_t(setup.mesh.vertex_count()), 0);
  for (const PrescribedVertex& p : setup.prescribed) held[std::size_t(p.vertex)] = 1;
  for (const GraspSetup& grasp : setup.grasps)
    for (Index v : grasp.vertices)
      if (!std::exchange(held[std::size_t(v)], 1))
        setup.prescribed.push_back({v, grasp.path.back().position});
  setup.grasps.clear();
  return setup;
}

Mat3X<double> linear_trial(const Setup& setup) {
  const StaticResult solution = solve_static(all(at_the_end(setup), RegionModel::tensor_mass));
  if (!solution.converged) throw InputError("trial solution", solution.reason);
  return solution.u;
}

std::vector<double> smoothed_norm(const TetMesh& mesh, const Mat3X<double>& u, Measure measure) {
  std::vector<double> norm(std::size_t(mesh.tet_count())), volume(norm.size());
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Shape s = shape(tet_points(mesh, t));
    Mat34<double> corners;
    for (int c = 0; c < 4; ++c) corners.col(c) = u.col(mesh.tets(c, t));
    const Mat3<double> H = displacement_gradient<double>(corners, s.gradients.rightCols<3>());
    norm[std::size_t(t)] = measure == Measure::strain ? (H + H.transpose()).norm() / 2 : H.norm();
    volume[std::size_t(t)] = s.volume;
  }
  for (int pass = 0; pass < smoothings; ++pass) {
    std::vector<double> sum(std::size_t(mesh.vertex_count())), weight(sum.size());
    for (std::size_t t = 0; t < norm.size(); ++t)
      for (Index v : mesh.tets.col(Index(t))) {
        sum[std::size_t(v)] += volume[t] * norm[t];
        weight[std::size_t(v)] += volume[t];
      }
    for (std::size_t t = 0; t < norm.size(); ++t) {
      norm[t] = 0;
      for (Index v : mesh.tets.col(Index(t))) norm[t] += sum[std::size_t(v)] / weight[std::size_t(v)] / 4;
    }
  }
  return norm;
}

double make_linear(Setup& setup, const std::vector<double>& score, double fraction) {
  std::vector<Index> order(score.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](Index s, Index t) { return score[std::size_t(s)] < score[std::size_t(t)]; });
  setup = reference_setup(std::move(setup));
  const double total = total_volume(setup.mesh);
  double linear = 0;
  for (Index t : order) {
    const double volume = signed_volume(tet_points(setup.mesh, t));
    if (linear + volume > fraction * total * (1 + 1e-12)) break;
    setup.region_of[std::size_t(t)] = RegionModel::tensor_mass;
    linear += volume;
  }
  return linear / total;
}

}  // namespace lobe::bench
