// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench.h"
#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/text.h"
#include "lobe_mesh/check_options.h"
#include "lobe_mesh/child_process.h"
#include "lobe_mesh/model.h"
#include "lobe_mesh/repair.h"

namespace lobe::meshing {
namespace {

// A file to mesh: its name in the table, and what it encloses.
struct Body {
  std::string file, name;
  double volume = 0;  // [m³]
};

struct Row {
  std::string body, mesher;
  int asked = 0;
  ChildResult child;
  nlohmann::json report;  // empty if it failed

  double value(const char* key) const { return report.value(key, std::nan("")); }
  std::string mesher_kept() const { return report.value("mesher", ""); }
  // The smallest sizes of a thin body cannot hold its volume.
  bool good() const {
    return !report.empty() && report["passes"] == true &&
           (asked < 20000 || std::abs(value("volume_error_percent")) <= 1);
  }
};

std::string grouped(int number) {
  std::string digits = std::to_string(number);
  for (auto at = static_cast<int>(digits.size()) - 3; at > 0; at -= 3) digits.insert(at, ",");
  return digits;
}

Body body_of(const std::string& file) {
  const std::string name = std::filesystem::path(file).stem().string();
  if (is_label_image(file)) return {file, name, make_model(read_label_image(file), 0).total_volume()};
  const Surface surface = read_surface(file);
  RepairReport repair;
  return {file, name + ", " + grouped(surface.point_count()) + " vertices",
          enclosed_volume(repair_surface(surface, {}, repair))};
}

Row measure(const Body& body, const std::string& mesher, int tets) {
  const TemporaryFolder folder;
  const std::filesystem::path report = folder.path() / "report.json";
  Row row{body.name, mesher, tets, {}, {}};
  row.child = run_child(
      find_program("lobe-mesh"),
      {body.file, "-o", folder.path() / "mesh.vtu", "--edge", exact(regular_edge(body.volume / tets)),
       "--mesher", mesher, "--report", report, "--quiet", "--time-limit", "3600"},
      {3700, 16e9});
  if (row.child.end == ChildResult::End::normal && row.child.status == 0)
    row.report = nlohmann::json::parse(std::ifstream(report));
  return row;
}

constexpr const char* table_head =
    "| body | asked | mesher | tetrahedra | dt\\* | smallest dihedral ° | median of the smallest ° | "
    "altitude / edge | volume error % | tries | processor s | MB "
    "|\n|---|---|---|---|---|---|---|---|---|---|---|---|\n";

std::string table_line(const Row& row) {
  const std::string start = "| " + row.body + (row.good() ? "" : ", below the gate") + " | " +
                            grouped(row.asked) + " | " + row.mesher;
  if (row.report.empty()) return start + " | failed: " + row.child.in_words() + " |\n";
  const std::string kept = row.mesher_kept() == row.mesher ? "" : ", " + row.mesher_kept() + " kept";
  char figures[200];
  std::snprintf(figures, sizeof figures, " | %s | %.2f | %.1f | %.0f | %.2f | %.2f | %zu | %.1f | %.0f |\n",
                grouped(row.report["tets"].get<int>()).c_str(), row.value("time_step_star"),
                row.value("min_dihedral"), row.value("median_min_dihedral"),
                row.value("smallest_altitude_ratio"),
                std::round(100 * row.value("volume_error_percent")) / 100 + 0.0,  // no −0.00
                row.report["attempts"].size(), row.child.cpu_seconds, row.child.peak_bytes / 1e6);
  return start + kept + figures;
}

std::string csv_line(const Row& row) {
  std::string line = '"' + row.body + "\"," + std::to_string(row.asked) + ',' + row.mesher;
  for (const char* key : {"tets", "time_step_star", "min_dihedral", "median_min_dihedral",
                          "smallest_altitude_ratio", "volume_error_percent"})
    line += ',' + exact(row.value(key));
  return line + ',' + row.mesher_kept() + ',' + exact(row.child.cpu_seconds) + ',' +
         exact(row.child.peak_bytes) + '\n';
}

}  // namespace

int bench_quality(const BenchOptions& options) {
  if (options.surfaces.empty()) throw InputError("SURFACE", "missing: give surfaces to mesh");
  std::string table = table_head,
              csv =
                  "body,asked,mesher,tets,time_step_star,min_dihedral,median_min_dihedral,"
                  "smallest_altitude_ratio,volume_error_percent,mesher_kept,cpu_s,peak_bytes\n";
  std::fputs(table_head, stdout);
  int bad = 0;
  for (const std::string& file : options.surfaces) {
    const Body body = body_of(file);
    std::vector<int> sizes = options.tets;
    if (&file == &options.surfaces.front())
      sizes.insert(sizes.end(), options.first_tets.begin(), options.first_tets.end());
    for (const int tets : sizes) {
      for (const char* mesher : {"cgal", "tetgen"}) {
        if (is_label_image(file) && mesher == std::string("tetgen")) continue;
        const Row row = measure(body, mesher, tets);
        table += table_line(row);
        csv += csv_line(row);
        bad += !row.good();
        std::fputs(table_line(row).c_str(), stdout);
        std::fflush(stdout);
      }
    }
  }
  io::write_file(options.output / "quality.md", table);
  io::write_file(options.output / "quality.csv", csv);
  return bad;
}

}  // namespace lobe::meshing
