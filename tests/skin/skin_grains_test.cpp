// A skin on what a blade has cut.
#include <doctest/doctest.h>

#include <random>
#include <set>

#include "lobe/mesh/refine.h"
#include "lobe/scalpel/incise.h"
#include "lobe/sim/world.h"
#include "lobe/skin/skin.h"
#include "near.h"
#include "textured.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double plane = 0.0437;   // where x is that the blade falls [m]
constexpr double snapped = 0.003;  // the cut is off it by at most a tenth of an edge [m]

// Through a body of 0.1 m: from above, `depth` deep.
ScalpelSetup blade_at(const Vec3d& low, const Vec3d& along, double begin, double depth) {
  const Vec3d down(0, 0, -depth);
  return {"blade", 0.1, {{begin, low}, {begin + 0.04, low + down}}, {low + along, low + along + down}};
}

ScalpelSetup plain_blade(double depth) { return blade_at({plane, -0.1, 0.12}, {0, 0.3, 0}, 0.001, depth); }

struct Played {
  Setup setup;
  TexturedSurface surface;
  Skin skin, at_once;
  World<double> world;

  Played(const TexturedSurface& own, std::vector<ScalpelSetup> blades, const Setup& body)
      : setup(with(body, std::move(blades))),
        surface(own),
        skin(surface, setup.mesh),
        at_once(skin),
        world(setup) {
    world.on_cut(
        [&](const Topology& topology, const MeshEdit& edit) { skin.follow(topology, edit, world.grains()); });
  }
  static Setup with(Setup setup, std::vector<ScalpelSetup> blades) {
    setup.scalpels = std::move(blades);
    return setup;
  }
  void play(int frames) {
    for (int i = 0; i < frames; ++i) REQUIRE(world.advance(0.01).ok);
  }

  // At rest, in double precision.
  Vec3d rest_of(Index vertex) const {
    const SkinMesh& mesh = skin.mesh();
    const Index first = mesh.vertex_count() - static_cast<Index>(mesh.between.size());
    const auto of_file = [&](Index v) -> Vec3d {
      return surface.points.col(mesh.file_vertex[std::size_t(v)]);
    };
    if (vertex < first) return of_file(vertex);
    const SkinMesh::Between& own = mesh.between[std::size_t(vertex - first)];
    return (1 - double(own.share)) * of_file(own.a) + double(own.share) * of_file(own.b);
  }
  double area() const {
    double sum = 0;
    for (const Eigen::Vector3i& t : skin.mesh().triangles) {
      const Vec3d a = rest_of(t[0]), b = rest_of(t[1]), c = rest_of(t[2]);
      sum += (b - a).cross(c - a).norm() / 2;
    }
    return sum;
  }

  // Every piece is moved away by itself. How far an edge of a triangle is longer than at rest, the most of
  // all [m]; how many pieces carry some of the skin.
  double longest_bridge(std::set<int>& carrying) {
    const Topology& topology = world.elements().topology;
    State<double> state = world.state();
    const auto pieces = topology.pieces();
    const auto away = [](std::size_t piece) { return Vec3d(double(piece), 0, 0); };
    state.u.setZero();
    for (std::size_t i = 0; i < pieces.size(); ++i)
      for (Index t : pieces[i])
        for (Index v : topology.corners(t)) state.u.col(v) = away(i);
    Mat3X<float> x, normals;
    skin.update(world.elements().points.view(), state.u, x, normals);
    double longest = 0;
    for (const Eigen::Vector3i& t : skin.mesh().triangles)
      for (int k = 0; k < 3; ++k) {
        const Index a = t[k], b = t[(k + 1) % 3];
        const double now = double((x.col(a) - x.col(b)).norm()), before = (rest_of(a) - rest_of(b)).norm();
        longest = std::max(longest, std::abs(now - before));
        carrying.insert(int(std::lround(x(0, a) - rest_of(a).x())));
        CHECK(normals.col(a).allFinite());
      }
    return longest;
  }
};

// Triangles by where their corners are, for a displacement that tells sides apart.
std::multiset<std::array<float, 9>> drawn(Skin& skin, const World<double>& world) {
  const Index count = world.elements().topology.vertex_count();
  Mat3X<double> u(3, count);
  for (Index v = 0; v < count; ++v) u.col(v) = 1e-3 * Vec3d(v % 7, v % 11, v % 13);
  Mat3X<float> x, normals;
  skin.update(world.elements().points.view(), u, x, normals);
  std::multiset<std::array<float, 9>> found;
  for (const Eigen::Vector3i& t : skin.mesh().triangles) {
    std::array<float, 9> own{};
    for (int k = 0; k < 9; ++k) own[std::size_t(k)] = x(k % 3, t[k / 3]);
    found.insert(own);
  }
  return found;
}

}  // namespace

