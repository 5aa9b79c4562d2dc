// A body against itself: organ against organ, the lips of a cut, pieces that have fallen.
//
// A point x_q of a surface triangle that lies in a tetrahedron of the boundary layer, at the barycentric
// coordinates b, was at rest at X = Σ b_i X_i: there the face of the boundary that it has come through is the
// nearest one, however deep the two overlap now. With that face where it is now, of normal n and corners x_j,
//   g = n·(x_q − x_1),  p = κ ⟨−g⟩,  f_q = A_q p n,  f_j = −w_j f_q,
// w the barycentric coordinates of the foot of x_q in the face's plane: minus the gradient of ½ κ A_q ⟨−g⟩²,
// so that momentum and angular momentum are kept, and energy but for where another face becomes the nearest.
// A slit, whose lips lie on each other, has no force until they overlap. Both sides are evaluated. κ is half
// of κ_q κ_f/(κ_q + κ_f), so that both together give no vertex more stiffness than it may have
// (contact_surface.h).
//
// A triangle may touch a tetrahedron that has a vertex of it or of its neighbours only where that lies in
// front of it at rest: across a slit or a fold. What lies behind it, its own side, cannot be where it is.
//
// Friction follows Coulomb's law, with a spring per point. The length ξ of the spring grows by the sliding of
// both sides past each other. Friction acts on the tetrahedron at the place of x_q, by −b_i f_t on its
// corners.
#pragma once

#include <limits>

#include "lobe/contact/anchors.h"
#include "lobe/contact/contact_law.h"
#include "lobe/contact/contact_surface.h"
#include "lobe/contact/quadrature.h"

namespace lobe {

// Whether a plane along a face of a tetrahedron, or along the triangle, parts the two by more than a gap [m].
bool are_apart(const Mat3<double>& triangle, const Mat34<double>& tet, double gap);

class SelfContact {
 public:
  static constexpr int divisions = 3;  // of the edges of a triangle
  static constexpr int points_per_triangle = divisions * divisions;

  explicit SelfContact(double friction) : friction_(friction) {}

  // ---- Search

  void rebuild(const ContactSurface& surface, const Model& model);  // of another surface
  bool is_outdated(double body_moved) const { return slack_ < 0 || body_moved - body_moved_ > slack_; }
  // x: positions of the surface's points, and of the mesh's vertices [m].
  void search(const ContactSurface& surface, const Model& model, const Mat3X<double>& x,
              const Mat3X<double>& of_mesh, double body_moved);
  void forget() { slack_ = -1; }
  const std::vector<int>& points() const { return points_; }        // of the surface, that candidates have
  const std::vector<Index>& vertices() const { return vertices_; }  // of the mesh, that candidates have
  bool has_friction() const { return friction_ > 0; }

  // ---- Forces. x, v, f: one column for each of points(); of_mesh, v_of_mesh, f_of_mesh: for each of
  // vertices().

  struct At {
    const ContactSurface& surface;
    const ContactLaw& law;
    const Mat3X<double>& x;  // [m]
    const Mat3X<double>& v;  // [m/s]
    const Mat3X<double>& of_mesh;
    const Mat3X<double>& v_of_mesh;  // with friction only
    double since = 0;                // the last step [s]
  };
  void add_forces(const At& at, Mat3X<double>& f, Mat3X<double>& f_of_mesh);  // [N]
  double energy(const At& at);                                                // [J]
  // at_point(place in points(), weight, K) as in tool_contact.h; at_vertex(place in vertices(), weight, K).
  template <class AtPoint, class AtVertex>
  void visit_stiffness(const At& at, AtPoint&& at_point, AtVertex&& at_vertex);
  // Of whatever may overlap now: triangle(number of the surface), tetrahedron(places in vertices()).
  template <class Triangle, class Tetrahedron>
  void visit_close(const At& at, Triangle&& triangle, Tetrahedron&& tetrahedron) const;

  // ---- What friction remembers: ξ of each point [m]

  void end_step() { std::swap(anchors_, next_); }
  const Anchors& anchors() const { return anchors_; }
  void set_anchors(const Anchors& anchors) {
    anchors_ = next_ = anchors;
    forget();
  }
  void keep_anchors() { kept_ = anchors_; }
  void take_back() { set_anchors(kept_); }

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
  struct Candidate {
    int triangle = 0;
    Eigen::Vector3i points = Eigen::Vector3i::Zero();  // places in points_
    int first = 0, count = 0;                          // in tets_
    int anchor = 0;
  };
  struct Other {  // a tetrahedron that a candidate may be in
    int layer = 0;
    Eigen::Vector4i corners = Eigen::Vector4i::Zero();  // places in vertices_
  };
  struct Touch {
    const Candidate* candidate = nullptr;
    Vec3d weights = Vec3d::Zero();
    int face = 0;                                           // of the surface
    Eigen::Vector3i face_points = Eigen::Vector3i::Zero();  // places in points_
    Vec3d face_weights = Vec3d::Zero(), normal = Vec3d::Zero();
    Eigen::Vector4i corners = Eigen::Vector4i::Zero();  // of the tetrahedron: places in vertices_
    Eigen::Vector4d corner_weights = Eigen::Vector4d::Zero();
    double depth = 0, stiffness = 0, area = 0;
    int anchor = 0;
  };
  struct Inverse {  // of a tetrahedron where it is now: found where it is first asked for in a step
    Vec3d origin = Vec3d::Zero();
    Mat3<double> to_weights = Mat3<double>::Zero();
    bool is_sound = false;
    int pass = -1;
  };

