#include "lobe/region/smoothed_edges.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <map>
#include <numeric>
#include <random>

#include "lobe/numerics/symmetric_eigen.h"
#include "lobe/solve/tangent.h"
#include "near.h"
#include "smoothed_support.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

EnergyAndForces of(const Setup& setup, const Mat3X<double>& u) {
  return energy_and_forces(Elements(setup), u);
}

// The energy as the headers of smoothed_edge.h and edge_pressures.h read, of SVK alone.
double energy_by_domains(const Setup& setup, const Mat3X<double>& u) {
  struct Domain {
    double volume = 0;
    Mat3<double> sum = Mat3<double>::Zero();
  };
  struct Node {
    double volume = 0, weighted = 0;
  };
  std::map<std::array<Index, 3>, Domain> domains;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const Shape s = shape(tet_points(setup.mesh, t));
    const Mat34<double> at = u(Eigen::all, setup.mesh.tets.col(t));
    const Mat3<double> H = displacement_gradient<double>(at, s.gradients.rightCols<3>());
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j) {
        const auto [a, b] = std::minmax(setup.mesh.tets(i, t), setup.mesh.tets(j, t));
        Domain& domain = domains[{a, b, setup.material_of[t]}];
        domain.volume += s.volume / 6;
        domain.sum += s.volume / 6 * H;
      }
  }
  double W = 0;
  std::map<std::pair<Index, Index>, Node> nodes;  // vertex, material
  for (const auto& [key, d] : domains) {
    const Elastic& m = setup.materials[std::size_t(key[2])];
    const Mat3<double> E = green_strain<double>(d.sum / d.volume);
    const double theta = E.trace();
    W += d.volume * ((1 - m.nodal_pressure) * m.lambda / 2 * theta * theta + m.mu * (E * E).trace());
    for (Index end : {key[0], key[1]}) {
      Node& node = nodes[{end, key[2]}];
      node.volume += d.volume / 2;
      node.weighted += d.volume / 2 * theta;
    }
  }
  for (const auto& [key, node] : nodes) {
    const Elastic& m = setup.materials[std::size_t(key.second)];
    W += m.nodal_pressure * m.lambda / 2 * node.weighted * node.weighted / node.volume;
  }
  return W;
}

// The stiffness at rest of what is left of a body.
Eigen::MatrixXd stiffness_at_rest(const Elements& elements) {
  const Unknowns there(elements.topology.vertex_count(),
                       [&](Index v, int) { return !elements.topology.around(v).empty(); });
  Tangent tangent(elements, there);
  tangent.update(Mat3X<double>::Zero(3, elements.topology.vertex_count()));
  return dense_stiffness(tangent, there.count);
}

int zero_modes(const Elements& elements) {
  const Eigen::VectorXd squares = symmetric_eigenvalues(stiffness_at_rest(elements));
  const double largest = squares.tail(1)[0];
  CHECK(squares[0] > -1e-10 * largest);
  return int((squares.array() < 1e-9 * largest).count());
}

// What a removal means for the regions.
RegionEdit remove(Elements& elements, const std::vector<Index>& tets) {
  const MeshEdit cut = elements.topology.remove(tets);
  elements.follow(cut);
  RegionEdit edit;
  for (const VertexSplit& split : cut.splits)
    edit.entered.insert(edit.entered.end(), split.tets.begin(), split.tets.end());
  std::sort(edit.entered.begin(), edit.entered.end());
  edit.entered.erase(std::unique(edit.entered.begin(), edit.entered.end()), edit.entered.end());
  edit.left = cut.removed;
  edit.left.insert(edit.left.end(), edit.entered.begin(), edit.entered.end());
  return edit;
}

}  // namespace