TEST_CASE("a skin opens along the cut: nothing of it is lost, and each triangle goes with one side") {
  const Setup body = setup_of(irregular_box(5, 0.02));
  for (const TexturedSurface& surface :
       {textured_boundary(refine(refine(body.mesh).mesh).mesh), textured_boundary(body.mesh),
        fine_boundary_of(body.mesh, 1, 1.03), fine_boundary_of(body.mesh, 1, 0.97)}) {
    Played played(surface, {plain_blade(0.15)}, body);
    const double before = played.area();
    played.play(6);
    REQUIRE(played.world.elements().topology.pieces().size() == 2);
    CHECK(played.skin.is_divided());
    CHECK(played.area() == near(before, 1e-12));
    std::set<int> carrying;
    CHECK(played.longest_bridge(carrying) < 1e-5);
    CHECK(carrying.size() == 2);
    // The line is where the blade was.
    double farthest = 0;
    for (const Eigen::Vector3i& t : played.skin.mesh().triangles)
      for (Index v : t)
        if (v >= played.skin.mesh().vertex_count() - Index(played.skin.mesh().between.size()))
          farthest = std::max(farthest, std::abs(played.rest_of(v).x() - plane));
    CHECK(farthest > 0);
    CHECK(farthest < 2 * snapped);
    played.at_once.follow_all(played.world.elements().topology, played.world.grains());
    CHECK(drawn(played.at_once, played.world) == drawn(played.skin, played.world));
  }
}

TEST_CASE("where cuts cross, each piece has its own part of the skin") {
  const Setup body = setup_of(irregular_box(5, 0.02));
  const std::vector<ScalpelSetup> blades{plain_blade(0.15),
                                         blade_at({-0.1, 0.0561, 0.12}, {0.3, 0.004, 0}, 0.041, 0.15),
                                         blade_at({-0.1, -0.09, 0.12}, {0.3, 0.29, 0}, 0.081, 0.15)};
  for (const TexturedSurface& surface :
       {textured_boundary(refine(body.mesh).mesh), fine_boundary_of(body.mesh, 2, 1.02)}) {
    Played played(surface, blades, body);
    const double before = played.area();
    played.play(14);
    const std::size_t pieces = played.world.elements().topology.pieces().size();
    CHECK(pieces >= 6);
    CHECK(played.area() == near(before, 1e-12));
    std::set<int> carrying;
    CHECK(played.longest_bridge(carrying) < 1e-5);
    CHECK(carrying.size() == pieces);
  }
}

TEST_CASE("cuts at random lose nothing of the skin, and no triangle bridges pieces") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> part(-0.03, 0.03);
  const Setup body = setup_of(irregular_box(4, 0.025));
  for (int trial = 0; trial < 12; ++trial) {
    std::vector<ScalpelSetup> blades;
    for (int i = 0; i < 4; ++i) {
      const double angle = 2.5 * trial + 0.8 * i;
      const Vec3d along(std::cos(angle), std::sin(angle), 0);
      const Vec3d middle(0.05 + part(random), 0.05 + part(random), 0.12);
      blades.push_back(blade_at(middle - 0.15 * along, 0.3 * along + Vec3d(0, 0, part(random)),
                                0.001 + 0.04 * i, i % 2 == 0 ? 0.16 : 0.07));
      blades.back().along_faces = trial % 4 == 3;
    }
    Played played(trial % 3 == 0 ? textured_boundary(body.mesh)
                                 : fine_boundary_of(body.mesh, 1, 0.97 + 0.03 * (trial % 3)),
                  blades, body);
    const double before = played.area();
    played.play(18);
    const std::size_t pieces = played.world.elements().topology.pieces().size();
    CHECK(pieces >= 2);
    CHECK(played.area() == near(before, 1e-12));
    std::set<int> carrying;
    CHECK(played.longest_bridge(carrying) < 1e-5);
    CHECK(carrying.size() <= pieces);
    played.at_once.follow_all(played.world.elements().topology, played.world.grains());
    CHECK(drawn(played.at_once, played.world) == drawn(played.skin, played.world));
  }
}

