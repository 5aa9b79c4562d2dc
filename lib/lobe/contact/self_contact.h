// A body against itself: organ against organ, the lips of a cut, pieces that have fallen.
//
// A point x_q of a surface triangle that lies in a tetrahedron of the boundary layer, at the barycentric
// coordinates b, was at rest at X = Σ b_i X_i: there the face of the boundary that it has come through is the
// nearest one, however deep the two overlap now. With that face where it is now, of normal n and corners x_j,
//   d = −n·(x_q − x_1),  p = κ ⟨d + h⟩,  f_q = A_q p n,  f_j = −w_j f_q,
// h what is held (contact_law.h), w the barycentric coordinates of the foot of x_q in the face's plane: minus
// the gradient of ½ κ A_q ⟨d + h⟩², so that momentum and angular momentum are kept, and energy but for what h
// gives and where another face becomes the nearest. A point that is held keeps its face until p is 0. A slit,
// whose lips lie on each other, has no force until they overlap. Both sides are evaluated. κ is half of κ_q
// κ_f/(κ_q + κ_f), so that both together give no vertex more stiffness than it may have (contact_surface.h).
//
// A tetrahedron that shares a vertex with a triangle, or with a neighbour of the triangle, can touch it only
// if it lies in front of the triangle at rest, across a slit or a fold. A tetrahedron behind the triangle is
// on its own side, and is left out.
// Copies of a tetrahedron that a blade has divided have the shape of the whole. A point in one touches it
// only where it is filled at rest: behind the nearest of its own cut faces.
//
// Friction follows Coulomb's law, with a spring per point. The length ξ of the spring grows by the sliding of
// both sides past each other. Friction acts on the tetrahedron at the place of x_q, by −b_i f_t on its
// corners.
//
// Cost. Most of the time a step only asks how far vertices have moved since the body was last looked at.
// self_gaps.cpp says what is looked at when.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <span>

#include "lobe/contact/boundary_layer.h"
#include "lobe/contact/contact_law.h"
#include "lobe/contact/contact_memory.h"
#include "lobe/contact/contact_surface.h"
#include "lobe/contact/gap_kernels.h"
#include "lobe/contact/part_motion.h"
#include "lobe/contact/places.h"
#include "lobe/contact/quadrature.h"

namespace lobe {

class SelfContact {
 public:
  static constexpr int divisions = 3;  // of the edges of a triangle
  static constexpr int points_per_triangle = divisions * divisions;

  explicit SelfContact(double friction) : friction_(friction) {}

  struct At {
    const ContactSurface& surface;
    const ContactLaw& law;
    const Places& places;
    double moved = 0;  // how far vertices have moved at most in all steps [m]
    double since = 0;  // the last step [s]
  };

  // ---- Search

  static constexpr int stations = 2;  // of Places, that it sets

  void rebuild(const ContactSurface& surface, const Model& model);  // of another surface
  void keep_pairs(const At& at);                                    // before all that follows
  void forget() { is_measured_ = false; }

  // ---- Forces

  void add_forces(const At& at, ContactForces& f);
  double energy(const At& at);  // [J]
  // at_point(point of the surface, weight, K) as in tool_contact.h; at_vertex(of the mesh, weight, K).
  template <class AtPoint, class AtVertex>
  void visit_stiffness(const At& at, AtPoint&& at_point, AtVertex&& at_vertex);
  // Of whatever is so near that it may touch soon: triangle(number of the surface), tetrahedron(corners).
  // That does not depend on when it was searched.
  template <class Triangle, class Tetrahedron>
  void visit_close(const At& at, Triangle&& triangle, Tetrahedron&& tetrahedron);

  // ---- What it remembers: of friction ξ of each point. If that is replaced, forget() must follow.

  ContactMemory& memory() { return memory_; }

