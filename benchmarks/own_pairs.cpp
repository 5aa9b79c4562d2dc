// lobe bench own_pairs: 10⁵ large steps of 200 pairs of bodies with own steps.
#include "benchmarks/own_pairs.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <sstream>

#include "benchmarks/benchmarks.h"
#include "benchmarks/machine.h"
#include "lobe/file/atomic_file.h"
#include "lobe/mesh/generators.h"
#include "lobe/sim/world.h"

namespace lobe::bench {
namespace {

constexpr double pair_edge = 0.01, pair_frame = 0.03;  // [m], [s]

TetMesh jittered_box(int nx, int ny, int nz, std::mt19937& random) {
  std::uniform_real_distribution<double> one(0, 1);
  TetMesh mesh = box_mesh({nx * pair_edge, ny * pair_edge, nz * pair_edge}, nx, ny, nz);
  for (double& x : mesh.points.reshaped()) x += (one(random) - 0.5) * 0.3 * pair_edge;
  return mesh;
}

TetMesh beside(const TetMesh& a, const TetMesh& b) {
  TetMesh both;
  both.points.resize(3, a.points.cols() + b.points.cols());
  both.points << a.points, b.points;
  both.tets.resize(4, a.tets.cols() + b.tets.cols());
  both.tets << a.tets, (b.tets.array() + a.vertex_count()).matrix();
  both.labels.assign(std::size_t(both.tet_count()), 0);
  return both;
}

Elastic elastic_of(double E, double nu, double density) {
  return {E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu)), density};
}

// Turns, a wave along z and noise [m/s]; what is held stays.
State<double> swinging_pair(const Setup& setup, unsigned seed) {
  const Mat3X<double>& X = setup.mesh.points;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> noise(-0.02, 0.02);
  State<double> state{Mat3X<double>::Zero(3, X.cols()), Mat3X<double>::Zero(3, X.cols())};
  const Vec3d centre = X.rowwise().mean();
  const bool is_free = setup.prescribed.empty();
  for (Index v = 0; v < X.cols(); ++v) {
    for (double& x : state.v.col(v)) x = noise(random);
    if (is_free)
      state.v.col(v) +=
          Vec3d(1, 3, 2).cross(Vec3d(X.col(v)) - centre) + Vec3d(0.2 * std::sin(45 * X(2, v)), 0, 0);
  }
  for (const PrescribedVertex& held : setup.prescribed) state.v.col(held.vertex).setZero();
  return state;
}

struct PairPlay {
  World<double> world;
  PairFigures figures;
  double done = 0, frames = 0;  // large steps, frames
  std::vector<double> energies = {};
  int refused = 0;

  double energy() {
    world.body().synchronise_velocities();
    return world.energies().total();
  }
  // Until so many large steps are done; false if it blew up.
  bool go_on(double until) {
    const double start = energy();
    double least = start, highest = start;
    bool is_free = true;
    for (long i = 0; done < until; ++i) {
      const Report report = world.advance(pair_frame);
      figures.reruns += report.reruns;
      refused += !report.ok;
      const auto& own_steps = world.body().own_steps;
      Level top = 0;
      if (own_steps && own_steps->any())
        top = *std::max_element(own_steps->levels().begin(), own_steps->levels().end());
      done += double(report.steps) / (1 << top);
      figures.share += own_steps ? own_steps->share() : 1;
      ++frames;
      if (i % 10 != 0) continue;
      const double now = energy();
      energies.push_back(now);
      highest = std::max(highest, now);
      least = std::min(least, now);
      if (!(now - least <= 5 * std::max(start - least, std::abs(start)))) is_free = false;
      if (!is_free || refused > 3) return false;
    }
    const double scale = world.held().all().empty() ? start : start - least;
    figures.most_energy = std::max(figures.most_energy, 1 + (highest - start) / scale);
    return true;
  }
};

struct PairRow {
  const char* name;
  PairSetting setting;
};
constexpr PairRow pair_rows[] = {{"tied", {Joint::tied, 0.9, 5, true}},
                                 {"tied undamped", {Joint::tied, 0.8, 0, true}},
                                 {"touching", {Joint::touching, 0.9, 5, true}}};

struct PairSum {
  int blew_up = 0, gained = 0, reruns = 0;
  double most_energy = 1, drift = 0, share = 0;
  void add(const PairFigures& one) {
    blew_up += one.blew_up;
    share += one.share;
    reruns += one.reruns;
    if (one.blew_up) return;
    gained += one.gained();
    most_energy = std::max(most_energy, one.most_energy);
    drift = std::max(drift, one.drift);
  }
};

double mean_of(const std::vector<double>& values, std::size_t from, std::size_t to) {
  double sum = 0;
  for (std::size_t i = from; i < to; ++i) sum += values[i];
  return sum / double(to - from);
}

}  // namespace

