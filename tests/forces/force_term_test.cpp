// A force term of an application's own, which it adds to a world (forces/force_term.h).
#include "lobe/forces/force_term.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "condense/half_linear.h"
#include "lobe/error.h"
#include "lobe/sim/checkpoint.h"
#include "near.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double frame_length = 0.02;  // [s]

// The springs of SetSprings once more, and a count of evaluations, which is its state.
class OwnSprings : public ForceTerm<double> {
 public:
  explicit OwnSprings(std::vector<Spring> springs) : springs_(std::move(springs)) {}
  std::string name() const override { return "own springs"; }
  void add_forces(const At& at, Mat3X<double>& f) override {
    ++evaluations;
    for (const Spring& s : springs_)
      f.col(s.vertex) +=
          s.stiffness * (s.point - at.model.elements.points.col(s.vertex) - at.u.col(s.vertex));
  }
  void add_diagonal_stiffness(const At&, DiagonalStiffness& K) override {
    for (const Spring& s : springs_)
      for (int entry : {0, 3, 5}) K(entry, s.vertex) += s.stiffness;
  }
  double energy(const At& at) override {
    double sum = 0;
    for (const Spring& s : springs_)
      sum += s.stiffness / 2 *
             (s.point - at.model.elements.points.col(s.vertex) - at.u.col(s.vertex)).squaredNorm();
    return sum;
  }
  std::vector<Index> acts_on(const Model&) const override {
    std::vector<Index> vertices;
    for (const Spring& s : springs_) vertices.push_back(s.vertex);
    return vertices;
  }
  std::string save() const override { return std::to_string(evaluations); }
  void load(const std::string& saved, Index) override { evaluations = std::stoll(saved); }

  long long evaluations = 0;

 private:
  std::vector<Spring> springs_;
};

// From some vertices to points beside them.
std::vector<Spring> some_springs(const Setup& setup) {
  std::vector<Spring> springs;
  for (Index v = 0; v < setup.mesh.vertex_count(); v += 5)
    springs.push_back({v, 30, Vec3d(setup.mesh.points.col(v)) + Vec3d(0.002, 0, 0.001)});
  return springs;
}

}  // namespace

TEST_CASE("a term that is added does what the world's own one of the same forces does") {
  const Setup setup = half_linear(RegionModel::tensor_mass);
  World<double> own(setup), known(setup);
  const double alone = own.time_step_limit();
  own.add(std::make_shared<OwnSprings>(some_springs(setup)));
  known.apply(SetSprings{some_springs(setup)});
  CHECK(own.time_step_limit() == near(known.time_step_limit(), 1e-12));
  CHECK(own.time_step_limit() < alone);
  for (int i = 0; i < 20; ++i) {
    REQUIRE(own.advance(frame_length).ok);
    known.advance(frame_length);
  }
  CHECK(known.state().u.norm() > 1e-3);
  CHECK((own.state().u - known.state().u).norm() < 1e-12 * known.state().u.norm());
  CHECK(own.energies().applied == near(known.energies().applied, 1e-12));
  CHECK(own.energies().applied > 0);
}

TEST_CASE("what a term acts on does not sleep, and a second one of the same name is refused") {
  Setup setup = half_linear(RegionModel::nonlinear);
  setup.sleep = 1e-3;
  setup.damping = 50;
  World<double> world(setup);
  for (int i = 0; i < 50; ++i) world.advance(frame_length);
  REQUIRE(world.body().sleep.any());
  const Mat3X<double> before = world.state().u;
  const auto term = std::make_shared<OwnSprings>(some_springs(setup));
  world.add(term);
  for (int i = 0; i < 50; ++i) world.advance(frame_length);
  CHECK((world.state().u - before).norm() > 1e-3);
  CHECK_THROWS_WITH_AS(world.add(std::make_shared<OwnSprings>(some_springs(setup))),
                       "force term: there is one of the name \"own springs\" already", InputError);
  setup.integrator = Integrator::generalised_alpha;
  setup.implicit_step = 0.01;
  setup.sleep = 0;
  World<double> implicit(setup);
  CHECK_THROWS_AS(implicit.add(std::make_shared<OwnSprings>(some_springs(setup))), InputError);
}

TEST_CASE("the state of a term that is added is part of checkpoints") {
  const Setup setup = half_linear(RegionModel::tensor_mass);
  World<double> world(setup), other(setup), without(setup);
  const auto term = std::make_shared<OwnSprings>(some_springs(setup)),
             same = std::make_shared<OwnSprings>(some_springs(setup));
  world.add(term);
  other.add(same);
  for (int i = 0; i < 5; ++i) world.advance(frame_length);
  const Checkpoint<double> checkpoint = world.save();
  const long long evaluations = term->evaluations;
  CHECK(evaluations > 5);
  other.restore(checkpoint);
  CHECK(same->evaluations == evaluations);
  for (World<double>* one : {&world, &other})
    for (int i = 0; i < 5; ++i) one->advance(frame_length);
  CHECK(other.state().u == world.state().u);
  CHECK(same->evaluations == term->evaluations);
  CHECK_THROWS_WITH_AS(without.restore(checkpoint),
                       "checkpoint: has a force term \"own springs\", which the world has not: add it",
                       InputError);
  CHECK(without.time() == 0);
}

TEST_CASE(
    "a checkpoint whose state of an added term does not load leaves the world and the term as they were") {
  const Setup setup = half_linear(RegionModel::tensor_mass);
  World<double> world(setup);
  const auto term = std::make_shared<OwnSprings>(some_springs(setup));
  world.add(term);
  const Checkpoint<double> start = world.save();
  for (int i = 0; i < 5; ++i) world.advance(frame_length);
  world.remove_tets({0, 1});
  const Mat3X<double> u = world.state().u;
  const double time = world.time();
  const long long evaluations = term->evaluations;
  for (Checkpoint<double> damaged : {start, world.save()}) {
    REQUIRE(damaged.terms.size() == 1);
    damaged.terms[0].saved = "no number";
    CHECK_THROWS_AS(world.restore(damaged), std::invalid_argument);
    CHECK(world.state().u == u);
    CHECK(world.time() == time);
    CHECK_FALSE(world.elements().topology.alive(0));
    CHECK(term->evaluations == evaluations);
  }
  world.restore(start);
  CHECK(world.time() == 0);
  CHECK(world.elements().topology.alive(0));
}
