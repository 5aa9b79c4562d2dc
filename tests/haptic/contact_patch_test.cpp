#include "lobe/haptic/contact_patch.h"

#include <doctest/doctest.h>

#include "benchmarks/static_stiffness.h"
#include "lobe/haptic/contact_stiffness.h"
#include "lobe/numerics/symmetric_eigen.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Setup held_block(int cells) {
  Setup setup = hybrid_setup(irregular_box(cells));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

std::vector<Index> top_of(const Setup& setup, double radius) {
  const Vec3d top(0.025, 0.025, 0.05);
  std::vector<Index> contact;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if ((setup.mesh.points.col(v) - top).norm() < radius) contact.push_back(v);
  return contact;
}

std::function<Vec3d(Index)> displacement_of(World<double>& world) {
  return [u = Mat3X<double>(world.displacements())](Index v) -> Vec3d { return u.col(v); };
}

// A tool on the top of a block at rest, and how stiff it finds it.
struct TouchedBlock {
  static constexpr double frame = 1.0 / 120;  // [s]
  Setup setup = held_block(5);
  World<double> world{setup};
  std::vector<Index> contact = top_of(setup, 0.012);
  ContactStiffness stiffness{{.has_helper = false}};
  Vec3d position = Vec3d::Zero(), force = Vec3d::Zero();

  // A frame in which the tool goes this way and its force changes so.
  void move(const Vec3d& way, const Vec3d& change, double expected = 1) {
    position += way;
    force += change;
    stiffness.after_frame(world.body().model, contact, displacement_of(world), position, force, frame,
                          {.share = expected});
  }
  void rest(double expected = 1) { move(Vec3d::Zero(), Vec3d::Zero(), expected); }

  template <class Where>
  void cut(Where&& where) {  // what has its barycentre there
    RemoveTets cut;
    for (Index t = 0; t < setup.mesh.tet_count(); ++t)
      if (where(barycentre(setup.mesh, t))) cut.tets.push_back(t);
    REQUIRE(!cut.tets.empty());
    world.apply(cut);
  }
};

const auto below_contact = [](const Vec3d& at) { return std::abs(at.z() - 0.035) < 0.006 && at.x() < 0.03; };
const auto layer = [](const Vec3d& at) { return std::abs(at.z() - 0.035) < 0.006; };
const auto far_off = [](const Vec3d& at) { return at.norm() < 0.012; };

}  // namespace

TEST_CASE("a patch of everything has the stiffness of the body in balance, plain or smoothed") {
  for (const ElementType element : {ElementType::tetrahedron, ElementType::edge_smoothed}) {
    CAPTURE(int(element));
    Setup setup = held_block(5);
    setup.materials[0].element = element;
    setup.volume_penalty = 1e5;
    setup.gravity = {0, 0, -9.81};
    World<double> world(setup);
    world.advance(0.02);
    REQUIRE(Mat3X<double>(world.displacements()).norm() > 1e-4);
    const std::vector<Index> contact = top_of(setup, 0.012);
    REQUIRE(contact.size() >= 4);
    ContactPatch patch;
    patch.gather(world.body().model, contact, displacement_of(world), {.reach = 1, .most_free = 100000});
    const Mat3<double> exact = bench::static_stiffness(world, contact);
    CHECK((patch.condense() - exact).norm() < 1e-6 * exact.norm());
  }
}

