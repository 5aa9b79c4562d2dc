// `lobe refine`: a finer mesh of the same body. `lobe convert`: the same in another format or scale.
#include "lobe/mesh/refine.h"

#include <algorithm>
#include <cstdio>

#include "commands.h"
#include "console.h"
#include "lobe/error.h"
#include "lobe/io/grouped_mesh.h"
#include "lobe/io/labelled_mesh.h"

namespace lobe::program {
namespace {

using Arrays = std::map<std::string, Eigen::MatrixXd>;

void refine_group(SurfaceGroup& group, const TetMesh& old, const RefinedMesh& fine) {
  const std::size_t before = group.triangles.size();
  group.triangles = refined_triangles(group.triangles, old, fine);
  if (const std::size_t lost = before - group.triangles.size() / 4; lost > 0)
    print_warnings({"surface " + std::to_string(group.number) + ": " + std::to_string(lost) + " of " +
                    std::to_string(before) + " triangles have no edges of the mesh, and are left out"});
}

void refine_once(MeshFile& file) {
  RefinedMesh fine = refine(file.mesh);
  for (auto& [name, values] : file.point_data) values = fine.prolongate(values);
  for (auto& [name, values] : file.cell_data) values = fine.inherit(values);
  for (SurfaceGroup& group : file.surfaces) refine_group(group, file.mesh, fine);
  std::erase_if(file.surfaces, [](const SurfaceGroup& group) { return group.triangles.empty(); });
  file.mesh = std::move(fine.mesh);
}

std::vector<DataArray> data_arrays(Arrays& arrays) {
  std::vector<DataArray> result;
  for (auto& [name, values] : arrays) result.push_back({name, std::move(values)});
  return result;
}

bool has_names(const Groups& groups) {
  return !groups.label_names.empty() || std::any_of(groups.surfaces.begin(), groups.surfaces.end(),
                                                    [](const SurfaceGroup& g) { return !g.name.empty(); });
}

void write(const std::filesystem::path& output, MeshFile& file) {
  Groups groups{file.surfaces, file.label_names};
  if (!groups.empty() && !holds_groups(output)) {
    print_warnings(
        {output.string() +
         ": the groups of surfaces and the names of labels are left out; .vtu and .msh hold them"});
    groups = {};
  }
  if (output.extension() == ".mesh" && has_names(groups))
    print_warnings({output.string() + ": .mesh holds the numbers of groups and labels, not their names"});
  if (output.extension() == ".vtu")
    return write_grouped_vtu(output, file.mesh, groups, data_arrays(file.point_data),
                             data_arrays(file.cell_data));
  if (!file.point_data.empty() || !file.cell_data.empty())
    print_warnings({output.string() + ": only .vtu holds arrays; those of the mesh are left out"});
  write_grouped_mesh(output, file.mesh, groups);
}

}  // namespace

int refine(const RefineOptions& options) {
  if (!can_write_mesh(options.output))
    throw InputError(options.output.string(), "no mesh is written with this extension; .vtu is");
  MeshFile file = read_mesh(options.mesh);
  print_warnings(file.warnings());
  const Index before = file.mesh.tet_count();
  if (options.tets > 0)
    while (file.mesh.tet_count() < options.tets) refine_once(file);
  else
    for (int i = 0; i < options.times; ++i) refine_once(file);
  const Index after = file.mesh.tet_count(), vertices = file.mesh.vertex_count();
  write(options.output, file);
  std::printf("%d tetrahedra became %d, with %d vertices\nwritten to %s\n", before, after, vertices,
              options.output.string().c_str());
  return done;
}

int convert(const ConvertOptions& options) {
  if (!can_write_mesh(options.output))
    throw InputError(options.output.string(), "no mesh is written with this extension; .vtu is");
  MeshFile file =
      options.labels.empty() ? read_mesh(options.mesh) : read_labelled_mesh(options.mesh, options.labels);
  print_warnings(file.warnings());
  file.mesh.points *= options.scale;
  const Vec3d size = bounding_box(file.mesh).max - bounding_box(file.mesh).min;
  const Index vertices = file.mesh.vertex_count(), tets = file.mesh.tet_count();
  write(options.output, file);
  std::printf("%d vertices, %d tetrahedra, %g × %g × %g m\nwritten to %s\n", vertices, tets, size.x(),
              size.y(), size.z(), options.output.string().c_str());
  return done;
}

}  // namespace lobe::program
