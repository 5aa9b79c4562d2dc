// The triangles of a surface and the tetrahedra of its boundary layer that are near each other, and a bound
// of how near any others may have come since (part_motion.h).
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
  // Others that were farther apart than this are not known [m].
  double within() const { return within_; }
  // The next search goes as far as all searches after the first do. False: the last one did.
  bool widen();
  // By how much pairs may come nearer until one that is not listed may be near [m]. That is exact up to
  // `most` only.
  double room_for_others(double most);

  // ---- What it found

  const std::vector<Candidate>& candidates() const { return candidates_; }  // in the surface's order
  const std::vector<Pair>& pairs() const { return pairs_; }                 // candidate by candidate
  const std::vector<int>& ranked() const { return ranked_; }  // pairs by their gaps when they were searched
  std::vector<PairBlock>& blocks() { return blocks_; }        // in that order
  // How many of the ranked pairs may be within a gap now: by the motion of parts, the others are not.
  std::size_t count_within(double gap) const;
  double rounding() const { return parts_.rounding(); }  // rounding error of gaps [m]

 private:
  struct Link {  // two parts that were near each other when they were searched
    PartMotion::Meeting meeting;
    PartMotion::Bound bound;
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
    auto place() const { return std::pair(divisions, layer); }  // among those of its triangle
  };
  struct Scratch {  // memory of a search
    std::vector<float> squares;
    std::vector<Planes> planes;  // per layer
    std::vector<Boxes> boxes;    // per four
    std::vector<int> stamp;      // per layer: the last triangle that it belongs to
    std::vector<Found> found;
  };

  void find_boxes();
  static void find_planes(const Mat34<double>& x, Planes& planes);
  void link_parts();
  void find_pairs(const ContactSurface& surface, const std::vector<Anchor>& anchors);
  void find_pairs_of(const ContactSurface& surface, int triangle);
  void find_held(int triangle, int divisions, std::size_t first, Index tet);
  void take_candidates(const ContactSurface& surface);
  void take_pair(const ContactSurface& surface, const Found& found, float gap);
  void rank_pairs(const std::vector<PairBlock>& blocks);

  const SelfRest& rest_;
  GapKernels kernels_ = gap_kernels(chosen_instruction_set());

  bool is_searched_ = false;
  int number_ = 0;
  double within_ = 0;
  SelfPoints points_;
  PartMotion parts_;
  std::vector<Link> links_;
  std::vector<int> link_of_;  // per pair of parts: −1 if they were not near
  std::vector<Candidate> candidates_;
  std::vector<Pair> pairs_;
  std::vector<int> ranked_;
  std::vector<PairBlock> blocks_;

  Scratch scratch_;
};

}  // namespace lobe
