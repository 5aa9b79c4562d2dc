// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/label_grid.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "lobe/error.h"
#include "lobe/text.h"

namespace lobe::meshing {
namespace {

constexpr std::size_t most_labels = 250;
constexpr double most_smoothing = 5;             // voxels
constexpr double reported_volume_change = 0.05;  // of a label, by the smoothing
constexpr float smallest_margin = 1e-6F;

// A box of voxels, [first, last).
struct Box3 {
  std::array<Index, 3> first{}, last{};

  std::size_t size(int axis) const { return static_cast<std::size_t>(last[axis] - first[axis]); }
  std::size_t count() const { return size(0) * size(1) * size(2); }
  bool contains(const std::array<Index, 3>& voxel) const {
    bool inside = true;
    for (int k = 0; k < 3; ++k) inside = inside && voxel[k] >= first[k] && voxel[k] < last[k];
    return inside;
  }
  Box3 grown(Index by) const {
    Box3 box = *this;
    for (int k = 0; k < 3; ++k) box.first[k] -= by, box.last[k] += by;
    return box;
  }
  void add(const std::array<Index, 3>& voxel) {
    const bool is_first = count() == 0;
    for (int k = 0; k < 3; ++k) {
      first[k] = is_first ? voxel[k] : std::min(first[k], voxel[k]);
      last[k] = is_first ? voxel[k] + 1 : std::max(last[k], voxel[k] + 1);
    }
  }
};

template <class Visit>
void for_each_voxel(const Box3& box, const Visit& visit) {
  for (Index k = box.first[2]; k < box.last[2]; ++k)
    for (Index j = box.first[1]; j < box.last[1]; ++j)
      for (Index i = box.first[0]; i < box.last[0]; ++i) visit(i, j, k);
}

std::vector<float> gaussian(double sigma) {
  const int radius = static_cast<int>(std::ceil(3 * sigma));
  std::vector<float> kernel;
  double sum = 0;
  for (int i = -radius; i <= radius; ++i) sum += std::exp(-i * i / (2 * sigma * sigma));
  for (int i = -radius; i <= radius; ++i)
    kernel.push_back(static_cast<float>(std::exp(-i * i / (2 * sigma * sigma)) / sum));
  return kernel;
}

// Filters along each axis in turn. Values outside of the box count as zero.
std::vector<float> blurred(std::vector<float> values, const Box3& box, const std::vector<float>& kernel) {
  const auto radius = static_cast<std::ptrdiff_t>(kernel.size() / 2);
  std::vector<float> line;
  for (int axis = 0; axis < 3; ++axis) {
    const auto length = static_cast<std::ptrdiff_t>(box.size(axis));
    const std::size_t stride = axis == 0 ? 1 : axis == 1 ? box.size(0) : box.size(0) * box.size(1);
    line.resize(box.size(axis));
    for (std::size_t start = 0; start < values.size(); ++start) {
      if (start / stride % box.size(axis) != 0) continue;
      for (std::ptrdiff_t i = 0; i < length; ++i)
        line[i] = values[start + static_cast<std::size_t>(i) * stride];
      for (std::ptrdiff_t i = 0; i < length; ++i) {
        float sum = 0;
        for (std::ptrdiff_t d = std::max(-radius, -i); d <= std::min(radius, length - 1 - i); ++d)
          sum += kernel[static_cast<std::size_t>(d + radius)] * line[static_cast<std::size_t>(i + d)];
        values[start + static_cast<std::size_t>(i) * stride] = sum;
      }
    }
  }
  return values;
}

// The labels of an image, with the number of voxels and the box of each.
struct Contents {
  std::map<std::int32_t, std::size_t> counts;
  std::map<std::int32_t, Box3> boxes;
  Box3 all;
};

Contents contents_of(const LabelImage& image) {
  Contents contents;
  std::size_t n = 0;
  for_each_voxel({{}, image.size}, [&](Index i, Index j, Index k) {
    const std::int32_t value = image.values[n++];
    if (value < 0)
      throw InputError("label image", "the value " + std::to_string(value) + ": labels are 0 and above");
    ++contents.counts[value];
    if (contents.counts.size() > most_labels)
      throw InputError("label image", "more than 250 different values: it is not a segmentation");
    if (value == 0) return;
    contents.boxes[value].add({i, j, k});
    contents.all.add({i, j, k});
  });
  if (contents.counts.size() == 1) {
    const bool empty = contents.counts.begin()->first == 0;
    throw InputError("label image", empty ? "empty: every voxel is 0, the background"
                                          : "only one value: no background (0) around the labels");
  }
  return contents;
}

// A grid with room for all labels and for `pad` voxels around them.
LabelGrid empty_grid(const LabelImage& image, const Contents& contents, Index pad) {
  const Box3 box = contents.all.grown(pad);
  LabelGrid grid;
  grid.first = box.first;
  for (int k = 0; k < 3; ++k) grid.size[k] = static_cast<Index>(box.size(k));
  grid.regions.assign(box.count(), 0);
  grid.margins.assign(box.count(), 0);
  grid.to_world = image.to_world;
  for (int k = 0; k < 3; ++k) grid.to_world.col(3) += box.first[k] * image.to_world.col(k);
  return grid;
}

// The indicator of a value: 1 where the image has it, else 0. No voxel outside of `box` has the value.
std::vector<float> indicator(const LabelImage& image, std::int32_t value, const Box3& box,
                             const Box3& reached) {
  std::vector<float> result;
  result.reserve(reached.count());
  for_each_voxel(reached, [&](Index i, Index j, Index k) {
    result.push_back(box.contains({i, j, k}) && image.at(i, j, k) == value ? 1 : 0);
  });
  return result;
}

// φ of one region in its box.
std::vector<float> smoothed(std::vector<float> phi, const Box3& box, double smoothing) {
  if (smoothing == 0) return phi;
  const std::vector<float> kernel = gaussian(smoothing);
  phi = blurred(std::move(phi), box, kernel);
  const std::vector<float> twice = blurred(phi, box, kernel);
  constexpr auto root = static_cast<float>(std::numbers::sqrt2);
  for (std::size_t i = 0; i < twice.size(); ++i) phi[i] = (2 + root) * phi[i] - (1 + root) * twice[i];
  return phi;
}

// Updates the largest and the second largest φ of each voxel with those of one region.
class Contest {
 public:
  explicit Contest(LabelGrid& grid) : grid_(grid), best_(grid.regions.size(), -1), second_(best_) {}

