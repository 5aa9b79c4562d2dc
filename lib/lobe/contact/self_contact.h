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
// A triangle may touch a tetrahedron that has a vertex of it or of its neighbours only where that lies in
// front of it at rest: across a slit or a fold. What lies behind it, its own side, cannot be where it is.
//
// Friction follows Coulomb's law, with a spring per point. The length ξ of the spring grows by the sliding of
// both sides past each other. Friction acts on the tetrahedron at the place of x_q, by −b_i f_t on its
// corners.
//
// Cost. A search finds the pairs of a triangle and a tetrahedron that are near each other (self_search.cpp).
// Which of them may have come so near that a point may be inside follows from the motion of parts of the body
// (part_motion.h), every few steps. Those alone are looked at, each no sooner than the body has moved by half
// of its gap; and there is no other search until one of the pairs that were not found may be that near.
#pragma once

#include <limits>
#include <span>

#include "lobe/contact/contact_law.h"
#include "lobe/contact/contact_memory.h"
#include "lobe/contact/contact_surface.h"
#include "lobe/contact/part_motion.h"
#include "lobe/contact/places.h"
#include "lobe/contact/quadrature.h"

namespace lobe {

class SelfContact {
 public:
  static constexpr int divisions = 3;  // of the edges of a triangle
  static constexpr int points_per_triangle = divisions * divisions;

  explicit SelfContact(double friction) : friction_(friction) {}

  // ---- Search. `moved`: how far vertices have moved at most in all steps [m].

  void rebuild(const ContactSurface& surface, const Model& model);  // of another surface
  // Searches if pairs that are not known may have come near, by how far the body has moved or, if that is too
  // far, by where its vertices are.
  void keep_pairs(const ContactSurface& surface, const Places& now, double moved);
  void forget() { knows_until_ = -std::numeric_limits<double>::infinity(); }

  // ---- Forces

  struct At {
    const ContactSurface& surface;
    const ContactLaw& law;
    const Places& places;
    double moved = 0;  // [m]
    double since = 0;  // the last step [s]
  };
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
  struct Layer {  // a tetrahedron with a corner on the boundary
    Index tet = -1;
    Eigen::Vector4i corners;
    Mat34<double> rest;        // its corners [m]
    int first = 0, count = 0;  // in faces_: triangles of the surface that may be nearest to a point in it
  };
  struct Plane {  // of a triangle at rest
    Vec3d normal, corner;
  };
  struct Pair {
    int layer = 0;
    int link = 0;           // in links_: of the triangle's part and the tetrahedron's
    float gap = 0;          // of the points when it was searched, or less [m]
    std::uint8_t face = 0;  // the plane of this face of the tetrahedron parted them last
    double due = 0;         // how far the body must have moved for a point to be inside [m]
  };
  struct Candidate {
    int triangle = 0, part = 0;
    int first = 0, count = 0;                            // in pairs_, by their gaps
    double due = 0;                                      // the least of its suspects
    float gap = std::numeric_limits<float>::infinity();  // the least, when it was searched [m]
    int first_suspect = 0, suspects = 0;                 // in suspects_
  };
  struct Link {  // of two parts that were near each other when they were searched
    int a, b;
    PartMotion::Bound bound;
  };
  struct Planes {  // of a tetrahedron's faces, n·x − offset > 0 outside, and its corners x, about origin_
    Eigen::Array4f n[3], offset, x[3];
  };
  struct Four {  // layers of a part, −1 if there is none, and their boxes
    Eigen::Vector4i layers;
    Eigen::Array4f low[3], high[3];
  };
  struct Touch {
    const Candidate* candidate = nullptr;
    const Anchor* anchor = nullptr;  // or none
    int number = 0;                  // of the point
    Vec3d weights = Vec3d::Zero();
    int face = 0;   // of the surface
    int layer = 0;  // behind it
    Vec3d face_weights = Vec3d::Zero(), normal = Vec3d::Zero();
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

  void find_faces(Layer& layer);
  std::vector<int> vertices_around(const ContactSurface& surface, int triangle);
  void list_own_layers(const ContactSurface& surface);
  bool is_on_its_side(int triangle, const Layer& layer) const;
  void divide_into_parts(const ContactSurface& surface);
  void search(const ContactSurface& surface, double moved);
  void find_boxes();
  static void find_planes(const Mat34<double>& x, Planes& planes);
  void link_parts();
  void find_pairs(const ContactSurface& surface);
  void find_pairs_of(const ContactSurface& surface, int triangle);
  void take_candidates(const ContactSurface& surface, double moved);
  double room_for_others();
  void find_due(double moved);
  std::span<const int> suspects_of(const Candidate& candidate) const {
    return {suspects_.data() + candidate.first_suspect, std::size_t(candidate.suspects)};
  }
  int face_at(const Layer& layer, const Vec3d& rest) const;
  Mat3<double> corners_of(const At& at, int triangle) const;
  Mat3<double> corners_now(const ContactSurface& surface, int triangle) const;  // by x_
  // Of the triangle between its outermost points, by its own corners.
  static Mat3<double> outermost(const Mat3<double>& corners) {
    const Vec3d centre = corners.rowwise().mean();
    return ((1 - 1.0 / divisions) * (corners.colwise() - centre)).colwise() + centre;
  }
  const Inverse& inverse(const Places& now, int layer);
  bool is_close(const Places& now, const Mat3<double>& corners, int layer);
  static double gap_beyond(const Mat34<double>& tet, int face, const Mat3<double>& outermost);
  void find_near_pairs(const At& at, const Candidate& candidate, const Mat3<double>& corners);
  template <class Visit>
  void visit_touches(const At& at, Visit&& visit);
  int find_tet(const At& at, const Candidate& candidate, const Vec3d& x, const Anchor* anchor,
               Eigen::Vector4d& b);
  bool find_kept_face(const At& at, const Candidate& candidate, const Vec3d& x, Touch& touch);
  bool find_touch(const At& at, const Candidate& candidate, const Vec3d& x, Touch& touch);
  void put_off(Candidate& candidate, double moved);
  Vec3d speed_of(const At& at, const Touch& touch) const;
  Vec3d slip_of(const At& at, const Touch& touch, double pressure) const;

