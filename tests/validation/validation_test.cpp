// Every row of `lobe bench validation --quick` must pass.
#include <doctest/doctest.h>

#include <atomic>
#include <cstdio>
#include <optional>
#include <thread>

#include "benchmarks/validation/cases.h"
#include "benchmarks/validation/table.h"

using namespace lobe::validation;

namespace {

// All families, two at a time.
std::vector<lobe::validation::Findings> all_findings() {
  const auto& families = all_families();
  std::vector<std::optional<lobe::validation::Findings>> found(families.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < found.size(); i = next++) found[i] = run_family(families[i], true);
  };
  std::thread other(work);
  work();
  other.join();
  std::vector<lobe::validation::Findings> all;
  for (auto& findings : found) all.push_back(*std::move(findings));
  return all;
}

}  // namespace

TEST_CASE("every case of the validation table is within its tolerance") {
  std::printf("%s", text_header().c_str());
  for (const lobe::validation::Findings& findings : all_findings()) {
    CHECK(!findings.rows().empty());
    for (const Row& row : findings.rows()) {
      const std::string line = text_line(row);
      std::printf("%s", line.c_str());
      CHECK_MESSAGE(row.passed, line);
    }
    std::fflush(stdout);
  }
}
