#include "lobe/diagnostics/fields.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "folder.h"
#include "lobe/region/nodal_pressure.h"
#include "lobe/sim/world.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double lambda = seed_material.lambda, mu = seed_material.mu;
const Mat3<double> I = Mat3<double>::Identity();

// The body of all these tests, whose every tetrahedron has another shape.
Elements elements(RegionModel model, double volume_penalty = 0) {
  Setup setup = setup_of(irregular_box(2), model);
  setup.volume_penalty = volume_penalty;
  return Elements(setup);
}

// The fields of one tetrahedron when the body is deformed by x = F X.
TetFields fields_at(const Elements& body, const Mat3<double>& F, Index tet = 5) {
  return tet_fields(body, tet, (F - I) * body.corner_points(tet), 0);
}

Mat3<double> rotation(double angle) { return Eigen::AngleAxisd(angle, Vec3d::UnitZ()).toRotationMatrix(); }

void check_equal(const Mat3<double>& found, const Mat3<double>& expected, double scale) {
  CAPTURE(found);
  CAPTURE(expected);
  CHECK((found - expected).norm() < 1e-12 * scale);
}

}  // namespace

TEST_CASE("a non-linear tetrahedron stretched along x has the strain and Cauchy stress of the formula") {
  for (const double stretch : {1.5, 0.8}) {
    const TetFields fields =
        fields_at(elements(RegionModel::nonlinear), Vec3d(stretch, 1, 1).asDiagonal().toDenseMatrix());
    const double E = (stretch * stretch - 1) / 2;
    const double along = stretch * (lambda + 2 * mu) * E, across = lambda * E / stretch;  // F S Fᵀ / det F
    CHECK(fields.volume_ratio == near(stretch, 1e-13));
    check_equal(fields.strain, Vec3d(E, 0, 0).asDiagonal().toDenseMatrix(), 1);
    check_equal(fields.stress, Vec3d(along, across, across).asDiagonal().toDenseMatrix(), lambda);
    CHECK(fields.von_mises == near(std::abs(along - across), 1e-12));
  }
}

TEST_CASE("the volume term adds the pressure κ v|v| to the stress, of the sign of the change of volume") {
  for (const double stretch : {1.5, 0.8}) {
    const Mat3<double> F = Vec3d(stretch, 1, 1).asDiagonal().toDenseMatrix();
    const TetFields without = fields_at(elements(RegionModel::nonlinear), F);
    const TetFields with = fields_at(elements(RegionModel::nonlinear, 1e5), F);
    const double v = stretch - 1;
    check_equal(with.stress, without.stress + 1e5 * v * std::abs(v) * I, lambda);
    CHECK(with.von_mises == near(without.von_mises, 1e-12));
  }
}

TEST_CASE("with nodal pressure the stresses are those that give the forces on the vertices") {
  Setup setup = averaged(hybrid_setup(irregular_box(2)));
  setup.region_of.assign(setup.region_of.size(), RegionModel::nonlinear);
  World<double> world(setup);
  State<double> state = world.state();
  state.u = random_displacement(state.u.cols(), 1e-3);
  world.set_state(state);
  const Elements& body = world.elements();
  const std::vector<double> pressures = tet_pressures(body, PressureNodes(body), state.u);
  Mat3X<double> f = Mat3X<double>::Zero(3, state.u.cols());
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const Shape s = body.shape_of(t);
    const Mat34<double> u = state.u(Eigen::all, setup.mesh.tets.col(t));
    const TetFields fields = tet_fields(body, t, u, pressures[t]);
    const Mat3<double> F = I + displacement_gradient<double>(u, s.gradients.rightCols<3>());
    const Mat3<double> P = fields.stress * F.inverse().transpose() * F.determinant();
    f(Eigen::all, setup.mesh.tets.col(t)) -= s.volume * P * s.gradients;
  }
  CHECK((f - world.forces()).norm() < 1e-13 * f.norm());
}

TEST_CASE("a rotation strains no non-linear tetrahedron, and turns the stress of a stretched one") {
  const Elements body = elements(RegionModel::nonlinear, 1e5);
  const Mat3<double> R = rotation(2), stretch = Vec3d(1.2, 0.9, 1).asDiagonal().toDenseMatrix();
  const TetFields turned = fields_at(body, R);
  check_equal(turned.strain, Mat3<double>::Zero(), 1);
  check_equal(turned.stress, Mat3<double>::Zero(), lambda);
  CHECK(turned.volume_ratio == near(1, 1e-13));
  CHECK(turned.von_mises < 1e-12 * lambda);
  const TetFields still = fields_at(body, stretch), both = fields_at(body, R * stretch);
  check_equal(both.strain, still.strain, 1);
  check_equal(both.stress, R * still.stress * R.transpose(), lambda);
  CHECK(both.von_mises == near(still.von_mises, 1e-12));
}

TEST_CASE("a linear tetrahedron has Hooke's stress, whatever the volume penalty") {
  const double shear = 0.3;
  Mat3<double> F = I;
  F(0, 1) = shear;
  for (const double penalty : {0.0, 1e5}) {
    const TetFields fields = fields_at(elements(RegionModel::tensor_mass, penalty), F);
    Mat3<double> strain = Mat3<double>::Zero();
    strain(0, 1) = strain(1, 0) = shear / 2;
    check_equal(fields.strain, strain, 1);
    check_equal(fields.stress, 2 * mu * strain, lambda);
    CHECK(fields.von_mises == near(std::sqrt(3.0) * mu * shear, 1e-12));
    CHECK(fields.volume_ratio == near(1, 1e-13));
  }
}

