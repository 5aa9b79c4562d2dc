// lobe bench huge: static solutions in parts by lobe-petsc, under mpirun (docs/huge.md).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

#include "benchmarks/benchmarks.h"
#include "benchmarks/machine.h"
#include "console.h"
#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/generators.h"

namespace lobe::bench {
namespace {

using Json = nlohmann::json;

struct HugeRow {
  Index tets = 0;
  int ranks = 1;
  Json report;

  double peak() const {  // of the rank with most [byte]
    double most = 0;
    for (double bytes : report["peak_memory_bytes_of_rank"]) most = std::max(most, bytes);
    return most;
  }
  double sum(const char* key) const {
    double all = 0;
    for (double value : report[key]) all += value;
    return all;
  }
};

// A bar of 2 × 1 × 1 with about so many tetrahedra, held at one end and stretched by a tenth at the other.
void write_bar(const std::filesystem::path& folder, int wanted) {
  const int n = std::max(1, int(std::lround(std::cbrt(wanted / 12.0))));
  write_vtu(folder / "bar.vtu", box_mesh({0.2, 0.1, 0.1}, 2 * n, n, n));
  constexpr const char* scene = R"({
  "mesh": "bar.vtu",
  "materials": [{"lame_lambda": 1.4e4, "lame_mu": 3.6e3, "density": 1000, "element": "tetrahedron"}],
  "boundary": [
    {"fix": true, "where": {"plane": {"point": [0, 0, 0], "normal": [1, 0, 0], "within": 1e-6}}},
    {"displacement": [0.02, 0, 0], "where": {"plane": {"point": [0.2, 0, 0], "normal": [1, 0, 0], "within": 1e-6}}}
  ],
  "time": {"duration": 1}
})";
  io::write_file(folder / "bar.json", scene);
}

HugeRow solve_bar(const std::filesystem::path& folder, int ranks) {
  setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
  setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
  setenv("OMP_NUM_THREADS", "1", 1);
  const std::string out = (folder / "out").string();
  const int status = program::run_program(
      {"mpirun", "--oversubscribe", "-n", std::to_string(ranks), program::sibling("lobe-petsc").string(),
       (folder / "bar.json").string(), "-o", out, "--tolerance", "1e-8", "--method", "gamg"});
  if (status == 127) throw InputError("bench huge", "mpirun was not found: install openmpi-bin");
  if (status != 0) throw WrongResult("lobe-petsc ended with status " + std::to_string(status));
  HugeRow row;
  std::ifstream(folder / "out" / "report.json") >> row.report;
  row.tets = row.report["tetrahedra"];
  row.ranks = ranks;
  if (!(row.report["relative_residual"].get<double>() <= 1e-8))
    throw WrongResult("the residual is above 1e-8");
  std::filesystem::remove_all(folder / "out");
  return row;
}

constexpr const char* phases[] = {"read",     "partition",      "resolve",       "forces",
                                  "assembly", "preconditioner", "linear_solver", "write"};

void print(const HugeRow& r) {
  std::printf("%9d %5d %8.1f %6d %6d %8.2f %9.0f %9.3f", r.tets, r.ranks, r.report["wall_s"].get<double>(),
              r.report["newton_iterations"].get<int>(), r.report["linear_iterations"].get<int>(),
              r.peak() / 1e9, r.sum("peak_memory_bytes_of_rank") / r.tets, r.sum("halo_bytes_of_rank") / 1e6);
  for (const char* phase : phases) std::printf(" %7.1f", r.report["seconds"][phase].get<double>());
  std::printf("\n");
  std::fflush(stdout);
}

std::string csv(const std::vector<HugeRow>& rows) {
  std::ostringstream out;
  out << "tets,ranks,unknowns,wall_s,newton,linear,most_linear,peak_rank_bytes,bytes_per_tet,halo_bytes,"
         "residual";
  for (const char* phase : phases) out << ',' << phase << "_s";
  out << '\n' << std::setprecision(5);
  for (const HugeRow& r : rows) {
    out << r.tets << ',' << r.ranks << ',' << r.report["unknowns"].get<long>() << ','
        << r.report["wall_s"].get<double>() << ',' << r.report["newton_iterations"].get<int>() << ','
        << r.report["linear_iterations"].get<int>() << ',' << r.report["most_linear_iterations"].get<int>()
        << ',' << r.peak() << ',' << r.sum("peak_memory_bytes_of_rank") / r.tets << ','
        << r.sum("halo_bytes_of_rank") << ',' << r.report["relative_residual"].get<double>();
    for (const char* phase : phases) out << ',' << r.report["seconds"][phase].get<double>();
    out << '\n';
  }
  return out.str();
}

constexpr const char* huge_plot = R"(set terminal pngcairo size 900,560 font 'sans,11'
set output 'huge.png'
set datafile separator ','
set datafile missing NaN
set logscale xy
set grid
set key left top
set xlabel 'tetrahedra'
set ylabel 'seconds'
set y2label 'linear iterations in all'
set y2range [0:*]
set y2tics
plot for [r in '1 2'] 'huge.csv' using 1:(column(2) == r + 0 ? column(4) : NaN) with linespoints lw 2 pt 7 \
    title r.' ranks: wall time', \
  '' using 1:(column(2) == 2 ? column(6) : NaN) axes x1y2 with linespoints dt 2 pt 6 title '2 ranks: iterations'
)";

}  // namespace

void bench_huge(const Options& options) {
  std::vector<int> sizes = options.tets;
  if (sizes.empty())
    sizes = options.quick ? std::vector<int>{12000, 96000}
                          : std::vector<int>{31250, 62500, 125000, 250000, 500000, 1000000, 2000000};
  begin_results(options.output, "huge");
  const std::filesystem::path folder = options.output / "huge_scene";
  std::filesystem::create_directories(folder);
  std::printf("\n%9s %5s %8s %6s %6s %8s %9s %9s", "tets", "ranks", "wall s", "Newton", "linear", "GB/rank",
              "byte/tet", "halo MB");
  for (const char* phase : {"read", "part", "resolve", "forces", "tangent", "precond", "CG", "write"})
    std::printf(" %7s", phase);
  std::printf("\n");
  std::vector<HugeRow> rows;
  const int most = std::max(2, options.threads);
  for (int tets : sizes) {
    write_bar(folder, tets);
    for (int ranks = 1; ranks <= most; ranks *= 2) {
      rows.push_back(solve_bar(folder, ranks));
      print(rows.back());
    }
  }
  std::filesystem::remove_all(folder);
  io::write_file(options.output / "huge.csv", csv(rows));
  io::write_file(options.output / "huge.gp", huge_plot);
}

}  // namespace lobe::bench