TEST_CASE("the energy of smoothed edges is the formula's, with averages that cross no material") {
  Setup setup = smoothed(setup_of(irregular_box()));
  setup.materials.push_back({9e4, 2e4, 1000});
  setup.materials.back().element = ElementType::edge_smoothed;
  for (Index t = 0; t < setup.mesh.tet_count(); t += 3) setup.material_of[t] = 1;
  const Mat3X<double> u = random_displacement(setup.mesh.vertex_count(), 2e-3);
  for (double share : {0.0, 1.0}) {
    const Setup with_pressure = averaged(setup, share);
    CHECK(of(with_pressure, u).energy == near(energy_by_domains(with_pressure, u), 1e-13));
  }
  CHECK(energy_by_domains(averaged(setup), u) < 0.98 * energy_by_domains(setup, u));  // Jensen
  Setup plain = setup;
  for (Elastic& elastic : plain.materials) elastic.element = ElementType::tetrahedron;
  CHECK(energy_by_domains(setup, u) < 0.9 * of(plain, u).energy);
}

TEST_CASE("with smoothed edges forces are minus the slope of the energy, of every law and at interfaces") {
  for (bool nodal_pressure : {false, true}) {
    const Setup setup = mixed_setup(irregular_box(2), nodal_pressure);
    const Elements elements(setup);
    const Mat3X<double> u = random_displacement(setup.mesh.vertex_count(), 1e-3);
    const Mat3X<double> f = energy_and_forces(elements, u).forces;
    const double h = 1e-7;
    for (Index i = 0; i < u.size(); ++i) {
      Mat3X<double> plus = u, minus = u;
      plus(i) += h;
      minus(i) -= h;
      const double slope =
          (energy_and_forces(elements, plus).energy - energy_and_forces(elements, minus).energy) / (2 * h);
      CHECK(std::abs(f(i) + slope) < 1e-7 * f.norm());
    }
  }
}

TEST_CASE("with smoothed edges an affine map gives the forces and the energy of plain tetrahedra") {
  const TetMesh mesh = irregular_box(4);
  Mat3<double> F;
  F << 1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.2, 0.1, 1.1;
  const Mat3X<double> u = affine_displacement(mesh.points, F);
  for (bool nodal_pressure : {false, true}) {
    Setup setup = mixed_setup(mesh, nodal_pressure);
    setup.mesh.fibres = Vec3d(1, 2, 2).normalized().replicate(1, mesh.tet_count());
    Setup plain = setup;
    for (Elastic& elastic : plain.materials) elastic.element = ElementType::tetrahedron;
    const EnergyAndForces found = of(setup, u), expected = of(plain, u);
    CHECK((found.forces - expected.forces).norm() < 1e-12 * expected.forces.norm());
    CHECK(found.energy == near(expected.energy, 1e-13));
  }
}

TEST_CASE("patch test across an interface of smoothed and plain tetrahedra: no force inside") {
  const TetMesh mesh = irregular_box(4);
  Setup setup = smoothed(setup_of(mesh));
  setup.materials.push_back(seed_material);
  for (Index t = 0; t < mesh.tet_count(); ++t) setup.material_of[t] = barycentre(mesh, t).x() > 0.018;
  const Mat3X<double> u = affine_displacement(mesh.points, Vec3d(1.2, 0.8, 1.1).asDiagonal());
  const Mat3X<double> f = of(setup, u).forces;
  std::vector<bool> outside(std::size_t(mesh.vertex_count()), false);
  const Topology topology(mesh);
  for (Index code : topology.boundary_faces())
    for (Index v : topology.face(code)) outside[std::size_t(v)] = true;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (!outside[std::size_t(v)]) CHECK(f.col(v).norm() < 1e-12 * f.colwise().norm().maxCoeff());
}

TEST_CASE("a lone smoothed tetrahedron is the plain one") {
  Setup plain = setup_of(irregular_box(1));
  plain.mesh.tets = Tets(plain.mesh.tets.leftCols(1));
  plain.mesh.labels.clear();
  plain.material_of.resize(1);
  plain.region_of.resize(1);
  plain.guard_below = 0.9;
  const Mat3X<double> u = random_displacement(plain.mesh.vertex_count(), 3e-3);
  const Eigen::MatrixXd K = stiffness_at_rest(Elements(plain));
  for (const Setup& setup : {smoothed(plain), smoothed(averaged(plain))}) {
    const EnergyAndForces expected = of(plain, u), found = of(setup, u);
    CHECK((found.forces - expected.forces).norm() < 1e-13 * expected.forces.norm());
    CHECK(found.energy == near(expected.energy, 1e-13));
    CHECK((stiffness_at_rest(Elements(setup)) - K).norm() < 1e-13 * K.norm());
  }
}

