// Lips of a cut that a blade has made within tetrahedra, against each other.
#include <cmath>
#include <random>

#include "contact/frame.h"
#include "lobe/contact/boundary_layer.h"
#include "lobe/contact/contact.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/validate.h"
#include "near.h"
#include "scalpel/strokes.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double edge = 0.04;  // of the block [m]

Setup block(RegionModel model) {
  Setup setup = setup_of(box_mesh(Vec3d::Constant(edge), 8, 8, 8), model);
  setup.damping = 60;
  setup.contact.self = true;
  setup.contact.friction = 0;
  return setup;
}

// Pressed by a twentieth of its height.
Setup pressed(RegionModel model) {
  Setup setup = block(model);
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
    const double z = setup.mesh.points(2, v);
    if (z == 0) setup.prescribed.push_back({v, Vec3d::Zero()});
    if (z > edge - 1e-9) setup.prescribed.push_back({v, {0, 0, -edge / 20}});
  }
  return setup;
}

// From one side through 70 % of the block, aslant and between its layers of vertices.
template <class Real>
void slit(World<Real>& world, const TetMesh& mesh) {
  Knife knife(mesh);
  knife.begin();
  const auto row = [](double x) {
    const double z = 0.55 * edge - 0.04 * x;
    return std::vector<Vec3d>{{x, -0.01, z}, {x, 0.05, z + 0.002}};
  };
  std::vector<Incision> incisions;
  for (int i = 0; i < 7; ++i)
    if (Incision incision = knife.sweep(row(-0.007 + 0.005 * i), row(-0.002 + 0.005 * i)).incision;
        !incision.empty())
      incisions.push_back(std::move(incision));
  incise(world, incisions);
  CHECK(world.elements().topology.tet_copy_count() > 100);
  CHECK(world.elements().topology.pieces().size() == 1);
}

Vec3d place_at_rest(const World<double>& world, const ContactSurface::Point& point) {
  Vec3d x = Vec3d::Zero();
  for (int i = 0; i < point.count; ++i) x += point.weights[i] * world.elements().points.col(point.corners[i]);
  return x;
}

double energy_at_rest(Setup setup, bool is_cut, bool self) {
  setup.contact.self = self;
  World<double> world(setup, 2);
  if (is_cut) slit(world, setup.mesh);
  for (int i = 0; i < 25; ++i) REQUIRE(world.advance(frame).ok);
  const Energies energies = world.energies();
  return energies.elastic_linear + energies.elastic_nonlinear;
}

}  // namespace

TEST_CASE("lips of a blade's cut that are pressed shut are as stiff as the block without it") {
  for (const RegionModel model : {RegionModel::tensor_mass, RegionModel::nonlinear}) {
    const Setup setup = pressed(model);
    const double whole = energy_at_rest(setup, false, false), shut = energy_at_rest(setup, true, true),
                 loose = energy_at_rest(setup, true, false);
    MESSAGE("shut " << shut / whole << ", without contact " << loose / whole);
    CHECK(shut == near(whole, 0.02));
    CHECK(loose < 0.9 * whole);
  }
}

TEST_CASE("lips of a blade's cut have no force until they overlap") {
  const Setup setup = block(RegionModel::nonlinear);
  World<double> world(setup);
  slit(world, setup.mesh);
  for (int i = 0; i < 3; ++i) world.advance(frame);
  CHECK(world.forces().norm() < 1e-12);
  CHECK(world.energies().applied < 1e-18);
}

TEST_CASE(
    "lips that beat against each other keep momentum, with the same bits on any threads and from a "
    "checkpoint") {
  Setup setup = block(RegionModel::nonlinear);
  setup.damping = 0;
  setup.contact.friction = 0.2;
  const auto begin = [&](World<float>& world) {
    slit(world, setup.mesh);
    State<float> state = world.state();
    for (Index v = 0; v < state.v.cols(); ++v) {  // the upper half moves down, the lower one up
      const Vec3d X = world.elements().points.col(v);
      state.v(2, v) = float(-8 * (X.z() - edge / 2));
      state.v(0, v) = 0.1F;
    }
    world.set_state(state);
  };
  World<float> world(setup), other(setup, 7), restored(setup, 2);
  begin(world);
  begin(other);
  const auto momentum = [&] {
    Vec3d sum = Vec3d::Zero();
    const StateView<float> state = world.state();
    for (Index v = 0; v < state.v.cols(); ++v)
      sum += world.body().inertia.mass()[std::size_t(v)] * state.v.col(v).cast<double>();
    return sum;
  };
  const Vec3d before = momentum();
  const double energy = world.energies().total();
  double most = 0, most_in_body = 0, touching = 0;
  for (int i = 0; i < 40; ++i) {
    if (i == 20) restored.restore(world.save());
    REQUIRE(world.advance(0.002).ok);
    other.advance(0.002);
    if (i >= 20) restored.advance(0.002);
    const Energies now = world.energies();
    most = std::max(most, now.total());
    most_in_body = std::max(most_in_body, now.total() - now.applied);
    touching = std::max(touching, now.applied);
  }
  validate(world);
  CHECK(touching > 0.01 * energy);
  CHECK((momentum() - before).norm() < 1e-5 * before.norm());
  CHECK(most_in_body < energy * 1.03);  // depths that are held give some
  CHECK(most < energy * 1.04);
  CHECK(same_bits(world, other));
  CHECK(same_bits(world, restored));
}

TEST_CASE("a face is the nearest wherever it is said to be, also at the lips of a closed cut") {
  const Setup setup = block(RegionModel::nonlinear);
  World<double> world(setup);
  slit(world, setup.mesh);
  REQUIRE(world.advance(1e-4).ok);
  const Contact<double>* contact = nullptr;
  for (const auto& term : world.body().terms)
    if (const auto* found = dynamic_cast<const Contact<double>*>(term.get())) contact = found;
  REQUIRE(contact);
  const ContactSurface& surface = contact->surface();
  BoundaryLayer layer;
  layer.rebuild(surface, world.elements());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(0.1, 1);
  int known = 0, wrong = 0;
  for (const BoundaryLayer::Tet& tet : layer.tets())
    for (int f : layer.faces_of(tet)) {
      Mat3<double> corners;
      for (int c = 0; c < 3; ++c)
        corners.col(c) = place_at_rest(
            world, surface.points()[std::size_t(surface.triangles()[std::size_t(f)].points[c])]);
      for (int i = 0; i < 6; ++i) {
        const Vec3d weights(share(random), share(random), share(random));
        const Vec3d x = corners * (weights / weights.sum());
        Vec3d y = x;  // but for the last digit of a coordinate
        y[i % 3] = std::nextafter(y[i % 3], i % 2 == 0 ? 1 : -1);
        const BoundaryLayer::Nearest nearest = layer.nearest_face(tet, x);
        if (nearest.face < 0 || !((y - x).norm() < nearest.room) || !layer.is_behind(nearest.face, y))
          continue;
        ++known;
        wrong += layer.nearest_face(tet, y).face != nearest.face;
      }
    }
  CHECK(known > 1000);
  CHECK(wrong == 0);
}
