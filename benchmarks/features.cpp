// lobe bench features: what each option costs where a scene asks for it, beside a scene that asks for
// nothing.
#include <cmath>
#include <cstdio>
#include <functional>
#include <iomanip>
#include <memory>
#include <sstream>

#include "benchmarks/benchmarks.h"
#include "benchmarks/frames.h"
#include "benchmarks/kernel_cases.h"
#include "benchmarks/machine.h"
#include "benchmarks/timing.h"
#include "lobe/file/atomic_file.h"
#include "lobe/forces/embedded.h"
#include "lobe/run/recording.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/world.h"

namespace lobe::bench {
namespace {

using Frame = std::function<void(double duration)>;
using WorldPointer = std::shared_ptr<World<float>>;

struct Feature {
  const char* name;
  const char* what;
  std::function<void(Setup&)> ask = [](Setup&) {};
  std::function<Frame(const WorldPointer&)> play = [](const WorldPointer& world) -> Frame {
    return [world](double duration) { world->advance(duration); };
  };
};

constexpr double later = 1e6;  // [s]: tools that wait

void add_grasp(Setup& setup, double start) {
  GraspSetup grasp{"grasp", {}, {{start, Vec3d::Zero()}, {later + 1, Vec3d::Zero()}}, false};
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) > 0.99 * cube_edge) grasp.vertices.push_back(v);
  setup.grasps.push_back(grasp);
}

void add_cautery(Setup& setup, const std::vector<PathPoint>& path) {
  setup.cauteries.push_back({"cautery", 0.005, path});
}

void add_loads(Setup& setup) {
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) setup.vertex_loads.push_back({v, {0, 0, -1e-9}});
}

// A row of loops of four bites, 4.5 % of the edge apart, which are drawn together.
void add_stitches(Setup& setup) {
  const Locator locator(setup.mesh);
  for (int i = 0; i < 20; ++i) {
    StitchSetup& stitch = setup.stitches.emplace_back();
    stitch.name = "stitch " + std::to_string(i + 1);
    for (const Vec3d& place :
         {Vec3d(0.45, 0, 0.98), Vec3d(0.48, 0, 0.95), Vec3d(0.52, 0, 0.95), Vec3d(0.55, 0, 0.98)})
      stitch.bites.push_back(embed(locator, cube_edge * (place + Vec3d(0, 0.07 + 0.045 * i, 0))).point);
    stitch.ties.push_back({0, 3, 0, 0.03 * cube_edge, 0.1});
  }
}

Frame recorded(const WorldPointer& world) {
  const auto recorded = std::make_shared<CommandRecorder<float>>(*world);
  return [world, recorded](double duration) { recorded->advance(duration); };
}

Frame kept_in_a_ring(const WorldPointer& world) {
  const auto ring = std::make_shared<CheckpointRing<float>>(10, 0.0);
  return [world, ring](double duration) {
    world->advance(duration);
    ring->keep(*world);
  };
}

const std::vector<Feature>& features() {
  static const std::vector<Feature> list{
      {"nothing", "the plain scene against itself: what cannot be told from noise"},
      {"volume_penalty", "a term per tetrahedron", [](Setup& s) { s.volume_penalty = 1e5; }},
      {"guard", "no tetrahedron near it", [](Setup& s) { s.guard_below = 0.2; }},
      {"nodal_pressure", "averaged around vertices", [](Setup& s) { s.materials[0].nodal_pressure = 1; }},
      {"edge-smoothed", "strains averaged around edges",
       [](Setup& s) { s.materials[0].element = ElementType::edge_smoothed; }},
      {"edge-smoothed with volume_penalty", "with a term per tetrahedron, too",
       [](Setup& s) {
         s.materials[0].element = ElementType::edge_smoothed;
         s.volume_penalty = 1e5;
       }},
      {"edge-smoothed with nodal_pressure", "pressure averaged around vertices, the rest around edges",
       [](Setup& s) {
         s.materials[0].element = ElementType::edge_smoothed;
         s.materials[0].nodal_pressure = 1;
       }},
      {"damping", "", [](Setup& s) { s.damping = 5; }},
      {"gravity", "too weak to move anything far",
       [](Setup& s) {
         s.gravity = {0, 0, -1e-6};
       }},
      {"dead loads", "on every vertex", add_loads},
      {"growing dead loads", "the same",
       [](Setup& s) {
         add_loads(s);
         s.load_ramp = later;
       }},
      {"selective mass", "degree 9: far fewer steps, each dearer", [](Setup& s) { s.selective_mass = 9; }},
      {"sleep", "of a body at rest", [](Setup& s) { s.sleep = 1e-6; }},
      {"grasp", "of one side", [](Setup& s) { add_grasp(s, 0); }},
      {"waiting grasp", "", [](Setup& s) { add_grasp(s, later); }},
      {"waiting cautery", "",
       [](Setup& s) {
         add_cautery(s, {{later, Vec3d::Zero()}, {later + 1, Vec3d::Ones()}});
       }},
      {"far cautery", "ten radii from the body",
       [](Setup& s) {
         add_cautery(s, {{0, {-0.05, 0, 0}}, {later, {-0.05, 0.1, 0}}});
       }},
      {"20 stitches", "loops of four bites, tightened, side by side", add_stitches},
      {"recording", "a digest of the state per frame", [](Setup&) {}, recorded},
      {"checkpoint ring", "a copy of the state per frame", [](Setup&) {}, kept_in_a_ring},
  };
  return list;
}

