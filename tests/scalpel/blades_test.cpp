// What a step of a blade leaves out because it cannot matter, against steps that leave out nothing.
#include "lobe/scalpel/blades.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "lobe/io/mesh_io.h"
#include "lobe/mesh/generators.h"
#include "near.h"
#include "rebuilt.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A body that is turned and stretched as one, and blades through it.
struct MappedBody {
  MappedBody(const TetMesh& mesh, bool looks_at_all) : elements(setup_of(mesh)), blades(elements) {
    now.placement = [this](Index t) {
      const Vec3d start = elements.points.col(elements.topology.corners(t)[0]);
      return Placement{start, F * start, F};
    };
    if (!looks_at_all) now.corners = [this](Index t) { return Mat34<double>(F * elements.corner_points(t)); };
    now.tets_in = [this, looks_at_all](const SweptVolume& volume) {
      std::vector<Index> tets(std::size_t(elements.topology.tet_count()));
      std::iota(tets.begin(), tets.end(), 0);
      if (looks_at_all) return tets;
      std::erase_if(tets, [&](Index t) {
        const Mat34<double> x = F * elements.corner_points(t);
        return !volume.box.intersects({x.rowwise().minCoeff(), x.rowwise().maxCoeff()}) ||
               (volume.meets && !volume.meets(x));
      });
      return tets;
    };
  }

  Incised cut(const BladeMove& move) {
    Incised incised = *blades.cut(move, now);
    if (!incised.opened.empty())
      elements.follow(elements.topology.divide(blades.grains.divide(elements.topology, incised.opened)));
    return incised;
  }

  // All steps of a move.
  std::vector<Incised> cut_whole(const BladeMove& move) {
    std::vector<Incised> all;
    for (const BladeMove& step : blades.steps(move)) all.push_back(cut(step));
    return all;
  }

  const Mat3<double> F = Eigen::AngleAxisd(0.7, Vec3d(1, 2, 3).normalized()).toRotationMatrix() *
                         Vec3d(1.1, 0.9, 1.05).asDiagonal();
  Elements elements;
  Blades blades;
  Blades::BodyNow now;
};

// The k-th of n steps of one of two blades, which cross each other.
BladeMove move_of(int tool, int k, int n, const Mat3<double>& F) {
  const Vec3d normal = Vec3d(1, tool == 0 ? 0.3 : -2, 0.2).normalized(), along = normal.unitOrthogonal(),
              edge = normal.cross(along), middle = Vec3d::Constant(0.05);
  const auto pose = [&](int i) {
    const double x = -0.1 + 0.2 * i / n;
    const Vec3d at = F * (middle + x * along + 0.004 * std::sin(60 * x) * normal);
    return BladePose{at - 0.12 * edge, at + 0.12 * edge};
  };
  return {tool, 0, 0.1, pose(k), pose(k + 1)};
}

std::vector<Index> all_with_closed_faces(const Grains& grains, int stroke) {
  std::vector<Index> found;
  for (Index grain = 0; grain < grains.count(); ++grain)
    if (grains.has_closed_face_on(grain, stroke)) found.push_back(grain);
  return found;
}

void check_waiting(Grains& grains, int stroke) {
  std::vector<Index> waiting = grains.waiting(stroke);
  std::sort(waiting.begin(), waiting.end());
  const std::vector<Index> closed = all_with_closed_faces(grains, stroke);
  CHECK(std::includes(waiting.begin(), waiting.end(), closed.begin(), closed.end()));
  Grains restored = grains;
  restored.set_on(grains.on());
  CHECK(restored.waiting(stroke) == closed);
}

}  // namespace

