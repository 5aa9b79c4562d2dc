#include "lobe/contact/pair_search.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace lobe {
namespace {

// In reaches of two bodies: how far the first search goes, and all others.
constexpr double first_far = 0.7, next_far = 1;
// Links of which less than this share of the radius is known are looked at again.
constexpr double least_known = 0.6;

// Numbers in the order of floats.
std::uint64_t ordered(float value) {
  constexpr std::uint32_t sign = 0x80000000;
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return bits & sign ? ~bits : bits | sign;
}

}  // namespace

void PairSearch::rebuild() {
  is_searched_ = false;
  is_all_due_ = true;
  far_ = first_far;
  within_ = 0;
  listed_ = {};
  links_.clear();
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
  if (std::exchange(far_, next_far) == next_far) return false;
  is_all_due_ = true;
  return true;
}

double PairSearch::room_for_others(double most) {
  find_known();
  const double far = rest_.near + most;
  double least = far;
  for (const Link& link : links_) least = std::min(least, link.bound.now(link.within));
  const int count = parts_.count();
  const auto square = static_cast<float>(far * far);
  std::vector<float>& squares = scratch_.squares;
  for (int a = 0; a < count; ++a) {
    parts_.find_box_distances(a, squares);
    for (int b = a + 1; b < count; ++b) {
      using Eight = Eigen::Array<float, 8, 1>;
      while (b + 8 <= count && Eigen::Map<const Eight>(&squares[std::size_t(b)]).minCoeff() > square) b += 8;
      if (b == count || squares[std::size_t(b)] > square || link_of_[std::size_t(a * count + b)] >= 0)
        continue;
      const double then = radius(body_of_part(a), body_of_part(b));
      least =
          std::min(least, std::max(std::sqrt(double(squares[std::size_t(b)])), parts_.bound(a, b).now(then)));
    }
  }
  return least - rest_.near;
}

// Of each link, by the motion of parts until now.
void PairSearch::find_known() {
  parts_.measure(points_.x.data());
  for (Link& link : links_) link.bound = parts_.bound(link.meeting);
}

std::size_t PairSearch::count_within(double gap) const {
  double share = 1, approach = 0;
  for (const Link& link : links_) {
    share = std::min(share, link.bound.share);
    approach = std::max(approach, link.bound.approach);
  }
  const auto safe = static_cast<float>((gap + approach) / share);
  const auto end = std::partition_point(ranked_.begin(), ranked_.end(),
                                        [&](int i) { return !(pairs()[std::size_t(i)].gap > safe); });
  return std::size_t(end - ranked_.begin());
}

// ---- Search

void PairSearch::search(const ContactSurface& surface, const ContactMemory& memory) {
  if (!is_all_due_) find_known();
  parts_.remember(points_.x.data());
  link_parts();
  find_boxes();
  find_pairs(surface, memory.all_anchors());
  take_candidates(surface);
  is_searched_ = true;
  is_all_due_ = false;
  ++number_;
}

void PairSearch::link_parts() {
  const int count = parts_.count();
  scratch_.links.swap(links_);
  scratch_.link_of.swap(link_of_);
  links_.clear();
  link_of_.assign(std::size_t(count) * std::size_t(count), -1);
  scratch_.has_due.assign(std::size_t(count), 0);
  within_ = far_ * rest_.least_reach();
  for (int a = 0; a < count; ++a) {
    parts_.find_box_distances(a, scratch_.squares);
    for (int b = a; b < count; ++b) {
      const double most = radius(body_of_part(a), body_of_part(b));
      if (b > a && scratch_.squares[std::size_t(b)] > static_cast<float>(most * most * 1.0001)) continue;
      link(a, b);
    }
  }
}

// Two parts. Pairs that their last link did not list are no nearer than its bound.
void PairSearch::link(int a, int b) {
  const auto count = std::size_t(parts_.count());
  const double most = radius(body_of_part(a), body_of_part(b));
  const int last = is_all_due_ ? -1 : scratch_.link_of[std::size_t(a) * count + std::size_t(b)];
  double known = 0;
  if (last >= 0) {
    const Link& before = scratch_.links[std::size_t(last)];
    known = std::min(most, before.bound.now(before.within));
  }
  const bool is_due = !(known >= least_known * most);
  if (is_due) known = most;
  within_ = std::min(within_, known);
  for (int part : {a, b})
    if (is_due) scratch_.has_due[std::size_t(part)] = 1;
  link_of_[std::size_t(a) * count + std::size_t(b)] = link_of_[std::size_t(b) * count + std::size_t(a)] =
      static_cast<int>(links_.size());
  links_.push_back({parts_.meeting(a, b, known), {}, known, is_due});
}

void PairSearch::find_boxes() {
  scratch_.planes.resize(rest_.boundary.tets().size());
  scratch_.boxes.resize(rest_.fours.size());
  for (std::size_t part = 0; part < scratch_.has_due.size(); ++part) {
    if (!scratch_.has_due[part]) continue;
    const auto end = std::size_t(rest_.first_four[part + 1]);
    for (auto f = std::size_t(rest_.first_four[part]); f < end; ++f) find_boxes_of(f);
  }
}

