#include "lobe/solve/rest_shape.h"

#include <doctest/doctest.h>

#include <cmath>

#include "lobe/error.h"
#include "lobe/io/mesh_io.h"
#include "lobe/scene/select.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double bar_edge = 0.0125;  // of its cells along x [m]

// A bar that is held on one side and hangs down under gravity.
Setup hanging_bar(double gravity = 9.81) {
  Setup setup = setup_of(box_mesh({0.1, 0.03, 0.03}, 8, 2, 2));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) == 0) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.gravity = {0, 0, -gravity};
  return setup;
}

Setup bar_of_law(MaterialLaw law, std::array<double, 2> further = {}) {
  Setup setup = hanging_bar();
  setup.materials[0].law = law;
  setup.materials[0].further = further;
  return setup;
}

// The same body, brought into its equilibrium.
Setup loaded(Setup setup) {
  const StaticResult found = solve_static(setup);
  REQUIRE_MESSAGE(found.converged, found.reason);
  setup.mesh.points += found.u;
  return setup;
}

double largest_of(const Mat3X<double>& x) { return x.colwise().norm().maxCoeff(); }

// Loads a body, and asks for its rest shape. Returns the iterations.
RestShape round_trip(const Setup& rest, double least_way = 0.003) {
  const Setup image = loaded(rest);
  CHECK(largest_of(image.mesh.points - rest.mesh.points) > least_way);
  const RestShape found = find_rest_shape(image, {.tolerance = 1e-9});
  REQUIRE_MESSAGE(found.converged, found.reason);
  CHECK(found.load_fraction == 1);
  CHECK(found.distance <= 1e-9);
  CHECK(found.mean_distance <= found.distance);
  CHECK(largest_of(found.points - rest.mesh.points) < 1e-6 * bar_edge);
  CHECK(largest_of(found.points + found.u - image.mesh.points) == found.distance);
  return found;
}

// Pressure on the boundary faces of a plane x = const.
void press_at(Setup& setup, double x, double pressure) {
  const Selector where{SelectPlane{{x, 0, 0}, {1, 0, 0}, SelectPlane::Side::within, 1e-9}};
  for (const TetFace& face : select_faces(where, setup.mesh, outer_faces(setup.mesh)))
    setup.pressures.push_back({face.tet, face.face, pressure});
}

}  // namespace

// The inverse of a computed equilibrium is known exactly.
TEST_CASE("the rest shape of a body in equilibrium is that from which it came") {
  Setup held_away = hanging_bar(0), pulled = hanging_bar();
  for (PrescribedVertex& held : held_away.prescribed) held.displacement = {0, 0, 0.004};
  held_away.vertex_loads.push_back({held_away.mesh.vertex_count() - 1, {0.02, 0, 0.05}});
  pulled.vertex_loads.push_back({pulled.mesh.vertex_count() - 1, {0.1, 0, 0.1}});
  for (const Setup& rest : {hanging_bar(), smoothed(hanging_bar()), held_away, pulled})
    CHECK(round_trip(rest).iterations < 25);
}

TEST_CASE("rest shapes are found with every law, nodal pressure, and linear parts") {
  Setup soft = hanging_bar();
  soft.materials[0].lambda = 49 * soft.materials[0].mu;  // ν = 0.49
  Setup hybrid = hybrid_setup(hanging_bar().mesh);
  hybrid.prescribed = hanging_bar().prescribed;
  hybrid.gravity = {0, 0, -9.81};
  Setup fibrous = bar_of_law(MaterialLaw::holzapfel, {2e4, 2});
  fibrous.mesh.fibres = Vec3d(0.6, 0, 0.8).replicate(1, fibrous.mesh.tet_count());
  Setup turning = hanging_bar();
  turning.region_of.assign(turning.region_of.size(), RegionModel::corotational);
  for (const Setup& rest :
       {bar_of_law(MaterialLaw::neo_hookean), bar_of_law(MaterialLaw::mooney_rivlin, {3000}),
        bar_of_law(MaterialLaw::yeoh, {2000, 1000}), fibrous, averaged(soft), averaged(smoothed(soft)),
        turning})
    CHECK(round_trip(rest, 0.001).iterations < 80);  // 11, and up to 60 with nodal pressure
  CHECK(round_trip(hybrid, 0.0005).iterations < 80);
}

