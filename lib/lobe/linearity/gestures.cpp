#include "lobe/linearity/gestures.h"

#include <algorithm>
#include <limits>
#include <set>

#include "lobe/mesh/outer_faces.h"
#include "lobe/setup/boundary_conditions.h"

namespace lobe {
namespace {

std::set<Index> held_vertices(const Setup& setup) {
  std::set<Index> held;
  for (const PrescribedVertex& p : setup.prescribed) held.insert(p.vertex);
  return held;
}

// Area-weighted normals of the surface, outwards [m²], zero within: 3 × #vertices.
Mat3X<double> surface_normals(const TetMesh& mesh) {
  Mat3X<double> normals = Mat3X<double>::Zero(3, mesh.vertex_count());
  for (const TetFace& face : outer_faces(mesh)) {
    std::array<Vec3d, 3> p;
    for (int c = 0; c < 3; ++c) p[c] = mesh.points.col(mesh.tets(face_corners[face.face][c], face.tet));
    const Vec3d inside = mesh.points.col(mesh.tets(face.face, face.tet));
    Vec3d normal = (p[1] - p[0]).cross(p[2] - p[0]);
    if (normal.dot(inside - p[0]) > 0) normal = -normal;
    for (int corner : face_corners[face.face]) normals.col(mesh.tets(corner, face.tet)) += normal;
  }
  return normals;
}

void lower(std::vector<double>& distance, const TetMesh& mesh, Index from) {
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    distance[v] = std::min(distance[v], (mesh.points.col(v) - mesh.points.col(from)).norm());
}

}  // namespace

Setup at_the_end_of(const Gesture& gesture, const Setup& setup) {
  Setup end = setup;
  static_cast<ToolSetups&>(end) = {};
  const std::set<Index> held = held_vertices(setup);
  for (std::size_t i = 0; i < gesture.displacements.size(); ++i)
    if (!held.contains(gesture.vertices[i]))
      end.prescribed.push_back({gesture.vertices[i], gesture.displacements[i]});
  if (gesture.displacements.empty())
    for (Index v : gesture.vertices)
      end.vertex_loads.push_back({v, gesture.force / double(gesture.vertices.size())});
  return end;
}

std::vector<Gesture> gestures_of_grasps(const Setup& setup) {
  std::vector<Gesture> gestures;
  for (const GraspSetup& grasp : setup.grasps) {
    const auto furthest = std::max_element(
        grasp.path.begin(), grasp.path.end(),
        [](const PathPoint& a, const PathPoint& b) { return a.position.norm() < b.position.norm(); });
    if (furthest == grasp.path.end() || furthest->position.isZero(0)) continue;
    std::vector<Index> vertices = grasp.vertices;
    std::erase_if(vertices, [&](Index v) { return v >= setup.mesh.vertex_count(); });  // copies
    if (vertices.empty()) continue;
    std::vector<Vec3d> displacements(vertices.size(), furthest->position);
    gestures.push_back({grasp.name, std::move(vertices), std::move(displacements), Vec3d::Zero()});
  }
  return gestures;
}

std::vector<Gesture> usual_gestures(const Setup& setup) {
  constexpr int places = 5;
  const TetMesh& mesh = setup.mesh;
  const Mat3X<double> normals = surface_normals(mesh);
  const Box box = bounding_box(mesh);
  const double diagonal = (box.max - box.min).norm(), grip = diagonal / 20;
  std::vector<double> distance(std::size_t(mesh.vertex_count()), std::numeric_limits<double>::max());
  const std::set<Index> held = held_vertices(setup);
  for (Index v : held) lower(distance, mesh, v);
  std::vector<Gesture> gestures;
  for (int i = 0; i < places; ++i) {
    Index place = -1;
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (!normals.col(v).isZero(0) && (place < 0 || distance[v] > distance[place])) place = v;
    if (place < 0 || distance[place] < grip) break;
    lower(distance, mesh, place);
    Gesture& gesture = gestures.emplace_back();
    gesture.name = "pull " + std::to_string(i + 1);
    const Vec3d pull = diagonal / 10 * normals.col(place).normalized();
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
      if ((mesh.points.col(v) - mesh.points.col(place)).norm() > grip || held.contains(v)) continue;
      gesture.vertices.push_back(v);
      gesture.displacements.push_back(pull);
    }
  }
  return gestures;
}

std::vector<StaticLoad> static_loads(const Setup& setup) {
  Setup resting = setup;
  static_cast<ToolSetups&>(resting) = {};
  StaticLoad weight{"weight", resting, {}};
  if (setup.gravity.isZero(0)) {
    weight.name = "weight, 9.81 m/s² along −z";
    weight.setup.gravity = {0, 0, -9.81};
  }
  std::vector<StaticLoad> loads{std::move(weight)};
  for (const Gesture& gesture : gestures_of_grasps(setup))
    loads.push_back({gesture.name, at_the_end_of(gesture, setup), gesture.vertices});
  return loads;
}

}  // namespace lobe
