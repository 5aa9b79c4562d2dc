// lobe bench validation: all cases against their references in one table (docs/validation.md).
#include <cstdio>

#include "benchmarks/benchmarks.h"
#include "benchmarks/machine.h"
#include "benchmarks/timing.h"
#include "benchmarks/validation/cases.h"
#include "benchmarks/validation/table.h"
#include "lobe/error.h"
#include "lobe/file/atomic_file.h"

namespace lobe::bench {
namespace {

std::span<const validation::Family> chosen_families(const std::string& name) {
  const auto all = validation::all_families();
  if (name.empty()) return all;
  std::string names;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (name == all[i].name) return all.subspan(i, 1);
    names += std::string("\n  ") + all[i].name;
  }
  throw InputError("--family " + name, "no such family; there are:" + names);
}

}  // namespace

void bench_validation(const Options& options) {
  using namespace validation;
  const auto families = chosen_families(options.family);
  const std::string machine = begin_results(options.output, "validation");
  std::printf("\n%s", text_header().c_str());
  std::vector<Row> rows;
  std::vector<Point> points;
  std::size_t failed = 0;
  for (const Family& family : families) {
    const validation::Findings findings = run_family(family, options.quick);
    for (const Row& row : findings.rows()) {
      std::printf("%s", text_line(row).c_str());
      failed += !row.passed;
    }
    std::fflush(stdout);
    rows.insert(rows.end(), findings.rows().begin(), findings.rows().end());
    points.insert(points.end(), findings.points().begin(), findings.points().end());
  }
  io::write_file(options.output / "validation.csv", csv(rows));
  io::write_file(options.output / "validation.md",
                 "# Validation: results\n\n" + machine + "\n" + markdown(rows));
  if (!points.empty()) io::write_file(options.output / "validation.gp", study_script(points));
  const std::string count = std::to_string(failed) + " of " + std::to_string(rows.size()) + " rows failed";
  std::printf("\n%s\n", count.c_str());
  if (failed > 0) throw WrongResult(count + "; see validation.csv");
}

}  // namespace lobe::bench
