// Plays the scenes of `lobe bench accuracy` in all ways.
#include <memory>

#include "benchmarks/accuracy.h"
#include "benchmarks/accuracy_error.h"
#include "benchmarks/accuracy_models.h"
#include "lobe/scene/resolve.h"

namespace lobe::bench {
namespace {

constexpr double safeties[] = {0.9, 0.45};  // of the time step
// Of the references: first, and halved, which is what errors are measured against. Errors in time shrink with the step,
// so the change between the two bounds what is left; those of space are larger by far, hence the larger steps on the
// fine mesh.
constexpr double model_safety[] = {0.225, 0.1125}, total_safety[] = {0.9, 0.45};

struct Reference {
  Setup setup;
  Samples samples;
  double change = 0;  // when the steps were halved, relative
};

Reference make_reference(Setup setup, const Gesture& gesture, const double (&safety)[2], int threads) {
  Reference reference{reference_setup(std::move(setup)), {}, 0};
  reference.samples = play_reference(reference.setup, gesture, safety[1], threads);
  const Samples before = play_reference(reference.setup, gesture, safety[0], threads);
  reference.change = ErrorNorm(reference.setup).relative(before, reference.samples);
  return reference;
}

// Tools that cut are left out: the comparison is of models.
Setup setup_on(const Scene& scene, TetMesh mesh) {
  Setup setup = resolve(scene, std::move(mesh)).setup;
  setup.cauteries.clear();
  return setup;
}

Reference fine_reference(const Case& scene, const Gesture& gesture, int threads) {
  const TetMesh& largest = scene.meshes.back();
  RefinedMesh refined = refine(largest);
  const Scene fine = prolongated(scene.scene, largest, refined);
  return make_reference(setup_on(fine, std::move(refined.mesh)), gesture, total_safety, threads);
}

std::vector<std::string> warnings_of(const Case& scene) {
  std::vector<std::string> warnings;
  for (const Tool& tool : scene.scene.tools)
    if (tool.type == ToolType::cautery)
      warnings.push_back(scene.name + ": " + (tool.name.empty() ? "a cautery" : tool.name) +
                         " is left out: nothing is cut in this comparison");
  if (scene.meshes.size() > 1 && selects_by_number(scene.scene))
    warnings.push_back(
        scene.name +
        ": selects by number or by count, which means something else on each mesh: error_total "
        "is there for the largest mesh only");
  return warnings;
}

// Plays every model on one mesh.
void measure_mesh(const Case& scene, const TetMesh& mesh, const Gesture& gesture, int threads,
                  const Reference* total, Accuracy& accuracy, void (*show)(const AccuracyRow&)) {
  const Setup setup = setup_on(scene.scene, mesh);
  const Reference model_reference = make_reference(setup, gesture, model_safety, threads);
  const ErrorNorm model_norm(model_reference.setup);
  const auto total_norm = total ? std::make_unique<ErrorNorm>(total->setup, mesh) : nullptr;
  for (const Model& model : make_models(setup, accuracy.warnings))
    for (const Precision precision : {Precision::single_precision, Precision::double_precision})
      for (const double safety : safeties) {
        AccuracyRow row;
        row.scene = scene.name;
        row.model = model.name;
        row.precision = precision == Precision::single_precision ? "single" : "double";
        row.safety = safety;
        row.threads = threads;
        row.tets = mesh.tet_count();
        row.linear_fraction = model.linear_fraction;
        const Played played = play(model.setup, gesture, {precision, safety, threads});
        row.to_the_end = played.to_the_end;
        row.status = played.status;
        row.dt = played.dt;
        row.wall_per_s = played.wall_per_s;
        row.model_reference_change = model_reference.change;
        if (played.to_the_end) {
          row.error_model = model_norm.relative(played.samples, model_reference.samples);
          row.has_total = total != nullptr;
          if (total) {
            row.error_total = total_norm->relative(played.samples, total->samples);
            row.total_reference_change = total->change;
          }
        }
        if (show) show(row);
        accuracy.rows.push_back(std::move(row));
      }
}

}  // namespace

Accuracy measure_accuracy(const Case& scene, int threads, void (*show)(const AccuracyRow&)) {
  const Gesture gesture = gesture_of(scene.scene.time);
  Accuracy accuracy{{}, warnings_of(scene)};
  const Reference total = fine_reference(scene, gesture, threads);
  const bool only_largest = selects_by_number(scene.scene);
  for (const TetMesh& mesh : scene.meshes) {
    const bool comparable = !only_largest || &mesh == &scene.meshes.back();
    measure_mesh(scene, mesh, gesture, threads, comparable ? &total : nullptr, accuracy, show);
  }
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
