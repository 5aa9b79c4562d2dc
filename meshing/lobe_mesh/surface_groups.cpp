// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/surface_groups.h"

#include <algorithm>
#include <limits>
#include <map>

#include "lobe/file/scanner.h"
#include "lobe_mesh/interfaces.h"
#include "lobe_mesh/nearest.h"
#include "lobe_mesh/polygons.h"

namespace lobe::meshing {
namespace {

// By name, in the order in which they begin.
std::vector<NamedSurface> divided(const Polygons& polygons, const std::vector<std::string>& names,
                                  const FileText& file) {
  std::vector<std::string> order;
  std::map<std::string, Polygons> parts;
  for (std::size_t p = 0; p < names.size(); ++p) {
    if (!parts.contains(names[p])) order.push_back(names[p]);
    parts[names[p]].corners.push_back(polygons.corners[p]);
  }
  std::vector<NamedSurface> groups;
  for (const std::string& name : order) {
    parts[name].points = polygons.points;
    groups.push_back({name.empty() ? "unnamed" : name, to_surface(parts[name], file)});
  }
  return groups;
}

}  // namespace

std::vector<NamedSurface> read_groups(const std::filesystem::path& file) {
  const std::string extension = io::lower_case(file.extension().string());
  if (extension == ".obj" || extension == ".stl") {
    const FileText text{file.string(), io::read_file(file)};
    std::vector<std::string> names;
    const Polygons polygons = extension == ".obj" ? parse_obj(text, &names) : parse_stl(text, &names);
    const auto other = std::adjacent_find(names.begin(), names.end(), std::not_equal_to<>());
    if (other != names.end()) return divided(polygons, names, text);
  }
  return {{"", read_surface(file)}};
}

std::vector<SurfaceGroup> groups_of_faces(const TetMesh& mesh, const std::vector<NamedSurface>& groups) {
  std::vector<NearestPoint> nearest;
  for (const NamedSurface& group : groups) nearest.emplace_back(group.surface);
  std::vector<SurfaceGroup> found(groups.size());
  for (const InterfaceFace& face : interface_faces(mesh)) {
    const Vec3d centre = mesh.points(Eigen::all, face.corners).rowwise().mean();
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const double distance = nearest[g].distance(centre);
      if (distance >= least) continue;
      least = distance;
      best = g;
    }
    if (!groups.empty()) found[best].triangles.push_back(face.corners);
  }
  std::vector<SurfaceGroup> named;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (groups[g].name.empty() || found[g].triangles.empty()) continue;
    found[g].name = groups[g].name;
    found[g].number = static_cast<int>(named.size()) + 1;
    named.push_back(std::move(found[g]));
  }
  return named;
}

}  // namespace lobe::meshing
