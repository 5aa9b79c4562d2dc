#include "lobe/scalpel/grains.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numeric>
#include <random>

#include "knife.h"
#include "lobe/io/mesh_io.h"
#include "near.h"
#include "rebuilt.h"

using namespace lobe;
using namespace lobe::test;

namespace {

TetMesh cube(int n = 8) { return box_mesh(Vec3d::Constant(0.1), n, n, n); }

Rebuilt rebuilt_of(const Knife& knife) { return {knife.grains, knife.elements.topology}; }

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

  const Rebuilt rebuilt = rebuilt_of(knife);
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
  CHECK(rebuilt_of(knife).pieces == pieces);
}

const Vec3d middle = Vec3d::Constant(0.05);

// A full stroke along a plane or a wave with a curvature times edge up to 1, whose rows often meet vertices,
// edges and diagonals exactly. Whether it leaves no bridge, and as many pieces of the simulation as of the
// grains.
bool is_parted(int trial, const TetMesh& mesh) {
  std::mt19937 random(static_cast<unsigned>(trial));
  std::uniform_real_distribution<double> uniform(0, 1);
  std::uniform_int_distribution<int> small(-2, 2);
  Knife knife(mesh);
  const Vec3d low = mesh.points.rowwise().minCoeff(), high = mesh.points.rowwise().maxCoeff();
  const double size = (high - low).norm();
  Vec3d normal(small(random), small(random), small(random)), through = (low + high) / 2;
  if (normal.isZero()) normal = Vec3d(1, 0, 0);
  const bool is_exact = trial % 2 == 0;
  if (is_exact) {
    through = mesh.points.col(int(uniform(random) * mesh.vertex_count()));  // on a vertex
    through += ((low + high) / 2 - through) / 2;                            // or halfway to the middle
  } else {
    normal += 0.3 * Vec3d(uniform(random), uniform(random), uniform(random));
  }
  const double length = size * (0.4 + 0.6 * uniform(random)), wave = 2 * M_PI / length;
  const double height = trial % 3 == 0 ? uniform(random) / knife.grains.mean_edge() / (wave * wave) : 0;
  knife.plane(normal, through, (height > 0 ? 40 : 1) + int(40 * uniform(random)), 1, 1.2 * size, height,
              wave);
  const Vec3d n = normal.normalized(), along = n.unitOrthogonal();
  const auto distance = [&](const Vec3d& X) {
    return n.dot(X - through) - height * std::sin(wave * along.dot(X - through));
  };
  if (has_bridge(knife.grains, distance)) return false;
  const Rebuilt rebuilt = rebuilt_of(knife);
  return rebuilt.faults == 0 && rebuilt.odd_edges == 0 &&
         rebuilt.pieces == Index(knife.elements.topology.pieces().size());
}

// Ordered ones, and the shipped liver.
TetMesh mesh_of_stroke(int trial) {
  if (trial % 25 != 24) return cube(4 + trial % 3);
  static const TetMesh liver = read_mesh(std::string(LOBE_DATA_DIR) + "/meshes/liver_2k.vtu").mesh;
  return liver;
}

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

TEST_CASE(
    "planes that cross leave eight pieces, on vertices and aslant, and each edge of their surface is between "
    "two triangles") {
  const TetMesh mesh = cube();
  Knife straight(mesh), slanted(mesh);
  for (const Vec3d& normal : {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)})
    straight.plane(normal, middle, 3);
  check_pieces(straight, mesh, 8);
  for (const Vec3d& normal : {Vec3d(1, 0.2, 0), Vec3d(0.1, 1, 0), Vec3d(0, 0.3, 1)})
    slanted.plane(normal, middle, 3);
  check_pieces(slanted, mesh, 8);
  for (const Knife* knife : {&straight, &slanted}) CHECK(rebuilt_of(*knife).edges_not_between_two == 0);
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
    CHECK(rebuilt_of(knife).pieces == 2);
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

