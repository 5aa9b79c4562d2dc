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
// A pair is looked at again only when the body has moved so far that its points may be inside by then.
#pragma once

#include <limits>

#include "lobe/contact/contact_law.h"
#include "lobe/contact/contact_memory.h"
#include "lobe/contact/contact_surface.h"
#include "lobe/contact/places.h"
#include "lobe/contact/quadrature.h"

namespace lobe {

// A plane along a face of a tetrahedron, or along the triangle, parts the two by this; 0 or less: none does.
double gap_between(const Mat3<double>& triangle, const Mat34<double>& tet);

class SelfContact {
 public:
  static constexpr int divisions = 3;  // of the edges of a triangle
  static constexpr int points_per_triangle = divisions * divisions;

  explicit SelfContact(double friction) : friction_(friction) {}

  // ---- Search. `moved`: how far vertices have moved at most in all steps [m].

  void rebuild(const ContactSurface& surface, const Model& model);  // of another surface
  // Whether pairs that are not known may have come near, by how far the body has moved; if that is too far,
  // by where its vertices are.
  bool is_outdated(const Places& now, double moved);
  void search(const ContactSurface& surface, const Places& now, double moved);
  void forget() { slack_ = -1; }

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
    double due = 0;  // how far the body must have moved for a point to be inside [m]
  };
  struct Candidate {
    int triangle = 0;
    int first = 0, count = 0;  // in pairs_
    double due = 0;            // the least of its pairs
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

  void fill_grid(const Places& now, double margin, double cell);
  void find_faces(Layer& layer);
  std::vector<int> vertices_around(const ContactSurface& surface, int triangle);
  void list_own_layers(const ContactSurface& surface);
  bool is_on_its_side(int triangle, const Layer& layer) const;
  void find_pairs(const ContactSurface& surface, const Places& now, double within);
  void take_candidates(const ContactSurface& surface, double moved);
  double moved_since_search(const Places& now) const;
  int face_at(const Layer& layer, const Vec3d& rest) const;
  Mat3<double> corners_of(const At& at, int triangle) const;
  static Mat34<double> corners_of(const Places& now, const Layer& layer);
  const Inverse& inverse(const Places& now, int layer);
  double gap_of_points(const Places& now, const Mat3<double>& corners, int layer);
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

  std::vector<Candidate> candidates_;
  std::vector<Pair> pairs_;
  std::vector<double> gaps_;  // scratch: per pair, of the points that were looked at
  std::vector<Inverse> inverses_;
  int pass_ = 0;                    // of all touches
  double near_ = 0;                 // pairs that are nearer are always looked at [m]
  double slack_ = -1;               // by how much vertices may move, before pairs are searched anew [m]
  double left_ = 0;                 // of it, when they were measured last
  double measured_at_ = 0;          // in terms of how far the body had moved
  std::vector<Vec3d> searched_at_;  // where vertices_ were then

  // Scratch of a search: a uniform grid of the layer's boxes.
  Vec3d low_ = Vec3d::Zero();
  Eigen::Vector3i count_ = Eigen::Vector3i::Zero();
  double cell_ = 0;
  std::vector<Vec3d> box_low_, box_high_;
  std::vector<int> first_in_, in_cell_, stamp_of_vertex_, stamp_of_layer_;
  struct Found {
    int triangle, layer;
    double gap;  // or less [m]
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
  for (Candidate& candidate : candidates_) {
    if (candidate.due > at.moved) continue;
    const Mat3<double> corners = corners_of(at, candidate.triangle);
    const FaceOwner& owner = at.surface.triangles()[std::size_t(candidate.triangle)].owner;
    touch.candidate = &candidate;
    std::fill_n(gaps_.begin() + candidate.first, candidate.count, std::numeric_limits<double>::infinity());
    visit_centroids(divisions, [&](int number, const Vec3d& weights) {
      touch.number = number;
      touch.weights = weights;
      touch.anchor = anchors.find(owner, divisions, number);
      if (find_touch(at, candidate, corners * weights, touch)) visit(touch);
    });
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
  for (const Candidate& candidate : candidates_) {
    if (candidate.due > at.moved) continue;
    const Mat3<double> corners = corners_of(at, candidate.triangle);
    bool is_close = false;
    for (int i = candidate.first; i < candidate.first + candidate.count; ++i) {
      const Pair& pair = pairs_[std::size_t(i)];
      if (pair.due > at.moved || gap_of_points(at.places, corners, pair.layer) > near_) continue;
      is_close = true;
      tetrahedron(layers_[std::size_t(pair.layer)].corners);
    }
    if (is_close) triangle(candidate.triangle);
  }
}

}  // namespace lobe
