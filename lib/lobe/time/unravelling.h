// Unravels tangles: tetrahedra that stay crushed or inverted although no tool holds them there. They are
// linear until they have come back (theory, section 8).
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "lobe/time/dynamics.h"

namespace lobe {

class Unravelling {
 public:
  // How many rings of neighbours become linear with the tangle, at each stage. At the last stage the whole
  // connected piece does.
  static constexpr std::array<int, 4> rings{1, 2, 4, std::numeric_limits<int>::max()};
  static constexpr int stages = static_cast<int>(rings.size());

  struct State {              // part of a checkpoint
    std::vector<Index> tets;  // tetrahedra that are linear for now, sorted; none: nothing is being unravelled
    int stage = 0;     // stages tried since a tool last moved the body or its state was set, up to `stages`
    double since = 0;  // time when the present stage, or the tangle, began [s]
    bool is_lumped = false;  // selective masses wait until nothing is crushed

    bool is_valid() const { return stage >= 0 && stage <= stages && std::isfinite(since); }
    static constexpr auto fields = std::tuple(&State::tets, &State::stage, &State::since, &State::is_lumped);
  };

  Unravelling() = default;
  // A tangle has some time to come undone by itself: that in which the slowest shear wave crosses the body 16
  // times.
  explicit Unravelling(const Elements& elements, double diagonal);  // diagonal of the bounding box [m]

  bool is_on() const { return !state_.tets.empty(); }
  bool is_lumped() const { return state_.is_lumped; }
  const State& state() const { return state_; }
  void set_state(const State& state) { state_ = state; }
  void restart(double time) {  // a tool moves the body, or its state was set
    state_.stage = 0;
    state_.since = time;
  }
  // Call it with tetrahedra, sorted, whose model an edit sets. They are not changed back.
  void leave_alone(const std::vector<Index>& tets);

  // Call it at the start of a frame, with the smallest volume ratio. Masses are lumped while tetrahedra are
  // crushed, because a tangle comes undone by short waves. Selective masses would slow these, and long waves
  // would fold the body meanwhile.
  template <class Real>
  void lump(const Dynamics<Real>& body, double volume_ratio);

  struct Remedy {
    RegionModel model = tangling_model;
    std::vector<Index> tets;  // tetrahedra that are to get this model
    std::string why;
  };
  // Returns what must be done in this frame, if anything. was_held(tet): whether something held the piece of
  // a tetrahedron when that piece was cut off.
  template <class Real, class WasHeld>
  std::optional<Remedy> look(const Dynamics<Real>& body, double volume_ratio, WasHeld&& was_held);

 private:
  template <class Real, class WasHeld>
  std::vector<Index> tangled(const Dynamics<Real>& body, double volume_ratio, WasHeld&& was_held) const;
  template <class Real>
  bool have_come_back(const Dynamics<Real>& body) const;
  std::optional<Remedy> make_linear_around(const Elements& elements, double time, std::vector<Index> tangled);
  Remedy end(const Elements& elements, double time, const std::string& how);

  State state_;
  double patience_ = 0;  // [s]
};

// Returns det F of a tetrahedron.
template <class Real>
double volume_ratio_of(const Elements& elements, Index tet, const Mat3X<Real>& u);

// Whether a tool or prescribed displacements move the body. They may crush it on purpose, so nothing is
// unravelled meanwhile.
bool is_driven(const HeldVertices& held);

// Returns the tangled tetrahedra: non-linear ones that are crushed, of held pieces. A piece that nothing
// holds is left out, since it would grow as a linear one when it turns.
template <class Real, class WasHeld>
std::vector<Index> Unravelling::tangled(const Dynamics<Real>& body, double volume_ratio,
                                        WasHeld&& was_held) const {
  const Elements& elements = body.model.elements;
  std::vector<Index> tangled;
  if (volume_ratio >= elements.guard_below) return tangled;
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    if (elements.is_in(tangling_model, t) && was_held(t) &&
        volume_ratio_of(elements, t, body.motion.u.padded()) < elements.guard_below)
      tangled.push_back(t);
  return tangled;
}

template <class Real, class WasHeld>
std::optional<Unravelling::Remedy> Unravelling::look(const Dynamics<Real>& body, double volume_ratio,
                                                     WasHeld&& was_held) {
  const Elements& elements = body.model.elements;
  const double time = body.motion.time;
  if (is_driven(body.model.held)) restart(time);
  const bool has_waited = time - state_.since >= (is_on() ? patience_ / 2 : patience_);
  const bool is_crushed = volume_ratio < elements.guard_below / 2;  // a strong bend may be beyond the guard
  if (is_on()) {
    const std::vector<Index> others = tangled(body, volume_ratio, was_held);
    if (others.empty() && have_come_back(body))
      return end(elements, time, "have come back, and are non-linear again");
    if (has_waited && state_.stage < stages) return make_linear_around(elements, time, others);
    if (has_waited)
      return end(elements, time,
                 "do not come back as linear ones either, and are non-linear again: smaller loads may help");
    return {};
  }
  if (!is_crushed)
    state_.since = time;
  else if (has_waited && state_.stage < stages)
    return make_linear_around(elements, time, tangled(body, volume_ratio, was_held));
  return {};
}

}  // namespace lobe
