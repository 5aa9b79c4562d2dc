// Grains are the small tetrahedra into which blades have divided tetrahedra of the body at rest. Every cut
// runs along faces of grains, and these faces are open. Grains are geometry only, so they may be as flat as
// they like.
// The simulation has whole tetrahedra, each with the share of its volume that its grains fill
// (fem/elements.h).
//
// A grain is a tetrahedron of four points. An edge that a blade has crossed is bisected in all grains around
// it, in the order of the new points' numbers. So the grains on both sides of a face divide it alike. An open
// face separates the grains on its two sides. If the grains around a point are no longer connected by faces,
// each connected part has its own copy of the point.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "lobe/fem/elements.h"
#include "lobe/scalpel/sheet.h"

namespace lobe {

// What a step of a blade has done, by numbers of points and grains. Repeated on equal grains it gives equal
// grains, whatever the state of the body.
struct Incision {
  struct Bisection {
    Index a = 0, b = 0;  // the ends of the edge
    double share = 0;    // share of the edge from a at which the new point is
    bool operator==(const Bisection&) const = default;
    static constexpr auto fields = std::tuple(&Bisection::a, &Bisection::b, &Bisection::share);
  };
  std::vector<Bisection> bisections;
  std::vector<Index> opened;  // faces as codes 4 × grain + corner opposite to the face, one of both sides
  Index stroke = -1;          // number of its stroke, counted from 0 in the order in which they began

  bool empty() const { return bisections.empty() && opened.empty(); }
  bool operator==(const Incision&) const = default;
  static constexpr auto fields = std::tuple(&Incision::bisections, &Incision::opened, &Incision::stroke);
};

class Grains {
 public:
  struct Grain {
    Eigen::Vector4i points;
    Index element;              // tetrahedron of the simulation that it is part of
    std::int16_t stroke = -1;   // last stroke that has opened a face of it; from most_numbered on always that
    std::uint8_t open = 0;      // one bit per face
    std::uint8_t boundary = 0;  // one bit per face: it was on the boundary at the start
    double share = 1;           // share of its parent's volume
  };

  // Makes one grain per tetrahedron that is there, in their order. O(#tets).
  explicit Grains(const Elements& elements);

  Index count() const { return static_cast<Index>(grains_.size()); }
  const Grain& operator[](Index grain) const { return grains_[std::size_t(grain)]; }
  Index point_count() const { return static_cast<Index>(points_.size()); }
  const Vec3d& point(Index p) const { return points_[std::size_t(p)]; }  // at rest [m]
  std::span<const Index> around(Index point) const { return around_[point]; }
  std::span<const Index> of(Index element) const { return of_element_[element]; }
  // The tetrahedron of the start that a grain is part of; and into how many grains that has been divided,
  // those that are burnt included.
  Index parent(Index grain) const { return parent_of((*this)[grain].element); }
  Index divided(Index parent) const { return divided_[std::size_t(parent)]; }
  bool is_open(Index grain, int face) const { return grains_[std::size_t(grain)].open >> face & 1; }
  bool was_boundary(Index grain, int face) const { return grains_[std::size_t(grain)].boundary >> face & 1; }
  // The grain to which it is connected across a face; −1: the face is open, or on the boundary.
  Index neighbour(Index grain, int face) const {
    const Index code = other_sides_[std::size_t(grain)][std::size_t(face)];
    return code < 0 ? -1 : code / 4;
  }
  double mean_edge() const { return mean_edge_; }                            // mean edge of the mesh [m]
  double longest_edge() const { return longest_edge_; }                      // longest edge of the mesh [m]
  double mean_volume() const { return mean_volume_; }                        // mean tetrahedron [m³]
  double shortest_edge(Index p) const { return shortest_[std::size_t(p)]; }  // mesh near a point [m]
  double longest_shortest_edge() const { return longest_shortest_; }         // over all points [m]

  // Points that lie on the sheet of a stroke that goes on. At most 32 strokes go on at a time.
  static constexpr int most_strokes = 32;
  static constexpr Index most_numbered = 32767;
  bool is_on(Index point, int stroke) const { return on_[std::size_t(point)] >> stroke & 1; }
  void put_on(Index point, int stroke) { on_[std::size_t(point)] |= 1u << stroke; }
  void forget_stroke(int stroke);
  const std::vector<std::uint32_t>& on() const { return on_; }
  void set_on(std::vector<std::uint32_t> on);
  // Whether grains are connected across a face all three points of which lie on the sheet of a stroke.
  bool is_closed_on(Index grain, int face, int stroke) const;
  bool has_closed_face_on(Index grain, int stroke) const;
  // Grains that have such a face, and some that had. Their faces wait for the blade to come nearer.
  std::vector<Index>& waiting(int stroke) { return waiting_[std::size_t(stroke)]; }
  std::vector<Index>& point_scratch() {  // a number for each point during a step, −1 before and after
    point_scratch_.resize(points_.size(), -1);
    return point_scratch_;
  }

