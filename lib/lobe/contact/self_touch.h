// Forces, stiffness and energy at the points where a body touches itself, of the pairs that are close
// (gap_watch.h). Its formulae are in self_contact.h.
#pragma once

#include <algorithm>
#include <bit>

#include "lobe/contact/gap_watch.h"

namespace lobe {

class SelfTouch {
 public:
  SelfTouch(const SelfRest& rest, const PairSearch& search, const GapWatch& watch)
      : rest_(rest), search_(search), watch_(watch) {}

  void rebuild(const ContactSurface& surface);  // call it after that of `rest`
  void add_forces(const SelfAt& at, ContactMemory& memory, ContactForces& f);
  double energy(const SelfAt& at, ContactMemory& memory);  // [J]
  // As in self_contact.h.
  template <class AtPoint, class AtVertex>
  void visit_stiffness(const SelfAt& at, ContactMemory& memory, AtPoint&& at_point, AtVertex&& at_vertex);

 private:
  struct Face {                   // a triangle of the surface where it is in this pass
    int pass = -1, pressed = -1;  // the last passes that asked for it, and that had forces on it
    bool is_sound = false;        // it has an area
    Vec3d normal, corner;
    Vec3d to_weights[2];  // barycentric coordinates 1 and 2 of x in its plane: these · (x − corner)
    Mat3<double> speeds;  // speeds of its corners, where the pass has speeds [m/s]
    Mat3<double> forces;  // forces on its corners [N]
  };
  struct KnownFace {  // the nearest one to a point of a triangle, where that was at rest
    int layer = -1;
    Vec3d rest = Vec3d::Zero();  // place of the point [m]
    BoundaryLayer::Nearest nearest;
  };
  struct Touch {  // the touch of a point of a triangle
    const PairSearch::Candidate* candidate = nullptr;
    const Anchor* anchor = nullptr;  // anchor of the point, or null
    int number = 0;                  // number of the point
    Vec3d weights = Vec3d::Zero();   // weights of the triangle's corners
    int pair = 0;                    // place in ClosePairs
    int layer = 0;                   // number of the tetrahedron behind the face
    int face = 0;                    // number in the surface
    Face* now = nullptr;
    Vec3d face_weights = Vec3d::Zero();
    Eigen::Vector4d corner_weights = Eigen::Vector4d::Zero();  // weights of the tetrahedron's corners
    double depth = 0, held = 0, stiffness = 0, area = 0;       // [m], [m], [Pa/m], [m²]
    ContactLaw law;                                            // law of contact of the two bodies
  };
  struct Scratch {
    int numbering = -1;                          // numbering of the points that the next rows are about
    std::vector<double> places, speeds, forces;  // four numbers per point [m], [m/s], [N]
    std::vector<InsideBlock> insides;            // blocks of the close pairs
    std::vector<Face> faces;                     // per triangle of the surface
    std::vector<int> pressed;                    // triangles with forces on them
  };

  template <class Visit>
  void visit_touches(const SelfAt& at, ContactMemory& memory, bool with_speeds, Visit&& visit);
  void find_insides(const SelfAt& at, bool with_speeds);
  int place_at(int pair, std::size_t corner) const {
    return watch_.close()
        .blocks[std::size_t(pair) / PairBlock::width]
        .places[corner][std::size_t(pair) % PairBlock::width];
  }
  int insides_of(int pair) const {  // bits of points
    const InsideBlock& block = scratch_.insides[std::size_t(pair) / PairBlock::width];
    return int(block.points[std::size_t(pair) % PairBlock::width]);
  }
  const PairSearch::Pair& pair_of(int close) const {
    return search_.pairs()[std::size_t(watch_.close().pairs[std::size_t(close)])];
  }
  Eigen::Vector4d weights_in(int pair, const Vec3d& weights) const;  // barycentric coordinates
  static Vec3d place_at_rest(const BoundaryLayer::Tet& tet, const Eigen::Vector4d& weights);
  int nearest_face(int point, int layer, const Vec3d& rest);
  Face& face_now(const SelfAt& at, int face, bool with_speeds);
  bool find_pair(const ClosePairs::OfCandidate& ones, Touch& touch) const;
  bool find_kept_face(const SelfAt& at, const ClosePairs::OfCandidate& ones, Touch& touch) const;
  bool find_touch(const SelfAt& at, const HeldDepths& held, const ClosePairs::OfCandidate& ones,
                  const Vec3d& x, bool with_speeds, Touch& touch);
  Vec3d slip_of(const SelfAt& at, const Touch& touch, const Vec3d& speed, double pressure) const;
  template <int count>
  Eigen::Matrix<double, 3, count> rows_at(const std::vector<double>& rows, int pair, int first) const;
  template <int count>
  void add_at(int pair, int first, const Eigen::Matrix<double, 3, count>& forces);
  void press(const Touch& touch, const Vec3d& force);
  void remember(const SelfAt& at, const Touch& touch, const Vec3d& slip, ContactMemory& memory) const;
  void give_forces(const SelfAt& at, ContactForces& f);