 private:
  struct Pair {
    int candidate = 0, layer = 0;
    Index tet = -1;         // of the layer
    int rank = 0;           // in ranked_
    int watched = -1;       // in watched_, if it is
    std::uint8_t face = 0;  // the plane of this face of the tetrahedron parted them last
    bool is_held = false;   // a point of the triangle is held in it
    int turned = -100;      // the last measurement since which it was watched
    float gap = 0;          // of the points when it was searched, or less [m]
  };
  struct Candidate {
    int triangle = 0;
    int first = 0, count = 0;  // in pairs_
  };
  struct CloseOnes {  // of a candidate, in close_
    int candidate = 0, first = 0, count = 0;
  };
  struct Link {  // of two parts that were near each other when they were searched
    PartMotion::Meeting meeting;
    PartMotion::Bound bound;
  };
  // Places at a station: of vertices, then of points of the surface that are no vertices.
  struct Placed {
    struct Between {
      Eigen::Vector4i of;  // places of vertices
      Eigen::Vector4d weights;
      template <class Number>  // four numbers per place, of which the last stays as it is
      void find(const Number* rows, Number* own) const {
        for (int d = 0; d < 3; ++d) {
          own[d] = 0;
          for (int c = 0; c < 4; ++c) own[d] += Number(weights[c]) * rows[std::size_t(4 * of[c] + d)];
        }
      }
    };
    std::vector<Index> vertices;
    std::vector<Between> between;
    std::vector<float> x;  // four numbers each, about vertices_[0]
    void fit() { x.resize(4 * (vertices.size() + between.size())); }
    void find_between();
    Vec3d at(int place) const {
      return Eigen::Map<const Vec3<float>>(x.data() + 4 * std::size_t(place)).cast<double>();
    }
  };
  struct Planes {  // of a tetrahedron's faces, n·x − offset > 0 outside, and its corners x
    Eigen::Array4f n[3], offset, x[3];
  };
  struct Four {  // layers of a part, −1 if there is none, and their boxes
    Eigen::Vector4i layers;
    Eigen::Array4f low[3], high[3];
  };
  struct FaceNow {                // of a triangle of the surface, where it is first asked for in a pass
    int pass = -1, pressed = -1;  // the last with it; the last with forces on it
    bool is_sound = false;
    Vec3d normal, corner;
    Vec3d to_weights[2];  // barycentric coordinates 1 and 2 of x in its plane: these · (x − corner)
    Mat3<double> speeds;  // of its corners, if they are asked for [m/s]
    Mat3<double> forces;  // on them [N]
  };
  struct KnownFace {  // nearest to a point of a triangle where it was at rest
    int layer = -1;
    Vec3d rest = Vec3d::Zero();  // [m]
    BoundaryLayer::Nearest nearest;
  };
  struct Touch {
    const Candidate* candidate = nullptr;
    const Anchor* anchor = nullptr;  // or none
    int number = 0;                  // of the point
    Vec3d weights = Vec3d::Zero();
    int pair = 0;   // in close_
    int layer = 0;  // behind the face
    int face = 0;   // of the surface
    FaceNow* now = nullptr;
    Vec3d face_weights = Vec3d::Zero();
    Eigen::Vector4d corner_weights = Eigen::Vector4d::Zero();
    double depth = 0, held = 0, stiffness = 0, area = 0;
  };
  struct Inverse {  // of a tetrahedron where it is now: found where it is first asked for in a pass
    Vec3d origin = Vec3d::Zero();
    Mat3<double> to_weights = Mat3<double>::Zero();
    Eigen::Vector4d heights = Eigen::Vector4d::Zero();  // [m]
    bool is_sound = false;
    int pass = -1;
    Eigen::Vector4d weights(const Vec3d& x) const;  // barycentric coordinates
    double gap(const Eigen::Vector4d& weights) const { return (-weights.cwiseProduct(heights)).maxCoeff(); }
  };

