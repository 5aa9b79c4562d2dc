#include "lobe/mesh/joined_mesh.h"

#include <algorithm>

#include "lobe/error.h"

namespace lobe {
namespace {

// One label per tetrahedron.
std::vector<int> all_labels(const TetMesh& mesh) {
  std::vector<int> labels = mesh.labels;
  labels.resize(std::size_t(mesh.tet_count()), 0);
  return labels;
}

// 3 × #tetrahedra, zero where the mesh has no fibres.
Mat3X<double> all_fibres(const TetMesh& mesh) {
  return mesh.fibres.cols() > 0 ? mesh.fibres : Mat3X<double>::Zero(3, mesh.tet_count());
}

template <class Columns>
void append_columns(const Columns& added, Columns& to) {
  const Eigen::Index before = to.cols();
  to.conservativeResize(Eigen::NoChange, before + added.cols());
  to.rightCols(added.cols()) = added;
}

// The vertices after those of the bodies before.
Index end_of_body(const TetMesh& mesh, int body) {
  if (body + 1 == int(mesh.bodies.count())) return mesh.vertex_count();
  Index end = 0;
  for (Index t = 0; t < mesh.tet_count(); ++t)
    if (mesh.bodies.body_of(t) <= body) end = std::max(end, mesh.tets.col(t).maxCoeff() + 1);
  return end;
}

}  // namespace

void append_body(const TetMesh& body, const std::string& name, TetMesh& mesh) {
  if (mesh.bodies.names.size() == MeshBodies::most)
    throw InputError(name, "is one body too many: a mesh has at most " + std::to_string(MeshBodies::most));
  if (mesh.fibres.cols() > 0 || body.fibres.cols() > 0) {
    mesh.fibres = all_fibres(mesh);
    append_columns(all_fibres(body), mesh.fibres);
  }
  mesh.labels = all_labels(mesh);
  const std::vector<int> labels = all_labels(body);
  mesh.labels.insert(mesh.labels.end(), labels.begin(), labels.end());
  const auto number = std::uint8_t(mesh.bodies.names.size());
  mesh.bodies.names.push_back(name);
  mesh.bodies.of.insert(mesh.bodies.of.end(), std::size_t(body.tet_count()), number);
  append_columns(Tets(body.tets.array() + mesh.vertex_count()), mesh.tets);
  append_columns(body.points, mesh.points);
}

TetMesh tets_of_body(const TetMesh& mesh, int body) {
  std::vector<Index> tets;
  for (Index t = 0; t < mesh.tet_count(); ++t)
    if (mesh.bodies.body_of(t) == body) tets.push_back(t);
  TetMesh part;
  part.points = mesh.points;
  part.tets = mesh.tets(Eigen::all, tets);
  if (mesh.fibres.cols() > 0) part.fibres = mesh.fibres(Eigen::all, tets);
  const std::vector<int> labels = all_labels(mesh);
  for (const Index t : tets) part.labels.push_back(labels[std::size_t(t)]);
  return part;
}

TetMesh mesh_of_body(const TetMesh& mesh, int body) {
  const Index begin = body == 0 ? 0 : end_of_body(mesh, body - 1), end = end_of_body(mesh, body);
  TetMesh part = tets_of_body(mesh, body);
  if (part.tet_count() > 0 && (part.tets.minCoeff() < begin || part.tets.maxCoeff() >= end))
    throw InputError("mesh", "its vertices are not numbered body by body");
  part.points = Mat3X<double>(mesh.points.middleCols(begin, end - begin));
  part.tets.array() -= begin;
  return part;
}

}  // namespace lobe