TEST_CASE("a step is two edges long where a blade sweeps a plane, and shorter where it turns") {
  const TetMesh mesh = irregular_box(5, 0.02);
  const MappedBody body(mesh, false);
  const double edge = body.blades.grains.mean_edge();
  const BladePose from{{0, 0, -0.1}, {0, 0, 0.1}};
  const auto steps_to = [&](const Vec3d& of_tip, const Vec3d& of_heel) {
    return body.blades.steps({0, 0, 0.1, from, {from.tip + edge * of_tip, from.heel + edge * of_heel}})
        .size();
  };
  const Vec3d along(1, 0, 0);
  CHECK(steps_to(Vec3d::Zero(), Vec3d::Zero()) == 1);
  CHECK(steps_to(1.9 * along, 1.9 * along) == 1);
  CHECK(steps_to(9 * along, 9 * along) == 5);
  CHECK(steps_to(0.9 * along, -0.9 * along) == 4);  // about its middle
  CHECK(steps_to(5.9 * along, 4 * along) == 4);
}

TEST_CASE("a straight stroke does the same in steps of two edges as in short ones") {
  const TetMesh mesh = irregular_box(5, 0.02);
  const auto cut = [&](int steps) {
    MappedBody body(mesh, false);
    double area = 0;
    for (int k = 0; k < steps; ++k) {
      const auto pose = [&](int i) {
        const Vec3d at = body.F * Vec3d(-0.02 + 0.14 * i / steps, 0.05, 0.047),
                    edge = body.F * Vec3d(0.01, 0.1, 0.02);
        return BladePose{at - edge, at + edge};
      };
      area += body.cut({0, 0, 0.1, pose(k), pose(k + 1)}).area;
    }
    return std::pair(area, body.blades.grains.count());
  };
  const auto [area, grains] = cut(4);
  const auto [area_in_short, grains_in_short] = cut(16);
  CHECK(area == test::near(area_in_short, 1e-9));
  CHECK(grains == grains_in_short);
}

TEST_CASE("a step that looks at what it may reach does what one does that looks at everything") {
  const TetMesh mesh = irregular_box(5, 0.02);
  MappedBody near(mesh, false), all(mesh, true);
  constexpr int steps = 14;
  std::size_t edges = 0, faces = 0;
  for (int k = 0; k < steps; ++k)
    for (int tool : {0, 1}) {
      const Incised some = near.cut(move_of(tool, k, steps, near.F)),
                    same = all.cut(move_of(tool, k, steps, near.F));
      CHECK(some.incision.opened == same.incision.opened);
      REQUIRE(some.incision.bisections.size() == same.incision.bisections.size());
      for (std::size_t i = 0; i < some.incision.bisections.size(); ++i) {
        const auto &a = some.incision.bisections[i], &b = same.incision.bisections[i];
        CHECK(std::pair(a.a, a.b) == std::pair(b.a, b.b));
        CHECK(a.share == test::near(b.share, 1e-9, 1));
      }
      edges += some.incision.bisections.size();
      faces += some.incision.opened.size();
    }
  CHECK(edges > 100);
  CHECK(faces > 200);
  CHECK(near.blades.grains.on() == all.blades.grains.on());
}

TEST_CASE("each closed face on the sheet of a stroke that goes on waits, also where others divide it") {
  MappedBody body(irregular_box(5, 0.02), false);
  constexpr int steps = 14;
  for (int k = 0; k < steps; ++k)
    for (int tool : {0, 1}) {
      body.cut(move_of(tool, k, steps, body.F));
      for (int stroke : {0, 1}) check_waiting(body.blades.grains, stroke);
    }
}

// Around two faces that fill a square of a plane of the mesh, through its corners; then across.
TEST_CASE("faces whose points a blade has passed wait until it comes near their middle") {
  MappedBody body(box_mesh(Vec3d::Constant(0.1), 5, 5, 5), false);
  Grains& grains = body.blades.grains;
  const Vec3d centre(0.05, 0.05, 0.04);
  const double radius = 0.02 / std::sqrt(2);
  const auto pose = [&](int i) {
    const double angle = i * M_PI / 12;
    const Vec3d out(std::cos(angle), std::sin(angle), 0);
    return BladePose{body.F * (centre + radius * out), body.F * (centre + (radius + 0.003) * out)};
  };
  for (int i = 0; i < 24; ++i) {
    body.cut({0, 0, 0.1, pose(i), pose(i + 1)});
    check_waiting(grains, 0);
  }
  const std::vector<Index> waiting = all_with_closed_faces(grains, 0);
  CHECK(waiting.size() == 4);
  const BladePose across{body.F * (centre - Vec3d(0, 0.006, 0)), body.F * (centre + Vec3d(0, 0.006, 0))};
  CHECK(body.cut({0, 0, 0.1, pose(24), across}).incision.opened.size() == 2);
  CHECK(all_with_closed_faces(grains, 0).empty());
  check_waiting(grains, 0);
}

