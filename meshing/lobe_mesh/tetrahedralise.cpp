// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/tetrahedralise.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>

#include "lobe/error.h"
#include "lobe/sim/frequency.h"
#include "lobe_mesh/diagnose.h"
#include "lobe_mesh/errors.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {
namespace {

constexpr double most_tets = 20e6;
// Remeshing to this multiple of the edge gives boundary tetrahedra of the volume aimed at.
constexpr double surface_edge_factor = 1.08;
constexpr int smoothing_rounds = 8;

double regular_volume(double edge) { return edge * edge * edge / (6 * std::numbers::sqrt2); }
double regular_edge(double volume) { return std::cbrt(volume * 6 * std::numbers::sqrt2); }

double area(const Surface& surface) {
  double sum = 0;
  for (const auto& t : surface.triangles.colwise()) {
    const Vec3d a = surface.points.col(t[1]) - surface.points.col(t[0]);
    sum += a.cross(Vec3d(surface.points.col(t[2]) - surface.points.col(t[0]))).norm() / 2;
  }
  return sum;
}

std::string number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

void check(const MeshOptions& options, const Surface& surface) {
  std::vector<Fault> faults;
  const auto positive = [&](const std::string& name, double value, bool zero_too) {
    if (std::isfinite(value) && (value > 0 || (zero_too && value == 0))) return;
    faults.push_back({name, number(value) + (zero_too ? ", must not be negative" : ", must be positive")});
  };
  positive("edge", options.edge, true);
  positive("lambda", options.lambda, true);
  positive("mu", options.mu, false);
  positive("density", options.density, false);
  positive("time limit", options.time_limit, false);
  positive("memory limit", options.memory_limit, false);
  positive("feature angle", options.feature_angle, false);
  if (options.time_limit > 1e7) faults.push_back({"time limit", "must be at most 1e7 s"});
  if (options.memory_limit > 1e15) faults.push_back({"memory limit", "must be at most 1e15 bytes"});
  if (options.tries < 0 || options.tries > 8) faults.push_back({"tries", "must be from 1 to 8"});
  if (!faults.empty()) throw InputError(std::move(faults));
  if (options.edge == 0) return;
  const double diagonal = box_diagonal(surface);
  if (options.edge > diagonal / 2) {
    throw InputError("edge", number(options.edge) + " m is too long for a body of " + number(diagonal) +
                                 " m: choose at most " + number(diagonal / 4));
  }
  // About one tetrahedron per face of the boundary counts where a body is thin or has spikes.
  const double faces = area(surface) / (std::numbers::sqrt3 / 4 * options.edge * options.edge);
  const double tets = std::max(enclosed_volume(surface) / regular_volume(options.edge), faces);
  if (tets > most_tets) {
    throw InputError("edge",
                     number(options.edge) + " m would give about " + number(std::round(tets / 1e6)) +
                         " million tetrahedra, at most " + number(most_tets / 1e6) +
                         " million are made: choose a longer edge (or --scale, if the units are wrong)");
  }
}

class Stopwatch {
 public:
  explicit Stopwatch(MeshReport& report) : report_(report) {}
  void phase(const std::string& name) {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    const auto same = [&](const Phase& phase) { return phase.name == name; };
    const auto known = std::find_if(report_.phases.begin(), report_.phases.end(), same);
    if (known != report_.phases.end())
      known->seconds += seconds;
    else
      report_.phases.push_back({name, seconds});
    last_ = now;
  }
  double elapsed() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  MeshReport& report_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), last_ = start_;
};

// Remeshing may fold thin parts onto themselves, which TetGen refuses: then a finer surface is tried.
Surface remesh_without_intersections(const Surface& surface, const std::vector<Polyline>& features,
                                     double edge) {
  for (const double factor : {1.0, 0.85, 0.7, 0.5}) {
    const Surface result = remesh(surface, features, surface_edge_factor * factor * edge);
    if (diagnose(result).meshable()) return result;
  }
  throw MeshingFailure("remeshing left self-intersections: use --mesher cgal, or a shorter --edge");
}

Index count_boundary_faces(const TetMesh& mesh) {
  std::map<std::array<Index, 3>, int> faces;
  for (const auto& tet : mesh.tets.colwise()) {
    for (const auto& face : face_corners) {
      std::array<Index, 3> key{tet[face[0]], tet[face[1]], tet[face[2]]};
      std::sort(key.begin(), key.end());
      ++faces[key];
    }
  }
  return static_cast<Index>(
      std::count_if(faces.begin(), faces.end(), [](const auto& f) { return f.second == 1; }));
}

