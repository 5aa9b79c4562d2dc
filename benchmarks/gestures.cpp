#include "benchmarks/gestures.h"

#include <algorithm>
#include <cstdio>
#include <iomanip>
#include <optional>
#include <sstream>

#include "benchmarks/accuracy_models.h"
#include "benchmarks/timing.h"
#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/linearity/mass_watch.h"
#include "lobe/linearity/reduced_watch.h"
#include "lobe/linearity/trials.h"
#include "lobe/linearity/watch.h"
#include "lobe/mesh/refine.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"

namespace lobe::bench {
namespace {

struct GestureRow {
  std::string scene, regions;
  Index tets = 0;
  double tolerance = 0;
  double linear_share = 0;  // of the tetrahedra, at the start
  double static_error = 0;  // of these regions, in the worst declared gesture
  double speedup = 1;       // of all frames, against all non-linear
  double worst_frame = 1;   // of a frame's time, against the slowest of all non-linear
  double mean_error = 0, largest_error = 0,
         estimated = 0;       // L2, of the largest displacement so far; the last the largest
  double ratio_at_worst = 0;  // estimated over true, in the frame with the largest error
  double watching = 0;        // share of the time, corrections included
  Index moved = 0;            // tetrahedra that changed their model
  double expanded = 0;        // share of the frames after which the precomputed region was, or all was full
  int wrong = 0;              // frames with an error above 0.7 %
  int beyond = 0;             // in which the estimate is not within a factor of 3 of it
  double largest_same_cut = 0, mean_same_cut = 0;  // of reduced regions, against Player::as_cut()
};

// How the regions are made, and whether they are corrected.
struct Making {
  std::string name;
  Setup setup;
  bool watch = false, correct = false;
  double tolerance = 0;
};

Setup all_nonlinear(Setup setup) {
  std::fill(setup.region_of.begin(), setup.region_of.end(), RegionModel::nonlinear);
  return setup;
}

Setup all_reduced(Setup setup) {
  std::fill(setup.region_of.begin(), setup.region_of.end(), RegionModel::reduced);
  return setup;
}

Setup with_regions(Setup setup, const std::vector<RegionModel>& region_of) {
  setup.region_of = region_of;
  return setup;
}

double worst_error(const std::vector<RegionModel>& region_of, const std::vector<Trial>& trials) {
  double worst = 0;
  for (const Trial& trial : trials) worst = std::max(worst, static_error(region_of, trial));
  return worst;
}

// The simple recipe: the tetrahedra with the least strain in one linear solution of the first declared
// gesture, as many as the tolerance allows.
std::vector<RegionModel> by_strain(const Setup& setup, const std::vector<Gesture>& gestures,
                                   const std::vector<Trial>& trials, double tolerance) {
  constexpr int halvings = 8;
  Setup trial = all_nonlinear(setup);
  const std::vector<double> score =
      smoothed_norm(trial.mesh, linear_trial(at_the_end_of(gestures.front(), trial)), Measure::strain);
  std::vector<RegionModel> best = trial.region_of;
  double least = 0, most = 1;
  for (int i = 0; i < halvings; ++i) {
    const double share = (least + most) / 2;
    make_linear(trial, score, share);
    const bool fits = worst_error(trial.region_of, trials) <= tolerance;
    (fits ? least : most) = share;
    if (fits) best = trial.region_of;
  }
  return best;
}

bool any_precomputed(const std::vector<RegionModel>& region_of) {
  return std::count(region_of.begin(), region_of.end(), RegionModel::precomputed) > 0;
}

std::vector<Making> makings(const Setup& setup, const std::vector<Gesture>& gestures,
                            const std::vector<Trial>& trials, double tolerance) {
  std::vector<Making> list;
  const auto add = [&](const std::string& name, const std::vector<RegionModel>& region_of, bool watch,
                       bool correct) {
    list.push_back({name, with_regions(setup, region_of), watch, correct, tolerance});
  };
  ProposalOptions options;
  options.tolerance = tolerance;
  const Proposal condensed = propose_regions(setup, gestures, options);
  options.condense = false;
  const Proposal tensor_mass = propose_regions(setup, gestures, options);
  add("strain-recipe", by_strain(setup, gestures, trials, tolerance), false, false);
  add("proposed", tensor_mass.region_of, true, false);
  if (condensed.region_of != tensor_mass.region_of)
    add("proposed-precomputed", condensed.region_of, true, false);
  add("proposed-corrected", tensor_mass.region_of, true, true);
  options.condense = true;
  const Proposal corrected = propose_regions_to_correct(setup, gestures, options);
  if (any_precomputed(corrected.region_of)) {
    add("precomputed-alone", corrected.region_of, true, false);
    add("precomputed-in-frame", corrected.region_of, false, false);
    list.back().setup.precomputed_frame = RegionFrame::corotated;
    add("precomputed-corrected", corrected.region_of, true, true);
    list.back().setup.expandable = true;
  }
  for (bool correct : {false, true}) {
    add(correct ? "selective-mass-corrected" : "selective-mass-alone", all_nonlinear(setup).region_of, false,
        correct);
    list.back().setup.selective_mass = mass_degree;
  }
  add("all-linear-corrected", std::vector<RegionModel>(setup.region_of.size(), RegionModel::tensor_mass),
      true, true);
  return list;
}

// One of them as it runs.
class Player {
 public:
  explicit Player(const Making& making) : world_(making.setup) {
    if (making.setup.selective_mass > 1 && making.correct) {
      mass_watch_.emplace(world_, making.tolerance);
      mass_watch_->look(world_);
    }
    if (world_.body().regions.any_reduced()) {
      reduced_watch_.emplace(world_, ReducedOptions{making.tolerance, making.correct});
      reduced_watch_->look(world_);
    }
    if (!making.watch) return;
    std::vector<std::vector<Index>> grasps;
    for (const GraspSetup& grasp : making.setup.grasps) grasps.push_back(grasp.vertices);
    watch_.emplace(world_, grasps, LinearityOptions{making.tolerance, making.correct});
    watch_->look(world_);
  }

