// What pieces blades leave: of the scenes of data/scenes, and of a body that sways while two blades cross in
// it.
#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <filesystem>
#include <map>

#include "lobe/io/mesh_io.h"
#include "lobe/scene/frames.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/validate.h"
#include "lobe/sim/world.h"
#include "near.h"
#include "rebuilt.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

struct Piece {
  double volume = 0;            // at rest [m³]
  Vec3d rest = Vec3d::Zero();   // its centre at rest [m]
  Vec3d moved = Vec3d::Zero();  // and by how much that has moved [m]
};

// Those of more than 0.1 % of the volume, the largest first.
std::vector<Piece> large_pieces(World<float>& world) {
  const Elements& elements = world.elements();
  const auto u = world.displacements();
  std::vector<Piece> pieces;
  double whole = 0;
  for (const std::vector<Index>& tets : elements.topology.pieces()) {
    Piece& piece = pieces.emplace_back();
    for (Index t : tets) {
      const double own = elements.volume(t);
      piece.volume += own;
      piece.rest += own * elements.corner_points(t).rowwise().mean();
      for (Index v : elements.topology.corners(t)) piece.moved += own / 4 * u.col(v).cast<double>();
    }
    piece.rest /= piece.volume;
    piece.moved /= piece.volume;
    whole += piece.volume;
  }
  std::erase_if(pieces, [&](const Piece& piece) { return piece.volume < 1e-3 * whole; });
  std::sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) { return a.volume > b.volume; });
  return pieces;
}

// Plays frames. Masses and the pieces that are found from the grains alone must be right at its end.
std::vector<Piece> pieces_after(const Setup& setup, const Frames& frames) {
  World<float> world(setup);
  double before = 0, after = 0;
  for (Index t = 0; t < world.elements().topology.tet_count(); ++t) before += world.elements().volume(t);
  for (int i = 0; i < frames.count; ++i) REQUIRE(world.advance(frames.length).ok);
  validate(world);
  const Topology& topology = world.elements().topology;
  for (Index t = 0; t < topology.tet_count(); ++t) {
    CHECK(topology.alive(t));
    after += world.elements().volume(t);
  }
  CHECK(after == near(before, 1e-12));
  const Rebuilt rebuilt(*world.grains(), topology);
  CHECK(rebuilt.faults == 0);
  CHECK(rebuilt.pieces == Index(topology.pieces().size()));
  return large_pieces(world);
}

// How far the sides of a cut are apart at most: what has one place at rest, in the grains around it [m].
double widest_gap(World<float>& world) {
  const Elements& elements = world.elements();
  const Grains& grains = *world.grains();
  const auto u = world.displacements();
  std::map<Place, Eigen::AlignedBox3d> moves;
  for (Index g = 0; g < grains.count(); ++g) {
    const Index t = grains[g].element;
    const Mat34<double> X = elements.corner_points(t),
                        of_corners = u(Eigen::all, elements.topology.corners(t)).cast<double>();
    const Mat3<double> gradient = (of_corners.rightCols<3>().colwise() - of_corners.col(0)) *
                                  (X.rightCols<3>().colwise() - X.col(0)).inverse();
    for (Index p : grains[g].points) {
      const Vec3d& at = grains.point(p);
      moves[{at[0], at[1], at[2]}].extend(of_corners.col(0) + gradient * (at - X.col(0)));
    }
  }
  double widest = 0;
  for (const auto& [at, box] : moves) widest = std::max(widest, box.diagonal().norm());
  return widest;
}

std::vector<Piece> pieces_after(const std::string& name) {
  const Scene scene = read_scene(std::filesystem::path(LOBE_DATA_DIR) / "scenes" / (name + ".json"));
  return pieces_after(resolve(scene, read_mesh(mesh_path(scene)).mesh).setup, frames_of(scene.time));
}

