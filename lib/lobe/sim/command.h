// What may be done to a world, as data: the same for steering it, for the record of a run and its replay, and
// for what a checkpoint keeps of the edits since the start.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <tuple>
#include <variant>
#include <vector>

#include "lobe/body/applied_forces.h"
#include "lobe/tool/tools.h"

namespace lobe {

struct Advance {
  double duration = 0;  // [s]
  bool operator==(const Advance&) const = default;
  static constexpr auto fields = std::tuple(&Advance::duration);
};

struct RemoveTets {
  std::vector<Index> tets;
  bool operator==(const RemoveTets&) const = default;
  static constexpr auto fields = std::tuple(&RemoveTets::tets);
};

// Displacements and velocities stay, but for what becomes the interior of a precomputed region.
struct SetRegion {
  std::vector<Index> tets;
  RegionModel model = RegionModel::nonlinear;
  bool operator==(const SetRegion&) const = default;
  static constexpr auto fields = std::tuple(&SetRegion::tets, &SetRegion::model);
};

// Precomputed regions become non-linear, interior and all, until they are condensed again. Only if the setup
// is expandable.
struct Expand {
  bool operator==(const Expand&) const = default;
  static constexpr auto fields = std::tuple();
};

// Only if no edit has concerned the region since it was renewed. Its interior takes its displacements from
// the interface.
struct Condense {
  bool operator==(const Condense&) const = default;
  static constexpr auto fields = std::tuple();
};

// Linearises precomputed regions anew about the present state, by another thread; the world goes on with the
// result at the first frame that starts `delay` later, by waiting for it if need be.
struct Renew {
  double delay = 0;  // [s], > 0
  bool operator==(const Renew&) const = default;
  static constexpr auto fields = std::tuple(&Renew::delay);
};

// The degree of selective masses, one of Inertia::degrees(). Between two frames; displacements stay, and of
// velocities all but their short waves, where the degree grows.
struct SetMassDegree {
  int degree = 1;
  bool operator==(const SetMassDegree&) const = default;
  static constexpr auto fields = std::tuple(&SetMassDegree::degree);
};

// What a blade has done in one step, by numbers of grains. World makes it; the first, which is empty, says
// where the grains were made.
struct Incise {
  Incision incision;
  bool operator==(const Incise&) const = default;
  static constexpr auto fields = std::tuple(&Incise::incision);
};

// External forces on vertices, in place of those that there were.
struct SetForces {
  std::vector<VertexLoad> forces;
  bool operator==(const SetForces&) const = default;
  static constexpr auto fields = std::tuple(&SetForces::forces);
};

// Springs from vertices to points, in place of those that there were. Explicit integrator only.
struct SetSprings {
  std::vector<Spring> springs;
  bool operator==(const SetSprings&) const = default;
  static constexpr auto fields = std::tuple(&SetSprings::springs);
};

// Where the points are to be at the end of the next frame, 3 × #springs [m]; on their way they move
// uniformly.
struct MoveSprings {
  Mat3X<double> points;
  bool operator==(const MoveSprings& other) const {
    return points.cols() == other.points.cols() && points == other.points;
  }
  static constexpr auto fields = std::tuple(&MoveSprings::points);
};

// What is held from then on. World makes it where a precomputed region depends on it.
struct Hold {
  HeldVertices held;
  bool operator==(const Hold&) const = default;
  static constexpr auto fields = std::tuple(&Hold::held);
};

// Precomputed regions are condensed afresh by another thread, and what it has found is used. World makes
// them.
struct BeginRefresh {
  double due = 0;  // when EndRefresh follows [s]
  // Linearised anew about these, 3 × #vertices [m]; none: as before.
  std::shared_ptr<const std::vector<double>> about = {};
  bool operator==(const BeginRefresh& other) const {
    return due == other.due && (about == other.about || (about && other.about && *about == *other.about));
  }
  bool is_valid() const {
    return std::isfinite(due) &&
           (!about || std::all_of(about->begin(), about->end(), [](double x) { return std::isfinite(x); }));
  }
  static constexpr auto fields = std::tuple(&BeginRefresh::due, &BeginRefresh::about);
};
struct EndRefresh {
  bool operator==(const EndRefresh&) const = default;
  static constexpr auto fields = std::tuple();
};

// In the place of a command whose effect a later one has replaced: it keeps the numbers of those that follow.
struct Superseded {
  bool operator==(const Superseded&) const = default;
  static constexpr auto fields = std::tuple();
};

template <class... Variants>
struct Joined;
template <class... A, class... B, class... C>
struct Joined<std::variant<A...>, std::variant<B...>, std::variant<C...>> {
  using Type = std::variant<A..., B..., C...>;
};
using Command =
    Joined<std::variant<Advance, RemoveTets, SetRegion, Expand, Condense, Renew, SetMassDegree>, ToolCommand,
           std::variant<Incise, SetForces, SetSprings, MoveSprings, Hold, BeginRefresh, EndRefresh,
                        Superseded>>::Type;

// Only says what tools are to do in the next frame, and leaves the state as it is.
inline bool is_about_tools(const Command& command) {
  return std::visit([]<class Any>(const Any&) { return std::is_constructible_v<ToolCommand, Any>; }, command);
}

// Of a precomputed region, by what may press on its interior: it is expanded then, and condensed again later.
struct Touched {
  static constexpr double patience = 0.5;  // after which it is condensed again [s]
  bool has_expanded = false;
  bool is_lost = false;  // that forces have no effect has been said
  double last = 0;       // [s]
  bool is_valid() const { return std::isfinite(last); }
  static constexpr auto fields = std::tuple(&Touched::has_expanded, &Touched::is_lost, &Touched::last);
};

// What a world was built from, and what has been done to its mesh and regions since.
struct Journal {
  std::uint64_t setup = 0;  // fingerprint() of all that it was built from (checkpoint.h)
  std::vector<Command>
      edits;  // of those that condense a region afresh only the last that no other has replaced
};

}  // namespace lobe
