// Mass that keeps the time step of what a blade has cut.
#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/numerics/symmetric_eigen.h"
#include "lobe/time/mass_floor.h"

#include <doctest/doctest.h>

#include <filesystem>

#include "fibre_support.h"
#include "lobe/io/mesh_io.h"
#include "lobe/sim/rebuild.h"
#include "lobe/sim/validate.h"
#include "near.h"
#include "strokes.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// λ_max(K_T)/(ρV/4) from the matrix of 12 × 12, column by column as forces of a linear tetrahedron.
double square_by_matrix(const Elements& elements, Index t) {
  const Shape of_tet = elements.shape_of(t);
  const Elastic& e = elements.elastic_of(t);
  const Law<double> law = linear_law(elements, t);
  Eigen::Matrix<double, 12, 12> K;
  for (int i = 0; i < 12; ++i) {
    Mat34<double> u = Mat34<double>::Zero();
    u.data()[i] = 1;
    const Mat3<double> alpha = of_tet.gradients.rightCols<3>();
    const Mat3<double> H = displacement_gradient(u, alpha), strain = (H + H.transpose()) / 2;
    Mat3<double> stress = e.lambda * strain.trace() * Mat3<double>::Identity() + 2 * e.mu * strain;
    if (e.fibre.any()) {
      const Vec3d a = law.direction, Ea = strain * a;
      const double along = a.dot(Ea);
      stress += e.fibre.coupling * (along * Mat3<double>::Identity() + strain.trace() * a * a.transpose()) +
                2 * e.fibre.shear * (a * Ea.transpose() + Ea * a.transpose()) +
                e.fibre.stretch * along * a * a.transpose();
    }
    K.col(i) = (stress * of_tet.gradients * of_tet.volume).reshaped();
  }
  return symmetric_eigenvalues<Eigen::MatrixXd>(K)[11] / (e.density * of_tet.volume / 4);
}

World<double> cut_world(const Setup& setup, int strokes) {
  World<double> world(setup);
  cut(world, incisions_of(setup.mesh, strokes));
  return world;
}

double total(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

}  // namespace

TEST_CASE("the highest frequency of a tetrahedron is that of its matrix, with fibres at least that") {
  const Elements plain(setup_of(irregular_box(2))), fibrous(fibrous_setup(irregular_box(2)));
  for (Index t = 0; t < plain.topology.tet_count(); ++t) {
    CHECK(tet_square(plain, t) == near(square_by_matrix(plain, t), 1e-12));
    CHECK(tet_square(fibrous, t) > (1 - 1e-12) * square_by_matrix(fibrous, t));
  }
}

TEST_CASE("with the floor a diced body keeps 0.7 of its time step, and without it less") {
  Setup setup = setup_of(irregular_box(4, 0.025));
  const double uncut = World<double>(setup).time_step_limit();
  World<double> kept = cut_world(setup, 20);
  kept.step_limit().measure_at_rest(kept.body());
  CHECK(kept.time_step_limit() > 0.7 * uncut);
  CHECK(kept.body().inertia.mass_of_floor() > 0);
  setup.cut_step = 0;
  World<double> plain = cut_world(setup, 20);
  plain.step_limit().measure_at_rest(plain.body());
  CHECK(plain.time_step_limit() <= kept.time_step_limit());
  CHECK(plain.body().inertia.mass_of_floor() == 0);
  const double added = total(kept.body().inertia.mass()) - total(plain.body().inertia.mass());
  CHECK(kept.body().inertia.mass_of_floor() == near(added, 1e-9));
}

