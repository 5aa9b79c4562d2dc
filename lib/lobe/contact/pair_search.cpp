#include "lobe/contact/pair_search.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace lobe {
namespace {

// In mean edges: how far the first search goes, and all others.
constexpr double first_within = 0.7, next_within = 1;

}  // namespace

void PairSearch::rebuild() {
  is_searched_ = false;
  within_ = first_within * rest_.mean_edge;
  points_ = rest_.points;
  parts_.set_parts(rest_.parts);
  scratch_.stamp.assign(rest_.boundary.tets().size(), -1);
}

void PairSearch::place(const Stations& stations, const Places& now) {
  stations.of_vertices(Stations::measured, now, points_.vertices[0], points_.vertices, points_.x.data());
  points_.find_between();
}

void PairSearch::place_at_rest() { points_.x = rest_.points.x; }

bool PairSearch::widen() {
  const double next = next_within * rest_.mean_edge;
  return std::exchange(within_, std::max(within_, next)) < next;
}

double PairSearch::room_for_others(double most) {
  parts_.measure(points_.x.data());
  double least = within_;
  for (Link& link : links_) {
    link.bound = parts_.bound(link.meeting);
    least = std::min(least, link.bound.now(within_));
  }
  const int count = parts_.count();
  const double far = rest_.near + most;
  const auto square = static_cast<float>(far * far);
  std::vector<float>& squares = scratch_.squares;
  for (int a = 0; a < count; ++a) {
    parts_.find_box_distances(a, squares);
    for (int b = a + 1; b < count; ++b) {
      using Eight = Eigen::Array<float, 8, 1>;
      while (b + 8 <= count && Eigen::Map<const Eight>(&squares[std::size_t(b)]).minCoeff() > square) b += 8;
      if (b == count || squares[std::size_t(b)] > square || link_of_[std::size_t(a * count + b)] >= 0)
        continue;
      least = std::min(least,
                       std::max(std::sqrt(double(squares[std::size_t(b)])), parts_.bound(a, b).now(within_)));
    }
  }
  return least - rest_.near;
}

std::size_t PairSearch::count_within(double gap) const {
  double share = 1, approach = 0;
  for (const Link& link : links_) {
    share = std::min(share, link.bound.share);
    approach = std::max(approach, link.bound.approach);
  }
  const auto safe = static_cast<float>((gap + approach) / share);
  const auto end = std::partition_point(ranked_.begin(), ranked_.end(),
                                        [&](int i) { return !(pairs_[std::size_t(i)].gap > safe); });
  return std::size_t(end - ranked_.begin());
}

// ---- Search

void PairSearch::search(const ContactSurface& surface, const ContactMemory& memory) {
  parts_.remember(points_.x.data());
  find_boxes();
  link_parts();
  find_pairs(surface, memory.all_anchors());
  take_candidates(surface);
  is_searched_ = true;
  ++number_;
}

void PairSearch::find_boxes() {
  scratch_.planes.resize(rest_.boundary.tets().size());
  scratch_.boxes.resize(rest_.fours.size());
  for (std::size_t f = 0; f < rest_.fours.size(); ++f) {
    const SelfRest::Four& four = rest_.fours[f];
    Boxes& boxes = scratch_.boxes[f];
    boxes.low[0] = boxes.low[1] = boxes.low[2] =
        Eigen::Array4f::Constant(std::numeric_limits<float>::infinity());
    boxes.high[0] = boxes.high[1] = boxes.high[2] = -boxes.low[0];
    for (int k = 0; k < 4 && four[k] >= 0; ++k) {
      const auto l = std::size_t(four[k]);
      Mat34<double> x;
      for (int c = 0; c < 4; ++c) x.col(c) = points_.at(rest_.places_of[l][c]);
      Planes& planes = scratch_.planes[l];
      find_planes(x, planes);
      for (int axis = 0; axis < 3; ++axis) {
        boxes.low[axis][k] = planes.x[axis].minCoeff();
        boxes.high[axis][k] = planes.x[axis].maxCoeff();
      }
    }
  }
}

