#include "lobe/scalpel/crumbs.h"

#include <algorithm>

namespace lobe {
namespace {

constexpr double least_share = 1e-3;  // of the mean tetrahedron's volume
constexpr std::size_t most = 64;

bool has(const std::vector<Index>& sorted, Index value) {
  return std::binary_search(sorted.begin(), sorted.end(), value);
}

std::vector<Index> both_sides(const Grains& grains, const std::vector<Index>& faces) {
  std::vector<Index> sides;
  for (Index code : faces)
    for (Index side : {code, grains.other_side(code)}) sides.push_back(side);
  std::sort(sides.begin(), sides.end());
  return sides;
}

// The grains that hang together with one if these faces open, sorted; none if they are no crumb.
std::vector<Index> crumb_of(const Grains& grains, Index first, const std::vector<Index>& opened) {
  const double least = least_share * grains.mean_volume();
  if (grains.volume(first) >= least) return {};
  std::vector<Index> part{first};
  double volume = 0;
  for (std::size_t at = 0; at < part.size(); ++at) {
    volume += grains.volume(part[at]);
    if (volume >= least || part.size() > most) return {};
    for (int f = 0; f < 4; ++f) {
      if (has(opened, 4 * part[at] + f)) continue;
      const Index other = grains.neighbour(part[at], f);
      if (other >= 0 && std::find(part.begin(), part.end(), other) == part.end()) part.push_back(other);
    }
  }
  std::sort(part.begin(), part.end());
  return part;
}

// The largest face between a crumb and what it hangs on.
std::vector<Index>::iterator largest_around(const Grains& grains, const std::vector<Index>& crumb,
                                            std::vector<Index>& faces) {
  auto largest = faces.end();
  double area = -1;
  for (auto face = faces.begin(); face != faces.end(); ++face) {
    if (has(crumb, *face / 4) == has(crumb, grains.other_side(*face) / 4)) continue;
    if (const double face_area = grains.area(*face); face_area > area) {
      area = face_area;
      largest = face;
    }
  }
  return largest;
}

bool keep_one(const Grains& grains, std::vector<Index>& faces) {
  const std::vector<Index> opened = both_sides(grains, faces);
  for (Index side : opened) {
    const std::vector<Index> crumb = crumb_of(grains, side / 4, opened);
    if (crumb.empty()) continue;
    const auto face = largest_around(grains, crumb, faces);
    if (face == faces.end()) continue;  // it has hung on nothing before
    faces.erase(face);
    return true;
  }
  return false;
}

}  // namespace

Index keep_crumbs(const Grains& grains, std::vector<Index>& faces) {
  Index count = 0;
  while (keep_one(grains, faces)) ++count;
  return count;
}

}  // namespace lobe