// No tetrahedron is divided then, so there is no floor. The bound by the worst tetrahedron holds.
TEST_CASE(
    "cuts along faces of a shipped liver shorten its time step to that of its worst tetrahedron at most") {
  Setup setup = setup_of(read_mesh(std::filesystem::path(LOBE_DATA_DIR) / "meshes/liver_2k.vtu").mesh);
  const double uncut = World<double>(setup).time_step_limit();
  const Elements elements(setup);
  double of_worst = std::numeric_limits<double>::infinity();  // [s]
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    of_worst = std::min(of_worst, 2 / std::sqrt(tet_square(elements, t)));
  const Vec3d low = setup.mesh.points.rowwise().minCoeff(), high = setup.mesh.points.rowwise().maxCoeff();
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.25, 0.75);
  std::vector<double> ratios;
  for (int trial = 0; trial < 20; ++trial) {
    World<double> world(setup);
    for (int stroke = 0; stroke < (trial < 15 ? 1 : 4); ++stroke) {
      const Vec3d n = Vec3d(normal(random), normal(random), normal(random)).normalized(),
                  along = n.unitOrthogonal(), edge = 0.3 * n.cross(along),
                  middle =
                      low +
                      (high - low).cwiseProduct(Vec3d(uniform(random), uniform(random), uniform(random)));
      const ToolId id = world.tools().next_id();
      const auto tip = [&](double x) { return Vec3d(middle + x * along - edge / 2); };
      world.apply(BringScalpel{"blade", {tip(-0.2), tip(-0.2) + edge}, 0.1, true});
      world.apply(SwitchTool{id, true});
      world.apply(Lead{id, {tip(0.2)}});
      REQUIRE(world.advance(1e-6).cut_area > 0);
      world.apply(LetGo{id});
    }
    CHECK(world.elements().topology.tet_copy_count() == 0);
    CHECK(world.elements().topology.copy_count() > 20);
    world.step_limit().measure_at_rest(world.body());
    ratios.push_back(world.time_step_limit() / uncut);
    CHECK(world.body().inertia.mass_of_floor() == 0);
    CHECK(world.time_step_limit() > of_worst);
  }
  std::sort(ratios.begin(), ratios.begin() + 15);
  MESSAGE("of one plane: worst " << ratios[0] << ", median " << ratios[7] << "; of four: worst "
                                 << *std::min_element(ratios.begin() + 15, ratios.end()));
  CHECK(ratios[7] > 0.7);
}

TEST_CASE("what the floor adds has no weight") {
  Setup setup = setup_of(irregular_box(4, 0.025));
  setup.gravity = {0, 0, -9.81};
  World<double> whole(setup);
  World<double> world = cut_world(setup, 10);
  CHECK(world.body().inertia.mass_of_floor() > 0);
  const Vec3d before = whole.body().loads.at(0).rowwise().sum(),
              after = world.body().loads.at(0).rowwise().sum();
  CHECK((after - before).norm() < 1e-12 * before.norm());
}

TEST_CASE("a body with a floor equals one built afresh, also after removals") {
  World<double> world = cut_world(hybrid_setup(irregular_box(4, 0.025)), 8);
  validate(world);
  CHECK(world.body().inertia.mass_of_floor() > 0);
  CHECK(compare_with_rebuilt(world).largest() < 1e-12);
  world.remove_tets({3, 50, 51, 120});
  CHECK(compare_with_rebuilt(world).largest() < 1e-12);
}

TEST_CASE("a hundred thousand undamped steps at 0.99 of the limit stay stable after twenty cuts") {
  Setup setup = setup_of(irregular_box(3, 0.03));
  World<double> world = cut_world(setup, 20);
  world.step_limit().measure_at_rest(world.body());
  const double dt = 0.99 * world.time_step_limit();
  State<double> state = world.state();
  state.v = random_displacement(static_cast<Index>(state.v.cols()), 1e-3, 8);
  world.set_state(state);
  const double energy = world.energies().total();
  double highest = 0;
  for (int i = 0; i < 100; ++i) {
    for (int k = 0; k < 1000; ++k) world.step(dt);
    highest = std::max(highest, world.energies().total());
  }
  CHECK(highest < 1.5 * energy);  // velocities stand half a step behind
  CHECK(highest > 0.5 * energy);
}
