// One rigid tool against the surface of a body, by a penalty pressure at fixed points of its triangles.
//
//   d = −φ(x_q),  p = κ ⟨d + h⟩ + δ κ ⟨−v_n⟩ where d + h > 0,  f_i += A_q w_qi p ∇φ,  W = Σ ½ κ A_q ⟨d + h⟩²
//
// with φ the signed distance to the tool, x_q = Σ w_qi x_i the q-th of the n² points of a triangle, A_q the
// share of its area at rest, v_n the speed along ∇φ against the tool's, h the depth at which the contact is
// held (contact_law.h). Since the points stay where they are in their triangles, W is a potential of the
// vertices' positions: energy is kept but for what h gives, and the force is continuous while the tool
// slides. n is such that points are no further apart than half of the tool's radius.
//
// Friction follows Coulomb's law with Cundall's springs. Each point that touches has an anchor on the tool,
//   f_t = −k_t A_q ξ,  k_t = κ/2,  |f_t| ≤ μ p A_q,
// where ξ is the tangential part of the way from the anchor to the point. If the bound is exceeded, the
// anchor slides after the point.
#pragma once

#include <limits>

#include "lobe/contact/contact_law.h"
#include "lobe/contact/contact_memory.h"
#include "lobe/contact/contact_surface.h"
#include "lobe/contact/places.h"
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
  // How far it moves at most until a time, so that is_outdated() need not follow its path.
  void look_ahead(double until);
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

  // ---- Forces. f: one column for each of points(). memory().begin_forces() in each evaluation.

  struct At {
    const ContactSurface& surface;
    const ContactLaw& law;
    double time = 0;
    double since = 0;       // the last step [s]
    double body_moved = 0;  // by at most that in all steps [m]
    const Places& places;   // of the surface
  };
  // Sets f at pressed(), those of points() on which there are forces [N].
  void find_forces(const At& at, Mat3X<double>& f);
  const std::vector<int>& pressed() const { return pressed_; }
  const OnTool& on_tool() const { return on_tool_; }
  double energy(const At& at) const;                                        // [J]
  void use(const ContactSurface& surface) { memory_.held().use(surface); }  // before any of these
  // visit(point, weight, K): each touch, whose stiffness K, 3 × 3 [N/m], a point shares by its weight.
  template <class Visit>
  void visit_stiffness(const At& at, Visit&& visit) const {
    if (!find_near(at)) return;
    const RigidMotion now = motion_at(path_, at.time);
    visit_touches(at, now, [&](const Candidate& candidate, const Touch& touch) {
      const ContactSurface::Triangle& triangle = at.surface.triangles()[std::size_t(candidate.triangle)];
      const double k = triangle.stiffness * triangle.area / (candidate.divisions * candidate.divisions);
      const Vec3d n = now.rotation * touch.gradient;
      Mat3<double> K = k * n * n.transpose();
      if (friction_ > 0) K += k / 2 * (Mat3<double>::Identity() - n * n.transpose());
      for (int c = 0; c < 3; ++c) visit(candidate.points[c], touch.weights[c], K);
    });
  }

  // visit(triangle of the surface) of what it may reach until a time, as things are now; one column of x for
  // each of points(). That does not depend on when it was searched.
  template <class Visit>
  void visit_close(const Mat3X<double>& x, double time, double until, Visit&& visit) const {
    const RigidMotion now = motion_at(path_, time);
    const double ahead = moves_until(time, until);
    for (const Candidate& candidate : candidates_)
      if (gap_to(x(Eigen::all, candidate.points), now) <= ahead + memory_.held().most())
        visit(candidate.triangle);
  }

  // ---- What it remembers. If that is replaced, forget() must follow.

  ContactMemory& memory() { return memory_; }
  const ContactMemory& memory() const { return memory_; }

 private:
  static constexpr double nothing_ahead = -std::numeric_limits<double>::infinity();
  struct Candidate {
    int triangle = 0;
    Eigen::Vector3i points;  // places in points_
    int divisions = 1;
    // It is out of reach until body and tool together have moved so far in all steps [m].
    mutable double clear_until = -std::numeric_limits<double>::infinity();
  };
  struct Touch {  // at a point of a triangle, in the tool's axes
    Vec3d weights;
    int number;  // of the point
    double depth, held;
    const Anchor* anchor;  // or null
    Vec3d gradient, place;
  };
  double gap_to(const Mat3<double>& triangle, const RigidMotion& now) const;  // or less [m]
  bool find_near(const At& at) const;
  void find_places(const At& at, const RigidMotion& now) const;
  // Of a candidate that nothing touches now. x: its corners in the tool's axes [m].
  void remember_clear(const Candidate& candidate, const Mat3<double>& x, const At& at, double opening) const;
  template <class Visit>  // visit(candidate, touch), after find_near()
  void visit_touches(const At& at, const RigidMotion& now, Visit&& visit) const;
  Vec3d slip_of(const Touch& touch, double stiffness, double pressure) const;

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
  double ahead_ = 0, ahead_until_ = nothing_ahead;  // at most since it was searched, until a time [m], [s]

  ContactMemory memory_;
  OnTool on_tool_;
  // Scratch of an evaluation: candidates that may touch, where their points are in the tool's axes [m], and
  // the points that are pressed.
  mutable std::vector<int> near_;
  mutable Mat3X<double> places_;
  mutable std::vector<int> place_is_of_;  // per point: the evaluation that found its place
  mutable int evaluation_ = 0;
  std::vector<int> pressed_, is_pressed_in_;  // the latter per point: in which evaluation
  Mat3X<double> speeds_;                      // of pressed points against the tool, in its axes [m/s]
};

template <class Visit>
void ToolContact::visit_touches(const At& at, const RigidMotion& now, Visit&& visit) const {
  AnchorReader anchors = memory_.anchors();
  const double most_held = memory_.held().most();
  const auto is_beyond = [&](const Vec3d& middle, double radius) {
    return distance_.is_beyond(middle, radius + most_held, now.opening);
  };
  find_places(at, now);
  for (int c : near_) {
    const Candidate& candidate = candidates_[std::size_t(c)];
    const Mat3<double> x = places_(Eigen::all, candidate.points);
    if (candidate.divisions > few_divisions) {
      const Vec3d centre = x.rowwise().sum() / 3;
      const double radius = std::sqrt((x.colwise() - centre).colwise().squaredNorm().maxCoeff());
      if (is_beyond(centre, radius + distance_.error())) {
        remember_clear(candidate, x, at, now.opening);
        continue;
      }
    }
    bool is_touched = false;
    const ContactSurface::Triangle& triangle = at.surface.triangles()[std::size_t(candidate.triangle)];
    visit_places(x, candidate.divisions, is_beyond, [&](int number, const Vec3d& place, auto&& weights_of) {
      if (is_beyond(place, 0)) return;
      const Distance g = distance_.at(place, now.opening);
      if (g.value >= most_held) return;
      const Vec3d weights = weights_of();
      const double held = memory_.held().any() ? memory_.held().at(triangle.points, weights) : 0;
      if (g.value >= held) return;
      is_touched = true;
      const Anchor* anchor = anchors.find(triangle.owner, candidate.divisions, number);
      visit(candidate, Touch{weights, number, -g.value, held, anchor, g.gradient, place});
    });
    if (!is_touched) remember_clear(candidate, x, at, now.opening);
  }
}

}  // namespace lobe
