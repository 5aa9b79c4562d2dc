// What a mesh lost of its surfaces, and what keeps it.
#include "lobe_mesh/surface_gap.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lobe_mesh/label_image.h"
#include "lobe_mesh/measure.h"
#include "meshing/shapes.h"
#include "near.h"

using namespace lobe;
using namespace lobe::meshing;
using test::near;

namespace {

// A ball of 15 mm radius with a rod of 1 mm radius at either side, to z = ±50 mm: a surface of revolution.
Surface ball_with_rods() {
  constexpr double ball = 0.015, rod = 0.001, end = 0.05;
  std::vector<std::array<double, 2>> rings;  // radius and height
  for (int i = 0; i <= 20; ++i) rings.push_back({rod, -end + i * (end - ball) / 20});
  for (int i = 1; i < 16; ++i) {
    const double angle = std::numbers::pi * i / 16;
    rings.push_back({std::max(rod, ball * std::sin(angle)), -ball * std::cos(angle)});
  }
  for (int i = 0; i <= 20; ++i) rings.push_back({rod, ball + i * (end - ball) / 20});
  constexpr Index around = 16;
  const auto count = static_cast<Index>(rings.size());
  Surface surface{Mat3X<double>(3, count * around + 2), Triangles(3, 2 * count * around)};
  surface.points.col(count * around) = Vec3d(0, 0, -end);
  surface.points.col(count * around + 1) = Vec3d(0, 0, end);
  Index at = 0;
  for (Index r = 0; r < count; ++r)
    for (Index i = 0; i < around; ++i) {
      const double turn = 2 * std::numbers::pi * i / around;
      const auto [radius, height] = rings[std::size_t(r)];
      surface.points.col(r * around + i) = Vec3d(radius * std::cos(turn), radius * std::sin(turn), height);
      const Index a = r * around + i, b = r * around + (i + 1) % around;
      if (r == 0) surface.triangles.col(at++) << count * around, b, a;
      if (r + 1 == count) {
        surface.triangles.col(at++) << count * around + 1, a, b;
        continue;
      }
      surface.triangles.col(at++) << a, b, b + around;
      surface.triangles.col(at++) << a, b + around, a + around;
    }
  return surface;
}

bool says(const MeshReport& report, const std::string& text) {
  return std::any_of(report.warnings.begin(), report.warnings.end(),
                     [&](const std::string& warning) { return contains(warning, text); });
}

// A block of label 1 that has a cube of 3 voxels, label 3, in its middle; voxels of 1 mm.
LabelImage block_with_cube() {
  LabelImage image{{26, 26, 26}, {}, Mat34<double>::Zero()};
  image.to_world.leftCols<3>() = 1e-3 * Mat3<double>::Identity();
  const auto within = [](const std::array<Index, 3>& v, Index low, Index high) {
    return std::all_of(v.begin(), v.end(), [&](Index i) { return i >= low && i < high; });
  };
  for (Index k = 0; k < 26; ++k)
    for (Index j = 0; j < 26; ++j)
      for (Index i = 0; i < 26; ++i)
        image.values.push_back(within({i, j, k}, 11, 14) ? 3 : within({i, j, k}, 1, 25) ? 1 : 0);
  return image;
}

}  // namespace

TEST_CASE("the gap between two cubes, one moved by a tenth of its side, is the exact one") {
  const Surface cube = make_cube(0.1), other = moved(make_cube(0.1), {0.01, 0, 0});
  const SurfaceGap gap = gap_between(points_on(cube, 0.002), NearestPoint(other));
  CHECK(gap.largest == near(0.01, 1e-12));
  CHECK(gap.percentile_95 == near(0.01, 1e-12));
  // The side that leaves: 0.01. The one inside: 0.01, less within 0.01 of its rim. The other four: less than
  // 0.01 within a strip, else 0.
  const double inside = 0.64 * 0.01 + 4 * (0.1 * 1e-4 / 2 - 2e-6 / 3) / 0.01,
               strip = 0.1 * 0.01 * 0.005 / 0.01;
  CHECK(gap.mean == near((0.01 + inside + 4 * strip) / 6, 0.01));
  CHECK(gap_between(points_on(cube, 0.01), NearestPoint(cube)).largest < 1e-15);
}

