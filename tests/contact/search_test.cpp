// Self contact against a search by force, and the bounds that spare it most of its looks.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "lobe/contact/contact.h"
#include "lobe/contact/convex_gap.h"
#include "lobe/contact/gap_kernels.h"
#include "lobe/contact/pair_search.h"
#include "lobe/contact/part_motion.h"
#include "lobe/contact/quadrature.h"
#include "lobe/cut/distance.h"
#include "lobe/mesh/joined_mesh.h"
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

// Places between −1 and 1, four numbers each, and pairs of a triangle and a tetrahedron of such corners.
template <class Number>
struct RandomPairs {
  RandomPairs(unsigned seed, int places, std::size_t block_count)
      : x(std::size_t(4 * places)), blocks(block_count) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<Number> uniform(-1, 1);
    for (Number& number : x) number = uniform(random);
    for (PairBlock& block : blocks)
      for (std::size_t lane = 0; lane < PairBlock::width; ++lane)
        for (auto& of_corner : block.places) of_corner[lane] = int(random() % unsigned(places));
  }
  Mat3<double> triangle(const PairBlock& block, std::size_t lane) const { return corners<3>(block, lane, 0); }
  Mat34<double> tet(const PairBlock& block, std::size_t lane) const { return corners<4>(block, lane, 3); }

  std::vector<Number> x;
  std::vector<PairBlock> blocks;

 private:
  template <int count>
  Eigen::Matrix<double, 3, count> corners(const PairBlock& block, std::size_t lane, std::size_t first) const {
    Eigen::Matrix<double, 3, count> found;
    for (std::size_t c = 0; c < count; ++c)
      found.col(Eigen::Index(c)) =
          Eigen::Map<const Vec3<Number>>(&x[4 * std::size_t(block.places[first + c][lane])])
              .template cast<double>();
    return found;
  }
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
  auto& contact = dynamic_cast<Contact<double>&>(*world.body().terms.front());
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

namespace {

// Two blocks above each other, the lower of which has a slit in its middle, along z.
TetMesh slit_block_and_piece() {
  TetMesh mesh = box_mesh({0.04, 0.02, 0.03}, 4, 2, 3);
  std::map<Index, Index> copy_of;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (std::abs(mesh.points(0, v) - 0.02) < 1e-9 && mesh.points(2, v) > 0.005)
      copy_of.emplace(v, mesh.vertex_count() + static_cast<Index>(copy_of.size()));
  for (Index t = 0; t < mesh.tet_count(); ++t)
    if (barycentre(mesh, t).x() > 0.02)
      for (Index& v : mesh.tets.col(t))
        if (const auto found = copy_of.find(v); found != copy_of.end()) v = found->second;
  const TetMesh piece = box_mesh({0.02, 0.02, 0.01}, 2, 2, 1);
  const auto before = static_cast<Index>(mesh.points.cols());
  const auto with_copies = before + static_cast<Index>(copy_of.size());
  mesh.points.conservativeResize(3, with_copies + piece.vertex_count());
  for (const auto& [v, copy] : copy_of) mesh.points.col(copy) = mesh.points.col(v);
  mesh.points.rightCols(piece.vertex_count()) = piece.points.colwise() + Vec3d(0.01, 0, 0.031);
  const Index tets = mesh.tet_count();
  mesh.tets.conservativeResize(4, tets + piece.tet_count());
  mesh.tets.rightCols(piece.tet_count()) = piece.tets.array() + with_copies;
  mesh.labels.insert(mesh.labels.end(), piece.labels.begin(), piece.labels.end());
  return mesh;
}

}  // namespace

