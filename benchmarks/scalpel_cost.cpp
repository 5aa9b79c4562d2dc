// What a blade costs per tetrahedron that it cuts and per frame, and what a step costs afterwards.
#include <algorithm>
#include <cstdio>
#include <iomanip>
#include <limits>
#include <memory>
#include <set>
#include <sstream>

#include "benchmarks/machine.h"
#include "benchmarks/scalpel.h"
#include "benchmarks/timing.h"
#include "lobe/sim/rebuild.h"

namespace lobe::bench {
namespace {

Vec3d normal_of(const FullStroke& stroke) {
  return (stroke.from.heel - stroke.from.tip).cross(stroke.to.tip - stroke.from.tip).normalized();
}

// What the stroke parts is held on both of its sides: a half that nothing holds would fall, and become
// non-linear for that.
Setup held_on_both_sides(Setup setup, const FullStroke& stroke) {
  constexpr double share = 0.05;  // of the body's width
  const Eigen::RowVectorXd along = normal_of(stroke).transpose() * setup.mesh.points;
  const double low = along.minCoeff(), high = along.maxCoeff(), deep = share * (high - low);
  setup.prescribed.clear();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (along[v] < low + deep || along[v] > high - deep) setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

constexpr int repeats = 5;  // of each cut; neighbours on the machine disturb some of them

template <class Measure>
double median_of(Measure&& measure, int count = repeats) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(measure());
  std::sort(values.begin(), values.end());
  return median(values);
}

// Plays the cut in several worlds, which do the same to the bit.
struct PlayedCut {
  PlayedCut(const Setup& setup, int count, int worlds = repeats) {
    std::vector<double> per_frame_of, slowest_of;
    seconds = median_of(
        [&] {
          world = std::make_unique<World<float>>(setup);
          const CutFrames played = play_cut(*world, count);
          frames = played.frames;
          per_frame_of.push_back(played.cutting / std::max(1, frames));
          slowest_of.push_back(played.slowest);
          return played.seconds;
        },
        worlds);
    std::sort(slowest_of.begin(), slowest_of.end());
    slowest = median(slowest_of);
    std::sort(per_frame_of.begin(), per_frame_of.end());
    per_frame = median(per_frame_of);
  }
  std::unique_ptr<World<float>> world;  // the last one
  double seconds = 0;                   // medians [s]
  double per_frame = 0, slowest = 0;    // of frames that open something
  int frames = 0;                       // of these
};

// Tetrahedra of the start that there are several grains of.
Index cut_tets(const World<float>& world) {
  if (!world.grains()) return 0;
  const Grains& grains = *world.grains();
  const Topology& topology = world.elements().topology;
  std::set<Index> once, cut;
  for (Index g = 0; g < grains.count(); ++g)
    if (const Index parent = topology.parent(grains[g].element); !once.insert(parent).second)
      cut.insert(parent);
  return static_cast<Index>(cut.size());
}

// During seven full cuts beside each other that follow a first one [bytes per cut tetrahedron]: vertices,
// copies, grains, the record of the cuts, and the room to spare of lists that have grown.
double allocated_by_cuts(Setup setup, const FullStroke& stroke, int frames) {
  constexpr int cuts = 8;
  const Vec3d normal = normal_of(stroke);
  const Eigen::RowVectorXd across = normal.transpose() * setup.mesh.points;
  const double width = across.maxCoeff() - across.minCoeff();
  for (int i = 0; i < cuts; ++i) {
    const Vec3d aside = width * (0.1 * i - 0.35) * normal;
    setup.scalpels.push_back(on_path({{stroke.from.tip + aside, stroke.from.heel + aside},
                                      {stroke.to.tip + aside, stroke.to.heel + aside}},
                                     frames, i * frames));
    setup.scalpels.back().name = "cut " + std::to_string(i);
  }
  World<float> world(setup);
  play_cut(world, frames);
  const Index cut = cut_tets(world);
  const double before = allocated_bytes();
  play_cut(world, (cuts - 1) * frames);
  return (allocated_bytes() - before) / (cut_tets(world) - cut);
}

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

double error_of(World<float>& world, const std::string& name) {
  State<float> state = world.state();
  state.u.setRandom();
  state.u *= 1e-4F;
  world.set_state(state);
  const double error = compare_with_rebuilt(world).largest();
  if (!(error <= 1e-5)) throw WrongResult(name + ": the cut world deviates from one built afresh");
  return error;
}

}  // namespace

FullStroke full_stroke(const TetMesh& mesh, Vec3d normal) {
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

ScalpelSetup on_path(const FullStroke& stroke, int frames, int first) {
  return {"blade",
          0.1,
          {{(first + 0.5) * cut_frame, stroke.from.tip}, {(first + frames + 0.5) * cut_frame, stroke.to.tip}},
          {stroke.from.heel, stroke.to.heel}};
}

CostRow measure_costs(const std::string& name, const char* region, const Setup& held_on_one_side) {
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
  row.cut = cut_tets(world);
  row.frames = cut.frames;
  row.copies = world.elements().topology.tet_copy_count();
  row.all_us = 1e6 * cut.seconds / row.cut;
  row.geometry_us = 1e6 * median_of([&] { return geometry_seconds(plain, stroke, frames); }) / row.cut;
  row.sweep_us = 1e6 * median_of([&] { return geometry_seconds(plain, stroke, 1); }) / row.cut;
  setup.scalpels = {on_path(stroke, 1)};
  const PlayedCut batch(setup, 1);
  row.batch_us = 1e6 * batch.seconds / cut_tets(*batch.world);
  const std::size_t before = Grains(World<float>(plain).elements()).bytes();
  row.bytes = double(world.grains()->bytes() - before) / row.cut;
  row.world_bytes = allocated_by_cuts(plain, stroke, frames);
  find_ratios_of_steps(plain, world, loose, row);
  row.error = error_of(world, name + ", " + region);
  row.blades = measure_short_blades(name, plain, repeats);
  return row;
}

ShortBlades measure_short_blades(const std::string& name, const Setup& whole, int worlds) {
  Setup setup = whole;
  const FullStroke stroke = full_stroke(setup.mesh);
  const Vec3d middle = setup.mesh.points.rowwise().mean(),
              along = (stroke.to.tip - stroke.from.tip).normalized(),
              edge = (stroke.from.heel - stroke.from.tip).normalized();
  const auto play = [&](double length, double way, int frames) {
    const Vec3d half = length / 2 * edge;
    const auto at = [&](double x) { return BladePose{middle + x * along - half, middle + x * along + half}; };
    setup.scalpels = {on_path({at(-way / 2), at(way / 2)}, frames)};
    return PlayedCut(setup, frames, worlds);
  };
  ShortBlades row;
  const PlayedCut slow = play(0.04, 0.05, 30);
  const Index cut = cut_tets(*slow.world);
  row.frame_ms = 1e3 * slow.per_frame;
  row.slowest_ms = 1e3 * slow.slowest;
  row.tet_us = 1e6 * slow.seconds / cut;
  row.tets = double(cut) / std::max(1, slow.frames);
  const double mean_edge = slow.world->grains()->mean_edge();
  constexpr int frames = 150;
  const PlayedCut single = play(2 * mean_edge, 8 * mean_edge, frames);
  const Index alone = cut_tets(*single.world);
  row.single_us = 1e6 * single.seconds / alone;
  row.single_tets = double(alone) / frames;
  row.error = error_of(*slow.world, name);
  return row;
}

double full_cut_us(const Setup& whole) {
  constexpr int frames = 60;
  const FullStroke stroke = full_stroke(whole.mesh);
  Setup setup = held_on_both_sides(whole, stroke);
  setup.scalpels = {on_path(stroke, frames)};
  World<float> world(setup);
  const double seconds = play_cut(world, frames).seconds;
  return 1e6 * seconds / cut_tets(world);
}

void print_head_of_costs() {
  std::printf("\n%-13s %-12s %6s %5s %6s %6s %6s %6s %6s %6s %7s %7s %7s %7s %5s %5s %5s %6s %6s %8s\n",
              "mesh", "region", "tets", "cut", "copies", "frames", "geom.", "all us", "sweep", "batch",
              "single", "tets", "frame", "slowest", "step", "fresh", "loose", "bytes", "world", "error");
}

void print(const CostRow& r) {
  std::printf(
      "%-13s %-12s %6d %5d %6d %6d %6.2f %6.2f %6.2f %6.2f %7.2f %7.2f %7.3f %7.3f %5.2f %5.2f %5.2f %6.0f "
      "%6.0f %8.1e\n",
      r.mesh.c_str(), r.region, r.tets, r.cut, r.copies, r.frames, r.geometry_us, r.all_us, r.sweep_us,
      r.batch_us, r.blades.single_us, r.blades.single_tets, r.blades.frame_ms, r.blades.slowest_ms,
      r.step_ratio, r.fresh_ratio, r.loose_ratio, r.bytes, r.world_bytes, r.error);
  std::fflush(stdout);
}

std::string csv(const std::vector<CostRow>& rows) {
  std::ostringstream out;
  out << "mesh,region,tets,cut,copies,frames,geometry_us,all_us,sweep_us,batch_us,single_us,single_tets,"
         "frame_ms,"
         "slowest_frame_ms,step_ratio,fresh_ratio,loose_ratio,bytes,world_bytes,error\n"
      << std::setprecision(5);
  for (const CostRow& r : rows) {
    out << r.mesh << ',' << r.region;
    for (const double figure :
         {double(r.tets), double(r.cut), double(r.copies), double(r.frames), r.geometry_us, r.all_us,
          r.sweep_us, r.batch_us, r.blades.single_us, r.blades.single_tets, r.blades.frame_ms,
          r.blades.slowest_ms, r.step_ratio, r.fresh_ratio, r.loose_ratio, r.bytes, r.world_bytes, r.error})
      out << ',' << figure;
    out << '\n';
  }
  return out.str();
}

}  // namespace lobe::bench