namespace {

Vec3d middle_of(const Grains& grains, Index g) {
  Vec3d sum = Vec3d::Zero();
  for (Index p : grains[g].points) sum += grains.point(p) / 4;
  return sum;
}

// The area of all faces between tetrahedra whose middles lie on both sides of a surface, by more than a
// margin [m], and of those that may: a cut along faces opens no less and no more.
template <class Distance>
std::pair<double, double> area_between_sides(const TetMesh& mesh, double margin, Distance&& distance) {
  const Grains grains{Elements(setup_of(mesh))};
  std::pair<double, double> area{0, 0};
  for (Index g = 0; g < grains.count(); ++g)
    for (int f = 0; f < 4; ++f) {
      const Index other = grains.neighbour(g, f);
      if (other < g) continue;
      const double a = distance(middle_of(grains, g)), b = distance(middle_of(grains, other));
      if (std::min(a, b) < -margin && std::max(a, b) > margin) area.first += grains.area(4 * g + f);
      if (std::min(a, b) <= margin && std::max(a, b) >= -margin) area.second += grains.area(4 * g + f);
    }
  return area;
}

// Into how many pieces a plane between the middles of grains parts them, but for crumbs.
Index pieces_between_sides(const Knife& knife, const Vec3d& normal, const Vec3d& through) {
  const Grains& grains = knife.grains;
  Sets sets(grains.count());
  const auto is_above = [&](Index g) { return normal.dot(middle_of(grains, g) - through) > 0; };
  for (Index g = 0; g < grains.count(); ++g)
    for (int f = 0; f < 4; ++f)
      if (const Index other = grains.neighbour(g, f); other >= 0 && is_above(g) == is_above(other))
        sets.join(g, other);
  std::map<Index, double> volumes;
  for (Index g = 0; g < grains.count(); ++g) volumes[sets.of(g)] += grains.volume(g);
  Index pieces = 0;
  for (const auto& [set, volume] : volumes) pieces += volume >= 1e-3 * grains.mean_volume();
  return pieces;
}

}  // namespace

TEST_CASE("along faces no tetrahedron is divided, and planes, waves and closed paths leave no bridge") {
  const TetMesh mesh = cube();
  const struct {
    Vec3d normal, offset;
    int steps;
    double height;
  } cuts[] = {{{1, 0, 0}, {0, 0, 0}, 1, 0},  // on vertices, between the middles of tetrahedra
              {{1, 0, 0}, {0.004, 0, 0}, 3, 0},
              {{1, 1, 0}, {0, 0, 0}, 7, 0},
              {{1, 2, 3}, {0, 0, 0}, 13, 0},
              {{0.1, 1, 0.2}, {0, 0, 0}, 60, 0.004}};
  for (const auto& cut : cuts) {
    Knife knife(mesh, 0.1, true);
    knife.plane(cut.normal, middle + cut.offset, cut.steps, 1, 0.2, cut.height, 60);
    check_pieces(knife, mesh, 2);
    CHECK(knife.grains.count() == mesh.tet_count());
    CHECK(knife.elements.topology.tet_count() == mesh.tet_count());
    // The sheet is made of planes between 60 rows: it is off a wave by their sagitta.
    const Vec3d n = cut.normal.normalized(), along = n.unitOrthogonal();
    const double margin = 1e-12 + cut.height * 60 * 60 * std::pow(0.4 / cut.steps, 2) / 8;
    const auto [least, most] = area_between_sides(mesh, margin, [&](const Vec3d& X) {
      const Vec3d x = X - middle - cut.offset;
      return n.dot(x) - cut.height * std::sin(60 * along.dot(x));
    });
    CHECK(knife.area >= least * (1 - 1e-12));
    CHECK(knife.area <= most * (1 + 1e-12));
    CHECK(knife.area > 0.01 - 1e-12);  // what parts the cube covers it, seen along x
  }
}

TEST_CASE("a cut along faces may cross one that divides tetrahedra") {
  const TetMesh mesh = irregular_box(6, 0.1 / 6);
  Knife knife(mesh);
  knife.plane({1, 0.2, 0.1}, middle, 3);
  knife.set_along_faces(true);
  const Index pieces = pieces_between_sides(knife, {0.1, 1, 0.3}, middle);
  CHECK(pieces >= 4);  // grains between both cuts may stand alone
  knife.plane({0.1, 1, 0.3}, middle, 3);
  check_pieces(knife, mesh, pieces);
}

