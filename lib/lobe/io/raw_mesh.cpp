#include "lobe/io/raw_mesh.h"

#include <algorithm>

#include "lobe/error.h"

namespace lobe::io {

namespace {

// "3 triangles and 1 hexahedron"
std::string listed(const std::map<std::string, Index>& cells) {
  std::string text;
  std::size_t left = cells.size();
  for (const auto& [kind, count] : cells) {
    const bool ends_in_x = kind.ends_with("x");
    text += std::to_string(count) + " " + kind + (count == 1 ? "" : ends_in_x ? "es" : "s");
    if (--left > 0) text += left == 1 ? " and " : ", ";
  }
  return text;
}

Index number_of(const std::map<std::string, Index>& cells) {
  Index sum = 0;
  for (const auto& [kind, count] : cells) sum += count;
  return sum;
}

// lobe-mesh reads surfaces of VTK's formats, but not of the others.
void refuse_without_tetrahedra(const RawMesh& raw, const std::string& name) {
  std::map<std::string, Index> others = raw.ignored;
  for (const auto& [number, group] : raw.surfaces)
    if (!group.triangles.empty()) others["triangle"] += static_cast<Index>(group.triangles.size());
  if (!raw.corners.empty() || others.empty()) return;
  const std::string extension = lower_case(std::filesystem::path(name).extension().string());
  const bool is_vtk = extension == ".vtk" || extension == ".vtu";
  throw InputError(name, "has no tetrahedron, only " + listed(others) +
                             (is_vtk ? "; a surface is meshed by lobe-mesh"
                                     : "; save a surface as .stl or .obj, which lobe-mesh meshes") +
                             ", other volume cells must be split into tetrahedra first");
}

// Leaves out the vertices in the middle of edges, unless they are corners as well. Returns which vertices are
// left.
std::vector<Index> leave_out_middles(RawMesh& raw) {
  const std::size_t count = raw.coordinates.size() / 3;
  std::vector<char> stays(count, 1);
  for (const Index v : raw.middles) stays[std::size_t(v)] = 0;
  for (const Index v : raw.corners) stays[std::size_t(v)] = 1;
  for (const auto& [of, group] : raw.surfaces)
    for (const auto& triangle : group.triangles)
      for (const Index v : triangle) stays[std::size_t(v)] = 1;
  std::vector<Index> left, number(count, -1);
  for (std::size_t v = 0; v < count; ++v) {
    if (!stays[v]) continue;
    number[v] = static_cast<Index>(left.size());
    std::copy_n(&raw.coordinates[3 * v], 3, &raw.coordinates[3 * left.size()]);
    left.push_back(static_cast<Index>(v));
  }
  raw.coordinates.resize(3 * left.size());
  for (Index& v : raw.corners) v = number[std::size_t(v)];
  for (auto& [of, group] : raw.surfaces)
    for (auto& triangle : group.triangles)
      for (Index& v : triangle) v = number[std::size_t(v)];
  raw.notes.push_back(std::to_string(raw.ten_node) +
                      (raw.ten_node == 1 ? " tetrahedron has" : " tetrahedra have") +
                      " ten nodes: the corners are taken, " + std::to_string(count - left.size()) +
                      " vertices in the middle of edges are left out");
  return left;
}

}  // namespace

void add_ten_node(const std::vector<Index>& nodes, RawMesh& raw) {
  raw.corners.insert(raw.corners.end(), nodes.begin(), nodes.begin() + 4);
  raw.middles.insert(raw.middles.end(), nodes.begin() + 4, nodes.end());
  ++raw.ten_node;
}

MeshFile finish(RawMesh raw, const std::string& name, std::vector<Index>* kept) {
  refuse_without_tetrahedra(raw, name);
  if (std::max(raw.coordinates.size() / 3, raw.corners.size() / 4) > static_cast<std::size_t>(max_index))
    throw InputError(name, "more than 2^31 - 1 vertices or tetrahedra");
  if (raw.ten_node > 0) {
    const std::vector<Index> left = leave_out_middles(raw);
    if (kept) *kept = left;
  }
  const std::size_t points = raw.coordinates.size() / 3, tets = raw.corners.size() / 4;
  MeshFile file;
  file.mesh.points.resize(3, static_cast<Index>(points));
  std::copy_n(raw.coordinates.begin(), 3 * points, file.mesh.points.data());
  file.mesh.tets.resize(4, static_cast<Index>(tets));
  std::copy_n(raw.corners.begin(), 4 * tets, file.mesh.tets.data());
  file.mesh.labels = std::move(raw.labels);
  file.ignored_cells = number_of(raw.ignored);
  file.notes = std::move(raw.notes);
  for (auto& [number, group] : raw.surfaces) {
    group.number = number;
    if (!group.triangles.empty()) file.surfaces.push_back(std::move(group));
  }
  file.label_names = std::move(raw.label_names);
  file.prepared = prepare(file.mesh, name);
  return file;
}

}  // namespace lobe::io
