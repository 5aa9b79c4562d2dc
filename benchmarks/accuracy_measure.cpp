// Plays the scenes of `lobe bench accuracy` in all ways.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "benchmarks/accuracy.h"
#include "benchmarks/accuracy_error.h"
#include "benchmarks/accuracy_models.h"
#include "lobe/scene/prolongated.h"
#include "lobe/scene/resolve.h"
#include "lobe/sort_unique.h"

namespace lobe::bench {
namespace {

constexpr double safeties[] = {0.9, 0.45};  // of the time step
// Of the references: first, and halved, which is what errors are measured against. The change between the two
// bounds what further halving would change. On the fine mesh the error of interest is that of space, hence
// larger steps.
constexpr double model_safety[] = {0.225, 0.1125}, total_safety[] = {0.9, 0.45};

// References are not timed, and have the same bits on any number of threads.
int reference_threads() { return std::clamp(int(std::thread::hardware_concurrency()), 1, 4); }

struct Reference {
  Setup setup;
  Samples samples;
  double change = 0;  // when the steps were halved, relative
};

Reference make_reference(Setup setup, const Schedule& schedule, const double (&safety)[2]) {
  Reference reference{std::move(setup), {}, 0};
  reference.samples = play_reference(reference.setup, schedule, safety[1], reference_threads());
  const Samples before = play_reference(reference.setup, schedule, safety[0], reference_threads());
  reference.change = ErrorNorm(reference.setup).relative(before, reference.samples);
  return reference;
}

// Tools that cut are left out: the comparison is of models.
Setup setup_on(const Scene& scene, TetMesh mesh) {
  Setup setup = resolve(scene, std::move(mesh), {false}).setup;
  auto grasps = std::move(setup.grasps);
  static_cast<ToolSetups&>(setup) = {};
  setup.grasps = std::move(grasps);
  return setup;
}

Setup fine_setup(const Case& scene) {
  const TetMesh& mesh = scene.refine.tet_count() > 0 ? scene.refine : scene.meshes.back();
  RefinedMesh refined = refine(mesh);
  const Scene fine = prolongated(scene.scene, mesh, refined);
  return reference_setup(setup_on(fine, std::move(refined.mesh)));
}

std::vector<std::string> warnings_of(const Case& scene) {
  std::vector<std::string> warnings;
  for (const Tool& tool : scene.scene.tools)
    if (!tool.is<GraspSetup>())
      warnings.push_back("the tool " + tool.name() + " is left out: nothing is cut in this comparison");
  if (scene.meshes.size() > 1 && selects_by_number(scene.scene))
    warnings.push_back(
        "selectors by number or by count mean something else on each mesh: error_total is given for the "
        "largest mesh only");
  return warnings;
}

// Three digits: an error is not known better, and rows that differ by less are equally good.
double three_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return std::strtod(text, nullptr);
}

void set_errors(const ErrorNorm& norm, const Reference& model, const Played& played, AccuracyRow& row) {
  row.model_reference_change = model.change;
  if (played.to_the_end) row.error_model = three_digits(norm.relative(played.samples, model.samples));
}

void set_total_error(const ErrorNorm& norm, const Reference& total, const Played& played, AccuracyRow& row) {
  row.has_total = true;
  row.total_reference_change = total.change;
  if (played.to_the_end) row.error_total = three_digits(norm.relative(played.samples, total.samples));
}

std::vector<Way> ways(int threads, bool in_double) {
  std::vector<Way> all;
  for (const Precision precision : {Precision::single_precision, Precision::double_precision})
    for (const double safety : safeties)
      if (in_double || precision == Precision::single_precision) all.push_back({precision, safety, threads});
  return all;
}

AccuracyRow row_of(const Model& model, const Way& way, const Played& played) {
  AccuracyRow row;
  row.model = model.name;
  row.precision = way.precision == Precision::single_precision ? "single" : "double";
  row.safety = way.safety;
  row.threads = way.threads;
  row.tets = model.setup.mesh.tet_count();
  row.linear_fraction = model.linear_fraction;
  row.to_the_end = played.to_the_end;
  row.status = played.status;
  row.dt = played.dt;
  row.wall_per_s = played.wall_per_s;
  return row;
}

}  // namespace

Accuracy measure_accuracy(const Case& scene, int threads, void (*show)(const AccuracyRow&), bool in_double) {
  const Schedule schedule = schedule_of(scene.scene.time);
  Accuracy accuracy{{}, warnings_of(scene)};
  Setup fine = fine_setup(scene);
  std::vector<Setup> setups;
  std::vector<ErrorNorm> total_norms;  // what cannot be compared is refused before anything is played
  for (const TetMesh& mesh : scene.meshes) {
    setups.push_back(setup_on(scene.scene, mesh));
    total_norms.emplace_back(fine, mesh);
  }
  const Reference total = make_reference(std::move(fine), schedule, total_safety);
  const bool only_largest = selects_by_number(scene.scene);
  for (std::size_t i = 0; i < setups.size(); ++i) {
    const Reference same_mesh = make_reference(reference_setup(setups[i]), schedule, model_safety);
    const ErrorNorm model_norm(same_mesh.setup);
    for (const Model& model : make_models(setups[i], accuracy.warnings))
      for (const Way& way : ways(threads, in_double)) {
        const Played played = play(model.setup, schedule, way, model.is_corrected);
        AccuracyRow row = row_of(model, way, played);
        row.scene = scene.name;
        set_errors(model_norm, same_mesh, played, row);
        if (!only_largest || i + 1 == setups.size()) set_total_error(total_norms[i], total, played, row);
        if (show) show(row);
        accuracy.rows.push_back(std::move(row));
      }
  }
  auto& warnings = accuracy.warnings;  // those of every mesh once
  sort_unique(warnings);
  mark_pareto(accuracy.rows);
  return accuracy;
}

void mark_pareto(std::vector<AccuracyRow>& rows) {
  const auto counts = [](const AccuracyRow& row) { return row.to_the_end && row.has_total; };
  for (AccuracyRow& row : rows) {
    row.pareto = counts(row);
    for (const AccuracyRow& other : rows) {
      const bool as_good = other.wall_per_s <= row.wall_per_s && other.error_total <= row.error_total;
      const bool better = other.wall_per_s < row.wall_per_s || other.error_total < row.error_total;
      if (counts(other) && other.scene == row.scene && as_good && better) row.pareto = false;
    }
  }
}

}  // namespace lobe::bench
