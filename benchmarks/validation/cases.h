// The families of validation cases; docs/validation.md says what each shows. Each adds its rows to the
// findings, with smaller meshes if `quick`; an exception means that it ended early.
#pragma once

#include <span>

#include "benchmarks/validation/findings.h"

namespace lobe::validation {

void patch_tests(Findings& findings, bool quick);
void manufactured_solutions(Findings& findings, bool quick);
void orders_in_time(Findings& findings, bool quick);
void closed_forms(Findings& findings, bool quick);
void turek_hron(Findings& findings, bool quick);
void svk_beam(Findings& findings, bool quick);
void independent_solutions(Findings& findings, bool quick);
void long_runs(Findings& findings, bool quick);
void natural_frequencies(Findings& findings, bool quick);
void fibre_benchmarks(Findings& findings, bool quick);
void quadratic_tetrahedra(Findings& findings, bool quick);
void silicone_beam(Findings& findings, bool quick);
void silicone_beam_motion(Findings& findings, bool quick);
void land_beam(Findings& findings);  // some minutes

struct Family {
  const char* name;
  void (*run)(Findings& findings, bool quick);
};
std::span<const Family> all_families();

// Never throws: what a family throws becomes a failed row.
Findings run_family(const Family& family, bool quick);

}  // namespace lobe::validation
