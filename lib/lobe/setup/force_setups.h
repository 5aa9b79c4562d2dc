// Forces of a setup besides loads and contact. Each kind has a struct in a file of its own, a list here, and
// a force term (forces/). All structs have
//
//   term                          name of the term
//   make_term<Real>(setup)        makes it; defined beside the term
//   check_all(list, body, expect) what must hold
//   fields                        what decides how it acts
//
// Forces add up in the order of the lists; those of threads come last.
#pragma once

#include "lobe/setup/attachment_setup.h"
#include "lobe/setup/clip_setup.h"
#include "lobe/setup/thread_setup.h"

namespace lobe {

struct ForceSetups {
  std::vector<StitchSetup> stitches;
  std::vector<AttachmentSetup> attachments;
  std::vector<ClipSetup> clips;  // clips that were closed before
  static constexpr auto fields =
      std::tuple(&ForceSetups::stitches, &ForceSetups::attachments, &ForceSetups::clips);

  template <class ForceSetup>
  const std::vector<ForceSetup>& forces_of() const {
    return this->*std::get<std::vector<ForceSetup> ForceSetups::*>(fields);
  }
  bool any_force() const {
    return std::apply([&](auto... list) { return (!(this->*list).empty() || ...); }, fields);
  }
};

}  // namespace lobe
