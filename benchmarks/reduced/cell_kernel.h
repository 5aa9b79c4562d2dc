// The forces of a register's width of cells at a time (cell.h). Plain arrays.
#pragma once

#include <array>
#include <vector>

#include "lobe/types.h"

namespace lobe::reduced {

template <class Real>
struct alignas(64) CellBlock {
  static constexpr int width = 64 / sizeof(Real);
  using Row = std::array<Real, std::size_t(width)>;

  std::array<std::array<Index, std::size_t(width)>, 8> nodes{};
  Row V{};                     // [m³]; 0 in empty lanes
  std::array<Row, 12> mean{};  // Ḡ_k, function by function
  std::array<Row, 78> K{};     // upper triangle, row by row
};

struct CellLaw {
  double lambda, mu, kappa;  // [Pa]; the volume term is κ v |v| as in lobe/fem/volume_term.h
  double slope;              // 2/h [1/m]
};

// q: four numbers per node, the last of which is a pad [m]; f likewise, to which forces are added [N].
void add_cell_forces(const std::vector<CellBlock<float>>& blocks, const CellLaw& law, const float* q,
                     float* f);
void add_cell_forces(const std::vector<CellBlock<double>>& blocks, const CellLaw& law, const double* q,
                     double* f);

}  // namespace lobe::reduced