void measure(const TetMesh& mesh, const MeshOptions& options, MeshReport& report) {
  report.vertices = mesh.vertex_count();
  report.tets = mesh.tet_count();
  report.boundary_faces = count_boundary_faces(mesh);
  report.quality = mesh_quality(mesh);
  report.volume_error = 100 * (report.quality.volume / report.surface_volume - 1);
  report.mean_edge = regular_edge(report.quality.volume / report.tets);
  report.time_step = rest_time_step(mesh, {options.lambda, options.mu, options.density});
  const double wave_speed = std::sqrt((options.lambda + 2 * options.mu) / options.density);
  report.time_step_star = report.time_step * wave_speed / report.mean_edge;
  if (std::abs(report.volume_error) > 5) {
    report.warnings.push_back("the mesh's volume differs from the surface's by " +
                              number(std::round(10 * report.volume_error) / 10) +
                              " %: choose a shorter --edge");
  }
}

// One mesh of the surface, which is scaled to unit size.
TetMesh mesh_once(const Surface& surface, const std::vector<Polyline>& features, double edge,
                  MeshOptions options, const UnitBox& unit, Stopwatch& stopwatch) {
  options.time_limit = std::max(0.001, options.time_limit - stopwatch.elapsed());
  TetMesh mesh;
  if (options.mesher == Mesher::cgal) {
    mesh = mesh_with_cgal(surface, features, edge, options.time_limit);
    stopwatch.phase("cgal");
  } else {
    const Surface remeshed = remesh_without_intersections(surface, features, edge);
    stopwatch.phase("remesh");
    mesh = mesh_with_tetgen(remeshed, edge, options);
    stopwatch.phase("tetgen");
    smooth_interior(mesh, smoothing_rounds);
    peel_flat_tets(mesh);
    stopwatch.phase("smooth");
  }
  if (mesh.tet_count() == 0) throw MeshingFailure("no tetrahedra: choose a shorter --edge");
  mesh.points = unit.from_unit(mesh.points);
  try {
    prepare(mesh, "mesh");
  } catch (const InputError& error) {
    throw MeshingFailure(std::string("the mesher left an unusable mesh (") + error.what() +
                         "): try another --edge");
  }
  return mesh;
}

// Repair takes bodies that touch along an edge or at a vertex apart, in the same place; Mesh_3 refines there without end.
void refuse_touching(const Surface& surface) {
  std::map<std::array<double, 3>, Index> seen;
  for (Index v = 0; v < surface.points.cols(); ++v) {
    const Vec3d p = surface.points.col(v);
    if (seen.try_emplace({p.x(), p.y(), p.z()}, v).second) continue;
    std::ostringstream place;
    place << "two bodies touch at (" << p.x() << ", " << p.y() << ", " << p.z()
          << ") m: use --mesher tetgen, or move them apart";
    throw InputError("surface", place.str());
  }
}

}  // namespace

TetMesh tetrahedralise(const Surface& surface, const MeshOptions& options, MeshReport& report) {
  report = {};
  check(options, surface);
  if (options.mesher == Mesher::cgal) refuse_touching(surface);
  Stopwatch stopwatch(report);
  const UnitBox unit(surface);
  const Surface scaled{unit.to_unit(surface.points), surface.triangles};
  report.surface_volume = enclosed_volume(surface);
  report.edge = options.edge > 0 ? options.edge : box_diagonal(surface) / 25;
  const double edge = report.edge / unit.size;
  if (!diagnose(scaled).meshable()) throw InputError("surface", "not closed and manifold: repair it first");
  const auto features = feature_lines(scaled, options.feature_angle, 6 * edge);
  stopwatch.phase("check");

  // A try that fails is replaced by another one; which one is best depends on chance more than on the edge.
  const int wanted = options.tries > 0 ? options.tries : options.mesher == Mesher::cgal ? 1 : 3;
  TetMesh best;
  double best_step = 0;
  int done = 0, failed = 0;
  std::string failure;
  for (const double factor : {1.0, 0.97, 1.03, 0.94, 1.05, 0.91, 1.02, 0.98, 0.92, 1.01}) {
    if (done == wanted || failed > 2) break;
    try {
      TetMesh mesh = mesh_once(scaled, features, factor * edge, options, unit, stopwatch);
      const double step = rest_time_step(mesh, {options.lambda, options.mu, options.density});
      ++done;
      if (step <= best_step) continue;
      best = std::move(mesh);
      best_step = step;
    } catch (const MeshingFailure& error) {
      ++failed;
      if (failure.empty()) failure = error.what();
      if (stopwatch.elapsed() > options.time_limit) break;
    }
  }
  if (done == 0) throw MeshingFailure(failure);
  measure(best, options, report);
  stopwatch.phase("measure");
  return best;
}

}  // namespace lobe::meshing
