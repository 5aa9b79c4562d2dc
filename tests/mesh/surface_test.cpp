#include "lobe/mesh/surface.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <tuple>

#include "lobe/fem/body.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A body that is cut, its vertices away from where they were, and the surface that follows it.
struct CutBody {
  explicit CutBody(const TetMesh& mesh)
      : points(mesh.points),
        u(random_displacement(mesh.vertex_count(), 1e-3)),
        topology(mesh),
        region_of(std::size_t(mesh.tet_count()), RegionModel::nonlinear),
        surface(topology, region_of) {}

  MeshEdit remove(const std::vector<Index>& tets) {
    const MeshEdit edit = topology.remove(tets);
    points.conservativeResize(3, topology.vertex_count());
    u.conservativeResize(3, topology.vertex_count());
    for (const VertexSplit& split : edit.splits) {
      points.col(split.copy) = points.col(split.vertex);
      u.col(split.copy) = u.col(split.vertex) + Vec3d(1e-4, 2e-4, 3e-4);
    }
    surface.follow(topology, edit, region_of);
    return edit;
  }

  void set_region(const std::vector<Index>& tets, RegionModel model) {
    for (Index t : tets) region_of[t] = model;
    surface.follow_regions(TetCells(topology), tets, region_of);
  }

  Mat3X<double> x() const { return points + u; }

  Mat3X<double> points, u;  // [m]
  Topology topology;
  std::vector<RegionModel> region_of;
  Surface surface;
};

using Side = std::pair<Index, int>;  // of a vertex of the mesh: 1 on cut faces
using Marked = std::tuple<Index, std::uint32_t, std::array<Side, 3>, RegionModel, int>;

std::set<Marked> triangles_of(const SurfaceMesh& mesh) {
  std::set<Marked> all;
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    std::array<Side, 3> corners;
    for (int i = 0; i < 3; ++i) {
      const Index vertex = mesh.triangles[t][i];
      corners[i] = {mesh.mesh_vertex[vertex], mesh.vertex_cut[vertex]};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    all.emplace(mesh.owner[t].tet, mesh.owner[t].code, corners, mesh.region[t], mesh.cut[t]);
  }
  CHECK(all.size() == std::size_t(mesh.triangle_count()));
  return all;
}

std::map<Side, Vec3d> normals_of(const SurfaceMesh& mesh, const Mat3X<double>& X, const Mat3X<double>& u) {
  Mat3X<double> x, normals;
  update_positions(mesh, X, u, x);
  update_normals(mesh, x, normals);
  std::map<Side, Vec3d> of_side;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    of_side[{mesh.mesh_vertex[v], mesh.vertex_cut[v]}] = normals.col(v);
  CHECK(of_side.size() == std::size_t(mesh.vertex_count()));
  return of_side;
}

