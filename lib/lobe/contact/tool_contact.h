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

#include <bit>
#include <limits>

#include "lobe/contact/contact_law.h"
#include "lobe/contact/contact_memory.h"
#include "lobe/contact/contact_surface.h"
#include "lobe/contact/places.h"
#include "lobe/contact/rigid_motion.h"
#include "lobe/contact/signed_distance.h"
#include "lobe/contact/touch_kernels.h"
#include "lobe/setup/contact_setup.h"

namespace lobe {

class ToolContact {
 public:
  ToolContact(int tool, const RigidShape& shape, InstructionSet set = chosen_instruction_set())
      : tool_(tool), shape_(shape), distance_(shape), kernels_(touch_kernels(set)) {}

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

  // Whether search() must run again: since the last search, body and tool have together moved further than
  // its margin. body_moved: the sum over all steps of the farthest move of a vertex [m].
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

  // ---- Forces. memory().begin_forces() in each evaluation.

  struct At {
    const ContactSurface& surface;
    const ContactLaw& law;
    double time = 0;
    double since = 0;       // the last step [s]
    double body_moved = 0;  // by at most that in all steps [m]
    const Places& places;   // of the surface
  };
  void find_forces(const At& at);
  template <class Visit>  // visit(point of the surface, force [N]) of those that are pressed
  void visit_forces(Visit&& visit) const {
    for (int i : pressed_) visit(near_points_[std::size_t(i)], Vec3d(forces_.col(i).template head<3>()));
  }
  const OnTool& on_tool() const { return on_tool_; }
  double energy(const At& at) const;                                        // [J]
  void use(const ContactSurface& surface) { memory_.held().use(surface); }  // before any of these
  // visit(point, weight, K): each touch, whose stiffness K, 3 × 3 [N/m], a point shares by its weight.
  template <class Visit>
  void visit_stiffness(const At& at, Visit&& visit) const {
    if (!find_near(at)) return;
    const RigidMotion now = motion_at(path_, at.time);
    visit_touches(at, now, [&](const Candidate& candidate, const Touch& touch) {
      const double k = touch.triangle.stiffness * touch.triangle.area;
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
    const TouchTriangle& triangle;
    Vec3d weights;
    double depth, held;
    const Anchor* anchor;  // or null
    Vec3d gradient, place;
  };
  double gap_to(const Mat3<double>& triangle, const RigidMotion& now) const;  // or less [m]
  bool find_near(const At& at) const;
  // After find_near(): where the corners of what is near are and what its points touch.
  void find_touches(const At& at, const RigidMotion& now) const;
  void find_places(const At& at, const RigidMotion& now) const;
  void take_triangle(int number, double opening) const;
  TouchLaw law(const At& at, double opens) const;
  TouchRows rows(PointRows& of) const { return {of.data(), int(of.cols())}; }
  void take_near_strips(int triangle, int divisions, double opening) const;
  void take_blocks(int triangle, int divisions, int begin, int end) const;
  void find_distances(std::size_t first_block, double opening) const;
  void leave_what_is_held(const At& at) const;
  void remember_clear(const At& at, double opening) const;
  const Candidate& candidate_of(const TouchBlock& block) const {
    return candidates_[std::size_t(block.triangle)];
  }
  const ContactSurface::Triangle& triangle_of(const TouchBlock& block, const At& at) const {
    return at.surface.triangles()[std::size_t(candidate_of(block).triangle)];
  }
  void begin_forces();
  void find_anchors(const At& at);
  void remember(const At& at);
  void turn_and_sum(const Mat3<double>& rotation);
  static Vec3d lane_of(const std::array<PointBlock::Row, 3>& rows, std::size_t lane) {
    return {rows[0][lane], rows[1][lane], rows[2][lane]};
  }
  // visit(block, lane) of each point that is touched.
  template <class Visit>
  void visit_lanes(Visit&& visit) const {
    for (std::size_t b = 0; b < block_count_; ++b)
      for (unsigned int rest = blocks_[b].touched; rest != 0; rest &= rest - 1)
        visit(blocks_[b], static_cast<std::size_t>(std::countr_zero(rest)));
  }
  template <class Visit>  // visit(candidate, touch), after find_near()
  void visit_touches(const At& at, const RigidMotion& now, Visit&& visit) const;

  int tool_;
  RigidShape shape_;
  SignedDistance distance_;
  TouchKernels kernels_;
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
  mutable std::vector<TouchTriangle> triangles_;  // per candidate

  // Scratch of an evaluation: candidates that may touch; their points, as those of the surface; where these
  // are and how fast, in the tool's axes; what is found at points of triangles; the points that are pressed.
  mutable std::vector<int> near_, near_points_;
  mutable PointRows places_, speeds_;    // per near point [m], [m/s]
  mutable std::vector<int> near_of_;     // per point: which near point it is
  mutable std::vector<int> is_near_in_;  // per point: the evaluation that found so
  mutable int evaluation_ = 0;
  mutable std::vector<TouchBlock> blocks_;
  mutable std::size_t block_count_ = 0;
  std::vector<int> pressed_;
  std::vector<std::uint8_t> is_pressed_;             // per near point
  Eigen::Matrix<double, 4, Eigen::Dynamic> forces_;  // per near point, and a row of zeros [N]
};

// One after the other, as numbers that are no packs.
template <class Visit>
void ToolContact::visit_touches(const At& at, const RigidMotion& now, Visit&& visit) const {
  AnchorReader anchors = memory_.anchors();
  find_touches(at, now);
  visit_lanes([&](const TouchBlock& block, std::size_t lane) {
    const Candidate& candidate = candidate_of(block);
    const Anchor* anchor =
        anchors.find(triangle_of(block, at).owner, candidate.divisions, block.first + int(lane));
    visit(candidate, Touch{triangles_[std::size_t(block.triangle)], lane_of(block.points->weights, lane),
                           -block.distance[lane], block.held[lane], anchor, lane_of(block.gradient, lane),
                           lane_of(block.place, lane)});
  });
}

}  // namespace lobe
