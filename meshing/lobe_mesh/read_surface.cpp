// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <algorithm>
#include <fstream>
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
  const bool known = extension == ".stl" || extension == ".obj" || extension == ".ply" ||
                     extension == ".off" || extension == ".vtp" || extension == ".vtk" || extension == ".vtu";
  std::error_code error;
  if (!std::filesystem::exists(file, error)) text.fail("no such file");
  if (std::filesystem::is_directory(file, error)) text.fail("is a folder, expected a file");
  if (!known)
    text.fail("unknown extension '" + extension + "', expected .stl, .obj, .ply, .off, .vtp, .vtk or .vtu");
  if (extension == ".vtp") return to_surface(read_vtp(file), text);
  if (extension == ".vtk" || extension == ".vtu") return to_surface(read_vtk_surface(file), text);
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

}  // namespace lobe::meshing
