// lobe bench own_steps: processor time of bodies with a stiff part, with own steps and with one step for all,
// against the same body without it.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <sstream>

#include "benchmarks/benchmarks.h"
#include "benchmarks/machine.h"
#include "benchmarks/scalpel.h"
#include "benchmarks/timing.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/generators.h"
#include "lobe/sim/world.h"

namespace lobe::bench {
namespace {

constexpr double frame_of_own = 1.0 / 60;  // [s]

// A body and what it is compared with. Each frame is played by all three, in turn.
struct OwnCase {
  std::string name;
  Setup without, with;          // the stiff part, or the cut
  bool is_cut = false;          // by a blade through all of it, before it is timed
  double gains = 0, costs = 0;  // what is asked: one step over own steps, own steps over without; 0: nothing
};

struct OwnRow {
  Index tets = 0;
  double with_one = 0, with_own = 0;  // processor time of frames, over those without the stiff part
  double gain = 0;                    // of one step for all over own steps
  double limit = 0;                   // step limit at the start over that without the stiff part
  double share = 1, difference = 0;   // of evaluations; of displacements to those of one step, of their norm
  int reruns = 0;
};

Elastic tissue(double E, ElementType element) {
  constexpr double nu = 0.4;
  Elastic elastic{E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu)), 1000};
  elastic.element = element;
  return elastic;
}

Vec3d centre_of(const TetMesh& mesh, Index t) {
  return mesh.points(Eigen::all, mesh.tets.col(t)).rowwise().mean();
}

Setup soft_body(TetMesh mesh, double E, ElementType element) {
  Setup setup;
  setup.mesh = std::move(mesh);
  setup.materials = {tissue(E, element)};
  setup.material_of.assign(std::size_t(setup.mesh.tet_count()), 0);
  setup.region_of.assign(std::size_t(setup.mesh.tet_count()), RegionModel::nonlinear);
  setup.damping = 5;
  return setup;
}

template <class Holds>
void hold_where(Setup& setup, Holds&& holds) {
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (holds(Vec3d(setup.mesh.points.col(v)))) setup.prescribed.push_back({v, Vec3d::Zero()});
}

template <class Is>
Setup stiffened(Setup setup, double times, Is&& is_stiff) {
  Elastic stiff = setup.materials.front();
  stiff.lambda *= times;
  stiff.mu *= times;
  setup.materials.push_back(stiff);
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (is_stiff(t)) setup.material_of[std::size_t(t)] = 1;
  return setup;
}

TetMesh shaken(TetMesh mesh, double by) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> shift(-by, by);
  for (double& x : mesh.points.reshaped()) x += shift(random);
  return mesh;
}

Setup lying_liver(const TetMesh& mesh, ElementType element) {
  Setup setup = soft_body(mesh, 1e4, element);
  setup.gravity = {0, 0, -9.81};
  const double lowest = mesh.points.row(2).minCoeff();
  hold_where(setup, [&](const Vec3d& X) { return X.z() < lowest + 0.06; });
  return setup;
}

OwnCase tumour(const TetMesh& mesh, ElementType element, double times, const std::string& name) {
  const Vec3d centre = mesh.points.rowwise().mean();
  Setup without = lying_liver(mesh, element);
  Setup with = times == 1 ? without : stiffened(without, times, [&](Index t) {
    return (centre_of(mesh, t) - centre).norm() < 0.02;
  });
  return {name, std::move(without), std::move(with), false, 0, times == 1 ? 1.0 : 1.5};
}

// A block of 10,368 tetrahedra under a wall of 1,728 that is 50 times as stiff.
OwnCase under_wall(bool is_tied, bool quick) {
  constexpr double cell = 0.008;
  const int n = quick ? 6 : 12, layers = 2;
  const double thickness = layers * cell, height = n * cell;
  TetMesh mesh = shaken(box_mesh({height, height, height + thickness}, n, n, n + layers), 0.1 * cell);
  const Index of_block = Index(6 * n * n * n);
  if (!is_tied) {
    const TetMesh block = shaken(box_mesh({height, height, height}, n, n, n), 0.1 * cell);
    TetMesh plate = shaken(box_mesh({height, height, thickness}, n, n, layers), 0.1 * cell);
    plate.points.row(2).array() += height + 0.25 * cell;
    mesh.points.resize(3, block.points.cols() + plate.points.cols());
    mesh.points << block.points, plate.points;
    mesh.tets.resize(4, block.tets.cols() + plate.tets.cols());
    mesh.tets << block.tets, (plate.tets.array() + block.vertex_count()).matrix();
    mesh.labels.assign(std::size_t(mesh.tet_count()), 0);
  }
  Setup without = soft_body(mesh, 1e4, ElementType::tetrahedron);
  without.gravity = {0, 0, -1};
  without.contact.self = !is_tied;
  hold_where(without, [&](const Vec3d& X) { return X.z() < cell / 2; });
  Setup with = stiffened(without, 50, [&](Index t) {
    return is_tied ? centre_of(without.mesh, t).z() > height : t >= of_block;
  });
  return {is_tied ? "wall tied" : "wall touching", std::move(without), std::move(with), false, 2.5, 0};
}

