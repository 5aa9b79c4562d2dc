// Commands that World makes by itself, and that a file or an application may hand it as well.
#pragma once

#include <algorithm>

#include "lobe/error.h"
#include "lobe/sim/command.h"
#include "lobe/time/dynamics.h"

namespace lobe {

// Throws InputError for a command that this body cannot follow now.
template <class Real>
void check_command(const Dynamics<Real>& body, const Command& command) {
  const Index vertices = body.model.elements.topology.vertex_count();
  if (const auto* hold = std::get_if<Hold>(&command)) {
    const auto is_there = [&](const HeldVertices::Held& item) {
      return item.is_valid() && item.vertex < vertices;
    };
    if (!std::all_of(hold->held.all().begin(), hold->held.all().end(), is_there))
      throw InputError("command", "holds a vertex that there is not, or at no finite place");
  }
  if (const auto* begin = std::get_if<BeginCondensing>(&command)) {
    if (!body.regions.can_begin_condensing())
      throw InputError("command", "condenses a region that there is not, or that is being condensed");
    if (begin->about && begin->about->size() != std::size_t(3 * vertices))
      throw InputError("command", "relinearises about displacements of another mesh");
  }
  // The region may be cut away while it is condensed.
  if (std::holds_alternative<EndCondensing>(command) && !body.regions.is_condensing())
    throw InputError("command", "ends condensing, which has not begun");
}

}  // namespace lobe