Setup pair_of(int number, const PairSetting& setting) {
  std::mt19937 random(unsigned(500 + number));
  std::uniform_real_distribution<double> one(0, 1);
  Setup setup;
  const bool is_tied = setting.joint == Joint::tied;
  if (is_tied) setup.mesh = jittered_box(2, 2, 14, random);
  const double contrast = std::pow(10, 3 * one(random)), nu_soft = 0.2 + 0.25 * one(random),
               nu_stiff = 0.2 + 0.25 * one(random), density = std::pow(4, one(random) - 0.5);
  const int layers = 1 + int(3 * one(random));
  setup.materials = {elastic_of(5e3, nu_soft, 1000), elastic_of(5e3 * contrast, nu_stiff, 1000 * density)};
  if (number % 2)
    for (Elastic& elastic : setup.materials) elastic.element = ElementType::edge_smoothed;
  Index soft_tets = 0;
  if (!is_tied) {
    const TetMesh block = jittered_box(6, 6, 8, random);
    TetMesh cube = box_mesh(Vec3d::Constant(2 * pair_edge), layers, layers, layers);
    cube.points.colwise() += Vec3d(2 * pair_edge, 2 * pair_edge, 8.2 * pair_edge);
    soft_tets = block.tet_count();
    setup.mesh = beside(block, cube);
    for (Index v = 0; v < block.vertex_count(); ++v)
      if (block.points(2, v) < pair_edge / 2) setup.prescribed.push_back({v, Vec3d::Zero()});
    setup.gravity = {0, 0, -1};
    setup.contact.self = true;
  }
  setup.region_of.assign(std::size_t(setup.mesh.tet_count()), RegionModel::nonlinear);
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const double z = setup.mesh.points(2, setup.mesh.tets.col(t)).mean();
    setup.material_of.push_back(is_tied ? z > (14 - layers) * pair_edge : t >= soft_tets);
  }
  setup.safety = setting.safety;
  setup.damping = setting.damping;
  setup.own_steps = setting.own_steps;
  return setup;
}

PairFigures play_pair(int number, const PairSetting& setting, double large_steps) {
  const Setup setup = pair_of(number, setting);
  PairPlay play{World<double>(setup), {.share = 0}};
  const int quarters = setting.damping > 0 ? 4 : 1;
  bool goes_on = true;
  for (int quarter = 0; quarter < quarters && goes_on; ++quarter) {
    if (setting.joint == Joint::tied || quarter > 0) {
      State<double> state = swinging_pair(setup, unsigned(9 + number + 1000 * quarter));
      if (setting.joint == Joint::touching) state.u = play.world.state().u;
      play.world.set_state(state);
    }
    goes_on = play.go_on(large_steps * (quarter + 1) / quarters);
  }
  PairFigures figures = play.figures;
  figures.blew_up = !goes_on;
  figures.share /= std::max(1.0, play.frames);
  const std::size_t tenth = play.energies.size() / 10, all = play.energies.size();
  if (setting.damping == 0 && goes_on && tenth > 0)
    figures.drift = mean_of(play.energies, all - tenth, all) / mean_of(play.energies, 0, tenth) - 1;
  return figures;
}

void bench_own_pairs(const Options& options) {
  begin_results(options.output, "own_pairs");
  const int pairs = options.quick ? 4 : 200;
  std::ostringstream csv;
  csv << "joint,steps,safety,damping_1_s,pairs,large_steps,blew_up,gained,most_energy,drift,evaluations,"
         "reruns\n";
  std::printf("\n%d pairs\n%-14s %-5s %-8s %-8s %-7s %-12s %-9s %-6s %s\n", pairs, "joint", "steps", "large",
              "blew up", "gained", "most energy", "drift", "eval.", "reruns");
  int blown = 0;
  for (PairRow row : pair_rows)
    for (const bool own_steps : {true, false}) {
      row.setting.own_steps = own_steps;
      const double large_steps = !options.quick ? 1e5 : row.setting.joint == Joint::tied ? 400 : 100;
      PairSum sum;
      for (int number = 0; number < pairs; ++number) sum.add(play_pair(number, row.setting, large_steps));
      const char* steps = own_steps ? "own" : "one";
      std::printf("%-14s %-5s %-8g %-8d %-7d %-12.4f %-+9.4f %-6.2f %d\n", row.name, steps, large_steps,
                  sum.blew_up, sum.gained, sum.most_energy, sum.drift, sum.share / pairs, sum.reruns);
      csv << row.name << ',' << steps << ',' << row.setting.safety << ',' << row.setting.damping << ','
          << pairs << ',' << large_steps << ',' << sum.blew_up << ',' << sum.gained << ',' << sum.most_energy
          << ',' << sum.drift << ',' << sum.share / pairs << ',' << sum.reruns << '\n';
      std::fflush(stdout);
      if (own_steps && row.setting.damping > 0) blown += sum.blew_up + sum.gained;
    }
  io::write_file(options.output / "own_pairs.csv", csv.str());
  if (blown > 0) throw WrongResult("own_pairs: a damped pair gained energy with own steps");
}

}  // namespace lobe::bench
