#include "lobe_mesh/size_balls.h"

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "lobe/io/mesh_io.h"
#include "lobe/mesh/generators.h"
#include "meshing/shapes.h"
#include "near.h"

using namespace lobe;
using namespace lobe::meshing;
using test::near;

namespace {

// A field on a mesh of a box from −0.06 to 0.06 m: edges of 4 mm at the left end, growing by half of the
// distance.
std::filesystem::path write_field(const SurfaceFolder& folder, double factor) {
  TetMesh box = box_mesh({0.12, 0.12, 0.12}, 8, 8, 8);
  box.points.array() -= 0.06;
  Eigen::MatrixXd edge = factor * (0.004 + 0.5 * (box.points.row(0).array() + 0.06)).matrix();
  const std::filesystem::path file = folder.path / "field.vtu";
  write_vtu(file, box, {{"edge", edge}});
  return file;
}

}  // namespace

TEST_CASE("the tree of balls gives the smallest edge that any of them asks for") {
  std::srand(1);
  for (const Index count : {1, 8, 9, 500}) {
    CAPTURE(count);
    std::vector<SizeBall> balls;
    for (Index i = 0; i < count; ++i) {
      const Vec3d random = Vec3d::Random();
      balls.push_back({Vec3d::Random(), 0.1 * std::abs(random[0]), 0.01 + 0.2 * std::abs(random[1])});
    }
    const SizeBalls tree(balls, 0.3);
    for (int i = 0; i < 200; ++i) {
      const Vec3d point = 1.5 * Vec3d::Random();
      double smallest = 0.3;
      for (const SizeBall& ball : balls)
        smallest =
            std::min(smallest, ball.edge + 0.3 * std::max(0.0, (point - ball.centre).norm() - ball.radius));
      CHECK(tree.at(point, 0.3) == smallest);
    }
  }
  CHECK(SizeBalls({}, 0.3).at(Vec3d::Zero(), 0.7) == 0.7);
}

TEST_CASE("the vertices of a mesh ask for their edges in balls that make up its volume") {
  const SurfaceFolder folder;
  const std::vector<SizeBall> balls = read_size_balls(write_field(folder, 1));
  REQUIRE(balls.size() == 9 * 9 * 9);
  double volume = 0;
  for (const SizeBall& ball : balls) {
    volume += 4.0 / 3 * std::numbers::pi * std::pow(ball.radius, 3);
    CHECK(ball.edge == near(0.004 + 0.5 * (ball.centre.x() + 0.06), 1e-9));
  }
  CHECK(volume == near(0.12 * 0.12 * 0.12, 1e-9));
}

TEST_CASE("edges follow the field of a mesh") {
  const SurfaceFolder folder;
  const Surface sphere = make_sphere(0.05, 4);
  MeshReport report;
  const TetMesh mesh = tetrahedralise(
      {sphere}, {.edge = 0.02, .balls = read_size_balls(write_field(folder, 1)), .growth = 0.5}, report);
  CHECK(report.passes());
  check_boundary(mesh);
  // Where the field asks for h, the mean volume is that of the regular tetrahedron of edge h, ± a factor of
  // 1.5³.
  for (const double x : {-0.035, -0.015, 0.005, 0.025}) {
    CAPTURE(x);
    double volume = 0;
    Index count = 0;
    for (Index t = 0; t < mesh.tet_count(); ++t) {
      if (std::abs(barycentre(mesh, t).x() - x) > 0.004) continue;
      volume += signed_volume(tet_points(mesh, t));
      ++count;
    }
    REQUIRE(count > 20);
    const double edge = std::cbrt(volume / count * 6 * std::numbers::sqrt2),
                 wanted = 0.004 + 0.5 * (x + 0.06);
    CHECK(edge / std::min(wanted, 0.02) > 1 / 1.5);
    CHECK(edge / std::min(wanted, 0.02) < 1.5);
  }
}

TEST_CASE("a mesh that holds no field is refused") {
  const SurfaceFolder folder;
  CHECK(contains(input_error([&] { read_size_balls(write_field(folder, -1)); }),
                 "at vertex 0, must be positive"));
  const std::filesystem::path plain = folder.path / "plain.vtu";
  write_vtu(plain, box_mesh({1, 1, 1}, 1, 1, 1));
  CHECK(contains(input_error([&] { read_size_balls(plain); }), "no point array 'edge'"));
}
