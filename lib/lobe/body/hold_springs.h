// Vertices of which a share φ is held, 0 < φ < 1, so that what is held is the same body on every mesh. A
// spring draws each to the displacement g that is prescribed there:
//   k = K φ/(1 − φ),  f = k (g − ū),  K = ⅓ tr(−∂f_v/∂u_v) of its own tetrahedra at rest
// It is taken implicitly, with the mean ū = ¼ (u⁺ + 2u + u⁻) over two steps of Δt. Then
//   (m + k Δt²/4) (v⁺ − v⁻)/Δt = f_v + k (g − u)
// which is stable whatever k is, wherever the step is stable without the springs: the mass that they add to a
// vertex, k Δt²/4, is as much as their stiffness needs.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lobe/body/model.h"

namespace lobe {

// k of a partly held vertex [N/m]. K is that of plain tetrahedra with moduli of small strains, 0 without any.
double hold_stiffness(const Elements& elements, const HeldVertices::Held& item);

template <class Real>
class HoldSprings {
 public:
  using Held = HeldVertices::Held;
  struct Spring {
    Held item;                     // axes: those that nothing holds wholly
    double stiffness = 0;          // k [N/m]
    Vec3d target = Vec3d::Zero();  // g [m]
    Vec3d force = Vec3d::Zero();   // pull in the last step [N]
    std::size_t pull = 0;          // number of its vertex in pulls_
  };

  bool any() const { return !springs_.empty(); }
  const std::vector<Spring>& all() const { return springs_; }
  // Finds the springs anew where the structure of the body, or what holds it, has changed since.
  void follow(const Model& model);
  bool is_current(const Revisions& now) const {
    return structure_ == now.structure && inertia_ == now.inertia;
  }
  // prescribed(item): the displacement at a time [m].
  template <class Prescribed>
  void aim(double time, Prescribed&& prescribed) {
    if (aimed_at_ == time) return;
    aimed_at_ = time;
    for (Spring& spring : springs_) spring.target = prescribed(spring.item);
  }

  // Adds the springs to forces f [N], 3 × at least #vertices, and divides those on their vertices by
  // 1 + k Δt²/4m, so that masses m get the accelerations above. `step` is Δt [s].
  void apply(const std::vector<double>& inverse_mass, double step, const Mat3X<Real>& u, Mat3X<Real>& f);
  Vec3d target(const Held& item) const;  // point g of the spring of an item of HeldVertices::partly() [m]
  Vec3d force_now(const Spring& spring, const Mat3X<Real>& u) const;  // k (g − u) [N]
  double energy(const Mat3X<Real>& u) const;                          // Σ k |g − u|²/2 [J]

 private:
  struct Pull {  // all springs of a vertex in a step
    Index vertex = 0;
    Vec3d force = Vec3d::Zero(), stiffness = Vec3d::Zero();  // [N], [N/m]
    Vec3d lag = Vec3d::Zero();                               // ū − u [m]
  };

  std::vector<Spring> springs_;
  std::vector<Pull> pulls_;
  std::optional<double> aimed_at_;                     // [s]
  std::uint64_t structure_ = never, inertia_ = never;  // revisions of the body for which springs_ were found

  static constexpr std::uint64_t never = ~std::uint64_t(0);
};

extern template class HoldSprings<float>;
extern template class HoldSprings<double>;

}  // namespace lobe
