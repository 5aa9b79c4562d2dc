#include "lobe/organ/kinds_of_terms.h"

#include <algorithm>

#include "lobe/contact/contact.h"
#include "lobe/forces/applied_forces.h"
#include "lobe/forces/attachments.h"
#include "lobe/forces/clips.h"
#include "lobe/forces/pressure.h"
#include "lobe/forces/threads.h"

namespace lobe {

template <class Real>
std::span<const KindOfTerm<Real>> kinds_of_terms() {
  using Term = std::shared_ptr<ForceTerm<Real>>;
  static constexpr KindOfTerm<Real> kinds[] = {
      {AppliedForces<Real>::term_name,
       [](const Setup&) -> Term { return std::make_shared<AppliedForces<Real>>(); },
       [](const Setup&, std::span<const ToolBody>) { return false; }, false},
      {Pressure<Real>::term_name,
       [](const Setup& setup) -> Term { return std::make_shared<Pressure<Real>>(setup); },
       [](const Setup& setup, std::span<const ToolBody>) { return !setup.pressures.empty(); }},
      {Contact<Real>::term_name,
       [](const Setup& setup) -> Term {
         return std::make_shared<Contact<Real>>(setup.contact, setup.damping);
       },
       [](const Setup& setup, std::span<const ToolBody> tools) {
         return !tools.empty() || setup.contact.is_on();
       },
       false},
      {Attachments<Real>::term_name,
       [](const Setup& setup) -> Term { return std::make_shared<Attachments<Real>>(setup); },
       [](const Setup& setup, std::span<const ToolBody>) { return !setup.attachments.empty(); }},
      {Clips<Real>::term_name,
       [](const Setup& setup) -> Term { return std::make_shared<Clips<Real>>(setup); },
       [](const Setup& setup, std::span<const ToolBody>) {
         return !setup.clips.empty() || !setup.carriers.empty();
       }},
      // The last: it predicts the motion that all other forces give.
      {Threads<Real>::term_name,
       [](const Setup& setup) -> Term { return std::make_shared<Threads<Real>>(setup); },
       [](const Setup& setup, std::span<const ToolBody>) { return !setup.stitches.empty(); }}};
  return kinds;
}

template <class Real>
const KindOfTerm<Real>* find_kind_of_term(std::string_view name) {
  const std::span<const KindOfTerm<Real>> kinds = kinds_of_terms<Real>();
  const auto found = std::find_if(kinds.begin(), kinds.end(),
                                  [&](const KindOfTerm<Real>& kind) { return kind.name == name; });
  return found == kinds.end() ? nullptr : &*found;
}

template std::span<const KindOfTerm<float>> kinds_of_terms();
template std::span<const KindOfTerm<double>> kinds_of_terms();
template const KindOfTerm<float>* find_kind_of_term(std::string_view);
template const KindOfTerm<double>* find_kind_of_term(std::string_view);

}  // namespace lobe
