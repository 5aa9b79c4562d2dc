// The triangles of a surface and the tetrahedra of its boundary layer that are near each other, and a bound
// of how near any others may have come since (part_motion.h).
//
// Two parts of the layer that are near each other are a link. A search lists the pairs of a link up to a
// radius, which differs from pair to pair of bodies (self_rest.h). Later searches keep the links whose other
// pairs are far apart still, with a smaller radius, which is the bound of how far. They look again only at
// the links that have lost more than some two fifths of their radius, and at new ones.
#pragma once

#include <cstdint>
#include <tuple>
#include <utility>

#include "lobe/contact/contact_memory.h"
#include "lobe/contact/part_motion.h"
#include "lobe/contact/self_rest.h"
#include "lobe/contact/stations.h"

namespace lobe {

class PairSearch {
 public:
  struct Pair {
    int candidate = 0, layer = 0;
    Index tet = -1;         // tetrahedron of the layer
    int rank = 0;           // place in ranked()
    std::uint8_t face = 0;  // the plane of this face of the tetrahedron parted them best
    float gap = 0;          // gap of the points when it was searched, or less [m]
  };
  struct Candidate {  // a triangle that has pairs, with the points that it has for these
    int triangle = 0;
    FaceOwner owner;
    int divisions = self_divisions;  // parts of each of its edges: it has divisions² points
    int first = 0, count = 0;        // place and number of its pairs
    auto key() const { return std::tuple(owner.tet, owner.code, divisions); }
  };

  explicit PairSearch(const SelfRest& rest) : rest_(rest) {}
  void rebuild();  // call it after that of `rest`

  // ---- Where the points of the layer are

  void place(const Stations& stations, const Places& now);  // puts them where the last measurement has them
  void place_at_rest();
  const SelfPoints& points() const { return points_; }

  // ---- Search

  bool is_searched() const { return is_searched_; }
  int number() const { return number_; }  // number of the last search, of any surface
  // Pairs of which a point is held are found however far apart they are.
  void search(const ContactSurface& surface, const ContactMemory& memory);
  // All pairs that were no farther apart than this are known [m].
  double within() const { return within_; }
  // The next search goes as far as all searches after the first do. False: the last one did.
  bool widen();
  // By how much pairs may come nearer until one that is not listed may be near [m]. That is exact up to
  // `most` only.
  double room_for_others(double most);

  // ---- What it found

  const std::vector<Candidate>& candidates() const { return listed_.candidates; }  // in the surface's order
  const std::vector<Pair>& pairs() const { return listed_.pairs; }                 // candidate by candidate
  const std::vector<int>& ranked() const { return ranked_; }  // pairs by their gaps when they were searched
  std::vector<PairBlock>& blocks() { return blocks_; }        // in that order
  const std::vector<int>& before() const { return before_; }  // number of each pair before that search, or −1
  // How many of the ranked pairs may be within a gap now: by the motion of parts, the others are not.
  std::size_t count_within(double gap) const;
  double rounding() const { return parts_.rounding(); }  // rounding error of gaps [m]

 private:
  struct Link {  // two parts that were near each other when they were searched
    PartMotion::Meeting meeting;
    PartMotion::Bound bound;
    double within = 0;    // all pairs of the two that were no farther apart are known [m]
    bool is_due = false;  // they are looked for in this search
  };
  struct Planes {  // planes of a tetrahedron's faces, n·x − offset > 0 outside, and its corners x
    Eigen::Array4f n[3], offset, x[3];
  };
  struct Boxes {  // boxes of four layers
    Eigen::Array4f low[3], high[3];
  };
  struct Found {
    int triangle, layer;
    float gap;  // gap of the pair, or less [m]
    int face;
    int divisions;
    bool is_held = false;
    int before = -1;  // its number before this search; −1: it had none
    auto place() const { return std::pair(divisions, layer); }  // among those of its triangle
  };
  struct Listed {
    std::vector<Candidate> candidates;
    std::vector<Pair> pairs;
  };
  struct Scratch {  // memory of a search
    std::vector<float> squares;
    std::vector<Planes> planes;  // per layer
    std::vector<Boxes> boxes;    // per four
    std::vector<int> stamp;      // per layer: the last triangle that it belongs to
    std::vector<Found> found;
    std::vector<PairBlock> blocks;      // blocks of `found`
    std::vector<int> found_of;          // per pair: its place there
    std::vector<std::uint64_t> keys;    // gaps and numbers of pairs
    std::vector<std::uint8_t> has_due;  // per part
    // What the last search has found, with the links' numbers per pair of parts.
    Listed before;
    std::vector<Link> links;
    std::vector<int> link_of;
  };

  int body_of_part(int part) const { return rest_.body_of_part[std::size_t(part)]; }
  double radius(int own, int other) const { return far_ * rest_.reach(own, other); }  // of two bodies [m]
  void find_known();
  void link_parts();
  void link(int a, int b);
  void find_boxes();
  void find_boxes_of(std::size_t four);
  static void find_planes(const Mat34<double>& x, Planes& planes);
  void find_pairs(const ContactSurface& surface, const std::vector<Anchor>& anchors);
  void find_pairs_of(const ContactSurface& surface, int triangle);
  void keep_pairs_of(int triangle, std::size_t& candidate);
  void find_held(int triangle, int divisions, std::size_t first, Index tet);
  void take_candidates(const ContactSurface& surface);
  void fill_block(const ContactSurface& surface, std::size_t number);
  void take_pair(const ContactSurface& surface, const Found& found, float gap);
  void rank_pairs();

  const SelfRest& rest_;
  GapKernels kernels_ = gap_kernels(chosen_instruction_set());

  bool is_searched_ = false, is_all_due_ = true;
  int number_ = 0;
  double far_ = 0;     // radii over reaches
  double within_ = 0;  // [m]
  SelfPoints points_;
  PartMotion parts_;
  std::vector<Link> links_;
  std::vector<int> link_of_;  // per pair of parts: −1 if they were not near
  Listed listed_;
  std::vector<int> before_, ranked_;
  std::vector<PairBlock> blocks_;

  Scratch scratch_;
};

}  // namespace lobe
