#include "lobe/setup/attachment_setup.h"

#include <algorithm>
#include <cmath>
#include <set>

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

void AttachmentSetup::check_all(const std::vector<AttachmentSetup>& all, const Body& body,
                                const Expect& expect) {
  std::set<std::string> names;
  for (const AttachmentSetup& attachment : all) {
    attachment.check(expect);
    expect(names.insert(attachment.name).second, "there are two attachments \"" + attachment.name + "\"");
    expect(std::all_of(attachment.strands.begin(), attachment.strands.end(),
                       [&](const StrandSetup& strand) {
                         return can_be_pulled(strand.from.tet, body) &&
                                (strand.ends_in_world() || can_be_pulled(strand.to.tet, body));
                       }),
           "attachment \"" + attachment.name +
               "\" has an end in a tetrahedron that there is not, or that is precomputed, where nothing can "
               "pull");
  }
}

}  // namespace lobe
