// Lists the triangles of a surface and the tetrahedra of its boundary layer that are near each other.
#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "lobe/contact/self_contact.h"

namespace lobe {

void SelfContact::search(const ContactSurface& surface) {
  parts_.remember(placed_.x.data());
  find_boxes();
  link_parts();
  find_pairs(surface);
  take_candidates(surface);
}

void SelfContact::find_boxes() {
  face_planes_.resize(boundary_.tets().size());
  for (Four& four : fours_) {
    four.low[0] = four.low[1] = four.low[2] =
        Eigen::Array4f::Constant(std::numeric_limits<float>::infinity());
    four.high[0] = four.high[1] = four.high[2] = -four.low[0];
    for (int k = 0; k < 4 && four.layers[k] >= 0; ++k) {
      const auto l = std::size_t(four.layers[k]);
      Mat34<double> x;
      for (int c = 0; c < 4; ++c) x.col(c) = placed_.at(places_of_[l][c]);
      find_planes(x, face_planes_[l]);
      for (int axis = 0; axis < 3; ++axis) {
        four.low[axis][k] = face_planes_[l].x[axis].minCoeff();
        four.high[axis][k] = face_planes_[l].x[axis].maxCoeff();
      }
    }
  }
}

// A face that is flat parts nothing.
void SelfContact::find_planes(const Mat34<double>& x, Planes& planes) {
  for (int axis = 0; axis < 3; ++axis) planes.x[axis] = x.row(axis).transpose().cast<float>().array();
  for (int c = 0; c < 4; ++c) {
    const Vec3d from = x.col((c + 1) % 4);
    Vec3d n = (x.col((c + 2) % 4) - from).cross(x.col((c + 3) % 4) - from);
    const double length = n.norm() * (n.dot(x.col(c) - from) < 0 ? 1 : -1);
    n = length != 0 ? Vec3d(n / length) : Vec3d::Zero();
    for (int axis = 0; axis < 3; ++axis) planes.n[axis][c] = static_cast<float>(n[axis]);
    planes.offset[c] = static_cast<float>(n.dot(from));
  }
}

void SelfContact::link_parts() {
  const int count = parts_.count();
  const auto square = static_cast<float>(within_ * within_ * 1.0001);
  link_of_.assign(std::size_t(count) * std::size_t(count), -1);
  links_.clear();
  for (int a = 0; a < count; ++a) {
    parts_.find_box_distances(a, squares_);
    for (int b = a; b < count; ++b) {
      if (b > a && squares_[std::size_t(b)] > square) continue;
      link_of_[std::size_t(a * count + b)] = link_of_[std::size_t(b * count + a)] =
          static_cast<int>(links_.size());
      links_.push_back({parts_.meeting(a, b, within_), {}});
    }
  }
}

void SelfContact::find_pairs(const ContactSurface& surface) {
  found_.clear();
  std::fill(stamp_of_layer_.begin(), stamp_of_layer_.end(), -1);
  for (std::size_t t = 0; t < surface.triangles().size(); ++t) find_pairs_of(surface, static_cast<int>(t));
}

Mat3<double> SelfContact::corners_placed(const ContactSurface& surface, int triangle) const {
  Mat3<double> x;
  for (int c = 0; c < 3; ++c)
    x.col(c) = placed_.at(place_of_point_[std::size_t(surface.triangles()[std::size_t(triangle)].points[c])]);
  return x;
}

void SelfContact::find_pairs_of(const ContactSurface& surface, int triangle) {
  for (int layer : boundary_.own_of(triangle)) stamp_of_layer_[std::size_t(layer)] = triangle;
  const Mat3<double> corners = outermost(corners_placed(surface, triangle));
  const Mat3<float> x = corners.cast<float>();
  const Vec3d across = (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0));
  const double length = across.norm();
  const Vec3<float> n = (length > 0 ? Vec3d(across / length) : Vec3d::Zero()).cast<float>();
  const auto rounding = static_cast<float>(parts_.rounding()), within = static_cast<float>(within_);
  const Vec3<float> low = x.rowwise().minCoeff().array() - (within + rounding),
                    high = x.rowwise().maxCoeff().array() + (within + rounding);
  Eigen::Array4f from[3], to[3];
  for (int axis = 0; axis < 3; ++axis) {
    from[axis].setConstant(low[axis]);
    to[axis].setConstant(high[axis]);
  }
  const auto look_at = [&](int layer) {
    const Planes& planes = face_planes_[std::size_t(layer)];
    Eigen::Array4f beyond;  // each face
    for (int c = 0; c < 3; ++c) {
      const Eigen::Array4f g =
          planes.n[0] * x(0, c) + planes.n[1] * x(1, c) + planes.n[2] * x(2, c) - planes.offset;
      beyond = c == 0 ? g : Eigen::Array4f(beyond.min(g));
    }
    int face;
    const float most = beyond.maxCoeff(&face);
    const Eigen::Array4f over =
        planes.x[0] * n[0] + planes.x[1] * n[1] + planes.x[2] * n[2] - n.dot(x.col(0));
    const float gap = std::max({most, over.minCoeff(), -over.maxCoeff()}) - rounding;
    if (gap <= within) found_.push_back({triangle, layer, gap, face});
  };
  const std::size_t before = found_.size();
  const int count = parts_.count(), part = part_of_triangle_[std::size_t(triangle)];
  for (int b = 0; b < count; ++b) {
    if (link_of_[std::size_t(part * count + b)] < 0 || !parts_.meets_box(b, low, high)) continue;
    for (int f = first_four_[std::size_t(b)]; f < first_four_[std::size_t(b) + 1]; ++f) {
      const Four& four = fours_[std::size_t(f)];
      Eigen::Array4f apart = (four.low[0] - to[0]).max(from[0] - four.high[0]);
      for (int axis = 1; axis < 3; ++axis)
        apart = apart.max(four.low[axis] - to[axis]).max(from[axis] - four.high[axis]);
      if (apart.minCoeff() > 0) continue;
      for (int k = 0; k < 4; ++k)
        if (apart[k] <= 0 && stamp_of_layer_[std::size_t(four.layers[k])] != triangle)
          look_at(four.layers[k]);
    }
  }
  std::sort(found_.begin() + long(before), found_.end(),
            [](const Found& a, const Found& b) { return a.layer < b.layer; });
}

