// What one edit of a body has changed, as data, and the moments of a frame at which kinds of regions wish for
// edits. Organ::edit() is the one place where an edit is made, and Organ::follow() the one list of what
// follows it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lobe/body/model.h"
#include "lobe/lattice/embedding.h"
#include "lobe/organ/edit.h"

namespace lobe {

// What an edit needs before it changes anything.
struct Before {
  bool velocities = false;  // velocities are brought up to the time of the displacements
  bool followers = false;   // what follows others is placed where it now is
  bool energies = false;    // energies are compared before and after, as vertices change what they follow
};

struct Change {
  std::optional<MeshEdit> mesh;       // tetrahedra that went or were divided; empty: only grains came apart
  std::optional<RegionEdit> regions;  // tetrahedra of other regions, vertices that are held or let go
  std::vector<Index> frozen;          // vertices of a piece that came loose, which are held from now on
  bool is_condensed_anew = false;     // a pre-computed region has another stiffness and carries other masses
  std::optional<bool> is_expanded;    // the mode of pre-computed regions
  std::optional<VertexRoles> roles;   // roles of vertices: which of them follow a lattice
  std::optional<int> mass_degree;     // degree of selective masses
  std::vector<Index> weighed;         // vertices that got more mass
  bool has_terms = false;             // force terms act on other vertices or otherwise
  std::vector<Index> woken;           // vertices that terms had woken
  bool has_new_terms = false;         // there are terms that act on nothing yet, or terms see other tools
  bool interior_is_sought = false;    // a tool seeks it: no step says how far what follows others has moved
  std::optional<Revisions> former;    // revisions of the organ in whose place this one is
  std::optional<JournalEntry> entry;
};

enum class Moment : std::uint8_t {
  frame_begins,
  limit_is_found,  // the step limit, with the smallest volume ratio
  tool_touches,    // a tool touches `vertices`
  blade_comes,     // a blade comes near `tets`
  tets_go,         // `tets` are about to be removed
  steps_begin,     // the edits of a frame are done; `vertices`: pressed ones that have been found late
  step_is_chosen
};
struct Occasion {
  Moment moment;
  std::vector<Index> tets = {}, vertices = {};
};

}  // namespace lobe
