// lobe bench realtime: whole gestures with every tetrahedron non-linear, cuts included, against the clock;
// and what the time step of each mesh is worth.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iomanip>
#include <limits>
#include <numeric>
#include <sstream>

#include "benchmarks/accuracy_cases.h"
#include "benchmarks/accuracy_models.h"
#include "benchmarks/accuracy_play.h"
#include "benchmarks/machine.h"
#include "benchmarks/resting.h"
#include "lobe/file/atomic_file.h"
#include "lobe/mesh/quality.h"
#include "lobe/scene/material_constants.h"
#include "lobe/scene/resolve.h"
#include "lobe/sim/world.h"

namespace lobe::bench {
namespace {

struct RealtimeRow {
  std::string organ;
  Index tets = 0;
  int threads = 1;
  double wave_step = 0;    // the usual guess, height of the flattest tetrahedron over c_p [s]
  double limit = 0;        // 2/ω_max at rest [s]
  double local_gain = 1;   // no local time stepping does fewer force evaluations than by this factor
  Played played = {};      // the run in the middle
  double undisturbed = 0;  // seconds per simulated second, of the fastest of each frame in all runs
};

double wave_step(const Setup& setup) {
  double step = std::numeric_limits<double>::infinity();
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const Elastic& e = setup.materials[setup.material_of[std::size_t(t)]];
    const auto heights = altitudes(tet_points(setup.mesh, t));
    step = std::min(
        step, *std::min_element(heights.begin(), heights.end()) / wave_speed(e.lambda, e.mu, e.density));
  }
  return step;
}

// If each tetrahedron was evaluated as seldom as the stiffest of its own vertices allows at rest, in steps of
// the shortest one times a power of two. Neighbours of other steps, which cost and need shorter ones, are
// left out.
double local_gain(World<float>& world) {
  const Elements& elements = world.elements();
  const Index vertices = elements.topology.vertex_count(), tets = elements.topology.tet_count();
  std::vector<double> inverse_mass, squares;
  for (Index v = 0; v < vertices; ++v)
    inverse_mass.push_back(world.held().fixes(v) ? 0 : 1 / world.body().inertia.mass()[std::size_t(v)]);
  VertexFrequencies<double> frequencies;
  const auto weight = [&](Index v) { return inverse_mass[std::size_t(v)]; };
  frequencies.find(vertices, weight, [&](DiagonalStiffness& K) {
    for (Index t = 0; t < tets; ++t) {
      const CornerStiffness stiffness = corner_stiffness(elements, t, Mat34<double>::Zero());
      for (int c = 0; c < 4; ++c) K.col(elements.topology.tets()(c, t)) += stiffness.col(c);
    }
  });
  for (Index v = 0; v < vertices; ++v) squares.push_back(frequencies.exact_square(v, weight(v)));
  const double highest = *std::max_element(squares.begin(), squares.end());
  constexpr int longest = 6;  // 64 shortest steps
  double evaluations = 0;
  for (Index t = 0; t < tets; ++t) {
    double largest_square = 0;
    for (Index v : elements.topology.corners(t))
      largest_square = std::max(largest_square, squares[std::size_t(v)]);
    const double ratio =
        std::sqrt(highest / largest_square);  // of the steps; infinite where all corners are held
    evaluations += std::exp2(-std::min(double(longest), std::floor(std::log2(ratio))));
  }
  return tets / evaluations;
}

RealtimeRow row_of_mesh(const std::string& organ, const Setup& setup) {
  RealtimeRow row{organ, setup.mesh.tet_count()};
  World<float> world(setup);
  row.wave_step = wave_step(setup);
  row.limit = world.time_step_limit();
  row.local_gain = local_gain(world);
  return row;
}

// Every run does the same work in each frame, to the bit: the fastest of a frame is what it takes while
// nobody else asks for the processor.
void play_some_times(const Setup& setup, const Schedule& schedule, const Way& way, int times,
                     RealtimeRow& row) {
  std::vector<Played> runs;
  for (int i = 0; i < times; ++i) runs.push_back(play(setup, schedule, way));
  std::vector<double> fastest = runs[0].frames;
  for (const Played& run : runs)
    for (std::size_t i = 0; i < fastest.size(); ++i) fastest[i] = std::min(fastest[i], run.frames[i]);
  row.undisturbed = std::accumulate(fastest.begin(), fastest.end(), 0.0) / schedule.duration();
  std::sort(runs.begin(), runs.end(),
            [](const Played& a, const Played& b) { return a.wall_per_s < b.wall_per_s; });
  row.played = runs[runs.size() / 2];
}

void print(const RealtimeRow& r) {
  std::printf("%-16s %8d %7d %8.0f %8.0f %6.2f %8.2f %8.0f %10.2f %11.2f  %s\n", r.organ.c_str(), r.tets,
              r.threads, 1e6 * r.wave_step, 1e6 * r.limit, r.limit / r.wave_step, r.local_gain,
              1e6 * r.played.dt, 1 / r.played.wall_per_s, 1 / r.undisturbed, r.played.status.c_str());
  std::fflush(stdout);
}

std::string csv(const std::vector<RealtimeRow>& rows) {
  std::ostringstream out;
  out << "organ,tets,threads,wave_step_us,limit_us,limit_gain,local_step_gain,dt_us,"
         "wall_s_per_s,real_time_factor,undisturbed_factor,status\n"
      << std::setprecision(4);
  for (const RealtimeRow& r : rows)
    out << r.organ << ',' << r.tets << ',' << r.threads << ',' << 1e6 * r.wave_step << ',' << 1e6 * r.limit
        << ',' << r.limit / r.wave_step << ',' << r.local_gain << ',' << 1e6 * r.played.dt << ','
        << r.played.wall_per_s << ',' << 1 / r.played.wall_per_s << ',' << 1 / r.undisturbed << ','
        << r.played.status << '\n';
  return out.str();
}

void print_resting(const RealtimeRow& row, const Resting& resting) {
  for (int part = 0; part < 2; ++part) {
    const Resting::Part& p = resting.parts[std::size_t(part)];
    std::printf("%-16s %8d %-8s %10.3f %10.3f %8.1f %8.3f %10.1e\n", row.organ.c_str(), row.tets,
                resting_parts[part], p.awake, p.asleep, p.awake / p.asleep, p.skipped, resting.error);
  }
  std::fflush(stdout);
}

std::string resting_csv(const std::vector<std::pair<RealtimeRow, Resting>>& all) {
  std::ostringstream out;
  out << "organ,tets,part,tolerance_m,awake_s_per_s,asleep_s_per_s,gain,share_asleep,error\n"
      << std::setprecision(4);
  for (const auto& [row, resting] : all)
    for (std::size_t part = 0; part < 2; ++part) {
      const Resting::Part& p = resting.parts[part];
      out << row.organ << ',' << row.tets << ',' << resting_parts[part] << ',' << resting.tolerance << ','
          << p.awake << ',' << p.asleep << ',' << p.awake / p.asleep << ',' << p.skipped << ','
          << resting.error << '\n';
    }
  return out.str();
}

// The shipped resection of a liver, also on a finer mesh, or the user's scenes.
std::vector<Case> organs(Options options) {
  if (!options.scenes.empty()) return make_organs(options);
  options.scenes = {std::filesystem::path(LOBE_DATA_DIR) / "scenes/liver_resection.json"};
  std::vector<Case> organs = make_organs(options);
  std::vector<TetMesh>& meshes = organs[0].meshes;
  if (!options.quick && options.meshes.empty()) meshes.push_back(refine(meshes[0]).mesh);
  return organs;
}

}  // namespace

