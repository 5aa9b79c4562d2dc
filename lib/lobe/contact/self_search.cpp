// Which triangles of a surface may be in which tetrahedra of its boundary layer.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lobe/contact/self_contact.h"
#include "lobe/cut/distance.h"

namespace lobe {
namespace {

// Pairs that are farther from each other than within_ are not known. If a search was not the last, the next
// goes that far, in mean edges, and about the body at rest: then a body that swings needs none after it.
constexpr double next_within = 1;
// A search is due when parts would have to be measured again after this share of the usual motion.
constexpr double least_time = 0.3;
constexpr double never = std::numeric_limits<double>::infinity();

}  // namespace

// ---- What may be near

void SelfContact::keep_pairs(const ContactSurface& surface, const Places& now, double moved) {
  if (moved <= knows_until_) return;
  const bool knows = std::isfinite(knows_until_);
  now.of_vertices(vertices_, x_);
  double room = 0;
  if (knows) {
    parts_.measure(x_);
    room = room_for_others();
  }
  if (knows && room < least_time * often_ && within_ < next_within * surface.mean_edge()) {
    within_ = next_within * surface.mean_edge();
    x_.swap(rest_x_);
    search(surface, moved);
    x_.swap(rest_x_);
    parts_.measure(x_);
    room = room_for_others();
  }
  if (room < least_time * often_) {
    search(surface, moved);
    room = (within_ - near_) / 2;
  }
  knows_until_ = moved + std::min(often_, room);
  find_due(moved);
}

// By how much vertices may move until a pair that is not known may be near.
double SelfContact::room_for_others() {
  double least = within_;
  for (Link& link : links_) {
    link.bound = parts_.bound(link.a, link.b);
    least = std::min(least, link.bound.now(within_));
  }
  const int count = parts_.count();
  const double far = near_ + 2 * often_;
  const auto square = static_cast<float>(far * far);
  for (int a = 0; a < count; ++a) {
    parts_.find_box_distances(a, squares_);
    for (int b = a + 1; b < count; ++b) {
      if (squares_[std::size_t(b)] > square || link_of_[std::size_t(a * count + b)] >= 0) continue;
      least = std::min(
          least, std::max(std::sqrt(double(squares_[std::size_t(b)])), parts_.bound(a, b).now(within_)));
    }
  }
  return (least - near_) / 2;
}

// Of pairs that cannot be near before the next measurement: never. What touches or is held stays.
void SelfContact::find_due(double moved) {
  const double needed = near_ + 2 * (knows_until_ - moved);
  worst_of_part_.assign(std::size_t(parts_.count()), {});
  for (const Link& link : links_)
    for (int part : {link.a, link.b}) {
      PartMotion::Bound& worst = worst_of_part_[std::size_t(part)];
      worst.share = std::min(worst.share, link.bound.share);
      worst.approach = std::max(worst.approach, link.bound.approach);
    }
  watched_.clear();
  suspects_.swap(last_suspects_);
  suspects_.clear();
  for (std::size_t c = 0; c < candidates_.size(); ++c) {
    Candidate& candidate = candidates_[c];
    const PartMotion::Bound& worst = worst_of_part_[std::size_t(candidate.part)];
    const auto safe = static_cast<float>((needed + worst.approach) / worst.share);
    if (candidate.suspects == 0 && candidate.gap > safe) continue;
    const auto first = static_cast<int>(suspects_.size());
    int i = candidate.first;
    for (; i < candidate.first + candidate.count && pairs_[std::size_t(i)].gap <= safe; ++i) {
      Pair& pair = pairs_[std::size_t(i)];
      const double gap = links_[std::size_t(pair.link)].bound.now(double(pair.gap));
      if (gap > needed) {
        if (pair.due > moved) pair.due = never;
      } else if (pair.due == never) {
        pair.due = moved + std::max(0.0, gap - near_) / 2;
      }
      if (pair.due != never) suspects_.push_back(i);
    }
    for (int k = candidate.first_suspect; k < candidate.first_suspect + candidate.suspects; ++k) {
      const int last = last_suspects_[std::size_t(k)];
      if (last < i) continue;
      double& due = pairs_[std::size_t(last)].due;
      if (due > moved) due = never;
      if (due != never) suspects_.push_back(last);
    }
    candidate.first_suspect = first;
    candidate.suspects = static_cast<int>(suspects_.size()) - first;
    if (candidate.suspects == 0) continue;
    candidate.due = never;
    for (int k : suspects_of(candidate)) candidate.due = std::min(candidate.due, pairs_[std::size_t(k)].due);
    std::sort(suspects_.begin() + first, suspects_.end(),
              [&](int k, int l) { return pairs_[std::size_t(k)].layer < pairs_[std::size_t(l)].layer; });
    watched_.push_back(static_cast<int>(c));
  }
}

// ---- Search

void SelfContact::search(const ContactSurface& surface, double moved) {
  parts_.remember(x_);
  find_boxes();
  link_parts();
  find_pairs(surface);
  take_candidates(surface, moved);
}

void SelfContact::find_boxes() {
  origin_ = x_.cols() > 0 ? Vec3d(x_.col(0)) : Vec3d::Zero();
  face_planes_.resize(layers_.size());
  for (Four& four : fours_) {
    four.low[0] = four.low[1] = four.low[2] =
        Eigen::Array4f::Constant(std::numeric_limits<float>::infinity());
    four.high[0] = four.high[1] = four.high[2] = -four.low[0];
    for (int k = 0; k < 4 && four.layers[k] >= 0; ++k) {
      const auto l = std::size_t(four.layers[k]);
      Mat34<double> x = x_(Eigen::all, places_of_[l]);
      x.colwise() -= origin_;
      find_planes(x, face_planes_[l]);
      for (int axis = 0; axis < 3; ++axis) {
        four.low[axis][k] = face_planes_[l].x[axis].minCoeff();
        four.high[axis][k] = face_planes_[l].x[axis].maxCoeff();
      }
    }
  }
}

// About origin_. A face that is flat parts nothing.
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
      links_.push_back({a, b, {}});
    }
  }
}

