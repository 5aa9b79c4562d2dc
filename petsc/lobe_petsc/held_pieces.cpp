#include "lobe_petsc/held_pieces.h"

#include <algorithm>
#include <array>
#include <string>

#include "lobe/numerics/symmetric_eigen.h"

namespace lobe::petsc {
namespace {

using Gram = Eigen::Matrix<double, 6, 6>;

struct OpenFace {  // of a part, but not of the body
  std::array<Index, 3> corners;
  std::int64_t piece = 0;
  auto operator<=>(const OpenFace&) const = default;
};

std::int64_t root_of(std::vector<std::int64_t>& parent, std::int64_t piece) {
  while (parent[piece] != piece) piece = parent[piece] = parent[parent[piece]];
  return piece;
}

class Pieces {
 public:
  Pieces(const Ranks& ranks, const Part& part, const Elements& elements);

  std::int64_t count() const { return std::int64_t(parent_.size()); }  // of all parts
  std::int64_t of(Index tet) const { return of_[std::size_t(tet)]; }

 private:
  std::vector<std::int64_t> of_;  // per tetrahedron: the lowest number of what hangs together by faces
  std::vector<std::int64_t> parent_;
};

Pieces::Pieces(const Ranks& ranks, const Part& part, const Elements& elements) {
  const std::vector<std::vector<Index>> of_part = elements.topology.pieces();
  const std::int64_t first = ranks.sum_before(std::int64_t(of_part.size()));
  of_.resize(std::size_t(elements.topology.tet_count()));
  for (std::size_t p = 0; p < of_part.size(); ++p)
    for (Index t : of_part[p]) of_[t] = first + std::int64_t(p);
  parent_.resize(std::size_t(ranks.sum(std::int64_t(of_part.size()))));
  std::iota(parent_.begin(), parent_.end(), 0);

  std::vector<Index> outer;
  for (const TetFace& face : part.outer) outer.push_back(4 * face.tet + face.face);
  std::vector<std::vector<OpenFace>> to(std::size_t(ranks.count()));
  for (Index code : elements.topology.boundary_faces()) {
    if (std::binary_search(outer.begin(), outer.end(), code)) continue;
    OpenFace face{{}, of_[code / 4]};
    for (int c = 0; c < 3; ++c) face.corners[c] = part.vertex_number[elements.topology.face(code)[c]];
    std::sort(face.corners.begin(), face.corners.end());
    to[ranks.holder_of(part.all_vertices, face.corners[0])].push_back(face);
  }
  std::vector<OpenFace> met;
  for (const auto& list : ranks.exchange(to)) met.insert(met.end(), list.begin(), list.end());
  std::sort(met.begin(), met.end());
  std::vector<std::array<std::int64_t, 2>> joined;
  for (std::size_t i = 0; i + 1 < met.size(); ++i)
    if (met[i].corners == met[i + 1].corners) joined.push_back({met[i].piece, met[i + 1].piece});
  std::sort(joined.begin(), joined.end());
  joined.erase(std::unique(joined.begin(), joined.end()), joined.end());
  for (const auto& [a, b] : ranks.gather(joined)) {
    const std::int64_t x = root_of(parent_, a), y = root_of(parent_, b);
    parent_[std::max(x, y)] = std::min(x, y);
  }
  for (std::int64_t& piece : of_) piece = root_of(parent_, piece);
}

}  // namespace

void refuse_floating_pieces(const Ranks& ranks, const Part& part, const Elements& elements,
                            const PrescribedComponents& is_prescribed) {
  const Pieces pieces(ranks, part, elements);
  Ghosted scratch(ranks, part);
  std::vector<std::int64_t> size(std::size_t(pieces.count()), 0), sizes = size;
  for (Index t = 0; t < part.mesh.tet_count(); ++t) ++size[pieces.of(t)];
  MPI_Allreduce(size.data(), sizes.data(), int(size.size()), MPI_INT64_T, MPI_SUM, ranks.comm());
  Vec3d centre;
  double extent = 0;
  for (int i = 0; i < 3; ++i) {
    const double low = ranks.min(part.mesh.points.row(i).minCoeff()),
                 high = ranks.max(part.mesh.points.row(i).maxCoeff());
    centre[i] = (low + high) / 2;
    extent = std::max(extent, (high - low) / 2);
  }

  std::vector<char> anchored(std::size_t(part.mesh.vertex_count()), 0), held(sizes.size(), 0);
  for (bool found = true; found;) {
    // One row per prescribed component: its part of the three translations, and of the three rotations about
    // the centre.
    std::vector<Gram> of_rank(sizes.size(), Gram::Zero()), all = of_rank;
    for (Index t = 0; t < part.mesh.tet_count(); ++t)
      for (int c = 0; c < 4; ++c)
        for (int axis = 0; axis < 3; ++axis) {
          const Index v = part.mesh.tets(c, t);
          if (!is_prescribed(axis, v) && !anchored[v]) continue;
          const Vec3d arm = (part.mesh.points.col(v) - centre) / extent;
          Eigen::Matrix<double, 6, 1> row;
          row << Vec3d::Unit(axis), arm.cross(Vec3d::Unit(axis));
          of_rank[pieces.of(t)] += row * row.transpose();
        }
    MPI_Allreduce(of_rank.data(), all.data(), int(36 * all.size()), MPI_DOUBLE, MPI_SUM, ranks.comm());
    found = false;
    for (std::size_t p = 0; p < all.size(); ++p) {
      if (held[p] || sizes[p] == 0) continue;
      const Eigen::VectorXd squares = symmetric_eigenvalues<Eigen::MatrixXd>(all[p]);
      if (!(squares[0] > 1e-13 * squares[5])) continue;
      held[p] = 1;
      found = true;
    }
    for (Index t = 0; t < part.mesh.tet_count() && found; ++t)
      for (int c = 0; c < 4 && held[pieces.of(t)]; ++c) anchored[part.mesh.tets(c, t)] = 1;
    if (found) anchored = any_rank(scratch, anchored);
  }
  for (std::size_t p = 0; p < held.size(); ++p)
    if (!held[p] && sizes[p] > 0)
      throw InputError(
          "static solution",
          "a piece of " + std::to_string(sizes[p]) +
              " tetrahedra is not held and could move freely; fix at least three of its vertices "
              "that do not lie on a line, or enough of their components to stop every translation "
              "and rotation");
}

}  // namespace lobe::petsc
