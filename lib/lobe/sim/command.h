// All that may be done to a world, as data: frames, edits of the body and commands of tools. Applications
// apply them (World::apply()), and recordings replay them.
#pragma once

#include <tuple>
#include <variant>

#include "lobe/organ/edit.h"
#include "lobe/tool/tools.h"

namespace lobe {

struct Advance {
  double duration = 0;  // [s]
  bool operator==(const Advance&) const = default;
  static constexpr auto fields = std::tuple(&Advance::duration);
};

template <class... Variants>
struct Joined;
template <class... A, class... B, class... C>
struct Joined<std::variant<A...>, std::variant<B...>, std::variant<C...>> {
  using Type = std::variant<A..., B..., C...>;
};
using Command = Joined<std::variant<Advance>, Edit, ToolCommand>::Type;

inline Command as_command(const Edit& edit) {
  return std::visit([](const auto& any) -> Command { return any; }, edit);
}

}  // namespace lobe
