// lobe bench steps: two ways in which stiff parts could take shorter steps than the rest, against one step
// for all. Which one is kept, and why, is in theory, section 7. World takes no part: plain code in
// step_chains.h and step_schemes.h.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <sstream>

#include "benchmarks/benchmarks.h"
#include "benchmarks/machine.h"
#include "benchmarks/step_chains.h"
#include "benchmarks/step_schemes.h"
#include "lobe/file/atomic_file.h"

namespace lobe::bench {
namespace {

struct TrialSetting {
  double safety, damping;  // [-], γ [1/s]
};
constexpr TrialSetting trial_settings[] = {{0.8, 0}, {0.9, 5}};
constexpr double large_step_of_liver = 1e-3;  // [s]: chains have no seconds

struct TrialFigures {  // not a number: not measured
  double energy = NAN, momentum = NAN, angular_momentum = NAN, evaluations = NAN, error = NAN, order = NAN;
};
struct TrialRow {
  const char *part, *scheme;
  TrialSetting setting;
  std::size_t cases;
  int grew;
  TrialFigures figures;
};
std::ostream& operator<<(std::ostream& csv, const TrialRow& row) {
  csv << row.part << ',' << row.scheme << ',' << row.setting.safety << ',' << row.setting.damping << ','
      << row.cases << ',' << row.grew;
  const TrialFigures& f = row.figures;
  for (double x : {f.energy, f.momentum, f.angular_momentum, f.evaluations, f.error, f.order})
    csv << ',' << x;
  return csv << '\n';
}

// ---- Chains

struct ChainRow {
  const char* name;
  ChainScheme scheme;
  double stabilisation;
};
constexpr ChainRow chain_rows[] = {{"one step", ChainScheme::one_step, 0},
                                   {"own steps", ChainScheme::own_steps, 0},
                                   {"two levels with nothing between", ChainScheme::two_levels, 0},
                                   {"leapfrog-Chebyshev 0.01", ChainScheme::leapfrog_chebyshev, 0.01},
                                   {"leapfrog-Chebyshev 0.05", ChainScheme::leapfrog_chebyshev, 0.05},
                                   {"leapfrog-Chebyshev 0.5", ChainScheme::leapfrog_chebyshev, 0.5}};

std::vector<ChainCase> chain_cases(bool quick) {
  std::vector<ChainCase> cases;
  const int contrasts = quick ? 6 : 24;
  for (int i = 0; i < contrasts; ++i)
    for (double mass : {0.25, 0.5, 1.0, 2.0, 4.0})
      for (double length : {0.5, 1.0, 2.0})
        cases.push_back({4 * std::pow(60.0, (i + 0.37) / contrasts), mass, length});
  return cases;
}

void play_chains(bool quick, std::ostream& csv) {
  constexpr double grown = 1e3;
  const std::vector<ChainCase> cases = chain_cases(quick);
  std::printf("\n%zu linear chains, 2^17 large steps\n%-30s %-8s %-6s %-12s %s\n", cases.size(), "scheme",
              "safety", "grew", "at most", "evaluations");
  for (const TrialSetting& setting : trial_settings)
    for (const ChainRow& row : chain_rows) {
      int grew = 0;
      double most = 0, cost = 0;
      for (const ChainCase& chain : cases) {
        const ChainFigures found = play_chain(chain, row.scheme, setting.safety,
                                              setting.damping * large_step_of_liver, row.stabilisation);
        grew += found.growth < grown ? 0 : 1;
        most = std::max(most, found.growth);
        cost += found.cost / double(cases.size());
      }
      std::printf("%-30s %-8g %-6d %-12.3g %.2f\n", row.name, setting.safety, grew, most, cost);
      csv << TrialRow{"chains", row.name, setting, cases.size(), grew, {.evaluations = cost}};
      if (row.scheme == ChainScheme::one_step && grew > 0)
        throw WrongResult("steps: a chain grows with one step for all");
    }
}

// ---- Blocks

enum class BlockScheme { one_step, own_steps, leapfrog_chebyshev };
struct BlockRow {
  const char* name;
  BlockScheme scheme;
  double stabilisation;
};
constexpr BlockRow block_rows[] = {{"one step", BlockScheme::one_step, 0},
                                   {"own steps", BlockScheme::own_steps, 0},
                                   {"leapfrog-Chebyshev 0.05", BlockScheme::leapfrog_chebyshev, 0.05},
                                   {"leapfrog-Chebyshev 0.5", BlockScheme::leapfrog_chebyshev, 0.5}};

struct BlockFigures {
  bool is_finite = true;
  double energy_change = 0;     // from the first tenth to the last, as a share; undamped
  double most_energy = 0;       // over that at the start
  double momentum = 0;          // change, over the sum of m |v|
  double angular_momentum = 0;  // change, as a share
  double evaluations = 0;       // per simulated second
};

std::unique_ptr<Scheme> scheme_for(const PlainBody& body, const BlockRow& row, double safety) {
  const double dt = safety * 2 / body.omega;
  if (row.scheme == BlockScheme::one_step) return own_steps(std::vector<Level>(body.tets.size(), 0), dt);
  const std::vector<Level> levels = safe_levels(body, body.squares);
  if (row.scheme == BlockScheme::own_steps) return own_steps(levels, dt);
  const Level top = *std::max_element(levels.begin(), levels.end());
  const std::vector<Level> of_vertices = levels_of_vertices(body.squares, body.omega * body.omega);
  std::vector<bool> is_fast;  // by its vertices and by the frequency of its level, but not by neighbours
  for (std::size_t t = 0; t < levels.size(); ++t) {
    const auto too_fast = [&](Index v) { return of_vertices[std::size_t(v)] < top; };
    is_fast.push_back(levels[t] < top &&
                      std::any_of(body.tets[t].corners.begin(), body.tets[t].corners.end(), too_fast));
  }
  return leapfrog_chebyshev(body, is_fast, dt * (1 << top), safety, row.stabilisation);
}

// Turns, waves as long as the body, and noise [m/s].
PlainState start_of(const PlainBody& body, double noise_speed) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  const Vec3d turn(0.3, 0.5, 0.8);  // [rad/s]
  PlainState state{Mat3X<double>::Zero(3, body.points.cols()), Mat3X<double>(3, body.points.cols())};
  for (Index v = 0; v < body.points.cols(); ++v) {
    const Vec3d X = body.points.col(v);
    const Vec3d wave(std::sin(50 * X.z()), std::cos(33 * X.z()), std::sin(130 * X.x() + 1));
    const Vec3d noise(normal(random), normal(random), normal(random));
    state.v.col(v) = turn.cross(X) + 0.02 * wave + noise_speed * noise;
  }
  return state;
}

double mean_between(const std::vector<double>& values, double from, double to) {
  const auto begin = values.begin() + std::ptrdiff_t(from * double(values.size()));
  const auto end = values.begin() + std::ptrdiff_t(to * double(values.size()));
  double sum = 0;
  for (auto at = begin; at != end; ++at) sum += *at;
  return sum / double(end - begin);
}

BlockFigures play_block(const PlainBody& body, Scheme& scheme, double damping, long steps) {
  PlainState state = start_of(body, 0.02);
  const Vec3d p = momentum(body, state.v), L = angular_momentum(body, state, state.v);
  double scale = 0;
  for (Index v = 0; v < state.v.cols(); ++v) scale += body.mass[std::size_t(v)] * state.v.col(v).norm();
  const long between = std::max(1L, steps / 2000);
  std::vector<double> energies;
  BlockFigures figures;
  Mat3X<double> kicked, before;
  for (long i = 0; i <= steps && figures.is_finite; ++i) {
    const bool at_end = i == 0 || i == steps;
    before = state.v;
    const Mat3X<double> u = state.u;
    scheme.step(body, damping, at_end ? 0.5 : 1, i < steps, state, kicked);
    if (i % between != 0 && !at_end) continue;
    const Mat3X<double> v = i == 0 ? before : at_end ? kicked : Mat3X<double>((before + kicked) / 2);
    energies.push_back(kinetic_energy(body, v) + elastic_energy(body, u));
    figures.is_finite = energies.back() < 1e6 * energies.front();
    figures.momentum = (momentum(body, v) - p).norm() / scale;
    figures.angular_momentum = (angular_momentum(body, {u, v}, v) - L).norm() / L.norm();
  }
  figures.most_energy = *std::max_element(energies.begin(), energies.end()) / energies.front();
  if (!figures.is_finite) return figures;
  figures.energy_change = mean_between(energies, 0.9, 1) / mean_between(energies, 0, 0.1) - 1;
  figures.evaluations = double(scheme.evaluations) / (double(steps) * scheme.large_step());
  return figures;
}

struct SolidPair {
  Solid soft, stiff;
};
std::vector<SolidPair> solid_pairs(bool quick) {
  std::vector<SolidPair> all;
  for (double contrast : {50., 13., 120., 30., 300., 1000.})
    all.push_back(
        {{5e3, 0.35, 1000}, {5e3 * contrast, all.size() % 2 ? 0.45 : 0.3, all.size() % 3 ? 1000. : 1200.}});
  if (quick) all.resize(2);
  return all;
}

// What the worst of the pairs did.
struct WorstPair {
  int blown = 0;
  TrialFigures figures{.energy = 0, .momentum = 0, .angular_momentum = 0, .evaluations = 0};
};

WorstPair worst_of(const BlockRow& row, const TrialSetting& setting, bool quick) {
  WorstPair worst;
  const std::vector<SolidPair> all = solid_pairs(quick);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const PlainBody body = two_part_block(all[i].soft, all[i].stiff, unsigned(5 + i));
    const auto scheme = scheme_for(body, row, setting.safety);
    const BlockFigures found = play_block(body, *scheme, setting.damping, quick ? 2000 : 100'000);
    if (!found.is_finite) {
      ++worst.blown;
      continue;
    }
    const double energy = setting.damping > 0 ? found.most_energy - 1 : found.energy_change;
    worst.figures.energy = std::abs(energy) > std::abs(worst.figures.energy) ? energy : worst.figures.energy;
    worst.figures.momentum = std::max(worst.figures.momentum, found.momentum);
    worst.figures.angular_momentum = std::max(worst.figures.angular_momentum, found.angular_momentum);
    const double of_one_step = double(body.tets.size()) * body.omega / (2 * setting.safety);
    worst.figures.evaluations += found.evaluations / of_one_step;
  }
  worst.figures.evaluations /= std::max(1.0, double(all.size()) - worst.blown);
  return worst;
}

void play_blocks(bool quick, std::ostream& csv) {
  std::printf("\n%zu blocks of two stiffnesses, %s large steps\n%-26s %-8s %-8s %-10s %-10s %-10s %s\n",
              solid_pairs(quick).size(), quick ? "2,000" : "100,000", "scheme", "safety", "blew up", "energy",
              "momentum", "angular", "evaluations");
  for (const TrialSetting& setting : trial_settings)
    for (const BlockRow& row : block_rows) {
      const WorstPair worst = worst_of(row, setting, quick);
      std::printf("%-26s %-8g %-8d %-10.2g %-10.1g %-10.1g %.2f\n", row.name, setting.safety, worst.blown,
                  worst.figures.energy, worst.figures.momentum, worst.figures.angular_momentum,
                  worst.figures.evaluations);
      csv << TrialRow{"blocks", row.name, setting, solid_pairs(quick).size(), worst.blown, worst.figures};
      if (row.scheme == BlockScheme::one_step && worst.blown > 0)
        throw WrongResult("steps: a block grows with one step for all");
      std::fflush(stdout);
    }
}

// ---- Order

// Relative errors of displacements after 30 ms, with steps of which each is half of the one before.
std::array<double, 3> errors_of(const PlainBody& body, const BlockRow& row, const Mat3X<double>& reference) {
  std::array<double, 3> errors;
  double safety = 0.8;
  for (double& error : errors) {
    PlainState state = start_of(body, 0);
    Mat3X<double> kicked;
    const auto rough = scheme_for(body, row, safety);
    const int steps = int(std::ceil(0.03 / rough->large_step()));
    const auto scheme = scheme_for(body, row, safety * 0.03 / (steps * rough->large_step()));
    for (int i = 0; i < steps; ++i) scheme->step(body, 0, i == 0 ? 0.5 : 1, true, state, kicked);
    error = (state.u - reference).norm() / reference.norm();
    safety /= 2;
  }
  return errors;
}

void find_orders(std::ostream& csv) {
  const PlainBody body = two_part_block({5e3, 0.35, 1000}, {2.5e5, 0.3, 1000}, 5);
  PlainState state = start_of(body, 0);
  Mat3X<double> kicked;
  const double dt = 0.05 * 2 / body.omega;
  const int steps = int(std::ceil(0.03 / dt));
  const auto fine = own_steps(std::vector<Level>(body.tets.size(), 0), 0.03 / steps);
  for (int i = 0; i < steps; ++i) fine->step(body, 0, i == 0 ? 0.5 : 1, true, state, kicked);
  std::printf("\nerror after 30 ms, contrast 50\n%-26s %-10s %-10s %-10s %s\n", "scheme", "0.8", "0.4", "0.2",
              "order");
  for (const BlockRow& row : block_rows) {
    const std::array<double, 3> errors = errors_of(body, row, state.u);
    const double order = std::log2(errors[1] / errors[2]);
    std::printf("%-26s %-10.1e %-10.1e %-10.1e %.2f\n", row.name, errors[0], errors[1], errors[2], order);
    csv << TrialRow{"order", row.name, trial_settings[0], 1, 0, {.error = errors[0], .order = order}};
  }
}

}  // namespace

void bench_steps(const Options& options) {
  begin_results(options.output, "steps");
  std::ostringstream csv;
  csv << "part,scheme,safety,damping_1_s,cases,grew,energy,momentum,angular_momentum,evaluations,error,"
         "order\n";
  play_chains(options.quick, csv);
  play_blocks(options.quick, csv);
  find_orders(csv);
  io::write_file(options.output / "steps.csv", csv.str());
}

}  // namespace lobe::bench
