#include "lobe/contact/touch_points.h"

#include "lobe/contact/quadrature.h"

namespace lobe {
namespace {

std::vector<PointBlock> make_blocks(int n) {
  constexpr int width = PointBlock::width;
  std::vector<PointBlock> blocks(std::size_t((n * n + width - 1) / width));
  const auto put = [&](int number, int along, int up, bool is_turned, const Vec3d& weights) {
    PointBlock& block = blocks[std::size_t(number / width)];
    block.lanes |= 1u << number % width;
    block.most_along = std::max(block.most_along, along);
    for (auto lane = std::size_t(number % width); lane < std::size_t(width); ++lane) {
      for (std::size_t c = 0; c < 3; ++c) block.weights[c][lane] = weights[int(c)];
      block.along[lane] = along;
      block.up[lane] = up;
      block.turned[lane] = is_turned;
    }
  };
  int up = 0;
  visit_centroids(n, [&](int number, const Vec3d& weights) {
    if (number == strip(n, up).end) ++up;
    const int along = number - strip(n, up).begin;
    put(number, along / 2, up, along % 2 == 1, weights);
  });
  return blocks;
}

}  // namespace

const std::vector<PointBlock>& point_blocks(int n) {
  static const std::array<std::vector<PointBlock>, most_divisions + 1> all = [] {
    std::array<std::vector<PointBlock>, most_divisions + 1> blocks;
    for (int i = 1; i <= most_divisions; ++i) blocks[std::size_t(i)] = make_blocks(i);
    return blocks;
  }();
  return all[std::size_t(n)];
}

}  // namespace lobe
