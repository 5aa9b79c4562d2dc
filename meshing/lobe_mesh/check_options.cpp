// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/check_options.h"

#include <algorithm>

#include "lobe/error.h"
#include "lobe/text.h"
#include "lobe_mesh/expected_tets.h"

namespace lobe::meshing {
namespace {

constexpr double most_tets = 20e6;
constexpr double largest_organ = 2;  // [m] across

void check_numbers(const MeshOptions& options, std::vector<Fault>& faults) {
  const auto positive = [&](const std::string& name, double value, bool zero_too = false) {
    if (std::isfinite(value) && (value > 0 || (zero_too && value == 0))) return;
    faults.push_back({name, rounded(value) + (zero_too ? ", must not be negative" : ", must be positive")});
  };
  positive("edge", options.edge, true);  // 0 was replaced before
  for (const auto& [label, edge] : options.label_edges)
    positive("edge of label " + std::to_string(label), edge);
  for (const SizeBall& ball : options.balls) {
    positive("radius of a ball", ball.radius, true);
    positive("edge of a ball", ball.edge);
    if (!ball.centre.allFinite()) faults.push_back({"centre of a ball", "must be finite"});
  }
  positive("growth", options.growth);
  positive("lambda", options.lambda, true);
  positive("mu", options.mu);
  positive("density", options.density);
  positive("time limit", options.time_limit);
  positive("memory limit", options.memory_limit);
  positive("feature angle", options.feature_angle);
  if (options.time_limit > 1e7) faults.push_back({"time limit", "must be at most 1e7 s"});
  if (options.memory_limit > 1e15) faults.push_back({"memory limit", "must be at most 1e15 bytes"});
  if (options.tries < 1 || options.tries > 8) faults.push_back({"tries", "must be from 1 to 8"});
}

std::string labels_of(const Model& model) {
  std::string text;
  for (const int label : model.labels) text += (text.empty() ? "" : ", ") + std::to_string(label);
  return text;
}

void check_labels(const MeshOptions& options, const Model& model, std::vector<Fault>& faults) {
  for (const auto& [label, edge] : options.label_edges) {
    if (model.region_of(label) < 0)
      faults.push_back({"edge of label " + std::to_string(label), "the labels are " + labels_of(model)});
  }
  if (options.mesher != Mesher::tetgen) return;
  if (!options.label_edges.empty() || !options.balls.empty())
    faults.push_back({"--mesher tetgen", "makes edges of one length only: use --mesher cgal for a sizing"});
  if (model.shares_walls())
    faults.push_back({"--mesher tetgen", "does not keep walls that surfaces share: use --mesher cgal"});
  if (model.is_image())
    faults.push_back({"--mesher tetgen",
                      "fills closed surfaces only: use --mesher cgal for a label image and with --voxels"});
}

std::string remedy_for_size(double diagonal) {
  if (diagonal <= largest_organ) return "choose a longer edge (or --scale, if the units are wrong)";
  return "the body is " + rounded(diagonal) +
         " m large; if the file is in millimetres, use --scale 0.001, else choose a longer edge";
}

}  // namespace

void check_options(const MeshOptions& options, const Model& model) {
  std::vector<Fault> faults;
  check_numbers(options, faults);
  check_labels(options, model, faults);
  if (!faults.empty()) throw InputError(std::move(faults));
  const double diagonal = box_diagonal(joined_surface(model.surfaces));
  if (options.edge > diagonal / 2) {
    throw InputError("edge", rounded(options.edge) + " m is too long for a body of " + rounded(diagonal) +
                                 " m: choose at most " + rounded(diagonal / 4));
  }
  const double tets = expected_tets(options, model);
  if (tets > most_tets) {
    throw InputError("edge", rounded(options.edge) + " m would give about " +
                                 rounded(std::round(tets / 1e6)) + " million tetrahedra, at most " +
                                 rounded(most_tets / 1e6) +
                                 " million are made: " + remedy_for_size(diagonal));
  }
}

}  // namespace lobe::meshing
