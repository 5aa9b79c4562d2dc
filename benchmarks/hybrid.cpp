// lobe bench hybrid: the step of a body of which a part is linear, against the step of all of it non-linear,
// beside the error in equilibrium.
#include <algorithm>
#include <cstdio>
#include <iomanip>
#include <memory>
#include <sstream>

#include "benchmarks/accuracy_cases.h"
#include "benchmarks/accuracy_models.h"
#include "benchmarks/frequencies.h"
#include "benchmarks/gestures.h"
#include "benchmarks/machine.h"
#include "benchmarks/reduced_setup.h"
#include "benchmarks/timing.h"
#include "lobe/condense/interface_size.h"
#include "lobe/condense/narrow_interface.h"
#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/scene/resolve.h"
#include "lobe/sim/world.h"
#include "lobe/solve/static_solver.h"

namespace lobe::bench {
namespace {

struct HybridRow {
  std::string organ;
  Index tets = 0;
  double linear_fraction = 0;  // of the volume
  RegionModel representation = RegionModel::precomputed;
  double step_us = 0, svk_step_us = 0, frame_step_us = 0;  // the last 0 where its interface is too large
  double error_l2 = 0, error_free = 0, error_max = 0;      // relative, in equilibrium, to all non-linear
  double error_transient = 0;                              // of the condensed in motion, to tensor-mass
  InterfaceSize interface = {};
  bool pays = false;    // whether the condensed step is the shorter one
  double set_up_s = 0;  // building the world, condensation included
};

// The vertices that move least in a linear trial are those that a linear model suits.
std::vector<double> moved(const TetMesh& mesh, const Mat3X<double>& trial) {
  std::vector<double> moved;
  for (Index t = 0; t < mesh.tet_count(); ++t)
    moved.push_back(trial(Eigen::all, mesh.tets.col(t)).rowwise().mean().norm());
  return moved;
}

// Linear is what moves least, up to about this fraction of the volume: a little less or more, as it takes to
// end where few vertices are shared. Returns the fraction that was reached.
double make_linear_to_a_neck(Setup& setup, const std::vector<double>& score, double fraction) {
  constexpr double less = 0.02, more = 0.04;
  Setup all = setup, least = setup;
  make_linear(least, score, fraction - less);
  make_linear(all, score, fraction + more);
  std::vector<Side> sides;
  for (std::size_t t = 0; t < score.size(); ++t)
    sides.push_back(least.region_of[t] != RegionModel::nonlinear ? Side::linear
                    : all.region_of[t] == RegionModel::nonlinear ? Side::nonlinear
                                                                 : Side::either);
  sides = with_narrow_interface(setup.mesh, std::move(sides));
  setup = reference_setup(std::move(setup));
  double linear = 0;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    if (sides[std::size_t(t)] != Side::linear) continue;
    setup.region_of[std::size_t(t)] = RegionModel::tensor_mass;
    linear += signed_volume(tet_points(setup.mesh, t));
  }
  return linear / total_volume(setup.mesh);
}

Mat3X<double> equilibrium(const Setup& setup) {
  const StaticResult solution = solve_static(setup);
  if (!solution.converged) throw InputError("hybrid", solution.reason);
  return solution.u;
}

Setup with_linear(Setup setup, RegionModel model) {
  for (RegionModel& region : setup.region_of)
    if (region != RegionModel::nonlinear) region = model;
  return setup;
}

void find_errors(const Setup& hybrid, const Mat3X<double>& exact, HybridRow& row) {
  const Mat3X<double> difference = equilibrium(hybrid) - exact;
  std::vector<char> is_free(std::size_t(exact.cols()), 0);
  for (Index t = 0; t < hybrid.mesh.tet_count(); ++t)
    for (Index v : hybrid.mesh.tets.col(t))
      if (hybrid.region_of[std::size_t(t)] == RegionModel::nonlinear) is_free[std::size_t(v)] = 1;
  double in_free = 0, all_free = 0;
  for (Eigen::Index v = 0; v < exact.cols(); ++v) {
    if (!is_free[std::size_t(v)]) continue;
    in_free += difference.col(v).squaredNorm();
    all_free += exact.col(v).squaredNorm();
  }
  row.error_l2 = difference.norm() / exact.norm();
  row.error_free = std::sqrt(in_free / all_free);
  row.error_max = difference.colwise().norm().maxCoeff() / exact.colwise().norm().maxCoeff();
}

// The interior of a condensed region has no inertia. How far the body is from that of the tensor-mass hybrid
// while the scene's gesture is played: relative L2 over all vertices and frames.
double transient_error(Setup gesture, const Setup& hybrid, const Time& time) {
  gesture.region_of = hybrid.region_of;
  World<float> condensed(with_linear(gesture, RegionModel::precomputed)),
      exact(with_linear(gesture, RegionModel::tensor_mass));
  double difference = 0, all = 0;
  for (double t = 0; t < time.duration; t += time.frame) {
    if (!condensed.advance(time.frame).ok || !exact.advance(time.frame).ok)
      throw InputError("hybrid", "the gesture could not be played");
    const Mat3X<double> u = exact.state().u.cast<double>();
    difference += (condensed.state().u.cast<double>() - u).squaredNorm();
    all += u.squaredNorm();
  }
  return std::sqrt(difference / all);
}

// A world in a state near rest, in which it may step on and on.
std::unique_ptr<World<float>> moving_world(const Setup& setup, double& seconds) {
  const Stopwatch watch(true);
  auto world = std::make_unique<World<float>>(setup);
  seconds = watch.seconds();
  State<float> state = world->state();
  state.u.setRandom();
  state.u *= 1e-5F;
  for (const HeldVertices::Held& item : world->held().all()) state.u.col(item.vertex).setZero();
  world->set_state(state);
  return world;
}

// The condensed forces must be those of the tensor-mass hybrid in the same equilibrium of the interior.
void check(World<float>& condensed, World<float>& tensor_mass, const HybridRow& row) {
  tensor_mass.set_state(condensed.state());
  const Mat3X<float> expected = tensor_mass.forces(), found = condensed.forces();
  double difference = 0;
  for (Eigen::Index v = 0; v < found.cols(); ++v)
    if (condensed.body().inertia.mass()[std::size_t(v)] > 0 && !condensed.held().holds(Index(v)))
      difference = std::max(difference, double((found - expected).col(v).norm()));
  const double relative = difference / double(expected.colwise().norm().maxCoeff());
  if (relative <= 1e-4) return;
  std::ostringstream message;
  message << row.organ << ", " << row.tets << " tetrahedra: the condensed forces deviate by " << relative
          << " from those of tensor-mass, allowed is 1e-4";
  throw WrongResult(message.str());
}

void time_rows(const Setup& hybrid, std::vector<HybridRow>& rows, const Sampling& sampling) {
  double seconds = 0;
  std::vector<std::unique_ptr<World<float>>> worlds;
  for (HybridRow& row : rows)
    worlds.push_back(moving_world(with_linear(hybrid, row.representation), row.set_up_s));
  check(*worlds[0], *worlds[1], rows[0]);
  worlds.push_back(moving_world(with_linear(reference_setup(hybrid), RegionModel::nonlinear), seconds));
  Setup turning = with_linear(hybrid, RegionModel::precomputed);
  turning.precomputed_frame = RegionFrame::corotated;
  try {
    worlds.push_back(moving_world(turning, seconds));
  } catch (const InputError&) {  // what is held belongs to its interface, and may be too much
  }
  std::vector<Timed> functions;
  for (const auto& world : worlds) {
    const double dt = 0.5 * world->time_step_limit();
    functions.push_back({[&world, dt] { world->step(dt); }});
  }
  const std::vector<std::vector<double>> samples = sample_in_turn(functions, sampling);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].step_us = 1e6 * samples[i].front();
    rows[i].svk_step_us = 1e6 * samples[rows.size()].front();
    if (samples.size() > rows.size() + 1) rows[i].frame_step_us = 1e6 * samples.back().front();
    rows[i].pays = samples[0].front() < samples[1].front();
  }
}

