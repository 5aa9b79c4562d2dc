// The volumes of labels, of one within another and of two that touch, at edges of a quarter of their
// diameter.
#include "lobe_mesh/volumes.h"

#include <cmath>
#include <functional>
#include <numbers>

#include "lobe/mesh/generators.h"
#include "lobe/mesh/quality.h"
#include "lobe_mesh/diagnose.h"
#include "lobe_mesh/tetrahedralise.h"
#include "meshing/shapes.h"
#include "near.h"

using namespace lobe;
using namespace lobe::meshing;
using test::near;

namespace {

Surface centred_cube(double side) { return moved(make_cube(side), Vec3d::Constant(-side / 2)); }

// 48³ voxels of 1 mm around the origin.
LabelImage image_of(const std::function<int(const Vec3d&)>& label) {
  constexpr Index n = 48;
  LabelImage image{{n, n, n}, {}, Mat34<double>::Zero()};
  image.to_world.leftCols<3>().diagonal().setConstant(1e-3);
  image.to_world.col(3).setConstant(-1e-3 * (n - 1) / 2);
  for (Index k = 0; k < n; ++k)
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i)
        image.values.push_back(label(image.to_world * Eigen::Vector4d(i, j, k, 1)));
  return image;
}

bool in_box(const Vec3d& x, const Vec3d& low, const Vec3d& high) {
  return (x.array() > low.array()).all() && (x.array() < high.array()).all();
}

void check_volumes(const TetMesh& mesh, const MeshReport& report, const std::vector<double>& volumes) {
  check_faces(mesh);
  CHECK(report.passes());
  CHECK(report.warnings.empty());
  REQUIRE(report.parts.size() == volumes.size());
  for (std::size_t k = 0; k < volumes.size(); ++k) {
    CAPTURE(k);
    CHECK(report.parts[k].volume == near(volumes[k], accepted_volume_error));
    double volume = 0;
    for (Index t = 0; t < mesh.tet_count(); ++t)
      if (mesh.labels[t] == report.parts[k].label) volume += signed_volume(tet_points(mesh, t));
    CHECK(volume == near(report.parts[k].volume, 1e-9));
  }
}

}  // namespace

TEST_CASE("a ball or a cube in a body has its volume at an edge of a quarter of its diameter") {
  constexpr double diameter = 0.024, edge = diameter / 4;
  const Surface organ = make_sphere(0.05, 4), ball = make_sphere(diameter / 2, 4),
                cube = centred_cube(diameter);
  const double organ_volume = enclosed_volume(organ), ball_volume = enclosed_volume(ball),
               cube_volume = std::pow(diameter, 3);
  REQUIRE(ball_volume == near(std::numbers::pi / 6 * cube_volume, 0.005));
  for (const Mesher mesher : {Mesher::cgal, Mesher::tetgen}) {
    CAPTURE(static_cast<int>(mesher));
    const MeshOptions options{.edge = edge, .mesher = mesher};
    MeshReport report;
    TetMesh mesh = tetrahedralise({organ, moved(ball, {0.01, 0, 0})}, options, report);
    CHECK(report.mesher == mesher);
    check_volumes(mesh, report, {organ_volume - ball_volume, ball_volume});
    mesh = tetrahedralise({organ, cube}, options, report);
    check_volumes(mesh, report, {organ_volume - cube_volume, cube_volume});
    mesh = tetrahedralise({centred_cube(0.08), ball}, options, report);
    check_volumes(mesh, report, {std::pow(0.08, 3) - ball_volume, ball_volume});
  }
}

TEST_CASE("labels of an image have their volumes at an edge of a quarter of their diameter") {
  constexpr double diameter = 0.016;
  const auto mesh_image = [](const LabelImage& image, const std::vector<double>& voxels) {
    MeshReport report;
    const TetMesh mesh = tetrahedralise(image, {.edge = diameter / 4}, report);
    std::vector<double> volumes;
    for (const double n : voxels) volumes.push_back(1e-9 * n);
    check_volumes(mesh, report, volumes);
  };
  const Vec3d low = Vec3d::Constant(-diameter / 2), high = -low;
  constexpr double cube = 16 * 16 * 16, small_ball = 2176, ball = 33552;
  REQUIRE(small_ball == near(std::numbers::pi / 6 * cube, 0.02));
  mesh_image(image_of([&](const Vec3d& x) { return x.norm() < 0.02 ? x.norm() < diameter / 2 ? 2 : 1 : 0; }),
             {ball - small_ball, small_ball});
  mesh_image(image_of([&](const Vec3d& x) { return x.norm() < 0.02 ? in_box(x, low, high) ? 2 : 1 : 0; }),
             {ball - cube, cube});
  // Two cubes that share a wall, alone and in a body.
  const Vec3d aside(diameter, 0, 0);
  const auto pair = [&](const Vec3d& x) {
    return in_box(x, low - aside / 2, high - aside / 2)   ? 1
           : in_box(x, low + aside / 2, high + aside / 2) ? 2
                                                          : 0;
  };
  mesh_image(image_of(pair), {cube, cube});
  const Vec3d body = Vec3d::Constant(0.021);
  mesh_image(image_of([&](const Vec3d& x) { return in_box(x, -body, body) ? pair(x) + 1 : 0; }),
             {42 * 42 * 42 - 2 * cube, cube, cube});
}

TEST_CASE("volumes are matched where they can be, and a mesh that has them stays bit for bit") {
  // Two halves of a ball of the radius 1; the wall between them is flat, their outer faces are coarse.
  const Surface fine = make_sphere(1, 5);
  TetMesh mesh = box_mesh({2, 2, 2}, 4, 4, 4);
  mesh.labels.assign(mesh.tet_count(), 0);
  for (Index t = 0; t < mesh.tet_count(); ++t) mesh.labels[t] = barycentre(mesh, t).x() < 1 ? 0 : 1;
  for (auto p : mesh.points.colwise()) {
    const Vec3d q = p - Vec3d::Ones();
    const double size = q.cwiseAbs().maxCoeff();
    p = size > 0 ? Vec3d(q * size / q.norm()) : Vec3d(q);
  }
  prepare(mesh, "ball");
  const NearestPoint surface(fine);
  const Interfaces interfaces{{{-1, 0}, &surface}, {{-1, 1}, &surface}};
  const Freedom freedom = find_freedom(mesh, interfaces, {}, 0);
  const double half = enclosed_volume(fine) / 2;
  REQUIRE(label_volumes(mesh, 2)[0] < 0.95 * half);
  match_volumes(mesh, interfaces, freedom, {half, half});
  for (const double volume : label_volumes(mesh, 2)) CHECK(volume == near(half, accepted_volume_error));
  CHECK(mesh_quality(mesh).smallest_tet_volume > 0);
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const bool on_sphere = !freedom.slides_on[v].empty();
    if (on_sphere && !freedom.is_fixed[v]) CHECK(std::abs(mesh.points.col(v).norm() - 1) < 0.1);
  }
  const TetMesh matched = mesh;
  match_volumes(mesh, interfaces, freedom, {half, half});
  CHECK(mesh.points == matched.points);
  // Twice the volume is out of reach: what can be is done, and nothing is turned inside out.
  match_volumes(mesh, interfaces, freedom, {2 * half, 2 * half});
  CHECK(total_volume(mesh) > 1.1 * total_volume(matched));
  CHECK(total_volume(mesh) < 4 * half);
  CHECK(mesh_quality(mesh).smallest_tet_volume > 0);
}
