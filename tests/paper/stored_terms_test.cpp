// The paper's form of the non-linear model against the region that lobe runs.
#include "paper/stored_terms.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <limits>
#include <numeric>
#include <set>

#include "doubled.h"
#include "fibre_support.h"
#include "lobe/region/nonlinear.h"
#include "lobe/sim/world.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

std::vector<Index> all_tets(const Elements& elements) {
  std::vector<Index> tets(std::size_t(elements.topology.tet_count()));
  std::iota(tets.begin(), tets.end(), 0);
  return tets;
}

template <class Real, class Evaluator>
Mat3X<Real> forces_by(Evaluator& evaluator, const Mat3X<Real>& u, int threads = 1) {
  Mat3X<Real> f = Mat3X<Real>::Zero(3, u.cols());
  Parallel parallel(threads);
  evaluator.add_forces(u, f, parallel);
  return f;
}

template <class Real>
Mat3X<Real> stored_forces(const Setup& setup, const Mat3X<Real>& u, int threads = 1,
                          InstructionSet set = chosen_instruction_set()) {
  const Elements elements(setup);
  StoredTerms<Real> terms(set);
  terms.follow(elements, {}, all_tets(elements));
  return forces_by<Real>(terms, u, threads);
}

// Of the non-linear region alone.
Mat3X<double> direct_forces(const Setup& setup, const Mat3X<double>& u) {
  const Elements elements(setup);
  RegionEdit edit;
  edit.entered = all_tets(elements);
  edit.vertices.resize(std::size_t(setup.mesh.vertex_count()));
  std::iota(edit.vertices.begin(), edit.vertices.end(), 0);
  NonlinearRegion<double> region;
  region.follow(elements, edit);
  return forces_by<double>(region, u);
}

template <class A, class B>
double stored_gap(const A& a, const B& b) {
  return (a.template cast<double>() - b.template cast<double>()).norm() / b.template cast<double>().norm();
}

Mat3X<double> turned(const TetMesh& mesh, double angle, double moved) {
  const Mat3<double> R = Eigen::AngleAxisd(angle, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
  return R * (mesh.points + random_displacement(mesh.vertex_count(), moved)) - mesh.points;
}

// Removes tetrahedra of a world. Others may have other corners then, where a vertex was split, or another
// model, where a piece came loose; the terms follow them all.
template <class Real>
void remove_with(StoredTerms<Real>& terms, World<Real>& world, const std::vector<Index>& tets) {
  const Elements& elements = world.elements();
  std::vector<std::pair<bool, Eigen::Vector4i>> before;  // whether it is non-linear, and its corners
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    before.emplace_back(elements.is_in(RegionModel::nonlinear, t), elements.topology.corners(t));
  world.remove_tets(tets);
  std::vector<Index> left, entered;
  for (Index t = 0; t < Index(before.size()); ++t) {
    const std::pair now(elements.is_in(RegionModel::nonlinear, t),
                        Eigen::Vector4i(elements.topology.corners(t)));
    if (now == before[std::size_t(t)]) continue;
    if (before[std::size_t(t)].first) left.push_back(t);
    if (now.first) entered.push_back(t);
  }
  terms.follow(elements, left, entered);
}

std::vector<Index> middle_of(const TetMesh& mesh) {
  std::vector<Index> middle;
  for (Index t = 0; t < mesh.tet_count(); ++t)
    if (std::abs(barycentre(mesh, t).x() - 0.02) < 0.007) middle.push_back(t);
  return middle;
}

}  // namespace

TEST_CASE("stored terms and closed form have the same forces, alone, in a hybrid and with fibres") {
  const TetMesh mesh = irregular_box(4);
  const Mat3X<double> u = random_displacement(mesh.vertex_count(), 2e-3);
  Setup hybrid = hybrid_setup(mesh);
  hybrid.volume_penalty = 0;  // which the paper's form does not have
  for (const Setup& setup : {setup_of(mesh), hybrid, fibrous_setup(mesh)}) {
    const Mat3X<double> direct = direct_forces(setup, u);
    CHECK(stored_gap(stored_forces<double>(setup, u), direct) < 1e-12);
    CHECK(stored_gap(stored_forces<float>(setup, u.cast<float>()), direct) < 1e-6);
  }
}

TEST_CASE("stored forces are minus the slope of the region's energy") {
  const TetMesh mesh = irregular_box(2);
  const Mat3X<double> u = random_displacement(mesh.vertex_count(), 2e-3);
  for (const Setup& setup : {setup_of(mesh), fibrous_setup(mesh)}) {
    const Mat3X<double> f = stored_forces<double>(setup, u);
    const double h = 1e-7;  // [m]
    for (Index i = 0; i < u.size(); ++i) {
      Mat3X<double> plus = u, minus = u;
      plus(i) += h;
      minus(i) -= h;
      const double slope = (elastic_energy(setup, plus) - elastic_energy(setup, minus)) / (2 * h);
      CHECK(f(i) == near(-slope, 1e-5, f.norm()));
    }
  }
}

TEST_CASE("patch test of stored terms: an affine map gives no force inside") {
  const TetMesh mesh = irregular_box(4);
  std::vector<bool> is_inner(std::size_t(mesh.vertex_count()), true);
  const Topology topology(mesh);
  for (Index code : topology.boundary_faces())
    for (Index v : topology.face(code)) is_inner[std::size_t(v)] = false;
  REQUIRE(std::count(is_inner.begin(), is_inner.end(), true) > 0);
  Mat3<double> F;
  F << 1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.2, 0.1, 1.1;
  const Mat3X<double> u = affine_displacement(mesh.points, F);
  Setup fibrous = fibrous_setup(mesh);
  fibrous.mesh.fibres.colwise() = Vec3d(2, -1, 0.5).normalized();
  for (const Setup& setup : {setup_of(mesh), fibrous}) {
    const Mat3X<double> f = stored_forces<double>(setup, u);
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (is_inner[std::size_t(v)]) CHECK(f.col(v).norm() < 1e-12 * f.colwise().norm().maxCoeff());
  }
}

