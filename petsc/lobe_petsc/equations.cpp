#include "lobe_petsc/equations.h"

#include <algorithm>
#include <cmath>

#include "lobe/setup/boundary_conditions.h"
#include "lobe/setup/check_setup.h"

namespace lobe::petsc {
namespace {

Mat34<double> corners_of(const Elements& elements, Index tet, const Mat3X<double>& u) {
  Mat34<double> corners;
  for (int c = 0; c < 4; ++c) corners.col(c) = u.col(elements.topology.tets()(c, tet));
  return corners;
}

const Setup& checked(const Ranks& ranks, const Setup& setup) {
  ranks.together([&] {
    check_setup(setup, {Option::static_solution});
    if (any_nodal_pressure(setup.materials))
      throw InputError("nodal_pressure", "is not available with --solver petsc; solve with --solver eigen");
    if (any_smoothed(setup.materials))
      throw InputError("element",
                       "\"edge-smoothed\" is not available with --solver petsc; solve with "
                       "--solver eigen");
  });
  return setup;
}

}  // namespace

Equations::Equations(const Ranks& ranks, const Part& part, const Setup& setup)
    : ranks_(ranks),
      part_(part),
      elements_(checked(ranks, setup)),
      averages_(elements_),
      u_(ranks, part),
      sums_(ranks, part),
      is_prescribed_(PrescribedComponents::Zero(3, part.mesh.vertex_count())) {
  prescribed_.setZero(3, part.owned);
  const HeldVertices held = held_by(setup.prescribed);
  for (const HeldVertices::Held& item : held.all())
    for (int axis = 0; axis < 3; ++axis) {
      if (!item.axes[axis]) continue;
      is_prescribed_(axis, item.vertex) = true;
      if (item.vertex < part.owned) prescribed_(axis, item.vertex) = item.goal[axis];
    }
  refuse_floating_pieces(ranks, part, elements_, is_prescribed_);
  unknowns_ =
      ranks.sum(std::int64_t(3) * part.owned - std::int64_t(is_prescribed_.leftCols(part.owned).count()));
  const auto nonlinear = std::count_if(setup.region_of.begin(), setup.region_of.end(),
                                       [](RegionModel model) { return !lobe::is_linear(model); });
  is_linear_ = ranks.sum(std::int64_t(nonlinear)) == 0;
  add_loads(setup);
}

// Loads of vertices count for owned vertices only. Ghosts add the weight of their tetrahedra and the loads on
// their faces.
void Equations::add_loads(const Setup& setup) {
  Mat3X<double> loads = dead_loads(elements_, setup.face_loads, setup.vertex_loads);
  for (Index v = 0; v < loads.cols(); ++v) loads.col(v) += lumped_mass(elements_, v) * setup.gravity;
  sums_.sum(loads);
  loads_ = sums_.local().leftCols(part_.owned);
}

Mat3X<double> Equations::local(Vec u) {
  check(VecCopy(u, u_.vec()));
  u_.update_ghosts();
  return u_.local();
}

State Equations::at(Vec u, double fraction, Vec forces) {
  const Mat3X<double> full = local(u);
  EnergyAndForces of_part = energy_and_forces(elements_, averages_, full);
  sums_.sum(of_part.forces);
  Mat3X<double> net = sums_.local().leftCols(part_.owned) + fraction * loads_;
  State state;
  state.elastic = ranks_.sum(of_part.energy);
  state.potential =
      state.elastic - ranks_.sum(fraction * loads_.cwiseProduct(full.leftCols(part_.owned)).sum());
  state.smallest_volume_ratio = ranks_.min(of_part.smallest_volume_ratio);
  const double all = ranks_.sum(net.squaredNorm());
  state.scale = std::sqrt(std::max(all, fraction * fraction * ranks_.sum(loads_.squaredNorm())));
  for (Index v = 0; v < part_.owned; ++v)
    for (int axis = 0; axis < 3; ++axis)
      if (is_prescribed_(axis, v)) net(axis, v) = 0;
  state.residual = std::sqrt(ranks_.sum(net.squaredNorm()));
  sums_.set_owned(net);
  check(VecCopy(sums_.vec(), forces));
  return state;
}

double Equations::smallest_volume_ratio(Vec u) {
  const Mat3X<double> full = local(u);
  double ratio = 1;
  for (Index t = 0; t < elements_.topology.tet_count(); ++t) {
    if (lobe::is_linear(elements_.region_of[t])) continue;
    const Mat3<double> alpha = elements_.shape_of(t).gradients.rightCols<3>();
    const Mat3<double> F =
        Mat3<double>::Identity() + displacement_gradient(corners_of(elements_, t, full), alpha);
    ratio = std::min(ratio, F.determinant());
  }
  return ranks_.min(ratio);
}

void Equations::boundary_move(Vec u, double fraction, Vec move) {
  Mat3X<double> missing = fraction * prescribed_ - local(u).leftCols(part_.owned);
  for (Index v = 0; v < part_.owned; ++v)
    for (int axis = 0; axis < 3; ++axis)
      if (!is_prescribed_(axis, v)) missing(axis, v) = 0;
  sums_.set_owned(missing);
  check(VecCopy(sums_.vec(), move));
}

void Equations::clear_prescribed(Vec w) {
  PetscScalar* values = nullptr;
  check(VecGetArray(w, &values));
  for (Index v = 0; v < part_.owned; ++v)
    for (int axis = 0; axis < 3; ++axis)
      if (is_prescribed_(axis, v)) values[3 * v + axis] = 0;
  check(VecRestoreArray(w, &values));
}

void Equations::subtract_product(Vec u, Vec w, Vec forces) {
  const Mat3X<double> full = local(u), by = local(w);
  Mat3X<double> product = Mat3X<double>::Zero(3, full.cols());
  for (Index t = 0; t < elements_.topology.tet_count(); ++t) {
    const Mat34<double> move = corners_of(elements_, t, by);
    if (move.isZero(0)) continue;
    const Eigen::Matrix<double, 12, 1> f =
        tet_stiffness(elements_, t, corners_of(elements_, t, full)) * move.reshaped();
    for (int c = 0; c < 4; ++c) product.col(elements_.topology.tets()(c, t)) += f.segment<3>(3 * c);
  }
  sums_.sum(product);
  Mat3X<double> net = sums_.local().leftCols(part_.owned);
  for (Index v = 0; v < part_.owned; ++v)
    for (int axis = 0; axis < 3; ++axis)
      if (is_prescribed_(axis, v)) net(axis, v) = 0;
  sums_.set_owned(net);
  check(VecAXPY(forces, -1, sums_.vec()));
}

namespace {

struct Pair {  // row and column of a block
  PetscInt row, column;
  auto operator<=>(const Pair&) const = default;
};

}  // namespace

// The columns of each row of blocks: those that the tetrahedra of this rank couple, and those that other
// ranks report for their tetrahedra.
void Equations::reserve(Mat matrix) {
  const PetscInt first = part_.owned > 0 ? part_.global[0] : 0, end = first + part_.owned;
  std::vector<std::vector<Pair>> to(std::size_t(ranks_.count()));
  std::vector<int> owner_ends;
  for (double rows : ranks_.gather(double(part_.owned)))
    owner_ends.push_back((owner_ends.empty() ? 0 : owner_ends.back()) + int(rows));
  const auto columns_of = [&](Index v) {
    std::vector<PetscInt> columns;
    for (Index t : elements_.topology.around(v))
      for (int c = 0; c < 4; ++c) columns.push_back(part_.global[elements_.topology.tets()(c, t)]);
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    return columns;
  };
  for (Index v = part_.owned; v < part_.mesh.vertex_count(); ++v) {
    const auto owner =
        std::upper_bound(owner_ends.begin(), owner_ends.end(), part_.global[v]) - owner_ends.begin();
    for (PetscInt column : columns_of(v)) to[owner].push_back({part_.global[v], column});
  }
  std::vector<Pair> told;
  for (const auto& list : ranks_.exchange(to)) told.insert(told.end(), list.begin(), list.end());
  std::sort(told.begin(), told.end());
  std::vector<PetscInt> own_blocks(std::size_t(part_.owned)), others = own_blocks;
  auto next = told.begin();
  for (Index v = 0; v < part_.owned; ++v) {
    std::vector<PetscInt> columns = columns_of(v);
    for (; next != told.end() && next->row == part_.global[v]; ++next) columns.push_back(next->column);
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    for (PetscInt column : columns) ++(column >= first && column < end ? own_blocks : others)[v];
  }
  check(MatXAIJSetPreallocation(matrix, 3, own_blocks.data(), others.data(), nullptr, nullptr));
}

Owned<Mat, MatDestroy> Equations::make_matrix() {
  Owned<Mat, MatDestroy> matrix;
  check(MatCreate(ranks_.comm(), matrix.fill()));
  check(MatSetSizes(matrix, 3 * part_.owned, 3 * part_.owned, PETSC_DETERMINE, PETSC_DETERMINE));
  check(MatSetBlockSize(matrix, 3));
  check(MatSetType(matrix, MATAIJ));
  reserve(matrix);
  check(MatSetOption(matrix, MAT_SYMMETRIC, PETSC_TRUE));
  check(MatSetOption(matrix, MAT_SYMMETRY_ETERNAL, PETSC_TRUE));
  Vector points;
  check(VecDuplicate(u_.vec(), points.fill()));
  sums_.set_owned(part_.mesh.points);
  check(VecCopy(sums_.vec(), points));
  Owned<MatNullSpace, MatNullSpaceDestroy> rigid;
  check(MatNullSpaceCreateRigidBody(points, rigid.fill()));
  check(MatSetNearNullSpace(matrix, rigid));
  return matrix;
}

void Equations::tangent(Vec u, Mat matrix) {
  const Mat3X<double> full = local(u);
  check(MatZeroEntries(matrix));
  for (Index t = 0; t < elements_.topology.tet_count(); ++t) {
    TetStiffness K = tet_stiffness(elements_, t, corners_of(elements_, t, full));
    PetscInt rows[4];
    for (int c = 0; c < 4; ++c) {
      const Index v = elements_.topology.tets()(c, t);
      rows[c] = part_.global[v];
      for (int axis = 0; axis < 3; ++axis) {
        if (!is_prescribed_(axis, v)) continue;
        const int i = 3 * c + axis;
        const double diagonal = std::abs(K(i, i));
        K.row(i).setZero();
        K.col(i).setZero();
        K(i, i) = diagonal;
      }
    }
    check(MatSetValuesBlocked(matrix, 4, rows, 4, rows, K.data(), ADD_VALUES));
  }
  check(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
}

}  // namespace lobe::petsc
