// The force term of threads with which a body is sewn (theory, section 20). A thread is a massless elastic
// cable through embedded points. What is slack is drawn, what is taut is exact. Its stiffness is taken into
// the step, so that no thread shortens the step of the tissue.
//
// A thread has free ends until a knot makes a loop of it, or a hand holds it; free ends pull at nothing.
#pragma once

#include <utility>

#include "lobe/forces/cables.h"
#include "lobe/forces/embedded.h"
#include "lobe/forces/force_term.h"
#include "lobe/forces/thread.h"
#include "lobe/setup/needle_setup.h"

namespace lobe {

// A thread as it is drawn.
struct ThreadLine {
  int thread = 0;
  std::string name;
  Mat3X<double> points{3, 0};    // along the thread, loops closed [m]
  std::vector<double> tensions;  // tension of each segment between them [N]
};

// Where work on threads and their energy went since they were sewn [J].
struct ThreadLedger {
  double hand = 0;      // work of hands, and of knots that were tightened
  double friction = 0;  // loss where threads slip
  double cut = 0;       // loss where threads cut into the tissue
  bool is_valid() const { return std::isfinite(hand) && std::isfinite(friction) && std::isfinite(cut); }
  static constexpr auto fields = std::tuple(&ThreadLedger::hand, &ThreadLedger::friction, &ThreadLedger::cut);
};

template <class Real>
class Threads : public ForceTerm<Real> {
 public:
  using At = typename ForceTerm<Real>::At;

  explicit Threads(const Setup& setup);

  // ---- What is done to threads. Each throws InputError for what cannot be done, and then changes nothing.

  void bring(int thread, const ThreadMaterial& material);
  void bite(int thread, const EmbeddedPoint& point, const At& at);
  void pull(int thread, bool on, const Vec3d& point, const At& at);
  bool lead(int thread, const Vec3d& point);  // moves the hand that holds it; false: none does
  void tie(int thread, Index from, Index to, double tighten, double over, const At& at);
  void cut(int thread, Index after);

  // ---- What needles do to threads

  // The end of a needle has passed the bite. If no needle has drawn the thread of this number, its length and
  // knots are now these.
  void bite_by_needle(const NeedleThread& by, const EmbeddedPoint& point, const NeedleEnd& end, const At& at);
  std::vector<int> needles() const;  // tools at whose ends there are threads
  void follow_needle(const NeedleEnd& end);
  void leave_needle(int tool);

  const std::vector<Thread>& all() const { return state_.threads; }
  const ThreadLedger& ledger() const { return state_.ledger; }
  std::vector<ThreadLine> drawn(const At& at) const;

  // ---- ForceTerm

  static constexpr const char* term_name = StitchSetup::term;
  std::string name() const override { return term_name; }
  bool needs_body() const override { return true; }
  void begin_frame(double time, double duration) override;
  bool see_tools(std::span<const ToolBody>, double) override { return std::exchange(has_changed_, false); }
  void see_body(const BodyView& body, const At& at) override;
  void add_forces(const At& at, Mat3X<Real>& f) override;
  // Adds the stiffness of the tensions across the thread; along it the step is implicit.
  void add_diagonal_stiffness(const At& at, DiagonalStiffness& K) override;
  double energy(const At& at) override;
  std::vector<Index> acts_on(const Model& model) const override;
  void begin_steps() override { saved_ = state_; }
  void take_back_steps() override;
  void end_step(double farthest, double dt) override;
  void follow(const Topology& topology, const MeshEdit& edit) override;
  void follow_grains(const Elements& elements, const Grains& grains, const MeshEdit& edit) override;
  std::vector<Event> take_events() override { return std::exchange(state_.events, {}); }
  std::span<const OnTool> on_tools() const override { return on_tools_; }
  std::vector<TermLines> lines(const At& at) const override;
  void add_to_setup(const Elements& elements, const CompactMesh& left, Setup& setup) const override;
  std::string save() const override;
  void load(const std::string& saved, Index vertices) override;

 private:
  struct State {
    std::vector<Thread> threads;
    ThreadLedger ledger;
    std::vector<Event> events;
  };
  // Where a point or span of the cables comes from.
  struct Source {
    std::size_t thread = 0;
    Index bite = -1;           // −1: the hand
    EmbeddedPoint moved = {};  // place after this step, if it gives way; no tetrahedron: the surface
  };
  struct SpanSource {
    std::size_t thread = 0;
    ThreadSpan* span = nullptr;
    Index after = -1;  // a bite, or −1: the knot or the hand
  };

  Thread& find(int number);
  Thread& find_for_bite(int number, const EmbeddedPoint& point, const At& at);
  void draw_through(Thread& thread, const At& at);
  void add_forces_on_tools();
  void perform_plans(const At& at);
  void sew(Thread& thread, const At& at);
  void tie_planned(Thread& thread, const TieSetup& plan, const At& at);
  void report(Event::Kind kind, const Thread& thread, const std::optional<Vec3d>& place, double size,
              const std::string& what);
  void lengthen_to_fit(Thread& thread, Index from, Index to, const At& at);

  void arrange();
  void add_cables_of(std::size_t thread);
  void add_chain(std::size_t thread, const std::vector<SpanSource>& spans, const std::vector<Index>& points,
                 bool is_closed);
  Vec3d mobility(const Model& model, Index a, Index b) const;
  void place_points(const At& at, const Mat3X<Real>* f);
  Vec3d hand_at(const ThreadHand& hand, double time) const;
  void tighten_knots(double dt);
  void break_threads();
  void move_bites();

  State state_, saved_;
  Cables cables_;
  std::vector<Source> sources_;           // sources of points
  std::vector<SpanSource> span_sources_;  // sources of spans
  Mat3X<double> inverse_mass_;            // 3 × #vertices: inverse mass by axis [1/kg]
  std::uint64_t seen_structure_ = ~std::uint64_t(0), seen_inertia_ = ~std::uint64_t(0);  // their revisions
  const Grains* grains_ = nullptr;
  struct Torn {
    std::size_t thread;
    Index bite;
    Vec3d place;  // [m]
  };
  std::vector<Torn> torn_;    // scratch
  std::vector<double> ways_;  // scratch
  std::vector<OnTool> on_tools_;
  double time_ = 0, begin_ = 0, duration_ = 0;  // the last evaluation; the frame [s]
  double due_ = -unlimited;                     // time until which plans are to be done [s]
  bool is_arranged_ = false, is_coupled_ = false, is_solved_ = false, has_changed_ = false;
};

extern template class Threads<float>;
extern template class Threads<double>;

}  // namespace lobe
