// Contact of a body with rigid tools and obstacles (tool_contact.h) and with itself (self_contact.h), as a
// force term: its energy and stiffness are known to the world, and its state is part of checkpoints. A world
// makes one as soon as it has a probe, or from the start if the setup asks for self contact or obstacles.
//
// Contact hardly changes the stable step (contact_surface.h). Its damping acts only along the normals. It is
// a share ζ of the critical damping at ω_max, and less at lower frequencies. Because velocities are those of
// half a step before, this damping lowers the stable step, by a factor √(1 + ζ²) − ζ at the worst: 0.95 for
// the default ζ = 0.05. The default safety of 0.9 leaves room for ζ up to 0.1.
#pragma once

#include <memory>

#include "lobe/contact/contact_surface.h"
#include "lobe/setup/contact_setup.h"

namespace lobe {

class ContactMemory;
class Places;
class SelfContact;
class ToolContact;
struct ContactLaw;
struct SelfAt;

// Depth beyond which the pressure grows no more, as a share of the surface's mean edge; more where selective
// masses have softened contact.
inline constexpr double deepest_contact = 0.25;

template <class Real>
class Contact : public ForceTerm<Real> {
 public:
  using At = typename ForceTerm<Real>::At;
  static constexpr const char* term_name = "contact";

  explicit Contact(const ContactSetup& setup = {}, double body_damping = 0);  // γ [1/s]
  ~Contact() override;

  std::string name() const override { return term_name; }
  void add_forces(const At& at, Mat3X<Real>& f) override;
  void add_diagonal_stiffness(const At& at, DiagonalStiffness& K) override;
  double energy(const At& at) override;
  std::vector<Index> acts_on(const Model&) const override { return touched_; }

  bool needs_body() const override { return true; }
  bool see_tools(std::span<const ToolBody> bodies, double time) override;
  void see_body(const BodyView& now, const At& at) override;
  void look_ahead(const At& at) override;
  void begin_frame(double time, double duration) override {
    frame_begin_ = time;
    frame_end_ = time + duration;
  }
  std::span<const OnTool> on_tools() const override { return on_tools_; }
  void begin_steps() override;
  void take_back_steps() override;
  void end_step(double farthest, double dt) override;

  std::string save() const override;
  void load(const std::string& saved, Index vertices) override;

  const ContactSurface& surface() const { return surface_; }

 private:
  struct OfTool;   // memory of a tool that a checkpoint has and that has not come yet
  struct Scratch;  // scratch data of a search and of forces
  ContactLaw law() const;
  Places places(const At& at) const;
  void find_there(double time, std::vector<int>& tools) const;  // finds the tools that exist at a time
  template <class Visit>
  void visit_memories(Visit&& visit);  // visit(memory) of the body on itself, then of each tool
  void forget_all();                   // forgets all lists of what may touch
  void forget_if_replaced(const At& at);
  void search(ToolContact& tool, const At& at, double ahead);
  void scatter(const ToolContact& tool, Mat3X<Real>& f) const;
  template <class Visit>
  void visit_self(const At& at, Visit&& visit);
  template <class Visit>
  void visit_tools(const At& at, Visit&& visit);
  void add_self_stiffness(const At& at, DiagonalStiffness& K);
  void find_soon(const At& at, double ahead);

  ContactSetup setup_;
  double body_damping_;  // γ [1/s]
  ContactSurface surface_;
  std::vector<ToolContact> tools_;     // obstacles first, as tools of numbers below 0
  std::unique_ptr<SelfContact> self_;  // null if the body does not touch itself
  std::vector<OfTool> waiting_;
  std::vector<OnTool> on_tools_;
  std::vector<Index> touched_;             // vertices that may be touched in this frame, sorted
  std::vector<int> there_, there_before_;  // tools, when see_tools() was called last
  // Times of the frame in which the world is, or of another one if time was set [s].
  double frame_begin_ = 0, frame_end_ = 0;
  double end_of_frame(double now) const { return now >= frame_begin_ ? std::max(frame_end_, now) : now; }
  double body_moved_ = 0;                     // bound of how far a vertex has moved in all steps [m]
  double last_step_ = 0, step_at_start_ = 0;  // step now, and when the steps began [s]
  std::uint64_t replaced_ = 0;                // revision of the state to which the lists of contacts belong

  std::unique_ptr<Scratch> scratch_;
};

extern template class Contact<float>;
extern template class Contact<double>;

}  // namespace lobe