  void advance(double frame) {
    const Stopwatch watch(true);
    const Report report = world_.advance(frame);
    if (!report.ok) throw WrongResult("a gesture did not run to its end: " + report.conditions.back().text);
    if (watch_) {
      const double before = watch.seconds();
      const LinearityReport seen = watch_->look(world_);
      estimated_now_ = seen.error;
      moved_ += seen.to_nonlinear + seen.to_linear;
      expanded_ += seen.is_expanded;
      watching_ += watch.seconds() - before;
    }
    const auto& reduced = world_.body().regions.reduced();
    expanded_ += reduced.any() && !reduced.any_embedded();
    if (mass_watch_) {
      const double before = watch.seconds();
      expanded_ += world_.body().inertia.degree() == 1;
      estimated_now_ = mass_watch_->look(world_).error;
      watching_ += watch.seconds() - before;
    }
    if (reduced_watch_) {
      const double before = watch.seconds();
      const ReducedReport seen = reduced_watch_->look(world_);
      estimated_now_ = seen.error;
      moved_ += seen.to_full;
      watching_ += watch.seconds() - before;
    }
    estimated_ = std::max(estimated_, estimated_now_);
    seconds_.push_back(watch.seconds());
  }

  World<float>& world() { return world_; }

  // All non-linear, and cut where the world was: a cautery that meets tissue at slightly other places burns
  // other tetrahedra, which is no error of the model.
  void follow_cuts(Setup nonlinear) {
    nonlinear.cauteries.clear();
    as_cut_.emplace(nonlinear);
    lives_.assign(std::size_t(nonlinear.mesh.tet_count()), 1);
  }
  void advance_as_cut(double frame) {
    if (!as_cut_) return;
    std::vector<Index> gone;
    for (std::size_t t = 0; t < lives_.size(); ++t)
      if (lives_[t] && !world_.elements().topology.alive(static_cast<Index>(t))) {
        gone.push_back(static_cast<Index>(t));
        lives_[t] = 0;
      }
    if (!gone.empty()) as_cut_->remove_tets(gone);
    as_cut_->advance(frame);
  }
  World<float>* as_cut() { return as_cut_ ? &*as_cut_ : nullptr; }
  double seconds() const {
    double sum = 0;
    for (double s : seconds_) sum += s;
    return sum;
  }
  double slowest() const { return *std::max_element(seconds_.begin(), seconds_.end()); }
  double estimated() const { return estimated_; }
  double estimated_now() const { return estimated_now_; }
  double watching() const { return watching_ / seconds(); }
  Index moved() const { return moved_; }
  double expanded() const { return expanded_ / double(seconds_.size()); }