TEST_CASE("rest shapes are found under pressure, and of vertices that are held by shares or slide") {
  Setup pressed = hanging_bar();
  press_at(pressed, 0.1, -1500);
  Setup partly = hanging_bar();
  for (Index v = 0; v < partly.mesh.vertex_count(); ++v)
    if (std::abs(partly.mesh.points(0, v) - bar_edge) < 1e-9)
      partly.partly_held.push_back({v, 0.4, {0, 0, 0.0005}, all_axes});
  Setup sliding = hanging_bar();
  sliding.prescribed.clear();
  for (Index v = 0; v < sliding.mesh.vertex_count(); ++v) {
    const bool is_end = sliding.mesh.points(0, v) == 0 || std::abs(sliding.mesh.points(0, v) - 0.1) < 1e-9;
    if (is_end) sliding.prescribed.push_back({v, Vec3d::Zero(), {v % 2 == 0, true, true}});
  }
  for (const Setup& rest : {pressed, partly}) CHECK(round_trip(rest).iterations < 30);
  CHECK(round_trip(sliding, 1e-4).iterations < 30);
}

TEST_CASE("parts that turn by nearly a right angle are turned back") {
  Setup slender = setup_of(box_mesh({0.12, 0.012, 0.012}, 12, 1, 1));
  for (Index v = 0; v < slender.mesh.vertex_count(); ++v)
    if (slender.mesh.points(0, v) == 0) slender.prescribed.push_back({v, Vec3d::Zero()});
  slender.gravity = {0, 0, -9.81};
  slender.materials = {smoothed(slender).materials[0]};
  CHECK(round_trip(slender, 0.08).iterations < 120);
}

// Of a bar that hangs from x = 0, of density ρ, rest length L and ν = 0: the stress is P(s) = E/2 (s³ − s) at
// the stretch s, and P = ρ g (L − X). With s₀ at the top, P(s₀) = ρ g L, and the hanging length is
// ∫ s dX = E/2ρg [¾ s⁴ − ½ s²] between 1 and s₀.
TEST_CASE("a bar under its own weight is as short as its closed form says, with an error of second order") {
  constexpr double E = 2e4, top = 1.25, density = 1000, gravity = 9.81;
  constexpr double height = E / (2 * density * gravity);
  const double rest_length = height * (top * top * top - top);
  const double length = height * (0.75 * (std::pow(top, 4) - 1) - 0.5 * (top * top - 1));
  double errors[2];
  for (int fine = 0; fine < 2; ++fine) {
    const int cells = fine ? 16 : 8;
    Setup bar = setup_of(box_mesh({length, length / cells, length / cells}, cells, 1, 1));
    bar.materials = {Elastic{0, E / 2, density}};
    bar.gravity = {gravity, 0, 0};
    for (Index v = 0; v < bar.mesh.vertex_count(); ++v)
      bar.prescribed.push_back({v, Vec3d::Zero(), {bar.mesh.points(0, v) == 0, true, true}});
    const RestShape found = find_rest_shape(bar, {.tolerance = 1e-9});
    REQUIRE_MESSAGE(found.converged, found.reason);
    double sum = 0;
    for (Index v = 0; v < bar.mesh.vertex_count(); ++v)
      if (std::abs(bar.mesh.points(0, v) - length) < 1e-9) sum += found.points(0, v) / 4;
    errors[fine] = std::abs(sum / rest_length - 1);
  }
  CHECK(length / rest_length > 1.1);
  CHECK(errors[0] < 0.005);
  CHECK(errors[1] < 0.3 * errors[0]);
}

