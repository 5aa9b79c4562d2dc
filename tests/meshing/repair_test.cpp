#include "lobe_mesh/repair.h"
#include "lobe_mesh/orient.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "lobe_mesh/diagnose.h"
#include "meshing/shapes.h"
#include "near.h"

using namespace lobe;
using namespace lobe::meshing;
using test::near;

namespace {

const RepairStep* step(const RepairReport& report, const std::string& name) {
  for (const RepairStep& s : report.steps) {
    if (s.name == name) return &s;
  }
  return nullptr;
}

std::string refusal(const Surface& surface, Repair level = Repair::basic) {
  RepairReport report;
  return input_error([&] { repair_surface(surface, {.level = level}, report); });
}

// A ball of 1,280 triangles whose vertices were drawn through each other, some onto the opposite edge of a
// triangle, with 38 triangles twice.
Surface wreck(unsigned random) {
  Surface bad = make_sphere(1, 3);
  const auto next = [&] { return (random = random * 1664525u + 1013904223u) / 4294967296.0; };
  const auto number = [&](Index count) { return static_cast<Index>(next() * count); };
  for (int i = 0; i < 60; ++i) {
    auto p = bad.points.col(number(bad.point_count()));
    for (double& x : p) x += 0.6 * (next() - 0.5);
  }
  for (int i = 0; i < 8; ++i) {
    const auto t = bad.triangles.col(number(bad.triangle_count()));
    const double s = next();
    bad.points.col(t[2]) = (1 - s) * bad.points.col(t[0]) + s * bad.points.col(t[1]);
  }
  const Index triangles = bad.triangle_count();
  bad.triangles.conservativeResize(3, triangles + 38);
  for (Index t = triangles; t < bad.triangle_count(); ++t)
    bad.triangles.col(t) = bad.triangles.col(number(triangles));
  return bad;
}

}  // namespace

TEST_CASE("a good surface comes back unchanged, bit for bit") {
  const Surface sphere = make_sphere(0.05, 2);
  for (const Repair level : {Repair::none, Repair::basic}) {
    RepairReport report;
    const Surface result = repair_surface(sphere, {.level = level}, report);
    CHECK(result.points == sphere.points);
    CHECK(result.triangles == sphere.triangles);
    CHECK(report.steps.empty());
    CHECK(report.pieces == 1);
  }
}

TEST_CASE("inverted, doubled and badly oriented surfaces are repaired and the change is reported") {
  const Surface sphere = make_sphere(1, 2);
  const double volume = enclosed_volume(sphere);
  RepairReport report;
  Surface result = repair_surface(inverted(sphere), {}, report);
  CHECK(enclosed_volume(result) == near(volume, 1e-9));
  REQUIRE(step(report, "inverted"));
  CHECK(step(report, "inverted")->count == sphere.triangle_count());

  result = repair_surface(joined(sphere, sphere), {}, report);
  CHECK(enclosed_volume(result) == near(volume, 1e-9));
  CHECK(result.point_count() == sphere.point_count());
  REQUIRE(step(report, "weld"));
  CHECK(step(report, "weld")->count == sphere.point_count());
  CHECK(step(report, "duplicates")->count == sphere.triangle_count());

  Surface flipped = sphere;
  for (const Index t : {3, 50, 200}) std::swap(flipped.triangles(0, t), flipped.triangles(1, t));
  result = repair_surface(flipped, {}, report);
  CHECK(enclosed_volume(result) == near(volume, 1e-9));
  REQUIRE(step(report, "orient"));
  CHECK(step(report, "orient")->count == 3);
  CHECK(report.warnings.empty());  // of the volume: what disagreeing triangles enclose means nothing
}

