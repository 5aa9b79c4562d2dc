#include "benchmarks/gestures.h"

#include <algorithm>
#include <cstdio>
#include <iomanip>
#include <optional>
#include <sstream>

#include "benchmarks/accuracy_models.h"
#include "benchmarks/files.h"
#include "benchmarks/timing.h"
#include "lobe/error.h"
#include "lobe/io/mesh_io.h"
#include "lobe/linearity/watch.h"
#include "lobe/mesh/refine.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"

namespace lobe::bench {
namespace {

struct Row {
  std::string scene, regions;
  Index tets = 0;
  double linear_share = 0;  // of the tetrahedra, at the start
  double speedup = 1;       // of all frames, against all non-linear
  double worst_frame = 1;   // of a frame's time, against the slowest of all non-linear
  double mean_error = 0, largest_error = 0,
         estimated = 0;  // L2, of the largest displacement so far; the last the largest
  double watching = 0;   // share of the time
  Index moved = 0;       // tetrahedra that changed their model
  double expanded = 0;   // share of the frames after which the precomputed region was
};

// How the regions are made, and whether they are corrected.
struct Making {
  std::string name;
  Setup setup;
  bool watch = false, correct = false;
};

Setup with_regions(Setup setup, const std::vector<RegionModel>& region_of) {
  setup.region_of = region_of;
  return setup;
}

// The simple recipe: as many tetrahedra as the proposal makes linear, those with the least strain in one linear solution of
// the first declared gesture.
std::vector<RegionModel> by_strain(const Setup& setup, const std::vector<Gesture>& gestures, double share) {
  Setup trial = setup;
  trial.region_of.assign(trial.region_of.size(), RegionModel::nonlinear);
  const Mat3X<double> u = linear_trial(at_the_end_of(gestures.front(), trial));
  make_linear(trial, smoothed_norm(trial.mesh, u, Measure::strain), share);
  return trial.region_of;
}

bool any_precomputed(const std::vector<RegionModel>& region_of) {
  return std::count(region_of.begin(), region_of.end(), RegionModel::precomputed) > 0;
}

std::vector<Making> makings(const Scene& scene, const Resolved& resolved) {
  const Setup& setup = resolved.setup;
  std::vector<Making> list;
  const auto add = [&](const std::string& name, const std::vector<RegionModel>& region_of, bool watch,
                       bool correct) {
    list.push_back({name, with_regions(setup, region_of), watch, correct});
  };
  add("nonlinear", std::vector<RegionModel>(setup.region_of.size(), RegionModel::nonlinear), false, false);
  ProposalOptions options;
  options.tolerance = scene.auto_regions->tolerance;
  const Proposal condensed = propose_regions(setup, resolved.gestures, options);
  options.condense = false;
  const Proposal tensor_mass = propose_regions(setup, resolved.gestures, options);
  if (!resolved.gestures.empty())
    add("strain-recipe", by_strain(setup, resolved.gestures, tensor_mass.linear_share), false, false);
  add("proposed", tensor_mass.region_of, true, false);
  if (condensed.region_of != tensor_mass.region_of)
    add("proposed-precomputed", condensed.region_of, true, false);
  add("proposed-corrected", tensor_mass.region_of, true, true);
  options.condense = true;
  const Proposal corrected = propose_regions_to_correct(setup, resolved.gestures, options);
  if (any_precomputed(corrected.region_of)) {
    add("precomputed-alone", corrected.region_of, true, false);
    add("precomputed-in-frame", corrected.region_of, false, false);
    list.back().setup.precomputed_frame = RegionFrame::corotated;
    add("precomputed-corrected", corrected.region_of, true, true);
    list.back().setup.expandable = true;
  }
  add("all-linear-corrected", std::vector<RegionModel>(setup.region_of.size(), RegionModel::tensor_mass),
      true, true);
  return list;
}

// One of them as it runs.
class Player {
 public:
  Player(const Making& making, double tolerance) : world_(making.setup) {
    if (!making.watch) return;
    std::vector<std::vector<Index>> grasps;
    for (const GraspSetup& grasp : making.setup.grasps) grasps.push_back(grasp.vertices);
    watch_.emplace(world_, grasps, LinearityOptions{tolerance, making.correct});
    watch_->look(world_);
  }

  void advance(double frame) {
    const Stopwatch watch(true);
    const Report report = world_.advance(frame);
    if (!report.ok) throw WrongResult("a gesture did not run to its end: " + report.conditions.back().text);
    if (watch_) {
      const LinearityReport seen = watch_->look(world_);
      estimated_ = std::max(estimated_, seen.error);
      moved_ += seen.to_nonlinear + seen.to_linear;
      expanded_ += seen.is_expanded;
    }
    seconds_.push_back(watch.seconds());
  }

  World<float>& world() { return world_; }
  double seconds() const {
    double sum = 0;
    for (double s : seconds_) sum += s;
    return sum;
  }
  double slowest() const { return *std::max_element(seconds_.begin(), seconds_.end()); }
  double estimated() const { return estimated_; }
  double watching() const { return watch_ ? watch_->looking_seconds() / seconds() : 0; }
  Index moved() const { return moved_; }
  double expanded() const { return expanded_ / double(seconds_.size()); }

