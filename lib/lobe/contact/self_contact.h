// A body against itself: organ against organ, the lips of a cut, pieces that have fallen.
//
// A point x_q of a surface triangle that lies in a tetrahedron of the boundary layer, at the barycentric coordinates b,
// was at rest at X = Σ b_i X_i: there the face of the boundary that it has come through is the nearest one, however deep
// the two overlap now. With that face where it is now, of normal n and corners x_j,
//   g = n·(x_q − x_1),  p = κ ⟨−g⟩,  f_q = A_q p n,  f_j = −w_j f_q,
// w the barycentric coordinates of the foot of x_q in the face's plane: minus the gradient of ½ κ A_q ⟨−g⟩², so that
// energy, momentum and angular momentum are kept. A slit, whose lips lie on each other, has no force until they
// overlap. Both sides are asked; κ is half of κ_q κ_f/(κ_q + κ_f), so that both together give no vertex more than it
// may have (contact_surface.h). A triangle never touches the tetrahedra around it; on skin, neither those around its
// neighbours.
//
// Friction is Coulomb's, with a spring per point whose length ξ grows by what the two slide past each other.
#pragma once

#include <limits>

#include "lobe/contact/anchors.h"
#include "lobe/contact/contact_law.h"
#include "lobe/contact/contact_surface.h"
#include "lobe/contact/quadrature.h"

namespace lobe {

class SelfContact {
 public:
  static constexpr int divisions = 2;  // of the edges of a triangle: 4 points

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

  // ---- Forces. x, v, f: one column for each of points(); of_mesh: for each of vertices().

  struct At {
    const ContactSurface& surface;
    const ContactLaw& law;
    const Mat3X<double>& x;  // [m]
    const Mat3X<double>& v;  // [m/s]
    const Mat3X<double>& of_mesh;
    double since = 0;  // the last step [s]
  };
  void add_forces(const At& at, Mat3X<double>& f);  // [N]
  double energy(const At& at);                      // [J]
  // visit(point, weight, K) as in tool_contact.h.
  template <class Visit>
  void visit_stiffness(const At& at, Visit&& visit);

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
    int first = 0, count = 0;  // of the surface's triangles that it owns
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
    double depth = 0, stiffness = 0, area = 0;
    int anchor = 0;
  };
  struct Inverse {
    Vec3d origin = Vec3d::Zero();
    Mat3<double> to_weights = Mat3<double>::Zero();
    bool is_sound = false;
  };

  void fill_grid(const Mat3X<double>& of_mesh, double margin, double cell);
  void find_excluded(const ContactSurface& surface, int triangle, int stamp);
  void take_candidates(const ContactSurface& surface);
  int face_at(const Layer& layer, const Vec3d& rest) const;
  void invert(const At& at);
  template <class Visit>
  void visit_touches(const At& at, Visit&& visit);
  bool find_touch(const At& at, const Candidate& own, const Vec3d& weights, Touch& touch) const;
  Vec3d friction_of(const At& at, const Touch& touch, double pressure);

  double friction_;
  std::vector<Layer> layers_;
  std::vector<Plane> planes_;                     // per triangle of the surface
  std::vector<Mat3<double>> rest_;                // their corners [m]
  std::vector<int> first_around_, around_;        // triangles around each point of the surface
  std::vector<int> first_of_vertex_, of_vertex_;  // and around each vertex of the mesh

  std::vector<Candidate> candidates_;
  std::vector<std::pair<int, int>> pairs_;  // triangle, layer
  std::vector<Other> tets_;                 // of the candidates, and where each is in unique_
  std::vector<int> unique_of_;
  std::vector<Other> unique_;
  std::vector<Inverse> inverses_;
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
  invert(at);
  Touch touch;
  for (const Candidate& own : candidates_)
    visit_centroids(divisions, [&](int number, const Vec3d& weights) {
      if (!find_touch(at, own, weights, touch)) return;
      touch.anchor = own.anchor + number;
      visit(touch);
    });
}

template <class Visit>
void SelfContact::visit_stiffness(const At& at, Visit&& visit) {
  visit_touches(at, [&](const Touch& touch) {
    const Vec3d& n = touch.normal;
    const double k = touch.area * touch.stiffness;
    Mat3<double> K = k * n * n.transpose();
    if (friction_ > 0) K += k / 2 * (Mat3<double>::Identity() - n * n.transpose());
    for (int c = 0; c < 3; ++c) {
      visit(touch.candidate->points[c], touch.weights[c], K);
      visit(touch.face_points[c], touch.face_weights[c], K);
    }
  });
}

}  // namespace lobe
