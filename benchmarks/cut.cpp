// lobe bench cut: microseconds per removed tetrahedron, everything included, while a channel is cut through a
// cube.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <iomanip>
#include <numeric>
#include <sstream>

#include "benchmarks/benchmarks.h"
#include "benchmarks/kernel_cases.h"
#include "benchmarks/machine.h"
#include "benchmarks/timing.h"
#include "lobe/file/atomic_file.h"
#include "lobe/sim/rebuild.h"

namespace lobe::bench {
namespace {

struct CutRow {
  const char* region;
  Index tets = 0, batch = 0, removed = 0;
  double us_per_tet = 0;
  double rebuild_us = 0;  // of a world from the cut mesh
  double error = 0;       // largest difference to it
};

// The tetrahedra nearest to a line through the middle, in order along it: what an instrument would take.
std::vector<Index> channel(const TetMesh& mesh, Index count) {
  std::vector<Index> order(std::size_t(mesh.tet_count()));
  std::iota(order.begin(), order.end(), 0);
  const Vec3d middle = mesh.points.rowwise().mean();
  std::vector<double> distance, along;
  for (Index t : order) {
    const Vec3d from_middle = barycentre(mesh, t) - middle;
    distance.push_back(std::hypot(from_middle.y(), from_middle.z()));
    along.push_back(from_middle.x());
  }
  std::nth_element(order.begin(), order.begin() + count - 1, order.end(),
                   [&](Index a, Index b) { return distance[a] < distance[b]; });
  order.resize(std::size_t(count));
  std::sort(order.begin(), order.end(), [&](Index a, Index b) { return along[a] < along[b]; });
  return order;
}

double seconds_to_rebuild(World<float>& world) {
  CompactMesh compacted;
  const Setup setup = world.current_setup(compacted);
  const Stopwatch watch(true);
  World<float> fresh(setup);
  return watch.seconds();
}

CutRow measure(const char* name, const Setup& setup, Index batch) {
  CutRow row{name, setup.mesh.tet_count(), batch};
  World<float> world(setup);
  double limit = 0;  // [s]
  const std::vector<Index> order = channel(setup.mesh, std::clamp<Index>(row.tets / 20, 1, 2000));
  std::vector<Index> now;
  const Stopwatch watch(true);
  for (auto next = order.begin(); next != order.end();) {
    const auto end = next + std::min<std::ptrdiff_t>(batch, order.end() - next);
    now.assign(next, end);
    row.removed += world.remove_tets(now);
    limit = world.time_step_limit();
    next = end;
  }
  row.us_per_tet = 1e6 * watch.seconds() / row.removed;
  world.step_limit().highest_vertex(world.body());
  row.error = std::abs(limit / world.time_step_limit() - 1);
  row.rebuild_us = 1e6 * seconds_to_rebuild(world);
  State<float> state = world.state();
  state.u.setRandom();
  state.u *= 1e-4F;
  world.set_state(state);
  row.error = std::max(row.error, compare_with_rebuilt(world).largest());
  if (!(row.error <= 1e-5)) {
    std::ostringstream message;
    message << row.region << ", " << row.tets << " tetrahedra: the cut world deviates by " << row.error
            << " from one built afresh, allowed is 1e-05";
    throw WrongResult(message.str());
  }
  return row;
}

// The shortest of some.
CutRow measure(const char* name, const Setup& setup, Index batch, int times) {
  CutRow best = measure(name, setup, batch);
  for (int i = 1; i < times; ++i)
    if (const CutRow row = measure(name, setup, batch); row.us_per_tet < best.us_per_tet) best = row;
  return best;
}

void print(const CutRow& r) {
  std::printf("%-17s %8d %6d %8d %11.2f %12.0f %10.1e\n", r.region, r.tets, r.batch, r.removed, r.us_per_tet,
              r.rebuild_us, r.error);
  std::fflush(stdout);
}

std::string csv(const std::vector<CutRow>& rows) {
  std::ostringstream out;
  out << "region,tets,batch,us_per_tet,rebuild_us,error,removed\n" << std::setprecision(5);
  for (const CutRow& r : rows)
    out << r.region << ',' << r.tets << ',' << r.batch << ',' << r.us_per_tet << ',' << r.rebuild_us << ','
        << r.error << ',' << r.removed << '\n';
  return out.str();
}

// What is dear to cut is cut in batches, as by an instrument's sweep of a frame, and on small meshes: beyond
// this size the cross-section of a cube is no interface to condense to.
constexpr int most_in_batches = 20000;

constexpr const char* cut_plot = R"(set terminal pngcairo size 900,560 font 'sans,11'
set output 'cut.png'
set datafile separator ','
set datafile missing NaN
set logscale xy
set grid
set key outside right
set xlabel 'tetrahedra'
set ylabel 'µs per removed tetrahedron'
series(r, b) = (strcol(1) eq r && column(3) == b) ? column(4) : NaN
plot for [b in '1 10 100'] 'cut.csv' using 2:(series('nonlinear', b + 0)) with linespoints lw 2 pt 7 \
    title 'non-linear, batches of '.b, \
  for [b in '1 10 100'] '' using 2:(series('tensor-mass', b + 0)) with linespoints lw 2 pt 6 dt 2 \
    title 'tensor-mass, batches of '.b, \
  for [b in '10 100'] '' using 2:(series('precomputed', b + 0)) with linespoints lw 2 pt 5 dt 3 \
    title 'pre-computed, batches of '.b
)";

}  // namespace

void bench_cut(const Options& options) {
  std::vector<int> sizes = options.tets;
  if (sizes.empty()) sizes = {10000, 48000, 200000};
  if (options.tets.empty() && !options.quick) sizes.push_back(1000000);

  begin_results(options.output, "cut");
  std::printf("\n%-17s %8s %6s %8s %11s %12s %10s\n", "region", "tets", "batch", "removed", "us/tet",
              "rebuild us", "error");
  std::vector<CutRow> rows;
  const auto cut = [&](const char* name, Setup& setup, RegionModel model,
                       std::initializer_list<Index> batches) {
    give(model, setup);
    for (Index batch : batches) print(rows.emplace_back(measure(name, setup, batch, options.quick ? 1 : 3)));
  };
  for (int size : sizes) {
    Setup setup = cube_setup(size);
    cut("nonlinear", setup, RegionModel::nonlinear, {1, 10, 100});
    cut("tensor-mass", setup, RegionModel::tensor_mass, {1, 10, 100});
    if (size > most_in_batches) continue;
    cut("precomputed", setup, RegionModel::precomputed, {10, 100});
  }
  Setup liver = liver_setup();
  cut("precomputed liver", liver, RegionModel::precomputed, {10, 100});
  io::write_file(options.output / "cut.csv", csv(rows));
  io::write_file(options.output / "cut.gp", cut_plot);
}

}  // namespace lobe::bench
