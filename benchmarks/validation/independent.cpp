// Finite-element solutions of the same mesh by independent programs, data/reference_solutions.
#include <cstdio>
#include <fstream>

#include "benchmarks/validation/bodies.h"
#include "benchmarks/validation/cases.h"
#include "lobe/error.h"
#include "lobe/fem/transverse_isotropy.h"
#include "lobe/io/mesh_io.h"

namespace lobe::validation {
namespace {

const std::string folder = LOBE_REFERENCE_SOLUTIONS;

Mat3X<double> read_displacements(const std::string& file) {
  std::ifstream in(file);
  std::string line;
  if (!std::getline(in, line)) throw InputError(file, "cannot be read; it belongs to the sources of lobe");
  std::vector<double> values;
  while (std::getline(in, line)) {
    double x = 0, y = 0, z = 0;
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf", &x, &y, &z) != 3)
      throw InputError(file, "\"" + line + "\" is no displacement; three numbers were expected");
    values.insert(values.end(), {x, y, z});
  }
  return Eigen::Map<Mat3X<double>>(values.data(), 3, Eigen::Index(values.size() / 3));
}

struct Solution {
  const char* file;
  RegionModel model;
  double body_force, traction;  // along z [N/m³], [Pa]
  bool has_fibres = false;
};

Mat3X<double> own_solution(const TetMesh& mesh, const Solution& solution) {
  Elastic elastic;
  if (solution.has_fibres) set_transverse({9e4, 3e4, 0.4, 0.35, 2e4}, elastic);
  Setup setup = body_of(mesh, elastic, solution.model);
  if (solution.has_fibres) {
    setup.mesh.fibres.resize(3, mesh.tet_count());
    for (Index t = 0; t < mesh.tet_count(); ++t) {
      const Vec3d X = barycentre(mesh, t);
      setup.mesh.fibres.col(t) = Vec3d(1, 10 * X.x(), 50 * X.z()).normalized();
    }
  }
  const double end = mesh.points.row(0).maxCoeff();
  prescribe(setup, vertices_where(mesh, [](const Vec3d& X) { return X.x() == 0; }),
            [](const Vec3d&) { return Vec3d::Zero(); });
  setup.gravity.z() = solution.body_force / elastic.density;
  load_faces(
      setup, [&](const Vec3d& X) { return X.x() > end - 1e-9; },
      [&](const Vec3d&) { return Vec3d(0, 0, solution.traction); });
  return equilibrium(setup);
}

}  // namespace

void independent_solutions(Findings& findings, bool) {
  const TetMesh mesh = read_mesh(folder + "/beam_coarse.msh").mesh;
  for (const Solution& s : {Solution{"linear_body", RegionModel::tensor_mass, -3000, 0},
                            Solution{"linear_traction", RegionModel::tensor_mass, 0, -100},
                            Solution{"svk_body", RegionModel::nonlinear, -3000, 0},
                            Solution{"svk_body_large", RegionModel::nonlinear, -8000, 0},
                            Solution{"svk_traction", RegionModel::nonlinear, 0, -100},
                            Solution{"svk_traction_large", RegionModel::nonlinear, 0, -400},
                            Solution{"svk_fibre_body", RegionModel::nonlinear, -8000, 0, true}}) {
    const Mat3X<double> theirs = read_displacements(folder + "/" + s.file + ".csv");
    if (theirs.cols() != mesh.vertex_count())
      throw InputError(s.file, "has not one line per vertex of beam_coarse.msh");
    findings.value(s.file, "largest distance of a vertex, relative", "-",
                   relative_maximum(own_solution(mesh, s), theirs),
                   {0, s.has_fibres ? "svk_fibre.py" : "FEniCSx 0.5.2, GetFEM 5.4.2"},
                   {1e-8, "residuals and digits of both"});
  }
}

}  // namespace lobe::validation