const char* name_of(const HybridRow& row) {
  return row.representation == RegionModel::precomputed ? "precomputed" : "tensor-mass";
}

void print(const HybridRow& r) {
  std::printf("%-8s %7d %7.2f %-12s %6d %9.2f %9.2f %8.2f %9.2f %10.2e %10.2e %10.2e %10.2e %8.2f\n",
              r.organ.c_str(), r.tets, r.linear_fraction, name_of(r), r.interface.vertices, r.step_us,
              r.svk_step_us, r.svk_step_us / r.step_us, r.frame_step_us, r.error_l2, r.error_free,
              r.error_max, r.error_transient, r.set_up_s);
  std::fflush(stdout);
}

std::string csv(const std::vector<HybridRow>& rows) {
  std::ostringstream out;
  out << "organ,tets,linear_fraction,representation,step_us,svk_step_us,speedup,error_l2,error_free,error_"
         "max,"
         "interface_vertices,pays,set_up_s,error_transient,frame_step_us\n"
      << std::setprecision(4);
  for (const HybridRow& r : rows)
    out << r.organ << ',' << r.tets << ',' << r.linear_fraction << ',' << name_of(r) << ',' << r.step_us
        << ',' << r.svk_step_us << ',' << r.svk_step_us / r.step_us << ',' << r.error_l2 << ','
        << r.error_free << ',' << r.error_max << ',' << r.interface.vertices << ',' << r.pays << ','
        << r.set_up_s << ',' << r.error_transient << ',' << r.frame_step_us << '\n';
  return out.str();
}

