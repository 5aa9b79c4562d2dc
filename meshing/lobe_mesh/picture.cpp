// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "lobe/file/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/io/surface_io.h"
#include "lobe/text.h"
#include "lobe_mesh/child_process.h"
#include "lobe_mesh/interfaces.h"

namespace lobe::meshing {
namespace {

const Vec3d towards_eye = Vec3d(0.3, -1, 0.4).normalized(), up = Vec3d::UnitZ();
constexpr double seconds = 300, bytes = 16e9;  // at most, for lobe-picture
constexpr double best_angle = 70;              // [degrees], of the regular tetrahedron
const char* const cell_angle = "smallest dihedral angle [deg]";
const char* const drawn = "picture.png";  // beside the request
const char* const bar_angle = "dihedral angle [deg]";

// The half of the mesh that lies beyond a plane through its middle.
void write_half(const std::filesystem::path& file, const TetMesh& mesh, const Vec3d& middle) {
  std::vector<Index> kept;
  std::vector<double> angles;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    if ((barycentre(mesh, t) - middle).dot(towards_eye) > 0) continue;
    const auto dihedral = dihedral_angles(tet_points(mesh, t));
    kept.push_back(t);
    angles.push_back(*std::min_element(dihedral.begin(), dihedral.end()));
  }
  TetMesh half;
  half.points = mesh.points;
  half.tets = mesh.tets(Eigen::all, kept);
  const Eigen::Map<const Eigen::RowVectorXd> values(angles.data(), static_cast<Eigen::Index>(angles.size()));
  write_vtu(file, half, {}, {{cell_angle, values}});
}

// The histogram: one upright bar per bin, in a plane that faces the camera. All bars together are as wide as
// the body.
void write_bars(const std::filesystem::path& file, const Quality& quality) {
  const auto& counts = quality.dihedral_histogram;
  const auto bars = static_cast<Index>(counts.size());
  const double size = (quality.box_max - quality.box_min).maxCoeff(), width = size / bars;
  const double highest = *std::max_element(counts.begin(), counts.end());
  const Vec3d right = up.cross(towards_eye).normalized(), high = towards_eye.cross(right);
  const Vec3d corner = (quality.box_min + quality.box_max) / 2 - size / 2 * right - 0.3 * size * high;
  Mat3X<double> points(3, 4 * bars);
  Triangles triangles(3, 2 * bars);
  Eigen::MatrixXd angles(1, 2 * bars);
  for (Index bar = 0; bar < bars; ++bar) {
    const Vec3d left = corner + bar * width * right, across = 0.9 * width * right,
                height = 0.6 * size * std::max(0.004, counts[bar] / highest) * high;
    const Index p = 4 * bar;
    points.middleCols<4>(p) << left, left + across, left + across + height, left + height;
    triangles.col(2 * bar) << p, p + 1, p + 2;
    triangles.col(2 * bar + 1) << p, p + 2, p + 3;
    angles.middleCols<2>(2 * bar).setConstant(180.0 / bars * (bar + 0.5));
  }
  write_surface(file, points, triangles, {{bar_angle, angles}});
}

nlohmann::json request_of(const MeshReport& report) {
  const Quality& q = report.quality;
  const nlohmann::json panels = {
      {{"mesh", "boundary.vtp"},
       {"title", "boundary: " + std::to_string(report.boundary_faces) + " triangles"},
       {"edges", true}},
      {{"mesh", "half.vtu"},
       {"title", std::to_string(report.tets) + " tetrahedra, dt* " + rounded(report.time_step_star)},
       {"color", cell_angle},
       {"range", {0, best_angle}},
       {"edges", true}},
      {{"mesh", "bars.vtp"},
       {"title", "dihedral angles " + rounded(q.min_dihedral) + " to " + rounded(q.max_dihedral) + " deg"},
       {"color", bar_angle},
       {"range", {0, 180}}}};
  const auto numbers = [](const Vec3d& v) { return nlohmann::json{v.x(), v.y(), v.z()}; };
  return {{"pictures",
           {{{"out", drawn},
             {"size", {1800, 700}},
             {"panels", panels},
             {"camera", {{"direction", numbers(towards_eye)}, {"up", numbers(up)}}}}}}};
}

}  // namespace

std::string draw_picture(const std::filesystem::path& file, const TetMesh& mesh, const MeshReport& report) {
  const auto program = find_program("lobe-picture");
  if (program.empty()) return "lobe-picture was not found: build lobe with LOBE_PICTURES, which needs VTK";
  const TemporaryFolder folder;
  const Surface boundary = boundary_surface(mesh);
  write_surface(folder.path() / "boundary.vtp", boundary.points, boundary.triangles);
  write_half(folder.path() / "half.vtu", mesh, (report.quality.box_min + report.quality.box_max) / 2);
  write_bars(folder.path() / "bars.vtp", report.quality);
  const std::filesystem::path request = folder.path() / "request.json", errors = folder.path() / "errors";
  std::ofstream(request) << request_of(report);
  const ChildResult result = run_child(program, {request}, {seconds, bytes}, errors);
  if (result.end == ChildResult::End::normal && result.status == 0) {
    io::AtomicFile out(file);
    out.stream() << std::ifstream(folder.path() / drawn, std::ios::binary).rdbuf();
    out.commit();
    return "";
  }
  std::string why;
  std::ifstream in(errors);
  std::getline(in, why);
  return "lobe-picture " + result.in_words() + (why.empty() ? "" : ": " + why);
}

}  // namespace lobe::meshing
