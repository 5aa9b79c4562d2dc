#include "lobe/time/vertex_frequencies.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "lobe/sim/world.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("a tournament knows the first of the largest numbers, whatever changes and is added") {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> number(0, 50);
  std::vector<double> plain(13);
  for (double& x : plain) x = number(random);
  Tournament tournament;
  tournament.assign(13, [&](Index i) { return plain[i]; });
  for (int round = 0; round < 3000; ++round) {
    if (round % 50 == 0) plain.push_back(0);
    const auto i = std::uniform_int_distribution<Index>(0, Index(plain.size()) - 1)(random);
    plain[i] = number(random);
    tournament.set(i, plain[i]);
    const auto largest = std::max_element(plain.begin(), plain.end());
    REQUIRE(tournament.largest() == *largest);
    if (*largest > 0) REQUIRE(tournament.winner() == largest - plain.begin());
  }
}

TEST_CASE("corner stiffnesses add up to the diagonal stiffness of both regions, deformed") {
  Setup setup = hybrid_setup(irregular_box(3));
  setup.guard_below = 0.95;
  const Elements elements(setup);
  const Mat3X<double> u = random_displacement(setup.mesh.vertex_count(), 1e-3);
  RegionEdit edit;
  edit.entered.resize(std::size_t(setup.mesh.tet_count()));
  std::iota(edit.entered.begin(), edit.entered.end(), 0);
  edit.vertices.resize(std::size_t(setup.mesh.vertex_count()));
  std::iota(edit.vertices.begin(), edit.vertices.end(), 0);
  TensorMassRegion<double> linear;
  NonlinearRegion<double> nonlinear;
  linear.follow(elements, edit);
  nonlinear.follow(elements, edit);
  DiagonalStiffness regions = DiagonalStiffness::Zero(6, setup.mesh.vertex_count()), sum = regions;
  Parallel one_thread;
  linear.add_diagonal_stiffness(u, regions, one_thread);
  nonlinear.add_diagonal_stiffness(u, regions, one_thread);
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const CornerStiffness K = corner_stiffness(elements, t, u(Eigen::all, setup.mesh.tets.col(t)));
    for (int c = 0; c < 4; ++c) sum.col(setup.mesh.tets(c, t)) += K.col(c);
  }
  CHECK((sum - regions).norm() < 1e-13 * regions.norm());
}

TEST_CASE_TEMPLATE("the time step limit that follows cuts equals the one found anew, down to nothing", Real,
                   float, double) {
  for (std::size_t batch : {1, 7}) {
    Setup setup = hybrid_setup(irregular_box(3));
    setup.guard_below = 0.95;
    for (Index v = 0; v < setup.mesh.vertex_count(); v += 7) setup.prescribed.push_back({v, Vec3d::Zero()});
    World<Real> follows(setup), anew(setup);
    State<Real> state = follows.state();
    state.u = random_displacement<Real>(setup.mesh.vertex_count(), 1e-3);
    for (World<Real>* world : {&follows, &anew}) world->set_state(state);
    follows.time_step_limit();
    std::vector<Index> order(std::size_t(setup.mesh.tet_count()));
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(11));
    for (std::size_t i = 0; i < order.size(); i += batch) {
      const std::vector<Index> now(order.begin() + long(i),
                                   order.begin() + long(std::min(order.size(), i + batch)));
      for (World<Real>* world : {&follows, &anew}) world->remove_tets(now);
      anew.step_limit().highest_vertex(anew.body());
      const double expected = anew.time_step_limit();
      if (std::isinf(expected))
        CHECK(std::isinf(follows.time_step_limit()));
      else
        CHECK(follows.time_step_limit() == near(expected, sizeof(Real) == 8 ? 1e-9 : 1e-4));
    }
  }
}
