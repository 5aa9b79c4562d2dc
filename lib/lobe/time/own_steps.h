// Own steps: each patch kicks its vertices as seldom as it may (theory, section 7). A large step is 2^top
// steps of World. In the i-th of them the patches of level l with 2^l a divisor of i are evaluated, and the
// vertices of these levels move: by 2^l steps at once. A vertex has the lowest level of the patches around,
// so that nothing reads its place in between. Its force is kept, and is that of the whole time. Force terms
// act in every step; what they act on has level 0.
//
// Frames begin and end where all vertices are at one time. Velocities of level l are 2^l half steps older
// than displacements then. They are brought up to these where levels change. Where levels meet, slow kicks
// push a vertex to and fro about its place: by 1/8 of what one side accelerates it times the square of the
// long step.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <tuple>
#include <vector>

#include "lobe/body/integrator.h"
#include "lobe/time/own_pace.h"

namespace lobe {

template <class Real>
struct Dynamics;

template <class Real>
class OwnSteps {
 public:
  // For so many frames a pace stays that is stable and costs less than one step for all. After a frame that
  // was run again, all step together for so many.
  static constexpr int frames_to_stay = 10, frames_together = 30;

  // Part of a checkpoint. Patches in the order in which Regions::visit_patches() shows them.
  struct State {
    // Per patch: the highest ω_v² when the step limit was found [1/s²]; empty: not seen, as no choice is due.
    std::vector<double> squares;
    std::vector<Level> levels;  // per patch, of the last frame; none: all stepped together
    double step = 0;            // short, of the last frame [s]
    int wait = 0;               // frames in which the pace stays if it can

    bool is_valid() const {
      return step >= 0 && std::isfinite(step) && wait >= 0 && wait <= frames_together &&
             (levels.empty() || levels.size() == squares.size()) &&
             std::all_of(squares.begin(), squares.end(), [](double square) { return square >= 0; }) &&
             std::all_of(levels.begin(), levels.end(), [](Level level) { return level <= highest_level; });
    }
    static constexpr auto fields = std::tuple(&State::squares, &State::levels, &State::step, &State::wait);
  };

  // Lays out the patches of a body at rest by the pace of their vertices, so that few have a slow and a fast
  // part. The highest frequency of each level alone is measured, and vertices go to lower levels until all
  // are stable. `squares`: ω_v² by which each vertex limits the step [1/s²]. `small`: displacements at which
  // forces are linear [m].
  void lay_out(Dynamics<Real>& body, const std::vector<double>& squares, double small);
  const LevelRatios& ratios() const { return ratios_; }

  // Call it when the step limit has been found. It does nothing while all step together and no choice is
  // due.
  void see_frequencies(Dynamics<Real>& body,
                       const std::function<double(Index)>& bound,    // of the square of a vertex [1/s²]
                       const std::function<double(Index)>& square);  // as above
  // Chooses levels and returns the number of steps of a frame that takes `fewest` of `longest` [s] where all
  // step together. Where levels change, velocities are brought up to the displacements.
  int begin_frame(Dynamics<Real>& body, int fewest, double longest, double safety);
  void begin_steps() { step_ = 0; }  // of a frame
  // All step together from here on; after trouble for some frames.
  void end(Dynamics<Real>& body);
  void end_after_trouble(Dynamics<Real>& body);
  void forget() { levels_.clear(), top_ = wait_ = 0; }  // of a state that is given
  // Whether the levels are stable with short steps of dt [s] at what was seen last.
  bool are_stable(double dt) const;

  bool any() const { return top_ > 0; }  // levels above 0
  const std::vector<Level>& levels() const { return levels_; }
  const PatchGraph& graph() const { return graph_; }
  double share() const { return share_; }  // of evaluations, of those that one step for all takes
  LevelRatios shares_of_levels() const;    // per level: of the tetrahedra, or edges of tensor-mass

  // ---- A step, while there are any.
  // Puts loads on what moves in this step, or everywhere if `all`, and leaves out the patches that do not
  // kick. end_forces() comes after the forces.
  void begin_forces(Dynamics<Real>& body, bool all);
  void end_forces(Dynamics<Real>& body);
  // As Dynamics::push(). The highest speeds count as much more as a vertex moves further in a step.
  Fastest<Real> push(Dynamics<Real>& body, double kick, double dt);

  State state() const { return {limits_.squares, levels_, step_length_, wait_}; }
  // False if it does not fit the body.
  bool fits(Dynamics<Real>& body, const State& state);
  void set_state(Dynamics<Real>& body, const State& state);

 private:
  void follow(Dynamics<Real>& body);  // its structure
  void use(Dynamics<Real>& body, const std::vector<Level>& levels);
  void find_moving(Dynamics<Real>& body);
  std::vector<std::uint8_t> fast_patches(const Dynamics<Real>& body) const;
  OwnPace pace_of_frame(const Dynamics<Real>& body, int fewest);
  int steps_in(double duration) const;
  double highest_of_level(Dynamics<Real>& body, Level level, const std::vector<double>& squares,
                          double small) const;
  int highest_now() const;  // level that kicks in this step

  PatchGraph graph_;
  std::vector<std::vector<Index>> patches_of_;  // per vertex
  std::uint64_t structure_ = ~std::uint64_t(0);
  PatchLimits limits_{{}, {}, {1, 1, 1, 1, 1, 1}};
  LevelRatios ratios_{1, 1, 1, 1, 1, 1};
  double rest_square_ = 0;  // ω² of a patch of pace 0 at rest, 4^pace times that of another pace [1/s²]

  std::vector<Level> levels_;       // per patch, in force
  std::vector<Level> of_vertices_;  // if so
  Level top_ = 0;
  double share_ = 1;
  double step_length_ = 0;       // [s]
  int wait_ = 0;                 // as State::wait
  int step_ = 0;                 // within a large step
  std::vector<Index> vertices_;  // by level
  std::array<std::size_t, std::size_t(highest_level) + 2> ends_{};
  std::array<std::vector<MovingVertex<Real>>, std::size_t(highest_level) + 1> moving_;
  std::tuple<std::uint64_t, std::uint64_t, std::uint64_t, bool> moving_found_at_{};
};

extern template class OwnSteps<float>;
extern template class OwnSteps<double>;

}  // namespace lobe
