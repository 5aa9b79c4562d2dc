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

  // An obstacle, which stays where it is, has a number below 0.
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
  // How far the tool moves at most between two times [m].
  double moves_until(double from, double to) const {
    return farthest_move(path_, from, to, distance_.reach());
  }
  const std::vector<int>& points() const { return points_; }  // points of the surface that candidates have

  // ---- Forces. memory().begin_forces() in each evaluation.

  struct At {
    const ContactSurface& surface;
    const ContactLaw& law;
    double time = 0;
    double since = 0;       // the last step [s]
    double body_moved = 0;  // distance, at most, by which the body has moved in all steps [m]
    const Places& places;   // places of the surface
  };
  void find_forces(const At& at);
  template <class Visit>  // visit(point of the surface, force [N]) for each pressed point
  void visit_forces(Visit&& visit) const {
    for (int i : scratch_.pressed)
      visit(scratch_.points[std::size_t(i)], Vec3d(scratch_.forces.col(i).template head<3>()));
  }
  const OnTool& on_tool() const { return on_tool_; }
  double energy(const At& at);                                              // [J]
  void use(const ContactSurface& surface) { memory_.held().use(surface); }  // before any of these
  // visit(point, weight, K): each touch, whose stiffness K, 3 × 3 [N/m], a point shares by its weight.
  template <class Visit>
  void visit_stiffness(const At& at, Visit&& visit) {
    if (!find_near(at)) return;
    const RigidMotion now = motion_at(path_, at.time);
    visit_touches(at, now, [&](const Candidate& candidate, const Touch& touch) {
      const double k = touch.triangle.stiffness * touch.triangle.area;
      const Vec3d n = now.rotation * touch.gradient;
      Mat3<double> K = k * n * n.transpose();
      if (friction_ > 0) K += ContactLaw::slip_share * k * (Mat3<double>::Identity() - n * n.transpose());
      for (int c = 0; c < 3; ++c) visit(candidate.points[c], touch.weights[c], K);
    });
  }

  // visit(triangle of the surface) of what it may reach until a time, as things are now. That does not depend
  // on when it was searched.
  template <class Visit>
  void visit_close(const Places& places, double time, double until, Visit&& visit) const {
    const RigidMotion now = motion_at(path_, time);
    const double ahead = moves_until(time, until);
    for (const Candidate& candidate : candidates_) {
      Mat3<double> x;
      for (int c = 0; c < 3; ++c) x.col(c) = places.of_point(points_[std::size_t(candidate.points[c])]);
      if (gap_to(x, now) <= ahead + memory_.held().most()) visit(candidate.triangle);
    }
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
    // How far body and tool together will have moved in all steps when it may be in reach [m].
    double clear_until = -std::numeric_limits<double>::infinity();
  };
  struct Touch {  // the touch at a point of a triangle, in the tool's axes
    const TouchTriangle& triangle;
    Vec3d weights;
    double depth, held;
    const Anchor* anchor;  // anchor of the point, or null
    Vec3d gradient, place;
  };
  struct Scratch {  // memory of a search, or of an evaluation of forces, stiffness or energy
    std::vector<int> place_in_search;      // per point of the surface: its place in points_, or −1
    std::vector<int> near;                 // candidates that may touch
    std::vector<int> points;               // their points, as those of the surface
    std::vector<int> place_of;             // per point of points_: its place there
    std::vector<int> evaluation_of;        // per point of points_: the last evaluation that it was near in
    PointRows places, speeds;              // per near point, in the tool's axes [m], [m/s]
    std::vector<TouchTriangle> triangles;  // per candidate; their κ and areas are known since the search
    std::vector<TouchBlock> blocks;        // blocks of points of triangles
    std::size_t block_count = 0;           // number of the blocks that are in use
    std::vector<int> pressed;              // near points
    std::vector<std::uint8_t> is_pressed;  // per near point
    Eigen::Matrix<double, 4, Eigen::Dynamic> forces;  // per near point, and a row of zeros [N]
    int number = 0;                                   // number of the evaluation
  };
  double gap_to(const Mat3<double>& triangle, const RigidMotion& now) const;  // a gap, or less [m]
  bool find_near(const At& at);
  // After find_near(): where the corners of what is near are and what its points touch.
  void find_touches(const At& at, const RigidMotion& now);
  void find_places(const At& at, const RigidMotion& now);
  void take_triangle(int number, const RigidMotion& now);
  ContactLaw law(const At& at) const {  // law of contact with the tool's friction
    ContactLaw own = at.law;
    own.friction = friction_;
    return own;
  }
  TouchShape touch_shape(const RigidMotion& now) const {
    return {shape_.kind, shape_.radius, shape_.length, shape_.size, now.opening, now.opens};
  }
  static TouchRows rows(PointRows& of) { return {of.data(), int(of.cols())}; }
  void take_near_strips(int triangle, int divisions, const RigidMotion& now);
  void take_blocks(int triangle, int divisions, int begin, int end);
  void find_distances(std::size_t first_block, const RigidMotion& now);
  void leave_what_is_held(const At& at);
  void remember_clear(const At& at, const RigidMotion& now);
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
  void visit_lanes(Visit&& visit) {
    for (std::size_t b = 0; b < scratch_.block_count; ++b)
      for (unsigned int rest = scratch_.blocks[b].touched; rest != 0; rest &= rest - 1)
        visit(scratch_.blocks[b], static_cast<std::size_t>(std::countr_zero(rest)));
  }
  template <class Visit>  // visit(candidate, touch), after find_near()
  void visit_touches(const At& at, const RigidMotion& now, Visit&& visit);

  int tool_;
  RigidShape shape_;
  SignedDistance distance_;
  TouchKernels kernels_;

  // The tool in the frame.
  double friction_ = 0, appears_ = 0, goes_ = 0;
  std::vector<PathPoint> path_;  // around the frame

  // What may touch it, since the last search.
  std::vector<Candidate> candidates_;
  std::vector<int> points_;             // points of the surface that candidates have
  double slack_ = -1;                   // how far body and tool may move, both together [m]
  double body_moved_ = 0;               // way of the body when they were searched [m]
  double moved_ = 0;                    // way of the tool since, until moved_at_ [m]
  double moved_at_ = 0;                 // [s]
  double ahead_ = 0;                    // bound of the tool's way since the search, until ahead_until_ [m]
  double ahead_until_ = nothing_ahead;  // [s]

  ContactMemory memory_;
  OnTool on_tool_;

  Scratch scratch_;
};

// One after the other, as numbers that are no packs.
template <class Visit>
void ToolContact::visit_touches(const At& at, const RigidMotion& now, Visit&& visit) {
  AnchorReader anchors = memory_.anchors();
  find_touches(at, now);
  visit_lanes([&](const TouchBlock& block, std::size_t lane) {
    const Candidate& candidate = candidate_of(block);
    const Anchor* anchor =
        anchors.find(triangle_of(block, at).owner, candidate.divisions, block.first + int(lane));
    visit(candidate, Touch{scratch_.triangles[std::size_t(block.triangle)],
                           lane_of(block.points->weights, lane), -block.distance[lane], block.held[lane],
                           anchor, lane_of(block.gradient, lane), lane_of(block.place, lane)});
  });
}

}  // namespace lobe