TEST_CASE("a liver's image is met within a hundredth of a millimetre") {
  Setup liver =
      smoothed(setup_of(read_mesh(std::filesystem::path(LOBE_DATA_DIR) / "meshes" / "liver_2k.vtu").mesh));
  for (Index v = 0; v < liver.mesh.vertex_count(); ++v) {
    const Vec3d x = liver.mesh.points.col(v);
    if (x.x() < -0.02 && x.y() > 0.015) liver.prescribed.push_back({v, Vec3d::Zero()});
  }
  liver.gravity = {0, 0, -9.81};
  const RestShape found = find_rest_shape(liver);
  REQUIRE_MESSAGE(found.converged, found.reason);
  CHECK(largest_of(found.points - liver.mesh.points) > 0.01);
  CHECK(found.distance <= 1e-5);
  Setup rest = liver;
  rest.mesh.points = found.points;
  CHECK(largest_of(loaded(rest).mesh.points - liver.mesh.points) <= 1e-5);
  CHECK(found.iterations < 30);
}

TEST_CASE("a body without loads is at rest as it is given") {
  const Setup setup = hanging_bar(0);
  const RestShape found = find_rest_shape(setup);
  CHECK(found.converged);
  CHECK(found.iterations == 1);
  CHECK(found.points == setup.mesh.points);
  CHECK(found.u.isZero(0));
  CHECK(found.distance == 0);
}

TEST_CASE("a guess at the rest shape is taken up") {
  const Setup image = loaded(hanging_bar());
  const RestShape first = find_rest_shape(image);
  const RestShape again = find_rest_shape(image, {.start = &first.points});
  CHECK(again.converged);
  CHECK(again.iterations == 1);
  CHECK(again.points == first.points);
}

TEST_CASE("what cannot be found is said, and the best shape is returned") {
  const Setup image = loaded(hanging_bar());
  int told = 0;
  const RestShape early = find_rest_shape(
      image, {.tolerance = 1e-12, .most_iterations = 2, .progress = [&](int, double) { ++told; }});
  CHECK_FALSE(early.converged);
  CHECK(early.reason.find("after 2 iterations") != std::string::npos);
  CHECK(told == 2);
  CHECK(early.distance < largest_of(image.mesh.points - hanging_bar().mesh.points));
  const RestShape none = find_rest_shape(hanging_bar(3e5));
  CHECK_FALSE(none.converged);
  CHECK(none.reason.find("% of the loads taken off") != std::string::npos);
  CHECK(none.load_fraction < 0.1);
  CHECK(none.points.allFinite());
  for (double gravity : {15, 100, 1000}) {
    const RestShape hopeless = find_rest_shape(hanging_bar(9.81 * gravity));
    CHECK_FALSE(hopeless.converged);
    CHECK_MESSAGE(hopeless.reason.find("no rest shape with more than") == 0, hopeless.reason);
    CHECK(hopeless.iterations < 100);
  }
  Setup free = hanging_bar();
  free.prescribed.clear();
  CHECK_THROWS_WITH_AS(find_rest_shape(free), doctest::Contains("held"), InputError);
  Setup inverted = hanging_bar();
  inverted.mesh.points.col(inverted.mesh.tets(0, 0)) += Vec3d(0.05, 0.05, 0.05);
  CHECK_THROWS_WITH_AS(find_rest_shape(inverted), doctest::Contains("inverted"), InputError);
}

// A straight column cannot be the image of one under ten times the load at which it buckles.
TEST_CASE("a column that would buckle has no rest shape that is straight under its load") {
  Setup column = smoothed(setup_of(box_mesh({0.16, 0.01, 0.01}, 16, 1, 1)));
  for (Index v = 0; v < column.mesh.vertex_count(); ++v) {
    if (column.mesh.points(0, v) == 0) column.prescribed.push_back({v, Vec3d::Zero()});
    if (std::abs(column.mesh.points(0, v) - 0.16) < 1e-9) column.vertex_loads.push_back({v, {-0.006, 0, 0}});
  }
  const RestShape found = find_rest_shape(column);
  CHECK_FALSE(found.converged);
  CHECK_MESSAGE(found.reason.find("buckl") != std::string::npos, found.reason);
}
