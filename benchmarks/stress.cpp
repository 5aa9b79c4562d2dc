// lobe bench stress: every plan in single and in double precision, one verdict each (docs/stability.md).
#include <cmath>
#include <cstdio>
#include <sstream>

#include "benchmarks/benchmarks.h"
#include "benchmarks/machine.h"
#include "benchmarks/stress/play.h"
#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/text.h"

namespace lobe::bench {
namespace {

using stress::Plan;
using stress::Verdict;

struct StressRow {
  const Plan* plan;
  Verdict verdict;
};

const char* precision(const StressRow& r) { return r.verdict.in_double ? "double" : "single"; }
double growth(const Verdict& v) { return v.energy_early > 0 ? v.energy_late / v.energy_early : NAN; }

void print_header() {
  std::printf("\n%-44s %-12s %-14s %-6s %9s %9s %9s %9s %8s %6s %10s  %s\n", "case", "body", "model", "prec.",
              "min det F", "max det F", "energy x", "momentum", "steps", "reruns", "step s", "verdict");
}

void print(const StressRow& r) {
  const Verdict& v = r.verdict;
  std::printf("%-44s %-12s %-14s %-6s %9.3g %9.3g %9.3g %9.1e %8ld %6d %10.2e  %s%s\n", r.plan->name.c_str(),
              r.plan->body.c_str(), r.plan->model.c_str(), precision(r), v.smallest_ratio, v.largest_ratio,
              growth(v), v.momentum_drift, v.steps, v.reruns, v.smallest_step,
              v.passed ? "passed" : "FAILED: ", v.passed ? "" : v.why.c_str());
  std::fflush(stdout);
}

std::string quoted(std::string text) {
  for (char& c : text) c = c == '"' ? '\'' : c;
  return '"' + text + '"';
}

std::string csv(const std::vector<StressRow>& rows) {
  std::ostringstream out;
  out << "case,body,model,precision,must,passed,smallest_det_F,largest_det_F,last_det_F,energy_start_J,"
         "energy_early_J,energy_late_J,momentum_drift,cut_error,farthest,steps,reruns,unravelling_s,"
         "smallest_step_s,largest_step_s,limited_by,seconds,why\n";
  for (const StressRow& r : rows) {
    const Verdict& v = r.verdict;
    out << quoted(r.plan->name) << ',' << r.plan->body << ',' << r.plan->model << ',' << precision(r) << ','
        << quoted(name(r.plan->must)) << ',' << (v.passed ? "yes" : "no");
    for (double x : {v.smallest_ratio, v.largest_ratio, v.last_ratio, v.energy_start, v.energy_early,
                     v.energy_late, v.momentum_drift, v.cut_error, v.farthest})
      out << ',' << rounded(x);
    out << ',' << v.steps << ',' << v.reruns << ',' << rounded(v.unravelling) << ','
        << rounded(v.smallest_step) << ',' << rounded(v.largest_step) << ',' << v.limited_by << ','
        << rounded(v.seconds) << ',' << quoted(v.why) << '\n';
  }
  return out.str();
}

// One line per case and body: the worst figures of all models and precisions, how many passed, and in how
// many a tangle was unravelled.
std::string markdown(const std::vector<StressRow>& rows) {
  std::ostringstream out;
  out << "\n| case | body | must | passed | smallest det F | largest det F | reruns | unravelled | shortest "
         "step [s] | what failed |\n"
         "|---|---|---|---|---|---|---|---|---|---|\n";
  std::vector<const StressRow*> left;
  for (const StressRow& r : rows) left.push_back(&r);
  while (!left.empty()) {
    const Plan& plan = *left.front()->plan;
    int count = 0, passed = 0, reruns = 0, unravelled = 0;
    double smallest = INFINITY, largest = 0, step = INFINITY;
    std::string failed;
    std::erase_if(left, [&](const StressRow* r) {
      if (r->plan->name != plan.name || r->plan->body != plan.body) return false;
      const Verdict& v = r->verdict;
      ++count;
      passed += v.passed;
      reruns += v.reruns;
      unravelled += v.unravelling > 0;
      smallest = std::min(smallest, v.smallest_ratio);
      largest = std::max(largest, v.largest_ratio);
      step = std::min(step, v.smallest_step);
      if (!v.passed)
        failed += (failed.empty() ? "" : "; ") + r->plan->model + ", " + precision(*r) + ": " + v.why;
      return true;
    });
    out << "| " << plan.name << " | " << plan.body << " | " << name(plan.must) << " | " << passed << " of "
        << count << " | " << rounded(smallest) << " | " << rounded(largest) << " | " << reruns << " | "
        << unravelled << " | " << rounded(step) << " | " << failed << " |\n";
  }
  return out.str();
}

}  // namespace

void bench_stress(const Options& options) {
  const std::string machine = begin_results(options.output, "stress");
  std::vector<Plan> plans = stress::all_plans(options.quick);
  if (!options.model.empty())
    std::erase_if(plans, [&](const Plan& plan) { return plan.model != options.model; });
  if (plans.empty()) throw InputError("--model", "the suite has no model \"" + options.model + "\"");
  print_header();
  std::vector<StressRow> rows;
  std::size_t failed = 0;
  for (const Plan& plan : plans)
    for (const bool in_double : {false, true}) {
      rows.push_back({&plan, in_double ? stress::play<double>(plan) : stress::play<float>(plan)});
      print(rows.back());
      failed += !rows.back().verdict.passed;
    }
  io::write_file(options.output / "stress.csv", csv(rows));
  io::write_file(options.output / "stress.md",
                 "# Stress suite: results\n\n" + machine + "\n" + markdown(rows));
  const std::string count = std::to_string(failed) + " of " + std::to_string(rows.size()) + " runs failed";
  std::printf("\n%s\n", count.c_str());
  if (failed > 0) throw WrongResult(count + "; see stress.csv");
}

}  // namespace lobe::bench
