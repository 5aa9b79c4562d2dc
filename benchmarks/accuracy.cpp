#include "benchmarks/accuracy.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "benchmarks/machine.h"
#include "lobe/file/atomic_file.h"

namespace lobe::bench {
namespace {

void show(const AccuracyRow& r) {
  std::printf("%-12s %-18s %-6s %7d %6.3g ", r.scene.c_str(), r.model.c_str(), r.precision.c_str(), r.tets,
              r.safety);
  if (r.to_the_end) {
    std::printf("%10.3e %10.4g %11.3e ", r.dt, r.wall_per_s, r.error_model);
    if (r.has_total) std::printf("%11.3e ", r.error_total);
  }
  std::printf(" %s\n", r.status.c_str());
  std::fflush(stdout);
}

void print_heading() {
  std::printf("\n%-12s %-18s %-6s %7s %6s %10s %10s %11s %11s  %s\n", "scene", "model", "prec.", "tets",
              "safety", "dt [s]", "wall/s", "error_model", "error_total", "status");
}

void print_pareto(std::vector<AccuracyRow> rows) {
  std::stable_sort(rows.begin(), rows.end(),
                   [](const AccuracyRow& a, const AccuracyRow& b) { return a.wall_per_s < b.wall_per_s; });
  std::printf("\nno other way of these is both faster and closer to the fine reference:\n");
  for (const AccuracyRow& row : rows)
    if (row.pareto) show(row);
}

// How far the references themselves can be trusted.
void print_references(const std::vector<AccuracyRow>& rows) {
  Index tets = 0;
  for (const AccuracyRow& row : rows) {
    if (std::exchange(tets, row.tets) == row.tets) continue;
    std::printf("halving its time steps changed the reference on %d tetrahedra by %.1e", row.tets,
                row.model_reference_change);
    if (row.has_total) std::printf(", that on the fine mesh by %.1e", row.total_reference_change);
    std::printf("\n");
  }
}

}  // namespace

void bench_accuracy(const Options& options) {
  const std::vector<Case> cases = make_cases(options);
  begin_results(options.output, "accuracy");
  std::vector<AccuracyRow> all;
  for (const Case& scene : cases) {
    print_heading();
    const Accuracy accuracy = measure_accuracy(scene, options.threads, show, !options.single);
    for (const std::string& warning : accuracy.warnings)
      std::fprintf(stderr, "lobe: warning: %s: %s\n", scene.name.c_str(), warning.c_str());
    print_pareto(accuracy.rows);
    print_references(accuracy.rows);
    all.insert(all.end(), accuracy.rows.begin(), accuracy.rows.end());
    io::write_file(options.output / "accuracy.csv", accuracy_csv(all));
    io::write_file(options.output / "accuracy.gp", accuracy_plot(all));
  }
}

}  // namespace lobe::bench
