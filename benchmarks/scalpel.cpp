// lobe bench scalpel: what a blade costs per tetrahedron that it cuts and per frame, what a step costs
// afterwards, what is left of the time step, and how a slit beam bends.
#include <algorithm>
#include <array>
#include <cstdio>
#include <iomanip>
#include <limits>
#include <memory>
#include <random>
#include <set>
#include <sstream>

#include "benchmarks/benchmarks.h"
#include "benchmarks/kernel_cases.h"
#include "benchmarks/machine.h"
#include "benchmarks/timing.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/generators.h"
#include "lobe/sim/rebuild.h"
#include "lobe/solve/static_solver.h"

namespace lobe::bench {
namespace {

constexpr double moment = 1e-4;  // of a frame: what is timed is the cut, not the steps [s]

struct FullStroke {
  BladePose from, to;
};

// All the way through a mesh, along a plane that is aslant to everything.
FullStroke full_stroke(const TetMesh& mesh, Vec3d normal = {1, 0.21, 0.13}) {
  const Vec3d low = mesh.points.rowwise().minCoeff(), high = mesh.points.rowwise().maxCoeff();
  const Vec3d middle = (low + high) / 2;
  const double reach = 0.6 * (high - low).norm();
  normal.normalize();
  const Vec3d along = normal.unitOrthogonal(), edge = normal.cross(along);
  const auto at = [&](double x) {
    return BladePose{middle + x * along - reach * edge, middle + x * along + reach * edge};
  };
  return {at(-reach), at(reach)};
}

// What the stroke parts is held on both of its sides: a half that nothing holds would fall, and become
// non-linear for that.
Setup held_on_both_sides(Setup setup, const FullStroke& stroke) {
  constexpr double share = 0.05;  // of the body's width
  const Vec3d normal =
      (stroke.from.heel - stroke.from.tip).cross(stroke.to.tip - stroke.from.tip).normalized();
  const Eigen::RowVectorXd along = normal.transpose() * setup.mesh.points;
  const double low = along.minCoeff(), high = along.maxCoeff(), deep = share * (high - low);
  setup.prescribed.clear();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (along[v] < low + deep || along[v] > high - deep) setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

ScalpelSetup on_path(const FullStroke& stroke, int frames) {
  return {"blade",
          0.1,
          {{moment / 2, stroke.from.tip}, {moment / 2 + frames * moment, stroke.to.tip}},
          {stroke.from.heel, stroke.to.heel}};
}

struct CutFrames {
  double seconds = 0, slowest = 0;  // of processor time, of all frames and the slowest [s]
  int frames = 0;                   // in which something was cut
};

template <class Real>
CutFrames play_cut(World<Real>& world, int frames) {
  CutFrames played;
  for (int i = 0; i <= frames; ++i) {
    const Report report = world.advance(moment);
    if (!report.ok) throw WrongResult("a cut body could not be advanced");
    if (report.cut_area == 0) continue;
    const double seconds = report.seconds[std::size_t(Phase::cutting)];
    played.seconds += seconds;
    played.slowest = std::max(played.slowest, seconds);
    ++played.frames;
  }
  return played;
}

constexpr int repeats = 5;  // of each cut; neighbours on the machine disturb some of them

template <class Measure>
double median_of(Measure&& measure) {
  std::vector<double> values;
  for (int i = 0; i < repeats; ++i) values.push_back(measure());
  std::sort(values.begin(), values.end());
  return median(values);
}

// Plays the cut in several worlds, which do the same to the bit.
struct PlayedCut {
  PlayedCut(const Setup& setup, int count) {
    std::vector<double> slowest_of;
    seconds = median_of([&] {
      world = std::make_unique<World<float>>(setup);
      const CutFrames played = play_cut(*world, count);
      frames = played.frames;
      slowest_of.push_back(played.slowest);
      return played.seconds;
    });
    std::sort(slowest_of.begin(), slowest_of.end());
    slowest = median(slowest_of);
  }
  std::unique_ptr<World<float>> world;  // the last one
  double seconds = 0, slowest = 0;      // medians [s]
  int frames = 0;
};

// Tetrahedra of the start that there are several grains of.
Index cut_tets(const Grains& grains, const Topology& topology) {
  std::set<Index> once, cut;
  for (Index g = 0; g < grains.count(); ++g)
    if (const Index parent = topology.parent(grains[g].element); !once.insert(parent).second)
      cut.insert(parent);
  return static_cast<Index>(cut.size());
}

// ---- Costs

struct CostRow {
  std::string mesh;
  const char* region;
  Index tets = 0, cut = 0, copies = 0;
  double geometry_us = 0, all_us = 0;   // per cut tetrahedron, of a stroke of 60 frames
  double sweep_us = 0, batch_us = 0;    // the same of a stroke that is one sweep; that is one frame
  double frame_ms = 0, slowest_ms = 0;  // of a blade of 40 mm at 50 mm/s, 30 frames a second
  double step_ratio = 0;                // after the cut, against before
  double fresh_ratio = 0;               // the same of a world that was built from the cut body
  double loose_ratio = 0;  // after the cut where nothing holds one half, which is non-linear then
  double bytes = 0;        // of grains per cut tetrahedron
  double error = 0;        // largest difference to a world built afresh
};

// Without a world: marks, bisections, opened faces.
double geometry_seconds(const Setup& setup, const FullStroke& stroke, int frames) {
  Elements elements(setup);
  Blades blades(elements);
  TetGroups groups;
  const Mat3X<float> u = Mat3X<float>::Zero(3, 4 * setup.mesh.vertex_count());
  const Blades::BodyNow body{[&](Index t) {
                               const Vec3d start = elements.points.col(elements.topology.corners(t)[0]);
                               return Placement{start, start, Mat3<double>::Identity()};
                             },
                             [&](const SweptVolume& volume) {
                               return groups.meeting(elements.topology, elements.points.padded(), u, volume);
                             },
                             [&](Index t) { return elements.corner_points(t); }};
  const auto pose = [&](double share) {
    return BladePose{stroke.from.tip + share * (stroke.to.tip - stroke.from.tip),
                     stroke.from.heel + share * (stroke.to.heel - stroke.from.heel)};
  };
  body.tets_in({});  // forms the groups, as a World does ahead of the first cut
  double seconds = 0;
  for (int i = 0; i < frames; ++i) {
    const Stopwatch watch(true);
    const auto incised =
        blades.cut({1, 0, 0.1, pose(double(i) / frames), pose(double(i + 1) / frames)}, body);
    seconds += watch.seconds();
    if (!incised || incised->opened.empty()) continue;
    const MeshEdit edit = elements.topology.divide(blades.grains.divide(elements.topology, incised->opened));
    elements.follow(edit);
    for (const TetCopy& tet_copy : edit.copies) groups.add_copy(tet_copy.tet, tet_copy.copy);
  }
  return seconds;
}

void find_ratios_of_steps(const Setup& setup, World<float>& cut, World<float>& loose, CostRow& row) {
  CompactMesh compacted;
  World<float> whole(setup), fresh(cut.current_setup(compacted));
  double dt = std::numeric_limits<double>::infinity();
  std::vector<Timed> steps;
  for (World<float>* world : {&whole, &cut, &fresh, &loose}) {
    dt = std::min(dt, 0.5 * world->time_step_limit());
    steps.push_back({[world, &dt] { world->step(dt); }});
  }
  const auto samples = sample_in_turn(steps, {});
  const double before = median(samples[0]);
  row.step_ratio = median(samples[1]) / before;
  row.fresh_ratio = median(samples[2]) / before;
  row.loose_ratio = median(samples[3]) / before;
}

CostRow measure(const std::string& name, const char* region, const Setup& held_on_one_side) {
  constexpr int frames = 60;
  CostRow row{name, region, held_on_one_side.mesh.tet_count()};
  const FullStroke stroke = full_stroke(held_on_one_side.mesh);
  const Setup plain = held_on_both_sides(held_on_one_side, stroke);
  Setup setup = held_on_one_side;
  setup.scalpels = {on_path(stroke, frames)};
  World<float> loose(setup);
  play_cut(loose, frames);
  setup = plain;
  setup.scalpels = {on_path(stroke, frames)};
  const PlayedCut cut(setup, frames);
  World<float>& world = *cut.world;
  row.cut = cut_tets(*world.grains(), world.elements().topology);
  row.copies = world.elements().topology.tet_copy_count();
  row.all_us = 1e6 * cut.seconds / row.cut;
  row.geometry_us = 1e6 * median_of([&] { return geometry_seconds(plain, stroke, frames); }) / row.cut;
  row.sweep_us = 1e6 * median_of([&] { return geometry_seconds(plain, stroke, 1); }) / row.cut;
  setup.scalpels = {on_path(stroke, 1)};
  const PlayedCut batch(setup, 1);
  row.batch_us = 1e6 * batch.seconds / cut_tets(*batch.world->grains(), batch.world->elements().topology);
  const std::size_t before = Grains(World<float>(plain).elements()).bytes();
  row.bytes = double(world.grains()->bytes() - before) / row.cut;
  find_ratios_of_steps(plain, world, loose, row);
  State<float> state = world.state();
  state.u.setRandom();
  state.u *= 1e-4F;
  world.set_state(state);
  row.error = compare_with_rebuilt(world).largest();
  if (!(row.error <= 1e-5))
    throw WrongResult(name + ", " + region + ": the cut world deviates from one built afresh");

  // A blade of 40 mm goes on by 50 mm/s / 30.
  const Vec3d middle = plain.mesh.points.rowwise().mean(),
              along = (stroke.to.tip - stroke.from.tip).normalized();
  const Vec3d edge = 0.02 * (stroke.from.heel - stroke.from.tip).normalized();
  const auto at = [&](double x) { return BladePose{middle + x * along - edge, middle + x * along + edge}; };
  setup.scalpels = {on_path({at(-0.025), at(0.025)}, 30)};
  const PlayedCut slow(setup, 30);
  row.frame_ms = 1e3 * slow.seconds / std::max(1, slow.frames);
  row.slowest_ms = 1e3 * slow.slowest;
  return row;
}

void print(const CostRow& r) {
  std::printf("%-13s %-12s %7d %6d %7d %9.2f %8.2f %8.2f %8.2f %8.3f %10.3f %6.2f %6.2f %6.2f %7.0f %9.1e\n",
              r.mesh.c_str(), r.region, r.tets, r.cut, r.copies, r.geometry_us, r.all_us, r.sweep_us,
              r.batch_us, r.frame_ms, r.slowest_ms, r.step_ratio, r.fresh_ratio, r.loose_ratio, r.bytes,
              r.error);
  std::fflush(stdout);
}

std::string csv(const std::vector<CostRow>& rows) {
  std::ostringstream out;
  out << "mesh,region,tets,cut,copies,geometry_us,all_us,sweep_us,batch_us,frame_ms,slowest_frame_ms,step_"
         "ratio,fresh_ratio,"
         "loose_ratio,bytes,error\n"
      << std::setprecision(4);
  for (const CostRow& r : rows)
    out << r.mesh << ',' << r.region << ',' << r.tets << ',' << r.cut << ',' << r.copies << ','
        << r.geometry_us << ',' << r.all_us << ',' << r.sweep_us << ',' << r.batch_us << ',' << r.frame_ms
        << ',' << r.slowest_ms << ',' << r.step_ratio << ',' << r.fresh_ratio << ',' << r.loose_ratio << ','
        << r.bytes << ',' << r.error << '\n';
  return out.str();
}

// ---- The time step

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

// ---- Statics: a beam that is held at one end, with an oblique slit from above through half of it

struct BeamRow {
  double cell_mm = 0;
  Index tets = 0, grains = 0;
  double whole = 0, cut = 0, conforming = 0;  // sag of its end [m]
};

Setup slit_beam(int n) {
  Setup setup;
  setup.mesh = box_mesh({0.16, 0.04, 0.04}, 16 * n, 4 * n, 4 * n);
  setup.materials = {{4e5, 1e5, 1000}};
  return setup;
}

double sag(Setup setup) {
  const auto tets = std::size_t(setup.mesh.tet_count());
  setup.scalpels.clear();
  setup.gravity = {0, 0, -9.81};
  setup.material_of.assign(tets, 0);
  setup.region_of.assign(tets, RegionModel::tensor_mass);
  setup.prescribed.clear();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < 1e-9) setup.prescribed.push_back({v});
  const StaticResult solved = solve_static(setup);
  if (!solved.converged) throw WrongResult("the beam has no equilibrium: " + solved.reason);
  double sum = 0;
  int count = 0;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) > 0.16 - 1e-9) {
      sum -= solved.u(2, v);
      ++count;
    }
  return sum / count;
}

