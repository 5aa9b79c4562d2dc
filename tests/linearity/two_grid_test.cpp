#include "lobe/linearity/two_grid.h"

#include <doctest/doctest.h>

#include "lobe/linearity/error_equation.h"
#include "lobe/numerics/supernodal_factor.h"
#include "lobe/solve/tangent.h"
#include "near.h"
#include "reduced_bar.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// The stiffness at rest and its inverse, where a bar is not held.
struct Rest {
  explicit Rest(const Setup& setup)
      : elements(setup),
        held(held_by(setup.prescribed)),
        all(setup.mesh.vertex_count(), [](Index, int) { return true; }),
        free(free_components(elements, held)),
        whole(elements, all),
        tangent(elements, free),
        factor(tangent.make_factor(make_supernodal)) {
    const Mat3X<double> rest = Mat3X<double>::Zero(3, setup.mesh.vertex_count());
    whole.update(rest);
    tangent.update(rest);
    bool damped = false;
    REQUIRE(tangent.factorise(*factor, damped));
  }
  Mat3X<double> times(const Mat3X<double>& x) const {
    return all.scatter(whole.matrix().selfadjointView<Eigen::Lower>() * all.gather(x));
  }
  Mat3X<double> solve(const Mat3X<double>& f) const {
    return free.scatter(tangent.solve(*factor, free.gather(f)));
  }
  TwoGrid::Product product() const {
    return [this](const Mat3X<double>& x) { return times(x); };
  }

  Elements elements;
  HeldVertices held;
  Unknowns all, free;
  Tangent whole, tangent;
  std::unique_ptr<SparseFactor> factor;
};

}  // namespace

TEST_CASE("cycles over two grids converge to the exact solution, of nearly incompressible bodies, too") {
  for (double volume_penalty : {0.0, 1e5})
    for (int across : {4, 8}) {
      Setup setup = damped_bar(4 * across, across);
      setup.volume_penalty = volume_penalty;
      const Rest rest(setup);
      TwoGrid grid(rest.elements, 0.03);
      grid.prepare(rest.held, 1, 0);
      const Mat3X<double> f = random_displacement(setup.mesh.vertex_count(), 1);
      const Mat3X<double> exact = rest.solve(f);
      Mat3X<double> x = Mat3X<double>::Zero(3, f.cols());
      double error = exact.norm();
      for (int i = 0; i < 12; ++i) {
        x += grid.solve(rest.product(), f - rest.times(x));
        const double left = (x - exact).norm();
        CAPTURE(i);
        CHECK(left < 0.9 * error);
        error = left;
      }
      CHECK(error < 0.015 * exact.norm());
    }
}

TEST_CASE("one cycle finds most of what a smooth force does, of inertia, too") {
  const Setup setup = damped_bar(32, 8);
  const Rest rest(setup);
  TwoGrid grid(rest.elements, 0.02);
  for (Index v = 0; v < grid.vertex_count(); ++v)
    CHECK(grid.mass()[std::size_t(v)] == lumped_mass(rest.elements, v));
  Mat3X<double> f = Mat3X<double>::Zero(3, setup.mesh.vertex_count());
  for (Index v = 0; v < f.cols(); ++v) f(2, v) = grid.mass()[std::size_t(v)];
  grid.prepare(rest.held, 1, 0);
  const Mat3X<double> exact = rest.solve(f);
  CHECK((grid.solve(rest.product(), f) - exact).norm() < 0.4 * exact.norm());
  grid.prepare(rest.held, 1e-9, 1);
  const Mat3X<double> fall = grid.solve(rest.product(), f);
  for (Index v = 0; v < f.cols(); ++v) CHECK(fall(2, v) == near(rest.held.holds(v) ? 0 : 1, 0.3, 1));
}

