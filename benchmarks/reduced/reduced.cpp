// lobe bench reduced: whether a smooth part of a body can be embedded in a coarse lattice. A trial: no world
// has such regions. docs/reduced.md says what was found.
#include <cstdio>
#include <iomanip>
#include <optional>
#include <sstream>

#include "benchmarks/benchmarks.h"
#include "benchmarks/machine.h"
#include "benchmarks/reduced/spectrum.h"
#include "benchmarks/reduced/trial_run.h"
#include "lobe/error.h"
#include "lobe/io/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/refine.h"

namespace lobe::reduced {
namespace {

using bench::Options;

constexpr double lattice_spacing = 0.012;  // of a liver [m]; a kidney is half as wide
constexpr double coarse_spacing = 0.02;    // of meshes below coarse_tets, whose edges are longer than 12 mm
constexpr Index coarse_tets = 5000;
constexpr int modes = 20;
constexpr double own_safety = 0.9, converged_safety = 0.2;  // of lobe's worlds; of references
constexpr Index most_refined = 15000;                       // tetrahedra of meshes that are refined once

struct Name {
  Stiffening stiffening;
  const char* text;
};
constexpr Name names[] = {{Stiffening::none, "one-point"},
                          {Stiffening::fluctuation, "fluctuation"},
                          {Stiffening::galerkin, "galerkin"},
                          {Stiffening::relaxed, "relaxed"},
                          {Stiffening::homogenised, "homogenised"}};
const char* text(Stiffening stiffening) {
  for (const Name& name : names)
    if (name.stiffening == stiffening) return name.text;
  return "";
}

struct Subject {
  std::string mesh;
  Organ organ;
  Body body;
  double ratio;    // λ/μ
  double spacing;  // [m]
};

Subject subject_of(const std::filesystem::path& file, double ratio) {
  const std::string name = file.stem().string();
  const bool is_kidney = name.starts_with("kidney");
  Subject subject{name, is_kidney ? kidney() : liver(), {}, ratio, 0};
  subject.body.mesh = read_mesh(file).mesh;
  const auto tets = std::size_t(subject.body.mesh.tet_count());
  const double spacing = subject.body.mesh.tet_count() < coarse_tets ? coarse_spacing : lattice_spacing;
  subject.spacing = (is_kidney ? 0.6 : 1) * spacing;
  subject.body.mesh.labels.clear();
  subject.body.materials = {{.lambda = ratio * 1e4, .mu = 1e4, .density = 1000}};
  subject.body.material_of.assign(tets, 0);
  subject.body.region_of.assign(tets, RegionModel::nonlinear);
  subject.body.volume_penalty = 1e5;
  const auto held = held_vertices(subject.body, subject.organ);
  if (std::count(held.begin(), held.end(), 1) == 0)
    throw InputError(file.string(),
                     "none of its vertices is where the gestures hold the organ: a mesh of "
                     "data/liver.obj, or of data/kidney.obj if its name begins with `kidney`");
  return subject;
}

// ---- Frequencies at rest

struct FrequencyRow {
  std::string mesh;
  Index tets = 0;
  double ratio = 0, spacing = 0;
  std::size_t cells = 0;
  const char* stiffening = "";
  double first_six = 0, all = 0, mean = 0;  // largest deviations, mean of all with its sign
};

void measure_frequencies(const Subject& subject, std::vector<FrequencyRow>& rows) {
  const Elements elements(subject.body);
  const auto held = held_vertices(subject.body, subject.organ);
  const Lattice lattice = make_lattice(elements, subject.spacing);
  const std::vector<std::uint8_t> all(held.size(), 1), none(held.size(), 0);
  const auto exact = lowest_frequencies(elements, lattice, make_membership(elements, lattice, held, all),
                                        Stiffening::none, modes);
  const Membership embedded = make_membership(elements, lattice, held, none);
  for (Stiffening stiffening :
       {Stiffening::fluctuation, Stiffening::galerkin, Stiffening::relaxed, Stiffening::homogenised}) {
    FrequencyRow row;
    row.mesh = subject.mesh;
    row.tets = subject.body.mesh.tet_count();
    row.ratio = subject.ratio;
    row.spacing = subject.spacing;
    row.cells = lattice.tets.size();
    row.stiffening = text(stiffening);
    const auto found = lowest_frequencies(elements, lattice, embedded, stiffening, modes);
    for (int k = 0; k < modes; ++k) {
      const double deviation = found[k] / exact[k] - 1;
      row.mean += deviation / modes;
      row.all = std::max(row.all, std::abs(deviation));
      if (k < 6) row.first_six = std::max(row.first_six, std::abs(deviation));
    }
    std::printf("%-12s %7d %4.0f %5.1f mm %6zu cells  %-12s %6.2f %6.2f %6.2f\n", row.mesh.c_str(), row.tets,
                row.ratio, 1e3 * row.spacing, row.cells, row.stiffening, 100 * row.first_six, 100 * row.all,
                100 * row.mean);
    std::fflush(stdout);
    rows.push_back(row);
  }
}

std::string csv(const std::vector<FrequencyRow>& rows) {
  std::ostringstream out;
  out << std::setprecision(4)
      << "mesh,tets,lambda_over_mu,spacing,cells,stiffening,first_six,largest_deviation,mean_deviation\n";
  for (const FrequencyRow& r : rows)
    out << r.mesh << ',' << r.tets << ',' << r.ratio << ',' << r.spacing << ',' << r.cells << ','
        << r.stiffening << ',' << r.first_six << ',' << r.all << ',' << r.mean << '\n';
  return out.str();
}

// ---- Gestures

struct Row {
  std::string mesh, gesture;
  Index tets = 0;
  double ratio = 0;
  std::string model;
  double spacing = 0;  // [m]
  Policy policy;
  Played played;
  double speedup = 1, slowest = 1;
  double jump = 0;  // of displacements when embedding, relative to the largest norm of the reference
  Errors same_mesh;
  std::optional<Errors> refined;
};

void print(const Row& r) {
  std::printf(
      "%-12s %7d %-14s %4.0f %-12s %4.1f %4.0f %4.2f %5.1f%% %6.2f %6.2f  %6.2f%% (%.2f s) %5.2f%% %3d",
      r.mesh.c_str(), r.tets, r.gesture.c_str(), r.ratio, r.model.c_str(), 1e3 * r.spacing,
      1e3 * r.policy.margin, r.policy.burst, 100 * r.played.full_share, r.speedup, r.slowest,
      100 * r.same_mesh.largest, r.same_mesh.largest_at, 100 * r.same_mesh.mean, r.same_mesh.above);
  if (r.refined) std::printf("  %6.2f%% %5.2f%%", 100 * r.refined->largest, 100 * r.refined->mean);
  std::printf("\n");
  std::fflush(stdout);
}

std::string csv(const std::vector<Row>& rows) {
  std::ostringstream out;
  out << std::setprecision(4)
      << "mesh,tets,gesture,lambda_over_mu,model,spacing,margin,burst,full_share,speedup,worst_frame,"
         "changing,jump,relaxed,"
         "largest_error,largest_at,mean_error,frames_above,refined_largest,refined_mean\n";
  for (const Row& r : rows) {
    out << r.mesh << ',' << r.tets << ',' << r.gesture << ',' << r.ratio << ',' << r.model << ',' << r.spacing
        << ',' << r.policy.margin << ',' << r.policy.burst << ',' << r.played.full_share << ',' << r.speedup
        << ',' << r.slowest << ',' << r.played.changing / r.played.seconds << ',' << r.jump << ','
        << r.played.transitions.relaxed_vertices << ',' << r.same_mesh.largest << ','
        << r.same_mesh.largest_at << ',' << r.same_mesh.mean << ',' << r.same_mesh.above << ',';
    if (r.refined)
      out << r.refined->largest << ',' << r.refined->mean;
    else
      out << ',';
    out << '\n';
  }
  return out.str();
}

struct Variant {
  Stiffening stiffening;
  Policy policy = {};
  double coarser = 1;  // than the subject's lattice
};

Body refined_once(const Body& body) {
  Body fine = body;
  fine.mesh = refine(body.mesh).mesh;
  fine.material_of.assign(std::size_t(fine.mesh.tet_count()), 0);
  fine.region_of.assign(std::size_t(fine.mesh.tet_count()), RegionModel::nonlinear);
  return fine;
}

void measure_gesture(const Subject& subject, const Gesture& gesture, const std::vector<Variant>& variants,
                     std::vector<Row>& rows) {
  const Index vertices = subject.body.mesh.vertex_count();
  const Policy all_full{.is_reduced = false};
  TrialSettings settings{.spacing = subject.spacing};
  const Played exact =
      play<double>(subject.body, subject.organ, gesture, settings, all_full, converged_safety, vertices);
  std::optional<Played> fine;
  if (subject.body.mesh.tet_count() <= most_refined && subject.ratio == 4)
    fine = play<float>(refined_once(subject.body), subject.organ, gesture, settings, all_full, 0.5, vertices);
  const auto add = [&](const std::string& model, const Policy& policy, Played&& played, const Row* full) {
    Row row;
    row.mesh = subject.mesh;
    row.gesture = gesture.name;
    row.tets = subject.body.mesh.tet_count();
    row.ratio = subject.ratio;
    row.model = model;
    row.policy = policy;
    row.spacing = policy.is_reduced ? settings.spacing : 0;
    double norm = 0;
    for (const auto& frame : exact.frames) norm = std::max(norm, double(frame.norm()));
    row.jump = played.transitions.largest_jump / norm;
    row.same_mesh = compare(played, exact);
    if (fine) row.refined = compare(played, *fine);
    if (full) {
      row.speedup = full->played.seconds / played.seconds;
      row.slowest = played.slowest / full->played.slowest;
    }
    played.frames.clear();
    row.played = std::move(played);
    print(row);
    rows.push_back(row);
  };
  const auto once = [&](const Policy& policy) {
    return play<float>(subject.body, subject.organ, gesture, settings, policy, own_safety, vertices);
  };
  add("nonlinear", all_full, once(all_full), nullptr);
  const Row full = rows.back();
  if (fine) {  // how far the reference is from the refined mesh
    Played same = exact;
    add("converged", all_full, std::move(same), &full);
  }
  for (const Variant& variant : variants) {
    settings.stiffening = variant.stiffening;
    settings.spacing = variant.coarser * subject.spacing;
    add(text(variant.stiffening), variant.policy, once(variant.policy), &full);
  }
}

void run(const Options& options) {
  if (!options.scenes.empty()) throw InputError("bench reduced", "takes --mesh, no --scene");
  bench::begin_results(options.output, "reduced");
  const std::filesystem::path meshes = std::filesystem::path(LOBE_DATA_DIR) / "meshes";
  std::vector<std::filesystem::path> files = options.meshes;
  files.insert(files.begin(), meshes / (options.quick ? "liver_2k.vtu" : "liver_10k.vtu"));
  std::printf("\nlowest %d frequencies at rest: largest deviation of the first six, of all, mean [%%]\n",
              modes);
  std::vector<FrequencyRow> frequencies;
  for (const auto& file : files)
    for (double ratio : {1.0, 4.0, 20.0, 50.0})
      if (ratio == 4 || (!options.quick && file == files.front()))
        measure_frequencies(subject_of(file, ratio), frequencies);
  io::write_file(options.output / "reduced_frequencies.csv", csv(frequencies));
  std::printf("\n%-12s %7s %-14s %4s %-12s %4s %4s %4s %6s %6s %6s  %-16s %6s %3s  %-14s\n", "mesh", "tets",
              "gesture", "l/m", "model", "mm", "rim", "all", "full", "speed", "frame", "largest error",
              "mean", ">2%", "to the refined");
  std::vector<Row> rows;
  for (const auto& file : files) {
    const Subject subject = subject_of(file, 4);
    for (const Gesture& gesture : subject.organ.gestures) {
      std::vector<Variant> variants;
      if (&gesture == &subject.organ.gestures.front())
        for (Stiffening s : {Stiffening::fluctuation, Stiffening::galerkin, Stiffening::homogenised})
          variants.push_back({s});
      for (double burst : {0.0, 0.1, 0.2}) variants.push_back({Stiffening::relaxed, {.burst = burst}});
      variants.push_back({Stiffening::relaxed, {.margin = 0.02}});
      variants.push_back({Stiffening::relaxed, {.burst = 0.2}, 1.25});
      measure_gesture(subject, gesture, variants, rows);
      if (options.quick) break;
    }
  }
  if (!options.quick)
    for (double ratio : {1.0, 20.0, 50.0}) {
      const Subject subject = subject_of(files.front(), ratio);
      measure_gesture(
          subject, subject.organ.gestures.front(),
          {{Stiffening::fluctuation}, {Stiffening::relaxed}, {Stiffening::relaxed, {.burst = 0.2}}}, rows);
    }
  io::write_file(options.output / "reduced.csv", csv(rows));
}

}  // namespace
}  // namespace lobe::reduced

void lobe::bench::bench_reduced(const Options& options) { reduced::run(options); }