TEST_CASE("in any motion of a slit and of a piece that falls, what touches is found") {
  Setup setup = setup_of(slit_block_and_piece());
  setup.contact.self = true;
  setup.contact.friction = 0;
  World<double> world(setup);
  const double dt = 0.8 * world.time_step_limit();
  REQUIRE(world.step(dt));
  const State<double> first = world.state();
  auto& contact = dynamic_cast<Contact<double>&>(*world.body().terms.front());
  ByForce by_force(world, contact.surface());
  std::mt19937 random(31);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Mat3X<double>& X = setup.mesh.points;
  int touches = 0, sure = 0;
  double worst = 0, most = 0;
  for (int throws = 0; throws < 12; ++throws) {
    State<double> state = first;  // flies, turns, is strained and bent; the piece falls, the slit shuts
    const Vec3d flies = Vec3d(uniform(random), uniform(random), uniform(random));
    Mat3<double> strains;
    for (double& rate : strains.reshaped()) rate = 25 * uniform(random);
    const double bends = 600 * uniform(random), shuts = 0.3 * (1 + uniform(random));
    for (Index v = 0; v < X.cols(); ++v) {
      const Vec3d x = X.col(v) - Vec3d(0.02, 0.01, 0.02);
      state.v.col(v) = flies + strains * x + Vec3d(0, 0, bends * x[0] * x[0]);
      state.v(0, v) += x[0] > 0 ? -shuts : shuts;
      if (X(2, v) > 0.0305) state.v(2, v) -= 0.6;
      for (double& speed : state.v.col(v)) speed += 0.02 * uniform(random);
    }
    world.set_state(state);
    for (int i = 0; i < 40 && world.step(dt); ++i) {
      const double found = contact.energy(world.body().here());
      const ByForce::Range expected = by_force.energy();
      most = std::max(most, expected.most);
      worst = std::max({worst, expected.least - found, found - expected.most});
      touches += expected.most > 0 ? 1 : 0;
      sure += expected.most > 0 && expected.least == expected.most ? 1 : 0;
    }
  }
  MESSAGE("it touches in " << touches << " of 480 steps, in " << sure << " of them for sure; energy up to "
                           << most << " J");
  CHECK(sure > 20);
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
  const auto about_one = [](const Mat3X<double>& x) {
    std::vector<float> places(4 * std::size_t(x.cols()));
    for (int i = 0; i < x.cols(); ++i)
      for (int d = 0; d < 3; ++d) places[std::size_t(4 * i + d)] = float(x(d, i) - x(d, 0));
    return places;
  };
  const auto holds = [&](const Mat3X<double>& x) {
    parts.measure(about_one(x).data());
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
  parts.remember(about_one(X).data());
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
  parts.remember(about_one(turned).data());  // one part comes to where the other is
  Mat3X<double> met = turned;
  met.rightCols(30).colwise() -= turn * Vec3d(0.03, 0, 0);
  CHECK(holds(met));
  CHECK(parts.bound(0, 1).now(0.02) < 0);
}

namespace {

constexpr int samples = 60;

double sampled_distance(const Mat34<double>& tet, const Mat3<double>& triangle) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= samples; ++i)
    for (int j = 0; i + j <= samples; ++j)
      least = std::min(least, distance_to_tet(triangle * Vec3d(i, j, samples - i - j) / samples, tet));
  return least;
}

}  // namespace

TEST_CASE("the way from a tetrahedron to a triangle that it does not meet is the shortest") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  int apart = 0;
  for (int k = 0; k < 60; ++k) {
    Mat34<double> tet;
    Mat3<double> triangle;
    for (double& x : tet.reshaped()) x = uniform(random);
    for (double& x : triangle.reshaped()) x = uniform(random);
    triangle.row(k % 3).array() += 0.2 * (k % 5);
    const double found = shortest_way(tet, triangle).norm(), sampled = sampled_distance(tet, triangle);
    if (sampled < 2.0 / samples) continue;
    ++apart;
    CHECK(found <= sampled + 1e-12);
    CHECK(found >= sampled - 2.0 / samples);
  }
  CHECK(apart > 15);
}

