// Loads, holds and forces of a body that a blade has cut.
#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "lobe/sim/rebuild.h"
#include "lobe/sim/validate.h"
#include "near.h"
#include "strokes.h"

using namespace lobe;
using namespace lobe::test;

namespace {

struct Resultant {
  Vec3d force = Vec3d::Zero(), moment = Vec3d::Zero();
};

Resultant of_loads(const World<double>& world) {
  const Mat3X<double> loads = world.body().loads.at(0);
  Resultant sum;
  for (Index v = 0; v < static_cast<Index>(loads.cols()); ++v) {
    sum.force += loads.col(v);
    sum.moment += Vec3d(world.elements().points.col(v)).cross(Vec3d(loads.col(v)));
  }
  return sum;
}

Setup loaded_box() {
  Setup setup = setup_of(irregular_box(5, 0.02));
  const Topology topology(setup.mesh);
  for (Index code : topology.boundary_faces()) {
    const Eigen::Vector3i face = topology.face(code);
    bool on_top = true;
    for (Index v : face) on_top = on_top && setup.mesh.points(2, v) > 0.09;
    if (on_top) setup.face_loads.push_back({code / 4, int(code % 4), {30, -20, 100}});
  }
  return setup;
}

// A bar along x at rest, and a blade that falls through its middle.
Setup bar_at_rest(double depth = 0.08, double speed = 0.2) {
  Setup setup = setup_of(box_mesh({0.12, 0.03, 0.03}, 12, 3, 3));
  setup.materials = {{8e5, 2e5, 1000}};
  setup.scalpels.push_back(
      {"blade",
       0.1,
       {{0.03, {0.063, -0.02, 0.05}}, {0.03 + depth / speed, {0.067, -0.02, 0.05 - depth}}},
       {{0.063, 0.05, 0.05}, {0.067, 0.05, 0.05 - depth}}});
  return setup;
}

double area_after(World<double>& world, int frames) {
  double area = 0;
  for (int i = 0; i < frames; ++i) {
    const Report report = world.advance(1.0 / 30);
    CHECK(report.ok);
    area += report.cut_area;
  }
  validate(world);
  return area;
}

}  // namespace

TEST_CASE("force and moment of a traction are the same before and after cuts through the loaded face") {
  const Setup setup = loaded_box();
  World<double> world(setup);
  const Resultant before = of_loads(world);
  CHECK(before.force.norm() > 0.5);
  cut(world, incisions_of(setup.mesh, 6));
  CHECK(world.elements().topology.tet_copy_count() > 100);
  const Resultant after = of_loads(world);
  CHECK((after.force - before.force).norm() < 1e-12 * before.force.norm());
  CHECK((after.moment - before.moment).norm() < 1e-12 * before.moment.norm());
  CHECK(compare_with_rebuilt(world).largest() < 1e-12);
}