// Every edge of the mesh is passed as often one way as the other.
void check_closed(const SurfaceMesh& mesh) {
  std::map<std::pair<Index, Index>, int> passed;
  for (const Eigen::Vector3i& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      const Index a = mesh.mesh_vertex[t[i]], b = mesh.mesh_vertex[t[(i + 1) % 3]];
      passed[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  for (const auto& [edge, surplus] : passed) CHECK(surplus == 0);
}

// By what the tetrahedra were at the start: their faces that two of them share were inside.
void check_marks(const SurfaceMesh& mesh, const TetMesh& start, const std::vector<RegionModel>& region_of) {
  std::set<std::pair<Index, int>> outer;
  const Topology uncut(start);
  for (Index code : uncut.boundary_faces()) outer.insert({code / 4, code % 4});
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const bool is_outer = outer.contains({mesh.owner[t].tet, int(mesh.owner[t].code)});
    CHECK(int(mesh.cut[t]) == (is_outer ? 0 : 2));  // tetrahedra are removed, not parted
    CHECK(mesh.region[t] == region_of[mesh.owner[t].tet]);
  }
}

void check_lookups(const Surface& surface, const Topology& topology) {
  const SurfaceMesh& mesh = surface.mesh();
  for (Index t = 0; t < mesh.triangle_count(); ++t) CHECK(surface.triangle_of(mesh.owner[t]) == t);
  Index found = 0;
  for (Index v = 0; v < topology.vertex_count(); ++v)
    for (const bool cut : {false, true}) {
      const Index vertex = surface.vertex_of(v, cut);
      if (vertex < 0) continue;
      REQUIRE(vertex < mesh.vertex_count());
      CHECK(mesh.mesh_vertex[vertex] == v);
      CHECK(bool(mesh.vertex_cut[vertex]) == cut);
      ++found;
    }
  CHECK(found == mesh.vertex_count());
}

double volume_of_tets(const CutBody& body) {
  const Mat3X<double> x = body.x();
  double volume = 0;
  for (Index t = 0; t < body.topology.tet_count(); ++t)
    if (body.topology.alive(t)) volume += signed_volume(x(Eigen::all, body.topology.corners(t)));
  return volume;
}

void check_against_fresh(const CutBody& body, const TetMesh& start) {
  const SurfaceMesh& mesh = body.surface.mesh();
  const Surface fresh(body.topology, body.region_of);
  CHECK(triangles_of(mesh) == triangles_of(fresh.mesh()));
  CHECK(mesh.vertex_count() == fresh.mesh().vertex_count());
  const auto normals = normals_of(mesh, body.points, body.u);
  for (const auto& [side, normal] : normals_of(fresh.mesh(), body.points, body.u))
    CHECK((normals.at(side) - normal).norm() < 1e-9);
  check_closed(mesh);
  check_marks(mesh, start, body.region_of);
  check_lookups(body.surface, body.topology);
  Mat3X<double> x;
  update_positions(mesh, body.points, body.u, x);
  CHECK(std::abs(enclosed_volume(mesh, x) - volume_of_tets(body)) <= 1e-12 * total_volume(start));
}

// Arrays of a reader who takes over nothing but the slots that are said to have changed.
struct Mirror {
  void update(const SurfaceMesh& mesh) {
    const auto triangle_slots = mesh.changed_triangles.since(revision);
    const auto vertex_slots = mesh.changed_vertices.since(revision);
    triangles.resize(mesh.triangles.size(), Eigen::Vector3i::Constant(-1));
    region.resize(mesh.region.size());
    mesh_vertex.resize(mesh.mesh_vertex.size(), -1);
    if (!triangle_slots || !vertex_slots) {
      ++copies;
      triangles = mesh.triangles;
      region = mesh.region;
      mesh_vertex = mesh.mesh_vertex;
    } else {
      for (Index t : *triangle_slots)
        if (t < mesh.triangle_count()) triangles[t] = mesh.triangles[t], region[t] = mesh.region[t];
      for (Index v : *vertex_slots)
        if (v < mesh.vertex_count()) mesh_vertex[v] = mesh.mesh_vertex[v];
    }
    revision = mesh.revision;
  }

  std::uint64_t revision = 0;
  int copies = 0;
  std::vector<Eigen::Vector3i> triangles;
  std::vector<RegionModel> region;
  std::vector<Index> mesh_vertex;
};

std::vector<Index> shuffled_tets(Index count, unsigned seed) {
  std::vector<Index> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  return order;
}

// V − E + F of the surface as a surface of vertices of the mesh.
Index euler_characteristic(const SurfaceMesh& mesh) {
  std::set<Index> vertices(mesh.mesh_vertex.begin(), mesh.mesh_vertex.end());
  std::map<std::pair<Index, Index>, int> edges;
  for (const Eigen::Vector3i& t : mesh.triangles)
    for (int i = 0; i < 3; ++i)
      ++edges[std::minmax(mesh.mesh_vertex[t[i]], mesh.mesh_vertex[t[(i + 1) % 3]])];
  for (const auto& [edge, count] : edges) CHECK(count == 2);
  return Index(vertices.size()) - Index(edges.size()) + mesh.triangle_count();
}

// The tetrahedra of those cells of a box of n × n × n for which this holds.
template <class Where>
std::vector<Index> cells(int n, Where&& where) {
  std::vector<Index> tets;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        if (where(i, j, k))
          for (int s = 0; s < 6; ++s) tets.push_back(6 * (i + n * (j + n * k)) + s);
  return tets;
}

// Tetrahedra from the centre to the faces of a polyhedron around it.
TetMesh star_of(const Mat3X<double>& corners, const std::vector<Eigen::Vector3i>& faces) {
  TetMesh mesh;
  mesh.points.resize(3, corners.cols() + 1);
  mesh.points << corners, Vec3d::Zero();
  mesh.tets.resize(4, Eigen::Index(faces.size()));
  for (std::size_t f = 0; f < faces.size(); ++f) {
    mesh.tets.col(Eigen::Index(f)) << Index(corners.cols()), faces[f];
    if (signed_volume(tet_points(mesh, Index(f))) < 0) std::swap(mesh.tets(1, f), mesh.tets(2, f));
  }
  return mesh;
}

}  // namespace

