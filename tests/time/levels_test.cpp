#include "lobe/time/levels.h"

#include <doctest/doctest.h>

#include <numeric>
#include <random>

#include "lobe/fem/hooke.h"
#include "lobe/numerics/symmetric_eigen.h"
#include "lobe/sim/world.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

std::vector<Level> levels_of_tets(const TetMesh& mesh, const std::vector<Level>& of_vertices) {
  return levels_of_parts(
      mesh.tet_count(), [&](Index t) { return mesh.tets.col(t); }, of_vertices);
}

std::vector<Level> random_levels(Index vertices, double few) {
  std::mt19937 random(5);
  std::bernoulli_distribution is_lower(few);
  std::uniform_int_distribution<int> level(0, highest_level);
  std::vector<Level> levels(std::size_t(vertices), highest_level);
  for (Level& l : levels)
    if (is_lower(random)) l = Level(level(random));
  return levels;
}

bool share_a_vertex(const TetMesh& mesh, Index s, Index t) {
  for (Index v : mesh.tets.col(s))
    for (Index w : mesh.tets.col(t))
      if (v == w) return true;
  return false;
}

// A free bar along x whose last cells are `contrast` times as stiff.
Setup bar_with_stiff_end(double contrast, double nu, int stiff_cells = 1) {
  Setup setup = setup_of(box_mesh({0.06, 0.01, 0.01}, 6, 1, 1));
  std::mt19937 random(7);
  std::uniform_real_distribution<double> jitter(-1e-3, 1e-3);
  for (double& x : setup.mesh.points.reshaped()) x += jitter(random);
  setup.materials.assign(2, seed_material);
  const double E = 5e3 * contrast;
  setup.materials[1].lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
  setup.materials[1].mu = E / (2 * (1 + nu));
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    setup.material_of[std::size_t(t)] = t >= 6 * (6 - stiff_cells) ? 1 : 0;
  setup.materials[0].lambda = 5e3 * 0.35 / (1.35 * 0.3);
  setup.materials[0].mu = 5e3 / 2.7;
  return setup;
}

// M^-½ K M^-½ of these tetrahedra, with the masses of all.
Eigen::MatrixXd scaled_stiffness(const Setup& setup, const std::vector<Level>& levels, Level level) {
  const Elements elements(setup);
  const Index n = setup.mesh.vertex_count();
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    if (levels[std::size_t(t)] != level) continue;
    const Shape s = elements.shape_of(t);
    const Elastic& e = elements.elastic_of(t);
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        const Index a = setup.mesh.tets(i, t), b = setup.mesh.tets(j, t);
        K.block<3, 3>(3 * a, 3 * b) +=
            s.volume / std::sqrt(lumped_mass(elements, a) * lumped_mass(elements, b)) *
            hooke_block<double>(s.gradients.col(i), s.gradients.col(j), e.lambda, e.mu);
      }
  }
  return K;
}

// By how much `rounds` large steps of own steps enlarge the velocities of a start that has all modes.
double growth(const Setup& setup, const std::vector<Level>& levels, double dt, int rounds) {
  std::vector<Eigen::MatrixXd> K;
  const Level top = *std::max_element(levels.begin(), levels.end());
  for (Level l = 0; l <= top; ++l) K.push_back(scaled_stiffness(setup, levels, l));
  const Index n = static_cast<Index>(K[0].rows());
  // One large step as a matrix, squared again and again: 2^rounds large steps.
  Eigen::MatrixXd T = Eigen::MatrixXd::Identity(2 * n, 2 * n);
  for (int i = 0; i < (1 << top); ++i) {
    for (Level l = 0; l <= top; ++l)
      if (i % (1 << l) == 0) T.bottomRows(n) -= dt * (1 << l) * (K[l] * T.topRows(n)).eval();
    T.topRows(n) += dt * T.bottomRows(n).eval();
  }
  for (int i = 0; i < rounds; ++i) T = (T * T).eval();
  return T.bottomRightCorner(n, n).norm() / std::sqrt(double(n));
}

double highest_frequency_of_all(const Setup& setup) {
  const std::vector<Level> all(std::size_t(setup.mesh.tet_count()), 0);
  return std::sqrt(symmetric_eigenvalues(scaled_stiffness(setup, all, 0)).maxCoeff());
}

}  // namespace

TEST_CASE("a vertex of half the highest frequency is of level 1, and one that does not move of the highest") {
  const double w = 300;  // [rad/s]
  const std::vector<double> squares{w * w, w * w / 4, w * w / 3.999, w * w / 16, w * w / 1e9, 0};
  CHECK(levels_of_vertices(squares, w * w) == std::vector<Level>{0, 1, 0, 2, highest_level, highest_level});
}

