#include "lobe/scene/scene_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "lobe/error.h"
#include "lobe/io/grouped_mesh.h"
#include "lobe/mesh/joined_mesh.h"
#include "lobe/scene/each_selector.h"
#include "lobe/scene/json_text.h"
#include "lobe/scene/read_scene.h"

namespace lobe {
namespace {

std::filesystem::path path_of(const Scene& scene, const SceneBody& body) {
  return scene.file.parent_path() / body.mesh;
}

void put_in_place(const SceneBody& body, const std::string& place, TetMesh& mesh) {
  const Mat3<double> turn = Eigen::Quaterniond(body.orientation).normalized().toRotationMatrix();
  if (!turn.isIdentity(0)) {
    mesh.points = turn * mesh.points;
    if (mesh.fibres.cols() > 0) mesh.fibres = turn * mesh.fibres;
  }
  if (body.mesh_scale != 1) mesh.points *= body.mesh_scale;
  mesh.points.colwise() += body.position;
  prepare(mesh, place);  // far from the origin, or scaled by far, its tetrahedra may be flat
}

// Adds groups of a file whose vertices are numbered from `first` on in the whole mesh.
void append_surfaces(std::vector<SurfaceGroup> added, Index first, std::vector<SurfaceGroup>& groups) {
  for (SurfaceGroup& group : added) {
    for (auto& triangle : group.triangles)
      for (Index& v : triangle) v += first;
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const SurfaceGroup& other) {
      return other.number == group.number && other.name == group.name;
    });
    if (same == groups.end())
      groups.push_back(std::move(group));
    else
      same->triangles.insert(same->triangles.end(), group.triangles.begin(), group.triangles.end());
  }
}

void append_file(MeshFile added, const SceneBody& body, MeshFile& whole) {
  append_surfaces(std::move(added.surfaces), whole.mesh.vertex_count(), whole.surfaces);
  for (const auto& [label, name] : added.label_names)
    whole.body_label_names.push_back({body.name, label, name});
  for (const std::string& note : added.warnings()) whole.notes.push_back(body.name + ": " + note);
  whole.ignored_cells += added.ignored_cells;
  append_body(added.mesh, body.name, whole.mesh);
}

// Collects what bind_groups() has found for a selector, under its name; several names become one.
void add_group_of(Selector& selector, std::vector<SurfaceGroup>& groups) {
  if (auto* parts = parts_of(selector)) {
    for (Selector& part : *parts) add_group_of(part, groups);
    return;
  }
  auto* surface = std::get_if<SelectSurface>(&selector.value);
  if (!surface || surface->triangles.empty()) return;
  std::string name;
  for (const std::string& one : surface->names) name += (name.empty() ? "" : ", ") + one;
  surface->names = {name};
  const auto has_name = [&](const SurfaceGroup& group) { return group.name == name; };
  if (std::none_of(groups.begin(), groups.end(), has_name))
    groups.push_back({static_cast<int>(groups.size()) + 1, name, surface->triangles});
}

std::vector<SurfaceGroup> selected_groups(Scene& scene) {
  std::vector<SurfaceGroup> groups;
  for_each_selector(scene, [&](Selector& selector, auto&&...) { add_group_of(selector, groups); });
  return groups;
}

// The part of groups that is on vertices from `first` on, which then have the numbers of a body's own mesh.
Groups groups_from(const std::vector<SurfaceGroup>& groups, Index first, Index count) {
  Groups own;
  for (const SurfaceGroup& group : groups) {
    SurfaceGroup part{group.number, group.name, {}};
    for (std::array<Index, 3> triangle : group.triangles) {
      for (Index& v : triangle) v -= first;
      const auto is_own = [&](Index v) { return v >= 0 && v < count; };
      if (std::all_of(triangle.begin(), triangle.end(), is_own)) part.triangles.push_back(triangle);
    }
    if (!part.triangles.empty()) own.surfaces.push_back(std::move(part));
  }
  return own;
}

}  // namespace

MeshFile read_scene_mesh(const Scene& scene) {
  if (scene.bodies.empty()) return read_mesh(mesh_path(scene));
  MeshFile whole;
  whole.mesh.points.resize(3, 0);
  whole.mesh.tets.resize(4, 0);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const SceneBody& body = scene.bodies[i];
    const std::filesystem::path path = path_of(scene, body);
    MeshFile file = read_mesh(path);
    put_in_place(body, child_pointer("/bodies", i) + ": " + path.string(), file.mesh);
    append_file(std::move(file), body, whole);
  }
  return whole;
}

std::vector<std::filesystem::path> mesh_paths(const Scene& scene) {
  if (scene.bodies.empty()) return {mesh_path(scene)};
  std::vector<std::filesystem::path> paths;
  for (const SceneBody& body : scene.bodies) paths.push_back(path_of(scene, body));
  return paths;
}

void replace_mesh(const std::filesystem::path& mesh, Scene& scene) {
  if (!scene.bodies.empty())
    throw InputError(scene.file.string(),
                     "has bodies with meshes of their own, which no other mesh can replace");
  scene.mesh = std::filesystem::absolute(mesh);
}

void save_scene_mesh(const TetMesh& mesh, const std::filesystem::path& folder, const std::string& stem,
                     Scene& scene) {
  const std::vector<SurfaceGroup> groups = selected_groups(scene);
  if (scene.bodies.empty()) {
    scene.mesh = stem + ".vtu";
    scene.mesh_scale = 1;
    return write_grouped_vtu(folder / scene.mesh, mesh, {groups, {}}, {}, {});
  }
  Index first = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const SceneBody placed{scene.bodies[i].name, stem + "_" + std::to_string(i + 1) + ".vtu"};
    const TetMesh part = mesh_of_body(mesh, int(i));
    write_grouped_vtu(folder / placed.mesh, part, groups_from(groups, first, part.vertex_count()), {}, {});
    first += part.vertex_count();
    scene.bodies[i] = placed;
  }
}

}  // namespace lobe
