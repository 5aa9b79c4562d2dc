// The kinds of force terms that a World makes by itself, in one table: those of all forces of a setup
// (setup/force_setups.h), and a few more. World needs no change for a new one. Terms of other kinds come by
// World::add().
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "lobe/forces/force_term.h"
#include "lobe/setup/setup.h"

namespace lobe {

template <class Real>
struct KindOfTerm {
  std::string_view name;  // name of its terms; a world has at most one of each kind
  std::shared_ptr<ForceTerm<Real>> (*make)(const Setup& setup);
  // Whether a world with this setup and these tools in the next frame needs one. Without need, a command or a
  // checkpoint may still ask for one.
  bool (*is_needed)(const Setup& setup, std::span<const ToolBody> tools);
  bool follows_cuts = true;  // whether it is there from the first on, since it follows cuts
};

template <class Real>
std::span<const KindOfTerm<Real>> kinds_of_terms();
template <class Real>
const KindOfTerm<Real>* find_kind_of_term(std::string_view name);  // null: no kind has this name

}  // namespace lobe
