#include "lobe/linearity/halving.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

namespace lobe {
namespace {

// The tetrahedra become the parts `first` … first + count − 1.
void halve(const Mat3X<double>& centres, std::span<Index> tets, Index first, Index count,
           std::vector<Index>& part) {
  if (count == 1) {
    for (Index t : tets) part[std::size_t(t)] = first;
    return;
  }
  Vec3d low = centres.col(tets[0]), high = low;
  for (Index t : tets) {
    low = low.cwiseMin(centres.col(t));
    high = high.cwiseMax(centres.col(t));
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const Index below = count / 2;
  const std::size_t middle = tets.size() * std::size_t(below) / std::size_t(count);
  std::nth_element(tets.begin(), tets.begin() + std::ptrdiff_t(middle), tets.end(), [&](Index a, Index b) {
    return std::pair(centres(axis, a), a) < std::pair(centres(axis, b), b);
  });
  halve(centres, tets.first(middle), first, below, part);
  halve(centres, tets.subspan(middle), first + below, count - below, part);
}

}  // namespace

std::vector<Index> parts_by_halving(const Elements& elements, Index count) {
  const Index tet_count = elements.topology.tet_count();
  Mat3X<double> centres(3, tet_count);
  for (Index t = 0; t < tet_count; ++t) centres.col(t) = elements.corner_points(t).rowwise().mean();
  std::vector<Index> tets(static_cast<std::size_t>(tet_count)), part(tets.size());
  std::iota(tets.begin(), tets.end(), 0);
  halve(centres, tets, 0, count, part);
  return part;
}

}  // namespace lobe
