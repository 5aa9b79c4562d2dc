// What a blade costs per tetrahedron that it cuts and per frame, and what a step costs afterwards.
#include <algorithm>
#include <cstdio>
#include <iomanip>
#include <limits>
#include <memory>
#include <set>
#include <sstream>

#include "benchmarks/scalpel.h"
#include "benchmarks/timing.h"
#include "lobe/sim/rebuild.h"

namespace lobe::bench {
namespace {

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

ScalpelSetup on_path(const FullStroke& stroke, int frames) {
  return {"blade",
          0.1,
          {{cut_frame / 2, stroke.from.tip}, {cut_frame / 2 + frames * cut_frame, stroke.to.tip}},
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

void print_head_of_costs() {
  std::printf("\n%-13s %-12s %7s %6s %7s %9s %8s %8s %8s %8s %10s %6s %6s %6s %7s %9s\n", "mesh", "region",
              "tets", "cut", "copies", "geom. us", "all us", "sweep us", "batch us", "frame ms", "slowest ms",
              "step", "fresh", "loose", "bytes", "error");
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

}  // namespace lobe::bench
