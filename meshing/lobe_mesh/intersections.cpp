// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// Works on any set of triangles: CGAL's own test of version 5.5 needs a manifold.
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>

#include <algorithm>

#include "lobe_mesh/cgal_common.h"
#include "lobe_mesh/clean.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {
namespace {

using Corners = std::array<std::size_t, 3>;

// Two triangles with a common edge (v, w) overlap if they are coplanar and on the same side of it.
bool fold_over(const std::vector<Point>& points, std::size_t v, std::size_t w, std::size_t a, std::size_t b) {
  return CGAL::coplanar(points[v], points[w], points[a], points[b]) &&
         CGAL::coplanar_orientation(points[v], points[w], points[a], points[b]) == CGAL::POSITIVE;
}

// With one common vertex, they intersect if the opposite edge of one meets the other.
bool edge_meets(const std::vector<Point>& points, const Corners& edge_of, std::size_t shared,
                const Corners& other) {
  std::array<std::size_t, 2> edge{};
  int n = 0;
  for (const std::size_t v : edge_of) {
    if (v != shared) edge[n++] = v;
  }
  const Kernel::Segment_3 segment(points[edge[0]], points[edge[1]]);
  return CGAL::do_intersect(segment,
                            Kernel::Triangle_3(points[other[0]], points[other[1]], points[other[2]]));
}

bool intersect(const std::vector<Point>& points, const Corners& a, const Corners& b) {
  std::vector<std::size_t> shared, only_a, only_b;
  for (const std::size_t v : a) (std::find(b.begin(), b.end(), v) != b.end() ? shared : only_a).push_back(v);
  for (const std::size_t v : b) {
    if (std::find(a.begin(), a.end(), v) == a.end()) only_b.push_back(v);
  }
  if (shared.size() == 3) return true;
  if (shared.size() == 2) return fold_over(points, shared[0], shared[1], only_a[0], only_b[0]);
  if (shared.size() == 1) return edge_meets(points, a, shared[0], b) || edge_meets(points, b, shared[0], a);
  return CGAL::do_intersect(Kernel::Triangle_3(points[a[0]], points[a[1]], points[a[2]]),
                            Kernel::Triangle_3(points[b[0]], points[b[1]], points[b[2]]));
}

bool flat(const std::vector<Point>& points, const Corners& t) {
  return CGAL::collinear(points[t[0]], points[t[1]], points[t[2]]);
}

struct Enough {};

}  // namespace

std::vector<std::pair<Index, Index>> self_intersections(const Surface& surface, std::size_t most) {
  return guarded("the search for self-intersections", [&] {
    Triangles welded = surface.triangles;
    const std::vector<Index> same = first_of_equal_points(surface.points);
    for (Index& v : welded.reshaped()) v = same[v];
    const Soup soup = to_soup(surface.points, welded);
    using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, Index>;
    std::vector<Box> boxes;
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
      const Corners& c = soup.triangles[t];
      if (flat(soup.points, c)) continue;  // counted as degenerate, not as intersecting
      boxes.emplace_back(soup.points[c[0]].bbox() + soup.points[c[1]].bbox() + soup.points[c[2]].bbox(),
                         static_cast<Index>(t));
    }
    std::vector<std::pair<Index, Index>> pairs;
    const auto test = [&](const Box& a, const Box& b) {
      const auto [low, high] = std::minmax({a.info(), b.info()});
      if (!intersect(soup.points, soup.triangles[low], soup.triangles[high])) return;
      pairs.emplace_back(low, high);
      if (pairs.size() >= most) throw Enough{};
    };
    try {
      CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), test);
    } catch (const Enough&) {
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
  });
}

}  // namespace lobe::meshing
