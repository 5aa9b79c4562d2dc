#include "lobe/body/integrator.h"

#include <doctest/doctest.h>

#include <cmath>

#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Parallel one_thread;

// A damped oscillator of mass 1 and stiffness ω², released at 1. Returns u at time 1.
double oscillator(double omega, double damping, int steps) {
  Mat3X<double> u = Mat3X<double>::Zero(3, 1), v = u, f = u;
  const double dt = 1.0 / steps;
  u(0) = 1;
  v(0) = omega * omega * dt / 2;  // v at −Δt/2 of an oscillator that starts at rest
  v(0) *= 1 + damping * dt / 2;
  Reversals reversals(1);
  for (int i = 0; i < steps; ++i) {
    f(0) = -omega * omega * u(0);
    central_difference(f, {{0, 1.0}}, dt, dt, damping, u, v, reversals, one_thread);
  }
  return u(0);
}

double exact(double omega, double damping) {
  const double a = damping / 2, w = std::sqrt(omega * omega - a * a);
  return std::exp(-a) * (std::cos(w) + a / w * std::sin(w));
}

}  // namespace

TEST_CASE("central differences converge with order 2, damped or not") {
  for (double damping : {0.0, 3.0}) {
    const double coarse = std::abs(oscillator(10, damping, 200) - exact(10, damping));
    const double fine = std::abs(oscillator(10, damping, 400) - exact(10, damping));
    CHECK(std::log2(coarse / fine) > 1.9);
  }
}

TEST_CASE("erratum 3: the printed damping signs make an oscillator grow, ours make it decay") {
  const double omega = 10, damping = 1, dt = 1e-3;
  const auto largest_late = [&](double sign) {
    // [PDA] section 3.2 for m = 1, R = 0; sign = 1 ours, −1 printed
    double before = 1, now = 1, largest = 0;
    for (int i = 0; i < 10000; ++i) {
      const double next = (-omega * omega * now + 2 / (dt * dt) * now -
                           (1 / (dt * dt) - sign * damping / (2 * dt)) * before) /
                          (1 / (dt * dt) + sign * damping / (2 * dt));
      before = now;
      now = next;
      if (i > 9000) largest = std::max(largest, std::abs(now));
    }
    return largest;
  };
  CHECK(largest_late(1) < 0.02);
  CHECK(largest_late(-1) > 50);
}

TEST_CASE("a vertex without inverse mass stays where it is, and what is not a number is reported") {
  Mat3X<double> u = Mat3X<double>::Zero(3, 2), v = u, f = Mat3X<double>::Ones(3, 2);
  Reversals reversals(2);
  CHECK(central_difference(f, moving_vertices<double>({0, 1}), 0.1, 0.1, 0.0, u, v, reversals, one_thread)
            .all == near(0.03, 1e-12));
  CHECK(u.col(0).norm() == 0);
  f(0, 1) = std::nan("");
  CHECK(std::isinf(
      central_difference(f, moving_vertices<double>({0, 1}), 0.1, 0.1, 0.0, u, v, reversals, one_thread)
          .all));
}

TEST_CASE("two and seven threads move vertices and find the fastest to the bit as one does") {
  const Index count = 20000;
  Mat3X<float> u = Mat3X<float>::Random(3, count), v = Mat3X<float>::Random(3, count);
  const Mat3X<float> f = Mat3X<float>::Random(3, count);
  std::vector<double> inverse_mass(std::size_t(count), 2);
  inverse_mass[5000] = 0;
  const std::vector<MovingVertex<float>> moving = moving_vertices<float>(inverse_mass);
  const Mat3X<float> start_u = u, start_v = v;
  const Reversals start(std::size_t(count), many_reversals - 1);
  Reversals reversals = start;
  const Fastest<float> one = central_difference(f, moving, 0.1F, 0.1F, 3.0F, u, v, reversals, one_thread);
  CHECK(one.reversing > 0);
  for (int threads : {2, 7}) {
    CAPTURE(threads);
    Parallel parallel(threads);
    Mat3X<float> other_u = start_u, other_v = start_v;
    Reversals other_reversals = start;
    const Fastest<float> several =
        central_difference(f, moving, 0.1F, 0.1F, 3.0F, other_u, other_v, other_reversals, parallel);
    CHECK(one.all == several.all);
    CHECK(one.reversing == several.reversing);
    CHECK(u == other_u);
    CHECK(v == other_v);
    CHECK(reversals == other_reversals);
  }
}

TEST_CASE("just beyond the stable step every swing turns back faster, well below it never twice") {
  const auto count_of = [](double omega_dt) {
    Reversals reversals(1);
    Mat3X<double> u = Mat3X<double>::Zero(3, 1), v = u, f = u;
    u(0) = 1;
    int count = 0;  // at a speed that matters
    double highest = 0;
    for (int i = 0; i < 40; ++i) {
      f(0) = -omega_dt * omega_dt * u(0);
      const Fastest<double> fastest =
          central_difference(f, {{0, 1.0}}, 1.0, 1.0, 0.0, u, v, reversals, one_thread);
      highest = std::max(highest, fastest.all);
      count += fastest.reversing > 0.1 * highest;
      if (fastest.reversing > 0) CHECK(fastest.reversing == fastest.all);
    }
    return count;
  };
  CHECK(count_of(2.01) == 38);
  CHECK(count_of(1.8) < 8);
  CHECK(count_of(1.73) == 0);
  CHECK(count_of(0.2) == 0);
}
