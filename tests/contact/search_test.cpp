// Self contact against a search by force, and the bounds that spare it most of its looks.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "lobe/contact/contact.h"
#include "lobe/cut/distance.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A bar that is bent to a ring, but for a gap of 20 degrees.
TetMesh open_ring() {
  constexpr double length = 0.14, radius = 0.02;
  TetMesh mesh = box_mesh({length, 0.008, 0.01}, 24, 2, 2);
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3d x = mesh.points.col(v);
    const double angle = x[0] / length * 340 / 180 * EIGEN_PI, r = radius + x[1];
    mesh.points.col(v) = Vec3d(r * std::cos(angle), -r * std::sin(angle), x[2]);
  }
  return mesh;
}

// The energy of a body on itself as self_contact.h defines it, by all points in all tetrahedra. A
// point that is in several, where the body is folded onto itself, counts for one of them.
class ByForce {
 public:
  ByForce(World<double>& world, const ContactSurface& surface)
      : world_(world), surface_(surface), X_(world.elements().points.view()) {
    around_.resize(std::size_t(X_.cols()));
    for (std::size_t t = 0; t < surface.triangles().size(); ++t)
      for (Index v : corners(t)) around_[std::size_t(v)].insert(t);
    for (std::size_t t = 0; t < surface.triangles().size(); ++t) {
      std::set<Index> near;
      for (Index v : corners(t))
        for (std::size_t other : around_[std::size_t(v)])
          for (Index w : corners(other)) near.insert(w);
      own_.push_back(near);
    }
  }

  struct Range {
    double least = 0, most = 0;  // [J]
  };
  Range energy() {
    x_ = X_ + world_.displacements();
    Range sum;
    for (std::size_t t = 0; t < surface_.triangles().size(); ++t) {
      const Mat3<double> x = x_(Eigen::all, corners(t));
      visit_centroids(3, [&](int, const Vec3d& weights) {
        const Range found = energy_of(t, x * weights);
        sum.least += found.least;
        sum.most += found.most;
      });
    }
    return sum;
  }

 private:
  Eigen::Vector3i corners(std::size_t t) const {
    Eigen::Vector3i found;
    for (int c = 0; c < 3; ++c)
      found[c] = surface_.points()[std::size_t(surface_.triangles()[t].points[c])].corners[0];
    return found;
  }
  Mat3<double> rest(std::size_t t) const { return X_(Eigen::all, corners(t)); }
  static Vec3d normal(const Mat3<double>& x) {
    return (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)).normalized();
  }
  bool may_touch(std::size_t t, const Eigen::Vector4i& tet) const {
    bool is_of_boundary = false, is_own = false;
    for (Index v : tet) {
      is_of_boundary = is_of_boundary || !around_[std::size_t(v)].empty();
      is_own = is_own || own_[t].contains(v);
    }
    if (!is_of_boundary || !is_own) return is_of_boundary;
    const Mat34<double> X = X_(Eigen::all, tet);
    return normal(rest(t)).dot(X.rowwise().mean() - rest(t).col(0)) >= 0.05 * (X.col(1) - X.col(0)).norm();
  }
  Range energy_of(std::size_t t, const Vec3d& x) const {
    Range found;
    bool is_any = false;
    const Topology& topology = world_.elements().topology;
    for (Index l = 0; l < topology.tet_count(); ++l) {
      const Eigen::Vector4i tet = topology.corners(l);
      const Mat34<double> y = x_(Eigen::all, tet);
      if ((x.array() < y.rowwise().minCoeff().array()).any()) continue;
      if ((x.array() > y.rowwise().maxCoeff().array()).any()) continue;
      Mat3<double> edges = y.rightCols<3>().colwise() - y.col(0);
      if (edges.determinant() <= 0) continue;
      Eigen::Vector4d b;
      b.tail<3>() = edges.inverse() * (x - y.col(0));
      b[0] = 1 - b.tail<3>().sum();
      if (b.minCoeff() < 0 || !may_touch(t, tet)) continue;
      const Range energy = energy_behind(t, x, tet, b);
      found.least = is_any ? std::min(found.least, energy.least) : energy.least;
      found.most = std::max(found.most, energy.most);
      is_any = true;
    }
    return found;
  }
  // Where the nearest point at rest is on an edge, either of its faces is the nearest.
  Range energy_behind(std::size_t t, const Vec3d& x, const Eigen::Vector4i& tet,
                      const Eigen::Vector4d& b) const {
    const Vec3d X = X_(Eigen::all, tet) * b;
    std::map<std::size_t, double> distances;
    double least = std::numeric_limits<double>::infinity();
    for (Index v : tet)
      for (std::size_t f : around_[std::size_t(v)]) {
        const Mat3<double> Y = rest(f);
        if (normal(Y).dot(X - Y.col(0)) > 1e-12) continue;
        distances[f] = (X - nearest_on_triangle(X, Y.col(0), Y.col(1), Y.col(2))).norm();
        least = std::min(least, distances[f]);
      }
    Range found{std::numeric_limits<double>::infinity(), 0};
    for (const auto& [face, distance] : distances) {
      if (distance > least + 1e-12) continue;
      const double energy = energy_at(t, x, face);
      found = {std::min(found.least, energy), std::max(found.most, energy)};
    }
    return distances.empty() ? Range() : found;
  }
  double energy_at(std::size_t t, const Vec3d& x, std::size_t face) const {
    const Mat3<double> y = x_(Eigen::all, corners(face));
    const double depth = -normal(y).dot(x - y.col(0)), deepest = deepest_contact * surface_.mean_edge();
    if (depth <= 0) return 0;
    const double a = surface_.self_stiffness(static_cast<int>(t)),
                 c = surface_.self_stiffness(static_cast<int>(face)), linear = std::min(depth, deepest);
    return surface_.triangles()[t].area / 9 * a * c / (a + c) / 2 * linear * (depth - linear / 2);
  }

  World<double>& world_;
  const ContactSurface& surface_;
  Mat3X<double> X_, x_;  // then, now [m]
  std::vector<std::set<std::size_t>> around_;
  std::vector<std::set<Index>> own_;
};

}  // namespace

