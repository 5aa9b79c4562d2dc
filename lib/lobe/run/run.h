// `lobe run`: plays a scene, records it, and reports.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lobe/numerics/sparse_factor.h"
#include "lobe/scene/resolve.h"

namespace lobe {

struct RunOptions {
  std::filesystem::path directory;  // folder of everything that is written; made if missing
  int threads = 1;
  std::filesystem::path record;          // file for the recording of the run (recording.h), if not empty
  SparseFactorMaker factor = make_ldlt;  // factor of the static solver
  bool quadratic = false;                // whether a static solution is with 10-node tetrahedra
  std::function<void(double fraction)> progress;         // called once per frame, 0 … 1
  std::function<void(double fraction)> condensing = {};  // called while regions are condensed, 0 … 1
};

struct RunResult {
  bool ok = true;                // false: it ended early; the report says why
  std::filesystem::path report;  // DIR/report.json
  std::filesystem::path
      picture_request;  // DIR/pictures.json for lobe-picture, empty if no pictures were asked for
  std::vector<std::string> warnings;  // warnings of the scene and of the run, one line each
  std::string summary;                // several lines for people
};

// resolve() has chosen the automatic regions. Writes DIR/series.pvd, DIR/frame_NNNN.vtu,
// DIR/pictures.json and DIR/report.json (written last). Throws InputError for bad input and for files that
// cannot be written.
RunResult run_scene(const Scene& scene, const Resolved& resolved, const RunOptions& options);

}  // namespace lobe
