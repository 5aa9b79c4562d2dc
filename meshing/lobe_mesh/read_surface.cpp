// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <algorithm>
#include <fstream>
#include <iomanip>
#include <iterator>

#include "lobe/error.h"
#include "lobe_mesh/clean.h"
#include "lobe_mesh/polygons.h"
#include "lobe_mesh/surface.h"

namespace lobe::meshing {
namespace {

std::string extension_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension;
}

// STL has no indices: equal points become one. Everything else stays for diagnose().
void weld(Surface& surface) {
  const std::vector<Index> first = first_of_equal_points(surface.points);
  std::vector<Index> number(first.size(), 0);
  Index count = 0;
  for (Index i = 0; i < surface.point_count(); ++i) {
    if (first[i] == i) {
      surface.points.col(count) = surface.points.col(i).eval();
      number[i] = count++;
    } else {
      number[i] = number[first[i]];
    }
  }
  for (Index& v : surface.triangles.reshaped()) v = number[v];
  surface.points.conservativeResize(3, count);
}

}  // namespace

Surface read_surface(const std::filesystem::path& file) {
  FileText text{file.string(), {}};
  const std::string extension = extension_of(file);
  const bool known = extension == ".stl" || extension == ".obj" || extension == ".ply" || extension == ".off";
  std::error_code error;
  if (!std::filesystem::exists(file, error)) text.fail("no such file");
  if (std::filesystem::is_directory(file, error)) text.fail("is a folder, expected a file");
  if (!known) text.fail("unknown extension '" + extension + "', expected .stl, .obj, .ply or .off");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) text.fail("cannot be read");
  text.text.assign(std::istreambuf_iterator<char>(stream), {});
  if (text.text.empty()) text.fail("empty file");
  if (extension == ".obj") return to_surface(parse_obj(text), text);
  if (extension == ".ply") return to_surface(parse_ply(text), text);
  if (extension == ".off") return to_surface(parse_off(text), text);
  Surface surface = to_surface(parse_stl(text), text);
  weld(surface);
  return surface;
}

void write_surface(const std::filesystem::path& file, const Surface& surface) {
  const std::string extension = extension_of(file);
  std::ofstream out(file);
  out << std::setprecision(17);
  const auto row = [&](const char* prefix, const auto& column) {
    out << prefix << column[0] << ' ' << column[1] << ' ' << column[2] << '\n';
  };
  if (extension == ".off" || extension == ".obj") {
    const bool off = extension == ".off";
    if (off) out << "OFF\n" << surface.point_count() << ' ' << surface.triangle_count() << " 0\n";
    for (const auto& p : surface.points.colwise()) row(off ? "" : "v ", p);
    for (const auto& t : surface.triangles.colwise()) {
      row(off ? "3 " : "f ", off ? t.eval() : (t.array() + 1).matrix().eval());
    }
  } else if (extension == ".stl") {
    out << "solid lobe\n";
    for (const auto& t : surface.triangles.colwise()) {
      out << "facet normal 0 0 0\nouter loop\n";
      for (const Index v : t) row("vertex ", surface.points.col(v));
      out << "endloop\nendfacet\n";
    }
    out << "endsolid lobe\n";
  } else {
    throw InputError(file.string(), "unknown extension '" + extension + "', expected .off, .obj or .stl");
  }
  if (!out.flush()) throw InputError(file.string(), "cannot be written");
}

}  // namespace lobe::meshing