  void enter(std::uint8_t region, float phi, std::size_t voxel) {
    if (phi > best_[voxel]) {
      second_[voxel] = best_[voxel];
      best_[voxel] = phi;
      grid_.regions[voxel] = region;
    } else {
      second_[voxel] = std::max(second_[voxel], phi);
    }
  }
  void close() {
    for (std::size_t v = 0; v < best_.size(); ++v)
      grid_.margins[v] = std::clamp(best_[v] - second_[v], smallest_margin, 1.0F);
  }

 private:
  LabelGrid& grid_;
  std::vector<float> best_, second_;
};

// How messages name the label of an image.
std::string name_of(const LabelImage& image, int value) {
  return image.is_of_surfaces ? "surface " + std::to_string(value - 1) : "label " + std::to_string(value);
}

// Volumes of the regions, and how much of them the smoothing leaves.
void measure_regions(const LabelImage& image, const Contents& contents, LabelGrid& grid) {
  std::vector<std::size_t> after(grid.values.size() + 1, 0);
  for (const std::uint8_t region : grid.regions) ++after[region];
  const double voxel = std::abs(image.to_world.leftCols<3>().determinant());  // [m³]
  for (std::size_t r = 0; r < grid.values.size(); ++r) {
    const int value = grid.values[r];
    const std::string label = name_of(image, value);
    grid.volumes.push_back(image.is_of_surfaces ? image.surface_volumes.at(std::size_t(value) - 1)
                                                : voxel * static_cast<double>(contents.counts.at(value)));
    grid.kept.push_back(voxel * static_cast<double>(after[r + 1]) / grid.volumes.back());
    const double change = grid.kept.back() - 1;
    if (after[r + 1] == 0 && !image.is_of_surfaces)
      throw InputError(label, "too thin: nothing of it is left by the smoothing; use --smoothing 0");
    if (std::abs(change) > reported_volume_change)
      grid.warnings.push_back((image.is_of_surfaces ? "the smoothed voxels change the volume of "
                                                    : "the smoothing changes the number of voxels of ") +
                              label + " by " + rounded(std::round(100 * change)) +
                              " %: " + (image.is_of_surfaces ? "choose a shorter --voxels, or " : "") +
                              "use a smaller --smoothing");
  }
}

}  // namespace

LabelGrid make_label_grid(const LabelImage& image, double smoothing) {
  if (!(smoothing >= 0 && smoothing <= most_smoothing))
    throw InputError("smoothing", rounded(smoothing) + ", expected 0 … 5 voxels");
  const Contents contents = contents_of(image);
  const auto reach = static_cast<Index>(2 * std::ceil(3 * smoothing));  // of G G
  LabelGrid grid = empty_grid(image, contents, reach + 2);
  std::vector<float> background(grid.regions.size(), 1);
  Contest contest(grid);
  for (const auto& [value, box] : contents.boxes) {
    const Box3 reached = box.grown(reach);
    const std::vector<float> phi = smoothed(indicator(image, value, box, reached), reached, smoothing);
    grid.values.push_back(value);
    std::size_t n = 0;
    for_each_voxel(reached, [&](Index i, Index j, Index k) {
      const std::size_t voxel = grid.index(i - grid.first[0], j - grid.first[1], k - grid.first[2]);
      background[voxel] -= phi[n];
      contest.enter(static_cast<std::uint8_t>(grid.values.size()), phi[n++], voxel);
    });
  }
  for (std::size_t v = 0; v < background.size(); ++v) contest.enter(0, background[v], v);
  contest.close();
  measure_regions(image, contents, grid);
  return grid;
}

RegionAt::RegionAt(const LabelGrid& grid) : grid_(grid) {
  const Mat3<double> inverse = grid.to_world.leftCols<3>().inverse();
  to_grid_ << inverse, -inverse * grid.to_world.col(3);
}

int RegionAt::operator()(const Vec3d& point) const {
  const Vec3d at = to_grid_.leftCols<3>() * point + to_grid_.col(3);
  std::array<Index, 3> corner{};
  for (int k = 0; k < 3; ++k) {
    if (!(at[k] >= 0 && at[k] < grid_.size[k] - 1)) return 0;
    corner[k] = static_cast<Index>(at[k]);
  }
  std::array<int, 8> regions{};
  std::array<double, 8> scores{};
  int count = 0;
  for (int c = 0; c < 8; ++c) {
    double weight = 1;
    for (int k = 0; k < 3; ++k) {
      const double part = at[k] - corner[k];
      weight *= (c >> k & 1) != 0 ? part : 1 - part;
    }
    const std::size_t voxel =
        grid_.index(corner[0] + (c & 1), corner[1] + (c >> 1 & 1), corner[2] + (c >> 2));
    int r = 0;
    while (r < count && regions[r] != grid_.regions[voxel]) ++r;
    if (r == count) regions[count++] = grid_.regions[voxel];
    scores[r] += weight * static_cast<double>(grid_.margins[voxel]);
  }
  return regions[std::max_element(scores.begin(), scores.begin() + count) - scores.begin()];
}

}  // namespace lobe::meshing
