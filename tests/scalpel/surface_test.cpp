// The surface of a body that blades have cut.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <random>

#include "knife.h"
#include "lobe/scalpel/grain_cells.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/validate.h"
#include "near.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Steps of strokes in all directions through the middle of a body at rest, none all the way.
struct Strokes {
  explicit Strokes(const TetMesh& mesh, int count) : knife(mesh) {
    std::mt19937 random(11);
    std::normal_distribution<double> normal;
    const Box box = bounding_box(mesh);
    const Vec3d centre = (box.min + box.max) / 2;
    const double r = (box.max - box.min).norm() / 2;
    for (int i = 0; i < count; ++i) {
      knife.begin();
      const Vec3d n = Vec3d(normal(random), normal(random), normal(random)).normalized(),
                  along = n.unitOrthogonal(), edge = n.cross(along);
      const auto row = [&](double x) {
        return std::vector<Vec3d>{centre + x * along - 2 * r * edge, centre + x * along + 2 * r * edge};
      };
      for (int k = 0; k < 4; ++k)
        steps.push_back(knife.sweep(row(r * (-1 + 0.35 * k)), row(r * (-0.65 + 0.35 * k))).incision);
    }
  }
  Knife knife;
  std::vector<Incision> steps;
};

using Marked = std::tuple<Index, std::uint32_t, std::array<Index, 3>, RegionModel, int>;

std::vector<Index> points_of_vertices(const Surface& surface, const SurfaceCells& cells) {
  const SurfaceMesh& mesh = surface.mesh();
  std::vector<Index> points(std::size_t(mesh.vertex_count()), -1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (Index v : mesh.triangles[t]) {
      points[std::size_t(v)] = surface.point_of(v);
      CHECK(surface.vertex_of(surface.point_of(v), mesh.cut[t], cells.stroke_of(Index(mesh.owner[t].code))) ==
            v);
      CHECK(bool(mesh.vertex_cut[std::size_t(v)]) == bool(mesh.cut[t]));
    }
  CHECK(std::count(points.begin(), points.end(), -1) == 0);
  return points;
}

std::set<Marked> marked_triangles(const Surface& surface, const SurfaceCells& cells) {
  const SurfaceMesh& mesh = surface.mesh();
  const std::vector<Index> points = points_of_vertices(surface, cells);
  std::set<Marked> all;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Index, 3> places;
    for (int k = 0; k < 3; ++k) places[std::size_t(k)] = points[std::size_t(mesh.triangles[t][k])];
    const bool is_burnt = mesh.cut[t] != 0 && cells.stroke_of(Index(mesh.owner[t].code)) < 0;
    CHECK(is_burnt == (mesh.cut[t] == 2));
    all.emplace(mesh.owner[t].tet, mesh.owner[t].code, places, mesh.region[t], mesh.cut[t]);
  }
  CHECK(all.size() == mesh.triangles.size());
  return all;
}

