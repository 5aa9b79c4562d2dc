// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_polyhedron_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polyhedral_complex_mesh_domain_3.h>
#include <CGAL/make_mesh_3.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>
#include <unordered_map>

#include "lobe/text.h"
#include "lobe_mesh/cgal_common.h"
#include "lobe_mesh/model.h"
#include "lobe_mesh/sizing.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {
namespace {

using Polyhedron = CGAL::Mesh_polyhedron_3<Kernel>::type;

// Starts the refinement from points of every piece of every surface: random ones, which CGAL takes, miss
// small pieces.
class Domain : public CGAL::Polyhedral_complex_mesh_domain_3<Kernel, Polyhedron> {
  using Base = CGAL::Polyhedral_complex_mesh_domain_3<Kernel, Polyhedron>;

 public:
  using Base::Base;

  struct Construct_initial_points {
    template <class Output>
    Output operator()(Output out, int = 0) const {
      constexpr std::size_t points_per_piece = 12;
      for (const auto& [patch, centres] : domain.centres_of_pieces()) {
        const std::size_t count = std::min(points_per_piece, centres.size());
        for (std::size_t i = 0; i < count; ++i)
          *out++ =
              std::pair(centres[i * centres.size() / count], domain.index_from_surface_patch_index(patch));
      }
      return out;
    }
    const Domain& domain;
  };
  Construct_initial_points construct_initial_points_object() const {
    Base::construct_initial_points_object();  // numbers the pieces
    return {*this};
  }

 private:
  std::map<Surface_patch_index, std::vector<Point>> centres_of_pieces() const {
    std::map<Surface_patch_index, std::vector<Point>> centres;
    for (const Polyhedron& polyhedron : stored_polyhedra) {
      for (auto f = polyhedron.facets_begin(); f != polyhedron.facets_end(); ++f) {
        const auto h = f->halfedge();
        centres[f->patch_id()].push_back(CGAL::centroid(h->vertex()->point(), h->next()->vertex()->point(),
                                                        h->opposite()->vertex()->point()));
      }
    }
    return centres;
  }
};
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex =
    CGAL::Mesh_complex_3_in_triangulation_3<Triangulation, Domain::Corner_index, Domain::Curve_index>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

// Radii in units of the edge aimed at, calibrated so that the mean volume of the optimised mesh is that of
// the regular tetrahedron (tests/meshing/tetrahedralise_test.cpp holds it to ±30 %).
constexpr double facet_radius = 0.7;
constexpr double cell_radius = 0.81;
constexpr double facet_distance = 0.3;  // tighter values ruin the time step

// Raises a flag when the time is over, unless it is destroyed before.
class Alarm {
 public:
  explicit Alarm(double seconds)
      : limit_(seconds),
        end_(Clock::now() +
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
  void check() const {
    if (!ringing_ && seconds_left() > 0) return;
    throw MeshingFailure("the mesher cgal did not finish within the time limit of " + rounded(limit_) +
                         " s: choose a longer edge or --time-limit");
  }

 private:
  using Clock = std::chrono::steady_clock;

  void wait() {
    std::unique_lock lock(mutex_);
    if (!condition_.wait_until(lock, end_, [this] { return done_; })) ringing_ = true;
  }

  double limit_;
  Clock::time_point end_;
  std::atomic<bool> ringing_ = false;
  bool done_ = false;
  std::mutex mutex_;
  std::condition_variable condition_;
  std::thread thread_;
};

Polyhedron to_polyhedron(const Surface& surface) {
  const Soup soup = to_soup(surface.points, surface.triangles);
  Polyhedron polyhedron;
  CGAL::Polygon_mesh_processing::polygon_soup_to_polygon_mesh(soup.points, soup.triangles, polyhedron);
  return polyhedron;
}

void add_features(Domain& domain, const Model& model) {
  std::vector<std::vector<Point>> lines;
  for (std::size_t k = 0; k < model.surfaces.size(); ++k) {
    const auto& points = model.surfaces[k].points;
    for (const Polyline& feature : model.features[k]) {
      auto& line = lines.emplace_back();
      for (const Index v : feature) line.emplace_back(points(0, v), points(1, v), points(2, v));
    }
  }
  if (!lines.empty()) domain.add_features(lines.begin(), lines.end());
}

// A multiple of the edges asked for, as Mesh_3 wants it.
struct Field {
  using FT = double;
  using Point_3 = Point;
  using Index = Domain::Index;

