#include "lobe/forces/cables.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

const auto no_mobility = [](Index, Index) -> Vec3d { return Vec3d::Zero(); };

Cables::Span span(Index p, Index q, double length, double friction = 0, double stiffness = 1) {
  Cables::Span made;
  made.p = p;
  made.q = q;
  made.length = length;
  made.friction = friction;
  made.stiffness = stiffness;
  return made;
}

// A cable along a regular polygon with this turn at each point, in n spans of 1 cm; all of it is at rest.
Cables polygon(int n, double turn, double friction) {
  Cables cables;
  std::vector<Cables::Span> spans;
  Vec3d x = Vec3d::Zero();
  for (int i = 0; i <= n; ++i) {
    cables.points()[std::size_t(cables.add_point())].x = x;
    x += 0.01 * Vec3d(std::cos(i * turn), std::sin(i * turn), 0);
    if (i < n) spans.push_back(span(i, i + 1, 0.01, friction));
  }
  cables.add_chain(spans, false);
  cables.couple(no_mobility);
  return cables;
}

// Moves the last point away from the one before it.
void draw(Cables& cables, double way) {
  auto& points = cables.points();
  const Vec3d along = points.back().x - points[points.size() - 2].x;
  points.back().x += way * along.normalized();
}

double natural_length(const Cables& cables) {
  double sum = 0;
  for (const Cables::Span& each : cables.spans()) sum += each.length;
  return sum;
}

}  // namespace

TEST_CASE("a cable that slips over points has the capstan's tensions, T2 = T1 e^(mu theta)") {
  constexpr double mu = 0.2, turn = std::numbers::pi / 4;
  for (const int n : {2, 4, 8, 16}) {
    Cables cables = polygon(n, turn, mu);
    const double length = natural_length(cables);
    for (int step = 0; step < 400; ++step) {
      draw(cables, 2e-5);
      cables.solve(0, 0);
      cables.slip();
      const auto& spans = cables.spans();
      for (int i = 0; i + 1 < n; ++i) {
        REQUIRE(spans[std::size_t(i)].tension > 0);
        CHECK(spans[std::size_t(i) + 1].tension ==
              near(spans[std::size_t(i)].tension * std::exp(mu * turn), 1e-12));
      }
      CHECK(spans.back().tension == near(spans.front().tension * std::exp(mu * turn * (n - 1)), 1e-12));
    }
    CHECK(natural_length(cables) == near(length, 1e-13));
  }
}

TEST_CASE("a cable without friction has one tension, that of its whole length") {
  Cables cables = polygon(5, 0.7, 0);
  draw(cables, 1e-3);
  cables.solve(0, 0);
  for (const Cables::Span& each : cables.spans()) CHECK(each.tension == near(1e-3 / (0.05 / 1), 1e-12));
}

TEST_CASE("a cable that was drawn and is let back sticks until its tensions differ the other way round") {
  constexpr double mu = 0.3, turn = std::numbers::pi / 2;
  Cables cables = polygon(2, turn, mu);
  const double ratio = std::exp(mu * turn);
  for (int step = 0; step < 100; ++step) {
    draw(cables, 2e-5);
    cables.solve(0, 0);
    cables.slip();
  }
  const double held = cables.spans()[0].tension;
  bool has_stuck = false, has_slipped = false;
  for (int step = 0; step < 80; ++step) {
    draw(cables, -2e-5);
    cables.solve(0, 0);
    const auto& spans = cables.spans();
    const double quotient = spans[1].tension / spans[0].tension;
    CHECK(quotient < ratio * (1 + 1e-12));
    CHECK(quotient > 1 / ratio * (1 - 1e-12));
    if (spans[0].slip == 0) {
      has_stuck = true;
      CHECK(spans[0].tension == near(held, 1e-10));
    } else {
      has_slipped = true;
      CHECK(spans[0].slip == -1);
      CHECK(quotient == near(1 / ratio, 1e-12));
    }
    cables.slip();
  }
  CHECK(has_stuck);
  CHECK(has_slipped);
}

TEST_CASE("the work of the hand is the energy of a cable and what friction took") {
  constexpr int steps = 4000;
  Cables cables = polygon(4, std::numbers::pi / 2, 0.3);
  double work = 0, friction = 0;
  for (int step = 0; step < steps; ++step) {
    const double way = step < steps * 3 / 4 ? 4e-7 : -4e-7, before = cables.spans().back().tension;
    draw(cables, way);
    cables.solve(0, 0);
    friction += cables.slip().friction;
    work += way * (before + cables.spans().back().tension) / 2;
  }
  cables.place();
  CHECK(friction > 0.1 * work);
  CHECK(cables.energy() + friction == near(work, 1e-3));
}

