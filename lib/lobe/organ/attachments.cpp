// Attachments in an Organ, and what tools cut of force terms.
#include "lobe/error.h"
#include "lobe/organ/organ.h"
#include "lobe/scalpel/sheet.h"
#include "lobe/setup/exclusions.h"

namespace lobe {

template <class Real>
void Organ<Real>::perform(const Attach& edit) {
  refuse_excluded(Option::force_terms, options_of(setup_), "attachment");
  for (const StrandSetup& strand : edit.attachment.strands)
    for (const EmbeddedPoint* end : {&strand.from, &strand.to}) {
      if (end->tet < 0) continue;
      check_tets({end->tet});
      if (elements().region_of[std::size_t(end->tet)] == RegionModel::precomputed)
        throw InputError("attachment \"" + edit.attachment.name + "\"",
                         "cannot end in tetrahedron " + std::to_string(end->tet) +
                             " of a precomputed region, where nothing can pull: make it tensor-mass");
    }
  change_term<Attachments>(
      [&](auto& attachments) { attachments.attach(edit.attachment, elements().topology); });
}

template <class Real>
void Organ<Real>::perform(const Detach& edit) {
  change_term<Attachments>([&](auto& attachments) { attachments.detach(edit.attachment, body_.here()); });
}

template <class Real>
void Organ<Real>::sever(const SweptVolume& volume) {
  for (const auto& term : body_.terms) term->sever(volume, body_.here());
}

template <class Real>
void Organ<Real>::sever(const BladeMove& move) {
  if (!term_of<Attachments>(body_.terms)) return;
  constexpr double half_thickness = 2e-4;  // of a blade [m]
  const Sheet sheet({move.from.tip, move.from.heel}, {move.to.tip, move.to.heel});
  const Vec3d reach = Vec3d::Constant(half_thickness);
  sever(SweptVolume{
      {sheet.box().min() - reach, sheet.box().max() + reach}, {}, {}, [&](const Vec3d& p, const Vec3d& q) {
        return sheet.crossing(p, q) || sheet.distance((p + q) / 2, half_thickness) <= half_thickness;
      }});
}

}  // namespace lobe
