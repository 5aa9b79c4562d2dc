#include "lobe/scalpel/grains.h"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "knife.h"
#include "lobe/io/mesh_io.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

TetMesh cube(int n = 8) { return box_mesh(Vec3d::Constant(0.1), n, n, n); }

// Of all that holds whatever was cut.
void check_invariants(const Knife& knife, const TetMesh& mesh) {
  const Grains& grains = knife.grains;
  double worst = 0, sum = 0;
  bool all_positive = true;
  for (Index g = 0; g < grains.count(); ++g) {
    Mat34<double> X;
    for (int k = 0; k < 4; ++k) X.col(k) = grains.point(grains[g].points[k]);
    const double whole = signed_volume(tet_points(mesh, knife.elements.topology.parent(grains[g].element)));
    all_positive = all_positive && grains[g].share > 0;
    worst = std::max(worst, std::abs(signed_volume(X) / whole - grains[g].share));
  }
  CHECK(all_positive);
  CHECK(worst < 1e-12);
  std::vector<double> filled(std::size_t(mesh.tet_count()), 0);
  for (Index t = 0; t < knife.elements.topology.tet_count(); ++t) {
    filled[std::size_t(knife.elements.topology.parent(t))] += knife.elements.share_of(t);
    sum += knife.elements.volume(t);
  }
  for (const double share : filled) CHECK(std::abs(share - 1) < 1e-12);
  CHECK(sum == near(total_volume(mesh), 1e-12));

  const Rebuilt rebuilt(knife);
  CHECK(rebuilt.faults == 0);
  CHECK(rebuilt.odd_edges == 0);
  CHECK(rebuilt.same_vertices);
  CHECK(rebuilt.same_tets);
  CHECK(rebuilt.tets == knife.elements.topology.alive_count());
  CHECK(rebuilt.vertices == knife.elements.topology.vertex_count());
  CHECK(rebuilt.pieces == Index(knife.elements.topology.pieces().size()));
}

void check_pieces(const Knife& knife, const TetMesh& mesh, Index pieces) {
  check_invariants(knife, mesh);
  CHECK(Rebuilt(knife).pieces == pieces);
}

const Vec3d middle = Vec3d::Constant(0.05);

}  // namespace

TEST_CASE("a plane through vertices of an ordered cube opens faces, and copies no tetrahedron") {
  const TetMesh mesh = cube();
  Knife knife(mesh);
  knife.plane({1, 0, 0}, middle, 1);
  check_pieces(knife, mesh, 2);
  CHECK(knife.elements.topology.tet_count() == mesh.tet_count());
  CHECK(knife.elements.topology.vertex_count() == mesh.vertex_count() + 81);
  CHECK(knife.area == near(0.01, 1e-12));
  CHECK(knife.cut_off == 1);
}

TEST_CASE("planes between vertices, along diagonals and aslant leave two pieces") {
  const TetMesh mesh = cube();
  const struct {
    Vec3d normal, offset;
    int steps;
  } cuts[] = {{{1, 0, 0}, {0.004, 0, 0}, 1}, {{1, 1, 0}, {0, 0, 0}, 7}, {{1, 2, 3}, {0, 0, 0}, 13}};
  for (const auto& cut : cuts) {
    Knife knife(mesh);
    knife.plane(cut.normal, middle + cut.offset, cut.steps);
    check_pieces(knife, mesh, 2);
  }
}

TEST_CASE("a plane between vertices opens its own area, whose sides are flat") {
  const TetMesh mesh = cube();
  Knife knife(mesh);
  knife.plane({1, 0, 0}, middle + Vec3d(0.004, 0, 0), 3);
  CHECK(knife.area == near(0.01, 1e-9));
}

TEST_CASE("half a cut leaves one piece, and its other half the second") {
  const TetMesh mesh = cube();
  Knife half(mesh);
  half.plane({1, 2, 3}, middle, 13, 0.5);
  check_pieces(half, mesh, 1);
  CHECK(half.area > 0.003);
}

