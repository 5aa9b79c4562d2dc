// lobe bench kernels: nanoseconds per tetrahedron of each force kernel, and the ratio to the plain loop.
#include <algorithm>
#include <cstdio>
#include <iomanip>
#include <map>
#include <sstream>

#include "benchmarks/benchmarks.h"
#include "benchmarks/kernel_cases.h"
#include "benchmarks/machine.h"
#include "benchmarks/roofline.h"
#include "benchmarks/timing.h"
#include "lobe/file/atomic_file.h"

namespace lobe::bench {
namespace {

struct KernelRow {
  Kernel kernel;
  std::string mesh;
  double deviation = 0;
  Index tets = 0;
  double ns_per_tet = 0;
  double ratio = 0;   // to the reference
  double spread = 0;  // of the samples: how quiet the machine was

  double gb_per_s() const { return kernel.bytes_per_tet / ns_per_tet; }
  double gflop_per_s() const { return kernel.flops_per_tet / ns_per_tet; }
};

std::vector<KernelRow> checked_rows(const std::shared_ptr<const Specimen>& specimen,
                                    const std::vector<int>& threads) {
  std::vector<KernelRow> rows;
  for (Kernel& kernel : make_kernels(specimen, threads)) {
    KernelRow row{std::move(kernel), specimen->mesh, 0, specimen->setup.mesh.tet_count()};
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

void time_rows(std::vector<KernelRow>& rows, const Sampling& sampling) {
  std::vector<Timed> functions;
  for (const KernelRow& row : rows) functions.push_back({row.kernel.evaluate, row.kernel.threads == 1});
  const std::vector<std::vector<double>> samples = sample_in_turn(functions, sampling);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].ns_per_tet = 1e9 * median(samples[i]) / rows[i].tets;
    rows[i].ratio = median(samples[i]) / median(samples[0]);
    rows[i].spread = relative_spread(samples[i]);
  }
}

void print(const std::vector<KernelRow>& rows) {
  std::printf("\n%-8s %-18s %-9s %7s %8s %8s %7s %10s %6s %8s %10s %7s\n", "mesh", "kernel", "precision",
              "threads", "tets", "ns/tet", "ratio", "bytes/tet", "GB/s", "Gflop/s", "deviation", "spread");
  for (const KernelRow& r : rows)
    std::printf("%-8s %-18s %-9s %7d %8d %8.2f %7.3f %10.1f %6.1f %8.1f %10.1e %5.0f %%\n", r.mesh.c_str(),
                r.kernel.name.c_str(), r.kernel.precision.c_str(), r.kernel.threads, r.tets, r.ns_per_tet,
                r.ratio, r.kernel.bytes_per_tet, r.gb_per_s(), r.gflop_per_s(), r.deviation, 100 * r.spread);
  for (const KernelRow& r : rows)
    if (r.kernel.world_bytes_per_tet > 0)
      std::printf("a world takes %.0f bytes per tetrahedron (%s, %d threads)\n", r.kernel.world_bytes_per_tet,
                  r.kernel.precision.c_str(), r.kernel.threads);
  std::fflush(stdout);
}

std::string csv(const std::vector<KernelRow>& rows) {
  std::ostringstream out;
  out << "kernel,precision,threads,tets,ns_per_tet,ratio,bytes_per_tet,deviation,spread,mesh,flops_per_tet,"
         "gb_per_s,"
         "gflop_per_s,world_bytes_per_tet\n"
      << std::setprecision(5);
  for (const KernelRow& r : rows)
    out << r.kernel.name << ',' << r.kernel.precision << ',' << r.kernel.threads << ',' << r.tets << ','
        << r.ns_per_tet << ',' << r.ratio << ',' << r.kernel.bytes_per_tet << ',' << r.deviation << ','
        << r.spread << ',' << r.mesh << ',' << r.kernel.flops_per_tet << ',' << r.gb_per_s() << ','
        << r.gflop_per_s() << ',' << r.kernel.world_bytes_per_tet << '\n';
  return out.str();
}

// For reading: a line per kernel, a column per size, "ns (ratio)".
std::string markdown(const std::vector<KernelRow>& rows, const std::string& machine) {
  std::map<std::string, std::map<std::string, std::string>> table;
  std::vector<std::string> order;
  std::vector<std::string> bodies;  // columns, in order
  for (const KernelRow& r : rows) {
    const std::string name =
        "| `" + r.kernel.name + "` | " + r.kernel.precision + " | " + std::to_string(r.kernel.threads) + " |";
    if (!table.contains(name)) order.push_back(name);
    char cell[64];
    std::snprintf(cell, sizeof cell, " %.1f (%.2f) |", r.ns_per_tet, r.ratio);
    const std::string body = r.mesh + ' ' + std::to_string(r.tets);
    if (std::find(bodies.begin(), bodies.end(), body) == bodies.end()) bodies.push_back(body);
    table[name][body] = cell;
  }
  std::string out =
      machine +
      "\n\nns per tetrahedron, in brackets the ratio to `reference`:\n\n| kernel | precision | threads |";
  for (const std::string& body : bodies) out += ' ' + body + " |";
  out += "\n|---|---|---|";
  for (std::size_t i = 0; i < bodies.size(); ++i) out += "---|";
  out += '\n';
  for (const std::string& name : order) {
    out += name;
    for (const std::string& body : bodies) out += table[name][body];
    out += '\n';
  }
  return out;
}

// Cost against size on one thread: a colour per kernel, double precision dashed.
constexpr const char* kernels_plot = R"(set terminal pngcairo size 1000,620 font 'sans,11'
set output 'kernels.png'
set datafile separator ','
set datafile missing NaN
set logscale x
set yrange [0:60]
set grid
set key outside right
set xlabel 'tetrahedra'
set ylabel 'ns per tetrahedron, one thread'
of(m, k, p) = (strcol(10) eq m && strcol(1) eq k && strcol(2) eq p && column(3) == 1) ? column(5) : NaN
series(k, p) = of('cube', k, p)
set linetype 1 lc '#0060ad'
set linetype 2 lc '#c02020'
set linetype 3 lc '#20a0d0'
set linetype 4 lc '#2e8b30'
set linetype 5 lc '#e08000'
set linetype 6 lc '#8040a0'
kernels = 'svk svk_stored svk_volume svk_guard tensor_mass corotational step svk_nodal_pressure svk_smoothed svk_smoothed_pressure svk_fibre neo_hookean'
plot 'kernels.csv' using 4:(series('reference', 'double')) with linespoints lw 2 lc 'black' dt 2 title 'reference, double', \
  '' using 4:(of('shuffled', 'svk', 'single')) with linespoints lw 1 lc 1 pt 1 title 'svk, single, shuffled', \
  for [i=1:words(kernels)] '' using 4:(series(word(kernels, i), 'single')) with linespoints lw 2 lc i pt 7 \
    title word(kernels, i).', single' noenhanced, \
  for [i=1:words(kernels)] '' using 4:(series(word(kernels, i), 'double')) with linespoints lw 2 lc i pt 6 dt 2 \
    title word(kernels, i).', double' noenhanced
)";

std::vector<std::function<Specimen()>> bodies(const Options& options) {
  std::vector<int> sizes = options.tets;
  if (sizes.empty()) sizes = {2000, 10000, 48000};
  const bool complete = options.tets.empty() && !options.quick;
  if (complete) sizes.insert(sizes.end(), {200000, 1000000});
  std::vector<std::function<Specimen()>> bodies;
  for (int size : sizes) {
    bodies.push_back([size] { return Specimen("cube", cube_setup(size)); });
    if (!options.quick) bodies.push_back([size] { return Specimen("shuffled", shuffled(cube_setup(size))); });
  }
  if (complete) bodies.push_back([] { return Specimen("liver", liver_setup()); });
  return bodies;
}

std::string roofline_line() {
  static const double stream = stream_bytes_per_second(), single = peak_flops_per_second<float>(),
                      real = peak_flops_per_second<double>();
  char line[160];
  std::snprintf(line, sizeof line,
                "one thread reads %.0f GB/s from memory and does %.0f (single), %.0f (double) Gflop/s",
                stream / 1e9, single / 1e9, real / 1e9);
  return line;
}

}  // namespace

void bench_kernels(const Options& options) {
  std::vector<int> threads{1};
  if (options.threads > 1) threads.push_back(options.threads);
  const Sampling sampling = options.quick ? Sampling{5, 0.01} : Sampling{};

  const std::string machine = begin_results(options.output, "kernels") + "; " + roofline_line();
  std::printf("%s\n", roofline_line().c_str());
  std::vector<KernelRow> all;
  for (const std::function<Specimen()>& body : bodies(options)) {
    std::vector<KernelRow> rows = checked_rows(std::make_shared<Specimen>(body()), threads);
    time_rows(rows, sampling);
    print(rows);
    for (KernelRow& row : rows) {
      row.kernel.evaluate = {};  // lets go of its data
      row.kernel.forces = {};
      row.kernel.expected = {};
      all.push_back(std::move(row));
    }
  }
  io::write_file(options.output / "kernels.csv", csv(all));
  io::write_file(options.output / "kernels.md",
                 "# Kernels: time per tetrahedron\n\n" + markdown(all, machine));
  io::write_file(options.output / "kernels.gp", kernels_plot);
}

}  // namespace lobe::bench