TEST_CASE("a corner that is hardly there is not cut off, and one that is there comes off") {
  const TetMesh mesh = cube();
  const double edge = 0.1 / 8;
  for (const double share : {0.05, 0.5}) {
    Knife knife(mesh, 0.02);
    knife.plane({1, 1, 1}, Vec3d::Constant(share * edge / 3), 1);
    const bool is_crumb = share < 0.1;
    check_pieces(knife, mesh, is_crumb ? 1 : 2);
    CHECK((knife.crumbs > 0) == is_crumb);
  }
}

TEST_CASE("mesh and blade that are turned, mirrored or renumbered together give the same grains") {
  const TetMesh mesh = irregular_box(4, 0.025);
  const Mat3<double> turn = Eigen::AngleAxisd(0.7, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
  const Mat3<double> mirror = Vec3d(-1, 1, 1).asDiagonal();
  std::mt19937 random(2);
  std::vector<Index> order(std::size_t(mesh.vertex_count()));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), random);
  const Vec3d n(1, 2, 3), along = n.normalized().unitOrthogonal(), edge = n.normalized().cross(along);
  const auto cut = [&](const TetMesh& changed, const Mat3<double>& A) {
    Knife knife(changed);
    const auto row = [&](double x) {
      const Vec3d p = middle + x * along;
      return std::vector<Vec3d>{A * (p - 0.2 * edge), A * (p + 0.2 * edge)};
    };
    knife.begin();
    for (int i = 0; i < 6; ++i) knife.sweep(row(-0.2 + i * 0.05), row(-0.15 + i * 0.05));
    std::vector<double> shares;
    for (Index g = 0; g < knife.grains.count(); ++g) shares.push_back(knife.grains.volume(g));
    std::sort(shares.begin(), shares.end());
    check_invariants(knife, changed);
    return std::pair(knife.area, shares);
  };
  const auto transformed = [&](const Mat3<double>& A) {
    TetMesh body_mesh = mesh;
    body_mesh.points = A * mesh.points;
    if (A.determinant() < 0) body_mesh.tets.row(0).swap(body_mesh.tets.row(1));
    return body_mesh;
  };
  TetMesh renumbered = mesh;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    renumbered.points.col(order[std::size_t(v)]) = mesh.points.col(v);
  renumbered.tets = mesh.tets.unaryExpr([&](Index v) { return order[std::size_t(v)]; });
  renumbered.tets.rowwise().reverseInPlace();
  const Mat3<double> none = Mat3<double>::Identity();
  const auto [area, volumes] = cut(mesh, none);
  for (const Mat3<double>& A : {turn, mirror}) {
    const auto [other_area, others] = cut(transformed(A), A);
    CHECK(other_area == near(area, 1e-9));
    REQUIRE(others.size() == volumes.size());
    for (std::size_t i = 0; i < others.size(); ++i) CHECK(std::abs(others[i] - volumes[i]) < 1e-15);
  }
  // Edges around a grain are bisected in the order of their numbers: the same surface, by other grains.
  CHECK(cut(renumbered, none).first == near(area, 1e-9));
}

TEST_CASE("five thousand full strokes with degenerate paths leave no bridge") {
#ifdef LOBE_SANITIZED  // sixteen times as slow
  constexpr int strokes = 400;
#else
  constexpr int strokes = 5000;
#endif
  for (int trial = 0; trial < strokes; ++trial) CHECK(is_parted(trial, mesh_of_stroke(trial)));
}

TEST_CASE(
    "a blade that turns far more sharply than the mesh is fine leaves crumbs and bridges, but loses "
    "nothing") {
  const TetMesh mesh = irregular_box(5, 0.02);
  const double edge = Grains(Elements(setup_of(mesh))).mean_edge();
  for (const double curvature : {2.0, 3.0, 5.0}) {  // times the edge
    const double wave = 2 * M_PI / 0.05;
    Knife knife(mesh);
    knife.plane({1, 2, 3}, middle, 150, 1, 0.2, curvature / edge / (wave * wave), wave);
    check_invariants(knife, mesh);
    CHECK(knife.area > 0.01);
  }
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
  const Index first = rebuilt_of(knife).pieces;
  CHECK(first >= 2);
  knife.plane({0.1, 1, 0.3}, centre, 60, 1, 0.3, 0.004, 60);
  check_invariants(knife, mesh);
  CHECK(rebuilt_of(knife).pieces > first);
}
