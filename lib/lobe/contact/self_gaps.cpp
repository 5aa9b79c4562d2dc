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
#include <bit>
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
  clear_close();
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
  find_watched();
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
    own.find(x.data(), to);
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
  is_close_place_.assign(own.x.size() / 4, -1);
  for (std::vector<double>* rows : {&now_, &speeds_, &forces_}) rows->assign(own.x.size(), 0);
  for (std::size_t k = 0; k < watched_.size(); ++k)
    for (std::size_t c = 0; c < 7; ++c) {
      int& place = watched_blocks_[k / PairBlock::width].places[c][k % PairBlock::width];
      place = watched_place_of_[std::size_t(place)];
    }
  for (const auto* list : {&used_places_, &between})
    for (int place : *list) watched_place_of_[std::size_t(place)] = -1;
}

// Of which pairs a point is held. Anchors and candidates are both in the order of the surface.
void SelfContact::mark_held() {
  for (int i : held_pairs_) pairs_[std::size_t(i)].is_held = false;
  held_pairs_.clear();
  std::size_t candidate = 0;
  Index last = -1;
  for (const Anchor& anchor : memory_.all_anchors()) {
    const std::pair own(anchor.tet, anchor.code);
    const auto owner = [&] { return std::pair(owners_[candidate].tet, owners_[candidate].code); };
    while (candidate != owners_.size() && owner() < own) {
      ++candidate;
      last = -1;
    }
    if (candidate == owners_.size()) return;
    if (owner() != own || anchor.in == last) continue;
    last = anchor.in;
    const Candidate& its = candidates_[candidate];
    for (int i = its.first; i < its.first + its.count; ++i) {
      Pair& pair = pairs_[std::size_t(i)];
      if (pair.tet != anchor.in || pair.is_held) continue;
      pair.is_held = true;
      held_pairs_.push_back(i);
    }
  }
}

// Pairs that may be near before the next measurement, and those of which a point is held; in the order of
// pairs_.
void SelfContact::find_watched() {
  const double needed = near_ + room_ + parts_.rounding();
  const std::size_t some = pairs_that_may_be_within(needed);
  find_gaps(placed_, all_blocks_, some);
  turn_normals(static_cast<float>(needed), some);
  mark_held();
  const auto watch = [&](int pair) {
    is_watched_[std::size_t(pair) / 64] |= std::uint64_t(1) << std::size_t(pair) % 64;
  };
  is_watched_.assign((pairs_.size() + 63) / 64, 0);
  visit_within(all_blocks_, static_cast<float>(needed), some, [&](std::size_t rank) {
    pairs_[std::size_t(ranked_[rank])].turned = measurement_;
    watch(ranked_[rank]);
  });
  for (int i : held_pairs_) watch(i);
  watched_.clear();
  for (std::size_t word = 0; word < is_watched_.size(); ++word)
    for (std::uint64_t left = is_watched_[word]; left != 0; left &= left - 1)
      watched_.push_back(static_cast<int>(64 * word) + std::countr_zero(left));
  watched_blocks_.assign((watched_.size() + PairBlock::width - 1) / PairBlock::width, {});
  for (std::size_t k = 0; k < watched_.size(); ++k) {
    Pair& pair = pairs_[std::size_t(watched_[k])];
    pair.watched = static_cast<int>(k);
    const auto rank = std::size_t(pair.rank);
    copy_lane(all_blocks_[rank / PairBlock::width], rank % PairBlock::width,
              watched_blocks_[k / PairBlock::width], k % PairBlock::width);
  }
  place_watched();
}

// visit(number) of those of the first pairs of blocks whose gaps are not larger.
template <class Visit>
void SelfContact::visit_within(const std::vector<PairBlock>& blocks, float limit, std::size_t some,
                               Visit&& visit) {
  constexpr std::size_t width = PairBlock::width;
  for (std::size_t first = 0; first < some; first += width) {
    const PairBlock& block = blocks[first / width];
    unsigned int within = 0;
    for (std::size_t lane = 0; lane < width; ++lane) within |= unsigned(!(block.gap[lane] > limit)) << lane;
    if (some - first < width) within &= (1U << (some - first)) - 1;
    for (; within != 0; within &= within - 1) visit(first + std::size_t(std::countr_zero(within)));
  }
}