TEST_CASE(
    "after any sequence of cuts the surface is the one built afresh: closed, marked, creased, of the body's "
    "volume") {
  for (const TetMesh& start : {irregular_box(4), cylinder_mesh(0.02, 0.04, 3, 3)})
    for (const Index batch : {1, 5, 40}) {
      CutBody body(start);
      check_against_fresh(body, start);
      const std::vector<Index> order = shuffled_tets(start.tet_count(), 3 + unsigned(batch));
      for (Index i = 0; i < start.tet_count(); i += batch) {
        body.remove({order.begin() + i, order.begin() + std::min(start.tet_count(), i + batch)});
        body.set_region({order[i], order[order.size() - 1 - std::size_t(i)]}, RegionModel(i / batch % 3));
        if (batch > 1 || i % 7 == 0) check_against_fresh(body, start);
      }
      CHECK(body.surface.mesh().triangle_count() == 0);
      CHECK(body.surface.mesh().vertex_count() == 0);
    }
}

TEST_CASE("a reader that takes over the changed slots alone has the same arrays, however seldom it looks") {
  const TetMesh start = irregular_box(6);
  for (const int every : {1, 3, 10}) {
    CutBody body(start);
    Mirror mirror;
    mirror.update(body.surface.mesh());
    CHECK(mirror.copies == 1);
    const std::vector<Index> order = shuffled_tets(start.tet_count(), 5);
    int edits = 0;
    for (Index i = 0; i + 4 <= start.tet_count(); i += 4) {
      body.remove({order.begin() + i, order.begin() + i + 4});
      body.set_region({order[order.size() - 1 - std::size_t(i)]}, RegionModel::tensor_mass);
      if (++edits % every != 0) continue;
      const SurfaceMesh& mesh = body.surface.mesh();
      mirror.update(mesh);
      CHECK(mirror.triangles == mesh.triangles);
      CHECK(mirror.region == mesh.region);
      CHECK(mirror.mesh_vertex == mesh.mesh_vertex);
    }
    CHECK(mirror.copies < edits / every / 2);  // the log is of use
  }
}

TEST_CASE("a revision that is unknown or forgotten means that everything may have changed") {
  SlotLog log;
  log.restart(7);
  CHECK_FALSE(log.since(6));
  CHECK_FALSE(log.since(8));
  REQUIRE(log.since(7));
  CHECK(log.since(7)->empty());
  log.next(3);
  log.record(1);
  log.record(2);
  log.next(3);
  log.record(5);
  CHECK(log.since(7)->size() == 3);
  REQUIRE(log.since(8)->size() == 1);
  CHECK(log.since(8)->front() == 5);
  log.next(3);  // more than three are remembered
  log.record(9);
  CHECK_FALSE(log.since(8));
  REQUIRE(log.since(9)->size() == 1);
  CHECK(log.since(9)->front() == 9);
}

