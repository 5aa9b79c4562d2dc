// Which of the pairs of a search (pair_search.h) may touch in a step.
//
// Pairs which the search does not list stay apart: a bound of how parts of the body have moved shows it. From
// time to time the body is measured: its parts, and the gaps of the pairs of the list (gap_kernels.h). Both
// are measured not where the body is, but where it will be at its present velocities half of the time until
// the next measurement. Let s be the largest displacement of any two vertices relative to each other since
// that configuration. Then no gap has shrunk by more than s. A bound of s is how far vertices have
// moved in all steps. If that does not suffice, s is found in one pass over all vertices.
//
// Pairs whose gap is larger than all the way to the next measurement are left alone until then. The others
// are watched: every few steps one looks at them in the same manner, with less way to the next look. Those
// whose gap is smaller even than that are close: in them each step seeks points of triangles.
#pragma once

#include <limits>
#include <span>

#include "lobe/contact/contact_memory.h"
#include "lobe/contact/pair_search.h"

namespace lobe {

// What contact of a body with itself is asked at.
struct SelfAt {
  const ContactSurface& surface;
  const ContactLaw& law;
  const Places& places;
  double moved = 0;  // how far vertices have moved at most in all steps [m]
  double since = 0;  // the last step [s]
};

// Pairs that may touch before the next look, candidate by candidate; first those whose triangles have one
// point, and so on. A block has pairs of one such kind.
struct ClosePairs {
  struct OfDivisions {
    int divisions = self_divisions, first_block = 0, blocks = 0;
  };
  struct OfCandidate {
    int candidate = 0, first = 0, count = 0;  // its number; place and number of its pairs in `pairs`
  };
  std::vector<int> pairs;  // numbers in PairSearch::pairs(); −1 fills up the last block of a kind
  std::vector<OfCandidate> candidates;  // ascending
  std::vector<OfDivisions> kinds;
  std::vector<PairBlock> blocks;  // blocks of `pairs`, with places in `points`

  // The places that these blocks use: those of vertices with their numbers in the mesh, and the others.
  std::vector<int> places, between;
  std::vector<Index> vertices;

  std::span<const int> of(const OfCandidate& own) const {
    return {pairs.data() + own.first, std::size_t(own.count)};
  }
  void clear() {
    pairs.clear();
    candidates.clear();
    kinds.clear();
    blocks.clear();
    places.clear();
    between.clear();
    vertices.clear();
  }
};

class GapWatch {
 public:
  GapWatch(const SelfRest& rest, PairSearch& search) : rest_(rest), search_(search) {}

  void rebuild();  // call it after that of the search
  void forget() { is_measured_ = false; }
  // The next place may be any: how far vertices have moved in steps says nothing of it.
  void leave_path() { moved_ = -std::numeric_limits<double>::infinity(); }
  // Looks, measures and searches where that is due.
  void keep(const SelfAt& at, const ContactMemory& memory);

  const ClosePairs& close() const { return close_; }
  const SelfPoints& points() const { return points_; }  // corners of the watched pairs
  int numbering() const { return measurement_; }        // its number: another one after each measurement

 private:
  struct Watched {         // what is known of a pair
    int place = -1;        // its place in watched_, if it is there
    int turned = -100;     // the last measurement since which it was watched
    bool is_held = false;  // a point of the triangle is held in it
  };
  struct Scratch {
    std::vector<Watched> states;            // states_ before a search
    std::vector<std::uint64_t> is_watched;  // a bit per pair
    std::vector<std::size_t> turned;        // ranks of pairs whose normals turn
    std::vector<PairBlock> turned_blocks;
    std::vector<int> place_of, used, between;  // lists about the points that are watched
    std::vector<int> is_close;                 // per place: the last look at which it was close
  };

  void measure(const SelfAt& at, const ContactMemory& memory, double ahead);
  bool find_room(const SelfAt& at, double ahead);
  void search(const SelfAt& at, const ContactMemory& memory);
  bool look(const SelfAt& at, const ContactMemory& memory);
  void find_close();
  void find_close_of(int divisions, float limit);
  void clear_close();
  void take_close(int pair, std::size_t watched);
  void choose_look_room(double speed, double since);
  void mark_held(const ContactMemory& memory);
  void find_watched(const ContactMemory& memory);
  void turn_normals(float limit, std::size_t some);
  void number_points();

  const SelfRest& rest_;
  PairSearch& search_;
  GapKernels kernels_ = gap_kernels(chosen_instruction_set());

  Stations stations_;
  bool is_measured_ = false;
  int measurement_ = 0, look_ = 0;   // numbers of the last measurement and the last look
  double most_room_ = 0;             // the largest room_ [m]
  double room_ = 0, look_room_ = 0;  // how much nearer pairs may come until the next one, and a look [m]
  double next_look_room_ = 0;
  bool is_tuned_ = false;            // next_look_room_ was chosen since the last measurement
  double range_ = 0;                 // how much nearer vertices came since the look, when last found [m]
  double moved_ = 0;                 // how far vertices had moved until then [m]
  std::vector<Watched> states_;      // one per pair of the search
  std::vector<int> watched_, held_;  // pairs that may touch before the next measurement; with a held point
  std::vector<PairBlock> blocks_;    // blocks of watched_, with places in points_
  SelfPoints points_;
  ClosePairs close_;

  Scratch scratch_;
};

}  // namespace lobe