  void fill_grid(const Mat3X<double>& of_mesh, double margin, double cell);
  void find_faces(Layer& layer);
  void stamp_around(const ContactSurface& surface, int triangle);
  bool is_own(int triangle, const Layer& layer) const;
  void take_candidates(const ContactSurface& surface);
  int face_at(const Layer& layer, const Vec3d& rest) const;
  const Inverse& inverse(const At& at, int unique);
  template <class Visit>
  void visit_touches(const At& at, Visit&& visit);
  int find_tet(const At& at, const Candidate& own, const Vec3d& x, int last, Eigen::Vector4d& b);
  bool find_touch(const At& at, const Candidate& own, const Vec3d& weights, int number, Touch& touch);
  Vec3d friction_of(const At& at, const Touch& touch, double pressure);

  double friction_;
  std::vector<Layer> layers_;
  std::vector<Plane> planes_;                     // per triangle of the surface
  std::vector<Mat3<double>> rest_;                // their corners [m]
  std::vector<int> faces_;                        // of the layers
  std::vector<int> first_around_, around_;        // triangles around each point of the surface
  std::vector<int> first_of_vertex_, of_vertex_;  // and around each vertex of the mesh

  std::vector<Candidate> candidates_;
  std::vector<std::pair<int, int>> pairs_;  // triangle, layer
  std::vector<Other> tets_;                 // of the candidates, and where each is in unique_
  std::vector<int> unique_of_;
  std::vector<Other> unique_;
  std::vector<Inverse> inverses_;
  int pass_ = 0;           // of all touches
  std::vector<int> last_;  // per point of the candidates: the tetrahedron that it was in, −1: none
  std::vector<int> points_, place_of_;  // place_of_: per point of the surface, −1
  std::vector<Index> vertices_;
  double slack_ = -1, body_moved_ = 0;  // [m]

  // Scratch of a search: a uniform grid of the layer's boxes.
  Vec3d low_ = Vec3d::Zero();
  Eigen::Vector3i count_ = Eigen::Vector3i::Zero();
  double cell_ = 0;
  std::vector<Vec3d> box_low_, box_high_;
  std::vector<int> first_in_, in_cell_, stamp_of_vertex_, stamp_of_layer_;

  Anchors anchors_, next_, kept_;
};

template <class Visit>
void SelfContact::visit_touches(const At& at, Visit&& visit) {
  ++pass_;
  Touch touch;
  for (const Candidate& own : candidates_)
    visit_centroids(divisions, [&](int number, const Vec3d& weights) {
      if (!find_touch(at, own, weights, number, touch)) return;
      touch.anchor = own.anchor + number;
      visit(touch);
    });
}

template <class AtPoint, class AtVertex>
void SelfContact::visit_stiffness(const At& at, AtPoint&& at_point, AtVertex&& at_vertex) {
  visit_touches(at, [&](const Touch& touch) {
    const Mat3<double> along = touch.normal * touch.normal.transpose();
    const double k = touch.area * touch.stiffness;
    Mat3<double> K = k * along;
    for (int c = 0; c < 3; ++c) at_point(touch.face_points[c], touch.face_weights[c], K);
    const Mat3<double> across = k / 2 * (Mat3<double>::Identity() - along);
    if (friction_ > 0) K += across;
    for (int c = 0; c < 3; ++c) at_point(touch.candidate->points[c], touch.weights[c], K);
    if (friction_ == 0) return;
    for (int c = 0; c < 4; ++c) at_vertex(touch.corners[c], touch.corner_weights[c], across);
  });
}

template <class Triangle, class Tetrahedron>
void SelfContact::visit_close(const At& at, Triangle&& triangle, Tetrahedron&& tetrahedron) const {
  for (const Candidate& own : candidates_) {
    const Mat3<double> x = at.x(Eigen::all, own.points);
    bool is_close = false;
    for (int i = own.first; i < own.first + own.count; ++i) {
      const Eigen::Vector4i& corners = unique_[std::size_t(unique_of_[std::size_t(i)])].corners;
      if (are_apart(x, at.of_mesh(Eigen::all, corners), 0)) continue;
      is_close = true;
      tetrahedron(corners);
    }
    if (is_close) triangle(own.triangle);
  }
}

}  // namespace lobe