TEST_CASE("every instruction set finds the same gaps and ranges") {
  RandomPairs<float> pairs(8, 50, 2);
  const std::vector<float>& x = pairs.x;
  std::vector<PairBlock>& blocks = pairs.blocks;
  for (PairBlock& block : blocks)
    for (std::size_t l = 0; l < PairBlock::width; ++l) {
      const Mat34<double> tet = pairs.tet(block, l);
      const Vec3d a = (tet.rightCols<3>().colwise() - tet.col(0)).transpose() *
                      shortest_way(tet, pairs.triangle(block, l));
      for (int d = 0; d < 3; ++d) block.normal[std::size_t(d)][l] = float(a[d]);
    }
  std::vector<PairBlock> of_baseline = blocks;
  gap_kernels(InstructionSet::baseline).find_gaps(x.data(), 1, of_baseline.data(), 2);
  int apart = 0;
  for (const PairBlock& block : of_baseline)
    for (std::size_t l = 0; l < PairBlock::width; ++l) {
      const Mat34<double> tet = pairs.tet(block, l);
      const Mat3<double> triangle = pairs.triangle(block, l);
      const Mat3<double> edges = tet.rightCols<3>().colwise() - tet.col(0);
      if (!(edges.determinant() > 0.01) || sampled_distance(tet, triangle) < 0.05) continue;
      ++apart;
      CHECK(block.gap[l] == near(shortest_way(tet, triangle).norm(), 1e-4));
    }
  CHECK(apart > 3);
  for (InstructionSet set : available_instruction_sets()) {
    std::vector<PairBlock> own = blocks;
    gap_kernels(set).find_gaps(x.data(), 1, own.data(), 2);
    for (std::size_t b = 0; b < own.size(); ++b)
      CHECK(std::memcmp(own[b].gap.data(), of_baseline[b].gap.data(), sizeof own[b].gap) == 0);
    for (int vertices : {0, 1, 5, 16, 37, 60})
      for (std::size_t first : {0, 1, 3}) {  // wherever the arrays begin
        const float *u = &x[first], *from = &x[first + 11];
        const Eigen::Map<const Mat3X<float>> there(u, 3, vertices), here(from, 3, vertices);
        const std::vector<double> wide(x.begin(), x.end());
        double expected = 0;
        if (vertices > 0) {
          const Mat3X<double> moved = (there - here).cast<double>();
          expected = (moved.rowwise().maxCoeff() - moved.rowwise().minCoeff()).norm();
        }
        CHECK(gap_kernels(set).float_range(u, from, vertices) == near(expected, 1e-6, 1));
        CHECK(gap_kernels(set).double_range(&wide[first], &wide[first + 11], vertices) ==
              near(expected, 1e-6, 1));
      }
  }
}