  static const std::array<Vec3d, points_per_triangle>& point_weights();
  const BoundaryLayer::Tet& layer_at(int layer) const { return boundary_.tets()[std::size_t(layer)]; }
  void divide_into_parts(const ContactSurface& surface);
  void number_places(const ContactSurface& surface);
  void measure(const At& at, double ahead);
  bool find_room(const At& at, double ahead);
  double room_for_others();
  bool look(const At& at);
  void clear_close();
  void take_close(int pair, std::size_t watched);
  void choose_look_room(double speed, double since);
  void search(const ContactSurface& surface);
  void find_boxes();
  static void find_planes(const Mat34<double>& x, Planes& planes);
  void link_parts();
  void find_pairs(const ContactSurface& surface);
  void find_pairs_of(const ContactSurface& surface, int triangle);
  void take_candidates(const ContactSurface& surface);
  static void copy_lane(const PairBlock& from, std::size_t lane, PairBlock& to, std::size_t at);
  void rank_pairs(const std::vector<PairBlock>& blocks);
  void mark_held();
  void find_watched();
  std::size_t pairs_that_may_be_within(double gap) const;
  template <class Visit>
  static void visit_within(const std::vector<PairBlock>& blocks, float limit, std::size_t some,
                           Visit&& visit);
  void turn_normals(float limit, std::size_t some);
  void find_places(const At& at, int station, Placed& placed) const;
  void find_gaps(const Placed& placed, std::vector<PairBlock>& blocks, std::size_t pairs) const;
  void place_watched();
  struct PairPlaces {
    Mat3<double> triangle;
    Mat34<double> tet;
  };
  PairPlaces places_in(const PairBlock& block, std::size_t lane) const;
  static void set_normal(const PairPlaces& places, const Vec3d& way, PairBlock& block, std::size_t lane);
  std::span<const int> close_of(const CloseOnes& ones) const {
    return {close_.data() + ones.first, std::size_t(ones.count)};
  }
  int nearest_face(int point, int layer, const Vec3d& rest);
  Mat3<double> corners_of(const At& at, int triangle) const;
  Mat3<double> corners_placed(const ContactSurface& surface, int triangle) const;
  // Of the triangle between its outermost points, by its own corners.
  static Mat3<double> outermost(const Mat3<double>& corners) {
    const Vec3d centre = corners.rowwise().mean();
    return ((1 - 1.0 / divisions) * (corners.colwise() - centre)).colwise() + centre;
  }
  const Inverse& inverse(const Places& now, int layer);
  bool is_close(const Places& now, const Mat3<double>& corners, int layer);
  static double gap_beyond(const Mat34<double>& tet, int face, const Mat3<double>& outermost);
  void find_near_pairs(const At& at, const CloseOnes& ones, const Mat3<double>& corners);
  void find_insides(const At& at, bool with_speeds);
  int place_at(int pair, std::size_t corner) const {
    return close_blocks_[std::size_t(pair) / PairBlock::width]
        .places[corner][std::size_t(pair) % PairBlock::width];
  }
  int insides_of(int pair) const {  // bits of points
    return int(insides_[std::size_t(pair) / PairBlock::width].points[std::size_t(pair) % PairBlock::width]);
  }
  Eigen::Vector4d weights_in(int pair, const Vec3d& weights) const;  // barycentric coordinates
  static Vec3d place_at_rest(const BoundaryLayer::Tet& tet, const Eigen::Vector4d& weights);
  FaceNow& face_now(const At& at, int face, bool with_speeds);
  template <class Visit>
  void visit_touches(const At& at, bool with_speeds, Visit&& visit);
  bool find_pair(const CloseOnes& ones, Touch& touch) const;
  bool find_kept_face(const At& at, const CloseOnes& ones, Touch& touch) const;
  bool find_touch(const At& at, const CloseOnes& ones, const Vec3d& x, bool with_speeds, Touch& touch);
  template <int count>
  Eigen::Matrix<double, 3, count> rows_at(const std::vector<double>& rows, int pair, int first) const;
  template <int count>
  void add_at(int pair, int first, const Eigen::Matrix<double, 3, count>& forces);
  void remember(const At& at, const Touch& touch, const Vec3d& slip);
  void give_forces(const At& at, ContactForces& f);
  Vec3d slip_of(const At& at, const Touch& touch, const Vec3d& speed, double pressure) const;

  double friction_;
  BoundaryLayer boundary_;
  std::vector<Index> vertices_;  // of its tetrahedra

  // Parts: of near tetrahedra with what triangles they own.
  PartMotion parts_;
  std::vector<int> part_of_triangle_, part_of_layer_;
  std::vector<int> first_of_part_, of_part_;  // layers
  std::vector<float> rest_x_;                 // of vertices_ at rest, as in Placed [m]
  std::vector<Eigen::Vector4i> places_of_;    // per layer: of its corners in that
  std::vector<Index> place_of_vertex_;        // −1: in no layer

  std::vector<Link> links_;
  std::vector<int> link_of_;  // per pair of parts: −1 if they were not near
  std::vector<Candidate> candidates_;
  std::vector<Pair> pairs_;
  std::vector<FaceOwner> owners_;      // of the candidates' triangles
  std::vector<int> ranked_;            // pairs, by their gaps when they were searched
  std::vector<PairBlock> all_blocks_;  // in that order
  GapKernels kernels_ = gap_kernels(chosen_instruction_set());

  // Of what may touch before the next measurement, and before the next look: pairs.
  std::vector<int> watched_, held_pairs_, close_;
  std::vector<PairBlock> watched_blocks_, turned_blocks_;
  std::vector<std::size_t> turned_;        // ranks
  std::vector<std::uint64_t> is_watched_;  // a bit per pair
  int measurement_ = 0;                    // its number
  std::vector<CloseOnes> close_ones_;
  std::vector<PairBlock> close_blocks_;  // of close_, with places as in watched_placed_
  std::vector<InsideBlock> insides_;
  std::vector<int> close_places_, close_between_, is_close_place_;
  std::vector<Index> close_vertices_;
  // Of those places, four numbers each.
  std::vector<double> now_, speeds_, forces_;  // [m], [m/s], [N]
  std::vector<FaceNow> faces_now_;             // per triangle of the surface
  std::vector<int> pressed_faces_;
  std::vector<KnownFace> known_faces_;  // per point
  std::vector<int> near_pairs_;         // scratch: of a candidate, that no plane is known to part
  std::vector<Inverse> inverses_;
  int pass_ = 0;       // of all touches
  int look_ = 0;       // number of the look
  double near_ = 0;    // pairs that are nearer are always looked at [m]
  double within_ = 0;  // pairs that were farther apart when they were searched are not known [m]
  bool is_searched_ = false, is_measured_ = false;
  double most_room_ = 0;             // of a measurement [m]
  double room_ = 0, look_room_ = 0;  // by how much pairs may come nearer until the next one, and a look [m]
  double next_look_room_ = 0;
  double range_ = 0, moved_ = 0;  // since the look, when that was found; moved until then [m]
  bool is_tuned_ = false;         // next_look_room_, since the last measurement

