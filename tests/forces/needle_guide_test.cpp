#include "lobe/forces/needle_guide.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>

#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double guide_dt = 1e-4;  // [s]
constexpr double sticks = std::numeric_limits<double>::infinity();

const auto apart = [](double mass) {  // points that do not act on each other
  return [mass](std::size_t a, std::size_t b) -> Vec3d {
    return a == b ? Vec3d::Constant(1 / mass) : Vec3d::Zero();
  };
};

// Points that share the corners of one tetrahedron, whose corners have masses.
struct Shared {
  std::vector<Eigen::Vector4d> weights;
  Eigen::Vector4d masses{1e-5, 2e-5, 1.5e-5, 3e-5};
  Vec3d operator()(std::size_t a, std::size_t b) const {
    return Vec3d::Constant((weights[a].array() * weights[b].array() / masses.array()).sum());
  }
};

Shared shared_points(int count, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  Shared made;
  for (int i = 0; i < count; ++i) {
    Eigen::Vector4d w(unit(random), unit(random), unit(random), unit(random));
    made.weights.push_back(w / w.sum());
  }
  return made;
}

Vec3d random_vector(double size, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-size, size);
  return {unit(random), unit(random), unit(random)};
}

// The places of points, less those that they should have at the end: −F/k − ds t, by the equations.
Vec3d rest_of(const NeedleGuide& guide, std::size_t i, const Shared& mobility, double dt) {
  const NeedleGuide::Point& p = guide.points()[i];
  Vec3d x = p.x + dt * p.v;
  for (std::size_t k = 0; k < guide.points().size(); ++k)
    x += dt * dt * mobility(i, k).cwiseProduct(guide.points()[k].force);
  return x - p.c + p.force / NeedleGuide::stiffness + p.slipped * p.along;
}

}  // namespace

TEST_CASE("a free point comes to the needle in one step, but for its force over the needle's stiffness") {
  NeedleGuide guide;
  constexpr double mass = 1e-5;
  guide.couple(1, apart(mass));
  NeedleGuide::Point& p = guide.points()[0];
  p.x = {0.001, 0.002, -0.001};
  p.v = {0.1, 0, -0.3};
  p.c = {0.0012, 0.0017, -0.0008};
  p.along = Vec3d(1, 2, 2).normalized();
  p.friction = sticks;
  guide.solve(guide_dt, guide_dt);
  const Vec3d gap = p.c - p.x - guide_dt * p.v;
  const double yields = 1 / NeedleGuide::stiffness + guide_dt * guide_dt / mass;
  for (int i = 0; i < 3; ++i) CHECK(p.force[i] == near(gap[i] / yields, 1e-12));
  CHECK(p.slipped == 0);
  const Vec3d after = p.x + guide_dt * (p.v + guide_dt * p.force / mass);
  CHECK((after - p.c + p.force / NeedleGuide::stiffness).norm() < 1e-16);
}

TEST_CASE("a needle that goes through drags the tissue by the friction, and slips by the rest of its way") {
  NeedleGuide guide;
  constexpr double mass = 1e-5, friction = 0.03, way = 5e-4;
  guide.couple(1, apart(mass));
  NeedleGuide::Point& p = guide.points()[0];
  for (const double sign : {1.0, -1.0}) {
    p = {};
    p.along = Vec3d(0, 0.6, 0.8);
    p.c = sign * way * p.along;
    p.friction = friction;
    guide.solve(guide_dt, guide_dt);
    CHECK(p.force.dot(p.along) == near(sign * friction, 1e-14));
    CHECK((p.force - sign * friction * p.along).norm() < 1e-14);
    const double comes = friction * (guide_dt * guide_dt / mass + 1 / NeedleGuide::stiffness);
    CHECK(p.slipped == near(sign * (way - comes), 1e-12));
    CHECK(guide.friction_loss() == near(friction * (way - comes), 1e-12));
  }
}

TEST_CASE("a needle without friction only guides") {
  NeedleGuide guide;
  guide.couple(1, apart(1e-5));
  NeedleGuide::Point& p = guide.points()[0];
  p.along = Vec3d::UnitZ();
  p.c = {1e-4, 0, 3e-4};
  guide.solve(guide_dt, guide_dt);
  CHECK(p.force.z() == 0);
  CHECK(p.force.y() == 0);
  CHECK(p.force.x() > 0);
  CHECK(p.slipped == near(3e-4, 1e-12));
}

TEST_CASE("held components of a point do not answer, and the needle yields by its stiffness") {
  NeedleGuide guide;
  guide.couple(1, [](std::size_t, std::size_t) -> Vec3d { return {0, 0, 1e5}; });
  NeedleGuide::Point& p = guide.points()[0];
  p.c = {1e-4, 0, 0};
  p.friction = sticks;
  guide.solve(guide_dt, guide_dt);
  CHECK(p.force.x() == near(1e-4 * NeedleGuide::stiffness, 1e-12));
}

