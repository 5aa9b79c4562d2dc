// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// CGAL's Delaunay refinement (Mesh_3) of any domain. Private: included by one translation unit per kind of
// domain.
#pragma once

#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/make_mesh_3.h>

#include <algorithm>
#include <functional>
#include <string>
#include <unordered_map>

#include "lobe/mesh/tet_mesh.h"
#include "lobe_mesh/alarm.h"
#include "lobe_mesh/cgal_common.h"
#include "lobe_mesh/sizing.h"
#include "lobe_mesh/steps.h"

namespace CGAL {

// Preferred to CGAL's own, which leaves files in the working folder before it reports an internal error.
template <class Triangulation, class Corner, class Curve>
void dump_c3t3(const Mesh_complex_3_in_triangulation_3<Triangulation, Corner, Curve>&, std::string) {}

// Preferred to CGAL's own within make_mesh_3(), too: optimisers that refine() does not ask for, and that take
// long to compile.
template <class T, class Corner, class Curve, class Domain, class A, class B, class C, class D>
void odt_optimize_mesh_3(Mesh_complex_3_in_triangulation_3<T, Corner, Curve>&, Domain&&, A&&, B&&, C&&, D&&) {
}
template <class T, class Corner, class Curve, class Domain, class A, class B, class C, class D>
void lloyd_optimize_mesh_3(Mesh_complex_3_in_triangulation_3<T, Corner, Curve>&, Domain&&, A&&, B&&, C&&,
                           D&&) {}
template <class T, class Corner, class Curve, class A, class B>
void exude_mesh_3(Mesh_complex_3_in_triangulation_3<T, Corner, Curve>&, A&&, B&&) {}

}  // namespace CGAL

namespace lobe::meshing {

// Radii in units of the edge aimed at, calibrated so that the mean volume of the optimised mesh is that of
// the regular tetrahedron (tests/meshing/tetrahedralise_test.cpp holds it to ±30 %).
inline constexpr double facet_radius = 0.7;
inline constexpr double cell_radius = 0.81;
inline constexpr double facet_distance = 0.3;  // tighter values ruin the time step

// Points of one piece of a surface that a refinement starts from: random ones, which CGAL takes, miss small
// pieces.
inline constexpr std::size_t points_per_piece = 12;

// Whether a seed is so near that another point there would make an edge shorter than any that is asked for.
inline bool is_near_a_seed(const MeshingRun& run, const Point& p) {
  const Vec3d at(p.x(), p.y(), p.z());
  return std::any_of(run.seeds.begin(), run.seeds.end(),
                     [&](const Seed& seed) { return (seed.point - at).norm() < run.sizing.shortest(); });
}

template <class Domain>
struct Mesh3 {
  using Triangulation = typename CGAL::Mesh_triangulation_3<Domain>::type;
  using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation, typename Domain::Corner_index,
                                                          typename Domain::Curve_index>;
  using Criteria = CGAL::Mesh_criteria_3<Triangulation>;
};

// A multiple of the edges asked for, as Mesh_3 wants it. Subdomain r + 1 of a domain is region r, 0 is
// outside.
template <class Domain>
struct Field {
  using FT = double;
  using Point_3 = Point;
  using Index = typename Domain::Index;

