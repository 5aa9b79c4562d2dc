// lobe bench scalpel: what a blade costs, what is left of the time step, and how a slit beam bends.
#include <algorithm>
#include <cstdio>
#include <iomanip>
#include <random>
#include <sstream>

#include "benchmarks/kernel_cases.h"
#include "benchmarks/machine.h"
#include "benchmarks/scalpel.h"
#include "benchmarks/timing.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/mesh_io.h"

namespace lobe::bench {
namespace {

struct LimitRow {
  std::string mesh;
  double cut_step = 0;
  int planes = 0;
  double worst = 0, median = 0;             // of the limit, against the uncut body
  double most_added = 0, median_added = 0;  // mass, as a share of the body's
};

LimitRow measure_limit(const std::string& name, Setup setup, double cut_step, int planes) {
  setup.cut_step = cut_step;
  const double uncut = World<double>(setup).time_step_limit();
  double mass = 0;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    mass +=
        setup.materials[setup.material_of[std::size_t(t)]].density * signed_volume(tet_points(setup.mesh, t));
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<double> limits, added;
  for (int i = 0; i < planes; ++i) {
    setup.scalpels = {on_path(full_stroke(setup.mesh, {normal(random), normal(random), normal(random)}), 20)};
    World<double> world(setup);
    play_cut(world, 20);
    world.step_limit().measure_at_rest(world.body());
    limits.push_back(world.time_step_limit() / uncut);
    added.push_back(world.body().inertia.mass_of_floor() / mass);
  }
  std::sort(limits.begin(), limits.end());
  std::sort(added.begin(), added.end());
  return {name, cut_step, planes, limits.front(), median(limits), added.back(), median(added)};
}

void bench_precomputed(Setup condensed, const Options& options) {
  give(RegionModel::precomputed, condensed);
  const ShortBlades edits = measure_short_blades("liver_10k", condensed, options.quick ? 1 : 5);
  std::printf(
      "\npre-computed liver, exact edits: %.0f us per tetrahedron at %.1f in a frame, %.0f us at %.2f; "
      "a frame takes %.2f ms, the slowest %.2f ms\n",
      edits.tet_us, edits.tets, edits.single_us, edits.single_tets, edits.frame_ms, edits.slowest_ms);
  std::ostringstream precomputed;
  const double full_us = options.quick ? 0 : full_cut_us(condensed);  // 0: not measured
  if (!options.quick) std::printf("a full cut: %.0f us per tetrahedron\n", full_us);
  precomputed << "mesh,tets,frame_tets,tet_us,frame_ms,slowest_frame_ms,single_us,single_tets,full_us,error\n"
              << std::setprecision(4) << "liver_10k," << condensed.mesh.tet_count() << ',' << edits.tets
              << ',' << edits.tet_us << ',' << edits.frame_ms << ',' << edits.slowest_ms << ','
              << edits.single_us << ',' << edits.single_tets << ',' << full_us << ',' << edits.error << '\n';
  io::write_file(options.output / "scalpel_precomputed.csv", precomputed.str());
}

void bench_limits(const Setup& liver, const Options& options) {
  std::printf("\n%-11s %8s %6s %8s %8s %10s %10s\n", "mesh", "cut_step", "planes", "worst", "median",
              "most mass", "median");
  std::ostringstream limits;
  limits << "mesh,cut_step,planes,worst_limit,median_limit,most_added,median_added\n" << std::setprecision(4);
  const std::pair<std::string, Setup> livers[] = {
      {"liver_10k", liver},
      {"liver_2k", organ_setup(read_mesh(std::string(LOBE_DATA_DIR) + "/meshes/liver_2k.vtu").mesh)}};
  for (const auto& [name, setup] : livers)
    for (const double cut_step : {0.75, 0.0}) {
      const bool few = options.quick && setup.mesh.tet_count() > 5000;
      const LimitRow r = measure_limit(name, setup, cut_step, few ? 2 : 12);
      std::printf("%-11s %8.2f %6d %8.3f %8.3f %10.5f %10.5f\n", r.mesh.c_str(), r.cut_step, r.planes,
                  r.worst, r.median, r.most_added, r.median_added);
      limits << r.mesh << ',' << r.cut_step << ',' << r.planes << ',' << r.worst << ',' << r.median << ','
             << r.most_added << ',' << r.median_added << '\n';
    }
  io::write_file(options.output / "scalpel_limit.csv", limits.str());
}

void bench_beams(const Options& options) {
  std::printf("\n%8s %8s %8s %10s %10s %12s %10s\n", "cell mm", "tets", "grains", "whole m", "cut m",
              "conforming m", "rim, edges");
  std::vector<BeamRow> rows;
  std::ostringstream beams, orders;
  beams << "cell_mm,tets,grains,whole_m,cut_m,conforming_m,rim_edges\n" << std::setprecision(6);
  for (int n = 1; n <= (options.quick ? 1 : 5); ++n) {
    const BeamRow& r = rows.emplace_back(measure_beam(n));
    std::printf("%8.2f %8d %8d %10.6f %10.6f %12.6f %10.2f\n", r.cell_mm, r.tets, r.grains, r.whole, r.cut,
                r.conforming, r.rim);
    beams << r.cell_mm << ',' << r.tets << ',' << r.grains << ',' << r.whole << ',' << r.cut << ','
          << r.conforming << ',' << r.rim << '\n';
  }
  io::write_file(options.output / "scalpel_beam.csv", beams.str());
  if (rows.size() < 3) return;
  const SagOrders found = fit_orders(rows);
  std::printf(
      "order %.2f cut, %.2f conforming, of one limit %.5f m; rms %.2g m; %.2f to %.2f without one mesh\n",
      found.cut, found.conforming, found.limit, found.rms, found.least, found.most);
  orders << "meshes,limit_m,cut_order,conforming_order,rms_m,least_order,most_order\n"
         << std::setprecision(4) << rows.size() << ',' << found.limit << ',' << found.cut << ','
         << found.conforming << ',' << found.rms << ',' << found.least << ',' << found.most << '\n';
  io::write_file(options.output / "scalpel_beam_order.csv", orders.str());
}

}  // namespace

void bench_scalpel(const Options& options) {
  begin_results(options.output, "scalpel");
  print_head_of_costs();
  std::vector<CostRow> costs;
  const auto cost = [&](const std::string& name, Setup setup, RegionModel model, const char* region) {
    give(model, setup);
    print(costs.emplace_back(measure_costs(name, region, setup)));
  };
  const Setup liver = liver_setup();
  std::vector<std::pair<std::string, Setup>> bodies{{"liver_10k", liver}};
  if (!options.quick) bodies.emplace_back("cube_48k", cube_setup(48000));
  for (const std::filesystem::path& file : options.meshes)
    bodies.emplace_back(file.stem().string(), organ_setup(read_mesh(file).mesh));
  for (const auto& [name, setup] : bodies) {
    cost(name, setup, RegionModel::nonlinear, "nonlinear");
    cost(name, setup, RegionModel::tensor_mass, "tensor-mass");
  }
  io::write_file(options.output / "scalpel.csv", csv(costs));
  bench_precomputed(liver, options);
  bench_limits(liver, options);
  bench_beams(options);
}

}  // namespace lobe::bench