void check_closed_at_points(const std::set<Marked>& triangles) {
  std::map<std::pair<Index, Index>, int> passed;
  for (const Marked& marked : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = std::get<2>(marked)[k], b = std::get<2>(marked)[(k + 1) % 3];
      passed[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  for (const auto& [edge, surplus] : passed) CHECK(surplus == 0);
}

// Of all tetrahedra, the share that each fills, as they are deformed.
double volume_now(World<double>& world) {
  double volume = 0;
  const Elements& elements = world.elements();
  const Mat3X<double> x = elements.points.view() + world.displacements();
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    if (elements.topology.alive(t))
      volume += elements.share_of(t) * signed_volume(x(Eigen::all, elements.topology.corners(t)));
  return volume;
}

double area_of(const SurfaceMesh& mesh, const Mat3X<double>& x, bool cut) {
  double area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3d a = x.col(mesh.triangles[t][0]), b = x.col(mesh.triangles[t][1]),
                c = x.col(mesh.triangles[t][2]);
    if (bool(mesh.cut[t]) == cut) area += (b - a).cross(c - a).norm() / 2;
  }
  return area;
}

Mat3X<double> at_rest(World<double>& world) {
  Mat3X<double> x;
  const Mat3X<double> none = Mat3X<double>::Zero(3, world.elements().topology.vertex_count());
  update_positions(world.surface().mesh(), world.elements().points.view(), none, x);
  return x;
}

void check_against_fresh_surface(World<double>& world) {
  const Surface& surface = world.surface();
  const std::unique_ptr<SurfaceCells> cells = surface_cells(world.elements(), world.grains());
  const Surface fresh(*cells, world.elements().region_of);
  const std::set<Marked> triangles = marked_triangles(surface, *cells);
  CHECK(triangles == marked_triangles(fresh, *cells));
  CHECK(surface.mesh().vertex_count() == fresh.mesh().vertex_count());
  CHECK(surface.mesh().within.size() == fresh.mesh().within.size());
  check_closed_at_points(triangles);
  Mat3X<double> x;
  update_positions(surface.mesh(), world.elements().points.view(), world.displacements(), x);
  CHECK(enclosed_volume(surface.mesh(), x) == near(volume_now(world), 1e-12));
  const Mat3X<double> X = at_rest(world);
  const std::vector<Index> points = points_of_vertices(surface, *cells);
  for (std::size_t v = 0; v < points.size(); ++v)
    CHECK((X.col(Eigen::Index(v)) - world.grains()->point(points[v])).norm() < 1e-14);
  validate(world);
}

World<double> shaken_world(const Setup& setup) {
  World<double> world(setup);
  State<double> state = world.state();
  state.u = random_displacement<double>(setup.mesh.vertex_count(), 1e-3);
  world.set_state(state);
  return world;
}

}  // namespace

TEST_CASE(
    "after strokes, removals and changes of region the surface is the one built afresh: closed, of the "
    "body's "
    "volume, its vertices where the grains' points are") {
  const TetMesh mesh = irregular_box(4);
  World<double> world = shaken_world(hybrid_setup(mesh));
  world.surface();
  const Strokes strokes(mesh, 4);
  int edits = 0;
  for (const Incision& step : strokes.steps) {
    if (step.empty()) continue;
    const std::uint64_t before = world.surface().revision();
    incise(world, {step});
    CHECK(world.surface().revision() > before);
    if (++edits % 3 == 0) check_against_fresh_surface(world);
  }
  CHECK(world.elements().topology.tet_copy_count() > 20);
  check_against_fresh_surface(world);
  for (Index first = 0; first < 40; first += 10) {
    std::vector<Index> tets, others;
    for (Index t = first; t < world.elements().topology.tet_count(); t += 41) tets.push_back(t);
    world.remove_tets(tets);
    check_against_fresh_surface(world);
    for (Index t = first + 3; t < world.elements().topology.tet_count(); t += 17)
      if (world.elements().topology.alive(t)) others.push_back(t);
    world.apply(SetRegion{others, RegionModel::nonlinear});
    check_against_fresh_surface(world);
  }
}

TEST_CASE("a cut leaves the area of the skin as it was, and shows both sides of what it has opened") {
  const TetMesh mesh = irregular_box(4);
  World<double> world(setup_of(mesh));
  const double skin = area_of(world.surface().mesh(), at_rest(world), false);
  const Strokes strokes(mesh, 3);
  for (const Incision& step : strokes.steps)
    if (!step.empty()) incise(world, {step});
  const Mat3X<double> X = at_rest(world);
  CHECK(area_of(world.surface().mesh(), X, false) == near(skin, 1e-12));
  CHECK(area_of(world.surface().mesh(), X, true) == near(2 * strokes.knife.area, 1e-12));
}