TEST_CASE("each part of a cut face bears the traction on its own area") {
  const Setup setup = loaded_box();
  World<double> world(setup);
  Knife knife(setup.mesh);
  knife.begin();
  const auto row = [](double z) { return std::vector<Vec3d>{{0.0437, -0.1, z}, {0.0437, 0.2, z}}; };
  cut(world, {knife.sweep(row(0.2), row(-0.1)).incision});
  REQUIRE(world.elements().topology.pieces().size() == 2);
  // The area of the top on either side, from its triangles cut by the plane.
  double left = 0, whole = 0;
  for (const FaceLoad& load : setup.face_loads) {
    const Eigen::Vector3i face = Topology(setup.mesh).face(4 * load.tet + load.face);
    Mat3<double> X;
    for (int k = 0; k < 3; ++k) X.col(k) = setup.mesh.points.col(face[k]);
    const double area = (X.col(1) - X.col(0)).cross(X.col(2) - X.col(0)).norm() / 2;
    whole += area;
    int count = 0;
    for (int k = 0; k < 3; ++k) count += X(0, k) < 0.0437;
    if (count == 3) left += area;
    if (count == 1 || count == 2) {
      int apex = 0;
      for (int k = 0; k < 3; ++k)
        if ((X(0, k) < 0.0437) == (count == 1)) apex = k;
      double part = area;
      for (int k = 1; k < 3; ++k) {
        const int other = (apex + k) % 3;
        part *= (0.0437 - X(0, apex)) / (X(0, other) - X(0, apex));
      }
      left += count == 1 ? part : area - part;
    }
  }
  const Mat3X<double> loads = world.body().loads.at(0);
  Vec3d on_left = Vec3d::Zero();
  for (const std::vector<Index>& piece : world.elements().topology.pieces()) {
    bool is_left = false;
    std::vector<Index> vertices;
    for (Index t : piece)
      for (Index v : world.elements().topology.corners(t)) {
        vertices.push_back(v);
        is_left = is_left || world.elements().points(0, v) < 0.01;
      }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    if (is_left)
      for (Index v : vertices) on_left += loads.col(v);
  }
  CHECK(on_left.z() == near(100 * left, 0.03));  // points near the plane lie on it: by 0.1 of an edge at most
  CHECK(left < 0.6 * whole);
}

TEST_CASE("a force on a vertex stays where the vertex lies in the tissue, and all of it") {
  Setup setup = setup_of(irregular_box(5, 0.02));
  setup.gravity.setZero();
  for (Index v = 0; v < setup.mesh.vertex_count(); v += 3)
    setup.vertex_loads.push_back({v, {0.01 * v, 0.3, -0.02 * v}});
  World<double> world(setup), parted(setup);
  const Resultant before = of_loads(world);
  cut(world, incisions_of(setup.mesh, 6));
  CHECK(world.elements().topology.copy_count() > 50);
  Mat3X<double> expected = Mat3X<double>::Zero(3, world.elements().topology.vertex_count());
  for (const VertexLoad& load : setup.vertex_loads) {
    expected.col(load.vertex) = load.force;
    CHECK(world.grains()->fills(load.vertex, world.elements()));
  }
  CHECK(world.body().loads.at(0) == expected);
  const Resultant after = of_loads(world);
  CHECK((after.force - before.force).norm() < 1e-12 * before.force.norm());
  CHECK((after.moment - before.moment).norm() < 1e-12 * before.moment.norm());
  CHECK(compare_with_rebuilt(world).largest() < 1e-12);

  // Of two parts each has the forces on its side of the plane. The blade passes vertices by more than `snap`.
  Knife knife(setup.mesh, 0.02);
  knife.begin();
  const double x = 0.0437;
  const auto row = [&](double z) { return std::vector<Vec3d>{{x, -0.1, z}, {x, 0.2, z}}; };
  cut(parted, {knife.sweep(row(0.2), row(-0.1)).incision});
  const Topology& topology = parted.elements().topology;
  REQUIRE(topology.pieces().size() == 2);
  std::vector<int> piece_of(std::size_t(topology.tet_count()), 0);
  const std::vector<Index> second = topology.pieces()[1];
  for (Index t : second) piece_of[std::size_t(t)] = 1;
  const auto piece_at = [&](Index v) { return piece_of[std::size_t(topology.around(v)[0])]; };
  Index left = 0;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < setup.mesh.points(0, left)) left = v;
  for (const VertexLoad& load : setup.vertex_loads)
    if (const double off = setup.mesh.points(0, load.vertex) - x; std::abs(off) > 1e-3)
      CHECK((piece_at(load.vertex) == piece_at(left)) == (off < 0));
}

