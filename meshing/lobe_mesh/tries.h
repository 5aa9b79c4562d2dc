// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// Meshes one model several times, in a box of unit size, and keeps the best mesh. Internal.
#pragma once

#include <algorithm>
#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "lobe_mesh/interfaces.h"
#include "lobe_mesh/model.h"
#include "lobe_mesh/nearest.h"
#include "lobe_mesh/steps.h"
#include "lobe_mesh/surface_gap.h"
#include "lobe_mesh/tetrahedralise.h"

namespace lobe::meshing {

class Stopwatch {
 public:
  explicit Stopwatch(std::vector<Phase>& phases) : phases_(phases) {}
  void phase(const std::string& name) {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    const auto same = [&](const Phase& phase) { return phase.name == name; };
    const auto known = std::find_if(phases_.begin(), phases_.end(), same);
    if (known != phases_.end())
      known->seconds += seconds;
    else
      phases_.push_back({name, seconds});
    last_ = now;
  }
  double elapsed() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::vector<Phase>& phases_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), last_ = start_;
};

constexpr double point_spacing = 0.5;  // spacing of points on surfaces, as a share of the edge

class Tries {
 public:
  Tries(const Model& model, const MeshOptions& options, MeshReport& report);
  TetMesh best();

 private:
  void keep_features(std::size_t k);
  void keep_junctions();
  std::vector<Polyline> kept_lines(const Surface& surface, const std::string& name);
  void one(Mesher mesher, double factor);
  TetMesh mesh_with(Mesher mesher, double edge);
  void improve(TetMesh& mesh);
  Remedy measure_gap(const TetMesh& mesh, MeshReport& report) const;
  bool ask_for_lost_parts();
  bool shorten_edges_of(int region);
  bool may_pass(Mesher mesher) const;
  bool available(Mesher mesher) const;
  bool failed(Mesher mesher) const;
  bool out_of_time() const { return stopwatch_.elapsed() > options_.time_limit; }

  const Model& model_;
  const MeshOptions& options_;
  MeshReport& report_;
  UnitBox unit_;
  Model scaled_;
  MeshOptions scaled_options_;
  std::vector<NearestPoint> surfaces_;
  NearestPoint surface_;  // all of them
  std::vector<SurfacePoint> surface_points_;
  Interfaces interfaces_;
  std::vector<Mat3X<double>> features_;  // points of the feature lines, scaled
  std::vector<std::string> warnings_;
  std::vector<Phase> phases_;
  Stopwatch stopwatch_{phases_};
  TetMesh best_;
  MeshReport best_report_;
  Remedy remedy_;  // scaled: what would keep the parts that the best mesh lost
  std::vector<Seed> seeds_;
  std::map<Mesher, std::vector<double>> shapes_;  // of the meshes of almost the same edges
};

}  // namespace lobe::meshing