TEST_CASE("each part of a block that planes have parted is a ball: its surface has Euler's number 2") {
  const TetMesh mesh = irregular_box(4);
  World<double> world(setup_of(mesh));
  Knife knife(mesh);
  const Box box = bounding_box(mesh);
  const Vec3d centre = (box.min + box.max) / 2;
  const double r = (box.max - box.min).norm();
  for (const Vec3d& normal : {Vec3d(1, 0.2, 0.1), Vec3d(0.1, 1, -0.3), Vec3d(-0.2, 0.3, 1)}) {
    knife.begin();
    const Vec3d n = normal.normalized(), along = n.unitOrthogonal(), edge = n.cross(along);
    const auto row = [&](double x) {
      return std::vector<Vec3d>{centre + x * along - r * edge, centre + x * along + r * edge};
    };
    incise(world, {knife.sweep(row(-r), row(r)).incision});
  }
  const std::unique_ptr<SurfaceCells> cells = surface_cells(world.elements(), world.grains());
  const std::set<Marked> triangles = marked_triangles(world.surface(), *cells);
  Sets parts(cells->point_count());
  std::set<Index> points;
  std::set<std::pair<Index, Index>> edges;
  for (const Marked& marked : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = std::get<2>(marked)[k], b = std::get<2>(marked)[(k + 1) % 3];
      parts.join(a, b);
      points.insert(a);
      edges.insert(std::minmax(a, b));
    }
  std::map<Index, Index> euler;
  for (Index p : points) ++euler[parts.of(p)];
  for (const auto& [a, b] : edges) --euler[parts.of(a)];
  for (const Marked& marked : triangles) ++euler[parts.of(std::get<2>(marked)[0])];
  CHECK(euler.size() == 8);
  CHECK(world.elements().topology.pieces().size() == 8);
  for (const auto& [part, number] : euler) CHECK(number == 2);
}

TEST_CASE("lips are sharp: normals of the skin and of a plane cut are those of the planes up to the edge") {
  World<double> world(setup_of(box_mesh({0.1, 0.04, 0.04}, 10, 4, 4)));
  world.surface();
  Knife knife(box_mesh({0.1, 0.04, 0.04}, 10, 4, 4));
  knife.begin();
  const auto row = [](double z) { return std::vector<Vec3d>{{0.045, -0.1, z}, {0.045, 0.1, z}}; };
  incise(world, {knife.sweep(row(0.1), row(-0.1)).incision});
  CHECK(world.elements().topology.pieces().size() == 2);
  const SurfaceMesh& mesh = world.surface().mesh();
  const Mat3X<double> X = at_rest(world);
  Mat3X<double> normals;
  update_normals(mesh, X, normals);
  Index lips = 0, faces = 0;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3d p = X.col(v);
    if (std::abs(p.x() - 0.045) > 1e-12) continue;
    if (mesh.vertex_cut[std::size_t(v)]) {
      CHECK(std::abs(normals(0, v)) == near(1, 1e-12));
      ++faces;
    } else if (p.y() > 0.001 && p.y() < 0.039) {
      CHECK(std::abs(normals(2, v)) == near(1, 1e-12));
      ++lips;
    }
  }
  CHECK(lips > 10);
  CHECK(faces > 40);
}