  double operator()(const Point& p, int dimension, const Index& index) const {
    const int region = dimension == 3 ? domain->subdomain_index(index) - 1 : -1;
    return factor * (*sizing)(Vec3d(p.x(), p.y(), p.z()), region);
  }
  const Domain* domain;
  const Sizing* sizing;
  double factor;
};

// Numbers or fields: the meshing itself is the same.
template <class Domain, class Size>
auto make_criteria(const Size& edge, const Size& facet, const Size& distance, const Size& cell) {
  using namespace CGAL::parameters;
  return typename Mesh3<Domain>::Criteria(edge_size = edge, facet_angle = 25, facet_size = facet,
                                          CGAL::parameters::facet_distance = distance,
                                          cell_radius_edge_ratio = 2, cell_size = cell);
}

template <class Domain>
auto criteria_of(const Domain& domain, const Sizing& sizing) {
  const auto field = [&](double factor) { return Field<Domain>{&domain, &sizing, factor}; };
  if (!sizing.uniform()) {
    return make_criteria<Domain>(field(1), field(facet_radius), field(facet_distance), field(cell_radius));
  }
  const double edge = sizing.shortest();
  return make_criteria<Domain>(edge, facet_radius * edge, facet_distance * edge, cell_radius * edge);
}

template <class Complex>
TetMesh to_tet_mesh(const Complex& complex) {
  const auto& triangulation = complex.triangulation();
  std::unordered_map<typename Complex::Vertex_handle, Index> number;
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

// Counts how often the refinement asks what a new tetrahedron lies in, or where the surface meets the edge
// between two of them: how far it is, and whether it will end.
template <class Domain>
struct Counted : Domain {
  using Domain::Domain;

  struct Is_in_domain {
    auto operator()(const Point& p) const {
      if (++counted.asked % 1024 == 0 && counted.on_progress) counted.on_progress();
      return counted.Domain::is_in_domain_object()(p);
    }
    const Counted& counted;
  };
  Is_in_domain is_in_domain_object() const { return {*this}; }

  struct Construct_intersection {
    template <class Edge>
    auto operator()(const Edge& edge) const {
      if (++counted.intersected % 1024 == 0 && counted.on_progress) counted.on_progress();
      return counted.Domain::construct_intersection_object()(edge);
    }
    const Counted& counted;
  };
  Construct_intersection construct_intersection_object() const { return {*this}; }

  mutable std::size_t asked = 0, intersected = 0;
  std::function<void()> on_progress;
};
constexpr double asked_per_tet = 6;  // questions per tetrahedron of the finished mesh, roughly

// Far more than any refinement needs that ends: coarse meshes of detailed surfaces, too.
inline double most_intersections(double expected_tets) { return 1e6 + 100 * expected_tets; }

// Each tetrahedron of the finished mesh is asked about at least once. A mesh of the edge asked for stays at
// half of this number, and one of so many more has features far smaller than the edge: the refinement may
// take minutes for them, and so do all that follows it.
inline double most_asked(double expected_tets) { return 1e4 + 2 * asked_per_tet * expected_tets; }

// Perturbation breaks slivers up; the other optimisers take ten times longer than the refinement and leave no
// longer time step after the relaxation.
template <class Domain, class Topology>
TetMesh refine(Counted<Domain>& domain, const MeshingRun& run, const Topology& topology) {
  using namespace CGAL::parameters;
  Alarm alarm(run.time_limit);
  domain.on_progress = [&] {
    run.progress(std::min(1.0, static_cast<double>(domain.asked) / (asked_per_tet * run.expected_tets)));
    if (static_cast<double>(domain.intersected) > most_intersections(run.expected_tets))
      alarm.ring("refines without end, perhaps where two parts of the surface nearly touch");
    if (static_cast<double>(domain.asked) > most_asked(run.expected_tets) && !alarm.rings())
      alarm.ring("makes far more than the " + rounded(std::round(run.expected_tets)) +
                 " tetrahedra of such edges, at features of the surface far smaller than them");
  };
  auto complex = CGAL::make_mesh_3<typename Mesh3<Counted<Domain>>::Complex>(
      domain, criteria_of(domain, run.sizing), topology, no_lloyd(), no_odt(), no_perturb(), no_exude(),
      mesh_3_options(pointer_to_stop_atomic_boolean = alarm.flag()));
  alarm.check();
  run.progress(1);
  CGAL::perturb_mesh_3(complex, domain, CGAL::parameters::time_limit = alarm.seconds_left());
  alarm.check();
  return to_tet_mesh(complex);
}

}  // namespace lobe::meshing
