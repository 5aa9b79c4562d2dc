// A body whose vertices all follow a lattice.
#pragma once

#include <numeric>

#include "lobe/lattice/lattice_cells.h"
#include "near.h"
#include "support.h"

namespace lobe::test {

inline Setup reduced_setup(const TetMesh& mesh, double cell) {
  Setup setup = setup_of(mesh, RegionModel::reduced);
  setup.lattice_cell = cell;
  return setup;
}

// n × n × n jittered cells of 1 cm.
struct EmbeddedBox {
  explicit EmbeddedBox(int n = 8, double cell = 0.02, double volume_penalty = 1e5)
      : EmbeddedBox(reduced_setup(irregular_box(n), cell), volume_penalty) {}
  EmbeddedBox(Setup of_part, double volume_penalty)
      : setup((of_part.volume_penalty = volume_penalty, std::move(of_part))),
        elements(setup),
        lattice(make_lattice(elements, choose_lattice(elements, setup.lattice_cell))),
        embedding(embed(elements, lattice, sum_cells(elements, lattice),
                        {std::vector<std::uint8_t>(std::size_t(setup.mesh.vertex_count()), 1), {}})) {}

  template <class Real = double>
  LatticeCells<Real> cells(InstructionSet set = chosen_instruction_set()) const {
    LatticeCells<Real> cells(set);
    cells.build(elements, lattice, embedding.cells);
    return cells;
  }
  // 3 × #nodes [N].
  template <class Real>
  Mat3X<Real> forces(LatticeCells<Real>& cells, const Mat3X<Real>& q, int threads = 1) const {
    Parallel parallel(threads);
    cells.find_forces(q, parallel);
    Mat3X<Real> f(3, q.cols());
    for (Index n = 0; n < lattice.node_count(); ++n) f.col(n) = cells.force(n);
    return f;
  }
  std::vector<double> vertex_masses() const {
    std::vector<double> mass;
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v) mass.push_back(lumped_mass(elements, v));
    return mass;
  }

  Setup setup;
  Elements elements;
  Lattice lattice;
  Embedding embedding;
};

// Of the vertices.
inline Mat3X<double> interpolated(const EmbeddedBox& box, const Mat3X<double>& q) {
  Mat3X<double> u = Mat3X<double>::Zero(3, box.setup.mesh.vertex_count());
  for (Index v = 0; v < u.cols(); ++v) {
    const CellWeights w = box.lattice.weights(v, box.elements.points.col(v));
    const Lattice::Part& part = box.lattice.parts[std::size_t(box.lattice.part_of_vertex[std::size_t(v)])];
    for (int n = 0; n < 8; ++n) u.col(v) += w[n] * q.col(part.nodes[std::size_t(n)]);
  }
  return u;
}

}  // namespace lobe::test
