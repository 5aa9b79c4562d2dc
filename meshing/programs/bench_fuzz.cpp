// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <random>

#include "bench.h"
#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/io/surface_io.h"
#include "lobe/text.h"
#include "lobe_mesh/child_process.h"
#include "lobe_mesh/interfaces.h"
#include "lobe_mesh/repair.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {
namespace {

using Random = std::mt19937_64;  // the same numbers everywhere

double uniform(Random& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }
Index below(Random& random, Index n) { return static_cast<Index>(random() % static_cast<std::uint64_t>(n)); }

void delete_triangles(Surface& s, Random& random) {
  const Index count = 1 + below(random, s.triangle_count() / 4);
  for (Index i = 0; i < count; ++i) {
    s.triangles.col(below(random, s.triangle_count())) = s.triangles.rightCols<1>().eval();
    s.triangles.conservativeResize(3, s.triangles.cols() - 1);
  }
}

void flip_triangles(Surface& s, Random& random) {
  for (Index i = below(random, s.triangle_count()); i >= 0; --i) {
    const Index t = below(random, s.triangle_count());
    std::swap(s.triangles(0, t), s.triangles(1, t));
  }
}

void duplicate_triangles(Surface& s, Random& random) {
  const Index old = s.triangle_count(), more = 1 + below(random, old);
  s.triangles.conservativeResize(3, old + more);
  for (Index i = 0; i < more; ++i) s.triangles.col(old + i) = s.triangles.col(below(random, old)).eval();
}

void add_noise(Surface& s, Random& random) {
  const double size = box_diagonal(s) * std::pow(10, -4 + 3.3 * uniform(random));
  for (double& x : s.points.reshaped()) x += size * (2 * uniform(random) - 1);
}

void scale(Surface& s, Random& random) { s.points *= std::pow(10, -6 + 12 * uniform(random)); }

void spoil_coordinate(Surface& s, Random& random) {
  const double values[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                           1e300, 1e-300};
  s.points(below(random, 3), below(random, s.point_count())) = values[below(random, 4)];
}

void move_vertices_far(Surface& s, Random& random) {
  for (Index i = below(random, 5); i >= 0; --i)
    s.points.col(below(random, s.point_count())) *= 10 * uniform(random) - 5;
}

void merge_vertices(Surface& s, Random& random) {
  for (Index i = below(random, 20); i >= 0; --i)
    s.triangles(below(random, 3), below(random, s.triangle_count())) = below(random, s.point_count());
}

void take_apart(Surface& s, Random&) {
  Mat3X<double> points(3, s.triangles.size());
  for (Eigen::Index i = 0; i < s.triangles.size(); ++i) {
    points.col(i) = s.points.col(s.triangles.reshaped()[i]);
    s.triangles.reshaped()[i] = static_cast<Index>(i);
  }
  s.points = points;
}

void add_copy(Surface& s, Random& random) {
  Surface copy = s;
  copy.points *= uniform(random);
  const Vec3d shift =
      box_diagonal(s) * (uniform(random) - 0.5) * Vec3d(uniform(random), uniform(random), uniform(random));
  copy.points.colwise() += shift;
  const Index points = s.point_count(), triangles = s.triangle_count();
  s.points.conservativeResize(3, 2 * points);
  s.points.rightCols(points) = copy.points;
  s.triangles.conservativeResize(3, 2 * triangles);
  s.triangles.rightCols(triangles) = copy.triangles.array() + points;
}

struct Kind {
  const char* name;
  void (*damage)(Surface&, Random&);
};
constexpr Kind kinds[] = {{"triangles deleted", delete_triangles},
                          {"triangles flipped", flip_triangles},
                          {"triangles doubled", duplicate_triangles},
                          {"noise", add_noise},
                          {"scale 1e-6 … 1e6", scale},
                          {"NaN, infinite, huge", spoil_coordinate},
                          {"vertices far out", move_vertices_far},
                          {"corners exchanged", merge_vertices},
                          {"triangles apart", take_apart},
                          {"second copy", add_copy}};
constexpr int kind_count = static_cast<int>(std::size(kinds));

constexpr const char* several = "three of these";

std::string damage(Surface& surface, int number, Random& random) {
  if (number % (kind_count + 1) < kind_count) {
    kinds[number % (kind_count + 1)].damage(surface, random);
    return kinds[number % (kind_count + 1)].name;
  }
  for (int i = 0; i < 3; ++i) kinds[below(random, kind_count)].damage(surface, random);
  return several;
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Returns what is wrong with a mesh, or "". read_mesh() checks indices, orientation, flatness and faces.
std::string fault_of(const std::filesystem::path& mesh) {
  try {
    read_mesh(mesh);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

struct Counts {
  int surfaces = 0, meshed = 0, refused = 0, gave_up = 0, wrong = 0;

  void add(const Counts& c) {
    surfaces += c.surfaces;
    meshed += c.meshed;
    refused += c.refused;
    gave_up += c.gave_up;
    wrong += c.wrong;
  }
};

// Writes a line per kind of damage and one for all of them, as a table and as CSV.
void write_tables(const std::map<std::string, Counts>& counts, const std::filesystem::path& folder) {
  std::string table =
                  "| damage | surfaces | meshed | refused by name | gave up by name | wrong "
                  "|\n|---|---|---|---|---|---|\n",
              csv = "damage,surfaces,meshed,refused,gave_up,wrong\n";
  const auto add = [&](const std::string& kind, const Counts& c) {
    std::string line = "| " + kind, row = '"' + kind + '"';
    for (const int count : {c.surfaces, c.meshed, c.refused, c.gave_up, c.wrong}) {
      line += " | " + std::to_string(count);
      row += ',' + std::to_string(count);
    }
    table += line + " |\n";
    csv += row + '\n';
  };
  Counts all;
  std::vector<std::string> names;
  for (const Kind& kind : kinds) names.push_back(kind.name);
  names.push_back(several);
  for (const std::string& name : names) {
    const auto found = counts.find(name);
    if (found == counts.end()) continue;
    add(name, found->second);
    all.add(found->second);
  }
  add("together", all);
  std::fputs(table.c_str(), stdout);
  io::write_file(folder / "fuzz.md", table);
  io::write_file(folder / "fuzz.csv", csv);
}

// The edge to mesh with. It is long, so that a thousand surfaces take minutes. If the size of the surface
// makes no sense, lobe-mesh chooses the edge.
std::vector<std::string> arguments(const std::string& file, const std::string& mesh, const Surface& surface,
                                   const BenchOptions& options) {
  std::vector<std::string> words{
      file, "-o", mesh, "--quiet", "--time-limit", exact(options.time_limit), "--repair", options.repair};
  const double edge = box_diagonal(surface) / 12;
  if (std::isfinite(edge) && edge > 0) words.insert(words.end(), {"--edge", exact(edge)});
  return words;
}

// Returns what is wrong, or "".
std::string run_one(const std::filesystem::path& file, const Surface& surface, const BenchOptions& options,
                    Counts& counts) {
  ++counts.surfaces;
  const TemporaryFolder folder;
  const std::filesystem::path mesh = folder.path() / "mesh.vtu", errors = folder.path() / "errors";
  const ChildResult result = run_child(find_program("lobe-mesh"), arguments(file, mesh, surface, options),
                                       {options.time_limit + 30, 9e9}, errors);
  if (result.end != ChildResult::End::normal) return result.in_words();
  const bool written = std::filesystem::exists(mesh);
  if (result.status == 0) {
    ++counts.meshed;
    return written ? fault_of(mesh) : "no mesh was written";
  }
  if (written) return "failed, and wrote a mesh";
  const std::string text = text_of(errors);
  if (text.find("lobe-mesh: error: ") == text.npos) return "ended without a message";
  if (text.find("crashed") != text.npos) return text;
  ++(result.status == 2 ? counts.refused : counts.gave_up);
  return "";
}

}  // namespace

int bench_fuzz(const BenchOptions& options) {
  if (options.surfaces.empty()) throw InputError("SURFACE", "missing: give surfaces to damage");
  std::vector<Surface> bases;
  for (const std::string& file : options.surfaces) {
    RepairReport repair;
    const Surface whole = repair_surface(read_surface(file), {}, repair);
    const UnitBox unit(whole);
    bases.push_back(
        remesh({unit.to_unit(whole.points), whole.triangles}, {}, 0.07));  // some hundred triangles
    bases.back().points = unit.from_unit(bases.back().points);
  }
  const TemporaryFolder folder;
  std::map<std::string, Counts> table;
  int wrong = 0;
  for (int number = options.first; number < options.first + options.count; ++number) {
    Random random(static_cast<std::uint64_t>(number));
    Surface surface = bases[static_cast<std::size_t>(number / (kind_count + 1)) % bases.size()];
    const std::string kind = damage(surface, number, random);
    const std::filesystem::path file = folder.path() / "surface.vtp";
    write_surface(file, surface.points, surface.triangles);
    const std::string fault = run_one(file, surface, options, table[kind]);
    if (number % 50 == 0) std::fprintf(stderr, "surface %d, %d wrong so far\n", number, wrong);
    if (fault.empty()) continue;
    ++wrong;
    ++table[kind].wrong;
    std::printf("surface %d (%s): %s\n", number, kind.c_str(), fault.c_str());
    std::fflush(stdout);
    write_surface(options.output / ("fuzzed_" + std::to_string(number) + ".vtp"), surface.points,
                  surface.triangles);
  }
  write_tables(table, options.output);
  return wrong;
}

}  // namespace lobe::meshing
