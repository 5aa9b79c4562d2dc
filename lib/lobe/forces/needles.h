// The force term of needles that sew (theory, section 25). A needle is an arc that a tool moves. Its tip
// sticks to the surface of the body and pushes, until its force along the needle reaches the puncture force.
// Then the needle guides the tissue that it goes through (needle_guide.h): points of the tissue at its
// entries and exits, and between them, are drawn to the arc, with friction along it. Where the tip comes to
// the surface from inside it has to puncture it again. Bites are what the end of the needle has passed.
//
// Its springs are taken into the step, so that no needle shortens the step of the tissue.
//
// O(#triangles) per frame while there is a needle; per step, O(#triangles near the tip) and O(n³) for the n
// points on a needle, at most NeedleGuide::most.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <utility>

#include "lobe/forces/embedded.h"
#include "lobe/forces/force_term.h"
#include "lobe/forces/needle_guide.h"
#include "lobe/forces/needle_passage.h"
#include "lobe/forces/thread.h"
#include "lobe/tool/needle_body.h"

namespace lobe {

// A needle as it is now.
struct NeedleFigures {
  int tool = 0;
  std::string name;
  NeedlePassage::Tip tip = NeedlePassage::Tip::free;
  double inside = 0;                 // length in tissue [m]
  EmbeddedPoint at;                  // the tissue at its tip, unless that is free
  Index entries = 0, exits = 0;      // on the needle now
  std::vector<EmbeddedPoint> holds;  // points of the tissue that are on it, from its end to its tip
  // On the body in the last step: force, torque about the needle's centre, and the force of a tip that
  // touches the surface along the needle, positive where it pushes [N], [N m], [N].
  Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();
  double pressed = 0;
};

// A point of the tissue that the end of a needle has passed.
struct NeedleBite {
  int tool = 0;
  EmbeddedPoint point;
  bool is_valid() const { return point.is_valid(); }
  static constexpr auto fields = std::tuple(&NeedleBite::tool, &NeedleBite::point);
};

// Where the work of needles went [J].
struct NeedleLedger {
  double hand = 0;      // work of hands
  double friction = 0;  // loss where tissue slips along needles
  double puncture = 0;  // loss where a surface gives way
  bool is_valid() const { return std::isfinite(hand) && std::isfinite(friction) && std::isfinite(puncture); }
  static constexpr auto fields =
      std::tuple(&NeedleLedger::hand, &NeedleLedger::friction, &NeedleLedger::puncture);
};

template <class Real>
class Needles : public ForceTerm<Real> {
 public:
  using At = typename ForceTerm<Real>::At;

  // Call it before the steps of a frame, before see_body(): the needles that are there between two times
  // [s]. Another needle has gone, and so have all its holds. Returns whether others are there at `from` than
  // before.
  bool see(std::span<const NeedleBody> bodies, double from, double to);
  // The bites since the last call, in their order.
  std::vector<NeedleBite> take_bites() { return std::exchange(state_.bites, {}); }
  bool has_bites() const { return !state_.bites.empty(); }
  // The end of a needle from one time to another, in the frame of see() [s]; none: see() had no needle of
  // this tool.
  std::optional<NeedleEnd> end_of(int tool, double from, double to) const;
  bool is_there(int tool, double time) const;
  std::vector<NeedleFigures> figures() const;
  const NeedleLedger& ledger() const { return state_.ledger; }

  // ---- ForceTerm

  static constexpr const char* term_name = "needles";
  std::string name() const override { return term_name; }
  bool needs_body() const override { return true; }
  void see_body(const BodyView& body, const At& at) override;
  void look_ahead(const At& at) override;
  void add_forces(const At& at, Mat3X<Real>& f) override;
  double energy(const At& at) override;
  std::vector<Index> acts_on(const Model& model) const override;
  std::span<const OnTool> on_tools() const override { return on_tools_; }
  void begin_steps() override { saved_ = state_; }
  void take_back_steps() override;
  void end_step(double farthest, double dt) override;
  void follow(const Topology& topology, const MeshEdit& edit) override;
  void follow_grains(const Elements& elements, const Grains& grains, const MeshEdit& edit) override;
  std::vector<Event> take_events() override { return std::exchange(state_.events, {}); }
  std::vector<TermLines> lines(const At& at) const override;
  std::string save() const override;
  void load(const std::string& saved, Index vertices) override;

