// Which triangles of a surface may be in which tetrahedra of its boundary layer.
//
// A search (self_search.cpp) lists the pairs that are near each other. That pairs which it does not list
// stay apart follows from the motion of parts of the body (part_motion.h). From time to time the body is
// measured: its parts, and the gaps of the pairs of the list (gap_kernels.h). Both are measured not where
// the body is, but where it will be at its present velocities half of the time until the next measurement.
// At all times between the two, no gap is smaller than there by more than the largest displacement of any
// two vertices relative to each other. A bound of that is how far vertices have moved in all steps; if that
// does not suffice, it is found in one pass over all vertices.
//
// Pairs whose gap is larger than all the way to the next measurement are left alone until then. The others
// are watched: every few steps one looks at them in the same manner, with less way to the next look. Those
// whose gap is smaller even than that are the ones in which each step seeks points of triangles.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lobe/contact/convex_gap.h"
#include "lobe/contact/self_contact.h"

namespace lobe {
namespace {

enum Station { measured, looked };

// Pairs that are farther from each other than within_ are not known. If a search was not the last, the next
// goes that far, in mean edges, and about the body at rest: then a body that swings needs none after it.
constexpr double next_within = 1;
// A search is due when there is less room than this share of the most.
constexpr double least_room_share = 0.3;
// A station is where the body will be after this share of the room, or after so many steps.
constexpr double share_ahead = 0.6, steps_ahead = 16;

}  // namespace

// ---- What may be near

void SelfContact::keep_pairs(const At& at) {
  if (vertices_.empty()) return;
  if (is_measured_ && range_ + 2 * (at.moved - moved_) <= look_room_) return;
  if (is_measured_) {
    range_ = at.places.range_since(looked);
    moved_ = at.moved;
    if (range_ <= look_room_ || look(at)) return;
  }
  const double speed = at.places.range_of_speeds();
  measure(at, speed > 0 ? std::min(steps_ahead * at.since, share_ahead * most_room_ / speed) : 0);
  if (look(at)) return;
  measure(at, 0);
  look(at);
}

// Where the body will be `ahead`. False: pairs that are not listed may be near.
bool SelfContact::find_room(const At& at, double ahead) {
  at.places.set_station(measured, ahead);
  find_places(at, measured, placed_);
  room_ = 0;
  if (!is_searched_) return false;
  parts_.measure(placed_.x.data());
  room_ = std::min(most_room_, room_for_others());
  return room_ >= least_room_share * most_room_;
}

void SelfContact::measure(const At& at, double ahead) {
  close_.clear();
  close_ones_.clear();
  bool has_room = find_room(at, ahead);
  if (!has_room && is_searched_ && within_ < next_within * at.surface.mean_edge()) {
    within_ = next_within * at.surface.mean_edge();
    placed_.x = rest_x_;
    placed_.find_between();
    search(at.surface);
    has_room = find_room(at, ahead);
  }
  if (!has_room) {
    search(at.surface);
    is_searched_ = true;
    room_ = std::min(most_room_, within_ - near_);
  }
  find_watched(at);
  is_measured_ = true;
  is_tuned_ = false;
}

// By how much pairs may come nearer until one that is not listed may be near.
double SelfContact::room_for_others() {
  double least = within_;
  for (Link& link : links_) {
    link.bound = parts_.bound(link.meeting);
    least = std::min(least, link.bound.now(within_));
  }
  const int count = parts_.count();
  const double far = near_ + most_room_;
  const auto square = static_cast<float>(far * far);
  for (int a = 0; a < count; ++a) {
    parts_.find_box_distances(a, squares_);
    for (int b = a + 1; b < count; ++b) {
      using Eight = Eigen::Array<float, 8, 1>;
      while (b + 8 <= count && Eigen::Map<const Eight>(&squares_[std::size_t(b)]).minCoeff() > square) b += 8;
      if (b == count || squares_[std::size_t(b)] > square || link_of_[std::size_t(a * count + b)] >= 0)
        continue;
      least = std::min(
          least, std::max(std::sqrt(double(squares_[std::size_t(b)])), parts_.bound(a, b).now(within_)));
    }
  }
  return least - near_;
}

// ---- Gaps

void SelfContact::find_places(const At& at, int station, Placed& placed) const {
  at.places.of_vertices_there(station, vertices_[0], placed.vertices, placed.x.data());
  placed.find_between();
}

void SelfContact::Placed::find_between() {
  float* to = x.data() + 4 * vertices.size();
  for (const Between& own : between) {
    for (int d = 0; d < 3; ++d) {
      to[d] = 0;
      for (int c = 0; c < 4; ++c) to[d] += own.weights[c] * x[std::size_t(4 * own.of[c] + d)];
    }
    to += 4;
  }
}

// The places of a pair in a block, and its normal along a way in the world.
SelfContact::PairPlaces SelfContact::places_in(const PairBlock& block, std::size_t lane) const {
  PairPlaces found;
  for (int c = 0; c < 7; ++c) {
    const Vec3d x = placed_.at(block.places[std::size_t(c)][lane]);
    if (c < 3)
      found.triangle.col(c) = x;
    else
      found.tet.col(c - 3) = x;
  }
  return found;
}

void SelfContact::set_normal(const PairPlaces& places, const Vec3d& way, PairBlock& block, std::size_t lane) {
  const Vec3d normal = (places.tet.rightCols<3>().colwise() - places.tet.col(0)).transpose() * way;
  const double length = normal.norm();
  if (!(length > 0) || !std::isfinite(length)) return;
  for (int d = 0; d < 3; ++d) block.normal[std::size_t(d)][lane] = static_cast<float>(normal[d] / length);
}

void SelfContact::find_gaps(const Placed& placed, std::vector<PairBlock>& blocks, std::size_t pairs) const {
  const std::size_t width = PairBlock::width;
  kernels_.find_gaps(placed.x.data(), 1 - 1.0F / divisions, blocks.data(), int((pairs + width - 1) / width));
}

// Which places those of watched pairs are, and numbers them anew in their blocks.
void SelfContact::place_watched() {
  Placed& own = watched_placed_;
  own.vertices.clear();
  own.between.clear();
  std::vector<int> between;  // that are used, as places
  const auto vertices = static_cast<int>(vertices_.size());
  const auto use = [&](int vertex) {
    int& place = watched_place_of_[std::size_t(vertex)];
    if (place >= 0) return place;
    place = static_cast<int>(own.vertices.size());
    own.vertices.push_back(vertices_[std::size_t(vertex)]);
    used_places_.push_back(vertex);
    return place;
  };
  used_places_.clear();
  for (std::size_t k = 0; k < watched_.size(); ++k)
    for (std::size_t c = 0; c < 7; ++c) {
      const int place = watched_blocks_[k / PairBlock::width].places[c][k % PairBlock::width];
      if (place < vertices)
        use(place);
      else if (std::exchange(watched_place_of_[std::size_t(place)], 0) < 0)
        between.push_back(place);
    }
  for (int place : between) {
    Placed::Between corners = placed_.between[std::size_t(place - vertices)];
    for (int& corner : corners.of) corner = use(corner);
    own.between.push_back(corners);
  }
  for (std::size_t i = 0; i < between.size(); ++i)
    watched_place_of_[std::size_t(between[i])] = static_cast<int>(own.vertices.size() + i);
  own.fit();
  for (std::size_t k = 0; k < watched_.size(); ++k)
    for (std::size_t c = 0; c < 7; ++c) {
      int& place = watched_blocks_[k / PairBlock::width].places[c][k % PairBlock::width];
      place = watched_place_of_[std::size_t(place)];
    }
  for (const auto* list : {&used_places_, &between})
    for (int place : *list) watched_place_of_[std::size_t(place)] = -1;
}

// Of which pairs a point is held. Anchors and candidates are both in the order of the surface.
void SelfContact::mark_held(const ContactSurface& surface) {
  for (int i : held_pairs_) pairs_[std::size_t(i)].is_held = false;
  held_pairs_.clear();
  auto candidate = candidates_.begin();
  Index last = -1;
  for (const Anchor& anchor : memory_.all_anchors()) {
    const std::pair own(anchor.tet, anchor.code);
    const auto owner = [&] {
      const FaceOwner& found = surface.triangles()[std::size_t(candidate->triangle)].owner;
      return std::pair(found.tet, found.code);
    };
    while (candidate != candidates_.end() && owner() < own) {
      ++candidate;
      last = -1;
    }
    if (candidate == candidates_.end()) return;
    if (owner() != own || anchor.in == last) continue;
    last = anchor.in;
    for (int i = candidate->first; i < candidate->first + candidate->count; ++i) {
      Pair& pair = pairs_[std::size_t(i)];
      if (layers_[std::size_t(pair.layer)].tet != anchor.in || pair.is_held) continue;
      pair.is_held = true;
      held_pairs_.push_back(i);
    }
  }
}

// Pairs that may be near before the next measurement, and those of which a point is held.
void SelfContact::find_watched(const At& at) {
  const double needed = near_ + room_ + parts_.rounding();
  const std::size_t some = pairs_that_may_be_within(needed);
  find_gaps(placed_, all_blocks_, some);
  mark_held(at.surface);
  for (int i : watched_) pairs_[std::size_t(i)].was_watched = true;
  last_watched_.swap(watched_);
  watched_.clear();
  for (std::size_t k = 0; k < some; ++k) {
    const int number = ranked_[k];
    const Pair& pair = pairs_[std::size_t(number)];
    if (!pair.is_held && is_within(static_cast<float>(needed), k, !pair.was_watched))
      watched_.push_back(number);
  }
  for (int i : last_watched_) pairs_[std::size_t(i)].was_watched = false;
  watched_.insert(watched_.end(), held_pairs_.begin(), held_pairs_.end());
  std::sort(watched_.begin(), watched_.end(), [&](int i, int j) {
    const Pair &a = pairs_[std::size_t(i)], &b = pairs_[std::size_t(j)];
    return std::pair(a.candidate, a.layer) < std::pair(b.candidate, b.layer);
  });
  watched_blocks_.assign((watched_.size() + PairBlock::width - 1) / PairBlock::width, {});
  for (std::size_t k = 0; k < watched_.size(); ++k) {
    const auto rank = std::size_t(pairs_[std::size_t(watched_[k])].rank);
    copy_lane(all_blocks_[rank / PairBlock::width], rank % PairBlock::width,
              watched_blocks_[k / PairBlock::width], k % PairBlock::width);
  }
  place_watched();
}

// How many of the ranked pairs: by the motion of parts, the others are farther apart.
std::size_t SelfContact::pairs_that_may_be_within(double gap) const {
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

// Perhaps along a better normal.
bool SelfContact::is_within(float limit, std::size_t rank, bool turns) {
  PairBlock& block = all_blocks_[rank / PairBlock::width];
  const std::size_t lane = rank % PairBlock::width;
  if (block.gap[lane] > limit) return false;
  if (!turns) return true;
  const PairPlaces places = places_in(block, lane);
  set_normal(places, shortest_way(places.tet, outermost(places.triangle)), block, lane);
  alone_.assign(1, {});
  copy_lane(block, lane, alone_.front(), 0);
  find_gaps(placed_, alone_, 1);
  return !(alone_.front().gap[0] > limit);
}

// Pairs that may be near before the next look. False: it needs a measurement.
bool SelfContact::look(const At& at) {
  const double speed = at.places.range_of_speeds();
  const double left = room_ - at.places.range_since(measured);
  look_room_ = std::min(next_look_room_, left / (1 + share_ahead));
  if (!(look_room_ >= least_room_share * next_look_room_)) return false;
  const double soon = steps_ahead * at.since;
  const double ahead = speed > 0 ? std::min(soon, share_ahead * look_room_ / speed) : 0;
  at.places.set_station(looked, ahead);
  range_ = 1.001 * ahead * speed;
  moved_ = at.moved;
  find_places(at, looked, watched_placed_);
  find_gaps(watched_placed_, watched_blocks_, watched_.size());
  if (!is_tuned_) choose_look_room(speed, at.since);
  is_tuned_ = true;
  if (range_ <= next_look_room_) look_room_ = std::min(look_room_, next_look_room_);
  mark_held(at.surface);
  close_.clear();
  close_ones_.clear();
  const auto limit = static_cast<float>(near_ + look_room_ + parts_.rounding());
  for (std::size_t k = 0; k < watched_.size(); ++k) {
    const Pair& pair = pairs_[std::size_t(watched_[k])];
    if (watched_blocks_[k / PairBlock::width].gap[k % PairBlock::width] > limit && !pair.is_held) continue;
    if (close_ones_.empty() || close_ones_.back().candidate != pair.candidate)
      close_ones_.push_back({pair.candidate, static_cast<int>(close_.size()), 0});
    ++close_ones_.back().count;
    close_.push_back(watched_[k]);
  }
  return true;
}

// That which makes looks and what each step seeks the least work, as pairs are now.
void SelfContact::choose_look_room(double speed, double since) {
  constexpr double look_per_pair = 8, look_at_least = 400, step_per_pair = 60;  // [ns]
  const double look = look_at_least + look_per_pair * double(watched_.size());
  double least = std::numeric_limits<double>::infinity();
  for (double share : {0.02, 0.04, 0.07, 0.1}) {
    const double room = share * most_room_ * 2;
    const auto limit = static_cast<float>(near_ + room + parts_.rounding());
    int close = 0;
    for (std::size_t k = 0; k < watched_.size(); ++k)
      close += !(watched_blocks_[k / PairBlock::width].gap[k % PairBlock::width] > limit);
    const double steps = std::clamp((1 + share_ahead) * room / (speed * since), 1.0, 1e6);
    const double cost = look / steps + step_per_pair * close;
    if (!(cost < least)) continue;
    least = cost;
    next_look_room_ = room;
  }
}

}  // namespace lobe
