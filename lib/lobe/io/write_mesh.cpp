// Meshes out in the text formats of other programs; labels survive a round trip.
#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/file/scanner.h"
#include "lobe/io/grouped_mesh.h"
#include "lobe/text.h"

namespace lobe {
namespace {

using Path = std::filesystem::path;

int label_of(const TetMesh& mesh, Index t) { return mesh.labels.empty() ? 0 : mesh.labels[t]; }

std::string position(const TetMesh& mesh, Index v) {
  return exact(mesh.points(0, v)) + ' ' + exact(mesh.points(1, v)) + ' ' + exact(mesh.points(2, v));
}

std::string corners(const TetMesh& mesh, Index t, Index first) {
  std::string text;
  for (const Index v : mesh.tets.col(t)) text += (text.empty() ? "" : " ") + std::to_string(v + first);
  return text;
}

std::size_t triangles_in(const Groups& groups) {
  std::size_t count = 0;
  for (const SurfaceGroup& group : groups.surfaces) count += group.triangles.size();
  return count;
}

std::string corners(const std::array<Index, 3>& triangle) {  // from 1
  return std::to_string(triangle[0] + 1) + ' ' + std::to_string(triangle[1] + 1) + ' ' +
         std::to_string(triangle[2] + 1);
}

// Legacy VTK 3.0, which every version of VTK reads.
void write_vtk(const Path& file, const TetMesh& mesh, const Groups&) {
  io::AtomicFile target(file);
  std::ostream& out = target.stream();
  out << "# vtk DataFile Version 3.0\nlobe\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " << mesh.vertex_count()
      << " double\n";
  for (Index v = 0; v < mesh.vertex_count(); ++v) out << position(mesh, v) << '\n';
  out << "CELLS " << mesh.tet_count() << ' ' << 5 * static_cast<std::int64_t>(mesh.tet_count()) << '\n';
  for (Index t = 0; t < mesh.tet_count(); ++t) out << "4 " << corners(mesh, t, 0) << '\n';
  out << "CELL_TYPES " << mesh.tet_count() << '\n';
  for (Index t = 0; t < mesh.tet_count(); ++t) out << "10\n";
  out << "CELL_DATA " << mesh.tet_count() << "\nSCALARS label int 1\nLOOKUP_TABLE default\n";
  for (Index t = 0; t < mesh.tet_count(); ++t) out << label_of(mesh, t) << '\n';
  target.commit();
}

void write_medit(const Path& file, const TetMesh& mesh, const Groups& groups) {
  io::AtomicFile target(file);
  std::ostream& out = target.stream();
  out << "MeshVersionFormatted 2\nDimension 3\nVertices\n" << mesh.vertex_count() << '\n';
  for (Index v = 0; v < mesh.vertex_count(); ++v) out << position(mesh, v) << " 0\n";
  if (!groups.surfaces.empty()) out << "Triangles\n" << triangles_in(groups) << '\n';
  for (const SurfaceGroup& group : groups.surfaces)
    for (const auto& triangle : group.triangles) out << corners(triangle) << ' ' << group.number << '\n';
  out << "Tetrahedra\n" << mesh.tet_count() << '\n';
  for (Index t = 0; t < mesh.tet_count(); ++t) out << corners(mesh, t, 1) << ' ' << label_of(mesh, t) << '\n';
  out << "End\n";
  target.commit();
}

void write_tetgen(const Path& either, const TetMesh& mesh, const Groups&) {
  Path name = either;
  io::AtomicFile node(name.replace_extension(".node")), ele(name.replace_extension(".ele"));
  node.stream() << mesh.vertex_count() << " 3 0 0\n";
  for (Index v = 0; v < mesh.vertex_count(); ++v) node.stream() << v << ' ' << position(mesh, v) << '\n';
  ele.stream() << mesh.tet_count() << " 4 1\n";
  for (Index t = 0; t < mesh.tet_count(); ++t)
    ele.stream() << t << ' ' << corners(mesh, t, 0) << ' ' << label_of(mesh, t) << '\n';
  node.commit();
  ele.commit();
}

// Labels are physical groups, whose numbers are above 0; label 0 belongs to none.
void refuse_negative_labels(const Path& file, const TetMesh& mesh, const Groups& groups) {
  const auto check = [&](const char* what, int number) {
    if (number < 0)
      throw InputError(file.string(), std::string(what) + std::to_string(number) +
                                          ": Gmsh's groups are not negative; use .vtu");
  };
  for (const int label : mesh.labels) check("label ", label);
  for (const SurfaceGroup& group : groups.surfaces) check("surface ", group.number);
}

void write_names(std::ostream& out, const Groups& groups) {
  std::ostringstream names;
  std::size_t count = 0;
  const auto add = [&](int dimension, int number, std::string name) {
    if (name.empty()) return;
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '"' || c == '\n' || c == '\r'; }, '_');
    names << dimension << ' ' << number << " \"" << name << "\"\n";
    ++count;
  };
  for (const SurfaceGroup& group : groups.surfaces) add(2, group.number, group.name);
  for (const auto& [label, name] : groups.label_names)
    if (label > 0) add(3, label, name);
  if (count > 0) out << "$PhysicalNames\n" << count << '\n' << names.str() << "$EndPhysicalNames\n";
}