TEST_CASE(
    "what stays keeps its slot while the surface grows, and a cut of one tetrahedron changes four triangles "
    "at most") {
  const TetMesh start = irregular_box(6);
  CutBody body(start);
  int grown = 0;
  for (Index t : shuffled_tets(start.tet_count(), 9)) {
    const SurfaceMesh before = body.surface.mesh();
    const MeshEdit edit = body.remove({t});
    const SurfaceMesh& after = body.surface.mesh();
    CHECK(after.revision == before.revision + 1);
    if (after.triangle_count() < before.triangle_count() || after.vertex_count() < before.vertex_count())
      continue;
    ++grown;
    for (Index i = 0; i < before.triangle_count(); ++i)
      if (before.owner[i].tet != t) CHECK(body.surface.triangle_of(before.owner[i]) == i);
    for (Index i = 0; i < before.vertex_count(); ++i) {
      const Index now = body.surface.vertex_of(before.mesh_vertex[i], before.vertex_cut[i]);
      CHECK((now == i || now < 0));
    }
    const auto changed = after.changed_triangles.since(before.revision);
    if (changed && edit.splits.empty()) CHECK(changed->size() <= 4);
  }
  CHECK(grown > start.tet_count() / 3);
}

TEST_CASE("the revision grows with what changes, and with nothing else") {
  CutBody body(irregular_box(3));
  const std::uint64_t start = body.surface.revision();
  body.remove({});
  body.set_region({0, 1, 2}, RegionModel::nonlinear);
  CHECK(body.surface.revision() == start);
  body.remove({5});
  CHECK(body.surface.revision() == start + 1);
  body.remove({5});
  CHECK(body.surface.revision() == start + 1);
  body.set_region({body.surface.mesh().owner[0].tet}, RegionModel::precomputed);
  CHECK(body.surface.revision() == start + 2);
  body.surface.rebuild(body.topology, body.region_of);
  CHECK(body.surface.revision() == start + 3);
  CHECK_FALSE(body.surface.mesh().changed_triangles.since(start + 2));
  CHECK(body.surface.mesh().changed_triangles.since(start + 3)->empty());
}

TEST_CASE("a hollow has a surface of its own, a tunnel makes a torus, two halves are two spheres") {
  const TetMesh box = box_mesh(Vec3d::Constant(0.05), 5, 5, 5);
  CHECK(euler_characteristic(CutBody(box).surface.mesh()) == 2);
  CutBody hollow(box), tunnel(box), halves(box);
  hollow.remove(cells(5, [](int i, int j, int k) { return i == 2 && j == 2 && k == 2; }));
  CHECK(euler_characteristic(hollow.surface.mesh()) == 4);
  tunnel.remove(cells(5, [](int i, int j, int) { return i == 2 && j == 2; }));
  CHECK(euler_characteristic(tunnel.surface.mesh()) == 0);
  halves.remove(cells(5, [](int i, int, int) { return i == 2; }));
  CHECK(euler_characteristic(halves.surface.mesh()) == 4);
  check_against_fresh(halves, box);
}

TEST_CASE("normals of a box look along its axes, at its edges halfway between them") {
  const int n = 4;
  const TetMesh box = box_mesh(Vec3d::Constant(0.04), n, n, n);
  const Topology topology(box);
  const std::vector<RegionModel> regions(std::size_t(box.tet_count()), RegionModel::nonlinear);
  const Surface surface(topology, regions);
  const auto normals = normals_of(surface.mesh(), box.points, Mat3X<double>::Zero(3, box.vertex_count()));
  int compared = 0;
  for (const auto& [side, normal] : normals) {
    const Eigen::Vector3i at(side.first % (n + 1), side.first / (n + 1) % (n + 1),
                             side.first / ((n + 1) * (n + 1)));
    Vec3d expected = Vec3d::Zero();
    for (int axis = 0; axis < 3; ++axis) expected[axis] = at[axis] == 0 ? -1 : at[axis] == n ? 1 : 0;
    if (expected.squaredNorm() > 2) continue;  // a corner: as its triangles happen to lie
    CHECK((normal - expected.normalized()).norm() < 1e-14);
    ++compared;
  }
  CHECK(compared == 6 * 9 + 12 * 3);
}

