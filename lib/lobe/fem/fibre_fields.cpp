#include "lobe/fem/fibre_fields.h"

#include "lobe/error.h"
#include "lobe/fem/shape.h"
#include "lobe/numerics/sparse_factor.h"

namespace lobe {
namespace {

class HarmonicField {
 public:
  HarmonicField(const TetMesh& mesh, const std::vector<Index>& tets, const std::string& place)
      : mesh_(mesh), tets_(tets), place_(place), unknown_(std::size_t(mesh.vertex_count()), unused) {
    value_.setZero(mesh.vertex_count());
    for (Index t : tets)
      for (Index v : mesh.tets.col(t)) unknown_[std::size_t(v)] = free;
  }

  void give(const std::vector<Index>& vertices, double value, const char* key) {
    bool any = false;
    for (Index v : vertices) {
      Index& state = unknown_[std::size_t(v)];
      if (state == given && value_[v] != value)
        throw InputError(place_ + "/" + key, "vertex " + std::to_string(v) + " is selected by both ends");
      if (state == unused) continue;
      state = given;
      value_[v] = value;
      any = true;
    }
    if (!any) throw InputError(place_ + "/" + key, "selects no vertex of the material's tetrahedra");
  }

  void solve() {
    Index count = 0;
    for (Index& state : unknown_)
      if (state == free) state = count++;
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
    for (Index t : tets_) add(t, entries, right);
    if (count == 0) return;
    SparseFactor::Matrix A(count, count);
    A.setFromTriplets(entries.begin(), entries.end());
    const auto factor = make_ldlt();
    factor->analyse(A);
    if (!factor->factorise(A))
      throw InputError(place_, "a part of the material's tetrahedra has no vertex of \"from\" and \"to\"");
    const Eigen::VectorXd x = factor->solve(right);
    for (std::size_t v = 0; v < unknown_.size(); ++v)
      if (unknown_[v] >= 0) value_[Eigen::Index(v)] = x[unknown_[v]];
  }

  Vec3d gradient(Index tet) const {
    const Shape s = shape(tet_points(mesh_, tet));
    Vec3d g = Vec3d::Zero();
    for (int c = 0; c < 4; ++c)
      g += (value_[mesh_.tets(c, tet)] - value_[mesh_.tets(0, tet)]) * s.gradients.col(c);
    return g;
  }

 private:
  static constexpr Index unused = -3, given = -2, free = -1;

  void add(Index t, std::vector<Eigen::Triplet<double>>& entries, Eigen::VectorXd& right) const {
    const Shape s = shape(tet_points(mesh_, t));
    for (int j = 0; j < 4; ++j) {
      const Index row = unknown_[std::size_t(mesh_.tets(j, t))];
      if (row < 0) continue;
      for (int k = 0; k < 4; ++k) {
        const Index v = mesh_.tets(k, t), column = unknown_[std::size_t(v)];
        const double entry = s.volume * s.gradients.col(j).dot(s.gradients.col(k));
        if (column < 0)
          right[row] -= entry * value_[v];
        else if (column <= row)
          entries.emplace_back(row, column, entry);
      }
    }
  }

  const TetMesh& mesh_;
  const std::vector<Index>& tets_;
  const std::string& place_;
  std::vector<Index> unknown_;
  Eigen::VectorXd value_;
};

// Gives tetrahedra without a direction the sum of the directions around their vertices, ring by ring.
void fill_from_neighbours(const std::vector<Index>& tets, TetMesh& mesh, const std::string& place) {
  std::vector<Index> left;
  for (Index t : tets)
    if (mesh.fibres.col(t).isZero(0)) left.push_back(t);
  while (!left.empty()) {
    Mat3X<double> around = Mat3X<double>::Zero(3, mesh.vertex_count());
    for (Index t : tets)
      for (Index v : mesh.tets.col(t)) around.col(v) += mesh.fibres.col(t);
    std::vector<Index> still;
    Mat3X<double> found(3, Eigen::Index(left.size()));
    for (std::size_t i = 0; i < left.size(); ++i)
      found.col(Eigen::Index(i)) = around(Eigen::all, mesh.tets.col(left[i])).rowwise().sum();
    for (std::size_t i = 0; i < left.size(); ++i) {
      const Vec3d sum = found.col(Eigen::Index(i));
      if (sum.norm() > 1e-6)
        mesh.fibres.col(left[i]) = sum.normalized();
      else
        still.push_back(left[i]);
    }
    if (still.size() == left.size())
      throw InputError(place, "tetrahedron " + std::to_string(left[0]) + ": the field has no gradient there");
    left = std::move(still);
  }
}

}  // namespace

void set_fibres_around(const Vec3d& point, const Vec3d& axis, const std::vector<Index>& tets, TetMesh& mesh,
                       const std::string& place) {
  const Vec3d along = axis.stableNormalized();
  for (Index t : tets) {
    const Vec3d arm = barycentre(mesh, t) - point, around = along.cross(arm);
    if (!(around.norm() > 1e-9 * arm.norm()))
      throw InputError(place,
                       "tetrahedron " + std::to_string(t) +
                           " has its barycentre on the axis, where no direction is around it; move the "
                           "axis, or give that part another material");
    mesh.fibres.col(t) = around.normalized();
  }
}

void set_harmonic_fibres(const std::vector<Index>& from, const std::vector<Index>& to,
                         const std::vector<Index>& tets, TetMesh& mesh, const std::string& place) {
  HarmonicField field(mesh, tets, place);
  field.give(from, 0, "from");
  field.give(to, 1, "to");
  field.solve();
  const Box box = bounding_box(mesh);
  const double least = 1e-9 / (box.max - box.min).norm();
  for (Index t : tets) {
    const Vec3d g = field.gradient(t);
    mesh.fibres.col(t) = g.norm() > least ? Vec3d(g.normalized()) : Vec3d(Vec3d::Zero());
  }
  fill_from_neighbours(tets, mesh, place);
}

}  // namespace lobe
