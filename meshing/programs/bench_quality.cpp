// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench.h"
#include "lobe/error.h"
#include "lobe/io/atomic_file.h"
#include "lobe/text.h"
#include "lobe_mesh/check_options.h"
#include "lobe_mesh/child_process.h"
#include "lobe_mesh/model.h"
#include "lobe_mesh/repair.h"

namespace lobe::meshing {
namespace {

struct Row {
  std::string surface, mesher;
  int asked = 0;
  ChildResult child;
  nlohmann::json report;  // empty if it failed

  double value(const char* key) const { return report.value(key, std::nan("")); }
  // The smallest sizes of a thin body cannot hold its volume.
  bool good() const {
    return !report.empty() && report["passes"] == true &&
           (asked < 20000 || std::abs(value("volume_error_percent")) <= 1);
  }
};

double volume_of(const std::string& file) {
  if (is_label_image(file)) return make_model(read_label_image(file), 0).total_volume();
  RepairReport repair;
  return enclosed_volume(repair_surface(read_surface(file), {}, repair));
}

Row measure(const std::string& file, double volume, const std::string& mesher, int tets) {
  const TemporaryFolder folder;
  const std::filesystem::path report = folder.path() / "report.json";
  Row row{std::filesystem::path(file).stem().string(), mesher, tets, {}, {}};
  row.child = run_child(find_program("lobe-mesh"),
                        {file, "-o", folder.path() / "mesh.vtu", "--edge", exact(regular_edge(volume / tets)),
                         "--mesher", mesher, "--report", report, "--quiet", "--time-limit", "3600"},
                        {3700, 16e9});
  if (row.child.end == ChildResult::End::normal && row.child.status == 0)
    row.report = nlohmann::json::parse(std::ifstream(report));
  return row;
}

void print(const Row& row) {
  if (row.report.empty()) {
    std::printf("| %s | %d | %s | failed: %s |\n", row.surface.c_str(), row.asked, row.mesher.c_str(),
                row.child.in_words().c_str());
    return;
  }
  std::printf("| %s | %d | %s | %d | %.2f | %.1f | %.0f | %.2f | %.2f | %zu | %.1f | %.0f |%s\n",
              row.surface.c_str(), row.asked, row.report["mesher"].get<std::string>().c_str(),
              row.report["tets"].get<int>(), row.value("time_step_star"), row.value("min_dihedral"),
              row.value("median_min_dihedral"), row.value("smallest_altitude_ratio"),
              row.value("volume_error_percent"), row.report["attempts"].size(), row.child.cpu_seconds,
              row.child.peak_bytes / 1e6, row.good() ? "" : " below the gate");
}

std::string csv_line(const Row& row) {
  std::string line = row.surface + ',' + std::to_string(row.asked) + ',' + row.mesher;
  for (const char* key : {"tets", "time_step_star", "min_dihedral", "median_min_dihedral",
                          "smallest_altitude_ratio", "volume_error_percent"})
    line += ',' + exact(row.value(key));
  const std::string used = row.report.empty() ? "" : row.report["mesher"].get<std::string>();
  return line + ',' + used + ',' + exact(row.child.cpu_seconds) + ',' + exact(row.child.peak_bytes) + '\n';
}

}  // namespace

int bench_quality(const BenchOptions& options) {
  if (options.surfaces.empty()) throw InputError("SURFACE", "missing: give surfaces to mesh");
  std::string csv =
      "surface,asked,mesher,tets,time_step_star,min_dihedral,median_min_dihedral,smallest_altitude_ratio,"
      "volume_error_percent,mesher_kept,cpu_s,peak_bytes\n";
  std::puts(
      "| surface | asked | mesher kept | tetrahedra | dt* | smallest dihedral ° | median of the smallest ° | "
      "altitude / edge | volume error % | tries | processor s | MB "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|---|");
  int bad = 0;
  for (const std::string& file : options.surfaces) {
    const double volume = volume_of(file);
    for (const int tets : options.tets) {
      for (const char* mesher : {"cgal", "tetgen"}) {
        if (is_label_image(file) && mesher == std::string("tetgen")) continue;
        const Row row = measure(file, volume, mesher, tets);
        print(row);
        std::fflush(stdout);
        bad += !row.good();
        csv += csv_line(row);
      }
    }
  }
  io::AtomicFile out(options.output / "quality.csv");
  out.stream() << csv;
  out.commit();
  return bad;
}

}  // namespace lobe::meshing