TEST_CASE("a slack part of a cable gives to a taut one, and no tension is negative") {
  Cables cables;
  for (const double x : {0.0, 0.01, 0.02}) cables.points()[std::size_t(cables.add_point())].x.x() = x;
  cables.add_chain({span(0, 1, 0.012, 0.2), span(1, 2, 0.009)}, false);
  cables.couple(no_mobility);
  cables.solve(0, 0);
  for (const Cables::Span& each : cables.spans()) CHECK(each.tension == 0);
  cables.slip();
  for (const Cables::Span& each : cables.spans()) CHECK(each.length >= 0.01 * (1 - 1e-15));
  CHECK(natural_length(cables) == near(0.021, 1e-14));
}

TEST_CASE("a loop with friction that is drawn in at one span has admissible tensions at each point") {
  constexpr double mu = 0.3;
  Cables cables;
  const Vec3d corners[] = {{0, 0, 0}, {0.003, 0, -0.006}, {0.011, 0.001, -0.005}, {0.012, 0, 0}};
  for (const Vec3d& x : corners) cables.points()[std::size_t(cables.add_point())].x = x;
  std::vector<Cables::Span> spans;
  for (int i = 0; i < 4; ++i)
    spans.push_back(span(i, (i + 1) % 4, (corners[(i + 1) % 4] - corners[i]).norm(), mu));
  cables.add_chain(spans, true);
  cables.couple(no_mobility);
  for (int step = 0; step < 200; ++step) {
    cables.spans()[3].length -= 1e-5;
    cables.solve(0, 0);
    for (std::size_t i = 0; i < 4; ++i) {
      const Cables::Span &a = cables.spans()[i], &b = cables.spans()[(i + 1) % 4];
      const double ratio = std::exp(mu * std::atan2(a.along.cross(b.along).norm(), a.along.dot(b.along)));
      REQUIRE(a.tension > 0);
      CHECK(b.tension <= a.tension * ratio * (1 + 1e-11));
      CHECK(a.tension <= b.tension * ratio * (1 + 1e-11));
    }
    const double before = natural_length(cables);
    cables.slip();
    CHECK(natural_length(cables) == near(before, 1e-14));
  }
  const auto& found = cables.spans();
  CHECK(found[3].tension > 1.2 * std::min(found[0].tension, std::min(found[1].tension, found[2].tension)));
}

TEST_CASE("the tension of an implicit step is that of its end, however stiff the cable is") {
  // A mass m on a cable that hangs from a point: T = k (S + dt v - l)/(1 + dt^2 k/m)
  constexpr double m = 1e-4, dt = 1e-3, v = -0.3;
  for (const double stiffness : {1.0, 1e4}) {
    Cables cables;
    cables.add_point();
    cables.add_point();
    cables.points()[1].x = {0, 0, -0.0101};
    cables.points()[1].v = {0, 0, v};
    cables.add_chain({span(0, 1, 0.01, 0, stiffness)}, false);
    cables.couple([](Index a, Index b) -> Vec3d { return Vec3d::Constant(a == 1 && b == 1 ? 1 / m : 0); });
    cables.solve(dt, dt);
    const double k = stiffness / 0.01, tension = cables.spans()[0].tension;
    CHECK(tension == near(k * (1e-4 - dt * v) / (1 + dt * dt * k / m), 1e-12));
    const double after = 0.0101 + dt * (-v - dt * tension / m);
    CHECK(std::abs(k * (after - 0.01) - tension) < 1e-9 * stiffness);
    CHECK(cables.points()[1].force.z() == near(tension, 1e-15));
  }
}

TEST_CASE("cables on one mass are solved together") {
  // Three cables hold one mass from three sides; each alone would take all of its motion.
  constexpr double m = 1e-4, dt = 1e-3, EA = 1e3;
  Cables cables;
  cables.points()[std::size_t(cables.add_point())].v = {0, 0, -0.1};
  const Vec3d ends[] = {{0.01, 0, 0.01}, {-0.01, 0.004, 0.01}, {0, -0.01, 0.012}};
  for (int i = 0; i < 3; ++i) {
    cables.points()[std::size_t(cables.add_point())].x = ends[i];
    cables.add_chain({span(0, i + 1, ends[i].norm(), 0, EA)}, false);
  }
  cables.couple([](Index a, Index b) -> Vec3d { return Vec3d::Constant(a == 0 && b == 0 ? 1 / m : 0); });
  cables.solve(dt, dt);
  const Vec3d v = Vec3d(0, 0, -0.1) + dt / m * cables.points()[0].force;
  for (const Cables::Span& each : cables.spans()) {
    const double longer = -dt * each.along.dot(v);  // to first order
    CHECK(each.tension == near(std::max(0.0, longer) / each.compliance(each.length), 1e-9));
  }
}