namespace {

// A full stroke of a plane through a body, in frames. Every other plane meets vertices, edges and diagonals
// exactly at rest. Whether it leaves no bridge, and as many pieces of the simulation as of the grains.
bool is_parted(unsigned trial, const TetMesh& mesh) {
  std::mt19937 random(trial);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::uniform_int_distribution<int> small(-2, 2);
  MappedBody body(mesh, false);
  const Box box = bounding_box(mesh);
  const Vec3d centre = (box.min + box.max) / 2;
  const double r = (box.max - box.min).norm();
  Vec3d normal(small(random), small(random), small(random));
  if (normal.isZero()) normal = Vec3d(1, 0, 0);
  Vec3d through = mesh.points.col(int(uniform(random) * mesh.vertex_count()));
  through = (through + centre) / 2;
  if (trial % 2 == 1) normal += 0.3 * Vec3d(uniform(random), uniform(random), uniform(random));
  const Vec3d n = normal.normalized(), along = n.unitOrthogonal(), edge = n.cross(along);
  const int frames = 1 + int(20 * uniform(random));
  const auto pose = [&](int i) {
    const Vec3d at = through + (2.0 * i / frames - 1) * r * along;
    return BladePose{body.F * (at - r * edge), body.F * (at + r * edge)};
  };
  for (int i = 0; i < frames; ++i) body.cut_whole({0, 0, 0.1, pose(i), pose(i + 1)});
  const Grains& grains = body.blades.grains;
  if (has_bridge(grains, [&](const Vec3d& X) { return n.dot(X - through); })) return false;
  const Rebuilt rebuilt(grains, body.elements.topology);
  return rebuilt.faults == 0 && rebuilt.odd_edges == 0 && rebuilt.pieces >= 2 &&
         rebuilt.pieces == Index(body.elements.topology.pieces().size());
}

TetMesh shipped(const char* name) {
  return read_mesh(std::string(LOBE_DATA_DIR) + "/meshes/" + name + ".vtu").mesh;
}

}  // namespace

TEST_CASE("full strokes of blades, in frames and their steps, part ordered cubes and shipped organs") {
#ifdef LOBE_SANITIZED  // sixteen times as slow
  constexpr unsigned strokes = 30;
#else
  constexpr unsigned strokes = 500;
#endif
  const TetMesh organs[] = {shipped("liver_2k"), shipped("liver_10k"), shipped("kidney_15k")};
  for (unsigned trial = 0; trial < strokes; ++trial) {
    CAPTURE(trial);
    const int n = 4 + int(trial % 3);
    CHECK(
        is_parted(trial, trial % 10 == 9 ? organs[trial / 10 % 3] : box_mesh(Vec3d::Constant(0.1), n, n, n)));
  }
}

