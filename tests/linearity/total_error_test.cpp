#include "lobe/linearity/total_error.h"

#include <doctest/doctest.h>

#include <cmath>

#include "lobe/error.h"
#include "lobe/solve/static_solver.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A bar along x that is held up to some place, and grasped at its other end and pulled by so much.
Setup pulled_bar(const TetMesh& mesh, const Vec3d& pull, double held_to = 0) {
  Setup setup = setup_of(mesh);
  GraspSetup grasp{"pull", {}, {{0, Vec3d::Zero()}, {1, pull}}};
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
    if (setup.mesh.points(0, v) <= held_to) setup.prescribed.push_back({v});
    if (setup.mesh.points(0, v) > 0.08 - 1e-9) grasp.vertices.push_back(v);
  }
  setup.grasps.push_back(grasp);
  return setup;
}
TetMesh bar_mesh(int cells) { return box_mesh({0.08, 0.02, 0.02}, 4 * cells, cells, cells); }
Setup pulled_bar(int cells, const Vec3d& pull) { return pulled_bar(bar_mesh(cells), pull); }

}  // namespace

TEST_CASE("plain tetrahedra bend too little and resist too much, and a finer mesh less so") {
  double before = 1;
  for (int cells : {1, 2}) {
    const std::vector<TotalError> errors = total_errors(pulled_bar(cells, {0, 0, 0.01}));
    REQUIRE(errors.size() == 2);
    CHECK(errors[0].name == "weight, 9.81 m/s² along −z");
    CHECK(errors[0].force == 0);
    CHECK(errors[0].element.largest < -0.2);
    CHECK(errors[0].element.l2 == near(-errors[0].element.largest, 0.2));
    CHECK(errors[1].name == "pull");
    CHECK(errors[1].largest == near(0.01, 0.1));
    CHECK(errors[1].element.force > 0.15);
    CHECK(errors[0].element.l2 < before);
    before = errors[0].element.l2;
  }
}

TEST_CASE("a gesture that every tetrahedron follows exactly has no total error") {
  Setup setup = pulled_bar(2, {0.004, 0, 0});
  setup.materials[0].lambda = 0;  // so that the bar keeps its width
  const TotalError error = total_errors(setup)[1];
  CHECK(error.element.l2 < 1e-9);
  CHECK(std::abs(error.element.force) < 1e-9);
  const double E = 0.004 / 0.08 + 0.05 * 0.05 / 2;  // Green's strain: P = F S, S = 2μE
  CHECK(error.force == near(1.05 * 2 * 1e4 * E * 0.02 * 0.02, 1e-9));
}

TEST_CASE("linear regions are measured by the same truth, so that their error is part of the total error") {
  const auto truth = [](const TotalError& error) { return error.largest / (1 + error.element.largest); };
  Setup setup = pulled_bar(1, {0, 0, 0.01});
  setup.gravity = {0, 0, -20};
  const TotalError nonlinear = total_errors(setup)[0];
  std::fill(setup.region_of.begin(), setup.region_of.end(), RegionModel::tensor_mass);
  const TotalError linear = total_errors(setup)[0];
  CHECK(truth(linear) == near(truth(nonlinear), 1e-9));
  CHECK(linear.largest == near(solve_static(setup).u.colwise().norm().maxCoeff(), 1e-9));
  CHECK(linear.largest != near(nonlinear.largest, 1e-3));
}

TEST_CASE("the table of total errors names each gesture, and why one has no figure") {
  Setup setup = pulled_bar(1, {0, 0, 0.01});
  const std::string table = total_error_table(total_errors(setup));
  CHECK(table.find("pull ") != std::string::npos);
  CHECK(table.find("N") != std::string::npos);
  setup.gravity = {0, 0, 1e308};
  const std::vector<TotalError> errors = total_errors(setup);
  CHECK(errors[0].trouble.find("too large") != std::string::npos);
  CHECK(total_error_table(errors).find("too large") != std::string::npos);
  setup.prescribed.clear();
  CHECK_THROWS_WITH_AS(total_errors(setup), doctest::Contains("is not held"), InputError);
}

TEST_CASE("what another mesh holds is a part of the total error, and none where it is the same body") {
  constexpr double held_to = 0.016;  // 0.01 on this mesh, 0.015 where it is refined
  const Vec3d pull(0, 0, 0.01);
  TotalErrorOptions options;
  options.on_refined = [&](const RefinedMesh& refined) { return pulled_bar(refined.mesh, pull, held_to); };
  for (const TotalError& error : total_errors(pulled_bar(bar_mesh(2), pull, held_to), options)) {
    INFO(error.name);
    REQUIRE(error.held);
    REQUIRE(error.total);
    CHECK(error.held_trouble.empty());
    for (const auto share : {&ErrorShare::largest, &ErrorShare::force})
      CHECK(1 + (*error.total).*share ==
            near((1 + error.element.*share) * (1 + (*error.held).*share), 1e-12));
    CHECK(error.held->l2 > 0.05);
    if (error.force > 0)
      CHECK(error.held->force < -0.1);  // its free part is longer
    else
      CHECK(1 + error.held->largest == near(std::pow(70.0 / 65, 4), 0.1));  // a beam that bends by its weight
  }
  options.on_refined = [&](const RefinedMesh& refined) { return pulled_bar(refined.mesh, pull); };
  for (const TotalError& error : total_errors(pulled_bar(2, pull), options)) {
    REQUIRE(error.held);
    CHECK(error.held->l2 < 1e-8);
    CHECK(error.total->l2 == near(error.element.l2, 1e-6));
  }
  options.on_refined = [](const RefinedMesh&) -> Setup { throw InputError("scene", "selects nothing"); };
  const std::vector<TotalError> errors = total_errors(pulled_bar(1, pull), options);
  CHECK_FALSE(errors[0].held);
  CHECK(errors[0].element.l2 > 0);
  CHECK(total_error_table(errors).find("what is held: scene: selects nothing") != std::string::npos);
}