  const SelfRest& rest_;
  const PairSearch& search_;
  const GapWatch& watch_;
  GapKernels kernels_ = gap_kernels(chosen_instruction_set());

  int pass_ = 0;                        // number of the last evaluation
  std::vector<KnownFace> known_faces_;  // per point

  Scratch scratch_;
};

template <class Visit>
void SelfTouch::visit_touches(const SelfAt& at, ContactMemory& memory, bool with_speeds, Visit&& visit) {
  ++pass_;
  memory.held().use(at.surface);
  const ClosePairs& close = watch_.close();
  if (close.pairs.empty()) return;
  find_insides(at, with_speeds);
  const bool is_any_held = memory.held().any();
  AnchorReader anchors = memory.anchors();
  Touch touch;
  for (const ClosePairs::OfCandidate& ones : close.candidates) {
    int inside = 0;
    for (int i = ones.first; i < ones.first + ones.count; ++i) inside |= std::max(0, insides_of(i));
    if (inside == 0 && !is_any_held) continue;
    touch.candidate = &search_.candidates()[std::size_t(ones.candidate)];
    const Mat3<double> corners = rows_at<3>(scratch_.places, ones.first, 0);
    const int divisions = touch.candidate->divisions;
    const std::vector<Vec3d>& weights = self_point_weights(divisions);
    for (unsigned int left = is_any_held ? (1U << weights.size()) - 1 : unsigned(inside); left != 0;
         left &= left - 1) {
      touch.number = std::countr_zero(left);
      touch.anchor = anchors.find(touch.candidate->owner, divisions, touch.number);
      if ((inside >> touch.number & 1) == 0 && !touch.anchor) continue;
      touch.weights = weights[std::size_t(touch.number)];
      if (find_touch(at, memory.held(), ones, corners * touch.weights, with_speeds, touch)) visit(touch);
    }
  }
}

template <class AtPoint, class AtVertex>
void SelfTouch::visit_stiffness(const SelfAt& at, ContactMemory& memory, AtPoint&& at_point,
                                AtVertex&& at_vertex) {
  visit_touches(at, memory, false, [&](const Touch& touch) {
    const Mat3<double> along = touch.now->normal * touch.now->normal.transpose();
    const double k = touch.area * touch.stiffness;
    Mat3<double> K = k * along;
    const auto& triangles = at.surface.triangles();
    for (int c = 0; c < 3; ++c)
      at_point(triangles[std::size_t(touch.face)].points[c], touch.face_weights[c], K);
    const Mat3<double> across = ContactLaw::slip_share * k * (Mat3<double>::Identity() - along);
    if (at.law.friction > 0) K += across;
    for (int c = 0; c < 3; ++c)
      at_point(triangles[std::size_t(touch.candidate->triangle)].points[c], touch.weights[c], K);
    if (at.law.friction == 0) return;
    for (int c = 0; c < 4; ++c)
      at_vertex(rest_.layer(touch.layer).corners[c], touch.corner_weights[c], across);
  });
}

// The rows of the corners of a pair, from the rows of all points.
template <int count>
Eigen::Matrix<double, 3, count> SelfTouch::rows_at(const std::vector<double>& rows, int pair,
                                                   int first) const {
  Eigen::Matrix<double, 3, count> found;
  for (int c = 0; c < count; ++c)
    found.col(c) = Eigen::Map<const Vec3d>(&rows[4 * std::size_t(place_at(pair, std::size_t(first + c)))]);
  return found;
}

}  // namespace lobe