TEST_CASE("in a bar with one fast end levels rise by one from cell to cell") {
  const TetMesh mesh = box_mesh({9, 1, 1}, 9, 1, 1);
  std::vector<Level> of_vertices(std::size_t(mesh.vertex_count()), highest_level);
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.points(0, v) == 0) of_vertices[std::size_t(v)] = 0;
  const std::vector<Level> levels = levels_of_tets(mesh, of_vertices);
  for (Index t = 0; t < mesh.tet_count(); ++t)
    CHECK(levels[std::size_t(t)] == std::min<int>(t / 6, highest_level));
  CHECK(evaluated_share(levels, {}) == near((1 + 0.5 + 0.25 + 0.125 + 0.0625 + 4 / 32.0) / 9, 1e-15));
}

TEST_CASE("levels are the highest that their vertices and neighbours allow, whatever the numbering") {
  const TetMesh mesh = irregular_box(4);
  for (double few : {0.01, 0.05, 0.5}) {
    const std::vector<Level> of_vertices = random_levels(mesh.vertex_count(), few);
    const std::vector<Level> levels = levels_of_tets(mesh, of_vertices);
    // The distance of tetrahedra to a lower one, in steps from neighbour to neighbour, by brute force.
    std::vector<int> expected(levels.size(), highest_level);
    for (Index t = 0; t < mesh.tet_count(); ++t)
      for (Index v : mesh.tets.col(t))
        expected[std::size_t(t)] = std::min<int>(expected[std::size_t(t)], of_vertices[std::size_t(v)]);
    for (int round = 0; round < highest_level; ++round)
      for (Index s = 0; s < mesh.tet_count(); ++s)
        for (Index t = 0; t < mesh.tet_count(); ++t)
          if (expected[std::size_t(s)] > expected[std::size_t(t)] + 1 && share_a_vertex(mesh, s, t))
            expected[std::size_t(s)] = expected[std::size_t(t)] + 1;
    CHECK(std::equal(levels.begin(), levels.end(), expected.begin()));
    // Backwards, with other numbers of vertices.
    TetMesh other = mesh;
    std::vector<Index> number(std::size_t(mesh.vertex_count()));
    std::iota(number.begin(), number.end(), 0);
    std::shuffle(number.begin(), number.end(), std::mt19937(3));
    std::vector<Level> renumbered(of_vertices.size());
    for (std::size_t v = 0; v < number.size(); ++v) renumbered[std::size_t(number[v])] = of_vertices[v];
    for (Index t = 0; t < mesh.tet_count(); ++t)
      for (int c = 0; c < 4; ++c)
        other.tets(c, t) = number[std::size_t(mesh.tets(3 - c, mesh.tet_count() - 1 - t))];
    std::vector<Level> backwards = levels_of_tets(other, renumbered);
    std::reverse(backwards.begin(), backwards.end());
    CHECK(backwards == levels);
  }
}

TEST_CASE("what is tied steps with the fastest, along a chain of ties too") {
  std::vector<Level> levels{5, 4, 3, 2, 5};
  step_together({{0, 1}, {1, 2}, {2, 3}, {}}, levels);
  CHECK(levels == std::vector<Level>{2, 2, 2, 2, 5});
}

TEST_CASE("the share of evaluations weighs parts with their costs") {
  const std::vector<Level> levels{0, 1, 2};
  CHECK(evaluated_share(levels, std::vector<double>{1, 2, 4}) == near(3.0 / 7, 1e-15));
  CHECK(evaluated_share({}, {}) == 1);
}

TEST_CASE("own steps by the rule do not grow in 2^17 undamped steps at 0.8, bare ones do") {
  bool bare_grew = false;
  for (int i = 0; i < 6; ++i) {
    const Setup setup = bar_with_stiff_end(std::array{9., 20., 33., 50., 120., 300.}[std::size_t(i)],
                                           i % 2 ? 0.45 : 0.2, 1 + i % 2);
    const double omega = highest_frequency_of_all(setup), dt = 0.8 * 2 / omega;
    World<double> world(setup);
    world.time_step_limit();
    std::vector<double> squares;
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
      squares.push_back(world.step_limit().limiting_square(world.body(), v, 0));
    const auto of_vertices = levels_of_vertices(squares, *std::max_element(squares.begin(), squares.end()));
    const std::vector<Level> levels = levels_of_tets(setup.mesh, of_vertices);
    CHECK(*std::max_element(levels.begin(), levels.end()) >= 1);
    // Rigid motions grow linearly in position, and not at all in velocity.
    CHECK(growth(setup, levels, dt, 17) < 10);
    // The stiff part alone at the short step, and all else at the long one.
    std::vector<Level> bare = levels;
    const Level top = *std::max_element(levels.begin(), levels.end());
    for (std::size_t t = 0; t < bare.size(); ++t) bare[t] = setup.material_of[t] == 1 ? 0 : top;
    bare_grew |= !(growth(setup, bare, dt, 17) < 1e3);
  }
  CHECK(bare_grew);
}
