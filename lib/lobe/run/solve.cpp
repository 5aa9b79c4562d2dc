#include "lobe/run/solve.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <utility>

#include "lobe/diagnostics/fields.h"
#include "lobe/error.h"
#include "lobe/fem/refined_body.h"
#include "lobe/file/atomic_file.h"
#include "lobe/run/reactions.h"
#include "lobe/solve/quadratic_solver.h"
#include "lobe/text.h"

namespace lobe {
namespace {

// What the displacements of a solution are of: the mesh, or the nodes of its quadratic tetrahedra.
Elements elements_of(const Setup& setup, bool is_quadratic) {
  return is_quadratic ? Elements(refined_body(setup, refine(setup.mesh))) : Elements(setup);
}

nlohmann::ordered_json report_of(const Scene& scene, const StaticResult& solution, const Elements& elements,
                                 const RunOptions& options) {
  return {{"ok", solution.converged},
          {"scene", scene.file.string()},
          {"elements", options.quadratic ? "quadratic" : "linear"},
          {"load_fraction", solution.load_fraction},
          {"relative_residual", solution.residual},
          {"newton_iterations", solution.iterations},
          {"load_steps", solution.load_steps},
          {"unknowns", solution.unknowns},
          {"factor", solution.factor},
          {"factor_nonzeros", solution.factor_nonzeros},
          {"damped_iterations", solution.damped},
          {"buckling_load_fraction", solution.buckling},
          {"elastic_energy", solution.energy},
          {"volume", current_volume(elements, solution.u)},
          {"largest_displacement", solution.u.colwise().norm().maxCoeff()},
          {"smallest_volume_ratio", solution.smallest_volume_ratio},
          {"worst_tetrahedron", solution.worst_tet}};
}

bool is_loaded(const Setup& setup) {
  const auto any = [](const auto& list, auto&& acts) { return std::any_of(list.begin(), list.end(), acts); };
  return setup.gravity != Vec3d::Zero() ||
         any(setup.prescribed, [](const auto& p) { return p.displacement != Vec3d::Zero(); }) ||
         any(setup.face_loads, [](const auto& load) { return load.traction != Vec3d::Zero(); }) ||
         any(setup.vertex_loads, [](const auto& load) { return load.force != Vec3d::Zero(); }) ||
         any(setup.pressures, [](const auto& load) { return load.pressure != 0; });
}

}  // namespace

std::vector<std::string> left_out_of_statics(const Scene& scene, const Setup& setup) {
  std::vector<std::string> warnings;
  if (!scene.tools.empty()) warnings.push_back("tools are ignored in a static solution");
  for (const std::string& key : scene.force_keys())
    warnings.push_back(key + " are ignored in a static solution");
  if (scene.contact.is_on()) warnings.push_back("contact is ignored in a static solution");
  if (any_viscous(setup.materials))
    warnings.push_back("viscosity is left out of a static solution, which is that after long rest");
  return warnings;
}

RunResult solve_scene(const Scene& scene, const Resolved& resolved, const RunOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  StaticOptions solver;
  solver.factor = options.factor;
  solver.progress = options.progress;
  const StaticResult solution = options.quadratic ? solve_static_quadratic(resolved.setup, solver)
                                                  : solve_static(resolved.setup, solver);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  RunResult result;
  result.ok = solution.converged;
  result.warnings = resolved.warnings;
  if (!is_loaded(resolved.setup))
    result.warnings.push_back(
        "nothing loads the body, neither gravity nor a force, traction, pressure or displacement: it stays "
        "as "
        "it is");
  if (solution.converged && solution.buckling > 0)
    result.warnings.push_back("the body has buckled at about " + rounded(100 * solution.buckling) +
                              " % of the load: it has other equilibria than this one");
  for (const std::string& warning : left_out_of_statics(scene, resolved.setup))
    result.warnings.push_back(warning);
  if (!solution.converged) result.warnings.push_back(solution.reason);
  std::error_code error;
  std::filesystem::create_directories(options.directory, error);
  if (!std::filesystem::is_directory(options.directory, error))
    throw InputError(options.directory.string(), "cannot be made a directory for the results");
  const Elements elements = elements_of(resolved.setup, options.quadratic);
  write_frame(options.directory / "solution.vtu", elements, solution.u,
              Mat3X<double>::Zero(3, solution.u.cols()), {}, solution.reactions);
  nlohmann::ordered_json report = report_of(scene, solution, elements, options);
  if (!options.quadratic) report["reactions"] = reactions_json(resolved.held, elements, solution.reactions);
  report["wall_s"] = seconds;
  report["warnings"] = result.warnings;
  result.report = options.directory / "report.json";
  io::write_file(result.report,
                 report.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n');
  char text[256];
  std::snprintf(text, sizeof text,
                "%s at %.4g %% of the load: residual %.2g after %d Newton iterations in %.2f s\n"
                "largest displacement %.6g m, elastic energy %.6g J\n",
                solution.converged ? "equilibrium" : "stopped", 100 * solution.load_fraction,
                solution.residual, solution.iterations, seconds, solution.u.colwise().norm().maxCoeff(),
                solution.energy);
  result.summary = text;
  return result;
}

}  // namespace lobe
