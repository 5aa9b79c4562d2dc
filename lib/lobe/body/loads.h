// Gravity and dead loads at the vertices of a body that is being cut.
#pragma once

#include <algorithm>
#include <functional>

#include "lobe/parallel.h"
#include "lobe/setup/boundary_conditions.h"

namespace lobe {

template <class Real>
class Loads {
 public:
  using Columns = VertexColumns<Mat3X<Real>>;

  Loads(const Elements& elements, const Setup& setup)
      : loads_(elements, setup.face_loads, setup.vertex_loads),
        gravity_(setup.gravity),
        ramp_(setup.load_ramp) {}

  // Updates the loads of these vertices after an edit. mass(v) is the mass on which gravity acts [kg].
  void update(const Elements& elements, const std::vector<Index>& vertices,
              const std::function<double(Index)>& mass);
  DeadLoads& dead_loads() { return loads_; }
  const DeadLoads& dead_loads() const { return loads_; }

  // The share of the dead loads that does not act yet at a time [s].
  double missing_share(double time) const { return ramp_ > 0 ? std::max(0.0, 1 - time / ramp_) : 0; }

  void put(double time, Parallel& parallel, Columns& f) const;         // f = loads at a time
  void put_at(const std::vector<Index>& vertices, Columns& f) const {  // f = loads at full size, at these
    for (Index v : vertices) f.col(v) = external_.col(v);
  }
  Mat3X<double> at(double time) const {  // 3 × #vertices [N]
    return (external_.view() - missing_share(time) * dead_.view()).template cast<double>();
  }
  // Returns the load on a vertex of this mass [kg] at a time, whoever bears it [N].
  Vec3d of_vertex(const Elements& elements, Index v, double mass, double time) const {
    return mass * gravity_ + (1 - missing_share(time)) * loads_.at(elements, v);
  }
  double work(const Mat3X<Real>& u) const;  // work of all loads at full size on u [J]

  // Loads at full size, 3 × #vertices [N]: all loads, and only the dead ones. A condensed region takes out
  // the loads of its interior.
  Mat3X<Real>& external() { return external_.padded(); }
  Mat3X<Real>& dead() { return dead_.padded(); }

 private:
  DeadLoads loads_;
  Vec3d gravity_;            // [m/s²]
  double ramp_;              // [s]
  Columns dead_, external_;  // [N]
};

extern template class Loads<float>;
extern template class Loads<double>;

}  // namespace lobe