TEST_CASE("a linear tetrahedron takes a rotation for a shrinking: the error that the hybrid model avoids") {
  const double shrinking = std::cos(0.5) - 1;
  const TetFields fields = fields_at(elements(RegionModel::tensor_mass), rotation(0.5));
  check_equal(fields.strain, Vec3d(shrinking, shrinking, 0).asDiagonal().toDenseMatrix(), 1);
  const double side = (2 * lambda + 2 * mu) * shrinking, top = 2 * lambda * shrinking;
  check_equal(fields.stress, Vec3d(side, side, top).asDiagonal().toDenseMatrix(), lambda);
}

TEST_CASE("the current volume is det F times that at rest, without what was removed") {
  Elements body = elements(RegionModel::nonlinear);
  Mat3<double> F;
  F << 1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.2, 0.1, 1.1;
  const Mat3X<double> u = affine_displacement(body.points.view(), F);
  const double at_rest = total_volume(irregular_box(2));
  CHECK(current_volume(body, u) == near(F.determinant() * at_rest, 1e-12));
  const double removed = body.shape_of(0).volume;
  body.topology.remove(std::vector<Index>{0});
  REQUIRE(body.topology.vertex_count() == body.points.count());  // no vertex was split
  CHECK(current_volume(body, u) == near(F.determinant() * (at_rest - removed), 1e-12));
}

TEST_CASE("a frame's stress holds the nodal pressure") {
  const Folder folder;
  const Setup setup = averaged(setup_of(irregular_box(2)));
  const Elements body(setup);
  const Mat3X<double> u = random_displacement(body.points.count(), 1e-3);
  write_frame(folder.path / "frame.vtu", body, u, 0 * u);
  const MeshFile frame = read_mesh(folder.path / "frame.vtu");
  const std::vector<double> pressures = tet_pressures(body, PressureNodes(body), u);
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const Mat34<double> corners = u(Eigen::all, setup.mesh.tets.col(t));
    const TetFields fields = tet_fields(body, t, corners, pressures[t]);
    CHECK(frame.cell_data.at("stress")(0, t) == near(fields.stress(0, 0), 1e-6));
  }
}

TEST_CASE("a frame says which tetrahedra a lattice moves: those of four embedded vertices") {
  const Folder folder;
  const Elements body = elements(RegionModel::reduced);
  const Mat3X<double> u = Mat3X<double>::Zero(3, body.points.count());
  const Eigen::Vector4i first = body.topology.tets().col(0);
  std::vector<std::uint8_t> is_embedded(std::size_t(body.points.count()), 0);
  for (const Index v : first) is_embedded[std::size_t(v)] = 1;
  write_frame(folder.path / "frame.vtu", body, u, u, is_embedded);
  const Eigen::MatrixXd embedded = read_mesh(folder.path / "frame.vtu").cell_data.at("embedded");
  REQUIRE(embedded.cols() == body.topology.tet_count());
  CHECK(embedded(0, 0) == 1);
  CHECK(embedded.sum() == 1);
  write_frame(folder.path / "frame.vtu", body, u, u);
  CHECK_FALSE(read_mesh(folder.path / "frame.vtu").cell_data.contains("embedded"));
}

TEST_CASE("a frame holds the arrays that its page promises, tensors as xx, yy, zz, xy, yz, xz") {
  const Folder folder;
  Elements body = elements(RegionModel::nonlinear);
  for (Index t = 0; t < body.topology.tet_count(); ++t) body.labels.push_back(t % 3);
  body.region_of[7] = RegionModel::tensor_mass;
  body.topology.remove(std::vector<Index>{0});
  REQUIRE(body.topology.vertex_count() == body.points.count());
  Mat3<double> F;
  F << 1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.2, 0.1, 1.1;
  const Mat3X<double> u = affine_displacement(body.points.view(), F), v = 2 * u;
  write_frame(folder.path / "frame.vtu", body, u, v);
  const MeshFile frame = read_mesh(folder.path / "frame.vtu");
  CHECK(frame.mesh.points == body.points.view());
  CHECK(frame.mesh.tets == body.topology.tets().rightCols(body.topology.tet_count() - 1));
  CHECK(frame.point_data.at("displacement") == u);
  CHECK(frame.point_data.at("velocity") == v);
  for (Index t = 1; t < body.topology.tet_count(); ++t) {
    const Index at = t - 1;
    const TetFields fields = fields_at(body, F, t);
    CHECK(frame.mesh.labels[std::size_t(at)] == t % 3);
    CHECK(frame.cell_data.at("source")(0, at) == t);
    CHECK(frame.cell_data.at("region")(0, at) == (t == 7 ? 0 : 2));
    CHECK(frame.cell_data.at("density")(0, at) == 1000);
    CHECK(frame.cell_data.at("volume_ratio")(0, at) == near(fields.volume_ratio, 1e-6));
    CHECK(frame.cell_data.at("von_mises")(0, at) == near(fields.von_mises, 1e-6));
    const auto six = [](const Mat3<double>& a) {
      return Eigen::Matrix<double, 6, 1>{a(0, 0), a(1, 1), a(2, 2), a(0, 1), a(1, 2), a(0, 2)};
    };
    CHECK(frame.cell_data.at("strain").col(at).isApprox(six(fields.strain), 1e-6));
    CHECK(frame.cell_data.at("stress").col(at).isApprox(six(fields.stress), 1e-6));
  }
}
