#include "lobe_mesh/tetrahedralise.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "lobe_mesh/check_options.h"
#include "lobe_mesh/errors.h"
#include "lobe_mesh/measure.h"
#include "meshing/shapes.h"
#include "near.h"

using namespace lobe;
using namespace lobe::meshing;
using test::near;

namespace {

constexpr Mesher both_meshers[] = {Mesher::cgal, Mesher::tetgen};

TetMesh mesh_of(const Surface& surface, double edge, Mesher mesher, MeshReport& report) {
  return tetrahedralise({surface}, {.edge = edge, .mesher = mesher}, report);
}

void check_good(const TetMesh& mesh, const MeshReport& report) {
  CHECK(report.passes());
  CHECK(report.quality.min_dihedral >= 15);
  CHECK(report.time_step_star >= 0.5);
  CHECK(report.quality.smallest_tet_volume > 0);
  CHECK(report.time_step > 0);
  CHECK(std::abs(report.volume_error) < 5);
  check_boundary(mesh);
  // The mean volume is that of the regular tetrahedron of the edge asked for, ± 30 %.
  const double volume = report.quality.volume / report.tets;
  CHECK(volume > 0.7 * regular_volume(report.edge));
  CHECK(volume < 1.3 * regular_volume(report.edge));
}

std::string refusal(const MeshOptions& options) {
  MeshReport report;
  return input_error([&] { tetrahedralise({make_cube(0.1)}, options, report); });
}

}  // namespace

TEST_CASE("spheres become good meshes of the size asked for") {
  const Surface sphere = make_sphere(0.05, 4);
  for (const Mesher mesher : both_meshers) {
    for (const double edge : {0.014, 0.008}) {
      CAPTURE(edge);
      CAPTURE(static_cast<int>(mesher));
      MeshReport report;
      check_good(mesh_of(sphere, edge, mesher, report), report);
      CHECK(std::abs(report.volume_error) < 0.7);
    }
  }
}

TEST_CASE("the edges of a cube and the rims of a cylinder stay sharp") {
  for (const Mesher mesher : both_meshers) {
    CAPTURE(static_cast<int>(mesher));
    MeshReport report;
    check_good(mesh_of(make_cube(0.1), 0.02, mesher, report), report);
    CHECK(std::abs(report.volume_error) < 1e-6);
    check_good(mesh_of(make_cylinder(0.02, 0.1, 48), 0.007, mesher, report), report);
    CHECK(std::abs(report.volume_error) < 2);
  }
}

TEST_CASE("several bodies are meshed, a cavity is left empty") {
  const Surface sphere = make_sphere(0.05, 3);
  for (const Mesher mesher : both_meshers) {
    CAPTURE(static_cast<int>(mesher));
    MeshReport report;
    check_good(mesh_of(joined(sphere, moved(sphere, {0.15, 0, 0})), 0.015, mesher, report), report);
    check_good(mesh_of(joined(sphere, inverted(scaled(sphere, 0.4))), 0.012, mesher, report), report);
    CHECK(report.surface_volume < 0.95 * enclosed_volume(sphere));
  }
}

TEST_CASE("the same input gives the same mesh, bit for bit, in any unit") {
  const Surface sphere = make_sphere(0.05, 3);
  for (const Mesher mesher : both_meshers) {
    MeshReport report;
    const TetMesh first = mesh_of(sphere, 0.015, mesher, report),
                  second = mesh_of(sphere, 0.015, mesher, report);
    CHECK(first.points == second.points);
    CHECK(first.tets == second.tets);
    for (const double factor : {std::exp2(-20), std::exp2(20)}) {
      const TetMesh other = mesh_of(scaled(sphere, factor), 0.015 * factor, mesher, report);
      CHECK(other.tets == first.tets);
    }
  }
}

// Of a mesh in no order these would be about a third of its vertices, and half of its width.
TEST_CASE("neighbours in the body are neighbours in memory") {
  MeshReport report;
  const TetMesh mesh = mesh_of(make_sphere(0.05, 3), 0.008, Mesher::cgal, report);
  double apart = 0, way = 0;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    apart += double(mesh.tets.col(t).maxCoeff() - mesh.tets.col(t).minCoeff()) / mesh.tet_count();
    if (t > 0) way += (barycentre(mesh, t) - barycentre(mesh, t - 1)).norm() / mesh.tet_count();
  }
  CHECK(apart < 0.2 * mesh.vertex_count());
  CHECK(way < 1.2 * regular_edge(report.quality.volume / report.tets));
}