TEST_CASE("with smoothed edges there is no net force, no net moment, and forces turn with the body") {
  const TetMesh mesh = irregular_box(4);
  for (bool nodal_pressure : {false, true}) {
    const Setup setup = mixed_setup(mesh, nodal_pressure);
    const Mat3X<double> u = random_displacement(mesh.vertex_count(), 2e-3), f = of(setup, u).forces;
    CHECK(f.rowwise().sum().norm() < 1e-13 * f.norm());
    Vec3d moment = Vec3d::Zero();
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      moment += Vec3d(mesh.points.col(v) + u.col(v)).cross(Vec3d(f.col(v)));
    CHECK(moment.norm() < 1e-12 * f.norm() * 0.04);
    const Mat3<double> R = Eigen::AngleAxisd(2.0, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
    CHECK(of(setup, affine_displacement(mesh.points, R)).forces.norm() < 1e-11 * 1e4 * 0.01 * 0.01);
    const Mat3X<double> turned = R * (mesh.points + u) - mesh.points;
    CHECK((of(setup, turned).forces - R * f).norm() < 1e-12 * f.norm());
  }
}

TEST_CASE("after any cut the domains and their pressures are those of the cut mesh") {
  const TetMesh mesh = irregular_box(5);
  for (unsigned seed : {1u, 2u, 3u}) {
    Elements elements(mixed_setup(mesh, seed > 1));
    Averages followed(elements);
    std::mt19937 random(seed);
    std::uniform_int_distribution<Index> any(0, mesh.tet_count() - 1);
    for (int cut = 0; cut < 12; ++cut) {
      std::vector<Index> tets;
      for (int i = 0; i < (cut % 3 == 2 ? 60 : 1 + cut); ++i) tets.push_back(any(random));
      const RegionEdit edit = remove(elements, tets);
      const std::vector<Index> changed = followed.edges.follow(elements, edit.left, edit.entered);
      followed.edge_pressures.follow(elements, followed.edges, changed);
      followed.nodes.follow(elements, edit.left, edit.entered);
      const Mat3X<double> u = random_displacement(elements.topology.vertex_count(), 1e-3);
      const EnergyAndForces expected = energy_and_forces(elements, u);
      CHECK((energy_and_forces(elements, followed, u).forces - expected.forces).norm() <
            1e-13 * expected.forces.norm());
    }
    std::vector<Index> rest(std::size_t(mesh.tet_count()));
    std::iota(rest.begin(), rest.end(), 0);
    const RegionEdit edit = remove(elements, rest);
    followed.edge_pressures.follow(elements, followed.edges,
                                   followed.edges.follow(elements, edit.left, edit.entered));
    CHECK(!followed.edges.any());
    CHECK(!followed.edge_pressures.any());
  }
}

TEST_CASE("no cut leaves a spurious mode: smoothed bodies have those of plain tetrahedra, 100 at random") {
  std::mt19937 random(5);
  int more_than_rigid = 0;
  for (int body = 0; body < 100; ++body) {
    const Setup plain = setup_of(irregular_box(2, 0.01, unsigned(body + 1)));
    std::vector<Index> tets(std::size_t(plain.mesh.tet_count()));
    std::iota(tets.begin(), tets.end(), 0);
    std::shuffle(tets.begin(), tets.end(), random);
    tets.resize(tets.size() * std::size_t(1 + body % 9) / 10);
    Elements of_plain(plain), of_smoothed(smoothed(plain)), of_averaged(averaged(smoothed(plain)));
    for (Elements* elements : {&of_plain, &of_smoothed, &of_averaged}) remove(*elements, tets);
    const int modes = zero_modes(of_plain);
    more_than_rigid += modes > 6;
    CHECK(zero_modes(of_smoothed) == modes);
    CHECK(zero_modes(of_averaged) == modes);
  }
  CHECK(more_than_rigid > 20);  // pieces, and parts that hang by an edge or a vertex
}