// A face that is flat parts nothing.
void PairSearch::find_planes(const Mat34<double>& x, Planes& planes) {
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

void PairSearch::link_parts() {
  const int count = parts_.count();
  const auto square = static_cast<float>(within_ * within_ * 1.0001);
  link_of_.assign(std::size_t(count) * std::size_t(count), -1);
  links_.clear();
  for (int a = 0; a < count; ++a) {
    parts_.find_box_distances(a, scratch_.squares);
    for (int b = a; b < count; ++b) {
      if (b > a && scratch_.squares[std::size_t(b)] > square) continue;
      link_of_[std::size_t(a * count + b)] = link_of_[std::size_t(b * count + a)] =
          static_cast<int>(links_.size());
      links_.push_back({parts_.meeting(a, b, within_), {}});
    }
  }
}

// Anchors are in the order of the surface.
void PairSearch::find_pairs(const ContactSurface& surface, const std::vector<Anchor>& anchors) {
  scratch_.found.clear();
  std::fill(scratch_.stamp.begin(), scratch_.stamp.end(), -1);
  auto anchor = anchors.begin();
  for (std::size_t t = 0; t < surface.triangles().size(); ++t) {
    const std::size_t first = scratch_.found.size();
    find_pairs_of(surface, static_cast<int>(t));
    const FaceOwner& owner = surface.triangles()[t].owner;
    const std::pair own(owner.tet, owner.code);
    for (; anchor != anchors.end() && std::pair(anchor->tet, anchor->code) <= own; ++anchor)
      if (std::pair(anchor->tet, anchor->code) == own)
        find_held(static_cast<int>(t), anchor->divisions, first, anchor->in);
  }
}

// Adds a pair to those of its triangle, which begin at `first` and are in the order of points and layers. A
// tetrahedron that a cut has taken off the boundary holds nothing.
void PairSearch::find_held(int triangle, int divisions, std::size_t first, Index tet) {
  const int layer = rest_.boundary.number_of(tet);
  if (std::size_t(layer) == rest_.boundary.tets().size() || rest_.layer(layer).tet != tet ||
      scratch_.stamp[std::size_t(layer)] == triangle)
    return;
  const auto own = scratch_.found.begin() + long(first);
  const std::pair wanted(divisions, layer);
  const auto place =
      std::lower_bound(own, scratch_.found.end(), wanted,
                       [](const Found& found, const auto& key) { return found.place() < key; });
  if (place != scratch_.found.end() && place->place() == wanted)
    place->is_held = true;
  else
    scratch_.found.insert(place, {triangle, layer, std::numeric_limits<float>::lowest(), 0, divisions, true});
}

void PairSearch::find_pairs_of(const ContactSurface& surface, int triangle) {
  for (int layer : rest_.boundary.own_of(triangle)) scratch_.stamp[std::size_t(layer)] = triangle;
  Mat3<double> corners;
  for (int c = 0; c < 3; ++c) {
    const int point = surface.triangles()[std::size_t(triangle)].points[c];
    corners.col(c) = points_.at(rest_.place_of_point[std::size_t(point)]);
  }
  corners = outermost(corners);
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
  const int body = surface.triangles()[std::size_t(triangle)].body;
  const auto look_at = [&](int layer) {
    const int divisions = rest_.divisions(body, rest_.body_of[std::size_t(layer)]);
    if (divisions == 0) return;
    const Planes& planes = scratch_.planes[std::size_t(layer)];
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
    if (gap <= within) scratch_.found.push_back({triangle, layer, gap, face, divisions, false});
  };
  const std::size_t before = scratch_.found.size();
  const int count = parts_.count(), part = rest_.part_of_triangle[std::size_t(triangle)];
  for (int b = 0; b < count; ++b) {
    if (link_of_[std::size_t(part * count + b)] < 0 || !parts_.meets_box(b, low, high)) continue;
    const auto end = std::size_t(rest_.first_four[std::size_t(b) + 1]);
    for (auto f = std::size_t(rest_.first_four[std::size_t(b)]); f < end; ++f) {
      const Boxes& boxes = scratch_.boxes[f];
      Eigen::Array4f apart = (boxes.low[0] - to[0]).max(from[0] - boxes.high[0]);
      for (int axis = 1; axis < 3; ++axis)
        apart = apart.max(boxes.low[axis] - to[axis]).max(from[axis] - boxes.high[axis]);
      if (apart.minCoeff() > 0) continue;
      for (int k = 0; k < 4; ++k)
        if (const int layer = rest_.fours[f][k];
            apart[k] <= 0 && scratch_.stamp[std::size_t(layer)] != triangle)
          look_at(layer);
    }
  }
  std::sort(scratch_.found.begin() + long(before), scratch_.found.end(),
            [](const Found& a, const Found& b) { return a.place() < b.place(); });
}

// Of what was found, the pairs that are no farther than that from each other along the way between their
// centres, too.
void PairSearch::take_candidates(const ContactSurface& surface) {
  const std::vector<Found>& all = scratch_.found;
  blocks_.assign((all.size() + PairBlock::width - 1) / PairBlock::width, {});
  for (std::size_t k = 0; k < all.size(); ++k) {
    PairBlock& block = blocks_[k / PairBlock::width];
    const std::size_t lane = k % PairBlock::width;
    const auto& points = surface.triangles()[std::size_t(all[k].triangle)].points;
    for (int c = 0; c < 3; ++c)
      block.places[std::size_t(c)][lane] = rest_.place_of_point[std::size_t(points[c])];
    for (int c = 0; c < 4; ++c)
      block.places[std::size_t(3 + c)][lane] = rest_.places_of[std::size_t(all[k].layer)][c];
    const PairCorners corners = corners_in(points_, block, lane);
    set_normal(corners, corners.triangle.rowwise().mean() - corners.tet.rowwise().mean(), block, lane);
  }
  find_gaps(kernels_, points_, blocks_, all.size());
  candidates_.clear();
  pairs_.clear();
  std::vector<PairBlock> blocks;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Found& found = all[k];
    PairBlock& block = blocks_[k / PairBlock::width];
    const std::size_t lane = k % PairBlock::width;
    const float gap = block.gap[lane] - static_cast<float>(parts_.rounding());
    if (gap > static_cast<float>(within_) && !found.is_held) continue;
    if (!(gap > found.gap))  // the face parts them better
      for (int d = 0; d < 3; ++d)
        block.normal[std::size_t(d)][lane] = found.face == 0 ? 1.0F : found.face == d + 1 ? -1.0F : 0.0F;
    const std::size_t number = pairs_.size();
    take_pair(surface, found, gap);
    if (number % PairBlock::width == 0) blocks.emplace_back();
    copy_lane(block, lane, blocks.back(), number % PairBlock::width);
  }
  rank_pairs(blocks);
}