TEST_CASE("of several tries the longest time step is kept, and all are reported") {
  MeshReport report;
  tetrahedralise({make_sphere(0.05, 3)}, {.edge = 0.012, .tries = 3}, report);
  REQUIRE(report.attempts.size() == 3);
  double longest = 0;
  for (const Attempt& attempt : report.attempts) {
    CHECK(attempt.mesher == Mesher::cgal);
    if (attempt.min_dihedral >= quality_gate.min_dihedral)
      longest = std::max(longest, attempt.time_step_star);
  }
  CHECK(report.time_step_star == longest);
  CHECK(report.bottleneck.tets > 0);
}

TEST_CASE("where a wedge of the surface spoils all shapes, almost the same edge is tried once and no more") {
  // Two wedges of 8° with a common wall, so that TetGen is not for them.
  constexpr double length = 0.02, width = 0.02, height = 0.0028;
  Surface upper{Mat3X<double>(3, 6), Triangles(3, 8)};
  upper.points << 0, length, length, 0, length, length,  //
      0, 0, 0, width, width, width,                      //
      0, 0, height, 0, 0, height;
  upper.triangles << 0, 0, 0, 3, 1, 1, 0, 0,  //
      4, 3, 1, 5, 4, 5, 2, 5,                 //
      1, 4, 2, 4, 5, 2, 5, 3;
  Surface lower = inverted(upper);
  lower.points.row(2) *= -1;
  MeshReport report;
  tetrahedralise({upper, lower}, {.edge = 0.004, .keep_thin = true}, report);
  CHECK_FALSE(report.passes());
  CHECK(shape_of(report) < 0.7);
  CHECK(report.attempts.size() == 2);
  // The warning says what is missed, and advises nothing that is done already.
  const std::string& warning = report.warnings.back();
  CHECK_MESSAGE(contains(warning, "below the gate (smallest dihedral angle "), warning);
  CHECK_MESSAGE(contains(warning, "°, at least 15°"), warning);
  CHECK_FALSE(contains(warning, "--keep-thin"));
}

TEST_CASE("where a mesh does not pass the gate, the other mesher is tried") {
  // Mesh_3 refines without end where two bodies touch at a vertex; TetGen does not.
  const Surface cube = make_cube(0.1);
  MeshReport report;
  const TetMesh mesh = tetrahedralise({joined(cube, moved(cube, {0.1, 0.1, 0.1}))}, {.edge = 0.02}, report);
  REQUIRE(report.attempts.size() >= 2);
  CHECK(contains(report.attempts[0].failure, "two bodies touch"));
  CHECK(report.attempts[1].mesher == Mesher::tetgen);
  CHECK(report.mesher == Mesher::tetgen);
  CHECK(total_volume(mesh) == near(2e-3, 1e-9));
}

TEST_CASE("where the refinement does not end, it is stopped and the other mesher is tried") {
  const Surface cube = make_cube(0.1);
  MeshReport report;
  tetrahedralise({joined(cube, moved(cube, {0.1 + 1e-6, 0, 0}))}, {.edge = 0.02, .feature_angle = 180},
                 report);
  const std::string why = report.attempts.at(0).failure;
  CHECK_MESSAGE(contains(why, "refines without end"), why);
  CHECK(report.mesher == Mesher::tetgen);
}

TEST_CASE("a refinement that makes far more tetrahedra than the edge needs is stopped, and not tried again") {
  // All edges of a finely faceted ball are kept sharp, though the tetrahedra may be ten times as long.
  MeshReport report;
  tetrahedralise({make_sphere(0.1, 3)}, {.edge = 0.05, .tries = 2, .feature_angle = 1}, report);
  const std::string why = report.attempts.at(0).failure;
  CHECK_MESSAGE(contains(why, "makes far more than the"), why);
  CHECK(contains(why, "--feature-angle 180"));
  CHECK(report.mesher == Mesher::tetgen);
  CHECK(report.tets < 20000);
  CHECK(std::count_if(report.attempts.begin(), report.attempts.end(),
                      [](const Attempt& a) { return a.mesher == Mesher::cgal; }) == 1);
}

