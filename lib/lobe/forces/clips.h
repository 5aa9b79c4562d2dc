// The force term of clips, and what bodies lose that carry blood or bile (theory, section 23).
//
// A clip closes on what lies between its legs. Rays from leg to leg meet the surface of the tissue there
// first and last: at a pair of points, at the distance a. In 0.2 s the distance l at which springs hold the
// pairs falls to the gap g of the clip. A pair at the distance d pulls with
//   T = k <d − l>,  l = g + <a − g> (1 − s),  s = min(1, t/0.2 s),
// where k is the stiffness of the clip over the number of its pairs. Clips do not push.
//
// Blood or bile that a body carries may fill all of its inside. It comes in at the vertices that are
// fed, and flows from tetrahedron to tetrahedron, except through those that the middle plane of a clip
// crosses between its legs. Where it reaches a face that a cut or a burn has opened, it bleeds or leaks.
//
// O(#pairs) per step; O(#tetrahedra) in frames in which something was cut or clipped.
#pragma once

#include "lobe/forces/embedded.h"
#include "lobe/forces/force_term.h"
#include "lobe/setup/setup.h"
#include "lobe/tool/tool_pose.h"

namespace lobe {

inline constexpr double clip_closing_time = 0.2;  // [s]

// A clip as it is now.
struct ClipFigures {
  std::string name;
  Index pairs = 0;   // pairs of points that it holds together; 0: it has fallen off
  double apart = 0;  // largest distance of a pair [m]
  double force = 0;  // sum of the tensions of all pairs [N]
};

// A body that carries blood or bile, as it is now.
struct CarrierFigures {
  int body = 0;
  Carries carries = Carries::nothing;
  double open = 0;  // area of its open faces that are fed, at rest [m²]
};

template <class Real>
class Clips : public ForceTerm<Real> {
 public:
  using At = typename ForceTerm<Real>::At;

  explicit Clips(const Setup& setup);

  // Finds the clip that closes on what is there; it has no pairs if nothing is. Pre-computed regions count as
  // nothing, since no force moves their interior. O(#triangles of the surface).
  static ClipSetup find(const ClipClosure& closure, const SurfaceMesh& surface, const At& at);
  bool has(ToolId tool, int number) const;
  void add(const ClipSetup& clip, const ClipClosure& closure);

  std::vector<ClipFigures> figures(const At& at) const;
  std::vector<CarrierFigures> carriers() const;

  // ---- ForceTerm

  static constexpr const char* term_name = ClipSetup::term;
  std::string name() const override { return term_name; }
  bool needs_body() const override { return true; }
  void add_forces(const At& at, Mat3X<Real>& f) override;
  void add_diagonal_stiffness(const At& at, DiagonalStiffness& K) override;
  double energy(const At& at) override;
  std::vector<Index> acts_on(const Model& model) const override;
  void see_body(const BodyView& body, const At& at) override;
  void follow(const Topology& topology, const MeshEdit& edit) override;
  void follow_grains(const Elements& elements, const Grains& grains, const MeshEdit& edit) override;
  std::vector<Event> take_events() override;
  std::vector<TermLines> lines(const At& at) const override;
  void add_to_setup(const Elements&, const CompactMesh& left, Setup& setup) const override;
  std::string save() const override;
  void load(const std::string& saved, Index vertices) override;

 private:
  struct State {
    std::vector<ClipSetup> clips;
    std::vector<double> open;  // area of each carrier's open faces that are fed [m²]
    std::vector<Event> events;
  };
  // Finds the tetrahedra to which the content of a carrier flows.
  std::vector<char> reached(const CarrierSetup& carrier, const Elements& elements) const;
  void find_open(std::size_t carrier, const SurfaceMesh& surface, const At& at);

  std::vector<CarrierSetup> carriers_;
  State state_;
  bool has_changed_ = true;  // whether anything has changed since carriers were looked at
  std::uint64_t seen_ = 0;   // revision of the surface at that time
};

extern template class Clips<float>;
extern template class Clips<double>;

}  // namespace lobe