TEST_CASE("every instruction set finds the same points of triangles in tetrahedra") {
  const RandomPairs<double> pairs(9, 60, 20);
  const std::vector<double>& x = pairs.x;
  const std::vector<PairBlock>& blocks = pairs.blocks;
  std::vector<Vec3d> points;
  visit_centroids(3, [&](int, const Vec3d& weights) { points.push_back(weights); });
  const auto found_by = [&](InstructionSet set) {
    std::vector<InsideBlock> found(blocks.size());
    gap_kernels(set).find_insides(x.data(), points.front().data(), int(points.size()), 0, blocks.data(),
                                  found.data(), int(blocks.size()));
    return found;
  };
  const std::vector<InsideBlock> found = found_by(InstructionSet::baseline);
  int inside = 0, inverted = 0;
  std::vector<std::vector<InsideBlock>> of_sets;
  for (InstructionSet set : available_instruction_sets()) of_sets.push_back(found_by(set));
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (std::size_t lane = 0; lane < PairBlock::width; ++lane) {
      const Mat34<double> tet = pairs.tet(blocks[b], lane);
      const Mat3<double> edges = tet.rightCols<3>().colwise() - tet.col(0),
                         corners = pairs.triangle(blocks[b], lane).colwise() - tet.col(0);
      const int bits = int(found[b].points[lane]);
      if (edges.determinant() < -0.01) {
        CHECK(bits == -1);
        ++inverted;
      }
      if (edges.determinant() < 0.01) continue;
      const Mat3<double> weights = edges.inverse() * corners;
      for (int c = 0; c < 3; ++c)
        for (int k = 0; k < 3; ++k)
          CHECK(found[b].weights[std::size_t(c)][std::size_t(k)][lane] == near(weights(k, c), 1e-9, 1));
      for (const auto& own : of_sets) {
        CHECK(own[b].points[lane] == found[b].points[lane]);
        for (std::size_t c = 0; c < 3; ++c)
          for (std::size_t k = 0; k < 3; ++k)
            CHECK(own[b].weights[c][k][lane] == found[b].weights[c][k][lane]);
      }
      for (std::size_t p = 0; p < points.size(); ++p) {
        const Vec3d own = weights * points[p];
        const double lowest = std::min(own.minCoeff(), 1 - own.sum());
        if (std::abs(lowest) < 1e-9) continue;
        CHECK((bits >> p & 1) == (lowest > 0 ? 1 : 0));
        inside += lowest > 0 ? 1 : 0;
      }
    }
  CHECK(inside > 10);
  CHECK(inverted > 10);
}

TEST_CASE("a search finds the pair of a point that is held, however far apart the two are") {
  Setup setup = setup_of(slit_block_and_piece());
  setup.contact.self = true;
  World<double> world(setup);
  REQUIRE(world.step(0.8 * world.time_step_limit()));
  auto& contact = dynamic_cast<Contact<double>&>(*world.body().terms.front());
  SelfRest rest;
  rest.rebuild(contact.surface(), world.elements());
  PairSearch search(rest);
  ContactMemory memory;
  const auto pairs = [&] {
    search.rebuild();
    search.place_at_rest();
    search.search(contact.surface(), memory);
    std::set<std::pair<int, Index>> found;  // triangle, tetrahedron
    for (const PairSearch::Pair& pair : search.pairs())
      found.insert({search.candidates()[std::size_t(pair.candidate)].triangle, pair.tet});
    return found;
  };
  const std::set<std::pair<int, Index>> near = pairs();
  const int triangle = 0;
  const Index farthest = setup.mesh.tet_count() - 1, inside = -1;  // of the piece; none
  REQUIRE_FALSE(near.contains({triangle, farthest}));
  const FaceOwner& owner = contact.surface().triangles()[std::size_t(triangle)].owner;
  Anchor anchor;
  anchor.tet = owner.tet;
  anchor.code = owner.code;
  anchor.in = farthest;
  Anchor gone = anchor;
  gone.in = inside;
  memory.set({{gone, anchor}, {}});
  std::set<std::pair<int, Index>> expected = near;
  expected.insert({triangle, farthest});
  CHECK(pairs() == expected);
}