  double volume(Index grain) const;  // volume at rest [m³]
  double area(Index code) const;     // area of a face 4 × grain + face, at rest [m²]
  Index other_side(Index code) const { return std::max(side(code), -1); }  // face of its neighbour; −1: none
  // The stroke that has opened a face; −1: none has.
  Index stroke_of(Index code) const { return side(code) < -1 ? -2 - side(code) : -1; }
  // The filled part of a face of a tetrahedron that was on the boundary at the start: three times its share
  // of the area, times the barycentric coordinates of its middle. Ones if the face is whole.
  Vec3d boundary_share_of(Index element, int face, const Elements& elements) const;
  // Whether a vertex of the simulation lies in tissue. A divided tetrahedron may have a corner where none of
  // its part is.
  bool fills(Index vertex, const Elements& elements) const;

  // ---- Edits

  // Whether the present grains can have these edges, or faces: checks what was read from a file.
  bool can_bisect(const std::vector<Incision::Bisection>& edges) const;
  bool can_open(const std::vector<Index>& faces) const;

  // New points lie on the sheets that both ends of their edge lie on, and on those of `strokes`, as bits.
  void bisect(const std::vector<Incision::Bisection>& edges, std::uint32_t strokes = 0);
  // Opens both sides of each face, and splits points where grains come apart. Returns the tetrahedra beside.
  std::vector<Index> open(const std::vector<Index>& faces, Index stroke = -1);
  // Returns what has come apart in and around these tetrahedra, as the simulation sees it; the grains go over
  // to its parts.
  TetDivision divide(const Topology& topology, const std::vector<Index>& opened);
  void forget(const std::vector<Index>& elements);  // forgets removed tetrahedra
  // Grains whose points, neighbours or tetrahedra have changed since the last call, or that are gone. Some
  // are listed several times.
  std::vector<Index> take_changed() { return std::exchange(changed_, {}); }

  std::size_t bytes() const;

 private:
  void bisect(Index grain, Index a, Index b, Index point, double share);
  void split_if_apart(Index point);
  void wait_with(const std::vector<Index>& halves, std::uint32_t strokes);

  Index side(Index code) const { return other_sides_[std::size_t(code / 4)][std::size_t(code % 4)]; }
  void link(Index code, Index other);
  void unlink(Index grain);
  Index parent_of(Index element) const {
    const auto copy = element - static_cast<Index>(divided_.size());
    return copy < 0 ? element : parent_of_copy_[std::size_t(copy)];
  }
  void link_halves(const std::vector<Index>& star, Index halves, Index a, Index point);
  bool hangs_together(Index point);
  std::vector<std::vector<Index>> parts_around(Index point);

  std::vector<Grain> grains_;
  // The other side of each face, 4 × grain + face of the neighbour; −1: there is none; below: −2 − the stroke
  // that has opened the face.
  std::vector<std::array<Index, 4>> other_sides_;
  std::vector<Vec3d> points_;
  std::vector<double> shortest_;
  std::vector<std::uint32_t> on_;
  VertexLists<Index> around_;      // grains around each point
  VertexLists<Index> of_element_;  // grains of each tetrahedron of the simulation
  std::vector<Index> divided_;     // number of grains of each tetrahedron of the start
  std::vector<Index> parent_of_copy_;
  double mean_edge_ = 0, longest_edge_ = 0, mean_volume_ = 0, longest_shortest_ = 0;
  std::array<std::vector<Index>, most_strokes> waiting_;
  std::vector<Index> changed_;
  std::vector<std::pair<Index, Index>> parted_;  // grains on both sides of faces opened since divide()
  std::vector<std::uint8_t> is_whole_;  // whether the grains around a vertex hung together after divide()
  std::vector<Index> scratch_, front_;  // scratch of a search: numbers of grains, −1 outside; grains found
  std::vector<Index> vertex_scratch_;   // scratch of divide(): a number per vertex, −1 outside of it
  std::vector<Index> place_scratch_;    // scratch of divide(): a number per grain
  std::vector<Index> point_scratch_;
};

}  // namespace lobe
