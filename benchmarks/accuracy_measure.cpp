// Plays the scenes of `lobe bench accuracy` in all ways.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <thread>

#include "benchmarks/accuracy.h"
#include "benchmarks/accuracy_error.h"
#include "benchmarks/accuracy_models.h"
#include "lobe/scene/resolve.h"

namespace lobe::bench {
namespace {

constexpr double safeties[] = {0.9, 0.45};  // of the time step
// Of the references: first, and halved, which is what errors are measured against. The change between the two bounds
// what further halving would change. On the fine mesh the error of interest is that of space, hence larger steps.
constexpr double model_safety[] = {0.225, 0.1125}, total_safety[] = {0.9, 0.45};

// References are not timed, and have the same bits on any number of threads.
int reference_threads() { return std::clamp(int(std::thread::hardware_concurrency()), 1, 4); }

struct Reference {
  Setup setup;
  Samples samples;
  double change = 0;  // when the steps were halved, relative
};

Reference make_reference(Setup setup, const Gesture& gesture, const double (&safety)[2]) {
  Reference reference{reference_setup(std::move(setup)), {}, 0};
  reference.samples = play_reference(reference.setup, gesture, safety[1], reference_threads());
  const Samples before = play_reference(reference.setup, gesture, safety[0], reference_threads());
  reference.change = ErrorNorm(reference.setup).relative(before, reference.samples);
  return reference;
}

// Tools that cut are left out: the comparison is of models.
Setup setup_on(const Scene& scene, TetMesh mesh) {
  Setup setup = resolve(scene, std::move(mesh)).setup;
  setup.cauteries.clear();
  return setup;
}

Reference fine_reference(const Case& scene, const Gesture& gesture) {
  const TetMesh& largest = scene.meshes.back();
  RefinedMesh refined = refine(largest);
  const Scene fine = prolongated(scene.scene, largest, refined);
  return make_reference(setup_on(fine, std::move(refined.mesh)), gesture, total_safety);
}

std::vector<std::string> warnings_of(const Case& scene) {
  std::vector<std::string> warnings;
  for (const Tool& tool : scene.scene.tools)
    if (tool.type == ToolType::cautery)
      warnings.push_back("the tool " + tool.name + " is left out: nothing is cut in this comparison");
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

// The references that runs on one mesh are compared with.
struct Against {
  const Reference& model;
  ErrorNorm model_norm;
  const Reference* total = nullptr;  // none: not comparable
  std::unique_ptr<ErrorNorm> total_norm;

  Against(const Reference& model_reference, const Reference* total_reference, const TetMesh& mesh)
      : model(model_reference), model_norm(model.setup), total(total_reference) {
    if (total) total_norm = std::make_unique<ErrorNorm>(total->setup, mesh);
  }

  void set_errors(const Played& played, AccuracyRow& row) const {
    row.model_reference_change = model.change;
    row.has_total = total != nullptr;
    if (total) row.total_reference_change = total->change;
    if (!played.to_the_end) return;
    row.error_model = three_digits(model_norm.relative(played.samples, model.samples));
    if (total) row.error_total = three_digits(total_norm->relative(played.samples, total->samples));
  }
};

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

Accuracy measure_accuracy(const Case& scene, int threads, void (*show)(const AccuracyRow&)) {
  const Gesture gesture = gesture_of(scene.scene.time);
  Accuracy accuracy{{}, warnings_of(scene)};
  const Reference total = fine_reference(scene, gesture);
  const bool only_largest = selects_by_number(scene.scene);
  for (const TetMesh& mesh : scene.meshes) {
    const bool comparable = !only_largest || &mesh == &scene.meshes.back();
    const Setup setup = setup_on(scene.scene, mesh);
    const Reference model_reference = make_reference(setup, gesture, model_safety);
    const Against against(model_reference, comparable ? &total : nullptr, mesh);
    for (const Model& model : make_models(setup, accuracy.warnings))
      for (const Precision precision : {Precision::single_precision, Precision::double_precision})
        for (const double safety : safeties) {
          const Way way{precision, safety, threads};
          const Played played = play(model.setup, gesture, way);
          AccuracyRow row = row_of(model, way, played);
          row.scene = scene.name;
          against.set_errors(played, row);
          if (show) show(row);
          accuracy.rows.push_back(std::move(row));
        }
  }
  auto& warnings = accuracy.warnings;  // those of every mesh once
  std::sort(warnings.begin(), warnings.end());
  warnings.erase(std::unique(warnings.begin(), warnings.end()), warnings.end());
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
