// lobe bench kernels: nanoseconds per tetrahedron of each force kernel, and the ratio to the plain loop.
#include <cstdio>
#include <iomanip>
#include <map>
#include <set>
#include <sstream>

#include "benchmarks/benchmarks.h"
#include "benchmarks/files.h"
#include "benchmarks/kernel_cases.h"
#include "benchmarks/machine.h"
#include "benchmarks/timing.h"

namespace lobe::bench {
namespace {

struct Row {
  Kernel kernel;
  double deviation = 0;
  Index tets = 0;
  double ns_per_tet = 0;
  double ratio = 0;   // to the reference
  double spread = 0;  // of the samples: how quiet the machine was
};

std::vector<Row> checked_rows(const std::shared_ptr<const Cube>& cube, const std::vector<int>& threads) {
  std::vector<Row> rows;
  for (Kernel& kernel : make_kernels(cube, threads)) {
    Row row{std::move(kernel), 0, cube->setup.mesh.tet_count()};
    row.deviation = deviation(row.kernel);
    if (!(row.deviation <= allowed_deviation(row.kernel))) {
      std::ostringstream message;
      message << row.kernel.name << " (" << row.kernel.precision << ", " << row.kernel.threads << " threads, "
              << row.tets << " tetrahedra) deviates by " << row.deviation
              << " from the reference, allowed is " << allowed_deviation(row.kernel)
              << ": nothing was timed at this size";
      throw WrongResult(message.str());
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

void time_rows(std::vector<Row>& rows, const Sampling& sampling) {
  std::vector<Timed> functions;
  for (const Row& row : rows) functions.push_back({row.kernel.evaluate, row.kernel.threads == 1});
  const std::vector<std::vector<double>> samples = sample_in_turn(functions, sampling);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].ns_per_tet = 1e9 * median(samples[i]) / rows[i].tets;
    rows[i].ratio = median(samples[i]) / median(samples[0]);
    rows[i].spread = relative_spread(samples[i]);
  }
}

void print(const std::vector<Row>& rows) {
  std::printf("\n%-18s %-9s %7s %8s %8s %7s %10s %10s %7s\n", "kernel", "precision", "threads", "tets",
              "ns/tet", "ratio", "bytes/tet", "deviation", "spread");
  for (const Row& r : rows)
    std::printf("%-18s %-9s %7d %8d %8.2f %7.3f %10.1f %10.1e %5.0f %%\n", r.kernel.name.c_str(),
                r.kernel.precision.c_str(), r.kernel.threads, r.tets, r.ns_per_tet, r.ratio,
                r.kernel.bytes_per_tet, r.deviation, 100 * r.spread);
  std::fflush(stdout);
}

std::string csv(const std::vector<Row>& rows) {
  std::ostringstream out;
  out << "kernel,precision,threads,tets,ns_per_tet,ratio,bytes_per_tet,deviation,spread\n"
      << std::setprecision(5);
  for (const Row& r : rows)
    out << r.kernel.name << ',' << r.kernel.precision << ',' << r.kernel.threads << ',' << r.tets << ','
        << r.ns_per_tet << ',' << r.ratio << ',' << r.kernel.bytes_per_tet << ',' << r.deviation << ','
        << r.spread << '\n';
  return out.str();
}

// For reading: a line per kernel, a column per size, "ns (ratio)".
std::string markdown(const std::vector<Row>& rows, const std::string& machine) {
  std::map<std::string, std::map<Index, std::string>> table;
  std::vector<std::string> order;
  std::set<Index> sizes;
  for (const Row& r : rows) {
    const std::string name =
        "| `" + r.kernel.name + "` | " + r.kernel.precision + " | " + std::to_string(r.kernel.threads) + " |";
    if (!table.contains(name)) order.push_back(name);
    char cell[64];
    std::snprintf(cell, sizeof cell, " %.1f (%.2f) |", r.ns_per_tet, r.ratio);
    table[name][r.tets] = cell;
    sizes.insert(r.tets);
  }
  std::string out =
      machine +
      "\n\nns per tetrahedron, in brackets the ratio to `reference`:\n\n| kernel | precision | threads |";
  for (Index size : sizes) out += ' ' + std::to_string(size) + " |";
  out += "\n|---|---|---|";
  for (std::size_t i = 0; i < sizes.size(); ++i) out += "---|";
  out += '\n';
  for (const std::string& name : order) {
    out += name;
    for (Index size : sizes) out += table[name][size];
    out += '\n';
  }
  return out;
}

// Cost against size on one thread: a colour per kernel, double precision dashed.
constexpr const char* plot_script = R"(set terminal pngcairo size 1000,620 font 'sans,11'
set output 'kernels.png'
set datafile separator ','
set datafile missing NaN
set logscale x
set yrange [0:*]
set grid
set key outside right
set xlabel 'tetrahedra'
set ylabel 'ns per tetrahedron, one thread'
series(k, p) = (strcol(1) eq k && strcol(2) eq p && column(3) == 1) ? column(5) : NaN
set linetype 1 lc '#0060ad'
set linetype 2 lc '#c02020'
set linetype 3 lc '#20a0d0'
set linetype 4 lc '#2e8b30'
set linetype 5 lc '#e08000'
set linetype 6 lc '#8040a0'
kernels = 'svk svk_stored svk_volume tensor_mass step svk_nodal_pressure'
plot 'kernels.csv' using 4:(series('reference', 'double')) with linespoints lw 2 lc 'black' dt 2 title 'reference, double', \
  for [i=1:words(kernels)] '' using 4:(series(word(kernels, i), 'single')) with linespoints lw 2 lc i pt 7 \
    title word(kernels, i).', single' noenhanced, \
  for [i=1:words(kernels)] '' using 4:(series(word(kernels, i), 'double')) with linespoints lw 2 lc i pt 6 dt 2 \
    title word(kernels, i).', double' noenhanced
)";

}  // namespace

void bench_kernels(const Options& options) {
  std::vector<int> sizes = options.tets;
  if (sizes.empty()) sizes = {2000, 10000, 48000};
  if (options.tets.empty() && !options.quick) sizes.push_back(200000);
  std::vector<int> threads{1};
  if (options.threads > 1) threads.push_back(options.threads);
  const Sampling sampling = options.quick ? Sampling{5, 0.01} : Sampling{};

  const std::string machine = begin_results(options.output, "kernels");
  std::vector<Row> all;
  for (int size : sizes) {
    std::vector<Row> rows = checked_rows(std::make_shared<Cube>(size), threads);
    time_rows(rows, sampling);
    print(rows);
    for (Row& row : rows) {
      row.kernel.evaluate = {};  // lets go of its data
      row.kernel.forces = {};
      row.kernel.expected = {};
      all.push_back(std::move(row));
    }
  }
  write_file(options.output / "kernels.csv", csv(all));
  write_file(options.output / "kernels.md", markdown(all, machine));
  write_file(options.output / "kernels.gp", plot_script);
}

}  // namespace lobe::bench