TetMesh conforming_mesh(const Grains& grains) {
  TetMesh mesh{Mat3X<double>(3, grains.point_count()), Tets(4, grains.count()), {}};
  for (Index p = 0; p < grains.point_count(); ++p) mesh.points.col(p) = grains.point(p);
  for (Index g = 0; g < grains.count(); ++g) mesh.tets.col(g) = grains[g].points;
  mesh.labels.assign(std::size_t(grains.count()), 0);
  return mesh;
}

BeamRow measure_beam(int n) {
  Setup setup = slit_beam(n);
  const auto tets = std::size_t(setup.mesh.tet_count());
  setup.material_of.assign(tets, 0);
  setup.region_of.assign(tets, RegionModel::tensor_mass);
  BeamRow row{10.0 / n, setup.mesh.tet_count()};
  row.whole = sag(setup);
  setup.scalpels = {on_path(
      {{{0.068, -0.02, 0.06}, {0.068, 0.06, 0.06}}, {{0.083, -0.02, 0.02}, {0.083, 0.06, 0.02}}}, 20)};
  World<double> world(setup);
  play_cut(world, 20);
  CompactMesh compacted;
  row.cut = sag(world.current_setup(compacted));
  row.grains = world.grains()->count();
  Setup fine = slit_beam(n);
  fine.mesh = conforming_mesh(*world.grains());
  row.conforming = sag(fine);
  return row;
}

}  // namespace

