// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Polyhedral_mesh_domain_with_features_3.h>
#include <CGAL/make_mesh_3.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <unordered_map>

#include "lobe_mesh/cgal_common.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {
namespace {

using Domain = CGAL::Polyhedral_mesh_domain_with_features_3<Kernel, CgalMesh>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex =
    CGAL::Mesh_complex_3_in_triangulation_3<Triangulation, Domain::Corner_index, Domain::Curve_index>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

// Radii in units of the edge aimed at, calibrated so that the mean volume of the optimised mesh is that of
// the regular tetrahedron (tests/meshing/tetrahedralise_test.cpp holds it to ±30 %).
constexpr double facet_radius = 0.68;
constexpr double cell_radius = 0.78;
constexpr double facet_distance = 0.3;  // tighter values ruin the time step

// Raises a flag when the time is over, unless it is destroyed before.
class Alarm {
 public:
  explicit Alarm(double seconds)
      : end_(Clock::now() +
             std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds))),
        thread_([this] { wait(); }) {}
  ~Alarm() {
    {
      const std::lock_guard lock(mutex_);
      done_ = true;
    }
    condition_.notify_all();
    thread_.join();
  }
  Alarm(const Alarm&) = delete;
  Alarm& operator=(const Alarm&) = delete;

  std::atomic<bool>* flag() { return &ringing_; }
  double seconds_left() const { return std::chrono::duration<double>(end_ - Clock::now()).count(); }

 private:
  using Clock = std::chrono::steady_clock;

  void wait() {
    std::unique_lock lock(mutex_);
    if (!condition_.wait_until(lock, end_, [this] { return done_; })) ringing_ = true;
  }

  Clock::time_point end_;
  std::atomic<bool> ringing_ = false;
  bool done_ = false;
  std::mutex mutex_;
  std::condition_variable condition_;
  std::thread thread_;
};

void add_features(Domain& domain, const Surface& surface, const std::vector<Polyline>& features) {
  std::vector<std::vector<Point>> lines;
  for (const Polyline& feature : features) {
    auto& line = lines.emplace_back();
    for (const Index v : feature)
      line.emplace_back(surface.points(0, v), surface.points(1, v), surface.points(2, v));
  }
  domain.add_features(lines.begin(), lines.end());
}

TetMesh to_tet_mesh(const Complex& complex) {
  const auto& triangulation = complex.triangulation();
  std::unordered_map<Complex::Vertex_handle, Index> number;
  std::vector<Vec3d> points;
  TetMesh mesh;
  mesh.tets.resize(4, complex.number_of_cells_in_complex());
  Index t = 0;
  for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end(); ++cell, ++t) {
    for (int k = 0; k < 4; ++k) {
      const auto vertex = cell->vertex(k);
      const auto [entry, is_new] = number.try_emplace(vertex, static_cast<Index>(points.size()));
      if (is_new) {
        const auto& p = triangulation.point(vertex);
        points.emplace_back(p.x(), p.y(), p.z());
      }
      mesh.tets(k, t) = entry->second;
    }
  }
  mesh.points.resize(3, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) mesh.points.col(i) = points[i];
  return mesh;
}

Complex run(const Domain& domain, double edge, Alarm& alarm) {
  using namespace CGAL::parameters;
  const Criteria criteria(edge_size = edge, facet_angle = 25, facet_size = facet_radius * edge,
                          CGAL::parameters::facet_distance = meshing::facet_distance * edge,
                          cell_radius_edge_ratio = 2, cell_size = cell_radius * edge);
  Complex complex =
      CGAL::make_mesh_3<Complex>(domain, criteria, manifold(), no_lloyd(), no_odt(), no_perturb(), no_exude(),
                                 mesh_3_options(pointer_to_stop_atomic_boolean = alarm.flag()));
  const auto left = [&] { return std::max(0.01, alarm.seconds_left()); };
  CGAL::odt_optimize_mesh_3(complex, domain, CGAL::parameters::time_limit = left());
  CGAL::lloyd_optimize_mesh_3(complex, domain, CGAL::parameters::time_limit = left());
  CGAL::perturb_mesh_3(complex, domain, CGAL::parameters::time_limit = left());
  CGAL::exude_mesh_3(complex, CGAL::parameters::time_limit = left());
  return complex;
}

}  // namespace

TetMesh mesh_with_cgal(const Surface& surface, const std::vector<Polyline>& features, double edge,
                       double time_limit) {
  return guarded("the mesher cgal", [&] {
    const CgalMesh polyhedron = to_cgal(surface.points, surface.triangles);
    CGAL::Random random(0);
    Domain domain(polyhedron, &random);
    if (!features.empty()) add_features(domain, surface, features);
    Alarm alarm(time_limit);
    const Complex complex = run(domain, edge, alarm);
    if (*alarm.flag() || alarm.seconds_left() <= 0) {
      throw MeshingFailure("the mesher cgal did not finish within the time limit of " +
                           std::to_string(static_cast<int>(time_limit)) +
                           " s: choose a longer edge or --time-limit");
    }
    return to_tet_mesh(complex);
  });
}

}  // namespace lobe::meshing