TEST_CASE("a blade feels the work per area that it opens, along its way") {
  Setup setup = bar_at_rest();
  setup.materials[0].fracture_energy = 250;
  World<double> world(setup);
  double area = 0, work = 0;
  for (int i = 0; i < 18; ++i) {
    area += world.advance(1.0 / 30).cut_area;
    const Scalpel& blade = world.tools().lists().scalpels.front();
    // In the first frame and the last the blade moves for a part of it only.
    work += blade.length * blade.force.norm();
    if (blade.force.norm() > 0) {
      CHECK(blade.force.normalized().dot(Vec3d(0.004, 0, -0.08).normalized()) > 0.99);
      CHECK(blade.force.norm() < 250 * 0.03 * 3);  // G_c times the width, give or take whole elements
    }
  }
  CHECK(area > 8e-4);
  CHECK(work == near(250 * area, 1e-9));
  setup.materials[0].fracture_energy = 0;
  World<double> soft(setup);
  for (int i = 0; i < 18; ++i) {
    soft.advance(1.0 / 30);
    CHECK(soft.tools().lists().scalpels.front().force.isZero());
  }
}

TEST_CASE("what lies on a held face stays held, also where a cut runs between its corners") {
  Setup setup = setup_of(box_mesh(Vec3d::Constant(0.1), 5, 5, 5));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) == 0) setup.prescribed.push_back({v});
  World<double> world(setup);
  Knife knife(setup.mesh);
  knife.begin();
  const auto row = [](double z) { return std::vector<Vec3d>{{0.051, -0.1, z}, {0.051, 0.2, z}}; };
  cut(world, {knife.sweep(row(0.2), row(-0.1)).incision});
  REQUIRE(world.elements().topology.pieces().size() == 2);
  // Both sides are held by what is left of the floor, at the corners of every face of it.
  const Grains& grains = *world.grains();
  for (Index t = 0; t < world.elements().topology.tet_count(); ++t)
    for (int f = 0; f < 4; ++f) {
      const Eigen::Vector4i corners = world.elements().topology.corners(t);
      const int* c = face_corners[f];
      bool is_floor = grains.boundary_share_of(t, f, world.elements()).sum() > 0;
      for (int k = 0; k < 3; ++k) is_floor = is_floor && world.elements().points(2, corners[c[k]]) == 0;
      if (!is_floor) continue;
      for (int k = 0; k < 3; ++k) CHECK(world.held().holds(corners[c[k]]));
    }
}

// ---- What is no cut

TEST_CASE("a blade that is narrower than an element marks, opens nothing, and loses nothing") {
  Setup setup = bar_at_rest();
  setup.scalpels[0].path[0].position = {0.0632, 0.0132, 0.05};
  setup.scalpels[0].path[1].position = {0.0632, 0.0132, -0.03};
  setup.scalpels[0].heels = {{0.0632, 0.0152, 0.05}, {0.0632, 0.0152, -0.03}};
  World<double> world(setup);
  CHECK(area_after(world, 18) == 0);
  CHECK(world.elements().topology.copy_count() == 0);
  CHECK(compare_with_rebuilt(world).largest() < 1e-12);
}

TEST_CASE("a blade along a face of the body opens nothing") {
  Setup setup = bar_at_rest();
  for (int i = 0; i < 2; ++i) setup.scalpels[0].path[i].position.x() = setup.scalpels[0].heels[i].x() = 0.12;
  World<double> world(setup);
  CHECK(area_after(world, 18) == 0);
  CHECK(world.elements().topology.pieces().size() == 1);
  CHECK(world.elements().topology.tet_copy_count() == 0);
}

TEST_CASE("a blade that leaps through the body in one frame cuts all that lies between") {
  Setup setup = bar_at_rest();
  setup.scalpels[0].path = {{0.01, {0.063, -0.02, 3}}, {0.011, {0.063, -0.02, -3}}};
  setup.scalpels[0].heels = {{0.063, 0.05, 3}, {0.063, 0.05, -3}};
  World<double> world(setup);
  CHECK(area_after(world, 2) == near(9e-4, 0.02));
  CHECK(world.elements().topology.pieces().size() == 2);
}

