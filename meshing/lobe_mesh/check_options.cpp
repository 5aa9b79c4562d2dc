// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/check_options.h"

#include <algorithm>

#include "lobe/error.h"
#include "lobe/text.h"
#include "lobe_mesh/area.h"

namespace lobe::meshing {
namespace {

constexpr double most_tets = 20e6;

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
    faults.push_back({"--mesher tetgen", "fills closed surfaces only: use --mesher cgal for a label image"});
}

}  // namespace

// Where a body is thin or has spikes, each face of the boundary needs about one tetrahedron.
double expected_tets(const MeshOptions& options, const Model& model) {
  double tets = 0, smaller_balls = 0;
  for (int region = 0; region < model.region_count(); ++region) {
    const auto asked = options.label_edges.find(model.labels[region]);
    const double edge = asked == options.label_edges.end() ? options.edge : asked->second;
    double faces = 0;
    for (std::size_t k = 0; k < model.surfaces.size(); ++k) {
      if (model.sides[k].inside == region)
        faces += area(model.surfaces[k]) / (std::numbers::sqrt3 / 4 * edge * edge);
    }
    tets += std::max(model.volumes[region] / regular_volume(edge), faces);
  }
  for (const SizeBall& ball : options.balls) {
    const double volume =
        std::min(4.0 / 3 * std::numbers::pi * std::pow(ball.radius, 3), model.total_volume());
    smaller_balls += volume / regular_volume(ball.edge);
  }
  return tets + smaller_balls;
}

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
    throw InputError("edge",
                     rounded(options.edge) + " m would give about " + rounded(std::round(tets / 1e6)) +
                         " million tetrahedra, at most " + rounded(most_tets / 1e6) +
                         " million are made: choose a longer edge (or --scale, if the units are wrong)");
  }
}

}  // namespace lobe::meshing