  double friction_;
  std::vector<Layer> layers_;
  std::vector<Index> vertices_;                   // of the layers
  std::vector<Plane> planes_;                     // per triangle of the surface
  std::vector<Mat3<double>> rest_;                // their corners [m]
  std::vector<int> faces_;                        // of the layers
  std::vector<int> first_around_, around_;        // triangles around each point of the surface
  std::vector<int> first_of_vertex_, of_vertex_;  // and around each vertex of the mesh
  std::vector<int> first_own_, own_;              // per triangle: tetrahedra that it never touches

  // Parts: of near tetrahedra with what triangles they own.
  PartMotion parts_;
  std::vector<int> part_of_triangle_, part_of_layer_;
  std::vector<int> first_of_part_, of_part_;  // layers
  Mat3X<double> x_;                           // of vertices_, when they were measured [m]
  Mat3X<double> rest_x_;                      // at rest [m]
  std::vector<Eigen::Vector4i> places_of_;    // per layer: of its corners in that
  std::vector<Index> place_of_vertex_;        // −1: in no layer

  std::vector<Link> links_;
  std::vector<int> link_of_;  // per pair of parts: −1 if they were not near
  std::vector<PartMotion::Bound> worst_of_part_;
  std::vector<Candidate> candidates_;
  // Of what may touch before the next measurement: pairs, and their candidates.
  std::vector<int> suspects_, watched_, last_suspects_;
  std::vector<Pair> pairs_;
  std::vector<double> gaps_;     // scratch: per pair, of the points that were looked at
  std::vector<int> near_pairs_;  // scratch: of a candidate, that no plane is known to part
  std::vector<Inverse> inverses_;
  int pass_ = 0;       // of all touches
  double near_ = 0;    // pairs that are nearer are always looked at [m]
  double within_ = 0;  // pairs that were farther apart when they were searched are not known [m]
  double often_ = 0;   // parts are measured when the body has moved by this [m]
  double knows_until_ = -std::numeric_limits<double>::infinity();  // how far it may have moved before [m]

  // Scratch of a search, about origin_.
  Vec3d origin_ = Vec3d::Zero();
  std::vector<float> squares_;
  std::vector<Planes> face_planes_;  // per layer
  std::vector<Four> fours_;
  std::vector<int> first_four_;  // per part
  std::vector<int> stamp_of_vertex_, stamp_of_layer_;
  struct Found {
    int triangle, layer, link;
    float gap;  // or less [m]
    int face;
  };
  std::vector<Found> found_;

  ContactMemory memory_;
};

template <class Visit>
void SelfContact::visit_touches(const At& at, Visit&& visit) {
  ++pass_;
  memory_.held().use(at.surface);
  AnchorReader anchors = memory_.anchors();
  Touch touch;
  for (int number_of : watched_) {
    Candidate& candidate = candidates_[std::size_t(number_of)];
    if (candidate.due > at.moved) continue;
    const Mat3<double> corners = corners_of(at, candidate.triangle);
    find_near_pairs(at, candidate, corners);
    if (!near_pairs_.empty() || memory_.held().any()) {
      const FaceOwner& owner = at.surface.triangles()[std::size_t(candidate.triangle)].owner;
      touch.candidate = &candidate;
      visit_centroids(divisions, [&](int number, const Vec3d& weights) {
        touch.number = number;
        touch.weights = weights;
        touch.anchor = anchors.find(owner, divisions, number);
        if (find_touch(at, candidate, corners * weights, touch)) visit(touch);
      });
    }
    put_off(candidate, at.moved);
  }
}

template <class AtPoint, class AtVertex>
void SelfContact::visit_stiffness(const At& at, AtPoint&& at_point, AtVertex&& at_vertex) {
  visit_touches(at, [&](const Touch& touch) {
    const Mat3<double> along = touch.normal * touch.normal.transpose();
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
    for (int c = 0; c < 4; ++c)
      at_vertex(layers_[std::size_t(touch.layer)].corners[c], touch.corner_weights[c], across);
  });
}

template <class Triangle, class Tetrahedron>
void SelfContact::visit_close(const At& at, Triangle&& triangle, Tetrahedron&& tetrahedron) {
  ++pass_;
  for (int number : watched_) {
    const Candidate& candidate = candidates_[std::size_t(number)];
    if (candidate.due > at.moved) continue;
    const Mat3<double> corners = corners_of(at, candidate.triangle);
    bool is_any_close = false;
    for (int i : suspects_of(candidate)) {
      const Pair& pair = pairs_[std::size_t(i)];
      if (pair.due > at.moved || !is_close(at.places, corners, pair.layer)) continue;
      is_any_close = true;
      tetrahedron(layers_[std::size_t(pair.layer)].corners);
    }
    if (is_any_close) triangle(candidate.triangle);
  }
}

}  // namespace lobe