// Of pairs that come to be watched: along a better one their gap may be larger.
void SelfContact::turn_normals(float limit, std::size_t some) {
  constexpr std::size_t width = PairBlock::width;
  constexpr int turned_at_most_every = 8;  // measurements
  ++measurement_;
  turned_.clear();
  turned_blocks_.clear();
  visit_within(all_blocks_, limit, some, [&](std::size_t rank) {
    Pair& pair = pairs_[std::size_t(ranked_[rank])];
    if (measurement_ - pair.turned < turned_at_most_every) return;
    PairBlock& block = all_blocks_[rank / width];
    const std::size_t lane = rank % width;
    const PairPlaces places = places_in(block, lane);
    set_normal(places, shortest_way(places.tet, outermost(places.triangle)), block, lane);
    if (turned_.size() % width == 0) turned_blocks_.emplace_back();
    copy_lane(block, lane, turned_blocks_.back(), turned_.size() % width);
    turned_.push_back(rank);
  });
  find_gaps(placed_, turned_blocks_, turned_.size());
  for (std::size_t k = 0; k < turned_.size(); ++k)
    all_blocks_[turned_[k] / width].gap[turned_[k] % width] = turned_blocks_[k / width].gap[k % width];
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
  mark_held();
  clear_close();
  const auto limit = static_cast<float>(near_ + look_room_ + parts_.rounding());
  for (int i : held_pairs_) {
    const auto k = std::size_t(pairs_[std::size_t(i)].watched);
    watched_blocks_[k / PairBlock::width].gap[k % PairBlock::width] = 0;  // they are always close
  }
  visit_within(watched_blocks_, limit, watched_.size(), [&](std::size_t k) {
    const int candidate = pairs_[std::size_t(watched_[k])].candidate;
    if (close_ones_.empty() || close_ones_.back().candidate != candidate)
      close_ones_.push_back({candidate, static_cast<int>(close_.size()), 0});
    ++close_ones_.back().count;
    take_close(watched_[k], k);
  });
  insides_.resize(close_blocks_.size());
  return true;
}

void SelfContact::clear_close() {
  close_.clear();
  close_ones_.clear();
  close_blocks_.clear();
  close_places_.clear();
  close_vertices_.clear();
  close_between_.clear();
  ++look_;
}

void SelfContact::take_close(int pair, std::size_t watched) {
  constexpr std::size_t width = PairBlock::width;
  const PairBlock& from = watched_blocks_[watched / width];
  if (close_.size() % width == 0) close_blocks_.emplace_back();
  copy_lane(from, watched % width, close_blocks_.back(), close_.size() % width);
  close_.push_back(pair);
  const auto is_new = [&](int place) {
    return std::exchange(is_close_place_[std::size_t(place)], look_) != look_;
  };
  const auto take_vertex = [&](int place) {
    if (!is_new(place)) return;
    close_places_.push_back(place);
    close_vertices_.push_back(watched_placed_.vertices[std::size_t(place)]);
  };
  const auto vertices = static_cast<int>(watched_placed_.vertices.size());
  const auto take = [&](int place) {
    if (place < vertices) return take_vertex(place);
    if (!is_new(place)) return;
    close_between_.push_back(place);
    for (int corner : watched_placed_.between[std::size_t(place - vertices)].of) take_vertex(corner);
  };
  for (std::size_t c = 0; c < 7; ++c) take(from.places[c][watched % width]);
}

// That which makes looks and what each step seeks the least work, as pairs are now.
void SelfContact::choose_look_room(double speed, double since) {
  constexpr double look_per_pair = 8, look_at_least = 400, step_per_pair = 20;  // [ns]
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
