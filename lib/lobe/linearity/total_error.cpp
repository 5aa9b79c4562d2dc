#include "lobe/linearity/total_error.h"

#include <algorithm>
#include <cstdio>

#include "lobe/diagnostics/compare.h"
#include "lobe/error.h"
#include "lobe/linearity/gestures.h"
#include "lobe/numerics/supernodal_factor.h"
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

std::vector<char> chosen_of(const std::vector<Index>& nodes, Index count) {
  std::vector<char> chosen(std::size_t(count), 0);
  for (const Index node : nodes) chosen[std::size_t(node)] = 1;
  return chosen;
}

// The nodes that move with these vertices: they, and the middles of edges between them.
std::vector<char> nodes_of(const std::vector<Index>& vertices, const QuadraticMesh& mesh) {
  std::vector<char> chosen = chosen_of(vertices, mesh.node_count());
  for (std::size_t i = 0; i < mesh.ends.size(); ++i)
    chosen[std::size_t(mesh.vertices) + i] =
        chosen[std::size_t(mesh.ends[i][0])] && chosen[std::size_t(mesh.ends[i][1])];
  return chosen;
}

double excess(double found, double truth) { return truth > 0 ? found / truth - 1 : 0; }

// A solution at the nodes.
struct Solved {
  Mat3X<double> u;   // [m]
  double force = 0;  // on what the gesture moves [N]
  double largest() const { return u.colwise().norm().maxCoeff(); }
};

class Comparison {
 public:
  Comparison(const Setup& setup, const TotalErrorOptions& options)
      : factor_(options.factor ? options.factor : make_supernodal),
        judges_held_(bool(options.on_refined)),
        mesh_(setup.mesh),
        refined_(refine(setup.mesh)) {
    for (const Index parent : refined_.parent_of)
      density_.push_back(setup.materials[setup.material_of[std::size_t(parent)]].density);
    if (!options.on_refined) return;
    try {
      selected_again_ = static_loads(options.on_refined(refined_));
    } catch (const InputError& error) {
      held_trouble_ = error.what();
    }
  }

  TotalError of(const StaticLoad& load) const {
    TotalError error;
    error.name = load.name;
    Setup plain = load.setup;
    if (plain.precomputed_frame == RegionFrame::corotated) make_nonlinear(plain);
    StaticOptions solver;
    solver.factor = factor_;
    const StaticResult on_mesh = solve_static(plain, solver);
    error.trouble = on_mesh.reason;
    if (!on_mesh.converged) return error;
    make_nonlinear(plain);
    const Mat3X<double> start = mesh_.joined_linearly(on_mesh.u);
    solver.start = &start;
    const StaticEquations equations = quadratic_equations(plain, mesh_);
    const StaticResult on_nodes = solve_static_quadratic(plain, mesh_, equations, solver);
    error.trouble = on_nodes.reason;
    if (!on_nodes.converged) return error;
    const std::vector<char> moved = nodes_of(load.moved, mesh_);
    const std::vector<char> at_vertices(moved.begin(), moved.begin() + mesh_.vertices);
    const Solved found{refined_.prolongate(on_mesh.u), sum_at(on_mesh.reactions, at_vertices).norm()},
        truth{on_nodes.u, sum_at(on_nodes.reactions, moved).norm()};
    error.largest = found.largest();
    error.force = found.force;
    error.element = share(found, truth);
    if (judges_held_) judge_held(plain, found, truth, error);
    return error;
  }

 private:
  ErrorShare share(const Solved& found, const Solved& truth) const {
    return {compare_displacements(refined_.mesh, found.u, truth.u, density_).l2,
            excess(found.largest(), truth.largest()), excess(found.force, truth.force)};
  }

  void judge_held(const Setup& setup, const Solved& found, const Solved& truth, TotalError& error) const {
    error.held_trouble = held_trouble_;
    const auto again = std::find_if(selected_again_.begin(), selected_again_.end(),
                                    [&](const StaticLoad& load) { return load.name == error.name; });
    if (again == selected_again_.end()) return;
    StaticOptions solver;
    solver.factor = factor_;
    solver.start = &truth.u;
    try {
      const StaticEquations equations = quadratic_equations(setup, mesh_, again->setup.prescribed);
      const StaticResult result = solve_static_quadratic(setup, mesh_, equations, solver);
      error.held_trouble = result.reason;
      if (!result.converged) return;
      const std::vector<char> moved = chosen_of(again->moved, mesh_.node_count());
      const Solved selected{result.u, sum_at(result.reactions, moved).norm()};
      error.held = share(truth, selected);
      error.total = share(found, selected);
    } catch (const InputError& trouble) {
      error.held_trouble = trouble.what();
    }
  }

  SparseFactorMaker factor_;
  bool judges_held_;
  QuadraticMesh mesh_;
  RefinedMesh refined_;
  std::vector<double> density_;  // of the refined mesh [kg/m³]
  std::vector<StaticLoad> selected_again_;
  std::string held_trouble_;
};

std::string share_line(const char* what, const ErrorShare& share, bool has_force) {
  char line[160];
  std::snprintf(line, sizeof line, "    %-26s  %6.2f %% off  %+18.2f %%", what, 100 * share.l2,
                100 * share.largest);
  std::string text = line;
  if (has_force) {
    std::snprintf(line, sizeof line, "  %+16.2f %%", 100 * share.force);
    text += line;
  }
  return text + '\n';
}

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
      "total error of this mesh, against 10-node tetrahedra:\n"
      "  gesture                       displacement    largest               force\n";
  for (const TotalError& error : errors) {
    char line[256];
    if (!error.trouble.empty()) {
      std::snprintf(line, sizeof line, "  %-28s  ", error.name.c_str());
      text += line + error.trouble + '\n';
      continue;
    }
    const bool has_force = error.force > 0;
    std::snprintf(line, sizeof line, "  %-42s  %15.4g mm", error.name.c_str(), 1e3 * error.largest);
    text += line;
    if (has_force) {
      std::snprintf(line, sizeof line, "  %14.4g N", error.force);
      text += line;
    }
    text += '\n' + share_line("element, regions", error.element, has_force);
    if (error.held) text += share_line("what is held", *error.held, has_force);
    if (error.total) text += share_line("both", *error.total, has_force);
    if (!error.held_trouble.empty()) text += "    what is held: " + error.held_trouble + '\n';
  }
  return text;
}

}  // namespace lobe
