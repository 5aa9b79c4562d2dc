// Every row of `lobe bench validation --quick` must pass.
#include <doctest/doctest.h>

#include <cstdio>

#include "benchmarks/validation/cases.h"
#include "benchmarks/validation/table.h"

using namespace lobe::validation;

TEST_CASE("every case of the validation table is within its tolerance") {
  std::printf("%s", text_header().c_str());
  for (const Family& family : all_families()) {
    const Findings findings = run_family(family, true);
    CHECK(!findings.rows().empty());
    for (const Row& row : findings.rows()) {
      const std::string line = text_line(row);
      std::printf("%s", line.c_str());
      CHECK_MESSAGE(row.passed, line);
    }
    std::fflush(stdout);
  }
}