namespace {

// A coarse block, and two bars of fine cells that lie on it.
Setup block_and_fine_bars() {
  Setup setup = setup_of(box_mesh({0.06, 0.04, 0.02}, 6, 4, 2));
  const TetMesh block = setup.mesh;
  setup.mesh = {};
  append_body(block, "block", setup.mesh);
  TetMesh bar = box_mesh({0.04, 0.003, 0.003}, 14, 1, 1);
  bar.points.colwise() += Vec3d(0.01, 0.01, 0.0203);
  TetMesh other = bar;
  other.points.row(1).array() += 0.02;
  append_body(other, "bar that stays", setup.mesh);
  append_body(bar, "bar", setup.mesh);
  setup.material_of.assign(std::size_t(setup.mesh.tet_count()), 0);
  setup.region_of.assign(std::size_t(setup.mesh.tet_count()), RegionModel::nonlinear);
  setup.contact.self = true;
  return setup;
}

// The distance of the nearest pair that may touch but is not listed [m].
double least_unlisted(const PairSearch& search, const SelfRest& rest, const ContactSurface& surface,
                      const Places& places) {
  std::set<std::pair<int, int>> listed;  // triangle, layer
  for (const PairSearch::Pair& pair : search.pairs())
    listed.insert({search.candidates()[std::size_t(pair.candidate)].triangle, pair.layer});
  double least = std::numeric_limits<double>::infinity();
  for (int t = 0; t < static_cast<int>(surface.triangles().size()); ++t) {
    const ContactSurface::Triangle& triangle = surface.triangles()[std::size_t(t)];
    Mat3<double> x;
    for (int c = 0; c < 3; ++c) x.col(c) = places.of_point(triangle.points[c]);
    const auto own = rest.boundary.own_of(t);
    const std::set<int> never(own.begin(), own.end());
    for (int l = 0; l < static_cast<int>(rest.boundary.tets().size()); ++l) {
      if (never.contains(l) || listed.contains({t, l}) ||
          rest.divisions(triangle.body, rest.body_of[std::size_t(l)]) == 0)
        continue;
      Mat34<double> tet;
      for (int c = 0; c < 4; ++c) tet.col(c) = places.of_vertex(rest.layer(l).corners[c]);
      const Vec3d apart = (tet.rowwise().minCoeff() - x.rowwise().maxCoeff())
                              .cwiseMax(x.rowwise().minCoeff() - tet.rowwise().maxCoeff());
      if (apart.maxCoeff() >= least) continue;
      least = std::min(least, shortest_way(tet, outermost(x)).norm());
    }
  }
  return least;
}

}  // namespace

TEST_CASE(
    "pairs that are not listed are no nearer than a search says, whatever it has kept of the last one") {
  const Setup setup = block_and_fine_bars();
  World<double> world(setup);
  REQUIRE(world.step(0.8 * world.time_step_limit()));
  auto& contact = dynamic_cast<Contact<double>&>(*world.body().terms.front());
  const ContactSurface& surface = contact.surface();
  SelfRest rest;
  rest.rebuild(surface, world.elements());
  CHECK(rest.reach(1, 1) < 0.5 * rest.reach(0, 0));
  PairSearch search(rest);
  search.rebuild();
  const Mat3X<double>& X = setup.mesh.points;
  Mat3X<double> u = Mat3X<double>::Zero(3, X.cols());
  const Mat3X<double> v = u;
  const Places places(surface, world.body().model, u, v);
  Stations stations;
  const double edge = rest.least_reach();
  int kept = 0, searches = 0;
  const Index first_of_bar = X.cols() - mesh_of_body(setup.mesh, 2).vertex_count();
  for (int k = 0; k < 30; ++k) {
    for (Index i = 0; i < X.cols(); ++i) {  // a bar goes round and bends; all else is strained
      const double x = X(0, i), angle = 0.2 * k;
      u.col(i) = i < first_of_bar
                     ? Vec3d(0, 0, 0.002 * k * x)
                     : Vec3d(0.012 * std::sin(angle), 0.012 * (1 - std::cos(angle)) + 0.2 * k * x * x, 0);
    }
    stations.set(Stations::measured, places, 0);
    search.place(stations, places);
    const double room = search.is_searched() ? search.room_for_others(0.5 * edge) : -1;
    if (search.is_searched()) CHECK(least_unlisted(search, rest, surface, places) >= rest.near + room);
    if (room >= 0.15 * edge) continue;
    search.widen();
    search.search(surface, {});
    ++searches;
    kept += int(std::count_if(search.before().begin(), search.before().end(), [](int i) { return i >= 0; }));
    CHECK(least_unlisted(search, rest, surface, places) >= search.within());
  }
  MESSAGE(searches << " searches kept " << kept << " pairs");
  CHECK(searches > 3);
  CHECK(kept > 100);
}