TEST_CASE("a grid that was factored for another equation, without what tools hold, solves nearly as well") {
  const Setup setup = damped_bar(24, 6);
  const Rest rest(setup);
  HeldVertices by_tool = rest.held, by_boundary = rest.held;
  for (Index v : vertices_near(setup.mesh, {0.24, 0.03, 0.03}, 0.015)) {
    by_tool.hold({.vertex = v, .holder = 1});
    by_boundary.hold({.vertex = v});
  }
  REQUIRE(by_boundary.all().size() > rest.held.all().size() + 5);
  const Mat3X<double> f = random_displacement(setup.mesh.vertex_count(), 1);
  TwoGrid factored(rest.elements, 0.02);
  factored.prepare(by_boundary, 1, 4e3);
  const Mat3X<double> exact = factored.solve(rest.product(), f);
  TwoGrid used(rest.elements, 0.02);
  used.prepare(rest.held, 1, 1e3);
  CHECK((used.solve(rest.product(), f) - exact).norm() > 0.2 * exact.norm());
  used.prepare(by_tool, 1, 4e3);
  const Mat3X<double> near_it = used.solve(rest.product(), f);
  CHECK((near_it - exact).norm() < 0.1 * exact.norm());
  for (const HeldVertices::Held& item : by_tool.all()) CHECK(near_it.col(item.vertex).isZero(0));
}

TEST_CASE("what is lost at once is part of the error, swings and dies away") {
  const Setup setup = damped_bar(16, 4);
  const Rest rest(setup);
  ErrorEquation equation(TwoGrid(rest.elements, 0.02), 20);
  const Mat3X<double> none = Mat3X<double>::Zero(3, setup.mesh.vertex_count());
  Mat3X<double> lost = none;
  for (Index v = 0; v < lost.cols(); ++v) lost(2, v) = std::pow(setup.mesh.points(0, v), 2);
  equation.add(lost);
  CHECK(equation.error() == lost);
  const double before = equation.norm();
  equation.step(rest.product(), rest.held, none, 0.01);
  CHECK(equation.norm() > 0.3 * before);
  CHECK(equation.norm() < before);
  for (int i = 0; i < 100; ++i) equation.step(rest.product(), rest.held, none, 0.02);
  CHECK(equation.norm() < 1e-3 * before);
}

TEST_CASE("under a constant residual the error becomes that of equilibrium; without one it dies away") {
  const Setup setup = damped_bar(16, 4);
  const Rest rest(setup);
  ErrorEquation equation(TwoGrid(rest.elements, 0.02), 20);
  Mat3X<double> r = Mat3X<double>::Zero(3, setup.mesh.vertex_count());
  for (Index v = 0; v < r.cols(); ++v) r(2, v) = 0.1 * equation.grid().mass()[std::size_t(v)];
  for (int i = 0; i < 100; ++i) equation.step(rest.product(), rest.held, r, 0.05);
  const Mat3X<double> exact = rest.solve(r);
  CHECK((equation.error() - exact).norm() < 1e-3 * exact.norm());
  for (int i = 0; i < 100; ++i)
    equation.step(rest.product(), rest.held, Mat3X<double>::Zero(3, r.cols()), 0.05);
  CHECK(equation.error().norm() < 1e-6 * exact.norm());
}

TEST_CASE("held vertices keep their error, and copies have that of their originals") {
  const Setup setup = damped_bar(8, 4);
  Rest rest(setup);
  ErrorEquation equation(TwoGrid(rest.elements, 0.02), 20);
  Mat3X<double> r = Mat3X<double>::Zero(3, setup.mesh.vertex_count());
  for (Index v = 0; v < r.cols(); ++v) r(2, v) = 0.1 * equation.grid().mass()[std::size_t(v)];
  for (int i = 0; i < 10; ++i) equation.step(rest.product(), rest.held, r, 0.05);
  const Index tip = vertices_near(setup.mesh, {0.08, 0.02, 0.02}, 0.01).front();
  const Vec3d before = equation.error().col(tip);
  CHECK(before.norm() > 0);
  HeldVertices held = rest.held;
  held.hold({.vertex = tip, .holder = 1});
  for (int i = 0; i < 10; ++i) equation.step(rest.product(), held, 2 * r, 0.05);
  CHECK(equation.error().col(tip) == before);
  std::vector<Index> cut;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (std::abs(barycentre(setup.mesh, t).x() - 0.04) < 0.01 && barycentre(setup.mesh, t).z() < 0.035)
      cut.push_back(t);
  Elements& elements = rest.elements;
  elements.follow(elements.topology.remove(cut));
  elements.points.extend(elements.topology.vertex_count());
  for (Index v = setup.mesh.vertex_count(); v < elements.topology.vertex_count(); ++v)
    elements.points.col(v) = elements.points.col(elements.topology.origin(v));
  equation.use(TwoGrid(elements, 0.02), elements.topology);
  CHECK(equation.error().cols() == elements.topology.vertex_count());
  CHECK(equation.error().col(tip) == before);
}
