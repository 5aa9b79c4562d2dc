// lobe bench palpation: what a finger feels over a tumour below the surface of a liver, beside it, and at the
// same places of a liver without it. It plays data/scenes/liver_palpation.json.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <sstream>

#include "benchmarks/benchmarks.h"
#include "benchmarks/machine.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/scene/frames.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/sim/world.h"

namespace lobe::bench {
namespace {

// In a CSV without quotes, and in the plot.
const char* const places[] = {"right of the tumour", "over the tumour", "left of the tumour"};
constexpr double resolution = 0.5e-3, deepest = 7e-3;  // of the table [m]

struct Felt {
  double depth = 0, force = 0;  // how far the finger is below where it touched first [m]; [N]
};

struct Press {
  double from = 0, to = 0;  // [s]
  std::vector<Felt> felt;

  double force_at(double depth) const {
    const auto after =
        std::find_if(felt.begin(), felt.end(), [&](const Felt& f) { return f.depth >= depth; });
    if (after == felt.end() || after == felt.begin()) return after == felt.end() ? NAN : after->force;
    const Felt before = *(after - 1);
    return before.force +
           (depth - before.depth) / (after->depth - before.depth) * (after->force - before.force);
  }
};

// Where a path goes straight down.
std::vector<Press> presses_of(const std::vector<PathPoint>& path) {
  std::vector<Press> presses;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Vec3d way = path[i].position - path[i - 1].position;
    if (way.head<2>().isZero(0) && way.z() < 0) presses.push_back({path[i - 1].time, path[i].time, {}});
  }
  return presses;
}

// The force is the mean of a frame, and so is the place.
std::vector<Press> play(const Scene& scene, const Setup& setup) {
  const std::vector<PathPoint>& path = setup.probes.at(0).path;
  std::vector<Press> presses = presses_of(path);
  World<float> world(setup);
  const Frames frames = frames_of(scene.time);
  for (int i = 0; i < frames.count; ++i) {
    const double time = world.time();
    if (!world.advance(frames.length).ok) throw WrongResult("palpation: the run did not go well");
    const double force = world.tools().lists().probes.front().force.norm();
    for (Press& press : presses) {
      if (time < press.from - frames.length / 2 || time > press.to - frames.length / 2) continue;
      const double height = path_at(path, time + frames.length / 2).z();
      if (force > 0) press.felt.push_back({-height, force});
    }
  }
  std::erase_if(presses, [](const Press& press) { return press.felt.empty(); });  // only comes nearer
  for (Press& press : presses) {
    const double touch = press.felt.front().depth;
    for (Felt& felt : press.felt) felt.depth -= touch;
  }
  return presses;
}

const char* const palpation_plot = R"gp(set terminal pngcairo noenhanced size 900,560 font 'sans,11'
set output 'palpation.png'
set datafile separator ','
set datafile missing NaN
set grid
set key top left
set xlabel 'indentation [mm]'
set ylabel 'force on the finger [N]'
places = "'right of the tumour' 'over the tumour' 'left of the tumour'"
colours = '#0060ad #c02020 #2a8a3a'
of(place, tumour) = strcol(1) eq place && strcol(2) eq tumour ? column(4) : NaN
plot for [i=1:3] 'palpation.csv' using 3:(of(word(places, i), 'yes')) with linespoints pt 7 ps 0.7 lw 2 \
    lc rgb word(colours, i) title word(places, i), \
  for [i=1:3] '' using 3:(of(word(places, i), 'no')) with lines dt 2 lw 2 lc rgb word(colours, i) \
    title word(places, i).', without a tumour'
)gp";

}  // namespace

void bench_palpation(const Options& options) {
  begin_results(options.output, "palpation");
  const Scene scene = read_scene(std::filesystem::path(LOBE_DATA_DIR) / "scenes" / "liver_palpation.json");
  Setup setup = resolve(scene, read_mesh(mesh_path(scene)).mesh).setup;
  std::ostringstream csv;
  csv << "place,tumour,indentation_mm,force_N\n" << std::setprecision(4);
  std::printf("\n%-32s %-8s %s\n", "place", "tumour", "force at 7 mm [N]");
  double over = 0, most_else = 0;
  for (bool tumour : {true, false}) {
    if (!tumour)  // all are of the last material, the tissue
      std::fill(setup.material_of.begin(), setup.material_of.end(), int(setup.materials.size()) - 1);
    const std::vector<Press> presses = play(scene, setup);
    if (presses.size() != std::size(places)) throw WrongResult("palpation: the scene has not three presses");
    for (std::size_t i = 0; i < presses.size(); ++i) {
      for (double depth = 0; depth <= deepest + resolution / 2; depth += resolution)
        csv << places[i] << ',' << (tumour ? "yes" : "no") << ',' << 1e3 * depth << ','
            << presses[i].force_at(depth) << '\n';
      const double force = presses[i].force_at(deepest);
      std::printf("%-32s %-8s %.2f\n", places[i], tumour ? "yes" : "no", force);
      tumour&& i == 1 ? over = force : most_else = std::max(most_else, force);
    }
  }
  std::printf("over the tumour the force is at least %.2f times that of any other place\n", over / most_else);
  if (!(over > most_else)) throw WrongResult("palpation: the tumour is not felt");
  io::write_file(options.output / "palpation.csv", csv.str());
  io::write_file(options.output / "palpation.gp", palpation_plot);
}

}  // namespace lobe::bench
