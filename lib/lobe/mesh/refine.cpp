#include "lobe/mesh/refine.h"

#include <limits>

#include "lobe/error.h"
#include "lobe/mesh/edges.h"
#include "lobe/numerics/symmetric_eigen.h"

namespace lobe {
namespace {

// The octahedron's diagonals join the middles of opposite edges e and 5 − e. The ring of the four other
// middles around each diagonal is ordered so that (first, last, ring[i], ring[i+1]) is positively oriented.
constexpr int rings[3][4] = {{1, 2, 4, 3}, {0, 3, 5, 2}, {0, 1, 5, 4}};

int shortest_diagonal(const TetMesh& mesh, const std::array<Index, 6>& middle) {
  int shortest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int e = 0; e < 3; ++e) {
    const double length = (mesh.points.col(middle[e]) - mesh.points.col(middle[5 - e])).squaredNorm();
    if (length < least) {
      least = length;
      shortest = e;
    }
  }
  return shortest;
}

// middle: vertex in the middle of each edge, in the order of edge_corners.
void add_children(const Eigen::Vector4i& corners, const std::array<Index, 6>& middle, Index first,
                  TetMesh& fine) {
  const auto& m = middle;
  fine.tets.col(first) << corners[0], m[0], m[1], m[2];
  fine.tets.col(first + 1) << m[0], corners[1], m[3], m[4];
  fine.tets.col(first + 2) << m[1], m[3], corners[2], m[5];
  fine.tets.col(first + 3) << m[2], m[4], m[5], corners[3];
  const int e = shortest_diagonal(fine, middle);
  for (int i = 0; i < 4; ++i)
    fine.tets.col(first + 4 + i) << m[e], m[5 - e], m[rings[e][i]], m[rings[e][(i + 1) % 4]];
}

// A direction and its opposite are the same fibre, so a⊗a is interpolated. Each vertex has the mean of the
// tetrahedra around it. The slope of these means is added to each parent's value. A constant field stays
// constant.
class FibreInterpolation {
 public:
  explicit FibreInterpolation(const TetMesh& mesh) : mesh_(mesh) {
    Eigen::Matrix<double, 10, Eigen::Dynamic> sums;
    sums.setZero(10, mesh.vertex_count());
    for (Index t = 0; t < mesh.tet_count(); ++t) {
      const Vec3d a = mesh.fibres.col(t);
      if (a.isZero(0)) continue;
      const double volume = signed_volume(tet_points(mesh, t));
      for (Index v : mesh.tets.col(t)) {
        sums.col(v).head<9>() += volume * (a * a.transpose()).eval().reshaped();
        sums(9, v) += volume;
      }
    }
    means_ = sums.topRows<9>();
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (sums(9, v) > 0) means_.col(v) /= sums(9, v);
  }

  // `weights`: barycentric coordinates of a point of the tetrahedron.
  Vec3d at(Index tet, const Eigen::Vector4d& weights) const {
    const Vec3d fibre = mesh_.fibres.col(tet);
    if (fibre.isZero(0) || !fibre.allFinite()) return fibre;
    Mat3<double> A = fibre * fibre.transpose();
    for (int c = 0; c < 4; ++c) A += (weights[c] - 0.25) * means_.col(mesh_.tets(c, tet)).reshaped(3, 3);
    const Vec3d found = symmetric_eigen(A).vectors.col(2);
    return found.dot(fibre) < 0 ? Vec3d(-found) : found;
  }

 private:
  const TetMesh& mesh_;
  Eigen::Matrix<double, 9, Eigen::Dynamic> means_;  // of a⊗a
};

void set_fibres(const TetMesh& mesh, TetMesh& fine) {
  const FibreInterpolation field(mesh);
  fine.fibres.resize(3, fine.tet_count());
  for (Index child = 0; child < fine.tet_count(); ++child) {
    const Index parent = child / 8;
    const Mat34<double> X = tet_points(mesh, parent);
    const Mat3<double> edges = X.rightCols<3>().colwise() - X.col(0);
    Eigen::Vector4d weights;
    weights.tail<3>() = edges.inverse() * (barycentre(fine, child) - X.col(0));
    weights[0] = 1 - weights.tail<3>().sum();
    fine.fibres.col(child) = field.at(parent, weights);
  }
}

}  // namespace

RefinedMesh refine(const TetMesh& mesh) {
  if (mesh.tet_count() > std::numeric_limits<Index>::max() / 8)
    throw InputError("refine", "more than 2^31 - 1 tetrahedra would result; start from a coarser mesh");
  if (!mesh.labels.empty() && mesh.labels.size() != std::size_t(mesh.tet_count()))
    throw InputError("refine", "needs one label per tetrahedron, or none");
  RefinedMesh refined;
  refined.ends = mesh_edges(mesh);
  const auto& ends = refined.ends;
  TetMesh& fine = refined.mesh;
  const Index old = mesh.vertex_count();
  fine.points.resize(3, old + Index(ends.size()));
  fine.points = refined.prolongate(mesh.points);
  fine.tets.resize(4, 8 * mesh.tet_count());
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    std::array<Index, 6> middle;
    for (int e = 0; e < 6; ++e) middle[e] = old + edge_number(ends, mesh_edge(mesh, t, e));
    add_children(mesh.tets.col(t), middle, 8 * t, fine);
    refined.parent_of.insert(refined.parent_of.end(), 8, t);
    fine.labels.insert(fine.labels.end(), 8, mesh.labels.empty() ? 0 : mesh.labels[std::size_t(t)]);
  }
  if (mesh.fibres.cols() > 0) set_fibres(mesh, fine);
  fine.bodies.names = mesh.bodies.names;
  for (const std::uint8_t body : mesh.bodies.of) fine.bodies.of.insert(fine.bodies.of.end(), 8, body);
  return refined;
}

}  // namespace lobe