TEST_CASE("sharp edges far below the edge asked for are left out, with a warning that names the place") {
  // A ball with 60 spikes of triangular section that end 20 times thinner than they begin.
  Surface body = make_sphere(1, 2);
  const Index points = body.point_count(), triangles = body.triangle_count(), spikes = 60;
  body.points.conservativeResize(3, points + 3 * spikes);
  body.triangles.conservativeResize(3, triangles + 6 * spikes);
  for (Index s = 0; s < spikes; ++s) {
    const Index t = s * triangles / spikes, tip = points + 3 * s;
    const Eigen::Vector3i base = body.triangles.col(t);
    const Vec3d centre = body.points(Eigen::all, base).rowwise().mean();
    for (int k = 0; k < 3; ++k) {
      const Index next = (k + 1) % 3;
      body.points.col(tip + k) = 1.25 * centre + 0.05 * (body.points.col(base[k]) - centre);
      body.triangles.col(triangles + 6 * s + 2 * k) << base[k], base[next], tip + next;
      body.triangles.col(triangles + 6 * s + 2 * k + 1) << base[k], tip + next, tip + k;
    }
    body.triangles.col(t) << tip, tip + 1, tip + 2;
  }
  MeshReport report;
  const TetMesh mesh = tetrahedralise({body}, {.edge = 0.18}, report);
  CHECK(report.passes());
  CHECK(report.tets < 20000);
  CHECK(std::abs(report.volume_error) < 5);
  check_faces(mesh);
  REQUIRE(!report.warnings.empty());
  CHECK_MESSAGE(contains(report.warnings[0], "sharp edges are shorter than 0.15 of the mesh's edge"),
                report.warnings[0]);
  CHECK(contains(report.warnings[0], "first near ("));
}

TEST_CASE("options that make no sense for the body are refused with numbers") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(contains(refusal({.edge = -1}), "must not be negative"));
  CHECK(contains(refusal({.edge = nan}), "edge"));
  CHECK(contains(refusal({.edge = 5}), "too long"));
  CHECK(contains(refusal({.edge = 1e-5}), "million tetrahedra"));
  CHECK(contains(refusal({.edge = 0.02, .density = 0}), "density"));
  CHECK(contains(refusal({.edge = 0.02, .tries = 0}), "tries"));
}

TEST_CASE("an open surface is refused, whatever the mesher") {
  MeshReport report;
  CHECK(contains(input_error([&] { tetrahedralise({without_triangle(make_cube(1), 0)}, {}, report); }),
                 "repair"));
}

TEST_CASE("a mesher that runs out of time or memory is a failure with a message, not a crash") {
  const Surface sphere = make_sphere(0.05, 4);
  MeshReport report;
  MeshOptions options{.edge = 0.0015, .mesher = Mesher::cgal, .time_limit = 0.3};
  CHECK_THROWS_AS(tetrahedralise({sphere}, options, report), MeshingFailure);
  options = {.edge = 0.004, .mesher = Mesher::tetgen, .time_limit = 0.001};
  CHECK_THROWS_WITH_AS(tetrahedralise({sphere}, options, report), doctest::Contains("ran out of time"),
                       MeshingFailure);
#ifndef LOBE_SANITIZED  // without a memory limit then, see child_process.cpp
  options = {.edge = 0.004, .mesher = Mesher::tetgen, .memory_limit = 2e7};
  tetrahedralise({sphere}, options, report);
  CHECK(contains(report.attempts[0].failure, "tetgen"));
  CHECK(report.mesher == Mesher::cgal);
#endif
}

TEST_CASE("without lobe-tetgen the other mesher is tried, and the report says why") {
  MeshReport report;
  tetrahedralise({make_sphere(0.05, 3)},
                 {.edge = 0.015, .mesher = Mesher::tetgen, .tetgen_program = "/nowhere/lobe-tetgen"}, report);
  REQUIRE(report.attempts.size() == 2);
  CHECK(contains(report.attempts[0].failure, "could not be started"));
  CHECK(report.mesher == Mesher::cgal);
}