 private:
  World<float> world_;
  std::optional<World<float>> as_cut_;
  std::vector<std::uint8_t> lives_;  // per tetrahedron, as far as as_cut_ knows
  std::optional<LinearityWatch<float>> watch_;
  std::optional<MassWatch<float>> mass_watch_;
  std::optional<ReducedWatch<float>> reduced_watch_;
  std::vector<double> seconds_;  // per frame
  double estimated_ = 0, estimated_now_ = 0, watching_ = 0;
  Index moved_ = 0;
  int expanded_ = 0;  // frames, or of lumped masses
};

// √Σ m |u|² over the vertices that both still have.
double norm(World<float>& exact, World<float>& other, const std::vector<double>& mass, bool difference) {
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

// Of those that can be: what is held belongs to the interface of a frame, and may be too much.
std::vector<std::unique_ptr<Player>> players_of(std::vector<Making>& list) {
  std::vector<std::unique_ptr<Player>> players;
  std::vector<Making> played;
  for (Making& making : list) {
    try {
      players.push_back(std::make_unique<Player>(making));
      played.push_back(std::move(making));
    } catch (const InputError&) {
      if (making.setup.precomputed_frame != RegionFrame::corotated) throw;
    }
  }
  list = std::move(played);
  return players;
}

std::vector<GestureRow> play(const Scene& scene, const Resolved& resolved, double tolerance,
                             bool only_reduced) {
  std::vector<Trial> trials;
  std::vector<Making> list{{"nonlinear", all_nonlinear(resolved.setup), false, false, tolerance}};
  if (!only_reduced) {
    const std::vector<Gesture> gestures =
        resolved.gestures.empty() ? usual_gestures(resolved.setup) : resolved.gestures;
    trials = solve_trials(resolved.setup, gestures);
    for (Making& making : makings(resolved.setup, gestures, trials, tolerance))
      list.push_back(std::move(making));
  }
  const Setup reduced = all_reduced(resolved.setup);
  list.push_back({"reduced", reduced, false, false, tolerance});
  list.push_back({"reduced-corrected", reduced, false, true, tolerance});
  if (only_reduced) list.push_back({"reduced-corrected", reduced, false, true, tolerance / 2});
  const std::vector<std::unique_ptr<Player>> players = players_of(list);
  const std::vector<double> mass = players[0]->world().body().inertia.mass();
  const int frames = static_cast<int>(std::lround(scene.time.duration / scene.time.frame));
  for (std::size_t p = 1; only_reduced && p < players.size(); ++p) players[p]->follow_cuts(list[0].setup);
  std::vector<GestureRow> rows(list.size());
  double largest = 0;
  for (int i = 0; i < frames; ++i) {
    for (const auto& player : players) player->advance(scene.time.frame);
    for (const auto& player : players) player->advance_as_cut(scene.time.frame);
    largest = std::max(largest, norm(players[0]->world(), players[0]->world(), mass, false));
    for (std::size_t p = 1; p < players.size(); ++p) {
      const double of_all = norm(players[0]->world(), players[p]->world(), mass, true) / largest;
      rows[p].mean_error += of_all / frames;
      rows[p].largest_error = std::max(rows[p].largest_error, of_all);
      World<float>* as_cut = players[p]->as_cut();  // what an estimate may know of
      const double error = as_cut ? norm(*as_cut, players[p]->world(), mass, true) / largest : of_all;
      rows[p].mean_same_cut += error / frames;
      const double ratio = players[p]->estimated_now() / error;
      if (error > 0.007) {
        ++rows[p].wrong;
        rows[p].beyond += ratio > 3 || 3 * ratio < 1;
      }
      if (error > rows[p].largest_same_cut) rows[p].ratio_at_worst = ratio;
      rows[p].largest_same_cut = std::max(rows[p].largest_same_cut, error);
    }
  }
  for (std::size_t p = 0; p < players.size(); ++p) {
    const std::vector<RegionModel>& region_of = list[p].setup.region_of;
    rows[p].regions = list[p].name;
    rows[p].tolerance = list[p].tolerance;
    rows[p].static_error = worst_error(region_of, trials);
    rows[p].tets = static_cast<Index>(region_of.size());
    rows[p].linear_share =
        double(std::count_if(region_of.begin(), region_of.end(), is_linear)) / double(region_of.size());
    rows[p].speedup = players[0]->seconds() / players[p]->seconds();
    rows[p].worst_frame = players[p]->slowest() / players[0]->slowest();
    rows[p].estimated = players[p]->estimated();
    rows[p].watching = players[p]->watching();
    rows[p].moved = players[p]->moved();
    rows[p].expanded = players[p]->expanded();
  }
  return rows;
}

// Grasps move the other way.
Scene reversed(Scene scene) {
  for (Tool& tool : scene.tools)
    if (tool.is<GraspSetup>())
      for (PathPoint& point : tool.path()) point.position = -point.position;
  return scene;
}

void print(const GestureRow& r) {
  std::printf(
      "%-16s %7d %6.3f %-24s %7.2f %9.4f %8.2f %8.2f %9.4f %9.4f %9.4f %6.2f %8.3f %7d %8.2f %4d %4d\n",
      r.scene.c_str(), r.tets, r.tolerance, r.regions.c_str(), r.linear_share, r.static_error, r.speedup,
      r.worst_frame, r.mean_error, r.largest_error, r.estimated, r.ratio_at_worst, r.watching, r.moved,
      r.expanded, r.wrong, r.beyond);
  std::fflush(stdout);
}

std::string csv(const std::vector<GestureRow>& rows) {
  std::ostringstream out;
  out << "scene,tets,regions,linear_share,speedup,worst_frame,mean_error,largest_error,estimated_error,"
         "watching,moved,expanded,tolerance,static_error,ratio_at_worst,"
         "frames_wrong,frames_beyond,largest_same_cut,mean_same_cut\n"
      << std::setprecision(4);
  for (const GestureRow& r : rows)
    out << r.scene << ',' << r.tets << ',' << r.regions << ',' << r.linear_share << ',' << r.speedup << ','
        << r.worst_frame << ',' << r.mean_error << ',' << r.largest_error << ',' << r.estimated << ','
        << r.watching << ',' << r.moved << ',' << r.expanded << ',' << r.tolerance << ',' << r.static_error
        << ',' << r.ratio_at_worst << ',' << r.wrong << ',' << r.beyond << ',' << r.largest_same_cut << ','
        << r.mean_same_cut << '\n';
  return out.str();
}

// Two plots beside each other, one per scene. Lines lead from tolerance 1 % over 2 % to 5 % and carry their
// name; grey ones are in the table.
constexpr const char* gestures_plot = R"(set terminal pngcairo noenhanced size 1300,560 font 'sans,10'
set output 'gestures.png'
set yrange [0.03:50]
set xrange [0:3.6]
set datafile separator ','
set datafile missing NaN
set logscale y
set grid lc '#dddddd'
unset key
set xlabel 'speed-up of all frames over all non-linear'
set ylabel 'largest error of any frame [%]'
regions = "proposed proposed-corrected precomputed-alone precomputed-corrected selective-mass-alone \
selective-mass-corrected"
others = "reduced reduced-corrected strain-recipe proposed-precomputed all-linear-corrected precomputed-in-frame"
colours = "#d95f02 #e7298a #8da0cb #7570b3 #66c2a5 #1b9e77"
series(i, r) = strcol(1) eq word(scenes, i) && strcol(2) eq word(own, i) && strcol(3) eq r ? column(5) : NaN
at(i, r, tolerance) = column(13) == tolerance ? series(i, r) : NaN
# Where names would lie upon each other they are moved by a factor of the error.
move(j) = j == 1 ? 1.25 : j == 2 ? 0.8 : j == 3 ? 1.4 : j == 4 ? 0.8 : j == 5 ? 1.4 : 1
set multiplot layout 1,2
do for [i=1:words(scenes)] {
  set title word(scenes, i)
  plot for [j=1:words(others)] 'gestures.csv' using (series(i, word(others, j))):(100 * $8) \
    with linespoints lc '#cccccc' pt 7 ps 0.6, \
    for [j=1:words(regions)] '' using (series(i, word(regions, j))):(100 * $8) \
    with linespoints lc rgb word(colours, j) pt 7 ps 1.2 lw 2, \
    for [j=1:words(regions)] '' using (at(i, word(regions, j), 0.05)):(100 * $8 * move(j)):('  '.word(regions, j)) \
    with labels left textcolor rgb word(colours, j)
}
unset multiplot
)";

}  // namespace

std::string bench_gestures(const Options& options) {
  std::printf("\n%-16s %7s %6s %-22s %7s %9s %8s %8s %9s %9s %9s %6s %8s %7s %8s %4s %4s\n", "scene", "tets",
              "tol", "regions", "linear", "static", "speed-up", "slowest", "mean err", "largest", "estimate",
              "ratio", "watching", "moved", "expanded", "off", "> 3");
  std::vector<std::filesystem::path> scenes = options.scenes;
  if (scenes.empty())
    for (const char* name : {"liver_declared.json", "liver_undeclared.json"})
      scenes.push_back(std::filesystem::path(LOBE_DATA_DIR) / "scenes" / name);
  if (options.quick) scenes.resize(1);
  if (options.reduced && options.scenes.empty()) {
    scenes.erase(scenes.begin());  // the same, declared
    scenes.push_back(std::filesystem::path(LOBE_DATA_DIR) / "scenes" / "kidney_undeclared.json");
  }
  std::vector<GestureRow> all;
  std::string names, own;
  const auto play_all = [&](const Scene& scene, const std::string& name) {
    names += name + " ";
    std::vector<std::filesystem::path> meshes = {mesh_path(scene)};
    if (!options.scenes.empty() || name.starts_with("liver"))  // shipped scenes: --mesh is another liver
      meshes.insert(meshes.end(), options.meshes.begin(), options.meshes.end());
    for (const std::filesystem::path& mesh : meshes) {  // its own is drawn
      const Resolved resolved = resolve(scene, read_mesh(mesh).mesh, {false});
      const bool is_own = mesh == meshes.front();
      if (is_own) own += std::to_string(resolved.setup.mesh.tet_count()) + " ";
      const bool is_one = options.quick || options.reduced || !is_own;
      for (double tolerance : is_one ? std::vector{0.02} : std::vector{0.01, 0.02, 0.05})
        for (GestureRow row : play(scene, resolved, tolerance, options.reduced)) {
          row.scene = name;
          print(row);
          all.push_back(row);
        }
    }
  };
  for (const std::filesystem::path& path : scenes) {
    const Scene scene = read_scene(path);
    if (!scene.auto_regions) continue;
    play_all(scene, path.stem().string());
    if (options.reduced) play_all(reversed(scene), path.stem().string() + "_reversed");
  }
  if (all.empty()) return "";
  io::write_file(options.output / (options.reduced ? "reduced.csv" : "gestures.csv"), csv(all));
  return "scenes = \"" + names + "\"\nown = \"" + own + "\"\n" + gestures_plot;
}

}  // namespace lobe::bench
