#include "lobe/skin/carriers.h"

#include <algorithm>
#include <limits>

#include "lobe/cut/distance.h"
#include "lobe/diagnostics/locate.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

constexpr int fewest_per_edge = 3, most_per_edge = 24;
constexpr double inside = 0.95;  // how far samples reach from the barycentre to the rim

// Whether the numbers below `count` are all connected by pairs that are related.
template <class Related>
bool hang_together(std::size_t count, Related&& related) {
  std::vector<std::size_t> reached{0}, left;
  for (std::size_t i = 1; i < count; ++i) left.push_back(i);
  for (std::size_t at = 0; at < reached.size(); ++at)
    std::erase_if(left, [&](std::size_t i) {
      const bool is_near = related(reached[at], i);
      if (is_near) reached.push_back(i);
      return is_near;
    });
  return left.empty();
}

bool share_corner(const TetMesh& mesh, Index tet, Index other) {
  for (Index v : mesh.tets.col(tet))
    if ((mesh.tets.col(other).array() == v).any()) return true;
  return false;
}

// Finds the tetrahedra that are nearest to points spread over a triangle. The first is that of its middle;
// the others are in ascending order.
void sample(const Locator& where, const Mat3<double>& corners, int per_edge, Index guess,
            std::vector<Index>& tets) {
  const Vec3d middle = corners.rowwise().mean();
  const Index centre = where.nearest(middle, guess).tet;
  tets.clear();
  for (int i = 0; i <= per_edge; ++i)
    for (int j = 0; i + j <= per_edge; ++j) {
      const Vec3d weights = Vec3d(i, j, per_edge - i - j) / per_edge;
      const Vec3d p = middle + inside * (corners * weights - middle);
      tets.push_back(where.nearest(p, centre).tet);  // where several are as near: that of the middle
    }
  sort_unique(tets);
  std::erase(tets, centre);
  tets.insert(tets.begin(), centre);
}

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
  for (const auto& triangle : triangles.colwise()) {
    const auto near = [&](std::size_t i, std::size_t j) { return share_corner(mesh, tets[i], tets[j]); };
    const Index guess = tets.empty() ? -1 : tets[0];
    for (int per_edge = fewest_per_edge; per_edge <= most_per_edge; per_edge *= 2) {
      sample(where, points(Eigen::all, triangle), per_edge, guess, tets);
      if (hang_together(tets.size(), near)) break;
    }
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

Bond bond(const Topology& topology, std::span<const Index> tets) {
  for (std::size_t i = 0; i < tets.size(); ++i) {
    if (!topology.alive(tets[i])) return Bond::none;
    for (std::size_t j = 0; j < i; ++j)
      if (touch(topology, tets[i], tets[j]) == Touch::apart) return Bond::none;
  }
  const auto near = [&](std::size_t i, std::size_t j) {
    return touch(topology, tets[i], tets[j]) == Touch::together;
  };
  return hang_together(tets.size(), near) ? Bond::firm : Bond::loose;
}

}  // namespace lobe