void bench_realtime(const Options& options) {
  std::vector<int> threads{1};
  if (options.threads > 1) threads.push_back(options.threads);
  begin_results(options.output, "realtime");
  std::printf("\n%-16s %8s %7s %8s %8s %6s %8s %8s %10s %11s  %s\n", "organ", "tets", "threads", "h/c us",
              "limit us", "gain", "local", "step us", "real time", "undisturbed", "status");
  std::vector<RealtimeRow> rows;
  std::vector<std::pair<RealtimeRow, Resting>> resting;
  for (const Case& organ : organs(options))
    for (const TetMesh& mesh : organ.meshes) {
      const Setup setup = reference_setup(resolve(organ.scene, mesh, {false}).setup);
      Time time = organ.scene.time;
      time.duration = std::min(time.duration, options.quick ? 0.2 : 2.0);
      RealtimeRow row = row_of_mesh(organ.name, setup);
      for (int n : threads) {
        row.threads = n;
        play_some_times(setup, schedule_of(time, 1),
                        {Precision::single_precision, organ.scene.time.safety, n}, options.quick ? 1 : 5,
                        row);
        print(rows.emplace_back(row));
      }
      if (!setup.grasps.empty())
        resting.emplace_back(row, play_with_rests(setup, organ.scene.time.frame, options.quick ? 0.5 : 2));
    }
  std::printf("\n%-16s %8s %-8s %10s %10s %8s %8s %10s\n", "organ", "tets", "tool", "awake s/s", "asleep s/s",
              "gain", "asleep", "error");
  for (const auto& [row, result] : resting) print_resting(row, result);
  io::write_file(options.output / "resting.csv", resting_csv(resting));
  io::write_file(options.output / "realtime.csv", csv(rows));
}

}  // namespace lobe::bench