TEST_CASE("triangles are turned without a geometry library where nothing else is wrong") {
  const Surface sphere = make_sphere(1, 2);
  Turned turned;
  for (const bool inside_out : {false, true}) {
    Surface mixed = inside_out ? inverted(sphere) : sphere;
    for (const Index t : {0, 3, 50}) std::swap(mixed.triangles(0, t), mixed.triangles(1, t));
    const std::optional<Surface> result = turned_outwards(mixed, turned);
    REQUIRE(result);
    CHECK(enclosed_volume(*result) == enclosed_volume(sphere));
    CHECK(diagnose(*result).meshable());
    CHECK(turned.to_agree == 3);
    CHECK(turned.outwards == (inside_out ? sphere.triangle_count() : 0));
  }
  CHECK_FALSE(turned_outwards(without_triangle(sphere, 5), turned));
  CHECK_FALSE(turned_outwards(joined(sphere, moved(sphere, {5, 0, 0})), turned));
  // The projective plane of six vertices: every edge has two triangles, and there is one side only.
  Surface plane{Mat3X<double>::Random(3, 6), Triangles(3, 10)};
  plane.triangles << 0, 0, 0, 0, 0, 1, 1, 2, 3, 4,  //
      1, 2, 3, 4, 5, 2, 3, 3, 4, 5,                 //
      2, 3, 4, 5, 1, 4, 5, 5, 1, 2;
  CHECK_FALSE(turned_outwards(plane, turned));
}

TEST_CASE("a small hole is filled, a large one is refused with the option that helps") {
  const Surface sphere = make_sphere(1, 3);
  RepairReport report;
  const Surface result = repair_surface(without_triangle(sphere, 77), {}, report);
  CHECK(diagnose(result).meshable());
  CHECK(enclosed_volume(result) == near(enclosed_volume(sphere), 1e-3));
  CHECK(step(report, "holes"));
  CHECK(report.max_distance < 0.06);  // from the filled hole's middle to its rim

  Surface box = without_triangle(without_triangle(make_cube(1), 11), 10);
  CHECK(contains(refusal(box), "--repair wrap"));
  CHECK(contains(refusal(box), "hole"));
}

TEST_CASE("each rung says how far its surface is from the input, and what volume it left") {
  Surface sphere = make_sphere(1, 3);
  const double volume = enclosed_volume(sphere);
  RepairReport report;
  repair_surface(inverted(sphere), {}, report);
  REQUIRE(report.steps.size() == 1);
  CHECK(report.steps[0].volume_before == near(-volume, 1e-9));
  CHECK(report.steps[0].volume_after == near(volume, 1e-9));
  CHECK(report.steps[0].distance < 1e-9);

  // A hole, then a dent through the opposite side; in millimetres.
  sphere.points.col(0) *= -1.02;
  const Surface result = repair_surface(scaled(without_triangle(sphere, 77), 1e3), {}, report);
  const RepairStep *hole = step(report, "holes"), *dent = step(report, "self-intersections");
  REQUIRE(hole);
  REQUIRE(dent);
  CHECK(hole->volume_after == near(dent->volume_before, 1e-9));
  CHECK(dent->volume_after == near(enclosed_volume(result), 1e-9));
  CHECK(hole->distance > 0);
  CHECK(hole->distance < 60);   // from the middle of the patch to its rim
  CHECK(dent->distance > 500);  // from the middle of the triangles that reached across, now gone
  CHECK(dent->distance == near(report.max_distance, 1e-9));
}

TEST_CASE("wrapping closes what repair refuses, and says what it cost") {
  const Surface box = without_triangle(make_cube(1), 11);
  RepairReport report;
  const Surface result =
      repair_surface(box, {.level = Repair::wrap, .wrap_alpha = 2, .wrap_offset = 0.05}, report);
  CHECK(diagnose(result).meshable());
  CHECK(report.volume_after > 0.5);
  CHECK(report.max_distance > 0.04);
  CHECK(step(report, "wrap"));
  // Left to itself it finds the width of the gap; a gap that is too narrow for the user's choice is named.
  repair_surface(box, {.level = Repair::wrap}, report);
  CHECK(report.volume_after > 0.5);
  CHECK(
      contains(input_error([&] { repair_surface(box, {.level = Repair::wrap, .wrap_alpha = 0.1}, report); }),
               "hollow"));
}

