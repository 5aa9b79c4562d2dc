#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "lattice_support.h"
#include "lobe/fem/hooke.h"
#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/numerics/symmetric_eigen.h"
#include "lobe/solve/tangent.h"

using namespace lobe;
using namespace lobe::test;

namespace {

double stress_scale(const EmbeddedBox& box) {  // μ × face of a cell [N]
  return 1e4 * box.lattice.frame.edge * box.lattice.frame.edge;
}

// A smooth field that is neither linear nor trilinear.
Mat3X<double> bent(const Mat3X<double>& X, double size) {
  Mat3X<double> u(3, X.cols());
  for (Index i = 0; i < X.cols(); ++i) {
    const Vec3d x = X.col(i) / 0.16;
    u.col(i) = size * Vec3d(std::sin(3 * x.y()), x.x() * x.z(), std::cos(2 * x.x()) * x.y());
  }
  return u;
}

double energy_of_tets(const EmbeddedBox& box, const Mat3X<double>& u) {
  double sum = 0;
  for (Index t = 0; t < box.elements.topology.tet_count(); ++t) {
    const Shape s = box.elements.shape_of(t);
    const Mat34<double> corners = u(Eigen::all, box.elements.topology.corners(t));
    sum += s.volume * law_energy_density(nonlinear_law(box.elements, t),
                                         displacement_gradient<double>(corners, s.gradients.rightCols<3>()));
  }
  return sum;
}

}  // namespace

TEST_CASE("an affine map of a lattice has the exact energy") {
  const EmbeddedBox box;
  Mat3<double> F;
  F << 1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.2, 0.1, 1.1;
  const double exact =
      total_volume(box.setup.mesh) *
      law_energy_density(nonlinear_law(box.elements, 0), Mat3<double>(F - Mat3<double>::Identity()));
  CHECK(box.cells().energy(affine_displacement(box.lattice.nodes, F)) == near(exact, 1e-12));
}