TEST_CASE("tensions of cables that share points are those of projected sweeps") {
  Cables cables;
  for (int i = 0; i < 6; ++i)
    cables.points()[std::size_t(cables.add_point())].x = {0.01 * (i % 3), 0.007 * (i / 3), 0.003 * (i % 2)};
  for (const auto& each : {span(0, 1, 0.01), span(1, 2, 0.01), span(2, 0, 0.018), span(3, 4, 0.01),
                           span(4, 5, 0.01), span(5, 3, 0.019), span(1, 4, 0.008)})
    cables.add_chain({each}, false);
  const auto mobility = [](Index a, Index b) { return a == b ? 3e4 : a % 3 == b % 3 ? 1e4 : 0; };
  cables.couple([&](Index a, Index b) -> Vec3d { return Vec3d::Constant(mobility(a, b)); });
  constexpr double dt = 1e-3;
  int taut = 0, slack = 0;
  for (int step = 0; step < 100; ++step) {
    for (int i = 0; i < 6; ++i) {
      auto& point = cables.points()[std::size_t(i)];
      point.v = 3 * Vec3d(std::sin(0.1 * step + i), std::cos(0.07 * step + 2 * i), std::sin(0.05 * step));
      point.x += dt * point.v;
    }
    cables.solve(dt, dt);
    const auto& spans = cables.spans();
    const auto count = Eigen::Index(spans.size());
    Eigen::MatrixXd A(count, count);
    Eigen::VectorXd b(count), T = Eigen::VectorXd::Zero(count);
    for (Eigen::Index s = 0; s < count; ++s) {
      const Cables::Span& own = spans[std::size_t(s)];
      b[s] =
          own.stretched - own.length +
          dt * own.along.dot(cables.points()[std::size_t(own.q)].v - cables.points()[std::size_t(own.p)].v);
      for (Eigen::Index r = 0; r < count; ++r) {
        const Cables::Span& other = spans[std::size_t(r)];
        const double sum = mobility(own.q, other.q) - mobility(own.q, other.p) - mobility(own.p, other.q) +
                           mobility(own.p, other.p);
        A(s, r) = dt * dt * sum * own.along.dot(other.along) + (s == r ? own.compliance(own.length) : 0);
      }
    }
    for (int sweep = 0; sweep < 5000; ++sweep)
      for (Eigen::Index s = 0; s < count; ++s)
        T[s] = std::max(0.0, T[s] + (b[s] - A.row(s).dot(T)) / A(s, s));
    const double largest = T.maxCoeff();
    for (Eigen::Index s = 0; s < count; ++s) {
      CHECK(std::abs(spans[std::size_t(s)].tension - T[s]) <= 1e-10 * largest);
      (T[s] > 0 ? taut : slack) += 1;
    }
  }
  CHECK(taut > 100);
  CHECK(slack > 100);
}

TEST_CASE("a point gives way until its tissue holds the force, and takes the work of that") {
  Cables cables;
  for (const double x : {0.0, 0.01, 0.02}) {
    Cables::Point& point = cables.points()[std::size_t(
        cables.add_point(x == 0.01 ? 0.01 : std::numeric_limits<double>::infinity()))];
    point.x = {x, x == 0.01 ? 0.004 : 0, 0};
  }
  const double length = std::hypot(0.01, 0.004);
  cables.add_chain({span(0, 1, length * 0.97), span(1, 2, length * 0.97)}, false);
  cables.couple(no_mobility);
  cables.solve(0, 0);
  const Cables::Point& point = cables.points()[1];
  CHECK(point.force.norm() == near(0.01, 1e-8));
  CHECK(point.way > 0);
  CHECK(point.along.y() == near(-1.0, 1e-12));
  CHECK(cables.slip().cut == near(0.01 * point.way, 1e-8));
  for (const Cables::Span& each : cables.spans())
    CHECK(2 * each.tension * 0.004 / length == near(0.01, 1e-8));
}