TEST_CASE("a rigid motion gives no stored force but what rounding leaves") {
  const TetMesh mesh = irregular_box();
  const double scale = 1e4 * 0.01 * 0.01;  // μ × area of a face
  CHECK(stored_forces<double>(setup_of(mesh), turned(mesh, 2.0, 0)).norm() < 1e-10 * scale);
}

TEST_CASE_TEMPLATE("stored forces add up to nothing, also of a body that has turned far", Real, float,
                   double) {
  const TetMesh mesh = irregular_box();
  const Mat3X<Real> u = turned(mesh, 2.0, 1e-5).template cast<Real>();
  const Mat3X<double> f = stored_forces<Real>(setup_of(mesh), u).template cast<double>();
  CHECK(f.rowwise().sum().norm() < std::numeric_limits<Real>::epsilon() * f.colwise().norm().sum());
}

TEST_CASE("a body that has moved and turned far away feels the same stored forces") {
  const TetMesh mesh = irregular_box(4);  // edges of 0.01
  const Setup setup = setup_of(mesh);
  const Mat3X<float> u = (turned(mesh, 2.5, 5e-4).colwise() + Vec3d(0.3, -0.2, 0.1)).cast<float>();
  const Mat3X<double> exact = direct_forces(setup, u.cast<double>());
  CHECK(stored_gap(stored_forces<double>(setup, u.cast<double>()), exact) < 1e-11);
  // (4 edges)³ roundings of 6e-8, less what the way does that it has moved
  CHECK(stored_gap(stored_forces<float>(setup, u), exact) < 1e-3);
  Mat3X<float> only_moved = random_displacement<float>(mesh.vertex_count(), 5e-4);
  const Mat3X<float> near = stored_forces<float>(setup, only_moved);
  only_moved.colwise() += Vec3<float>(0.25f, -0.5f, 1);
  CHECK(stored_gap(stored_forces<float>(setup, only_moved), near) < 1e-3);  // u itself has 1e-7 of 5e-4
}

TEST_CASE("parts that a cut has left of a patch feel the same stored forces however far they fly apart") {
  const Setup setup = setup_of(irregular_box(4));
  World<float> world(setup);
  StoredTerms<float> terms;
  terms.follow(world.elements(), {}, all_tets(world.elements()));
  remove_with(terms, world, middle_of(setup.mesh));
  const Topology& topology = world.elements().topology;
  const std::vector<std::vector<Index>> pieces = topology.pieces();
  REQUIRE(pieces.size() == 2);
  Mat3X<float> u = random_displacement<float>(topology.vertex_count(), 5e-4);
  const Mat3X<float> near = forces_by<float>(terms, u);
  std::set<Index> moved;
  for (Index t : pieces[1])
    for (Index v : topology.corners(t)) moved.insert(v);
  for (Index v : moved) u.col(v) += Vec3<float>(0.25f, -0.5f, 1);
  CHECK(stored_gap(forces_by<float>(terms, u), near) < 1e-3);  // u itself has 1e-7 of 5e-4
}

TEST_CASE("stored terms that have followed removals are those built afresh, down to nothing") {
  const Setup setup = hybrid_setup(irregular_box(2));
  World<double> world(setup);
  StoredTerms<double> terms;
  terms.follow(world.elements(), {}, all_tets(world.elements()));
  std::vector<Index> order = all_tets(world.elements());
  std::shuffle(order.begin(), order.end(), std::mt19937(5));
  const double scale =
      stored_forces<double>(setup, random_displacement(setup.mesh.vertex_count(), 2e-3)).norm();
  for (Index t : order) {
    remove_with(terms, world, {t});
    StoredTerms<double> fresh;
    std::vector<Index> left;
    for (Index other = 0; other < setup.mesh.tet_count(); ++other)
      if (world.elements().is_in(RegionModel::nonlinear, other)) left.push_back(other);
    fresh.follow(world.elements(), {}, left);
    const Mat3X<double> u = random_displacement(world.elements().topology.vertex_count(), 2e-3);
    CHECK((forces_by<double>(terms, u) - forces_by<double>(fresh, u)).norm() < 1e-12 * scale);
  }
}

TEST_CASE("stored terms of doubled tetrahedra that share their volume are those of the plain ones") {
  for (const Setup& setup : {setup_of(irregular_box()), fibrous_setup(irregular_box())}) {
    const Mat3X<double> u = random_displacement(setup.mesh.vertex_count(), 1e-3);
    CHECK(stored_gap(stored_forces<double>(doubled(setup), u), stored_forces<double>(setup, u)) < 1e-12);
  }
}

TEST_CASE_TEMPLATE("stored forces have the same bits on one and two threads and every instruction set", Real,
                   float, double) {
  const Setup setup = setup_of(irregular_box(14));  // 16,464 tetrahedra: more than one range of work
  const Mat3X<Real> u = random_displacement<Real>(setup.mesh.vertex_count(), 2e-3);
  const Mat3X<Real> f = stored_forces<Real>(setup, u);
  CHECK(f.norm() > 0);
  CHECK(stored_forces<Real>(setup, u, 2) == f);
  for (InstructionSet set : available_instruction_sets()) {
    CAPTURE(name(set));
    CHECK(stored_forces<Real>(setup, u, 1, set) == f);
  }
}