TEST_CASE("a cut of what only a domain of a patch reaches is a cut of the patch") {
  Setup setup = held_block(5);
  const std::vector<Index> contact{top_of(setup, 0.012).at(0)};
  // At the tetrahedra of the contact, not at the contact.
  const auto is_next = [&](const World<double>& world, Index t) {
    const Topology& topology = world.elements().topology;
    int shared = 0;
    for (Index other : topology.around(contact[0])) {
      if (other == t) return false;
      int corners = 0;
      for (Index v : topology.corners(other)) corners += (topology.corners(t).array() == v).any();
      shared = std::max(shared, corners);
    }
    return shared == 3;
  };
  for (const ElementType element : {ElementType::tetrahedron, ElementType::edge_smoothed}) {
    setup.materials[0].element = element;
    World<double> world(setup);
    ContactPatch patch;
    patch.gather(world.body().model, contact, displacement_of(world), {.reach = 0});
    REQUIRE(patch.free_count() == 0);
    CHECK_FALSE(patch.is_cut(world.elements().topology));
    RemoveTets cut;
    for (Index t = 0; t < setup.mesh.tet_count() && cut.tets.empty(); ++t)
      if (is_next(world, t)) cut.tets = {t};
    REQUIRE(cut.tets.size() == 1);
    world.apply(cut);
    CHECK(patch.is_cut(world.elements().topology) == (element == ElementType::edge_smoothed));
  }
}

TEST_CASE("the smaller the patch, the stiffer; nothing is stiffer than the contact alone") {
  const Setup setup = held_block(6);
  World<double> world(setup);
  const std::vector<Index> contact = top_of(setup, 0.012);
  ContactPatch patch;
  double before = 0;
  for (double reach : {0.0, 0.01, 0.02, 0.03, 1.0}) {
    patch.gather(world.body().model, contact, displacement_of(world), {.reach = reach, .most_free = 100000});
    const Mat3<double> blocked = patch.blocked();
    const Mat3<double> K = patch.condense();
    const Vec3d values = symmetric_eigenvalues(K);
    CHECK(values[0] > 0);
    CHECK(values[2] <= highest_eigenvalue(blocked) * (1 + 1e-12));
    if (before > 0) CHECK(K.trace() < before);
    before = K.trace();
  }
}

TEST_CASE("a stiffness is kept within shares of another in every direction") {
  Mat3<double> A;
  A << 900, 100, 0, 100, 400, 50, 0, 50, 300;
  CHECK((clamped_to(0.7 * A, A, 0.25, 1.25) - 0.7 * A).norm() < 1e-9 * A.norm());
  CHECK((clamped_to(9 * A, A, 0.25, 1.25) - 1.25 * A).norm() < 1e-9 * A.norm());
  CHECK((clamped_to(-A, A, 0.25, 1.25) - 0.25 * A).norm() < 1e-9 * A.norm());
  const Mat3<double> K = clamped_to(Vec3d(5000, 500, 1).asDiagonal(), A, 0.25, 1.25);
  for (const Vec3d& d : {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1), Vec3d(1, -2, 3)}) {
    CHECK(d.dot(K * d) <= (1.25 + 1e-9) * d.dot(A * d));
    CHECK(d.dot(K * d) >= (0.25 - 1e-9) * d.dot(A * d));
  }
  CHECK(clamped_to(A, Mat3<double>::Zero(), 0.25, 1.25).norm() == 0);
}

TEST_CASE("a patch has no more vertices than are asked for, and the same ones each time") {
  const Setup setup = held_block(6);
  World<double> world(setup);
  const std::vector<Index> contact = top_of(setup, 0.012);
  ContactPatch patch, used;
  used.gather(world.body().model, {contact.data(), 1}, displacement_of(world), {.reach = 1});
  for (ContactPatch* each : {&patch, &used})
    each->gather(world.body().model, contact, displacement_of(world), {.reach = 1, .most_free = 40});
  CHECK(patch.free_count() == 40);
  CHECK(patch.condense() == used.condense());
}

