#include "lobe/setup/attachment_setup.h"

#include <algorithm>
#include <cmath>

namespace lobe {

void AttachmentSetup::check(const Expect& expect) const {
  const std::string whose = "attachment \"" + name + "\"";
  expect(!name.empty(), "an attachment needs a name");
  expect(holds_until > 0, whose + " must hold until an elongation above 0 m");
  expect(std::isfinite(softening) && softening > 1, whose + " needs a softening above 1, and finite");
  expect(!strands.empty(), whose + " has no strand");
  expect(std::all_of(strands.begin(), strands.end(), [](const StrandSetup& s) { return s.is_valid(); }),
         whose + " has a strand without a valid end, or a length, stiffness or area out of range");
  for (const StrandSetup& strand : strands)
    if (strand.from.tet >= 0 && strand.from.tet == strand.to.tet)
      return expect(false, whose + " has a strand with both ends in tetrahedron " +
                               std::to_string(strand.from.tet) + ", where it would pull at nothing");
}

}  // namespace lobe
