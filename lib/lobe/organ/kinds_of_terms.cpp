#include "lobe/organ/kinds_of_terms.h"

#include <algorithm>

#include "lobe/contact/contact.h"
#include "lobe/forces/applied_forces.h"
#include "lobe/forces/needles.h"
#include "lobe/forces/pressure.h"

namespace lobe {
namespace {

template <class Real, class ForceSetup>
KindOfTerm<Real> kind_of_term(std::vector<ForceSetup> ForceSetups::*) {
  return {ForceSetup::term, &ForceSetup::template make_term<Real>,
          [](const Setup& setup, std::span<const ToolBody>) {
            return !setup.forces_of<ForceSetup>().empty() ||
                   (std::is_same_v<ForceSetup, ClipSetup> && !setup.carriers.empty());
          }};
}

template <class Real>
std::vector<KindOfTerm<Real>> all_kinds() {
  std::vector<KindOfTerm<Real>> kinds = {
      {AppliedForces<Real>::term_name,
       [](const Setup&) -> NewTerm<Real> { return std::make_shared<AppliedForces<Real>>(); },
       [](const Setup&, std::span<const ToolBody>) { return false; }, false},
      {Pressure<Real>::term_name,
       [](const Setup& setup) -> NewTerm<Real> { return std::make_shared<Pressure<Real>>(setup); },
       [](const Setup& setup, std::span<const ToolBody>) { return !setup.pressures.empty(); }},
      {Contact<Real>::term_name,
       [](const Setup& setup) -> NewTerm<Real> {
         return std::make_shared<Contact<Real>>(setup.contact, setup.damping);
       },
       [](const Setup& setup, std::span<const ToolBody> tools) {
         return !tools.empty() || setup.contact.is_on();
       },
       false},
      {Needles<Real>::term_name,
       [](const Setup&) -> NewTerm<Real> { return std::make_shared<Needles<Real>>(); },
       [](const Setup&, std::span<const ToolBody>) { return false; }, false}};
  std::apply([&](auto... list) { (kinds.push_back(kind_of_term<Real>(list)), ...); }, ForceSetups::fields);
  // Needles and threads are the last: they predict the motion that all forces before them give.
  const auto moves_last = [](const KindOfTerm<Real>& kind) {
    return kind.name == Needles<Real>::term_name || kind.name == StitchSetup::term;
  };
  std::stable_partition(kinds.begin(), kinds.end(), [&](const auto& kind) { return !moves_last(kind); });
  return kinds;
}

}  // namespace

template <class Real>
std::span<const KindOfTerm<Real>> kinds_of_terms() {
  static const std::vector<KindOfTerm<Real>> kinds = all_kinds<Real>();
  return kinds;
}

template <class Real>
const KindOfTerm<Real>* find_kind_of_term(std::string_view name) {
  const std::span<const KindOfTerm<Real>> kinds = kinds_of_terms<Real>();
  const auto found = std::ranges::find(kinds, name, &KindOfTerm<Real>::name);
  return found == kinds.end() ? nullptr : &*found;
}

template std::span<const KindOfTerm<float>> kinds_of_terms();
template std::span<const KindOfTerm<double>> kinds_of_terms();
template const KindOfTerm<float>* find_kind_of_term(std::string_view);
template const KindOfTerm<double>* find_kind_of_term(std::string_view);

}  // namespace lobe
