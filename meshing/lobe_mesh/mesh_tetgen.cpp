// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <Eigen/Geometry>
#include <cmath>
#include <iomanip>
#include <map>
#include <numbers>
#include <sstream>

#include "lobe_mesh/child_process.h"
#include "lobe_mesh/errors.h"
#include "lobe_mesh/steps.h"
#include "lobe_mesh/tetgen_files.h"
#include "lobe_mesh/tetrahedralise.h"

namespace lobe::meshing {
namespace {

// Largest volume of a tetrahedron in units of the regular one, calibrated as in mesh_cgal.cpp.
constexpr double volume_factor = 2.0;

// How often the surface winds around a point (solid angle / 4π): 1 inside, 0 outside or in a cavity.
double winding_number(const Surface& surface, const Vec3d& p) {
  double angle = 0;
  for (const auto& t : surface.triangles.colwise()) {
    const Vec3d a = surface.points.col(t[0]) - p, b = surface.points.col(t[1]) - p,
                c = surface.points.col(t[2]) - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4 * std::numbers::pi);
}

// TetGen fills cavities as well: keep the regions that lie inside, and the points they use.
TetMesh inside_part(const TetgenFile& file, const Surface& surface) {
  const auto point = [&](std::int32_t v) {
    return Vec3d(file.points[3 * v], file.points[3 * v + 1], file.points[3 * v + 2]);
  };
  std::map<std::int32_t, bool> is_inside;
  std::vector<Index> number(file.points.size() / 3, -1);
  std::vector<Vec3d> points;
  std::vector<Index> cells;
  for (std::size_t t = 0; t < file.regions.size(); ++t) {
    const std::int32_t* corners = &file.cells[4 * t];
    const auto [region, is_new] = is_inside.try_emplace(file.regions[t], true);
    if (is_new) {
      const Vec3d centre =
          (point(corners[0]) + point(corners[1]) + point(corners[2]) + point(corners[3])) / 4;
      region->second = winding_number(surface, centre) > 0.5;
    }
    if (!region->second) continue;
    for (int k = 0; k < 4; ++k) {
      Index& n = number[corners[k]];
      if (n < 0) {
        n = static_cast<Index>(points.size());
        points.push_back(point(corners[k]));
      }
      cells.push_back(n);
    }
  }
  TetMesh mesh;
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

TetMesh mesh_with_tetgen(const Surface& surface, double edge, const MeshOptions& options) {
  const auto program = options.tetgen_program.empty() ? find_program("lobe-tetgen") : options.tetgen_program;
  if (program.empty())
    throw InputError("--mesher tetgen", "the program lobe-tetgen was not found; use --mesher cgal");
  const TemporaryFolder folder;
  const std::string input = folder.path() / "surface", output = folder.path() / "mesh";
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
  return inside_part(tets, surface);
}

}  // namespace lobe::meshing
