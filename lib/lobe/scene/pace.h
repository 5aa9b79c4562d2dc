// Which part of a body sets the length of all steps, and what it would spare if each patch took steps of its
// own (time/levels.h). An estimate at rest.
#pragma once

#include <optional>
#include <vector>

#include "lobe/setup/setup.h"
#include "lobe/time/levels.h"

namespace lobe {

struct Pace {
  double time_step = 0;  // stable step of all, 2/ω_max [s]
  struct Part {          // tetrahedra of one material
    Level lowest = highest_level, highest = 0;
  };
  std::vector<Part> materials;
  std::vector<Index> tets_of_level;  // highest_level + 1 numbers
  // Evaluations of forces that own steps would take, as a share of those of one step for all: with the
  // patches as they are, and if patches were as small as tetrahedra.
  double by_patches = 1, by_tets = 1;

  // Up to this share by tetrahedra, each level is measured as a body of its own. It then stands only where
  // it is stable.
  static constexpr double worth_telling = 0.75;
};

// Returns the pace of a setup by its mesh, materials, models, held vertices and attachments, but not by
// contact, which is not known at rest. Returns nothing with implicit steps, selective masses, pre-computed or
// reduced regions, where nothing moves, and where no levels were found stable in twelve rounds. Costs as much
// as building a world without tools, or as several where the pace is worth telling.
std::optional<Pace> pace_at_rest(const Setup& setup);

}  // namespace lobe
