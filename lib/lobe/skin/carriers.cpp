#include "lobe/skin/carriers.h"

#include <algorithm>
#include <limits>

#include "lobe/cut/distance.h"
#include "lobe/diagnostics/locate.h"

namespace lobe {
namespace {

constexpr int samples_per_edge = 3;
constexpr double inside = 0.95;  // how far samples reach from the barycentre to the rim

}  // namespace

NumberLists inverse(const NumberLists& lists, Index count) {
  NumberLists result;
  result.begin.assign(std::size_t(count) + 1, 0);
  for (Index item : lists.items) ++result.begin[item + 1];
  for (Index i = 0; i < count; ++i) result.begin[i + 1] += result.begin[i];
  result.items.resize(lists.items.size());
  std::vector<Index> next(result.begin.begin(), result.begin.end() - 1);
  for (Index list = 0; list < lists.count(); ++list)
    for (Index item : lists[list]) result.items[next[item]++] = list;
  return result;
}

NumberLists tets_under(const Mat3X<double>& points, const Triangles& triangles, const TetMesh& mesh) {
  const Locator where(mesh);
  NumberLists under;
  std::vector<Index> tets;
  Index guess = -1;
  for (const auto& triangle : triangles.colwise()) {
    const Mat3<double> corners = points(Eigen::all, triangle);
    const Vec3d middle = corners.rowwise().mean();
    guess = where.nearest(middle, guess).tet;
    tets.assign(1, guess);
    for (int i = 0; i <= samples_per_edge; ++i)
      for (int j = 0; i + j <= samples_per_edge; ++j) {
        const Vec3d weights = Vec3d(i, j, samples_per_edge - i - j) / samples_per_edge;
        const Vec3d p = middle + inside * (corners * weights - middle);
        tets.push_back(where.nearest(p, guess).tet);  // where several are as near: that under the middle
      }
    std::sort(tets.begin() + 1, tets.end());
    tets.erase(std::unique(tets.begin() + 1, tets.end()), tets.end());
    tets.erase(std::remove(tets.begin() + 1, tets.end(), tets.front()), tets.end());
    under.append(tets);
  }
  return under;
}

Index nearest_of(std::span<const Index> tets, const TetMesh& mesh, const Vec3d& p) {
  Index best = -1;
  double least = std::numeric_limits<double>::infinity();
  for (Index t : tets) {
    const double distance = distance_to_tet(p, tet_points(mesh, t));
    if (distance >= least) continue;
    least = distance;
    best = t;
  }
  return best;
}

Touch touch(const Topology& topology, Index tet, Index other) {
  Touch found = Touch::never;
  for (Index v : topology.corners(tet))
    for (Index w : topology.corners(other)) {
      if (v == w)
        found = Touch::together;
      else if (topology.origin(v) == topology.origin(w))
        return Touch::apart;
    }
  return found;
}

}  // namespace lobe
