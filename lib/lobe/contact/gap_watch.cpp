#include "lobe/contact/gap_watch.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "lobe/contact/convex_gap.h"

namespace lobe {
namespace {

constexpr std::size_t width = PairBlock::width;
// How much nearer pairs may come between two measurements, in the least reach of two bodies.
constexpr double most_room_share = 0.5;
// A search is due when there is less room than this share of the most.
constexpr double least_room_share = 0.3;
// A station is where the body will be after this share of the room, or after so many steps.
constexpr double share_ahead = 0.6, steps_ahead = 16;

// visit(number) of those of the first pairs of blocks whose gaps are not larger.
template <class Visit>
void visit_within(const std::vector<PairBlock>& blocks, float limit, std::size_t some, Visit&& visit) {
  for (std::size_t first = 0; first < some; first += width) {
    const PairBlock& block = blocks[first / width];
    unsigned int within = 0;
    for (std::size_t lane = 0; lane < width; ++lane) within |= unsigned(!(block.gap[lane] > limit)) << lane;
    if (some - first < width) within &= (1U << (some - first)) - 1;
    for (; within != 0; within &= within - 1) visit(first + std::size_t(std::countr_zero(within)));
  }
}

}  // namespace

void GapWatch::rebuild() {
  forget();
  clear_close();
  most_room_ = most_room_share * rest_.least_reach();
  next_look_room_ = 0.2 * most_room_;
  scratch_.place_of.assign(std::size_t(rest_.points.count()), -1);
}

void GapWatch::keep(const SelfAt& at, const ContactMemory& memory) {
  if (is_measured_ && range_ + 2 * (at.moved - moved_) <= look_room_) return;
  if (is_measured_) {
    range_ = stations_.range_since(Stations::looked, at.places);
    moved_ = at.moved;
    if (range_ <= look_room_ || look(at, memory)) return;
  }
  const double speed = stations_.range_of_speeds(at.places);
  measure(at, memory, speed > 0 ? std::min(steps_ahead * at.since, share_ahead * most_room_ / speed) : 0);
  if (look(at, memory)) return;
  measure(at, memory, 0);
  look(at, memory);
}

// ---- A measurement

// Where the body will be `ahead`. False: pairs that are not listed may be near.
bool GapWatch::find_room(const SelfAt& at, double ahead) {
  stations_.set(Stations::measured, at.places, ahead);
  search_.place(stations_, at.places);
  room_ = 0;
  if (!search_.is_searched()) return false;
  room_ = std::min(most_room_, search_.room_for_others(most_room_));
  return room_ >= least_room_share * most_room_;
}

void GapWatch::search(const SelfAt& at, const ContactMemory& memory) {
  search_.search(at.surface, memory);
  std::vector<Watched>& before = scratch_.states;
  before.swap(states_);
  states_.assign(search_.pairs().size(), {});
  for (std::size_t i = 0; i < states_.size(); ++i)
    if (const int last = search_.before()[i]; last >= 0) states_[i].turned = before[std::size_t(last)].turned;
  watched_.clear();
  held_.clear();
}

// A body that swings needs no search after one that goes far, and about the body at rest.
void GapWatch::measure(const SelfAt& at, const ContactMemory& memory, double ahead) {
  clear_close();
  bool has_room = find_room(at, ahead);
  if (!has_room && search_.is_searched() && search_.widen()) {
    search_.place_at_rest();
    search(at, memory);
    has_room = find_room(at, ahead);
  }
  if (!has_room) {
    search(at, memory);
    room_ = std::min(most_room_, search_.within() - rest_.near);
  }
  find_watched(memory);
  is_measured_ = true;
  is_tuned_ = false;
}

// Pairs that may be near before the next measurement, and those of which a point is held; in the order of the
// search.
void GapWatch::find_watched(const ContactMemory& memory) {
  const double needed = rest_.near + room_ + search_.rounding();
  const std::size_t some = search_.count_within(needed);
  find_gaps(kernels_, search_.points(), search_.blocks(), some);
  turn_normals(static_cast<float>(needed), some);
  mark_held(memory);
  std::vector<std::uint64_t>& is_watched = scratch_.is_watched;
  const auto watch = [&](int pair) {
    is_watched[std::size_t(pair) / 64] |= std::uint64_t(1) << std::size_t(pair) % 64;
  };
  is_watched.assign((states_.size() + 63) / 64, 0);
  visit_within(search_.blocks(), static_cast<float>(needed), some, [&](std::size_t rank) {
    const int pair = search_.ranked()[rank];
    states_[std::size_t(pair)].turned = measurement_;
    watch(pair);
  });
  for (int pair : held_) watch(pair);
  watched_.clear();
  for (std::size_t word = 0; word < is_watched.size(); ++word)
    for (std::uint64_t left = is_watched[word]; left != 0; left &= left - 1)
      watched_.push_back(static_cast<int>(64 * word) + std::countr_zero(left));
  blocks_.assign((watched_.size() + width - 1) / width, {});
  for (std::size_t k = 0; k < watched_.size(); ++k) {
    const auto pair = std::size_t(watched_[k]);
    states_[pair].place = static_cast<int>(k);
    const auto rank = std::size_t(search_.pairs()[pair].rank);
    copy_lane(search_.blocks()[rank / width], rank % width, blocks_[k / width], k % width);
  }
  number_points();
}

// Of pairs that come to be watched: along a better one their gap may be larger.
void GapWatch::turn_normals(float limit, std::size_t some) {
  constexpr int turned_at_most_every = 8;  // measurements
  ++measurement_;
  std::vector<PairBlock>& blocks = search_.blocks();
  std::vector<PairBlock>& turned_blocks = scratch_.turned_blocks;
  std::vector<std::size_t>& turned = scratch_.turned;
  turned.clear();
  turned_blocks.clear();
  visit_within(blocks, limit, some, [&](std::size_t rank) {
    const Watched& state = states_[std::size_t(search_.ranked()[rank])];
    if (measurement_ - state.turned < turned_at_most_every) return;
    PairBlock& block = blocks[rank / width];
    const std::size_t lane = rank % width;
    const PairCorners corners = corners_in(search_.points(), block, lane);
    set_normal(corners, shortest_way(corners.tet, outermost(corners.triangle)), block, lane);
    if (turned.size() % width == 0) turned_blocks.emplace_back();
    copy_lane(block, lane, turned_blocks.back(), turned.size() % width);
    turned.push_back(rank);
  });
  find_gaps(kernels_, search_.points(), turned_blocks, turned.size());
  for (std::size_t k = 0; k < turned.size(); ++k)
    blocks[turned[k] / width].gap[turned[k] % width] = turned_blocks[k / width].gap[k % width];
}

// Which pairs have a point that is held. Anchors and candidates are both in the order of the surface.
void GapWatch::mark_held(const ContactMemory& memory) {
  for (int i : held_) states_[std::size_t(i)].is_held = false;
  held_.clear();
  auto candidate = search_.candidates().begin();
  const auto end = search_.candidates().end();
  Index last = -1;
  for (const Anchor& anchor : memory.all_anchors()) {
    const std::tuple own(anchor.tet, anchor.code, anchor.divisions);
    while (candidate != end && candidate->key() < own) {
      ++candidate;
      last = -1;
    }
    if (candidate == end) return;
    if (candidate->key() != own || anchor.in == last) continue;
    last = anchor.in;
    for (int i = candidate->first; i < candidate->first + candidate->count; ++i) {
      Watched& state = states_[std::size_t(i)];
      if (search_.pairs()[std::size_t(i)].tet != anchor.in || state.is_held) continue;
      state.is_held = true;
      held_.push_back(i);
    }
  }
}

// The points that watched pairs have, by which their blocks number them.
void GapWatch::number_points() {
  points_.vertices.clear();
  points_.between.clear();
  std::vector<int>&used = scratch_.used, &between = scratch_.between, &place_of = scratch_.place_of;
  used.clear();
  between.clear();
  const auto vertices = static_cast<int>(rest_.points.vertices.size());
  const auto use = [&](int vertex) {
    int& place = place_of[std::size_t(vertex)];
    if (place >= 0) return place;
    place = static_cast<int>(points_.vertices.size());
    points_.vertices.push_back(rest_.points.vertices[std::size_t(vertex)]);
    used.push_back(vertex);
    return place;
  };
  for (std::size_t k = 0; k < watched_.size(); ++k)
    for (std::size_t c = 0; c < 7; ++c) {
      const int place = blocks_[k / width].places[c][k % width];
      if (place < vertices)
        use(place);
      else if (std::exchange(place_of[std::size_t(place)], 0) < 0)
        between.push_back(place);
    }
  std::sort(between.begin(), between.end());
  for (int place : between) {
    SelfPoints::Between corners = rest_.points.between[std::size_t(place - vertices)];
    for (int& corner : corners.of) corner = use(corner);
    points_.between.push_back(corners);
  }
  for (std::size_t i = 0; i < between.size(); ++i)
    place_of[std::size_t(between[i])] = static_cast<int>(points_.vertices.size() + i);
  points_.fit();
  scratch_.is_close.assign(std::size_t(points_.count()), -1);
  for (std::size_t k = 0; k < watched_.size(); ++k)
    for (std::size_t c = 0; c < 7; ++c) {
      int& place = blocks_[k / width].places[c][k % width];
      place = place_of[std::size_t(place)];
    }
  for (const std::vector<int>* list : {&used, &between})
    for (int place : *list) place_of[std::size_t(place)] = -1;
}

// ---- A look

// Finds the pairs that may be near before the next look. False: it needs a measurement.
bool GapWatch::look(const SelfAt& at, const ContactMemory& memory) {
  const double speed = stations_.range_of_speeds(at.places);
  const double left = room_ - stations_.range_since(Stations::measured, at.places);
  look_room_ = std::min(next_look_room_, left / (1 + share_ahead));
  if (!(look_room_ >= least_room_share * next_look_room_)) return false;
  const double soon = steps_ahead * at.since;
  const double ahead = speed > 0 ? std::min(soon, share_ahead * look_room_ / speed) : 0;
  stations_.set(Stations::looked, at.places, ahead);
  range_ = 1.001 * ahead * speed;
  moved_ = at.moved;
  stations_.of_vertices(Stations::looked, at.places, rest_.points.vertices[0], points_.vertices,
                        points_.x.data());
  points_.find_between();
  find_gaps(kernels_, points_, blocks_, watched_.size());
  if (!is_tuned_) choose_look_room(speed, at.since);
  is_tuned_ = true;
  if (range_ <= next_look_room_) look_room_ = std::min(look_room_, next_look_room_);
  mark_held(memory);
  find_close();
  return true;
}

// Pairs that are held are always close. Forces at points between vertices are summed in the order of those,
// so that bits do not depend on what else is close.
void GapWatch::find_close() {
  clear_close();
  const auto limit = static_cast<float>(rest_.near + look_room_ + search_.rounding());
  for (int i : held_) {
    const auto k = std::size_t(states_[std::size_t(i)].place);
    blocks_[k / width].gap[k % width] = 0;
  }
  const int fewest = rest_.has_several_bodies() ? 1 : self_divisions;
  for (int divisions = fewest; divisions <= self_divisions; ++divisions) find_close_of(divisions, limit);
  if (rest_.has_several_bodies())
    std::sort(close_.candidates.begin(), close_.candidates.end(),
              [](const auto& a, const auto& b) { return a.candidate < b.candidate; });
  std::sort(close_.between.begin(), close_.between.end());
}

void GapWatch::find_close_of(int divisions, float limit) {
  const auto first = static_cast<int>(close_.blocks.size());
  close_.pairs.resize(width * close_.blocks.size(), -1);
  int last = -1;
  visit_within(blocks_, limit, watched_.size(), [&](std::size_t k) {
    const int candidate = search_.pairs()[std::size_t(watched_[k])].candidate;
    if (search_.candidates()[std::size_t(candidate)].divisions != divisions) return;
    if (std::exchange(last, candidate) != candidate)
      close_.candidates.push_back({candidate, static_cast<int>(close_.pairs.size()), 0});
    ++close_.candidates.back().count;
    take_close(watched_[k], k);
  });
  const int added = static_cast<int>(close_.blocks.size()) - first;
  if (added > 0) close_.kinds.push_back({divisions, first, added});
}

void GapWatch::clear_close() {
  close_.clear();
  ++look_;
}

void GapWatch::take_close(int pair, std::size_t watched) {
  const PairBlock& from = blocks_[watched / width];
  if (close_.pairs.size() % width == 0) close_.blocks.emplace_back();
  copy_lane(from, watched % width, close_.blocks.back(), close_.pairs.size() % width);
  close_.pairs.push_back(pair);
  const auto is_new = [&](int place) {
    return std::exchange(scratch_.is_close[std::size_t(place)], look_) != look_;
  };
  const auto take_vertex = [&](int place) {
    if (!is_new(place)) return;
    close_.places.push_back(place);
    close_.vertices.push_back(points_.vertices[std::size_t(place)]);
  };
  const auto vertices = static_cast<int>(points_.vertices.size());
  const auto take = [&](int place) {
    if (place < vertices) return take_vertex(place);
    if (!is_new(place)) return;
    close_.between.push_back(place);
    for (int corner : points_.between[std::size_t(place - vertices)].of) take_vertex(corner);
  };
  for (std::size_t c = 0; c < 7; ++c) take(from.places[c][watched % width]);
}

// That which makes looks and what each step seeks the least work, as pairs are now.
void GapWatch::choose_look_room(double speed, double since) {
  constexpr double look_per_pair = 8, look_at_least = 400, step_per_pair = 20;  // [ns]
  const double look = look_at_least + look_per_pair * double(watched_.size());
  double least = std::numeric_limits<double>::infinity();
  for (double share : {0.02, 0.04, 0.07, 0.1}) {
    const double room = share * most_room_ * 2;
    const auto limit = static_cast<float>(rest_.near + room + search_.rounding());
    int close = 0;
    for (std::size_t k = 0; k < watched_.size(); ++k) close += !(blocks_[k / width].gap[k % width] > limit);
    const double steps = std::clamp((1 + share_ahead) * room / (speed * since), 1.0, 1e6);
    const double cost = look / steps + step_per_pair * close;
    if (!(cost < least)) continue;
    least = cost;
    next_look_room_ = room;
  }
}

}  // namespace lobe