// Two blades fall through a block that sways on its lower end.
Setup swaying_block(RegionModel model) {
  Setup setup = setup_of(irregular_box(6), model);
  const double size = setup.mesh.points.row(0).maxCoeff();
  setup.gravity = {6, 3, -9.81};
  setup.damping = 2;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < 0.1 * size) setup.prescribed.push_back({v, Vec3d::Zero()});
  const auto add_blade = [&](const char* name, const Vec3d& along, const Vec3d& aside) {
    const Vec3d middle = size * (Vec3d(0.5, 0.5, 0) + aside), above(0, 0, 1.5 * size),
                below(0, 0, -0.2 * size);
    setup.scalpels.push_back({name,
                              0.1,
                              {{0.02, middle + above - size * along}, {0.3, middle + below - size * along}},
                              {middle + above + size * along, middle + below + size * along}});
  };
  add_blade("one", {1.2, 0.2, 0.1}, {0, 0.04, 0});
  add_blade("other", {-0.1, 1.2, 0.05}, {0.06, 0, 0});
  return setup;
}

}  // namespace

TEST_CASE("the shipped resection with a blade: the left lobe is one piece, and is lifted off") {
  const std::vector<Piece> pieces = pieces_after("liver_scalpel");
  REQUIRE(pieces.size() == 2);
  CHECK(pieces[1].rest.x() > 0.04);
  CHECK(pieces[1].moved.z() > 0.009);
  CHECK(pieces[0].moved.norm() < 0.004);  // its lower part is held
}

TEST_CASE("the shipped incision opens as two grasps pull at its sides, and the liver stays one piece") {
  const Scene scene = read_scene(std::filesystem::path(LOBE_DATA_DIR) / "scenes/liver_incision.json");
  const Frames frames = frames_of(scene.time);
  World<float> world(resolve(scene, read_mesh(mesh_path(scene)).mesh).setup);
  std::vector<double> gaps;  // after 1.5, 2, 2.5 and 3 s
  double area = 0;
  for (int i = 1; i <= frames.count; ++i) {
    const Report report = world.advance(frames.length);
    REQUIRE(report.ok);
    CHECK(report.tets_removed == 0);
    area += report.cut_area;
    if (i >= 75 && i % 25 == 0) gaps.push_back(widest_gap(world));
  }
  validate(world);
  REQUIRE(gaps.size() == 4);
  CHECK(area > 1e-3);
  CHECK(gaps[0] < 1e-6);  // nothing pulls yet
  CHECK(gaps[1] > 0.01);
  CHECK(gaps[2] > 1.5 * gaps[1]);
  CHECK(gaps[2] < 0.05);                  // the grasps have gone 44 mm apart
  CHECK(gaps[3] == near(gaps[2], 0.05));  // and stay there
  CHECK(world.elements().topology.pieces().size() == 1);
}

TEST_CASE("three shipped cuts that cross part the liver in eight, and the upper four are lifted off") {
  const std::vector<Piece> pieces = pieces_after("liver_crossing");
  REQUIRE(pieces.size() == 8);
  int lifted = 0;
  for (const Piece& piece : pieces) {
    const bool is_upper = piece.rest.z() > 0.018;
    lifted += is_upper;
    CHECK((is_upper ? piece.moved.z() > 0.012 : piece.moved.norm() < 1e-3));
  }
  CHECK(lifted == 4);
}

TEST_CASE("two blades that cross at once in a body that sways part it in four") {
  for (const RegionModel model : {RegionModel::nonlinear, RegionModel::tensor_mass}) {
    const std::vector<Piece> pieces = pieces_after(swaying_block(model), {40, 0.01});
    REQUIRE(pieces.size() == 4);
    CHECK(pieces[3].volume > 0.5 * pieces[0].volume);
  }
}

TEST_CASE("a checkpoint amid two strokes that cross gives the same bits") {
  const Setup setup = swaying_block(RegionModel::nonlinear);
  World<float> world(setup), other(setup, 2);
  for (int i = 0; i < 15; ++i) REQUIRE(world.advance(0.01).ok);
  REQUIRE(world.grains()->point_count() > setup.mesh.vertex_count());
  other.restore(world.save());
  for (int i = 0; i < 25; ++i) {
    REQUIRE(world.advance(0.01).ok);
    REQUIRE(other.advance(0.01).ok);
  }
  CHECK(same_bits(world, other));
}