TEST_CASE("whatever a fast body does, it finds all of itself that it touches") {
  Setup setup = setup_of(open_ring());
  setup.contact.self = true;
  setup.contact.friction = 0;
  World<double> world(setup);
  const double dt = 0.8 * world.time_step_limit();
  REQUIRE(world.step(dt));
  State<double> state = world.state();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {  // flies, spins, and closes the ring
    const Vec3d x = setup.mesh.points.col(v);
    const double angle = std::atan2(-x[1], x[0]);
    const Vec3d along = Vec3d(-x[1], x[0], 0).normalized();
    state.v.col(v) =
        Vec3d(2, 1, 0.5) + Vec3d(0, 0, 40).cross(x) - 2 * std::cos(angle / 2) * along * (angle > 0 ? -1 : 1);
  }
  world.set_state(state);
  const auto& contact = dynamic_cast<const Contact<double>&>(*world.body().terms.front());
  ByForce by_force(world, contact.surface());
  int touches = 0, sure = 0, partings = 0;
  bool did_touch = false;
  double worst = 0, most = 0;
  for (int i = 0; i < 600; ++i) {
    REQUIRE(world.step(dt));
    const double found = contact.energy(world.body().here());
    const ByForce::Range expected = by_force.energy();
    most = std::max(most, expected.most);
    worst = std::max({worst, expected.least - found, found - expected.most});
    const bool does_touch = expected.most > 0;
    touches += does_touch ? 1 : 0;
    sure += does_touch && expected.least == expected.most ? 1 : 0;
    partings += !does_touch && did_touch ? 1 : 0;
    did_touch = does_touch;
  }
  MESSAGE("it touches itself in " << touches << " of 600 steps, in " << sure << " of them for sure; parts "
                                  << partings << " times; energy up to " << most << " J");
  CHECK(sure > 50);
  CHECK(partings > 0);
  CHECK(worst <= 1e-9 * most);
}

TEST_CASE("parts of a body are no nearer than their bound, and a turn of all brings none nearer") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Mat3X<double> X(3, 60);
  for (double& x : X.reshaped()) x = 0.01 * uniform(random);
  X.rightCols(30).row(0).array() += 0.03;
  std::vector<std::vector<int>> points(2);
  for (int i = 0; i < 60; ++i) points[std::size_t(i / 30)].push_back(i);
  PartMotion parts;
  parts.set_parts(points);
  const auto holds = [&](const Mat3X<double>& x) {
    parts.measure(x);
    const PartMotion::Bound between = parts.bound(0, 1), within = parts.bound(0, 0);
    for (int i = 0; i < 30; ++i)
      for (int j = 0; j < 60; ++j) {
        const double then = (X.col(i) - X.col(j)).norm(), now = (x.col(i) - x.col(j)).norm();
        if (now < (j < 30 ? within : between).now(then)) return false;
      }
    std::vector<float> squares;
    parts.find_box_distances(0, squares);
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 30; ++i)
      for (int j = 30; j < 60; ++j) least = std::min(least, (x.col(i) - x.col(j)).squaredNorm());
    return double(squares[1]) <= least;
  };
  parts.remember(X);
  CHECK(holds(X));
  const Mat3<double> turn = Eigen::AngleAxisd(2, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
  const Mat3X<double> turned = (turn * X).colwise() + Vec3d(5, 3, 1);
  CHECK(holds(turned));
  CHECK(parts.bound(0, 1).now(0.01) > 0.0099);
  for (int k = 0; k < 200; ++k) {
    const double strain = 0.3 * uniform(random), bend = 10 * uniform(random), noise = 1e-3 * uniform(random);
    Mat3X<double> x = turned;
    for (int i = 0; i < 60; ++i) {
      const Vec3d p = X.col(i);
      x.col(i) += turn * Vec3d(strain * p[0] + bend * p[1] * p[1], bend * p[0] * p[0], strain * p[1]);
      for (double& s : x.col(i)) s += noise * uniform(random);
    }
    CHECK(holds(x));
  }
  parts.remember(turned);  // one part comes to where the other is
  Mat3X<double> met = turned;
  met.rightCols(30).colwise() -= turn * Vec3d(0.03, 0, 0);
  CHECK(holds(met));
  CHECK(parts.bound(0, 1).now(0.02) < 0);
}
