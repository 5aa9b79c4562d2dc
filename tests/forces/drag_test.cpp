// A force term that damps: the drag of a fluid around the body, f_v = −c m_v v_v. It acts on all vertices and
// wakes none.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lattice/lattice_worlds.h"
#include "lobe/forces/force_term.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

class Drag : public ForceTerm<double> {
 public:
  Drag(double rate, std::vector<double> mass, bool tells = true)
      : rate_(rate), mass_(std::move(mass)), tells_(tells) {}
  std::string name() const override { return "drag"; }
  void add_forces(const At& at, Mat3X<double>& f) override {
    for (std::size_t v = 0; v < mass_.size(); ++v) f.col(Index(v)) -= rate_ * mass_[v] * at.v.col(Index(v));
  }
  void add_diagonal_damping(const At&, std::vector<double>& damping) const override {
    for (std::size_t v = 0; v < mass_.size() && tells_; ++v) damping[v] += rate_ * mass_[v];
  }
  std::vector<Index> acts_on(const Model& model) const override {
    std::vector<Index> all(std::size_t(model.elements.topology.vertex_count()));
    std::iota(all.begin(), all.end(), 0);
    return all;
  }
  std::vector<Index> wakes(const Model&) const override { return {}; }

 private:
  double rate_;  // c [1/s]
  std::vector<double> mass_;
  bool tells_;  // the step limit
};

void add_drag(World<double>& world, double rate, const Setup& setup, bool tells = true) {
  const World<double> full(
      all_nonlinear(setup));  // vertices that follow a lattice have no masses of their own
  world.add(std::make_shared<Drag>(rate, full.body().inertia.mass(), tells));
}

constexpr double g = 9.81;  // [m/s²]

// A body that nothing holds: it falls as a whole.
Setup falling() {
  Setup setup = setup_of(irregular_box(3), RegionModel::nonlinear);
  setup.gravity = {0, 0, -g};
  return setup;
}

}  // namespace

TEST_CASE("a body falls against a drag as central differences with a force half a step late say") {
  const double highest = 2 / World<double>(falling()).time_step_limit();
  for (double share : {0.5, 2.0, 8.0}) {
    CAPTURE(share);
    const double c = share * highest;
    World<double> world(falling());
    add_drag(world, c, falling());
    CHECK(world.time_step_limit() == near(4 / (c + std::hypot(c, 2 * highest)), 1e-12));
    const double dt = 0.9 * world.time_step_limit();
    double v = 0, z = 0;
    for (int i = 0; i < 300; ++i) {
      v += (i == 0 ? dt / 2 : dt) * (-g - c * v);
      z += dt * v;
      REQUIRE(world.step(dt));
    }
    const auto u = world.state().u;
    CHECK(u.row(2).minCoeff() == near(z, 1e-9));
    CHECK(u.row(2).maxCoeff() == near(z, 1e-9));
    CHECK(v == near(-g / c, 1e-6));
  }
}

TEST_CASE("frames are as long as a drag allows, and too long if it does not tell") {
  const double c = 8 * 2 / World<double>(falling()).time_step_limit();
  for (bool tells : {true, false}) {
    CAPTURE(tells);
    World<double> world(falling());
    add_drag(world, c, falling(), tells);
    int reruns = 0;
    bool ok = true;
    for (int i = 0; i < 5 && ok; ++i) {
      const Report report = world.advance(0.01);
      reruns += report.reruns;
      ok = report.ok;
    }
    CHECK((ok && reruns == 0) == tells);
    if (tells) CHECK(world.state().v.row(2).mean() == near(-g / c, 1e-6));
  }
}

TEST_CASE("a body sinks as far in a fluid, whether it is reduced or not") {
  std::vector<double> sunk;
  for (RegionModel model : {RegionModel::nonlinear, RegionModel::reduced}) {
    Setup setup = bar(16, 4, true, model);
    setup.gravity = {0, 0, -g};
    World<double> world(setup);
    add_drag(world, 200, setup);
    for (int i = 0; i < 20; ++i) REQUIRE(world.advance(0.01).ok);
    sunk.push_back(world.state().u.row(2).mean());
  }
  CHECK(sunk[0] < -1e-4);
  CHECK(sunk[1] == near(sunk[0], 1e-6));
}

TEST_CASE("what a drag has brought to rest sleeps") {
  Setup setup = setup_of(irregular_box(3), RegionModel::nonlinear);
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.gravity = {0, 0, -g};
  setup.sleep = 1e-3;
  World<double> world(setup);
  add_drag(world, 100, setup);
  for (int i = 0; i < 100; ++i) REQUIRE(world.advance(0.02).ok);
  CHECK(world.body().sleep.any());
}
