#include "lobe/linearity/total_error.h"

#include <algorithm>
#include <cstdio>

#include "lobe/diagnostics/compare.h"
#include "lobe/linearity/gestures.h"
#include "lobe/mesh/refine.h"
#include "lobe/solve/quadratic_solver.h"

namespace lobe {
namespace {

void make_nonlinear(Setup& setup) {
  std::fill(setup.region_of.begin(), setup.region_of.end(), RegionModel::nonlinear);
  setup.precomputed_frame = RegionFrame::fixed;
}

Vec3d sum_at(const Mat3X<double>& reactions, const std::vector<char>& chosen) {
  Vec3d sum = Vec3d::Zero();
  for (std::size_t n = 0; n < chosen.size(); ++n)
    if (chosen[n]) sum += reactions.col(Eigen::Index(n));
  return sum;
}

// The nodes that move with these vertices: they, and the middles of edges between them.
std::vector<char> nodes_of(const std::vector<Index>& vertices, const QuadraticMesh& mesh) {
  std::vector<char> chosen(std::size_t(mesh.node_count()), 0);
  for (const Index v : vertices) chosen[std::size_t(v)] = 1;
  for (std::size_t i = 0; i < mesh.ends.size(); ++i)
    chosen[std::size_t(mesh.vertices) + i] =
        chosen[std::size_t(mesh.ends[i][0])] && chosen[std::size_t(mesh.ends[i][1])];
  return chosen;
}

double excess(double found, double truth) { return truth > 0 ? found / truth - 1 : 0; }

class Comparison {
 public:
  Comparison(const Setup& setup, const TotalErrorOptions& options)
      : options_(options), mesh_(setup.mesh), refined_(refine(setup.mesh)) {
    for (const Index parent : refined_.parent_of)
      density_.push_back(setup.materials[setup.material_of[std::size_t(parent)]].density);
  }

  TotalError of(const StaticLoad& load) const {
    TotalError error;
    error.name = load.name;
    StaticOptions solver;
    solver.factor = options_.factor;
    Setup plain = load.setup;
    if (plain.precomputed_frame == RegionFrame::corotated) make_nonlinear(plain);
    const StaticResult found = solve_static(plain, solver);
    make_nonlinear(plain);
    const StaticResult truth = solve_static_quadratic(plain, solver);
    for (const StaticResult* one : {&found, &truth})
      if (!one->converged) error.trouble = one->reason;
    if (error.trouble.empty()) compare(load, found, truth, error);
    return error;
  }

 private:
  void compare(const StaticLoad& load, const StaticResult& found, const StaticResult& truth,
               TotalError& error) const {
    const std::vector<char> at_nodes = nodes_of(load.moved, mesh_);
    const std::vector<char> at_vertices(at_nodes.begin(), at_nodes.begin() + mesh_.vertices);
    error.l2 = compare_displacements(refined_.mesh, refined_.prolongate(found.u), truth.u, density_).l2;
    error.largest = found.u.colwise().norm().maxCoeff();
    error.of_largest = excess(error.largest, truth.u.colwise().norm().maxCoeff());
    error.force = sum_at(found.reactions, at_vertices).norm();
    error.of_force = excess(error.force, sum_at(truth.reactions, at_nodes).norm());
  }

  const TotalErrorOptions& options_;
  QuadraticMesh mesh_;
  RefinedMesh refined_;
  std::vector<double> density_;  // of the refined mesh [kg/m³]
};

}  // namespace

std::vector<TotalError> total_errors(const Setup& setup, const TotalErrorOptions& options) {
  const std::vector<StaticLoad> loads = static_loads(setup);
  const Comparison comparison(setup, options);
  std::vector<TotalError> errors;
  for (const StaticLoad& load : loads) {
    if (options.progress) options.progress(double(errors.size()) / double(loads.size()));
    errors.push_back(comparison.of(load));
  }
  return errors;
}

std::string total_error_table(const std::vector<TotalError>& errors) {
  std::string text =
      "total error of this mesh, against 10-node tetrahedra with the same body held:\n"
      "  gesture                       displacement    largest              force\n";
  for (const TotalError& error : errors) {
    char line[256];
    if (!error.trouble.empty()) {
      std::snprintf(line, sizeof line, "  %-28s  ", error.name.c_str());
      text += line + error.trouble + '\n';
      continue;
    }
    std::snprintf(line, sizeof line, "  %-28s  %6.2f %% off  %8.4g mm %+6.2f %%", error.name.c_str(),
                  100 * error.l2, 1e3 * error.largest, 100 * error.of_largest);
    text += line;
    if (error.force > 0) {
      std::snprintf(line, sizeof line, "  %8.4g N %+6.2f %%", error.force, 100 * error.of_force);
      text += line;
    }
    text += '\n';
  }
  return text;
}

}  // namespace lobe