TEST_CASE("where two plane cuts cross, each of their normals is that of its plane") {
  const TetMesh block = box_mesh({0.04, 0.04, 0.04}, 4, 4, 4);
  World<double> world(setup_of(block));
  world.surface();
  Knife knife(block, 1e-6);  // no point moves onto the planes
  const Vec3d across[] = {Vec3d(1, 0.2, 0.1).normalized(), Vec3d(-0.3, 1, 0.2).normalized()};
  const Vec3d middle(0.021, 0.019, 0.02);
  for (const Vec3d& n : across) {
    const Vec3d along = n.unitOrthogonal(), edge = n.cross(along);
    knife.begin();
    const auto row = [&](double x) {
      return std::vector<Vec3d>{middle + x * along - 0.1 * edge, middle + x * along + 0.1 * edge};
    };
    for (const double x : {-0.1, 0.0}) incise(world, {knife.sweep(row(x), row(x + 0.1)).incision});
  }
  CHECK(world.elements().topology.pieces().size() == 4);
  check_against_fresh_surface(world);
  const SurfaceMesh& mesh = world.surface().mesh();
  const Mat3X<double> X = at_rest(world);
  Mat3X<double> normals;
  update_normals(mesh, X, normals);
  std::map<Index, std::set<int>> planes_at;  // per point
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (!mesh.vertex_cut[std::size_t(v)]) continue;
    const double first = std::abs(across[0].dot(normals.col(v))),
                 second = std::abs(across[1].dot(normals.col(v)));
    CHECK(std::max(first, second) == near(1, 1e-12));
    planes_at[world.surface().point_of(v)].insert(first > second ? 0 : 1);
  }
  const auto creased =
      std::count_if(planes_at.begin(), planes_at.end(), [](const auto& at) { return at.second.size() == 2; });
  CHECK(creased > 4 * 4);
  CHECK(std::size_t(creased) < planes_at.size() / 2);
}

TEST_CASE("a reader that takes over the changed slots alone has the same surface, and a step changes few") {
  const TetMesh mesh = box_mesh({0.3, 0.04, 0.04}, 30, 4, 4);
  World<double> world(setup_of(mesh));
  std::vector<Eigen::Vector3i> triangles = world.surface().mesh().triangles;
  std::vector<Index> vertices = world.surface().mesh().mesh_vertex;
  int copies = 0;
  Knife knife(mesh);
  const auto row = [](double x, double z) { return std::vector<Vec3d>{{x, -0.1, z}, {x + 0.01, 0.1, z}}; };
  for (const double x : {0.043, 0.151, 0.244}) {
    knife.begin();
    for (int k = 0; k < 10; ++k) {
      const Incision step = knife.sweep(row(x, 0.045 - 0.004 * k), row(x, 0.041 - 0.004 * k)).incision;
      const std::uint64_t before = world.surface().revision();
      if (!step.empty()) incise(world, {step});
      const SurfaceMesh& now = world.surface().mesh();
      if (now.revision == before) continue;
      // The first makes the grains, and with them all of the surface.
      const auto changed = now.changed_triangles.since(before), moved = now.changed_vertices.since(before);
      if (!changed || !moved) {
        ++copies;
        triangles = now.triangles;
        vertices = now.mesh_vertex;
        continue;
      }
      CHECK(changed->size() < now.triangles.size() / 3);
      triangles.resize(now.triangles.size());
      vertices.resize(now.mesh_vertex.size());
      for (Index t : *changed)
        if (t < now.triangle_count()) triangles[std::size_t(t)] = now.triangles[std::size_t(t)];
      for (Index v : *moved)
        if (v < now.vertex_count()) vertices[std::size_t(v)] = now.mesh_vertex[std::size_t(v)];
      CHECK(triangles == now.triangles);
      CHECK(vertices == now.mesh_vertex);
    }
  }
  CHECK(copies <= 3);
  CHECK(world.surface().mesh().within.size() > 100);
}

TEST_CASE("a world that goes back to a checkpoint shows the surface of then") {
  const TetMesh mesh = irregular_box(4);
  World<double> world(setup_of(mesh));
  world.surface();
  const auto whole = world.save();
  const Strokes strokes(mesh, 2);
  for (const Incision& step : strokes.steps)
    if (!step.empty()) incise(world, {step});
  const auto cut = world.save();
  const Index triangles = world.surface().mesh().triangle_count();
  world.restore(whole);
  CHECK(world.surface().mesh().within.empty());
  CHECK(std::size_t(world.surface().mesh().triangle_count()) ==
        world.elements().topology.boundary_faces().size());
  validate(world);
  world.restore(cut);
  CHECK(world.surface().mesh().triangle_count() == triangles);
  check_against_fresh_surface(world);
}