TEST_CASE("the width of a body is that of the largest ball inside that touches the surface") {
  const NearestPoint rod(make_cylinder(0.005, 0.1, 64)), cube(make_cube(0.1));
  CHECK(width_at({{0.005, 0, 0.05}, Vec3d::UnitX(), 1}, rod, 1) == near(0.01, 0.03));
  CHECK(width_at({{0.1, 0.05, 0.05}, Vec3d::UnitX(), 1}, cube, 1) == near(0.1, 0.03));
  CHECK(width_at({{0.1, 0.05, 0.05}, Vec3d::UnitX(), 1}, cube, 0.03) == 0.03);
}

TEST_CASE("a mesh without the thin parts of its surface does not pass, and says what would keep them") {
  MeshReport report;
  tetrahedralise({ball_with_rods()}, {.edge = 0.0045}, report);
  CHECK_FALSE(report.passes());
  CHECK(report.surface_to_mesh.largest > 0.02);
  CHECK(std::abs(report.surface_to_mesh.place.z()) > 0.045);
  CHECK(report.mesh_to_surface.largest < 0.0045);
  CHECK(report.keeping_edge == near(0.0013, 0.15));
  CHECK(says(report, "parts of the surface are missing from the mesh"));
  CHECK(says(report, "or --keep-thin for such edges only there"));
  CHECK(says(report, "try --keep-thin (shorter edges along thin parts)"));
  CHECK(says(report, " m between surface and mesh, at most 0.0045 m"));  // of the gate
  CHECK_FALSE(says(report, "dt* 0.5"));                                  // it misses no other bound
  for (const Attempt& attempt : report.attempts)
    if (attempt.failure.empty()) CHECK(attempt.largest_gap >= report.largest_gap());
}

TEST_CASE("edges as short as thin parts keep them, where that is asked for or no edge is") {
  for (const bool by_default : {true, false}) {
    CAPTURE(by_default);
    MeshReport report;
    const TetMesh mesh = tetrahedralise({ball_with_rods()},
                                        {.edge = by_default ? 0 : 0.0045, .keep_thin = !by_default}, report);
    CHECK(bounding_box(mesh).max.z() > 0.049);
    CHECK(bounding_box(mesh).min.z() < -0.049);
    CHECK(report.largest_gap() < report.edge);
    CHECK(report.keeping_edge == 0);
    CHECK(report.passes());
    CHECK(report.shortest_edge < 0.0017);
    CHECK_FALSE(says(report, "missing from the mesh"));
    check_boundary(mesh);
  }
}

TEST_CASE("a label smaller than an edge gets edges of its own, unless it has been given some") {
  MeshReport report;
  tetrahedralise(block_with_cube(), {.edge = 6e-3, .smoothing = 0}, report);
  REQUIRE(report.parts.size() == 2);
  CHECK(report.parts[1].label == 3);
  CHECK(report.parts[1].tets > 0);
  CHECK(std::abs(report.parts[1].volume_error()) < 20);
  CHECK(report.missing_labels() == 0);
  CHECK(says(report, "label 3 is smaller than an edge: its edges are 0.001"));
}

TEST_CASE("a layer that is thinner than half an edge keeps its volume where thin parts are kept") {
  Surface thick = make_cube(1), thin = make_cube(1);  // 12 x 12 mm, 4 and 1.3 mm, with a common wall
  thick.points = Vec3d(0.012, 0.012, 0.004).asDiagonal() * thick.points;
  thin.points = (Vec3d(0.012, 0.012, 0.0013).asDiagonal() * thin.points).colwise() + Vec3d(0, 0, 0.004);
  MeshReport report;
  tetrahedralise({thick, thin}, {.edge = 0.003, .keep_thin = true}, report);
  CHECK(says(report, "label 1 is thinner than half an edge: its edges are 0.00"));
  CHECK(largest_volume_error(report) <= kept_volume);
}