 private:
  struct Needle {
    int tool = 0;
    std::string name;
    NeedleSettings settings;
    double appears = 0, goes = 0;  // [s]
    std::vector<PathPoint> path;   // rows around the frame
    NeedlePassage passage;
    // Of the last step, as in NeedleFigures.
    Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();
    double pressed = 0;
    bool is_there(double time) const;
    NeedlePose pose(double time) const;
    double spacing() const { return settings.shape.length() / 8; }  // of holds inside [m]
    bool is_valid() const;
    static constexpr auto fields =
        std::tuple(&Needle::tool, &Needle::name, &Needle::settings, &Needle::appears, &Needle::goes,
                   &Needle::path, &Needle::passage, &Needle::force, &Needle::torque, &Needle::pressed);
  };
  struct State {
    std::vector<Needle> needles;  // in ascending order of tools
    std::vector<NeedleBite> bites;
    std::vector<Event> events;
    NeedleLedger ledger;
    std::vector<Index> near;  // vertices on which they may act until the next frame, ascending
  };
  // A triangle of the surface that a tip may meet in the frame. Its corners lie between four vertices each.
  struct Candidate {
    FaceOwner owner;
    std::array<Eigen::Vector4i, 3> vertices;
    std::array<Eigen::Vector4d, 3> weights;
  };
  struct Scratch {
    NeedleGuide guide;
    std::vector<Candidate> candidates;  // in the order of their owners
    std::vector<double> lengths;
    std::vector<Vec3d> ways;  // of the needle at each point in the step [m]
    bool punctures = false;
  };

  void find_candidates(const Needle& needle, const SurfaceMesh& surface, const At& at, Scratch& scratch);
  void find_near(const Needle& needle, const Scratch& scratch, const At& at);
  Eigen::AlignedBox3d reach_of_tip(const Needle& needle) const;
  void move_tip(Needle& needle, Scratch& scratch, const At& at, const Mat3X<Real>& f);
  void walk(Needle& needle, const At& at);
  void seek_surface(Needle& needle, const Scratch& scratch, const At& at, const Mat3X<Real>& f);
  void solve(Needle& needle, Scratch& scratch, const At& at, const Mat3X<Real>& f);
  void place(const Needle& needle, Scratch& scratch, const At& at, double time, const Mat3X<Real>* f);
  void add(Needle& needle, const Scratch& scratch, const At& at, Mat3X<Real>& f);
  void add_last(const Needle& needle, const At& at, Mat3X<Real>& f) const;
  void puncture(Needle& needle, const Scratch& scratch);
  void report(Event::Kind kind, const Needle& needle, const Vec3d& place, double size);
  Vec3d mobility(const EmbeddedPoint& p, const EmbeddedPoint& q, const Topology& topology) const;
  Vec3d end_velocity(Index vertex, const At& at, const Mat3X<Real>& f) const;
  Vec3d outwards(const NeedlePassage& passage, const At& at) const;

  State state_, saved_;
  std::vector<Scratch> scratch_;  // one per needle
  std::vector<OnTool> on_tools_;
  std::vector<int> there_;      // needles that were there when see() was called last
  Mat3X<double> inverse_mass_;  // 3 × #vertices: inverse mass by axis [1/kg]
  std::uint64_t seen_structure_ = ~std::uint64_t(0), seen_inertia_ = ~std::uint64_t(0);  // their revisions
  const Grains* grains_ = nullptr;
  const SurfaceMesh* surface_ = nullptr;  // from see_body() until look_ahead()
  double from_ = 0, to_ = 0, time_ = 0;   // the frame, the last step [s]
  bool is_solved_ = false;
};

extern template class Needles<float>;
extern template class Needles<double>;

}  // namespace lobe
