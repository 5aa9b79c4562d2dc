#include "lobe/fem/smoothed_edge.h"

#include <doctest/doctest.h>

#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

std::vector<Index> around_edge(const Topology& topology, Index a, Index b) {
  std::vector<Index> tets;
  for (Index t : topology.around(a))
    if ((topology.corners(t).array() == b).any()) tets.push_back(t);
  return tets;
}

}  // namespace

TEST_CASE("a domain's gradient is the mean of its tetrahedra's, and its volume a sixth of theirs") {
  const TetMesh mesh = irregular_box(2);
  const Elements elements(setup_of(mesh));
  const Mat3X<double> u = random_displacement(mesh.vertex_count(), 2e-3);
  const Index a = 13;  // in the middle
  for (Index b : {Index(0), Index(4), Index(12), Index(14)}) {
    const std::vector<Index> tets = around_edge(elements.topology, a, b);
    REQUIRE(!tets.empty());
    SmoothedEdge edge;
    find_smoothed_edge(elements, a, b, tets, edge);
    double volume = 0;
    Mat3<double> mean = Mat3<double>::Zero();
    for (Index t : tets) {
      const Shape s = elements.shape_of(t);
      const Mat34<double> at = u(Eigen::all, elements.topology.corners(t));
      volume += s.volume / 6;
      mean += s.volume / 6 * displacement_gradient<double>(at, s.gradients.rightCols<3>());
    }
    CHECK(edge.volume == near(volume, 1e-14));
    CHECK((displacement_gradient(edge, u) - mean / volume).norm() < 1e-13 * mean.norm() / volume);
    Vec3d sum = Vec3d::Zero();
    for (const Vec3d& gradient : edge.gradients) sum += gradient;
    CHECK(sum.norm() < 1e-12 * edge.gradients[0].norm());
    CHECK(edge.vertices[0] == a);
    CHECK(edge.vertices[1] == b);
    CHECK(edge.vertices.size() >= 4);
  }
}

TEST_CASE(
    "a domain's fibre is the principal direction of its tetrahedra's, whichever way each of them points") {
  Setup setup = setup_of(irregular_box(2));
  setup.mesh.fibres = Vec3d(1, 2, 2).normalized().replicate(1, setup.mesh.tet_count());
  for (Index t = 0; t < setup.mesh.tet_count(); t += 2) setup.mesh.fibres.col(t) *= -1;
  const Elements elements(setup);
  SmoothedEdge edge;
  find_smoothed_edge(elements, 13, 0, around_edge(elements.topology, 13, 0), edge);
  CHECK(std::abs(edge.direction.dot(Vec3d(1, 2, 2))) == near(3, 1e-14));
}

TEST_CASE("volume term and guard are left to each tetrahedron, the rest of the law to the domains") {
  Setup setup = setup_of(irregular_box(1));
  setup.volume_penalty = 1e5;
  setup.guard_below = 0.2;
  const Elements elements(setup);
  const Elastic plain{4e4, 1e4, 1000};
  Elastic elastic = plain;
  elastic.element = ElementType::edge_smoothed;
  const Law<double> own = unsmoothed_law(elements, elastic, RegionModel::nonlinear);
  CHECK(own.terms == Terms{.solid = MaterialLaw::none, .volume = true, .guard = true});
  CHECK(own.kappa == 1e5);
  CHECK(own.guard_modulus == 6e4);
  CHECK(own.lambda == 0);
  CHECK(own.mu == 0);
  CHECK(unsmoothed_law(elements, plain, RegionModel::nonlinear).terms ==
        nonlinear_law(plain, 1e5, 0.2).terms);
  CHECK(unsmoothed_law(elements, elastic, RegionModel::corotational).terms ==
        Terms{.solid = MaterialLaw::none});
  SmoothedEdge edge;
  edge.model = RegionModel::corotational;
  CHECK(smoothed_law(elements, edge).terms == Terms{.solid = MaterialLaw::corotational});
  edge.model = RegionModel::nonlinear;
  CHECK(smoothed_law(elements, edge).terms == Terms{});
}