struct FeatureRow {
  const Feature* feature;
  Index tets = 0;
  double off = 0, on = 0;  // ns per tetrahedron and plain step
  double spread = 0;       // of the samples: how quiet the machine was
};

constexpr int steps_per_frame = 50;

// Frames of the same duration for both, so that longer steps show.
FeatureRow measure(const Feature& feature, const Setup& plain, const Sampling& sampling) {
  Setup setup = plain;
  feature.ask(setup);
  const auto off = std::make_shared<World<float>>(plain), on = std::make_shared<World<float>>(setup);
  const double duration = (steps_per_frame - 0.5) * plain.safety * off->time_step_limit();
  const Frame play_on = feature.play(on);
  const auto samples =
      sample_in_turn({{[&] { off->advance(duration); }}, {[&] { play_on(duration); }}}, sampling);
  const double per = 1e9 / plain.mesh.tet_count() / steps_per_frame;
  return {&feature, plain.mesh.tet_count(), per * median(samples[0]), per * median(samples[1]),
          relative_spread(samples[1])};
}

std::string csv(const std::vector<FeatureRow>& rows) {
  std::ostringstream out;
  out << "feature,tets,off_ns_per_tet,on_ns_per_tet,ratio,spread\n" << std::setprecision(4);
  for (const FeatureRow& r : rows)
    out << r.feature->name << ',' << r.tets << ',' << r.off << ',' << r.on << ',' << r.on / r.off << ','
        << r.spread << '\n';
  return out.str();
}

std::string markdown(const std::vector<FeatureRow>& rows, const std::string& machine) {
  std::ostringstream out;
  out << machine << "\n\n| feature | what | off | on | on / off | spread |\n|---|---|---|---|---|---|\n"
      << std::fixed << std::setprecision(2);
  for (const FeatureRow& r : rows)
    out << "| " << r.feature->name << " | " << r.feature->what << " | " << r.off << " | " << r.on << " | "
        << std::setprecision(3) << r.on / r.off << " | " << r.spread << std::setprecision(2) << " |\n";
  return out.str();
}

}  // namespace

void bench_features(const Options& options) {
  const Setup plain = cube_setup(options.tets.empty() ? 48000 : options.tets.front());
  const Sampling sampling = options.quick ? Sampling{5, 0.01} : Sampling{};
  const std::string machine = begin_results(options.output, "features");
  std::printf("\n%-20s %10s %10s %8s %8s\n", "feature", "off ns/tet", "on ns/tet", "on/off", "spread");
  std::vector<FeatureRow> rows;
  for (const Feature& feature : features()) {
    const FeatureRow& r = rows.emplace_back(measure(feature, plain, sampling));
    std::printf("%-20s %10.2f %10.2f %8.3f %8.3f\n", feature.name, r.off, r.on, r.on / r.off, r.spread);
    std::fflush(stdout);
  }
  io::write_file(options.output / "features.csv", csv(rows));
  io::write_file(options.output / "features.md",
                 "# Features: what each option costs\n\n" + markdown(rows, machine));
  Setup liver = liver_setup();
  liver.gravity = {0, 0, -3};
  liver.damping = 20;
  const std::vector<FrameCost> costs = frame_costs(liver, options.quick ? 0.05 : 0.5);
  print(costs, "liver_10k");
  io::write_file(options.output / "frames.csv", csv(costs, "liver_10k"));
}

}  // namespace lobe::bench
