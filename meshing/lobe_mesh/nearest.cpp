// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/nearest.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>

#include <algorithm>

#include "lobe_mesh/cgal_common.h"

namespace lobe::meshing {
namespace {

using Triangle = Kernel::Triangle_3;

std::vector<Triangle> triangles_of(const Surface& surface) {
  const Soup soup = to_soup(surface.points, surface.triangles);
  std::vector<Triangle> triangles;
  for (const auto& t : soup.triangles) {
    const Triangle triangle(soup.points[t[0]], soup.points[t[1]], soup.points[t[2]]);
    if (!triangle.is_degenerate()) triangles.push_back(triangle);
  }
  return triangles;
}

Vec3d to_vector(const Point& p) { return {p.x(), p.y(), p.z()}; }

double one_way(const Surface& from, const NearestPoint& to) {
  double largest = 0;
  for (const Triangle& triangle : triangles_of(from)) {
    for (int k = 0; k < 3; ++k) largest = std::max(largest, to.distance(to_vector(triangle[k])));
    largest = std::max(largest, to.distance(to_vector(CGAL::centroid(triangle))));
  }
  return largest;
}

}  // namespace

struct NearestPoint::Tree {
  using Primitive = CGAL::AABB_triangle_primitive<Kernel, std::vector<Triangle>::const_iterator>;
  explicit Tree(const Surface& surface)
      : triangles(triangles_of(surface)), tree(triangles.begin(), triangles.end()) {
    tree.accelerate_distance_queries();
  }
  std::vector<Triangle> triangles;
  CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> tree;
};

NearestPoint::NearestPoint(const Surface& surface) : tree_(std::make_unique<Tree>(surface)) {}
NearestPoint::~NearestPoint() = default;
NearestPoint::NearestPoint(NearestPoint&&) noexcept = default;

Vec3d NearestPoint::operator()(const Vec3d& point) const {
  if (tree_->triangles.empty()) return point;
  return to_vector(tree_->tree.closest_point({point.x(), point.y(), point.z()}));
}

double sampled_distance(const Surface& a, const Surface& b) {
  return guarded("the distance to the input",
                 [&] { return std::max(one_way(a, NearestPoint(b)), one_way(b, NearestPoint(a))); });
}

}  // namespace lobe::meshing
