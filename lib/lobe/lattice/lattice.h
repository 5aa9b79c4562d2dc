// The cubic lattice of reduced regions (theory, section 18). A tetrahedron is eight samples, one of each of
// the tetrahedra into which its edges' middles divide it. Samples of one cell and one material whose
// tetrahedra are connected by common vertices are a part; each part has eight nodes, the corners of its cell.
// A part that fills less than a fifth of its cell joins a neighbour, whose cell reaches beyond itself there.
// Nodes of two parts whose tetrahedra share a vertex are the same where they coincide. So the two sides of a
// slit have nodes of their own, however narrow it is.
#pragma once

#include <array>
#include <vector>

#include "lobe/fem/elements.h"

namespace lobe {

struct LatticeFrame {
  double edge = 0;               // edge of a cell [m]; 0: there is no lattice yet
  Vec3d origin = Vec3d::Zero();  // a corner of a cell [m]
};

// Values of the eight corners of a cell. Bit d of a corner's number says on which side it is along axis d.
using CellWeights = Eigen::Matrix<double, 8, 1>;
using CellGradients = Eigen::Matrix<double, 8, 3>;  // [1/m]

// Trilinear functions of a cell at a point of its own coordinates, 0…1 within. They are exact for linear
// fields outside of the cell, too.
CellWeights cell_weights(const Vec3d& at);
CellGradients cell_gradients(const Vec3d& at, double edge);

inline constexpr int tet_samples = 8;
// 4 × 8: barycentric coordinates of the samples. Each has an eighth of the tetrahedron's volume.
const Eigen::Matrix<double, 4, tet_samples>& sample_weights();

struct Lattice {
  struct Part {
    Eigen::Vector3i cell = Eigen::Vector3i::Zero();
    std::uint16_t material = 0;
    std::array<Index, 8> nodes{};
    bool has_cut_end = false;  // whether both sides of a cut follow one of its nodes
  };

  LatticeFrame frame;
  std::vector<Part> parts;
  std::vector<Index> part_of_sample;  // tet_samples × tetrahedron + sample; −1 outside of reduced regions
  std::vector<Index> part_of_vertex;  // part that moves it while embedded; −1 outside of reduced regions
  Mat3X<double> nodes;                // 3 × #nodes, rest positions [m]
  std::vector<Eigen::Vector3i> corner_of_node;

  Index node_count() const { return static_cast<Index>(nodes.cols()); }
  Vec3d in_cell(Index part, const Vec3d& X) const {  // coordinates of a point in the cell of a part
    return (X - frame.origin) / frame.edge - parts[std::size_t(part)].cell.cast<double>();
  }
  CellWeights weights(Index vertex, const Vec3d& X) const {  // X: its rest position [m]
    return cell_weights(in_cell(part_of_vertex[std::size_t(vertex)], X));
  }
};

// Chooses the lattice around the middle of a body's reduced regions. edge 0: a twentieth of the diagonal, but
// at least 1.5 mean edges of their tetrahedra. Throws InputError for a cell that is not larger than the
// tetrahedra, or larger than half of the regions.
LatticeFrame choose_lattice(const Elements& elements, double edge);

Lattice make_lattice(const Elements& elements, const LatticeFrame& frame);  // of all tetrahedra left

}  // namespace lobe