TEST_CASE("motion in one direction says how stiff the others are, and what K does not explain is the rate") {
  TouchedBlock block;
  ContactStiffness& stiffness = block.stiffness;
  block.rest();
  const Mat3<double> patch = stiffness.K();
  REQUIRE(patch.norm() > 0);
  const Vec3d way = 5e-4 * Vec3d(1, 2, -2).normalized(), across = 5e-4 * Vec3d(2, -1, 0).normalized();
  for (int i = 0; i < 10; ++i) block.move(way, -0.3 * patch * way);
  CHECK((stiffness.K() - 0.3 * patch).norm() < 1e-4 * patch.norm());
  CHECK(stiffness.rate().norm() * block.frame < 1e-4 * (patch * way).norm());
  block.move(Vec3d::Zero(), {0.01, 0, 0});
  CHECK((stiffness.rate() - Vec3d(0.01, 0, 0) / block.frame).norm() < 1e-9);
  CHECK((stiffness.K() - 0.3 * patch).norm() < 1e-4 * patch.norm());  // rest says nothing of K
  // A body that is stiffer across: all frames count, those before less.
  const Vec3d y = patch * across.normalized();
  const Mat3<double> K = 0.3 * patch + 0.3 / y.dot(across.normalized()) * y * y.transpose();
  for (int i = 0; i < 20; ++i) {
    block.move(across, -K * across);
    block.move(-0.5 * way, 0.5 * K * way);
  }
  CHECK(((stiffness.K() - K) * across).norm() < 0.15 * (K * across).norm());
  CHECK(((stiffness.K() - K) * way).norm() < 0.15 * (K * way).norm());
  stiffness.forget();
  CHECK(stiffness.rate().norm() == 0);
}

TEST_CASE("before any motion the stiffness of a contact is the share of the patch that is expected") {
  const auto after_rest = [&](double expected) {
    TouchedBlock block;
    for (int i = 0; i < 2; ++i) block.rest(expected);
    return block.stiffness.K();
  };
  REQUIRE(after_rest(1).norm() > 0);
  CHECK((after_rest(0.25) - 0.25 * after_rest(1)).norm() < 1e-9 * after_rest(1).norm());
}

TEST_CASE("a tool that is about to touch expects its share of the patch, and learns from where it begins") {
  TouchedBlock block;
  ContactStiffness& stiffness = block.stiffness;
  const auto before_touch = [&](double expected) {
    stiffness.before_touch(block.world.body().model, block.contact, displacement_of(block.world), block.frame,
                           {.share = expected});
  };
  before_touch(1);
  const Mat3<double> patch = stiffness.K();
  REQUIRE(patch.norm() > 0);
  before_touch(0.25);
  CHECK((stiffness.K() - 0.25 * patch).norm() < 1e-12 * patch.norm());
  CHECK(stiffness.rate().norm() == 0);
  const Vec3d way(0, 0, -5e-4);
  block.position = {0.01, 0.02, 0.03};
  stiffness.begin_at(block.position);
  block.move(way, -0.4 * patch * way, 0.25);
  CHECK((stiffness.K() - 0.4 * patch).norm() < 1e-3 * patch.norm());
}

TEST_CASE(
    "what is expected of a touch is no stiffer along the normal than asked, and no softer than a patch") {
  TouchedBlock block;
  const Vec3d normal = Vec3d(0.3, -0.2, 1).normalized();
  const auto along_normal = [&](double share, double most) {
    block.stiffness.before_touch(block.world.body().model, block.contact, displacement_of(block.world),
                                 block.frame, {.share = share, .most = most, .normal = normal});
    return normal.dot(block.stiffness.K() * normal);
  };
  const double patch = along_normal(1, 1e9);
  REQUIRE(patch > 0);
  CHECK(along_normal(0.25, 0.2 * patch) == near(0.2 * patch, 1e-9));
  CHECK(along_normal(0.25, 0.3 * patch) == near(0.25 * patch, 1e-9));
  const double softest = ContactStiffness::Settings{}.softest;
  CHECK(along_normal(0.25, 0) == near(softest * patch, 1e-9));
}