// Each goes on while others divide the tetrahedra that it has cut half.
TEST_CASE("blades that cross each other on their way, two or three at once, part the body all the same") {
  for (unsigned trial = 0; trial < 60; ++trial) {
    CAPTURE(trial);
    std::mt19937 random(trial);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const int n = 4 + int(trial % 4), frames = 4 + int(trial % 7) * 3, blades = 2 + int(trial % 2);
    MappedBody body(trial % 3 == 0 ? box_mesh(Vec3d::Constant(0.1), n, n, n) : irregular_box(n, 0.1 / n),
                    false);
    const Vec3d middle = Vec3d::Constant(0.05);
    std::array<Vec3d, 3> normals, ways;  // of the sheets, and along them
    for (int tool = 0; tool < blades; ++tool) {
      Vec3d& normal = normals[std::size_t(tool)];
      for (int d = 0; d < 3; ++d) normal[d] = (d == tool) + 0.2 * uniform(random);
      normal.normalize();
      ways[std::size_t(tool)] = normal.unitOrthogonal();
    }
    const auto pose = [&](int tool, int i) {
      const Vec3d &normal = normals[std::size_t(tool)], &way = ways[std::size_t(tool)];
      const Vec3d at = middle + 0.2 * (2.0 * i / frames - 1) * way, edge = 0.2 * normal.cross(way);
      return BladePose{body.F * (at - edge), body.F * (at + edge)};
    };
    for (int i = 0; i < frames; ++i)
      for (int tool = 0; tool < blades; ++tool)
        body.cut_whole({tool, 0, 0.1, pose(tool, i), pose(tool, i + 1)});
    const Grains& grains = body.blades.grains;
    for (int tool = 0; tool < blades; ++tool)
      CHECK_FALSE(
          has_bridge(grains, [&](const Vec3d& X) { return normals[std::size_t(tool)].dot(X - middle); }));
    const Rebuilt rebuilt(grains, body.elements.topology);
    CHECK(rebuilt.faults == 0);
    CHECK(rebuilt.odd_edges == 0);
    CHECK(rebuilt.pieces == Index(body.elements.topology.pieces().size()));
    CHECK(rebuilt.pieces >= 1 << blades);
  }
}

TEST_CASE("a blade that goes a little farther than all around cuts a plug out") {
  for (unsigned trial = 0; trial < 48; ++trial) {
    CAPTURE(trial);
    const int n = 4 + int(trial % 3), frames = 20 + 9 * int(trial % 4);
    const double beyond = 0.2 + 0.25 * double(trial / 12);  // all around [rad]
    CAPTURE(beyond);
    MappedBody body(irregular_box(n, 0.1 / n), false);
    const Vec3d middle(0.05, 0.05, 0.05);
    const double r = 0.028 + 0.002 * (trial % 5), start = 0.7 * trial;
    const auto pose = [&](int i) {
      const double angle = start + (2 * std::acos(-1.0) + beyond) * i / frames;
      const Vec3d at = middle + r * Vec3d(std::cos(angle), std::sin(angle), 0), edge(0, 0, 0.08);
      return BladePose{body.F * (at - edge), body.F * (at + edge)};
    };
    for (int i = 0; i < frames; ++i) body.cut_whole({0, 0, 0.1, pose(i), pose(i + 1)});
    const Rebuilt rebuilt(body.blades.grains, body.elements.topology);
    CHECK(rebuilt.pieces >= 2);
    CHECK_FALSE(
        has_bridge(body.blades.grains, [&](const Vec3d& X) { return (X - middle).head<2>().norm() - r; }));
  }
}

TEST_CASE(
    "a blade that retraces its path fifty times divides and opens nothing after the first, crumbs "
    "included") {
  MappedBody body(irregular_box(5, 0.02), false);
  const Vec3d n = Vec3d(1, 2, 3).normalized(), along = n.unitOrthogonal(), edge = 0.2 * n.cross(along);
  const auto pose = [&](double x) {
    const Vec3d at = Vec3d::Constant(0.05) + x * along;
    return BladePose{body.F * (at - edge), body.F * (at + edge)};
  };
  const BladePose from = pose(-0.2), to = pose(0.2);
  double area = 0;
  for (const Incised& step : body.cut_whole({0, 0, 0.1, from, to})) area += step.area;
  CHECK(area > 0.009);
  const Index grains = body.blades.grains.count(), tets = body.elements.topology.tet_count();
  for (int i = 1; i <= 50; ++i)
    for (const Incised& step : body.cut_whole({0, 0, 0.1, i % 2 ? to : from, i % 2 ? from : to})) {
      CHECK(step.incision.empty());
      CHECK(step.crumbs == 0);
    }
  CHECK(body.blades.grains.count() == grains);
  CHECK(body.elements.topology.tet_count() == tets);
}
