// The force term of attachments: beds, ligaments and other tissue that ties bodies to each other or to the
// world, and gives way (theory, section 22). An attachment is a set of strands between embedded points. A
// strand that is longer than its natural length by δ pulls with T = k (1 − D) δ. With m the largest δ so far,
//   1 − D = 1                              up to m = δ_f,
//         = (c δ_f − m)/((c − 1) m)        beyond,
// and has torn at m = c δ_f. By then it has taken up c k δ_f²/2: for a strand that stands for an area A of a
// bed, A times the fracture energy of the bed. Strands do not push; contact keeps bodies apart.
//
// A cautery and a scalpel cut the strands that they meet. A strand goes with the tissue of its ends.
//
// O(#strands) per step.
#pragma once

#include <array>

#include "lobe/forces/embedded.h"
#include "lobe/forces/force_term.h"
#include "lobe/setup/attachment_setup.h"

namespace lobe {

// What strands of an attachment have gone, and why.
struct StrandsGone {
  Index count = 0;
  double area = 0;    // area of the bed [m²]
  double energy = 0;  // energy that they took along [J]
  bool is_valid() const {
    return count >= 0 && std::isfinite(area) && area >= 0 && std::isfinite(energy) && energy >= 0;
  }
  static constexpr auto fields = std::tuple(&StrandsGone::count, &StrandsGone::area, &StrandsGone::energy);
};

// An attachment as it is now. Work on a body = energies + released + cut.energy.
struct AttachmentFigures {
  std::string name;
  Index strands = 0;      // strands that are left
  double area = 0;        // area of the bed that they stand for [m²]
  double tension = 0;     // largest tension [N]
  double stored = 0;      // elastic energy [J], also in Energies::applied
  double released = 0;    // energy that damage released, in strands that are left as well [J]
  StrandsGone torn, cut;  // `cut`: by tools, by commands, and with the tissue around them
};

template <class Real>
class Attachments : public ForceTerm<Real> {
 public:
  using At = typename ForceTerm<Real>::At;

  explicit Attachments(const Setup& setup);

  // Both throw InputError for what cannot be done, and have changed nothing then.
  void attach(const AttachmentSetup& attachment, const Topology& topology);
  void detach(const std::string& name, const At& at);

  std::vector<AttachmentFigures> figures(const At& at) const;
  std::vector<AttachmentSetup> as_setup() const;  // attachments that are left, as damaged as they are

  // ---- ForceTerm

  static constexpr const char* term_name = AttachmentSetup::term;
  std::string name() const override { return term_name; }
  bool needs_body() const override { return true; }
  void add_forces(const At& at, Mat3X<Real>& f) override;
  void add_diagonal_stiffness(const At& at, DiagonalStiffness& K) override;
  double energy(const At& at) override;
  std::vector<Index> acts_on(const Model& model) const override;
  void begin_steps() override { saved_ = state_; }
  void take_back_steps() override;
  void end_step(double farthest, double dt) override;
  void follow(const Topology& topology, const MeshEdit& edit) override;
  void follow_grains(const Elements& elements, const Grains& grains, const MeshEdit& edit) override;
  void sever(const SweptVolume& volume, const At& at) override;
  std::vector<Event> take_events() override;
  std::vector<TermLines> lines(const At& at) const override;
  void add_to_setup(const Elements&, const CompactMesh& left, Setup& setup) const override;
  std::string save() const override;
  void load(const std::string& saved, Index vertices) override;

 private:
  struct Attachment {
    AttachmentSetup now;  // the attachment with the strands that are left
    StrandsGone torn, cut;
    // Figures of the strands that have torn since the last call of take_events().
    StrandsGone torn_since;
    Vec3d places = Vec3d::Zero();  // sum of their places [m]
    double last = 0;               // time when the last one tore [s]
    static constexpr auto fields =
        std::tuple(&Attachment::now, &Attachment::torn, &Attachment::cut, &Attachment::torn_since,
                   &Attachment::places, &Attachment::last);
  };
  struct State {
    std::vector<Attachment> attachments;
    static constexpr auto fields = std::tuple(&State::attachments);
  };
  // A strand as it is evaluated. The corners and weights of `to` follow those of `from`, which are negative.
  struct Strand {
    std::array<Index, 8> corners;
    std::array<Real, 8> weights;
    Vec3<Real> at_rest;        // vector from `from` to `to` at rest [m]
    Real length, stiffness;    // [m], [N/m], damaged as it is
    Real unchanged_until;      // elongation [m]
    Index attachment, number;  // among the strands of the attachment
  };
  struct Ends {
    Vec3d from, to;  // [m]
  };
  static Ends ends_of(const StrandSetup& strand, const At& at);
  static double elongation_of(const StrandSetup& strand, const At& at);  // [m]
  void arrange(const Elements& elements);
  void add_strand(const AttachmentSetup& attachment, const StrandSetup& strand, const Elements& elements);
  void damage(Strand& strand, double elongation, const At& at);
  // Counts strands for which is_gone(strand) as cut. Without `at`, what they stored is not counted.
  template <class IsGone>
  void cut(Attachment& attachment, const At* at, IsGone&& is_gone);

  State state_, saved_;
  std::vector<Strand> strands_;
  bool is_arranged_ = false, has_torn_ = false;
};

extern template class Attachments<float>;
extern template class Attachments<double>;

}  // namespace lobe