TEST_CASE("a wrapping that is a shell around an open surface is no body, however thick") {
  Surface half = make_sphere(1, 3);
  std::vector<Index> upper;
  for (Index t = 0; t < half.triangle_count(); ++t)
    if (half.points(Eigen::all, half.triangles.col(t)).row(2).mean() > 0) upper.push_back(t);
  half.triangles = half.triangles(Eigen::all, upper).eval();
  RepairReport report;  // the shell has a volume of 0.33 π, the half ball of 0.67 π
  CHECK(contains(input_error([&] {
                   repair_surface(half, {.level = Repair::wrap, .wrap_alpha = 0.4, .wrap_offset = 0.08},
                                  report);
                 }),
                 "hollow"));
  const Surface body =
      repair_surface(half, {.level = Repair::wrap, .wrap_alpha = 2, .wrap_offset = 0.08}, report);
  CHECK(enclosed_volume(body) > 0.95 * 2 * std::numbers::pi / 3);
}

TEST_CASE("a dent that pierces the other side is undone") {
  Surface sphere = make_sphere(1, 3);
  sphere.points.col(0) *= -1.02;  // one vertex drawn through the opposite side
  REQUIRE(diagnose(sphere).self_intersections.count > 0);
  RepairReport report;
  const Surface result = repair_surface(sphere, {}, report);
  CHECK(diagnose(result).meshable());
  CHECK(step(report, "self-intersections"));
  CHECK(enclosed_volume(result) == near(4.1, 0.1));
}

TEST_CASE("second bodies and cavities stay, specks go, and all are counted") {
  const Surface sphere = make_sphere(1, 2);
  RepairReport report;
  Surface result = repair_surface(joined(sphere, moved(sphere, {3, 0, 0})), {}, report);
  CHECK(report.pieces == 2);
  REQUIRE(report.warnings.size() == 1);
  CHECK(contains(report.warnings[0], "2 separate pieces"));
  CHECK(enclosed_volume(result) == near(2 * enclosed_volume(sphere), 1e-9));

  result = repair_surface(joined(sphere, scaled(sphere, 0.5)), {}, report);
  CHECK(report.pieces == 1);
  CHECK(report.cavities == 1);
  CHECK(enclosed_volume(result) == near(0.875 * enclosed_volume(sphere), 1e-9));

  result = repair_surface(joined(sphere, moved(make_cube(0.005), {3, 0, 0})), {}, report);
  CHECK(report.pieces == 1);
  REQUIRE(step(report, "specks"));
  CHECK(step(report, "specks")->count == 1);
}

TEST_CASE("surfaces that no repair can help are refused with the reason") {
  Surface sphere = make_sphere(1, 1);
  Surface nan = sphere;
  nan.points(2, 7) = std::numeric_limits<double>::quiet_NaN();
  CHECK(contains(refusal(nan), "vertex 7"));
  Surface flat = sphere;
  flat.points.row(2).setZero();
  CHECK(contains(refusal(flat), "flat"));
  Surface triangle = make_cube(1);
  triangle.triangles.conservativeResize(3, 1);
  CHECK(contains(refusal(triangle), "1 triangle cannot enclose"));
  CHECK(contains(refusal(joined(sphere, moved(sphere, {0.5, 0.3, 0.1}))), "intersect"));
  CHECK(contains(refusal(inverted(sphere), Repair::none), "inverted"));
  CHECK(contains(refusal(without_triangle(sphere, 0), Repair::none), "3 open edges"));
}

TEST_CASE("triangles without area are removed, whether that is exact or up to rounding") {
  const Surface sphere = make_sphere(0.05, 3);
  for (const Index t : {10, 300, 777}) {
    for (const double ratio : {0.5, 0.3}) {
      CAPTURE(t);
      CAPTURE(ratio);
      Surface bad = sphere;  // one corner on the opposite edge
      bad.points.col(bad.triangles(2, t)) =
          (1 - ratio) * bad.points.col(bad.triangles(0, t)) + ratio * bad.points.col(bad.triangles(1, t));
      REQUIRE(diagnose(bad).degenerate.count == 1);
      RepairReport report;
      const Surface result = repair_surface(bad, {}, report);
      CHECK(diagnose(result).meshable());
      REQUIRE(step(report, "degenerate"));
      CHECK(step(report, "degenerate")->count == 1);
      CHECK(report.max_distance < 1e-3);
      CHECK(enclosed_volume(result) == near(enclosed_volume(bad), 1e-6));
    }
  }
}