// The tetrahedra between x = 0.06 and 0.07 are inverted, and lie where those beside them are stretched and
// crushed: the blade meets all three layers before the first step.
TEST_CASE("a blade through inverted and crushed tetrahedra cuts them as they are at rest") {
  Setup setup = bar_at_rest();
  setup.guard_below = 0.3;
  setup.scalpels[0].path = {{0, {0.0713, -0.02, 0.05}}, {1e-3, {0.0717, -0.02, -0.03}}};
  setup.scalpels[0].heels = {{0.0713, 0.05, 0.05}, {0.0717, 0.05, -0.03}};
  World<double> world(setup);
  State<double> state = world.state();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (std::abs(setup.mesh.points(0, v) - 0.06) < 1e-9) state.u(0, v) = 0.013;  // beyond the next vertices
  world.set_state(state);
  const auto is_inverted = [&](Index t) {
    const Eigen::Vector4i corners = setup.mesh.tets.col(t);
    const Mat34<double> x =
        setup.mesh.points(Eigen::all, corners) + Mat3X<double>(state.u(Eigen::all, corners));
    return (x.rightCols<3>().colwise() - x.col(0)).determinant() < 0;
  };
  CHECK(world.advance(1e-3).cut_area > 2.5 * 9e-4);  // three layers
  validate(world);
  CHECK(compare_with_rebuilt(world).largest() < 1e-12);
  const Topology& topology = world.elements().topology;
  Index inverted = 0, right_way_round = 0;  // of those that are cut
  double volume = 0;
  for (Index t = 0; t < topology.tet_count(); ++t) {
    volume += world.elements().volume(t);
    if (world.elements().share_of(t) == 1) continue;
    ++(is_inverted(topology.parent(t)) ? inverted : right_way_round);
  }
  CHECK(inverted >= 45);
  CHECK(right_way_round >= 90);
  CHECK(volume == near(1.08e-4, 1e-12));
  world.advance(1.0 / 30);
  validate(world);
  CHECK(world.state().u.allFinite());
}

TEST_CASE("a path whose times do not increase is refused") {
  Setup setup = bar_at_rest();
  setup.scalpels[0].path[1].time = setup.scalpels[0].path[0].time;
  CHECK_THROWS_WITH(World<double>{setup}, doctest::Contains("times of its path must increase"));
}

TEST_CASE("a body that moves as one feels no force, cut or not") {
  Setup setup = setup_of(irregular_box(8, 0.0125));
  setup.cut_step = 0;
  World<double> world(setup);
  cut(world, incisions_of(setup.mesh, 6));
  const Mat3<double> turn = Eigen::AngleAxisd(1, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
  State<double> state = world.state();
  const auto X = world.elements().points.view();
  state.u = (turn * X - X).colwise() + Vec3d(0.1, 0, 0.2);
  world.set_state(state);
  CHECK(world.forces().cwiseAbs().maxCoeff() < 1e-9);
  // An affine motion leaves none on what is whole around: the stress is the same in all of a vertex's
  // tetrahedra.
  state.u = Mat3<double>(Vec3d(0.1, -0.05, 0.02).asDiagonal()) * X;
  world.set_state(state);
  const Mat3X<double> forces = world.forces();
  const double scale = forces.cwiseAbs().maxCoeff();
  std::vector<char> is_whole(std::size_t(X.cols()), 1);
  const Topology& topology = world.elements().topology;
  for (Index t = 0; t < topology.tet_count(); ++t)
    if (world.elements().share_of(t) < 1)
      for (Index v : topology.corners(t)) is_whole[std::size_t(v)] = 0;
  for (Index code : topology.boundary_faces())
    for (Index v : topology.face(code)) is_whole[std::size_t(v)] = 0;
  int count = 0;
  for (Index v = 0; v < topology.vertex_count(); ++v) {
    if (!is_whole[std::size_t(v)]) continue;
    ++count;
    CHECK(forces.col(v).norm() < 1e-12 * scale);
  }
  CHECK(count > 0);
}