TEST_CASE("points of one tetrahedron satisfy the equations and the law of friction together") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  int slipping = 0, sticking = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const int count = 1 + trial % 12;
    const Shared mobility = shared_points(count, random);
    NeedleGuide guide;
    guide.couple(std::size_t(count), mobility);
    for (NeedleGuide::Point& p : guide.points()) {
      p.x = random_vector(1e-3, random);
      p.v = random_vector(0.1, random);
      p.c = p.x + random_vector(1e-4, random);
      p.along = random_vector(1, random).normalized();
      p.friction = 0.3 * unit(random);
      p.slip = int(3 * unit(random)) - 1;
    }
    guide.solve(guide_dt, guide_dt);
    for (std::size_t i = 0; i < guide.points().size(); ++i) {
      const NeedleGuide::Point& p = guide.points()[i];
      const double along = p.force.dot(p.along);
      CHECK(rest_of(guide, i, mobility, guide_dt).norm() < 1e-14);
      CHECK(std::abs(along) <= p.friction * (1 + 1e-12));
      if (p.slip == 0) {
        CHECK(p.slipped == 0);
        ++sticking;
      } else {
        CHECK(along == near(p.slip * p.friction, 1e-9));
        CHECK(p.slip * p.slipped >= 0);
        ++slipping;
      }
    }
  }
  CHECK(slipping > 100);
  CHECK(sticking > 100);
}

TEST_CASE("which points slip does not depend on which were tried first") {
  std::mt19937 random(3);
  const Shared mobility = shared_points(8, random);
  std::vector<NeedleGuide::Point> points(8);
  for (NeedleGuide::Point& p : points) {
    p.c = random_vector(1e-4, random);
    p.along = random_vector(1, random).normalized();
    p.friction = 0.1;
  }
  std::vector<Vec3d> first;
  for (const int slip : {0, 1, -1}) {
    NeedleGuide guide;
    guide.couple(8, mobility);
    guide.points() = points;
    for (NeedleGuide::Point& p : guide.points()) p.slip = slip;
    guide.solve(guide_dt, guide_dt);
    if (first.empty())
      for (const NeedleGuide::Point& p : guide.points()) first.push_back(p.force);
    for (std::size_t i = 0; i < 8; ++i) CHECK((guide.points()[i].force - first[i]).norm() < 1e-11);
  }
}

TEST_CASE("a needle a thousand times stiffer than a step bears explicitly does not swing") {
  NeedleGuide guide;
  constexpr double mass = 1e-7;  // k dt²/m = 1000, where 4 is the limit of a spring
  CHECK(NeedleGuide::stiffness * guide_dt * guide_dt / mass > 900);
  guide.couple(1, apart(mass));
  Vec3d x(2e-4, -1e-4, 0), v = Vec3d::Zero();
  double farthest = 0;
  for (int i = 0; i < 2000; ++i) {
    NeedleGuide::Point& p = guide.points()[0];
    p.x = x;
    p.v = v;
    p.friction = sticks;
    p.slip = 0;
    guide.solve(guide_dt, guide_dt);
    v += guide_dt * p.force / mass;
    x += guide_dt * v;
    if (i > 0) farthest = std::max(farthest, x.norm());
  }
  CHECK(farthest < 1e-6);
  CHECK(x.norm() < 1e-12);
}

// A mass on a spring of its own, through which a needle is pushed to and fro.
TEST_CASE("the work of the hand is what the tissue has, what the needle stores, and what friction took") {
  constexpr double mass = 1e-4, spring = 40, friction = 0.02;
  double hand = 0, lost = 0, place = 0, x = 0, v = 0, s = 0;
  NeedleGuide guide;
  guide.couple(1, apart(mass));
  const double dt = 1e-5;
  for (int i = 0; i < 40000; ++i) {
    const double next = 2e-3 * std::sin(20 * (i + 1) * dt);
    const double free = v - dt * spring * x / mass;
    NeedleGuide::Point& p = guide.points()[0];
    p = {.x = {x, 0, 0}, .v = {free, 0, 0}, .c = {next - s, 0, 0}, .friction = friction, .slip = p.slip};
    guide.solve(dt, dt);
    hand += p.force.x() * (next - place);
    lost += guide.friction_loss();
    s += p.slipped;
    v = free + dt * p.force.x() / mass;
    x += dt * v;
    place = next;
  }
  const double stored = NeedleGuide::stiffness * (x - place + s) * (x - place + s) / 2;
  const double has = mass * v * v / 2 + spring * x * x / 2;
  CHECK(lost > 1e-4);
  CHECK(hand == near(has + stored + lost, 2e-3));
}

TEST_CASE("outside of steps the force is that of the spring, along the needle at most the friction") {
  NeedleGuide::Point p;
  p.c = {1e-4, 2e-4, 0};
  p.friction = 0.5;
  CHECK((NeedleGuide::force_at_rest(p) - Vec3d(0.5, 2, 0)).norm() < 1e-12);
  p.friction = sticks;
  CHECK((NeedleGuide::force_at_rest(p) - Vec3d(1, 2, 0)).norm() < 1e-12);
}