  Placed placed_, watched_placed_;  // of vertices_; of what is watched
  std::vector<int> place_of_point_, watched_place_of_, used_places_;

  // Scratch of a search.
  std::vector<float> squares_;
  std::vector<Planes> face_planes_;  // per layer
  std::vector<Four> fours_;
  std::vector<int> first_four_;  // per part
  std::vector<int> stamp_of_layer_;
  struct Found {
    int triangle, layer;
    float gap;  // or less [m]
    int face;
  };
  std::vector<Found> found_;

  ContactMemory memory_;
};

template <class Visit>
void SelfContact::visit_touches(const At& at, bool with_speeds, Visit&& visit) {
  ++pass_;
  memory_.held().use(at.surface);
  if (close_.empty()) return;
  find_insides(at, with_speeds);
  const bool is_any_held = memory_.held().any();
  AnchorReader anchors = memory_.anchors();
  Touch touch;
  for (const CloseOnes& ones : close_ones_) {
    int inside = 0;
    for (int i = ones.first; i < ones.first + ones.count; ++i) inside |= std::max(0, insides_of(i));
    if (inside == 0 && !is_any_held) continue;
    touch.candidate = &candidates_[std::size_t(ones.candidate)];
    const FaceOwner& owner = at.surface.triangles()[std::size_t(touch.candidate->triangle)].owner;
    Mat3<double> corners;
    for (std::size_t c = 0; c < 3; ++c)
      corners.col(Eigen::Index(c)) = Eigen::Map<const Vec3d>(&now_[4 * std::size_t(place_at(ones.first, c))]);
    for (unsigned int left = is_any_held ? (1U << points_per_triangle) - 1 : unsigned(inside); left != 0;
         left &= left - 1) {
      touch.number = std::countr_zero(left);
      touch.anchor = anchors.find(owner, divisions, touch.number);
      if ((inside >> touch.number & 1) == 0 && !touch.anchor) continue;
      touch.weights = point_weights()[std::size_t(touch.number)];
      if (find_touch(at, ones, corners * touch.weights, with_speeds, touch)) visit(touch);
    }
  }
}

template <class AtPoint, class AtVertex>
void SelfContact::visit_stiffness(const At& at, AtPoint&& at_point, AtVertex&& at_vertex) {
  visit_touches(at, false, [&](const Touch& touch) {
    const Mat3<double> along = touch.now->normal * touch.now->normal.transpose();
    const double k = touch.area * touch.stiffness;
    Mat3<double> K = k * along;
    const auto& triangles = at.surface.triangles();
    for (int c = 0; c < 3; ++c)
      at_point(triangles[std::size_t(touch.face)].points[c], touch.face_weights[c], K);
    const Mat3<double> across = k / 2 * (Mat3<double>::Identity() - along);
    if (friction_ > 0) K += across;
    for (int c = 0; c < 3; ++c)
      at_point(triangles[std::size_t(touch.candidate->triangle)].points[c], touch.weights[c], K);
    if (friction_ == 0) return;
    for (int c = 0; c < 4; ++c) at_vertex(layer_at(touch.layer).corners[c], touch.corner_weights[c], across);
  });
}

template <class Triangle, class Tetrahedron>
void SelfContact::visit_close(const At& at, Triangle&& triangle, Tetrahedron&& tetrahedron) {
  ++pass_;
  for (const CloseOnes& ones : close_ones_) {
    const Candidate& candidate = candidates_[std::size_t(ones.candidate)];
    const Mat3<double> corners = corners_of(at, candidate.triangle);
    bool is_any_close = false;
    find_near_pairs(at, ones, corners);
    for (int i : near_pairs_) {
      const Pair& pair = pairs_[std::size_t(i)];
      if (!is_close(at.places, corners, pair.layer)) continue;
      is_any_close = true;
      tetrahedron(layer_at(pair.layer).corners);
    }
    if (is_any_close) triangle(candidate.triangle);
  }
}

}  // namespace lobe
