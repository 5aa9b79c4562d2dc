// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <cmath>
#include <iomanip>
#include <map>
#include <numbers>
#include <sstream>

#include "lobe_mesh/child_process.h"
#include "lobe_mesh/errors.h"
#include "lobe_mesh/model.h"
#include "lobe_mesh/steps.h"
#include "lobe_mesh/tetgen_files.h"
#include "lobe_mesh/tetrahedralise.h"

namespace lobe::meshing {
namespace {

// Largest volume of a tetrahedron in units of the regular one, calibrated as in mesh_cgal.cpp.
constexpr double volume_factor = 2.0;

// TetGen fills cavities as well: keep the regions that lie inside a surface, and the points they use.
TetMesh inside_part(const TetgenFile& file, const Model& model) {
  const auto point = [&](std::int32_t v) {
    return Vec3d(file.points[3 * v], file.points[3 * v + 1], file.points[3 * v + 2]);
  };
  std::map<std::int32_t, int> region_of;
  std::vector<Index> number(file.points.size() / 3, -1);
  std::vector<Vec3d> points;
  std::vector<Index> cells;
  TetMesh mesh;
  for (std::size_t t = 0; t < file.regions.size(); ++t) {
    const std::int32_t* corners = &file.cells[4 * t];
    const auto [region, is_new] = region_of.try_emplace(file.regions[t], -1);
    if (is_new) {
      const Vec3d centre =
          (point(corners[0]) + point(corners[1]) + point(corners[2]) + point(corners[3])) / 4;
      region->second = model.region_at(centre);
    }
    if (region->second < 0) continue;
    mesh.labels.push_back(region->second);
    for (int k = 0; k < 4; ++k) {
      Index& n = number[corners[k]];
      if (n < 0) {
        n = static_cast<Index>(points.size());
        points.push_back(point(corners[k]));
      }
      cells.push_back(n);
    }
  }
  mesh.points.resize(3, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) mesh.points.col(i) = points[i];
  mesh.tets = Eigen::Map<Tets>(cells.data(), 4, cells.size() / 4);
  return mesh;
}

std::string why(const ChildResult& result) {
  if (result.end == ChildResult::End::normal && result.status == 3) return "refused the remeshed surface";
  if (result.end == ChildResult::End::normal && result.status == 4) return "made no tetrahedra";
  return result.in_words();
}

}  // namespace

TetMesh mesh_with_tetgen(const Model& model, double edge, const MeshOptions& options) {
  const auto program = options.tetgen_program.empty() ? find_program("lobe-tetgen") : options.tetgen_program;
  if (program.empty())
    throw InputError("--mesher tetgen", "the program lobe-tetgen was not found; use --mesher cgal");
  const TemporaryFolder folder;
  const std::string input = folder.path() / "surface", output = folder.path() / "mesh";
  const Surface surface = joined_surface(model.surfaces);
  TetgenFile file;
  file.points.assign(surface.points.reshaped().begin(), surface.points.reshaped().end());
  file.cells.assign(surface.triangles.reshaped().begin(), surface.triangles.reshaped().end());
  if (!file.write(input)) throw MeshingFailure("cannot write to " + folder.path().string());
  std::ostringstream
      switches;  // Y: the surface stays; q: radius to edge, dihedral; A: regions are told apart
  switches << "pYAq1.414/15a" << std::fixed << std::setprecision(15)
           << volume_factor * edge * edge * edge / (6 * std::numbers::sqrt2) << "Q";
  const ChildResult result =
      run_child(program, {input, output, switches.str()}, {options.time_limit, options.memory_limit});
  if (result.end != ChildResult::End::normal || result.status != 0) {
    throw MeshingFailure("the mesher tetgen " + why(result) + ": use --mesher cgal, or another --edge");
  }
  TetgenFile tets;
  if (!tets.read(output)) throw MeshingFailure("the mesher tetgen left an incomplete result");
  return inside_part(tets, model);
}

}  // namespace lobe::meshing