  double operator()(const Point& p, int dimension, const Index& index) const {
    const int label = dimension == 3 ? domain->subdomain_index(index) - 1 : -1;
    return factor * (*sizing)(Vec3d(p.x(), p.y(), p.z()), label);
  }
  const Domain* domain;
  const Sizing* sizing;
  double factor;
};

TetMesh to_tet_mesh(const Complex& complex) {
  const auto& triangulation = complex.triangulation();
  std::unordered_map<Complex::Vertex_handle, Index> number;
  std::vector<Vec3d> points;
  TetMesh mesh;
  mesh.tets.resize(4, complex.number_of_cells_in_complex());
  mesh.labels.resize(complex.number_of_cells_in_complex());
  Index t = 0;
  for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end(); ++cell, ++t) {
    mesh.labels[t] = complex.subdomain_index(cell) - 1;
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

// Numbers or fields: the meshing itself is the same.
template <class Size>
Criteria make_criteria(const Size& edge, const Size& facet, const Size& distance, const Size& cell) {
  using namespace CGAL::parameters;
  return Criteria(edge_size = edge, facet_angle = 25, facet_size = facet,
                  CGAL::parameters::facet_distance = distance, cell_radius_edge_ratio = 2, cell_size = cell);
}

Criteria criteria_of(const Domain& domain, const Sizing& sizing) {
  const auto field = [&](double factor) { return Field{&domain, &sizing, factor}; };
  if (!sizing.uniform())
    return make_criteria(field(1), field(facet_radius), field(facet_distance), field(cell_radius));
  const double edge = sizing.shortest();
  return make_criteria(edge, facet_radius * edge, facet_distance * edge, cell_radius * edge);
}

// Perturbation breaks slivers up; the other optimisers take ten times longer than the refinement and leave no
// longer time step after the relaxation.
Complex run(const Domain& domain, const Sizing& sizing, Alarm& alarm) {
  using namespace CGAL::parameters;
  Complex complex = CGAL::make_mesh_3<Complex>(domain, criteria_of(domain, sizing), manifold(), no_lloyd(),
                                               no_odt(), no_perturb(), no_exude(),
                                               mesh_3_options(pointer_to_stop_atomic_boolean = alarm.flag()));
  alarm.check();
  CGAL::perturb_mesh_3(complex, domain, CGAL::parameters::time_limit = alarm.seconds_left());
  alarm.check();
  return complex;
}

}  // namespace

TetMesh mesh_with_cgal(const Model& model, const Sizing& sizing, double time_limit) {
  return guarded("the mesher cgal", [&] {
    CGAL::Random random(0);
    std::vector<Polyhedron> polyhedra;
    std::vector<std::pair<int, int>>
        sides;  // inside and outside of each: subdomain k + 1 is label k, 0 is outside
    for (std::size_t k = 0; k < model.surfaces.size(); ++k) {
      polyhedra.push_back(to_polyhedron(model.surfaces[k]));
      sides.emplace_back(static_cast<int>(k) + 1, model.parents[k] + 1);
    }
    Domain domain(polyhedra.begin(), polyhedra.end(), sides.begin(), sides.end(), &random);
    add_features(domain, model);
    Alarm alarm(time_limit);
    return to_tet_mesh(run(domain, sizing, alarm));
  });
}

}  // namespace lobe::meshing