TEST_CASE("what the removal of intersections leaves without area is removed, too") {
  for (const unsigned seed : {3u, 5u, 9u}) {  // once through the rungs left one triangle of the first
    CAPTURE(seed);
    const Surface bad = wreck(seed);
    const Diagnosis before = diagnose(bad);
    REQUIRE(before.degenerate.count >= 8);
    REQUIRE(before.duplicate_triangles.count == 38);
    REQUIRE(before.self_intersections.count > 80);
    RepairReport report;
    const Surface result = repair_surface(bad, {}, report);
    CHECK(diagnose(result).meshable());
    CHECK(step(report, "duplicates")->count == 38);
    CHECK(step(report, "degenerate"));
    CHECK(step(report, "self-intersections"));
    CHECK(!step(report, "wrap"));
    CHECK(enclosed_volume(result) == near(4.1, 0.15));
    for (std::size_t i = 1; i < report.steps.size(); ++i)
      CHECK(report.steps[i].volume_before == report.steps[i - 1].volume_after);
  }
}

TEST_CASE("repair climbs to wrapping when asked to, says why, and only where it must") {
  const RepairOptions options{.level = Repair::wrap_if_needed};
  const Surface sphere = make_sphere(1, 3), overlapping = joined(sphere, moved(sphere, {0.5, 0.3, 0.1}));
  REQUIRE(contains(refusal(overlapping), "could not be separated"));
  RepairReport report;
  const Surface body = repair_surface(overlapping, options, report);
  CHECK(diagnose(body).meshable());
  CHECK(step(report, "wrap"));
  REQUIRE(!report.warnings.empty());
  CHECK(contains(report.warnings[0], "wrapped, because the repair did not succeed (self-intersections: "));
  CHECK(!contains(report.warnings[0], "use --repair wrap"));
  // Two balls of the radius 1 at the distance d: 8π/3 − π (4 + d) (2 − d)² / 12. The wrapping is larger.
  const double pi = std::numbers::pi, d = std::sqrt(0.35),
               both = 8 * pi / 3 - pi * (4 + d) * std::pow(2 - d, 2) / 12;
  CHECK(enclosed_volume(body) == near(1.01 * both, 0.02));
  // The rungs of the failed repair are not in the report.
  CHECK(report.steps.back().name == "wrap");
  CHECK(!step(report, "self-intersections"));
  CHECK(report.steps.back().volume_before == near(enclosed_volume(overlapping), 1e-9));

  repair_surface(wreck(5), options, report);
  CHECK(!step(report, "wrap"));
  const Surface same = repair_surface(sphere, options, report);
  CHECK(same.points == sphere.points);
  CHECK(report.steps.empty());
}

TEST_CASE("an edge shared by four triangles is taken apart") {
  // Two cubes that touch along one edge: CGAL would say that they intersect.
  const Surface two = joined(make_cube(1), moved(make_cube(1), {1, 1, 0}));
  RepairReport report;
  const Surface result = repair_surface(two, {}, report);
  CHECK(diagnose(result).closed());
  CHECK(enclosed_volume(result) == near(2, 1e-9));
}

TEST_CASE("the unit of length does not matter") {
  Surface broken = without_triangle(inverted(make_sphere(1, 3)), 5);
  for (const double factor : {1e-6, 1.0, 1e6}) {
    RepairReport report;
    const Surface result = repair_surface(scaled(broken, factor), {}, report);
    CHECK(enclosed_volume(result) / std::pow(factor, 3) == near(4.15, 0.01));
  }
}
