// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>

#include <algorithm>
#include <cmath>

#include "lobe_mesh/cgal_common.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {
namespace {

std::vector<Kernel::Triangle_3> triangles_of(const Surface& surface) {
  const Soup soup = to_soup(surface.points, surface.triangles);
  std::vector<Kernel::Triangle_3> triangles;
  for (const auto& t : soup.triangles) {
    const Kernel::Triangle_3 triangle(soup.points[t[0]], soup.points[t[1]], soup.points[t[2]]);
    if (!triangle.is_degenerate()) triangles.push_back(triangle);
  }
  return triangles;
}

double one_way(const std::vector<Kernel::Triangle_3>& from, const std::vector<Kernel::Triangle_3>& to) {
  using Primitive = CGAL::AABB_triangle_primitive<Kernel, std::vector<Kernel::Triangle_3>::const_iterator>;
  CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> tree(to.begin(), to.end());
  tree.accelerate_distance_queries();
  double largest = 0;
  for (const auto& triangle : from) {
    for (int k = 0; k < 3; ++k) largest = std::max(largest, tree.squared_distance(triangle[k]));
    largest = std::max(largest, tree.squared_distance(CGAL::centroid(triangle)));
  }
  return std::sqrt(largest);
}

}  // namespace

double sampled_distance(const Surface& a, const Surface& b) {
  return guarded("the distance to the input", [&] {
    const auto in_a = triangles_of(a);
    const auto in_b = triangles_of(b);
    if (in_a.empty() || in_b.empty()) return 0.0;
    return std::max(one_way(in_a, in_b), one_way(in_b, in_a));
  });
}

}  // namespace lobe::meshing
