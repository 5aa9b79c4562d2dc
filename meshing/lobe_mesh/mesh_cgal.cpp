// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <CGAL/Mesh_polyhedron_3.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polyhedral_complex_mesh_domain_3.h>

#include <algorithm>
#include <map>

#include "lobe_mesh/mesh_3.h"
#include "lobe_mesh/model.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {
namespace {

using Polyhedron = CGAL::Mesh_polyhedron_3<Kernel>::type;

// Starts the refinement from points of every piece of every surface, and from the seeds of the run.
class Domain : public CGAL::Polyhedral_complex_mesh_domain_3<Kernel, Polyhedron> {
  using Base = CGAL::Polyhedral_complex_mesh_domain_3<Kernel, Polyhedron>;

 public:
  using Base::Base;

  const MeshingRun* run = nullptr;

  struct Construct_initial_points {
    template <class Output>
    Output operator()(Output out, int = 0) const {
      for (const auto& [patch, centres] : domain.centres_of_pieces()) {
        const std::size_t count = std::min(points_per_piece, centres.size());
        for (std::size_t i = 0; i < count; ++i) {
          const Point& centre = centres[i * centres.size() / count];
          if (!is_near_a_seed(*domain.run, centre))
            *out++ = std::pair(centre, domain.index_from_surface_patch_index(patch));
        }
      }
      for (const Seed& seed : domain.run->seeds)
        *out++ = std::pair(Point(seed.point.x(), seed.point.y(), seed.point.z()),
                           domain.index_from_surface_patch_index(domain.patch_at(seed)));
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

  // Facets are in the order of the triangles that they were made of.
  Surface_patch_index patch_at(const Seed& seed) const {
    return std::next(stored_polyhedra[seed.surface].facets_begin(), seed.triangle)->patch_id();
  }
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
  for (const Mat3X<double>& junction : model.junctions) {
    auto& line = lines.emplace_back();
    for (const auto& p : junction.colwise()) line.emplace_back(p.x(), p.y(), p.z());
  }
  if (!lines.empty()) domain.add_features(lines.begin(), lines.end());
}

}  // namespace

TetMesh mesh_with_cgal(const Model& model, const MeshingRun& run) {
  return guarded("the mesher cgal", [&] {
    CGAL::Random random(0);
    std::vector<Polyhedron> polyhedra;
    std::vector<std::pair<int, int>> sides;  // inside and outside of each
    for (std::size_t k = 0; k < model.surfaces.size(); ++k) {
      polyhedra.push_back(to_polyhedron(model.surfaces[k]));
      sides.emplace_back(model.sides[k].inside + 1, model.sides[k].outside + 1);
    }
    Counted<Domain> domain(polyhedra.begin(), polyhedra.end(), sides.begin(), sides.end(), &random);
    domain.run = &run;
    add_features(domain, model);
    return refine(domain, run,
                  model.shares_walls() ? CGAL::parameters::non_manifold() : CGAL::parameters::manifold());
  });
}

}  // namespace lobe::meshing