void bench_scalpel(const Options& options) {
  begin_results(options.output, "scalpel");
  std::printf("\n%-13s %-12s %7s %6s %7s %9s %8s %8s %8s %8s %10s %6s %6s %6s %7s %9s\n", "mesh", "region",
              "tets", "cut", "copies", "geom. us", "all us", "sweep us", "batch us", "frame ms", "slowest ms",
              "step", "fresh", "loose", "bytes", "error");
  std::vector<CostRow> costs;
  const auto cost = [&](const std::string& name, Setup setup, RegionModel model, const char* region) {
    std::fill(setup.region_of.begin(), setup.region_of.end(), model);
    print(costs.emplace_back(measure(name, region, setup)));
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

  std::printf("\n%-11s %8s %6s %8s %8s %10s %10s\n", "mesh", "cut_step", "planes", "worst", "median",
              "most mass", "median");
  std::ostringstream limits;
  limits << "mesh,cut_step,planes,worst_limit,median_limit,most_added,median_added\n" << std::setprecision(4);
  const std::pair<std::string, Setup> livers[] = {
      {"liver_10k", liver},
      {"liver_2k", organ_setup(read_mesh(std::string(LOBE_DATA_DIR) + "/meshes/liver_2k.vtu").mesh)}};
  for (const auto& [name, setup] : livers)
    for (const double cut_step : {0.75, 0.0}) {
      const LimitRow r = measure_limit(name, setup, cut_step, options.quick ? 2 : 12);
      std::printf("%-11s %8.2f %6d %8.3f %8.3f %10.5f %10.5f\n", r.mesh.c_str(), r.cut_step, r.planes,
                  r.worst, r.median, r.most_added, r.median_added);
      limits << r.mesh << ',' << r.cut_step << ',' << r.planes << ',' << r.worst << ',' << r.median << ','
             << r.most_added << ',' << r.median_added << '\n';
    }
  io::write_file(options.output / "scalpel_limit.csv", limits.str());

  std::printf("\n%8s %8s %8s %10s %10s %12s\n", "cell mm", "tets", "grains", "whole m", "cut m",
              "conforming m");
  std::ostringstream beams;
  beams << "cell_mm,tets,grains,whole_m,cut_m,conforming_m\n" << std::setprecision(6);
  for (int n = 1; n <= (options.quick ? 1 : 5); ++n) {
    const BeamRow r = measure_beam(n);
    std::printf("%8.2f %8d %8d %10.6f %10.6f %12.6f\n", r.cell_mm, r.tets, r.grains, r.whole, r.cut,
                r.conforming);
    beams << r.cell_mm << ',' << r.tets << ',' << r.grains << ',' << r.whole << ',' << r.cut << ','
          << r.conforming << '\n';
  }
  io::write_file(options.output / "scalpel_beam.csv", beams.str());
}

}  // namespace lobe::bench