TEST_CASE("what a cut of the patch takes away is no rate and no stiffness; a cut elsewhere changes nothing") {
  const Vec3d way = 5e-4 * Vec3d(1, 2, -2).normalized(), jump(0, 0, -0.2);
  for (const bool is_near : {true, false}) {
    CAPTURE(is_near);
    TouchedBlock block;
    const ContactStiffness& stiffness = block.stiffness;
    block.rest();
    const Mat3<double> patch = stiffness.K();
    for (int i = 0; i < 10; ++i) block.move(way, -0.3 * patch * way);
    if (is_near)
      block.cut(below_contact);
    else
      block.cut(far_off);
    block.move(way, is_near ? jump : Vec3d(-0.3 * patch * way));
    if (!is_near) {
      CHECK((stiffness.K() - 0.3 * patch).norm() < 1e-4 * patch.norm());
      block.move(Vec3d::Zero(), jump);
      CHECK((stiffness.rate() - jump / block.frame).norm() < 1e-9);
      continue;
    }
    const Mat3<double> K = stiffness.K();  // of the patch that is left
    CHECK(K.trace() > 0.01 * patch.trace());
    CHECK(symmetric_eigenvalues(Mat3<double>(patch - K))[0] > 0);
    for (int i = 0; i < 2; ++i) {
      CHECK(stiffness.rate().norm() == 0);
      CHECK(stiffness.K() == K);
      block.move(way, jump);
    }
    CHECK(stiffness.rate().norm() > 0.5 * jump.norm() / block.frame);
    CHECK(stiffness.K() != K);
  }
}

TEST_CASE("the force of a loose piece has no rate where it is held, but where it is pushed") {
  TouchedBlock block;
  const ContactStiffness& stiffness = block.stiffness;
  const Vec3d change(0.01, -0.02, 0.05), normal(0, 0, 1);
  block.rest();
  const double before = stiffness.K().norm();
  block.cut(layer);
  for (int i = 0; i < 3; ++i) block.move(Vec3d::Zero(), change);
  CHECK(stiffness.K().norm() < 1e-6 * before);
  CHECK(stiffness.rate().norm() == 0);
  CHECK((stiffness.rate_of_push(normal) - change / block.frame).norm() < 1e-9);
}

TEST_CASE("of a tool that only pushes, the rate is what its stiffness along the normal does not explain") {
  TouchedBlock block;
  const ContactStiffness& stiffness = block.stiffness;
  const double frame = block.frame;
  const Vec3d way(3e-4, 1e-4, -5e-4), change(0.01, -0.02, 0.05), normal = Vec3d(0.1, 0.2, 1).normalized();
  block.rest();
  block.move(way, change);
  const Mat3<double>& K = stiffness.K();
  const Vec3d explained = -normal.dot(K * normal) * normal.dot(way) * normal;
  CHECK((stiffness.rate_of_push(normal) - (change - explained) / frame).norm() <
        1e-9 * change.norm() / frame);
  CHECK((stiffness.rate() - (change + K * way) / frame).norm() < 1e-9 * change.norm() / frame);
}

TEST_CASE("with a helper the stiffness of a contact is what it is without, a little later") {
  const Setup setup = held_block(5);
  World<double> world(setup);
  const std::vector<Index> contact = top_of(setup, 0.012);
  ContactStiffness alone({.has_helper = false}), helped({});
  const auto frame = [&](ContactStiffness& stiffness) {
    stiffness.after_frame(world.body().model, contact, displacement_of(world), Vec3d::Zero(), Vec3d::Zero(),
                          1.0 / 120);
  };
  frame(alone);
  CHECK(alone.K().norm() > 0);
  for (int i = 0; i < 60000 && helped.K() != alone.K(); ++i) {
    frame(helped);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  CHECK(helped.K() == alone.K());
  // Of a cut it knows at first that it makes none stiffer.
  RemoveTets cut;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (below_contact(barycentre(setup.mesh, t))) cut.tets.push_back(t);
  world.apply(cut);
  const Mat3<double> before = helped.K();
  frame(helped);
  CHECK((helped.K() - before).norm() < 1e-9 * before.norm());
  helped.forget();
  CHECK(helped.K().norm() == 0);
}