TEST_CASE("normals of an octahedron and of an icosahedron are those of the sphere around them") {
  Mat3X<double> octahedron(3, 6), icosahedron(3, 12);
  octahedron << Mat3<double>::Identity(), -Mat3<double>::Identity();
  const double g = std::numbers::phi;
  for (int i = 0; i < 4; ++i)
    for (int axis = 0; axis < 3; ++axis) {
      auto p = icosahedron.col(3 * i + axis);
      p[axis] = 0, p[(axis + 1) % 3] = i % 2 == 0 ? 1 : -1, p[(axis + 2) % 3] = i < 2 ? g : -g;
    }
  for (const Mat3X<double>& corners : {octahedron, icosahedron}) {
    double edge = 1e300;
    for (int i = 1; i < corners.cols(); ++i) edge = std::min(edge, (corners.col(i) - corners.col(0)).norm());
    std::vector<Eigen::Vector3i> faces;
    const auto touch = [&](int i, int j) { return (corners.col(i) - corners.col(j)).norm() < 1.01 * edge; };
    for (int i = 0; i < corners.cols(); ++i)
      for (int j = 0; j < i; ++j)
        for (int k = 0; k < j; ++k)
          if (touch(i, j) && touch(j, k) && touch(i, k)) faces.emplace_back(i, j, k);
    REQUIRE(faces.size() == (corners.cols() == 6 ? 8 : 20));
    const TetMesh mesh = star_of(corners, faces);
    const CutBody body(mesh);
    CHECK(body.surface.mesh().vertex_count() == corners.cols());  // the centre is inside
    for (const auto& [side, normal] : normals_of(body.surface.mesh(), mesh.points, 0 * mesh.points))
      CHECK((normal - mesh.points.col(side.first).normalized()).norm() < 1e-14);
  }
}

TEST_CASE(
    "a cut is creased: the rim of a trench has the skin's normal on one side, the wall's on the other") {
  const int n = 4;
  CutBody body(box_mesh(Vec3d::Constant(0.04), n, n, n));
  body.remove(cells(n, [](int i, int, int k) { return i >= 2 && k == 3; }));  // half of the upper layer
  const auto number = [](int i, int j, int k) { return i + 5 * (j + 5 * k); };
  const auto normals = normals_of(body.surface.mesh(), body.points, 0 * body.u);
  for (int j = 1; j < n; ++j) {
    const Index rim = number(2, j, 4), floor = number(3, j, 3), wall = number(1, j, 4);
    CHECK((normals.at({rim, 0}) - Vec3d::UnitZ()).norm() < 1e-14);
    CHECK((normals.at({rim, 1}) - Vec3d::UnitX()).norm() < 1e-14);
    CHECK((normals.at({floor, 1}) - Vec3d::UnitZ()).norm() < 1e-14);
    CHECK_FALSE(normals.contains({floor, 0}));
    CHECK((normals.at({wall, 0}) - Vec3d::UnitZ()).norm() < 1e-14);
    CHECK_FALSE(normals.contains({wall, 1}));
  }
}

TEST_CASE(
    "positions in single precision are those in double precision, rounded once; normals turn with the body") {
  const TetMesh start = irregular_box(4);
  CutBody body(start);
  body.remove({100, 101, 102, 250});
  const SurfaceMesh& mesh = body.surface.mesh();
  Mat3X<double> x, normals;
  update_positions(mesh, body.points, body.u, x);
  update_normals(mesh, x, normals);
  const Mat3X<float> u = body.u.cast<float>();
  Mat3X<float> x_single, normals_single;
  update_positions(mesh, body.points, u, x_single);
  update_normals(mesh, x_single, normals_single);
  Mat3X<double> x_rounded_u;
  update_positions(mesh, body.points, u.cast<double>().eval(), x_rounded_u);
  CHECK(x_single == x_rounded_u.cast<float>());
  CHECK((normals_single.cast<double>() - normals).cwiseAbs().maxCoeff() < 1e-4);

  const Mat3<double> R = Eigen::AngleAxisd(1.2, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
  Mat3X<double> turned;
  update_normals(mesh, Mat3X<double>(R * x), turned);
  CHECK((turned - R * normals).cwiseAbs().maxCoeff() < 1e-12);
}
