// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_domain_with_polyline_features_3.h>

#include <algorithm>
#include <map>

#include "lobe_mesh/disjoint_sets.h"
#include "lobe_mesh/mesh_3.h"
#include "lobe_mesh/model.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {
namespace {

using LabelDomain = CGAL::Labeled_mesh_domain_3<Kernel>;

// Starts the refinement from points of every piece of every interface that is as large as an edge, and from
// the seeds of the run.
class ImageDomain : public CGAL::Mesh_domain_with_polyline_features_3<LabelDomain> {
  using Base = CGAL::Mesh_domain_with_polyline_features_3<LabelDomain>;

 public:
  ImageDomain(const Model& model, const MeshingRun& run, const CGAL::Bbox_3& box, double error_bound,
              CGAL::Random& random)
      : Base(
            [&model](const Point& p) {
              return model.image_region({p.x(), p.y(), p.z()}) + 1;
            },
            box, error_bound, CGAL::Null_subdomain_index(), &random),
        model_(model),
        run_(run) {}

  struct Construct_initial_points {
    template <class Output>
    Output operator()(Output out, int = 0) const {
      for (std::size_t k = 0; k < domain.model_.surfaces.size(); ++k) {
        for (const Vec3d& p : starts(domain.model_.surfaces[k], domain.run_.sizing.shortest()))
          if (!is_near_a_seed(domain.run_, Point(p.x(), p.y(), p.z()))) *out++ = domain.point_on(k, p);
      }
      for (const Seed& seed : domain.run_.seeds) *out++ = domain.point_on(seed.surface, seed.point);
      return out;
    }
    const ImageDomain& domain;
  };
  Construct_initial_points construct_initial_points_object() const { return {*this}; }

 private:
  std::pair<Point, Base::Index> point_on(std::size_t surface, const Vec3d& p) const {
    const Sides& sides = model_.sides[surface];
    return {Point(p.x(), p.y(), p.z()),
            index_from_surface_patch_index({sides.outside + 1, sides.inside + 1})};
  }

  static std::vector<Vec3d> starts(const Surface& surface, double edge) {
    DisjointSets pieces(static_cast<std::size_t>(surface.point_count()));
    for (const auto& t : surface.triangles.colwise()) pieces.join(t[0], t[1]), pieces.join(t[1], t[2]);
    std::map<lobe::Index, std::vector<lobe::Index>> points_of;
    for (lobe::Index v = 0; v < surface.point_count(); ++v) points_of[pieces.root(v)].push_back(v);
    std::vector<Vec3d> result;
    for (const auto& [root, points] : points_of) {
      const Mat3X<double> x = surface.points(Eigen::all, points);
      if ((x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm() < edge) continue;
      const std::size_t count = std::min(points_per_piece, points.size());
      for (std::size_t i = 0; i < count; ++i) result.push_back(x.col(i * points.size() / count));
    }
    return result;
  }

  const Model& model_;
  const MeshingRun& run_;
};

CGAL::Bbox_3 box_of(const Model& model, double margin) {
  const Surface all = joined_surface(model.surfaces);
  const Vec3d low = all.points.rowwise().minCoeff().array() - margin,
              high = all.points.rowwise().maxCoeff().array() + margin;
  return {low.x(), low.y(), low.z(), high.x(), high.y(), high.z()};
}

// Lines where regions meet become lines of edges. Lines that are too short would ask for tiny edges, so they
// are not kept.
void add_junctions(ImageDomain& domain, const Model& model, double edge) {
  constexpr double shortest = 3;  // edges
  std::vector<std::vector<Point>> lines;
  for (const Mat3X<double>& line : model.junctions) {
    const auto n = line.cols() - 1;
    if ((line.rightCols(n) - line.leftCols(n)).colwise().norm().sum() < shortest * edge) continue;
    auto& points = lines.emplace_back();
    for (const auto& p : line.colwise()) points.emplace_back(p.x(), p.y(), p.z());
  }
  if (!lines.empty()) domain.add_features(lines.begin(), lines.end());
}

}  // namespace

TetMesh mesh_image_with_cgal(const Model& model, const MeshingRun& run) {
  return guarded("the mesher cgal", [&] {
    constexpr double error_bound = 0.01;  // of an edge: where the surface is taken to be
    CGAL::Random random(0);
    const double edge = run.sizing.shortest();
    const CGAL::Bbox_3 box = box_of(model, edge);
    const double radius =
        std::hypot(box.xmax() - box.xmin(), box.ymax() - box.ymin(), box.zmax() - box.zmin()) / 2;
    Counted<ImageDomain> domain(model, run, box, error_bound * edge / radius, random);
    add_junctions(domain, model, edge);
    return refine(domain, run, CGAL::parameters::non_manifold());
  });
}

}  // namespace lobe::meshing
