// What was to be full for a while stays so as long as its tissue moves as no lattice can.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "lattice_worlds.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// The root mean square of F − F̄ over the tetrahedra around these vertices.
double roughness(World<double>& world, const std::vector<Index>& vertices) {
  const Elements& elements = world.elements();
  const Mat3X<double> u = world.state().u;
  double sum = 0;
  for (Index v : vertices) {
    const auto around = elements.topology.around(v);
    std::vector<Mat3<double>> F;
    Mat3<double> mean = Mat3<double>::Zero();
    double volume = 0, squares = 0;
    for (Index t : around) {
      const Mat34<double> of_corners = u(Eigen::all, elements.topology.corners(t));
      F.push_back(of_corners * elements.shape_of(t).gradients.transpose());
      mean += elements.shape_of(t).volume * F.back();
      volume += elements.shape_of(t).volume;
    }
    mean /= volume;
    for (std::size_t i = 0; i < F.size(); ++i)
      squares += elements.shape_of(around[i]).volume * (F[i] - mean).squaredNorm();
    sum += squares / volume;
  }
  return std::sqrt(sum / double(vertices.size()));
}

}  // namespace

TEST_CASE("what was full for a while stays so while its tissue is rough, and is embedded once it is smooth") {
  Setup setup = bar(16, 4, false);
  setup.damping = 4;
  World<double> world(setup);
  const std::vector<Index> end = vertices_near(setup.mesh, {0.16, 0.02, 0.02}, 0.03);
  world.apply(KeepFull{end, 0.15});
  REQUIRE(world.advance(0.01).ok);
  State<double> state = world.state();
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.04 * edge);
  for (Index v : end) state.u.col(v) += Vec3d(noise(random), noise(random), noise(random));
  state.u.row(2).array() += 1;  // so far that what vibrates is not quick, which would make all of it full
  world.set_state(state);
  int rough_frames = 0;
  while (world.time() < 2) {
    REQUIRE(world.advance(0.01).ok);
    CHECK(region_of(world).any_embedded());
    if (world.time() < 0.25 || roughness(world, end) < 0.03) continue;
    ++rough_frames;
    for (Index v : end) CHECK_FALSE(region_of(world).embeds(v));
  }
  CHECK(rough_frames > 40);
  CHECK(roughness(world, end) < 0.01);
  for (Index v : end) CHECK(region_of(world).embeds(v));
}
