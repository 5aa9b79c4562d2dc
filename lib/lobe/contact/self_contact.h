// A body against itself: organ against organ, the lips of a cut, pieces that have fallen.
//
// Let x_q be a point of a surface triangle that lies in a tetrahedron of the boundary layer, at the
// barycentric coordinates b. It was at rest at X = Σ b_i X_i. The face that it has come through is the one of
// the boundary that is nearest there, however deep the two overlap now. Where that face is now, it has the
// normal n and the corners x_j:
//   d = −n·(x_q − x_1),  p = κ ⟨d + h⟩,  f_q = A_q p n,  f_j = −w_j f_q,
// with what is held h (contact_law.h), and w the barycentric coordinates of the foot of x_q in the face's
// plane. This is minus the gradient of ½ κ A_q ⟨d + h⟩². So momentum and angular momentum are kept. Energy is
// kept but for what h gives, and where another face becomes the nearest. A point that is held keeps its face
// until p is 0. A slit, whose lips lie on each other, has no force until they overlap.
//
// Both sides are evaluated. κ is half of κ_q κ_f/(κ_q + κ_f), so that both together give no vertex more
// stiffness than it may have (contact_surface.h).
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
// gap_watch.h says what is looked at when.
#pragma once

#include "lobe/contact/self_near.h"
#include "lobe/contact/self_touch.h"

namespace lobe {

class SelfContact {
 public:
  SelfContact() = default;
  SelfContact(const SelfContact&) = delete;

  void rebuild(const ContactSurface& surface, const Model& model) {  // for another surface
    rest_.rebuild(surface, model.elements);
    search_.rebuild();
    watch_.rebuild();
    near_.rebuild();
    touch_.rebuild(surface);
  }
  // Finds what may touch. Call it before what follows.
  void keep_pairs(const SelfAt& at) {
    if (!rest_.points.vertices.empty()) watch_.keep(at, memory_);
  }
  void forget() { watch_.forget(); }
  // Call it before keep_pairs() for a place that no step has led to, and after it.
  void leave_path() { watch_.leave_path(); }

  // ---- Forces. memory().begin_forces() in each evaluation.

  void add_forces(const SelfAt& at, ContactForces& f) { touch_.add_forces(at, memory_, f); }
  double energy(const SelfAt& at) { return touch_.energy(at, memory_); }  // [J]
  // at_point(point of the surface, weight, K) as in tool_contact.h; at_vertex(of the mesh, weight, K).
  template <class AtPoint, class AtVertex>
  void visit_stiffness(const SelfAt& at, AtPoint&& at_point, AtVertex&& at_vertex) {
    touch_.visit_stiffness(at, memory_, at_point, at_vertex);
  }
  // Visits what is so near that it may touch soon: triangle(number of the surface), tetrahedron(corners).
  template <class Triangle, class Tetrahedron>
  void visit_close(const SelfAt& at, Triangle&& triangle, Tetrahedron&& tetrahedron) {
    near_.visit(at, triangle, tetrahedron);
  }

  // ---- What it remembers: the slip ξ of each point. If that is replaced, forget() must follow.

  ContactMemory& memory() { return memory_; }

 private:
  SelfRest rest_;
  PairSearch search_{rest_};
  GapWatch watch_{rest_, search_};
  SelfNear near_{rest_, search_, watch_};
  SelfTouch touch_{rest_, search_, watch_};
  ContactMemory memory_;
};

}  // namespace lobe