void write_gmsh_2(const Path& file, const TetMesh& mesh, const Groups& groups) {
  refuse_negative_labels(file, mesh, groups);
  io::AtomicFile target(file);
  std::ostream& out = target.stream();
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  write_names(out, groups);
  out << "$Nodes\n" << mesh.vertex_count() << '\n';
  for (Index v = 0; v < mesh.vertex_count(); ++v) out << v + 1 << ' ' << position(mesh, v) << '\n';
  out << "$EndNodes\n$Elements\n" << std::size_t(mesh.tet_count()) + triangles_in(groups) << '\n';
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const int label = label_of(mesh, t);
    out << t + 1 << " 4 2 " << label << ' ' << label + 1 << ' ' << corners(mesh, t, 1) << '\n';
  }
  std::int64_t element = mesh.tet_count();
  for (const SurfaceGroup& group : groups.surfaces)
    for (const auto& triangle : group.triangles)
      out << ++element << " 2 2 " << group.number << ' ' << group.number << ' ' << corners(triangle) << '\n';
  out << "$EndElements\n";
  target.commit();
}

std::string box_in_words(const Box& box) {
  std::string text;
  for (const Vec3d& corner : {box.min, box.max})
    for (const double x : corner) text += ' ' + exact(x);
  return text;
}

// One surface per group, and one volume per label, numbered label + 1. All have the box of the mesh.
void write_entities(std::ostream& out, const TetMesh& mesh, const std::set<int>& labels,
                    const Groups& groups) {
  const std::string box = box_in_words(bounding_box(mesh));
  out << "$Entities\n0 0 " << groups.surfaces.size() << ' ' << labels.size() << '\n';
  for (const SurfaceGroup& group : groups.surfaces)
    out << group.number << box << " 1 " << group.number << " 0\n";
  for (const int label : labels)
    out << label + 1 << box << (label > 0 ? " 1 " + std::to_string(label) : " 0") << " 0\n";
  out << "$EndEntities\n";
}

// One block per run of equal labels, which keeps the order.
void write_gmsh_4(const Path& file, const TetMesh& mesh, const Groups& groups) {
  refuse_negative_labels(file, mesh, groups);
  io::AtomicFile target(file);
  std::ostream& out = target.stream();
  std::set<int> labels{label_of(mesh, 0)};
  std::vector<Index> runs;  // where each begins
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    if (labels.insert(label_of(mesh, t)).second || t == 0 || label_of(mesh, t) != label_of(mesh, t - 1))
      runs.push_back(t);
  }
  out << "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
  write_names(out, groups);
  write_entities(out, mesh, labels, groups);
  const Index n = mesh.vertex_count();
  out << "$Nodes\n1 " << n << " 1 " << n << "\n3 " << *labels.begin() + 1 << " 0 " << n << '\n';
  for (Index v = 0; v < n; ++v) out << v + 1 << '\n';
  for (Index v = 0; v < n; ++v) out << position(mesh, v) << '\n';
  const Index tets = mesh.tet_count();
  const std::size_t elements = std::size_t(tets) + triangles_in(groups);
  out << "$EndNodes\n$Elements\n"
      << runs.size() + groups.surfaces.size() << ' ' << elements << " 1 " << elements << '\n';
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const Index end = r + 1 < runs.size() ? runs[r + 1] : tets;
    out << "3 " << label_of(mesh, runs[r]) + 1 << " 4 " << end - runs[r] << '\n';
    for (Index t = runs[r]; t < end; ++t) out << t + 1 << ' ' << corners(mesh, t, 1) << '\n';
  }
  std::int64_t element = tets;
  for (const SurfaceGroup& group : groups.surfaces) {
    out << "2 " << group.number << " 2 " << group.triangles.size() << '\n';
    for (const auto& triangle : group.triangles) out << ++element << ' ' << corners(triangle) << '\n';
  }
  out << "$EndElements\n";
  target.commit();
}

void write_vtu_alone(const Path& file, const TetMesh& mesh, const Groups& groups) {
  write_grouped_vtu(file, mesh, groups, {}, {});
}

const std::map<std::string, void (*)(const Path&, const TetMesh&, const Groups&)> writers = {
    {".vtu", write_vtu_alone}, {".vtk", write_vtk},     {".msh", write_gmsh_4}, {".msh2", write_gmsh_2},
    {".mesh", write_medit},    {".node", write_tetgen}, {".ele", write_tetgen}};

}  // namespace

bool can_write_mesh(const Path& file) { return writers.contains(io::lower_case(file.extension().string())); }

bool holds_groups(const Path& file) {
  const std::string extension = io::lower_case(file.extension().string());
  return extension == ".vtu" || extension == ".msh" || extension == ".msh2" || extension == ".mesh";
}

void write_grouped_mesh(const Path& file, const TetMesh& mesh, const Groups& groups) {
  if (!groups.empty() && !holds_groups(file))
    throw InputError(file.string(), "this format holds no groups: expected .vtu, .msh, .msh2 or .mesh");
  const auto writer = writers.find(io::lower_case(file.extension().string()));
  if (writer == writers.end())
    throw InputError(file.string(),
                     "unknown extension '" + file.extension().string() +
                         "', expected .vtu, .vtk, .msh (4.1), .msh2 (2.2), .mesh, .node or .ele");
  if (mesh.tet_count() == 0) throw InputError(file.string(), "the mesh has no tetrahedron");
  writer->second(file, mesh, groups);
}

void write_mesh(const Path& file, const TetMesh& mesh) { write_grouped_mesh(file, mesh, {}); }

}  // namespace lobe