void SelfContact::find_pairs(const ContactSurface& surface) {
  found_.clear();
  std::fill(stamp_of_layer_.begin(), stamp_of_layer_.end(), -1);
  for (std::size_t t = 0; t < surface.triangles().size(); ++t) find_pairs_of(surface, static_cast<int>(t));
}

void SelfContact::find_pairs_of(const ContactSurface& surface, int triangle) {
  for (int i = first_own_[std::size_t(triangle)]; i < first_own_[std::size_t(triangle) + 1]; ++i)
    stamp_of_layer_[std::size_t(own_[std::size_t(i)])] = triangle;
  const Mat3<double> corners = outermost(corners_now(surface, triangle)).colwise() - origin_;
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
  const auto look = [&](int layer, int link) {
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
    if (gap <= within) found_.push_back({triangle, layer, link, gap, face});
  };
  const std::size_t before = found_.size();
  const int count = parts_.count(), part = part_of_triangle_[std::size_t(triangle)];
  for (int b = 0; b < count; ++b) {
    const int link = link_of_[std::size_t(part * count + b)];
    if (link < 0 || !parts_.meets_box(b, low, high)) continue;
    for (int f = first_four_[std::size_t(b)]; f < first_four_[std::size_t(b) + 1]; ++f) {
      const Four& four = fours_[std::size_t(f)];
      Eigen::Array4f apart = (four.low[0] - to[0]).max(from[0] - four.high[0]);
      for (int axis = 1; axis < 3; ++axis)
        apart = apart.max(four.low[axis] - to[axis]).max(from[axis] - four.high[axis]);
      if (apart.minCoeff() > 0) continue;
      for (int k = 0; k < 4; ++k)
        if (apart[k] <= 0 && stamp_of_layer_[std::size_t(four.layers[k])] != triangle)
          look(four.layers[k], link);
    }
  }
  std::sort(found_.begin() + long(before), found_.end(), [](const Found& a, const Found& b) {
    return std::pair(a.gap, a.layer) < std::pair(b.gap, b.layer);
  });
}

// Triangles of which a point is held are looked at in any case.
void SelfContact::take_candidates(const ContactSurface& surface, double moved) {
  candidates_.clear();
  pairs_.clear();
  suspects_.clear();
  auto anchor = memory_.all_anchors().begin();
  bool is_held = false;
  for (const Found& found : found_) {
    if (candidates_.empty() || candidates_.back().triangle != found.triangle) {
      candidates_.push_back({.triangle = found.triangle,
                             .part = part_of_triangle_[std::size_t(found.triangle)],
                             .first = static_cast<int>(pairs_.size())});
      const FaceOwner& owner = surface.triangles()[std::size_t(found.triangle)].owner;
      const std::pair own(owner.tet, owner.code);
      while (anchor != memory_.all_anchors().end() && std::pair(anchor->tet, anchor->code) < own) ++anchor;
      is_held = anchor != memory_.all_anchors().end() && std::pair(anchor->tet, anchor->code) == own;
    }
    pairs_.push_back(
        {found.layer, found.link, found.gap, static_cast<std::uint8_t>(found.face), is_held ? moved : never});
    Candidate& candidate = candidates_.back();
    ++candidate.count;
    candidate.gap = std::min(candidate.gap, found.gap);
    if (!is_held) continue;
    suspects_.push_back(static_cast<int>(pairs_.size()) - 1);
    if (candidate.suspects++ == 0) candidate.first_suspect = static_cast<int>(suspects_.size()) - 1;
  }
  gaps_.resize(pairs_.size());
}

}  // namespace lobe
