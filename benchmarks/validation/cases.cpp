#include "benchmarks/validation/cases.h"

#include <exception>

namespace lobe::validation {

std::span<const Family> all_families() {
  static constexpr Family list[] = {
      {"patch test", patch_tests},
      {"manufactured solution", manufactured_solutions},
      {"order in time", orders_in_time},
      {"closed form", closed_forms},
      {"Turek-Hron", turek_hron},
      {"SVK beam", svk_beam},
      {"independent solution", independent_solutions},
      {"long run", long_runs},
      {"natural frequency", natural_frequencies},
      {"fibres", fibre_benchmarks},
      {"quadratic tetrahedra", quadratic_tetrahedra},
      {"silicone beam", silicone_beam},
      {"silicone beam in motion", silicone_beam_motion},
  };
  return list;
}

Findings run_family(const Family& family, bool quick) {
  Findings findings(family.name);
  try {
    family.run(findings, quick);
  } catch (const std::exception& error) {
    findings.failure(error.what());
  }
  return findings;
}

}  // namespace lobe::validation
