// The parts of report.json, and what they are summed up from. Private to this folder.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lobe/linearity/proposal.h"
#include "lobe/sim/world.h"

namespace lobe {

// Sums of the reports of all frames.
struct Totals {
  using Json = nlohmann::ordered_json;
  long long steps = 0;
  double smallest_step = 0, largest_step = 0;  // [s]
  double smallest_volume_ratio = 1;
  double simulation_seconds = 0, slowest_frame = 0, output_seconds = 0;  // wall
  std::array<double, phase_count> phases{};
  Json cuts = Json::array(), conditions = Json::array(), events = Json::array(), series = Json::array(),
       transitions = Json::array();
  Index tets_removed = 0, tets_copied = 0;
  double cut_area = 0, mass_added = 0;  // area cut and mass added by blades [m²], [kg]
  long long states = 1, patches_evaluated = 0, patches_skipped = 0;
  LevelRatios share_of_levels{};  // own steps: sums over frames of the shares of tetrahedra at each level
  int frames_by_levels = 0;       // in which some step more seldom
  std::vector<std::string> warnings;
  bool warned_of_inversion = false;

  void add(const Report& report, double time, double wall);
  void add_levels(const LevelRatios& shares);  // of tetrahedra in a frame
};

// An entry of the report's series: time, volume, energies and tools now.
template <class Real>
nlohmann::ordered_json state_json(World<Real>& world);
nlohmann::ordered_json region_counts(const Elements& elements);
nlohmann::ordered_json timing_json(const Totals& totals, double simulated, double setup_seconds,
                                   const CondensingLog& condensing);
// Lists what the run did not compute: patches that slept, states that no output needed, terms that the scene
// leaves out.
nlohmann::ordered_json skipped_json(const Totals& totals, const Setup& setup, std::size_t written);
// At which levels tetrahedra stepped.
nlohmann::ordered_json own_steps_json(const Totals& totals);
nlohmann::ordered_json proposal_json(const Proposal& proposal);

// The summary of a report, for the console.
std::string summary_of(const nlohmann::ordered_json& report);

}  // namespace lobe