// Of what was found, the pairs that are no farther than that from each other along the way between their
// centres, too.
void SelfContact::take_candidates(const ContactSurface& surface) {
  all_blocks_.assign((found_.size() + PairBlock::width - 1) / PairBlock::width, {});
  for (std::size_t k = 0; k < found_.size(); ++k) {
    PairBlock& block = all_blocks_[k / PairBlock::width];
    const std::size_t lane = k % PairBlock::width;
    const auto& points = surface.triangles()[std::size_t(found_[k].triangle)].points;
    for (int c = 0; c < 3; ++c) block.places[std::size_t(c)][lane] = place_of_point_[std::size_t(points[c])];
    for (int c = 0; c < 4; ++c)
      block.places[std::size_t(3 + c)][lane] = places_of_[std::size_t(found_[k].layer)][c];
    const PairPlaces places = places_in(block, lane);
    set_normal(places, places.triangle.rowwise().mean() - places.tet.rowwise().mean(), block, lane);
  }
  find_gaps(placed_, all_blocks_, found_.size());
  candidates_.clear();
  pairs_.clear();
  watched_.clear();
  held_pairs_.clear();
  std::vector<PairBlock> blocks;
  for (std::size_t k = 0; k < found_.size(); ++k) {
    const Found& found = found_[k];
    PairBlock& block = all_blocks_[k / PairBlock::width];
    const std::size_t lane = k % PairBlock::width;
    const float gap = block.gap[lane] - static_cast<float>(parts_.rounding());
    if (gap > static_cast<float>(within_)) continue;
    if (!(gap > found.gap))  // the face parts them better
      for (int d = 0; d < 3; ++d)
        block.normal[std::size_t(d)][lane] = found.face == 0 ? 1.0F : found.face == d + 1 ? -1.0F : 0.0F;
    if (candidates_.empty() || candidates_.back().triangle != found.triangle)
      candidates_.push_back({.triangle = found.triangle, .first = static_cast<int>(pairs_.size())});
    ++candidates_.back().count;
    const std::size_t number = pairs_.size();
    pairs_.push_back({.candidate = static_cast<int>(candidates_.size()) - 1,
                      .layer = found.layer,
                      .tet = layer_at(found.layer).tet,
                      .face = static_cast<std::uint8_t>(found.face),
                      .gap = gap > found.gap ? gap : found.gap});
    if (number % PairBlock::width == 0) blocks.emplace_back();
    copy_lane(block, lane, blocks.back(), number % PairBlock::width);
  }
  owners_.clear();
  for (const Candidate& candidate : candidates_)
    owners_.push_back(surface.triangles()[std::size_t(candidate.triangle)].owner);
  rank_pairs(blocks);
}

void SelfContact::copy_lane(const PairBlock& from, std::size_t lane, PairBlock& to, std::size_t at) {
  for (std::size_t c = 0; c < 7; ++c) to.places[c][at] = from.places[c][lane];
  for (std::size_t d = 0; d < 3; ++d) to.normal[d][at] = from.normal[d][lane];
}

void SelfContact::rank_pairs(const std::vector<PairBlock>& blocks) {
  constexpr std::size_t width = PairBlock::width;
  ranked_.resize(pairs_.size());
  std::iota(ranked_.begin(), ranked_.end(), 0);
  std::sort(ranked_.begin(), ranked_.end(), [&](int i, int j) {
    return std::pair(pairs_[std::size_t(i)].gap, i) < std::pair(pairs_[std::size_t(j)].gap, j);
  });
  all_blocks_.assign(blocks.size(), {});
  for (std::size_t k = 0; k < ranked_.size(); ++k) {
    const auto i = std::size_t(ranked_[k]);
    pairs_[i].rank = static_cast<int>(k);
    copy_lane(blocks[i / width], i % width, all_blocks_[k / width], k % width);
  }
}

}  // namespace lobe