void PairSearch::find_boxes_of(std::size_t number) {
  const SelfRest::Four& four = rest_.fours[number];
  Boxes& boxes = scratch_.boxes[number];
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

// Anchors are in the order of the surface.
void PairSearch::find_pairs(const ContactSurface& surface, const std::vector<Anchor>& anchors) {
  scratch_.found.clear();
  std::fill(scratch_.stamp.begin(), scratch_.stamp.end(), -1);
  auto anchor = anchors.begin();
  std::swap(scratch_.before, listed_);
  if (is_all_due_) scratch_.before = {};
  std::size_t candidate = 0;
  for (std::size_t t = 0; t < surface.triangles().size(); ++t) {
    const std::size_t first = scratch_.found.size();
    for (int layer : rest_.boundary.own_of(static_cast<int>(t)))
      scratch_.stamp[std::size_t(layer)] = static_cast<int>(t);
    keep_pairs_of(static_cast<int>(t), candidate);
    if (scratch_.has_due[std::size_t(rest_.part_of_triangle[t])]) find_pairs_of(surface, static_cast<int>(t));
    std::sort(scratch_.found.begin() + long(first), scratch_.found.end(),
              [](const Found& a, const Found& b) { return a.place() < b.place(); });
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

// Of the pairs before: those in links that are not due. `candidate` is the first of this triangle, then the
// first of the next one.
void PairSearch::keep_pairs_of(int triangle, std::size_t& candidate) {
  const Listed& before = scratch_.before;
  const auto first_link =
      std::size_t(rest_.part_of_triangle[std::size_t(triangle)]) * std::size_t(parts_.count());
  for (; candidate < before.candidates.size() && before.candidates[candidate].triangle == triangle;
       ++candidate) {
    const Candidate& own = before.candidates[candidate];
    for (int i = own.first; i < own.first + own.count; ++i) {
      const Pair& pair = before.pairs[std::size_t(i)];
      const int link = link_of_[first_link + std::size_t(rest_.part_of_layer[std::size_t(pair.layer)])];
      if (link < 0 || links_[std::size_t(link)].is_due) continue;
      scratch_.found.push_back(
          {triangle, pair.layer, std::numeric_limits<float>::lowest(), pair.face, own.divisions, false, i});
    }
  }
}

void PairSearch::find_pairs_of(const ContactSurface& surface, int triangle) {
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
  const auto rounding = static_cast<float>(parts_.rounding());
  const Vec3<float> least = x.rowwise().minCoeff(), most = x.rowwise().maxCoeff();
  const int body = surface.triangles()[std::size_t(triangle)].body;
  const auto look_at = [&](int layer, int divisions, float within) {
    const Planes& planes = scratch_.planes[std::size_t(layer)];
    Eigen::Array4f beyond;  // each face
    for (int c = 0; c < 3; ++c) {
      const Eigen::Array4f g =
          planes.n[0] * x(0, c) + planes.n[1] * x(1, c) + planes.n[2] * x(2, c) - planes.offset;
      beyond = c == 0 ? g : Eigen::Array4f(beyond.min(g));
    }
    int face;
    const float farthest = beyond.maxCoeff(&face);
    const Eigen::Array4f over =
        planes.x[0] * n[0] + planes.x[1] * n[1] + planes.x[2] * n[2] - n.dot(x.col(0));
    const float gap = std::max({farthest, over.minCoeff(), -over.maxCoeff()}) - rounding;
    if (gap <= within) scratch_.found.push_back({triangle, layer, gap, face, divisions});
  };
  const int count = parts_.count(), part = rest_.part_of_triangle[std::size_t(triangle)];
  for (int b = 0; b < count; ++b) {
    const int link = link_of_[std::size_t(part * count + b)];
    if (link < 0 || !links_[std::size_t(link)].is_due) continue;
    const int divisions = rest_.divisions(body, body_of_part(b));
    if (divisions == 0) continue;
    const auto within = static_cast<float>(radius(body, body_of_part(b)));
    const Vec3<float> low = least.array() - (within + rounding), high = most.array() + (within + rounding);
    if (!parts_.meets_box(b, low, high)) continue;
    const auto end = std::size_t(rest_.first_four[std::size_t(b) + 1]);
    for (auto f = std::size_t(rest_.first_four[std::size_t(b)]); f < end; ++f) {
      const Boxes& boxes = scratch_.boxes[f];
      Eigen::Array4f apart = (boxes.low[0] - high[0]).max(low[0] - boxes.high[0]);
      for (int axis = 1; axis < 3; ++axis)
        apart = apart.max(boxes.low[axis] - high[axis]).max(low[axis] - boxes.high[axis]);
      if (apart.minCoeff() > 0) continue;
      for (int k = 0; k < 4; ++k)
        if (const int layer = rest_.fours[f][k];
            apart[k] <= 0 && scratch_.stamp[std::size_t(layer)] != triangle)
          look_at(layer, divisions, within);
    }
  }
}

// The pair has the normal that it had, or the way between the two centres.
void PairSearch::fill_block(const ContactSurface& surface, std::size_t number) {
  const Found& found = scratch_.found[number];
  PairBlock& block = scratch_.blocks[number / PairBlock::width];
  const std::size_t lane = number % PairBlock::width;
  if (found.before >= 0) {
    const auto rank = std::size_t(scratch_.before.pairs[std::size_t(found.before)].rank);
    copy_lane(blocks_[rank / PairBlock::width], rank % PairBlock::width, block, lane);
    return;
  }
  const auto& points = surface.triangles()[std::size_t(found.triangle)].points;
  for (int c = 0; c < 3; ++c)
    block.places[std::size_t(c)][lane] = rest_.place_of_point[std::size_t(points[c])];
  for (int c = 0; c < 4; ++c)
    block.places[std::size_t(3 + c)][lane] = rest_.places_of[std::size_t(found.layer)][c];
  const PairCorners corners = corners_in(points_, block, lane);
  set_normal(corners, corners.triangle.rowwise().mean() - corners.tet.rowwise().mean(), block, lane);
}

// Of what was found, the pairs that are no farther than the radius from each other along their normals, too.
void PairSearch::take_candidates(const ContactSurface& surface) {
  const std::vector<Found>& all = scratch_.found;
  scratch_.blocks.assign((all.size() + PairBlock::width - 1) / PairBlock::width, {});
  for (std::size_t k = 0; k < all.size(); ++k) fill_block(surface, k);
  find_gaps(kernels_, points_, scratch_.blocks, all.size());
  listed_.candidates.clear();
  listed_.pairs.clear();
  before_.clear();
  scratch_.found_of.clear();
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Found& found = all[k];
    PairBlock& block = scratch_.blocks[k / PairBlock::width];
    const std::size_t lane = k % PairBlock::width;
    const float gap = block.gap[lane] - static_cast<float>(parts_.rounding());
    const int own = surface.triangles()[std::size_t(found.triangle)].body,
              other = rest_.body_of[std::size_t(found.layer)];
    if (gap > static_cast<float>(radius(own, other)) && !found.is_held) continue;
    if (!(gap > found.gap))  // the face parts them better
      for (int d = 0; d < 3; ++d)
        block.normal[std::size_t(d)][lane] = found.face == 0 ? 1.0F : found.face == d + 1 ? -1.0F : 0.0F;
    take_pair(surface, found, gap);
    scratch_.found_of.push_back(static_cast<int>(k));
  }
  rank_pairs();
}

// Beyond what its link knows, bounds of the motion of parts say nothing of a pair but that.
void PairSearch::take_pair(const ContactSurface& surface, const Found& found, float gap) {
  std::vector<Candidate>& candidates = listed_.candidates;
  if (candidates.empty() || candidates.back().triangle != found.triangle ||
      candidates.back().divisions != found.divisions)
    candidates.push_back({.triangle = found.triangle,
                          .owner = surface.triangles()[std::size_t(found.triangle)].owner,
                          .divisions = found.divisions,
                          .first = static_cast<int>(listed_.pairs.size())});
  ++candidates.back().count;
  const int link = link_of_[std::size_t(rest_.part_of_triangle[std::size_t(found.triangle)] * parts_.count() +
                                        rest_.part_of_layer[std::size_t(found.layer)])];
  const float known =
      link < 0 ? std::numeric_limits<float>::lowest() : static_cast<float>(links_[std::size_t(link)].within);
  listed_.pairs.push_back({.candidate = static_cast<int>(candidates.size()) - 1,
                           .layer = found.layer,
                           .tet = rest_.layer(found.layer).tet,
                           .face = static_cast<std::uint8_t>(found.face),
                           .gap = std::min(known, gap > found.gap ? gap : found.gap)});
  before_.push_back(found.before);
}

void PairSearch::rank_pairs() {
  constexpr std::size_t width = PairBlock::width;
  std::vector<Pair>& pairs = listed_.pairs;
  std::vector<std::uint64_t>& keys = scratch_.keys;
  keys.clear();
  for (std::size_t i = 0; i < pairs.size(); ++i) keys.push_back(ordered(pairs[i].gap) << 32U | i);
  std::sort(keys.begin(), keys.end());
  ranked_.resize(pairs.size());
  blocks_.assign((pairs.size() + width - 1) / width, {});
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const auto i = std::size_t(keys[k] & 0xffffffffU);
    ranked_[k] = static_cast<int>(i);
    pairs[i].rank = static_cast<int>(k);
    const auto from = std::size_t(scratch_.found_of[i]);
    copy_lane(scratch_.blocks[from / width], from % width, blocks_[k / width], k % width);
  }
}

}  // namespace lobe
