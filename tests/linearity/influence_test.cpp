#include "lobe/linearity/influence.h"

#include <doctest/doctest.h>

#include "lobe/linearity/defect.h"
#include "lobe/solve/static_solver.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A bar that is clamped at one end and bent at the other.
Setup bent_bar(double lift) {
  Setup setup = setup_of(box_mesh({0.12, 0.03, 0.03}, 12, 3, 3));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < 1e-9) setup.prescribed.push_back({v, Vec3d::Zero()});
  const auto clamped = setup.prescribed.size();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) > 0.12 - 1e-9) setup.prescribed.push_back({v, {0, 0, lift}});
  REQUIRE(clamped == 16);
  return setup;
}

HeldVertices clamp(const Setup& setup) {
  HeldVertices held;
  for (std::size_t i = 0; i < 16; ++i)
    held.hold({setup.prescribed[i].vertex, HeldVertices::boundary, Vec3d::Zero(), Vec3d::Zero()});
  return held;
}

std::vector<Index> grip(const Setup& setup) {
  std::vector<Index> vertices;
  for (std::size_t i = 16; i < setup.prescribed.size(); ++i) vertices.push_back(setup.prescribed[i].vertex);
  return vertices;
}

Eigen::VectorXd zone_means(const Elements& elements, const Zones& zones, const Mat3X<double>& u) {
  Eigen::VectorXd means = Eigen::VectorXd::Zero(3 * zones.count());
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    const Index z = zones.of[std::size_t(t)];
    const Mat34<double> corners = u(Eigen::all, elements.topology.corners(t));
    means.segment<3>(3 * z) +=
        signed_volume(elements.corner_points(t)) / zones.volume[std::size_t(z)] * corners.rowwise().mean();
  }
  return means;
}

}  // namespace

// The linear body with the defect of the exact state as a load is the exact body: K (u_linear − u_exact) =
// its force.
TEST_CASE("the error of the all-linear body is predicted from the exact state as zones become fine") {
  const Setup setup = bent_bar(0.02);
  Setup linear = setup;
  for (RegionModel& region : linear.region_of) region = RegionModel::tensor_mass;
  const Mat3X<double> exact = solve_static(setup).u, found = solve_static(linear).u;
  const Elements elements(setup);
  const auto deviation = [&](Index count) {
    const Zones zones(elements, count);
    const Influence influence(elements, zones, held_by(setup.prescribed), {});
    const Defects defects = exact_defects(elements, zones, exact);
    Eigen::VectorXd predicted = Eigen::VectorXd::Zero(3 * zones.count());
    for (Index z = 0; z < zones.count(); ++z) predicted += influence.displacement(z, defects.col(z));
    const Eigen::VectorXd measured = zone_means(elements, zones, found - exact);
    return (predicted - measured).norm() / measured.norm();
  };
  const double coarse = deviation(20);
  CHECK(coarse < 1);
  CHECK(deviation(100) < 0.75 * coarse);
  CHECK(deviation(setup.mesh.tet_count()) < 2e-5);  // each tetrahedron a zone: no average; single precision
}

TEST_CASE("a grasp of one vertex is what holding it is") {
  const Setup setup = bent_bar(0.01);
  const Elements elements(setup);
  const Zones zones(elements, 12);
  const Index vertex = grip(setup)[5];
  HeldVertices held = clamp(setup);
  Influence grasped(elements, zones, held, {{vertex}, grip(setup)});
  grasped.hold({0});
  held.hold({vertex, HeldVertices::boundary, Vec3d::Zero(), Vec3d::Zero()});
  const Influence fixed(elements, zones, held, {});
  const Eigen::Matrix<double, 9, 1> defect = Eigen::Matrix<double, 9, 1>::LinSpaced(-1, 1);
  for (Index z = 0; z < zones.count(); ++z) {
    const Eigen::VectorXd expected = fixed.displacement(z, defect);
    CHECK((grasped.displacement(z, defect) - expected).norm() < 1e-4 * expected.norm());
  }
}

TEST_CASE("who holds is part of the influence: letting go gives what it was") {
  const Setup setup = bent_bar(0.01);
  const Elements elements(setup);
  const Zones zones(elements, 12);
  Influence influence(elements, zones, clamp(setup), {grip(setup)});
  const Eigen::Matrix<double, 9, 1> defect = Eigen::Matrix<double, 9, 1>::LinSpaced(-1, 1);
  const Eigen::VectorXd before = influence.displacement(3, defect);
  influence.hold({0});
  const Eigen::VectorXd held = influence.displacement(3, defect);
  influence.hold({});
  CHECK((influence.displacement(3, defect) - before).norm() == 0);
  CHECK((held - before).norm() > 0.1 * before.norm());
}

TEST_CASE("of a body that floats nothing is said; beside it a zone that it shares is what it is without") {
  Setup setup = bent_bar(0);
  setup.prescribed.clear();
  const Elements elements(setup);
  const Zones zones(elements, 4);
  const Eigen::Matrix<double, 9, 1> defect = Eigen::Matrix<double, 9, 1>::LinSpaced(-1, 1);
  CHECK(Influence(elements, zones, HeldVertices{}, {}).displacement(1, defect).norm() == 0);

  Setup cut = bent_bar(0);
  Elements left(cut);
  std::vector<Index> gap;
  for (Index t = 0; t < cut.mesh.tet_count(); ++t)
    if (std::abs(barycentre(cut.mesh, t).x() - 0.065) < 0.005) gap.push_back(t);
  left.topology.remove(gap);
  const Zones halves(left, 2);
  const Influence influence(left, halves, clamp(cut), {});
  for (Index z = 0; z < 2; ++z)
    CHECK(influence.displacement(z, defect).norm() < 1);  // of pieces, 1e9 times more
}
