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
  bool velocities = false;  // brought up to the time of the displacements
  bool followers = false;   // recovered: what follows others is where it now is
  bool energies = false;    // compared before and after, where vertices change what they follow
};

struct Change {
  std::optional<MeshEdit> mesh;       // tetrahedra that went or were divided; empty: only grains came apart
  std::optional<RegionEdit> regions;  // tetrahedra of other regions, vertices that are held or let go
  std::vector<Index> frozen;          // vertices that are held from now on, of a piece that came loose
  bool is_condensed_anew = false;     // a pre-computed region: its stiffness and its carried masses
  std::optional<bool> is_expanded;    // the mode of pre-computed regions
  std::optional<VertexRoles> roles;   // of vertices: which of them follow a lattice
  std::optional<int> mass_degree;     // of selective masses
  std::vector<Index> weighed;         // vertices that got more mass
  bool has_terms = false;             // force terms act on other vertices or otherwise
  std::vector<Index> woken;           // vertices that terms woke before
  bool has_new_terms = false;         // there are terms that act on nothing yet, or terms see other tools
  bool interior_is_sought = false;    // by a tool: no step says how far what follows others has moved
  std::optional<Revisions> former;    // of the organ in whose place this one is
  std::optional<JournalEntry> entry;
};

enum class Moment : std::uint8_t {
  frame_begins,
  limit_is_found,  // of the step, with the smallest volume ratio
  tool_touches,    // vertices
  blade_comes,     // near tetrahedra
  tets_go,         // tetrahedra, which are about to be removed
  steps_begin,     // after the edits of a frame; vertices: pressed ones that have been found late
  step_is_chosen
};
struct Occasion {
  Moment moment;
  std::vector<Index> tets = {}, vertices = {};
};

}  // namespace lobe
