// Mass that vertices of full tetrahedra get while a lattice moves the rest of a body, so that its steps are
// as long as those of the full body, whose highest frequency is ω*. With K_vv at rest and R, the ratio of ω*
// to the estimate that single vertices give,
//
//   m_v ≥ R² λ_max(K_vv)/ω*².
//
// Such vertices lie around tools, where they follow the tool and hardly oscillate. Others lie in tissue that
// a cut has taken out of the region, where slivers would halve the step. A vertex in strained tissue gets
// mass by ask(). While no vertex is embedded, no mass is added. The added mass has no weight.
#pragma once

#include <algorithm>

#include "lobe/body/model.h"
#include "lobe/body/motion.h"
#include "lobe/lattice/settle.h"

namespace lobe {

class ZoneMass {
 public:
  static constexpr double ratio = 1.15;  // R
  // Strained tissue: a vertex with a frequency, squared, that is so many times ω*² gets mass, and has ω*²
  // over `spare` then, so that it seldom gets more.
  static constexpr double strained = 1.02, spare = 1.3;

  // Call it after an edit: vertices of these tetrahedra and no others may get mass. `owns(tet)`.
  template <class Owns>
  void follow(const Elements& elements, const std::vector<Index>& vertices, Owns&& owns) {
    const auto count = std::size_t(elements.topology.vertex_count());
    if (stiffness_.empty()) {
      stiffness_.resize(count, 0);
      for (Index v = 0; v < static_cast<Index>(count); ++v) find(elements, v, owns);
    }
    stiffness_.resize(count, 0);
    for (Index v : vertices) find(elements, v, owns);
  }
  // λ_max(K_vv) at rest [N/m]; 0 where a vertex gets no mass.
  const std::vector<double>& stiffness() const { return stiffness_; }
  bool may_raise(Index v) const { return stiffness_[std::size_t(v)] > 0; }

  double least(Index v, double omega) const {  // [kg]
    return omega > 0 ? ratio * ratio / (omega * omega) * stiffness_[std::size_t(v)] : 0;
  }
  // Asks for at least this mass from the next raise() on, until the vertex is embedded or nothing is [kg].
  void ask(Index v, double mass) {
    if (asked_.size() < stiffness_.size()) asked_.resize(stiffness_.size(), 0);
    asked_[std::size_t(v)] = mass;
  }
  double asked(Index v) const { return v < static_cast<Index>(asked_.size()) ? asked_[std::size_t(v)] : 0; }
  const std::vector<double>& asked() const { return asked_; }  // part of a checkpoint
  void set_asked(const std::vector<double>& asked) { asked_ = asked; }
  // Raises the masses of these vertices where they are not embedded [kg].
  void raise(const Embedding& embedding, double omega, const std::vector<Index>& vertices,
             std::vector<double>& mass);
  // Adds the mass that was added, in motion. `counts(vertex)`.
  template <class Real, class Counts>
  void add_to(MovingMasses& sum, const Elements& elements, const Motion<Real>& motion,
              Counts&& counts) const {
    for (std::size_t i = 0; i < added_.size(); ++i) {
      const auto v = static_cast<Index>(i);
      if (added_[i] > 0 && counts(v))
        sum.add(added_[i], elements.points.col(v) + motion.u.col(v).template cast<double>(),
                motion.v.col(v).template cast<double>());
    }
  }
  double sum() const;            // [kg]
  double added(Index v) const {  // [kg]
    return v < static_cast<Index>(added_.size()) ? added_[std::size_t(v)] : 0;
  }

 private:
  template <class Owns>
  void find(const Elements& elements, Index v, Owns&& owns) {
    const auto around = elements.topology.around(v);
    const bool is_own = std::all_of(around.begin(), around.end(), owns);
    stiffness_[std::size_t(v)] = is_own ? stiffness_of(elements, v) : 0;
  }
  static double stiffness_of(const Elements& elements, Index v);

  std::vector<double> stiffness_, added_, asked_;  // one of each per vertex
};

}  // namespace lobe
