// Tools as a scene gives them, with their paths. Each kind of tool has a struct in a file of its own, a list
// here, and a class in tool/. All structs have
//
//   type               its name in scenes
//   name, path
//   check(expect)      what must hold
//   needs_force_term() whether the tool acts by a force term (Option::force_terms); only in kinds that may
//   any_partly()       whether it holds vertices by shares (Option::partly_held); only in kinds that may
//   fields             what decides how it moves: all but the name
#pragma once

#include "lobe/setup/cautery_setup.h"
#include "lobe/setup/clip_applier_setup.h"
#include "lobe/setup/grasp_setup.h"
#include "lobe/setup/needle_setup.h"
#include "lobe/setup/probe_setup.h"
#include "lobe/setup/scalpel_setup.h"

namespace lobe {

// Whether this tool acts by a force term.
template <class ToolSetup>
bool needs_force_term(const ToolSetup& tool) {
  if constexpr (requires { tool.needs_force_term(); }) return tool.needs_force_term();
  return false;
}

struct ToolSetups {
  std::vector<GraspSetup> grasps;
  std::vector<CauterySetup> cauteries;
  std::vector<ScalpelSetup> scalpels;
  std::vector<ProbeSetup> probes;
  std::vector<ClipApplierSetup> clip_appliers;
  std::vector<NeedleSetup> needles;
  static constexpr auto fields =
      std::tuple(&ToolSetups::grasps, &ToolSetups::cauteries, &ToolSetups::scalpels, &ToolSetups::probes,
                 &ToolSetups::clip_appliers, &ToolSetups::needles);
};

// Calls visit(list) for the list of each kind of tool, of ToolSetups or ToolLists (tool/tool_lists.h).
template <class Lists, class Visit>
void for_each_kind(Lists& lists, Visit&& visit) {
  std::apply([&](auto... list) { (visit(lists.*list), ...); }, Lists::fields);
}
// The list of the tools of one kind.
template <class ToolSetup>
std::vector<ToolSetup>& list_of(ToolSetups& setups) {
  return setups.*std::get<std::vector<ToolSetup> ToolSetups::*>(ToolSetups::fields);
}
template <class ToolSetup>
const std::vector<ToolSetup>& list_of(const ToolSetups& setups) {
  return setups.*std::get<std::vector<ToolSetup> ToolSetups::*>(ToolSetups::fields);
}
// Calls visit(tool) for each tool.
template <class Lists, class Visit>
void for_each_tool(Lists& lists, Visit&& visit) {
  for_each_kind(lists, [&](auto& list) {
    for (auto& tool : list) visit(tool);
  });
}

}  // namespace lobe
