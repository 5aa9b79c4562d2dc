#include "lobe/solve/floating.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <string>

#include "lobe/error.h"

namespace lobe {
// There is a row per given component: its part of the translations e_i and rotations e_i × (X − centre)/size.
// The piece is held if the rows have rank 6.
bool is_held(const Elements& elements, const std::vector<Index>& piece,
             const std::function<bool(Index vertex, int axis)>& is_prescribed) {
  std::vector<Index> vertices;
  for (Index t : piece)
    for (int c = 0; c < 4; ++c) vertices.push_back(elements.topology.tets()(c, t));
  const Vec3d centre = elements.points.col(vertices[0]);
  double size = 0;
  for (Index v : vertices) size = std::max(size, (elements.points.col(v) - centre).norm());
  std::vector<Eigen::Matrix<double, 1, 6>> rows;
  for (Index v : vertices)
    for (int axis = 0; axis < 3; ++axis) {
      if (!is_prescribed(v, axis)) continue;
      const Vec3d arm = (elements.points.col(v) - centre) / size;
      Eigen::Matrix<double, 1, 6> row;
      row << Vec3d::Unit(axis).transpose(), arm.cross(Vec3d::Unit(axis)).transpose();
      rows.push_back(row);
    }
  Eigen::Matrix<double, Eigen::Dynamic, 6> J(Eigen::Index(rows.size()), 6);
  for (std::size_t i = 0; i < rows.size(); ++i) J.row(Eigen::Index(i)) = rows[i];
  Eigen::ColPivHouseholderQR<decltype(J)> qr(J);
  qr.setThreshold(1e-9);
  return J.rows() >= 6 && qr.rank() == 6;
}

void refuse_floating_pieces(const Elements& elements, const Unknowns& unknowns,
                            const Mat3X<double>& springs) {
  std::vector<std::vector<Index>> open = elements.topology.pieces();
  std::vector<std::uint8_t> anchored(std::size_t(elements.topology.vertex_count()), 0);
  const auto is_prescribed = [&](Index v, int axis) {
    return unknowns.number(axis, v) < 0 || anchored[v] || (v < springs.cols() && springs(axis, v) > 0);
  };
  for (std::size_t before = open.size() + 1; before > open.size() && !open.empty();) {
    before = open.size();
    std::erase_if(open, [&](const std::vector<Index>& piece) {
      if (!is_held(elements, piece, is_prescribed)) return false;
      for (Index t : piece)
        for (int c = 0; c < 4; ++c) anchored[elements.topology.tets()(c, t)] = 1;
      return true;
    });
  }
  if (open.empty()) return;
  throw InputError(
      "static solution",
      "a piece of " + std::to_string(open[0].size()) + " tetrahedra, among them " +
          std::to_string(open[0][0]) +
          ", is not held and could move freely; fix at least three of its vertices that do not lie on "
          "a line, or enough of their components to stop every translation and rotation");
}

}  // namespace lobe