void PairSearch::take_pair(const ContactSurface& surface, const Found& found, float gap) {
  if (candidates_.empty() || candidates_.back().triangle != found.triangle ||
      candidates_.back().divisions != found.divisions)
    candidates_.push_back({.triangle = found.triangle,
                           .owner = surface.triangles()[std::size_t(found.triangle)].owner,
                           .divisions = found.divisions,
                           .first = static_cast<int>(pairs_.size())});
  ++candidates_.back().count;
  pairs_.push_back({.candidate = static_cast<int>(candidates_.size()) - 1,
                    .layer = found.layer,
                    .tet = rest_.layer(found.layer).tet,
                    .face = static_cast<std::uint8_t>(found.face),
                    .gap = gap > found.gap ? gap : found.gap});
}

void PairSearch::rank_pairs(const std::vector<PairBlock>& blocks) {
  constexpr std::size_t width = PairBlock::width;
  ranked_.resize(pairs_.size());
  std::iota(ranked_.begin(), ranked_.end(), 0);
  std::sort(ranked_.begin(), ranked_.end(), [&](int i, int j) {
    return std::pair(pairs_[std::size_t(i)].gap, i) < std::pair(pairs_[std::size_t(j)].gap, j);
  });
  blocks_.assign(blocks.size(), {});
  for (std::size_t k = 0; k < ranked_.size(); ++k) {
    const auto i = std::size_t(ranked_[k]);
    pairs_[i].rank = static_cast<int>(k);
    copy_lane(blocks[i / width], i % width, blocks_[k / width], k % width);
  }
}

}  // namespace lobe