constexpr const char* hybrid_plot = R"(set terminal pngcairo size 900,560 font 'sans,11'
set output 'hybrid.png'
set datafile separator ','
set datafile missing NaN
set yrange [0:*]
set grid
set key outside right
set xlabel 'speed-up of a step over all non-linear'
set ylabel 'error in equilibrium, relative L2'
series(r) = strcol(4) eq r ? column(7) : NaN
plot 'hybrid.csv' using (series('precomputed')):8:(0.5 + 0.6 * log10($2 / 1000)) with points pt 7 ps variable lc '#c02020' \
    title 'pre-computed', \
  '' using (series('tensor-mass')):8:(0.5 + 0.6 * log10($2 / 1000)) with points pt 6 ps variable lc '#0060ad' \
    title 'tensor-mass', \
  '' using (series('precomputed')):8:(sprintf('%dk', $2 / 1000 + 0.5)) with labels font ',8' offset 2,0.6 notitle
)";

}  // namespace

void bench_hybrid(const Options& options) {
  const Sampling sampling = options.quick ? Sampling{5, 0.01} : Sampling{15, 0.02};
  begin_results(options.output, "hybrid");
  std::printf("\n%-8s %7s %7s %-12s %6s %9s %9s %8s %9s %10s %10s %10s %10s %8s\n", "organ", "tets", "linear",
              "represented", "shared", "step us", "svk us", "speed-up", "frame us", "error l2", "error free",
              "error max", "transient", "set up s");
  std::vector<HybridRow> all;
  for (const Case& organ : make_organs(options)) {
    if (organ.scene.auto_regions || options.reduced) continue;  // gestures are played below
    for (const TetMesh& mesh : organ.meshes) {
      const Setup gesture = reference_setup(resolve(organ.scene, mesh, {false}).setup),
                  setup = at_the_end(gesture);
      const std::vector<double> score = moved(setup.mesh, linear_trial(setup));
      const Mat3X<double> exact = equilibrium(setup);
      for (double fraction : {0.6, 0.8, 0.9}) {
        Setup hybrid = setup;
        HybridRow row{organ.name, mesh.tet_count()};
        row.linear_fraction = make_linear_to_a_neck(hybrid, score, fraction);
        find_errors(hybrid, exact, row);
        row.interface = interface_size(Elements(with_linear(hybrid, RegionModel::precomputed)));
        std::vector<HybridRow> rows(2, row);
        rows[1].representation = RegionModel::tensor_mass;
        rows[0].error_transient = transient_error(gesture, hybrid, organ.scene.time);
        time_rows(hybrid, rows, sampling);
        for (const HybridRow& r : rows) print(r);
        all.insert(all.end(), rows.begin(), rows.end());
      }
    }
  }
  if (!all.empty()) io::write_file(options.output / "hybrid.csv", csv(all));
  if (options.reduced) {
    bench_reduced_setup(options);
    bench_gestures(options);
    return bench_frequencies(options);
  }
  io::write_file(options.output / "hybrid.gp", (all.empty() ? "" : hybrid_plot) + bench_gestures(options));
}

}  // namespace lobe::bench