TEST_CASE("a rotation of a lattice gives no force and no energy; a translation gives none to the last bit") {
  const EmbeddedBox box;
  auto cells = box.cells();
  const Mat3<double> R = Eigen::AngleAxisd(2.0, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
  const Mat3X<double> q = affine_displacement(box.lattice.nodes, R);
  CHECK(box.forces(cells, q).cwiseAbs().maxCoeff() < 1e-12 * stress_scale(box));
  CHECK(cells.energy(q) < 1e-15 * 1e4 * total_volume(box.setup.mesh));
  const Mat3X<double> translation = Vec3d(0.3, -0.1, 0.7).replicate(1, q.cols());
  CHECK(box.forces(cells, translation).isZero(0));
}

TEST_CASE("forces of a lattice are minus the slope of its energy, also where the guard acts") {
  for (double guard : {0.0, 0.9}) {
    Setup setup = reduced_setup(irregular_box(4), 0.02);
    setup.guard_below = guard;
    const EmbeddedBox box(std::move(setup), 1e5);
    auto cells = box.cells();
    const Mat3X<double> q = random_displacement(box.lattice.node_count(), 0.002);
    const Mat3X<double> f = box.forces(cells, q);
    const double h = 1e-7;
    for (Index i = 0; i < q.size(); ++i) {
      Mat3X<double> plus = q, minus = q;
      plus(i) += h;
      minus(i) -= h;
      CHECK(f(i) == near(-(cells.energy(plus) - cells.energy(minus)) / (2 * h), 1e-6, f.norm()));
    }
  }
}

TEST_CASE("forces of a lattice conserve linear and angular momentum") {
  const EmbeddedBox box;
  auto cells = box.cells();
  const Mat3X<double> q = random_displacement(box.lattice.node_count(), 0.005), f = box.forces(cells, q);
  Vec3d torque = Vec3d::Zero();
  for (Index n = 0; n < q.cols(); ++n)
    torque += Vec3d(box.lattice.nodes.col(n) + q.col(n)).cross(Vec3d(f.col(n)));
  CHECK(f.norm() > stress_scale(box));
  CHECK(f.rowwise().sum().norm() < 1e-13 * f.norm());
  CHECK(torque.norm() < 1e-13 * f.norm());
}

TEST_CASE("an affine map of a lattice gives next to no force inside, less by finer tetrahedra") {
  Mat3<double> F;
  F << 1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.2, 0.1, 1.1;
  const auto largest_inside = [&](int n) {
    const EmbeddedBox box(reduced_setup(irregular_box(n, 0.08 / n), 0.023), 0);
    auto cells = box.cells();
    const Mat3X<double> f = box.forces(cells, affine_displacement(box.lattice.nodes, F));
    double largest = 0;
    for (Index i = 0; i < f.cols(); ++i) {
      const Vec3d X = box.lattice.nodes.col(i);
      if ((X.array() > 0.0231).all() && (X.array() < 0.08 - 0.0231).all())
        largest = std::max(largest, f.col(i).norm() / f.colwise().norm().maxCoeff());
    }
    return largest;
  };
  const double coarse = largest_inside(6), fine = largest_inside(16);
  MESSAGE("share of the largest force: " << coarse << ", " << fine);
  CHECK(coarse < 0.1);
  CHECK(fine < coarse / 2);
}

TEST_CASE("the energy of a smooth field converges to that of its tetrahedra with the square of the cells") {
  const auto error = [](double cell) {
    const EmbeddedBox box(reduced_setup(box_mesh({0.16, 0.16, 0.16}, 24, 24, 24), cell), 1e5);
    const double exact = energy_of_tets(box, bent(box.setup.mesh.points, 0.03));
    return std::abs(box.cells().energy(bent(box.lattice.nodes, 0.03)) / exact - 1);
  };
  const double coarse = error(0.08), middle = error(0.04), fine = error(0.02);
  MESSAGE("relative errors: " << coarse << ", " << middle << ", " << fine);
  CHECK(middle < coarse / 3);
  CHECK(fine < middle / 3);
}

TEST_CASE("cells of which some tetrahedra are full are the same, whichever of their samples are summed") {
  const EmbeddedBox box(12);
  const WholeLattice whole = sum_cells(box.elements, box.lattice);
  std::vector<std::uint8_t> flags(std::size_t(box.setup.mesh.vertex_count()), 1);
  for (Index v = 0; v < box.setup.mesh.vertex_count(); ++v)
    flags[std::size_t(v)] = box.setup.mesh.points(0, v) > 0.05;
  const Embedding some = embed(box.elements, box.lattice, whole, {flags, {}});
  CHECK(some.cells.size() < box.embedding.cells.size());
  CHECK(some.cells.size() > box.embedding.cells.size() / 2);
  std::vector<char> is_full(std::size_t(box.setup.mesh.tet_count()), 0);
  for (Index t : some.full) is_full[std::size_t(t)] = 1;
  for (const LatticeCell& cell : some.cells) {
    double volume = 0;
    CellGradients N = CellGradients::Zero();
    for (std::size_t i = 0; i < box.lattice.part_of_sample.size(); ++i) {
      const auto t = static_cast<Index>(i) / tet_samples;
      if (box.lattice.part_of_sample[i] != cell.part || is_full[std::size_t(t)]) continue;
      const Vec3d X = box.elements.corner_points(t) * sample_weights().col(Eigen::Index(i) % tet_samples);
      const double V = box.elements.volume(t) / tet_samples;
      volume += V;
      N += V * cell_gradients(box.lattice.in_cell(cell.part, X), box.lattice.frame.edge);
    }
    N /= volume;
    CellMatrix S = CellMatrix::Zero();
    for (int i = 0; i < 8; ++i) {
      const Vec3d at =
          Vec3d(i & 1, i >> 1 & 1, i >> 2) / std::sqrt(3.0) + Vec3d::Constant(0.5 - 0.5 / std::sqrt(3.0));
      const CellGradients g = cell_gradients(at, box.lattice.frame.edge);
      S += whole.stiffness[0] * volume / 8 * (g - N) * (g - N).transpose();
    }
    CHECK(cell.volume == near(volume, 1e-12));
    CHECK((cell.gradients - N).norm() < 1e-12 * N.norm());
    CHECK((cell.fluctuation - S).norm() < 1e-11 * S.norm());
  }
}

TEST_CASE("fluctuations are as stiff as tetrahedra are in bending, by refinement as a continuum is") {
  const auto stiffness = [](int n) {  // per μ, of cells that n tetrahedra fill side by side
    const TetMesh mesh = box_mesh({0.06, 0.06, 0.06}, 3 * n, 3 * n, 3 * n);
    const Elements elements(reduced_setup(mesh, 0.02));
    const Lattice lattice = make_lattice(elements, {0.02, Vec3d::Zero()});
    return sum_cells(elements, lattice).stiffness[0] / 1e4;
  };
  const double exact = (1 + 4 * 5.0 / 6) / 3;  // at λ = 4 μ
  const double coarse = stiffness(2), middle = stiffness(4), fine = stiffness(8);
  MESSAGE("per μ: " << coarse << ", " << middle << ", " << fine << ", exact " << exact);
  CHECK(coarse - exact > 3.5 * (middle - exact));
  CHECK(middle - exact > 3.5 * (fine - exact));
  CHECK(fine == near(exact, 0.1));
}

TEST_CASE(
    "fluctuations of a single cell have the energy of its tetrahedra in nine modes, of either element") {
  const double edge = 0.03, ratio = 4e4 / 6e4;              // λ/(λ + 2μ)
  const double of_continuum = 1e4 / 3 * (1 + 4 * 5.0 / 6);  // the least that is taken
  TetMesh mesh = box_mesh(Vec3d::Constant(edge), 3, 3, 3);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(-0.002, 0.002);
  for (Vec3d inner : {Vec3d(1, 1, 1), Vec3d(2, 1, 1), Vec3d(1, 2, 2)})
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if ((mesh.points.col(v) - edge / 3 * inner).norm() < 1e-9)
        mesh.points.col(v) += Vec3d(jitter(random), jitter(random), jitter(random));
  double found[2];
  for (bool is_smoothed : {false, true}) {
    const Setup body = is_smoothed ? smoothed(reduced_setup(mesh, edge)) : reduced_setup(mesh, edge);
    const Elements elements(body);
    const Vec3d origin = Vec3d::Zero();
    const Lattice lattice = make_lattice(elements, {edge, origin});
    REQUIRE(lattice.parts.size() == 1);
    const WholeLattice whole = sum_cells(elements, lattice);
    const double volume = whole.sums[0].volume;
    CellMatrix S = CellMatrix::Zero();
    Eigen::Matrix<double, 3, 8> corners;
    for (int i = 0; i < 8; ++i) {
      const Vec3d at(i & 1, i >> 1 & 1, i >> 2);
      const CellGradients g = cell_gradients(
                              at / std::sqrt(3.0) + Vec3d::Constant(0.5 - 0.5 / std::sqrt(3.0)), edge),
                          apart = g - whole.sums[0].gradients / volume;
      S += volume / 8 * apart * apart.transpose();
      corners.col(i) = edge * (at - Vec3d::Constant(0.5));
    }
    Setup linear = body;
    std::fill(linear.region_of.begin(), linear.region_of.end(), RegionModel::tensor_mass);
    const Elements of_linear(linear);
    double own = 0, of_lattice = 0;
    for (int a = 0; a < 3; ++a)
      for (int kind = 0; kind < 3; ++kind) {
        const int b = (a + 1 + kind) % 3;
        const auto mode = [&](const Mat3X<double>& X) {
          Mat3X<double> u = Mat3X<double>::Zero(3, X.cols());
          u.row(a) = X.row(kind == 2 ? (a + 1) % 3 : a).cwiseProduct(X.row(kind == 2 ? (a + 2) % 3 : b));
          if (kind < 2) u.row(b) = -0.5 * (X.row(a).cwiseAbs2() + ratio * X.row(b).cwiseAbs2());
          return u;
        };
        const Vec3d middle = origin + Vec3d::Constant(edge / 2);
        const Mat3X<double> u = mode(body.mesh.points.colwise() - middle);
        Mat3<double> mean = Mat3<double>::Zero();
        for (Index t = 0; t < body.mesh.tet_count(); ++t) {
          const Shape s = elements.shape_of(t);
          const Mat34<double> at = u(Eigen::all, body.mesh.tets.col(t));
          mean += s.volume / volume * at * s.gradients.transpose();
        }
        own += energy_and_forces(of_linear, u).energy - volume * hooke_energy_density<double>(mean, 4e4, 1e4);
        const Mat3X<double> q = mode(corners);
        of_lattice += 0.5 * (q * S).cwiseProduct(q).sum();
      }
    found[is_smoothed] = whole.stiffness[0];
    MESSAGE("per μ: " << own / of_lattice / 1e4);
    CHECK(whole.stiffness[0] == near(std::max(of_continuum, own / of_lattice), 1e-10));
  }
  CHECK(found[false] > 1.3 * of_continuum);
  CHECK(found[true] < 0.9 * found[false]);
}

TEST_CASE("nodes take over all mass and its centre") {
  EmbeddedBox box;
  const std::vector<double> mass = box.vertex_masses();
  const double added = give_mass(box.elements, box.lattice, mass, 0, {}, box.embedding);
  CHECK(added == 0);
  double all = 0, of_nodes = 0;
  Vec3d moment = Vec3d::Zero(), moment_of_nodes = Vec3d::Zero();
  for (std::size_t v = 0; v < mass.size(); ++v) {
    all += mass[v];
    moment += mass[v] * box.setup.mesh.points.col(Eigen::Index(v));
  }
  for (std::size_t n = 0; n < box.embedding.mass.size(); ++n) {
    of_nodes += box.embedding.mass[n];
    moment_of_nodes += box.embedding.mass[n] * box.lattice.nodes.col(Eigen::Index(n));
  }
  CHECK(of_nodes == near(all, 1e-13));
  CHECK((moment - moment_of_nodes).norm() < 1e-13 * moment.norm());
}

TEST_CASE("no frequency of a lattice at rest is above that for which it has its masses") {
  EmbeddedBox box(6);
  const std::vector<double> mass = box.vertex_masses();
  const double omega = 800;
  CHECK(give_mass(box.elements, box.lattice, mass, omega, {}, box.embedding) > 0);
  auto cells = box.cells();
  const Eigen::Index n = 3 * box.lattice.node_count();
  Eigen::MatrixXd K(n, n);
  const double h = 1e-7;
  for (Eigen::Index i = 0; i < n; ++i) {
    Mat3X<double> q = Mat3X<double>::Zero(3, n / 3);
    q.data()[i] = h;
    K.col(i) = -box.forces(cells, q).reshaped() / h;
    const double inverse = 1 / std::sqrt(box.embedding.mass[std::size_t(i / 3)]);
    K.col(i) *= inverse;
  }
  for (Eigen::Index i = 0; i < n; ++i) K.row(i) /= std::sqrt(box.embedding.mass[std::size_t(i / 3)]);
  const double highest = symmetric_eigenvalues<Eigen::MatrixXd>((K + K.transpose()) / 2).maxCoeff();
  CHECK(std::sqrt(highest) < omega * (1 + 1e-6));
  CHECK(std::sqrt(highest) > 0.4 * omega);
}

TEST_CASE("bounds of nodes follow the law at the strain of each cell, also where the guard acts") {
  Setup setup = reduced_setup(irregular_box(12), 0.02);
  setup.guard_below = 0.9;
  const EmbeddedBox box(std::move(setup), 1e5);
  const Mat3X<double> q = random_displacement(box.lattice.node_count(), 0.006);
  std::vector<double> expected(std::size_t(box.lattice.node_count()), 0);
  double smallest = 1;
  Index smallest_tet = -1;
  for (const LatticeCell& cell : box.embedding.cells) {
    const Lattice::Part& part = box.lattice.parts[std::size_t(cell.part)];
    Mat3<double> H = Mat3<double>::Zero();
    for (int n = 0; n < 8; ++n) H += q.col(part.nodes[std::size_t(n)]) * cell.gradients.row(n);
    const double ratio = (Mat3<double>::Identity() + H).determinant();
    if (ratio < smallest) {
      smallest = ratio;
      smallest_tet = cell.tet;
    }
    CellWeights tangents;
    for (int n = 0; n < 8; ++n) {
      const Mat3<double> K = law_diagonal_block<double>(nonlinear_law(box.elements, cell.tet), H,
                                                        cell.gradients.row(n).transpose());
      const double mean = K.trace() / 3;
      tangents[n] = mean + std::sqrt(2.0 / 3 * (K - mean * Mat3<double>::Identity()).squaredNorm());
      CHECK(tangents[n] > symmetric_eigenvalues<Mat3<double>>(K).maxCoeff() * (1 - 1e-12));
    }
    add_bounds(cell, part, cell.volume * tangents, expected);
  }
  REQUIRE(smallest < 0.8);
  const auto found = [&](auto cells, const auto& displacements) {
    std::vector<double> bounds(expected.size(), 0);
    const auto least = cells.add_bounds(displacements, bounds);
    CHECK(least.volume_ratio == near(smallest, 1e-5));
    CHECK(least.tet == smallest_tet);
    return bounds;
  };
  const std::vector<double> bounds = found(box.cells(), q);
  const Mat3X<float> single_q = q.cast<float>();
  const std::vector<double> single = found(box.cells<float>(), single_q);
  for (std::size_t n = 0; n < expected.size(); ++n) {
    CHECK(bounds[n] == near(expected[n], 1e-12));
    CHECK(single[n] == near(expected[n], 1e-4));
  }
  for (InstructionSet set : available_instruction_sets()) {
    CHECK(found(box.cells<double>(set), q) == bounds);
    CHECK(found(box.cells<float>(set), single_q) == single);
  }
}

TEST_CASE(
    "single precision follows double, and every instruction set and number of threads gives the same bits") {
  const EmbeddedBox box(12);
  const Mat3X<double> q = random_displacement(box.lattice.node_count(), 0.003);
  auto reference = box.cells();
  const Mat3X<double> f = box.forces(reference, q);
  const Mat3X<float> single_q = q.cast<float>();
  auto single = box.cells<float>();
  const Mat3X<float> single_f = box.forces(single, single_q);
  CHECK((single_f.cast<double>() - f).norm() < 1e-6 * f.norm());
  for (InstructionSet set : available_instruction_sets())
    for (int threads : {1, 2, 7}) {
      auto other = box.cells<double>(set);
      CHECK(box.forces(other, q, threads) == f);
      auto other_single = box.cells<float>(set);
      CHECK(box.forces(other_single, single_q, threads) == single_f);
    }
}