TEST_CASE("planes that cross leave eight pieces, on vertices and aslant") {
  const TetMesh mesh = cube();
  Knife straight(mesh), slanted(mesh);
  for (const Vec3d& normal : {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)})
    straight.plane(normal, middle, 3);
  check_pieces(straight, mesh, 8);
  for (const Vec3d& normal : {Vec3d(1, 0.2, 0), Vec3d(0.1, 1, 0), Vec3d(0, 0.3, 1)})
    slanted.plane(normal, middle, 3);
  check_pieces(slanted, mesh, 8);
}

TEST_CASE("a cylinder that is cut out is a piece") {
  const TetMesh mesh = cube();
  Knife knife(mesh);
  knife.begin();
  constexpr int steps = 40;
  const auto row = [&](int i) {
    const double angle = 2 * M_PI * (i % steps) / steps;
    const Vec3d p(0.05 + 0.027 * std::cos(angle), 0.05 + 0.031 * std::sin(angle), 0);
    return std::vector<Vec3d>{p - Vec3d(0, 0, 0.1), p + Vec3d(0, 0, 0.2)};
  };
  for (int i = 0; i < steps; ++i) knife.sweep(row(i), row(i + 1));
  check_pieces(knife, mesh, 2);
}

TEST_CASE("a stroke opens about the same area in one sweep, in 7 and in 60") {
  const TetMesh mesh = irregular_box(6, 0.1 / 6);
  std::vector<double> areas;
  for (const int steps : {1, 7, 60}) {
    Knife knife(mesh);
    knife.plane({1, 2, 3}, middle, steps);
    check_invariants(knife, mesh);
    areas.push_back(knife.area);
  }
  CHECK(areas[1] == near(areas[0], 0.02));
  CHECK(areas[2] == near(areas[0], 0.02));
}

TEST_CASE("wavy cuts leave no bridge") {
  const TetMesh mesh = cube();
  const double edge = Grains(Elements(setup_of(mesh))).mean_edge();
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 30; ++trial) {
    const double length = 0.06 + 0.06 * uniform(random), wave = 2 * M_PI / length;
    const double height = uniform(random) / edge / (wave * wave);  // curvature times edge up to 1
    const Vec3d normal(0.3 * (uniform(random) - 0.5), 1, 0.3 * (uniform(random) - 0.5));
    Knife knife(mesh);
    knife.plane(normal, middle + Vec3d(0, 0.02 * (uniform(random) - 0.5), 0), 20 + int(60 * uniform(random)),
                1, 0.2, height, wave);
    CHECK(Rebuilt(knife).pieces == 2);
  }
}

TEST_CASE("a hundred random strokes through one body keep its volume, and what holds of all cuts") {
  const TetMesh mesh = irregular_box(5, 0.02);
  Knife knife(mesh);
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int stroke = 0; stroke < 100; ++stroke) {
    const Vec3d n(normal(random), normal(random), normal(random));
    const Vec3d centre(0.1 * uniform(random), 0.1 * uniform(random), 0.1 * uniform(random));
    knife.plane(n, centre, 4, 1, 0.005 + 0.04 * uniform(random));
  }
  check_invariants(knife, mesh);
}

TEST_CASE("to retrace a path fifty times adds no grain after the first") {
  const TetMesh mesh = irregular_box(5, 0.02);
  Knife knife(mesh);
  knife.plane({1, 2, 3}, middle, 5);
  const Index grains = knife.grains.count();
  for (int i = 0; i < 50; ++i) knife.plane({1, 2, 3}, middle, 5);
  CHECK(knife.grains.count() == grains);
  check_invariants(knife, mesh);
}

TEST_CASE("the shipped liver is cut by crossing waves without a bridge") {
  TetMesh mesh = read_mesh(std::string(LOBE_DATA_DIR) + "/meshes/liver_2k.vtu").mesh;
  Knife knife(mesh);
  const Vec3d centre = mesh.points.rowwise().mean();
  knife.plane({1, 0.2, 0.1}, centre, 60, 1, 0.3, 0.004, 60);
  const Index first = Rebuilt(knife).pieces;
  CHECK(first >= 2);
  knife.plane({0.1, 1, 0.3}, centre, 60, 1, 0.3, 0.004, 60);
  check_invariants(knife, mesh);
  CHECK(Rebuilt(knife).pieces > first);
}
