// A length of thread: where it passes through tissue, its knots, and whose hand has its ends.
#pragma once

#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "lobe/setup/thread_setup.h"

namespace lobe {

struct ThreadSpan {    // a length of thread from one bite, knot or hand to the next
  double length = 0;   // natural length [m]
  double tension = 0;  // tension of the last step [N]
  int slip = 0;        // slip at its end in the last step (Cables::Span)
  bool is_cut = false;
  bool is_valid() const {
    return std::isfinite(length) && std::isfinite(tension) && tension >= 0 && slip >= -1 && slip <= 1;
  }
  static constexpr auto fields =
      std::tuple(&ThreadSpan::length, &ThreadSpan::tension, &ThreadSpan::slip, &ThreadSpan::is_cut);
};

struct ThreadBite {
  EmbeddedPoint point;
  Index number = 0;  // number in the order of sewing
  static constexpr auto fields = std::tuple(&ThreadBite::point, &ThreadBite::number);
};

struct ThreadKnot {
  Index from = 0, to = 0;  // places in Thread::bites
  ThreadSpan closing;      // span from `to` back to `from`
  double to_tighten = 0;   // length that is still to be drawn in [m]
  double rate = 0;         // [m/s]
  static constexpr auto fields = std::tuple(&ThreadKnot::from, &ThreadKnot::to, &ThreadKnot::closing,
                                            &ThreadKnot::to_tighten, &ThreadKnot::rate);
};

// The end of a needle in a frame, where a thread is fixed to it.
struct NeedleEnd {
  int tool = 0;                                    // ToolId
  Vec3d from = Vec3d::Zero(), to = Vec3d::Zero();  // places at the start and end of the frame [m]
  Vec3d arm = Vec3d::Zero();                       // way to it from the needle's centre at the end [m]
};

struct ThreadHand {
  bool holds = false;
  Vec3d from = Vec3d::Zero(), to = Vec3d::Zero();  // places at the start and end of the frame [m]
  Vec3d target = Vec3d::Zero();                    // place for the next frame [m]
  ThreadSpan head, tail;                           // spans to the first bite, and from the last
  // The tool whose end it is, where it is that of a needle, which has no head; 0: a hand has both ends.
  int needle = 0;
  Vec3d arm = Vec3d::Zero();  // of NeedleEnd
  static constexpr auto fields =
      std::tuple(&ThreadHand::holds, &ThreadHand::from, &ThreadHand::to, &ThreadHand::target,
                 &ThreadHand::head, &ThreadHand::tail, &ThreadHand::needle, &ThreadHand::arm);
};

struct Thread {
  int number = 0;
  std::string name;  // name in messages
  ThreadMaterial material;
  double at = 0;  // time at which a planned one is sewn [s]
  bool is_sewn = false;
  std::vector<TieSetup> plans;  // knots still to be tied, by the numbers of the bites
  std::vector<ThreadBite> bites;
  std::vector<ThreadSpan> spans;  // spans from each bite to the next
  std::vector<ThreadKnot> knots;  // knots in their order along the thread
  ThreadHand hand;
  // Natural length from the end of a needle to the thread's other end, or to where it was cut [m]. 0: no
  // needle has drawn it.
  double length = 0;

  bool is_valid() const;
  static constexpr auto fields = std::tuple(&Thread::number, &Thread::name, &Thread::material, &Thread::at,
                                            &Thread::is_sewn, &Thread::plans, &Thread::bites, &Thread::spans,
                                            &Thread::knots, &Thread::hand, &Thread::length);

  // The present place of a bite by its number; −1: it has torn out, or its tissue is gone.
  Index find(Index number) const;
  Index next_number() const;  // number of the next bite
  // Takes a bite out of the thread, which then runs straight past it. A loop that has no two bites left ends.
  void remove_bite(Index at);
  // Opens the thread behind a bite, and the loop that this is part of.
  void cut_after(Index at);
  // Ties a knot between two bites; its closing span has the length `closing` [m].
  void tie(Index from, Index to, double closing, double tighten, double over);
  // Whether the thread may be tied there: empty, or why not.
  std::string fault_of_tie(Index from, Index to) const;
  bool may_be_taut() const { return is_sewn && (!knots.empty() || (hand.holds && hand.needle == 0)); }

  // ---- On a needle

  void plan(const std::vector<TieSetup>& ties);
  bool is_on_needle() const { return hand.holds && hand.needle > 0; }
  Index first_on_needle() const;  // the first bite of the piece that a needle has
  // Whether its other end is free, so that it runs through the tissue as the needle draws: nothing pulls.
  bool runs_through() const;
  double free_length() const;  // natural length before its first bite: its other end hangs out there [m]
  // Lengthens the span to the needle to this way [m], and draws the others straight, by the ways between the
  // bites [m], as far as that takes. Returns the last bite that its end was drawn out of; −1: none.
  Index draw_through(double way, const std::vector<double>& ways);
  void leave_needle();
};

Thread planned(const StitchSetup& stitch, int number);

}  // namespace lobe
