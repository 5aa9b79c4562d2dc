// One rigid tool against the surface of a body, by a penalty pressure at fixed points of its triangles.
//
//   g = φ(x_q),  p = κ ⟨−g⟩ + δ κ ⟨−v_n⟩ where g < 0,  f_i += A_q w_qi p ∇φ,  W = Σ ½ κ A_q ⟨−g⟩²
//
// with φ the signed distance to the tool, x_q = Σ w_qi x_i the q-th of the n² points of a triangle, A_q the
// share of its area at rest, v_n the speed along ∇φ against the tool's. Since the points stay where they are
// in their triangles, W is a potential of the vertices' positions: energy is kept, and the force is
// continuous while the tool slides. Beyond a depth of `deepest` the pressure grows no more. n is such that
// points are no further apart than half of the tool's radius.
//
// Friction follows Coulomb's law with Cundall's springs. Each point that touches has an anchor on the tool,
//   f_t = −k_t A_q ξ,  k_t = κ/2,  |f_t| ≤ μ p A_q,
// where ξ is the tangential part of the way from the anchor to the point. If the bound is exceeded, the
// anchor slides after the point.
#pragma once

#include "lobe/contact/anchors.h"
#include "lobe/contact/contact_law.h"
#include "lobe/contact/contact_surface.h"
#include "lobe/contact/quadrature.h"
#include "lobe/contact/rigid_motion.h"
#include "lobe/contact/signed_distance.h"
#include "lobe/setup/contact_setup.h"

namespace lobe {

class ToolContact {
 public:
  ToolContact(int tool, const RigidShape& shape) : tool_(tool), shape_(shape), distance_(shape) {}

  // What stays where it is: of a number below 0.
  ToolContact(int number, const ObstacleSetup& obstacle);

  int tool() const { return tool_; }
  bool is_obstacle() const { return tool_ < 0; }
  void begin_frame(const ToolBody& body, double time);
  bool is_of(const ToolBody& body) const { return body.tool == tool_ && *body.shape == shape_; }
  bool is_there(double time) const { return time >= appears_ - just_before && time < goes_ - just_before; }

  // ---- Search: the triangles that may touch it, until it and they have moved by too much.

  // Whether the body moved by `move` since, on top of what it was told of, and the tool until then allow for
  // the candidates that there are.
  bool is_outdated(double time, double body_moved) const;
  // x: positions of the surface's points [m]; `ahead`: how far it and they will move at least [m].
  void search(const ContactSurface& surface, const Mat3X<double>& x, double time, double body_moved,
              double ahead);
  void forget() { slack_ = -1; }
  // The farthest that it moves until a time [m].
  double moves_until(double from, double to) const {
    return farthest_move(path_, from, to, distance_.reach());
  }
  const std::vector<int>& points() const { return points_; }  // of the surface, that candidates have

  // ---- Forces. x, v, f: one column for each of points().

  struct At {
    const ContactSurface& surface;
    const ContactLaw& law;
    double time = 0;
    const Mat3X<double>& x;  // [m]
    const Mat3X<double>& v;  // [m/s]
  };
  void add_forces(const At& at, Mat3X<double>& f);  // [N]
  const OnTool& on_tool() const { return on_tool_; }
  double energy(const At& at) const;  // [J]
  // visit(point, weight, K): each touch, whose stiffness K, 3 × 3 [N/m], a point shares by its weight.
  template <class Visit>
  void visit_stiffness(const At& at, Visit&& visit) const {
    const RigidMotion now = motion_at(path_, at.time);
    visit_touches(at, now, [&](const Candidate& own, const Touch& touch) {
      const ContactSurface::Triangle& triangle = at.surface.triangles()[std::size_t(own.triangle)];
      const double k = triangle.stiffness * triangle.area / (own.divisions * own.divisions);
      const Vec3d n = now.turn * touch.gradient;
      Mat3<double> K = k * n * n.transpose();
      if (friction_ > 0) K += k / 2 * (Mat3<double>::Identity() - n * n.transpose());
      for (int c = 0; c < 3; ++c) visit(own.points[c], touch.weights[c], K);
    });
  }

  // visit(triangle of the surface) of what it may reach until a time, as things are now; one column of x for
  // each of points(). That does not depend on when it was searched.
  template <class Visit>
  void visit_close(const Mat3X<double>& x, double time, double until, Visit&& visit) const {
    const RigidMotion now = motion_at(path_, time);
    const double ahead = moves_until(time, until);
    for (const Candidate& own : candidates_)
      if (gap_to(x(Eigen::all, own.points), now) <= ahead) visit(own.triangle);
  }

  // ---- Anchors

  void end_step();  // anchors of the last evaluation of forces hold from now on
  const Anchors& anchors() const { return anchors_; }
  void set_anchors(const Anchors& anchors) {
    kept_ = anchors;
    use_kept();
  }
  void keep_anchors() { kept_ = anchors_; }
  void take_back() { use_kept(); }

 private:
  struct Candidate {
    int triangle = 0;
    Eigen::Vector3i points;  // places in points_
    int divisions = 1;
    int first = 0;  // of its anchors
  };
  struct Touch {  // at a point of a triangle, in the tool's axes
    Vec3d weights;
    int anchor;
    double depth;
    Vec3d gradient, place;
  };
  double gap_to(const Mat3<double>& triangle, const RigidMotion& now) const;  // or less [m]
  template <class Visit>                                                      // visit(candidate, touch)
  void visit_touches(const At& at, const RigidMotion& now, Visit&& visit) const;
  Vec3d friction_of(const Touch& touch, double stiffness, double pressure, Anchors& anchors) const;
  void use_kept();

  int tool_;
  RigidShape shape_;
  SignedDistance distance_;
  double friction_ = 0, appears_ = 0, goes_ = 0;
  std::vector<PathPoint> path_;  // around the frame

  std::vector<Candidate> candidates_;
  std::vector<int> points_, place_of_;  // place_of_: per point of the surface, −1
  double slack_ = -1;                   // by how much they may move together [m]
  double body_moved_ = 0;               // when they were searched [m]
  double moved_ = 0;                    // by the tool since, until moved_at_ [m], [s]
  double moved_at_ = 0;

  Anchors anchors_, next_, kept_;  // of now, after the step that is under way, when steps began
  OnTool on_tool_;
};

template <class Visit>
void ToolContact::visit_touches(const At& at, const RigidMotion& now, Visit&& visit) const {
  for (const Candidate& own : candidates_) {
    Mat3<double> x;
    for (int c = 0; c < 3; ++c) x.col(c) = now.turn.transpose() * (at.x.col(own.points[c]) - now.position);
    const Vec3d centre = x.rowwise().sum() / 3;
    const double radius = std::sqrt((x.colwise() - centre).colwise().squaredNorm().maxCoeff());
    if (distance_.at(centre, now.opening).value > radius + distance_.error()) continue;
    visit_centroids(own.divisions, [&](int number, const Vec3d& weights) {
      const Vec3d place = x * weights;
      const Distance g = distance_.at(place, now.opening);
      if (g.value < 0) visit(own, Touch{weights, own.first + number, -g.value, g.gradient, place});
    });
  }
}

}  // namespace lobe