 private:
  World<float> world_;
  std::optional<LinearityWatch<float>> watch_;
  std::vector<double> seconds_;  // per frame
  double estimated_ = 0;
  Index moved_ = 0;
  int expanded_ = 0;  // frames
};

// √Σ m |u|² over the vertices that both still have.
double norm(const World<float>& exact, const World<float>& other, const std::vector<double>& mass,
            bool difference) {
  const auto u = exact.state().u, w = other.state().u;
  double sum = 0;
  for (std::size_t v = 0; v < mass.size(); ++v) {
    const auto i = static_cast<Index>(v);
    if (exact.elements().topology.around(i).empty() || other.elements().topology.around(i).empty()) continue;
    const Vec3d e = (difference ? (u.col(i) - w.col(i)).eval() : u.col(i).eval()).cast<double>();
    sum += mass[v] * e.squaredNorm();
  }
  return std::sqrt(sum);
}

std::vector<Row> play(const std::string& name, const Scene& scene, const Resolved& resolved) {
  const double tolerance = scene.auto_regions->tolerance;
  const std::vector<Making> list = makings(scene, resolved);
  std::vector<std::unique_ptr<Player>> players;
  for (const Making& making : list) players.push_back(std::make_unique<Player>(making, tolerance));
  const std::vector<double> mass = players[0]->world().mass();
  const int frames = static_cast<int>(std::lround(scene.time.duration / scene.time.frame));
  std::vector<Row> rows(list.size());
  double largest = 0;
  for (int i = 0; i < frames; ++i) {
    for (const auto& player : players) player->advance(scene.time.frame);
    largest = std::max(largest, norm(players[0]->world(), players[0]->world(), mass, false));
    for (std::size_t p = 1; p < players.size(); ++p) {
      const double error = norm(players[0]->world(), players[p]->world(), mass, true) / largest;
      rows[p].mean_error += error / frames;
      rows[p].largest_error = std::max(rows[p].largest_error, error);
    }
  }
  for (std::size_t p = 0; p < players.size(); ++p) {
    const std::vector<RegionModel>& region_of = list[p].setup.region_of;
    rows[p].scene = name;
    rows[p].regions = list[p].name;
    rows[p].tets = static_cast<Index>(region_of.size());
    rows[p].linear_share =
        1 - double(std::count(region_of.begin(), region_of.end(), RegionModel::nonlinear)) /
                double(region_of.size());
    rows[p].speedup = players[0]->seconds() / players[p]->seconds();
    rows[p].worst_frame = players[p]->slowest() / players[0]->slowest();
    rows[p].estimated = players[p]->estimated();
    rows[p].watching = players[p]->watching();
    rows[p].moved = players[p]->moved();
    rows[p].expanded = players[p]->expanded();
  }
  return rows;
}

void print(const Row& r) {
  std::printf("%-22s %7d %-24s %7.2f %8.2f %8.2f %9.4f %9.4f %9.4f %8.3f %7d %8.2f\n", r.scene.c_str(),
              r.tets, r.regions.c_str(), r.linear_share, r.speedup, r.worst_frame, r.mean_error,
              r.largest_error, r.estimated, r.watching, r.moved, r.expanded);
  std::fflush(stdout);
}

std::string csv(const std::vector<Row>& rows) {
  std::ostringstream out;
  out << "scene,tets,regions,linear_share,speedup,worst_frame,mean_error,largest_error,estimated_error,"
         "watching,moved,expanded\n"
      << std::setprecision(4);
  for (const Row& r : rows)
    out << r.scene << ',' << r.tets << ',' << r.regions << ',' << r.linear_share << ',' << r.speedup << ','
        << r.worst_frame << ',' << r.mean_error << ',' << r.largest_error << ',' << r.estimated << ','
        << r.watching << ',' << r.moved << ',' << r.expanded << '\n';
  return out.str();
}

constexpr const char* plot_script = R"(set terminal pngcairo size 900,560 font 'sans,11'
set output 'gestures.png'
set datafile separator ','
set datafile missing NaN
set logscale y
set grid
set key outside right
set xlabel 'speed-up of all frames over all non-linear'
set ylabel 'largest error of any frame, relative L2'
series(s, r) = strcol(1) eq s && strcol(3) eq r ? column(5) : NaN
plot for [r in "strain-recipe proposed proposed-precomputed proposed-corrected all-linear-corrected precomputed-alone precomputed-in-frame precomputed-corrected"] \
       'gestures.csv' using (series('liver_declared', r)):8 with points pt 7 ps 1.5 title r.', declared', \
     for [r in "strain-recipe proposed proposed-precomputed proposed-corrected all-linear-corrected precomputed-alone precomputed-in-frame precomputed-corrected"] \
       'gestures.csv' using (series('liver_undeclared', r)):8 with points pt 6 ps 1.5 title r.', undeclared'
)";

}  // namespace

std::string bench_gestures(const Options& options) {
  std::printf("\n%-22s %7s %-24s %7s %8s %8s %9s %9s %9s %8s %7s %8s\n", "scene", "tets", "regions", "linear",
              "speed-up", "slowest", "mean err", "largest", "estimate", "watching", "moved", "expanded");
  std::vector<Row> all;
  for (const char* name : {"liver_declared", "liver_undeclared"}) {
    const Scene scene =
        read_scene(std::filesystem::path(LOBE_DATA_DIR) / "scenes" / (std::string(name) + ".json"));
    const Resolved resolved = resolve(scene, read_mesh(mesh_path(scene)).mesh);
    for (const Row& row : play(name, scene, resolved)) {
      print(row);
      all.push_back(row);
    }
    if (options.quick) break;
  }
  write_file(options.output / "gestures.csv", csv(all));
  return plot_script;
}

}  // namespace lobe::bench