// The blade adds no mass. What it parts is held on both sides.
OwnCase full_cut(const TetMesh& mesh) {
  Setup without = soft_body(mesh, 1e4, ElementType::tetrahedron);
  without.gravity = {0, 0, -9.81};
  const double low = mesh.points.row(0).minCoeff(), high = mesh.points.row(0).maxCoeff();
  hold_where(without, [&](const Vec3d& X) {
    return X.x() < low + 0.1 * (high - low) || X.x() > high - 0.1 * (high - low);
  });
  Setup with = without;
  with.cut_step = 0;
  with.scalpels = {on_path(full_stroke(mesh), 20)};
  return {"full cut", std::move(without), std::move(with), true, 0, 1.15};
}

double per_frame(World<float>& world, OwnRow* row) {
  const Stopwatch watch(true);
  const Report report = world.advance(frame_of_own);
  const double seconds = watch.seconds();
  if (!report.ok) throw WrongResult("own_steps: a frame was given up");
  if (row) row->reruns += report.reruns;
  return seconds;
}

OwnRow measure_own(const OwnCase& one_case, int frames) {
  OwnRow row;
  World<float> without(one_case.without), one(one_case.with);
  Setup with_own = one_case.with;
  with_own.own_steps = true;
  World<float> own(with_own);
  if (one_case.is_cut)
    for (World<float>* world : {&one, &own}) play_cut(*world, 20);
  row.tets = one.elements().topology.tet_count();
  row.limit = one.time_step_limit() / without.time_step_limit();
  std::vector<double> seconds[3];
  double share = 0, furthest = 0, size = 0;
  for (int i = 0; i < frames; ++i) {
    seconds[0].push_back(per_frame(without, nullptr));
    seconds[1].push_back(per_frame(one, nullptr));
    seconds[2].push_back(per_frame(own, &row));
    share += own.body().own_steps->share() / frames;
    furthest = std::max(furthest, double((one.state().u - own.state().u).norm()));
    size = std::max(size, double(one.state().u.norm()));
  }
  for (std::vector<double>& of_world : seconds) std::sort(of_world.begin(), of_world.end());
  row.with_one = median(seconds[1]) / median(seconds[0]);
  row.with_own = median(seconds[2]) / median(seconds[0]);
  row.gain = median(seconds[1]) / median(seconds[2]);
  row.share = share;
  row.difference = furthest / size;
  if (!(row.difference < 0.02)) throw WrongResult(one_case.name + ": own steps go elsewhere than one step");
  return row;
}

}  // namespace

void bench_own_steps(const Options& options) {
  begin_results(options.output, "own_steps");
  const std::filesystem::path meshes = std::filesystem::path(LOBE_DATA_DIR) / "meshes";
  const TetMesh liver = read_mesh(meshes / (options.quick ? "liver_2k.vtu" : "liver_10k.vtu")).mesh;
  std::vector<OwnCase> cases;
  cases.push_back(tumour(liver, ElementType::tetrahedron, 1, "alike"));
  cases.push_back(tumour(liver, ElementType::tetrahedron, 13, "tumour"));
  cases.push_back(tumour(liver, ElementType::edge_smoothed, 13, "tumour smoothed"));
  cases.push_back(under_wall(true, options.quick));
  cases.push_back(under_wall(false, options.quick));
  cases.push_back(full_cut(liver));
  std::ostringstream csv;
  csv << "case,tets,step_limit,one_over_without,own_over_without,gain,evaluations,difference,reruns,"
         "asked_gain,asked_cost\n";
  std::printf("\n%-18s %7s %6s %10s %10s %6s %6s %10s %6s\n", "case", "tets", "limit", "one/without",
              "own/without", "gain", "eval.", "difference", "reruns");
  for (const OwnCase& one_case : cases) {
    const OwnRow row = measure_own(one_case, options.quick ? 12 : 60);
    std::printf("%-18s %7d %6.3f %10.2f %10.2f %6.2f %6.2f %10.1e %6d\n", one_case.name.c_str(), row.tets,
                row.limit, row.with_one, row.with_own, row.gain, row.share, row.difference, row.reruns);
    csv << one_case.name << ',' << row.tets << ',' << row.limit << ',' << row.with_one << ',' << row.with_own
        << ',' << row.gain << ',' << row.share << ',' << row.difference << ',' << row.reruns << ','
        << one_case.gains << ',' << one_case.costs << '\n';
    std::fflush(stdout);
  }
  io::write_file(options.output / "own_steps.csv", csv.str());
}

}  // namespace lobe::bench