TEST_CASE("half a cut opens the skin as far as it goes, and a reader of what changed has all of it") {
  const Setup body = setup_of(irregular_box(5, 0.02));
  Played played(textured_boundary(refine(body.mesh).mesh), {plain_blade(0.075)}, body);
  const double before = played.area();
  std::vector<Eigen::Vector3i> triangles = played.skin.mesh().triangles;
  std::vector<Eigen::Vector2f> texture = played.skin.mesh().texture;
  std::uint64_t seen = played.skin.mesh().revision;
  const std::uint64_t at_start = seen;
  for (int i = 0; i < 6; ++i) {
    played.play(1);
    const SkinMesh& mesh = played.skin.mesh();
    CHECK(played.area() == near(before, 1e-12));
    triangles.resize(mesh.triangles.size());
    texture.resize(mesh.texture.size());
    if (const auto slots = mesh.changed_triangles.since(seen)) {
      for (Index slot : *slots)
        if (slot < mesh.triangle_count()) triangles[std::size_t(slot)] = mesh.triangles[std::size_t(slot)];
    } else {
      triangles = mesh.triangles;
    }
    if (const auto slots = mesh.changed_vertices.since(seen)) {
      for (Index slot : *slots) texture[std::size_t(slot)] = mesh.texture[std::size_t(slot)];
    } else {
      texture = mesh.texture;
    }
    CHECK(triangles == mesh.triangles);
    CHECK(texture == mesh.texture);
    seen = mesh.revision;
  }
  CHECK(seen > at_start);
  CHECK(played.world.elements().topology.pieces().size() == 1);
  // Both sides of the gap: vertices at one place of the skin that different tetrahedra carry.
  std::multiset<std::array<double, 3>> places;
  std::set<Index> used;
  for (const Eigen::Vector3i& t : played.skin.mesh().triangles) used.insert(t.begin(), t.end());
  for (Index v : used)
    if (v >= played.skin.mesh().vertex_count() - Index(played.skin.mesh().between.size())) {
      const Vec3d X = played.rest_of(v);
      places.insert({X[0], X[1], X[2]});
      CHECK(X.z() > 0.1 - 0.075 - 0.02);  // not an edge further than the blade has come
    }
  CHECK(places.size() > 20);
  CHECK(std::all_of(places.begin(), places.end(), [&](const auto& X) { return places.count(X) >= 2; }));
  played.at_once.follow_all(played.world.elements().topology, played.world.grains());
  CHECK(drawn(played.at_once, played.world) == drawn(played.skin, played.world));
}

TEST_CASE("a cautery takes parts of the skin with the copies on which they lie") {
  const Setup body = setup_of(irregular_box(5, 0.02));
  Played played(textured_boundary(refine(body.mesh).mesh), {plain_blade(0.15)}, body);
  played.play(6);
  const double before = played.area();
  const Topology& topology = played.world.elements().topology;
  std::vector<Index> burnt;  // of the copies at the skin every second one, and some whole tetrahedra
  for (Index t = topology.tet_count() - topology.tet_copy_count(); t < topology.tet_count(); t += 2)
    burnt.push_back(t);
  for (Index t = 0; t < 40; t += 5) burnt.push_back(t);
  played.world.remove_tets(burnt);
  CHECK(played.area() < before);
  CHECK(played.area() > before / 2);
  std::set<int> carrying;
  CHECK(played.longest_bridge(carrying) < 1e-5);
  std::vector<Index> rest;
  for (Index t = 0; t < topology.tet_count(); ++t)
    if (topology.alive(t)) rest.push_back(t);
  played.world.remove_tets(rest);
  CHECK(played.skin.mesh().triangle_count() == 0);
}

TEST_CASE(
    "a skin that is not told of grains keeps to the tetrahedra of the start, and shows no triangle across a "
    "gap of "
    "tetrahedra") {
  Setup setup = setup_of(irregular_box(5, 0.02));
  setup.scalpels.push_back(plain_blade(0.15));
  const TexturedSurface surface = textured_boundary(refine(setup.mesh).mesh);
  Skin skin(surface, setup.mesh);
  World<double> world(setup);
  world.on_cut([&](const Topology& topology, const MeshEdit& edit) { skin.follow(topology, edit); });
  for (int i = 0; i < 6; ++i) world.advance(0.01);
  world.remove_tets({world.elements().topology.tet_count() - 1, 0, 7});  // of which the first is a copy
  CHECK(skin.mesh().triangle_count() > 0);
  CHECK(skin.mesh().triangle_count() < surface.triangles.cols());
}
