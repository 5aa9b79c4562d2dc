#include "lobe/lattice/lattice_cells.h"

#include <algorithm>

#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"

namespace lobe {
// A block has cells of one material; its empty lanes have the nodes of its first cell.
template <class Real>
void LatticeCells<Real>::build(const Elements& elements, const Lattice& lattice,
                               const std::vector<LatticeCell>& cells) {
  constexpr int width = CellBlock<Real>::width;
  cells_.clear();
  blocks_.clear();
  laws_.clear();
  q_.assign(std::size_t(lattice.node_count()), {});
  std::vector<std::vector<Index>> places(std::size_t(lattice.node_count()));
  int used = width;
  for (const LatticeCell& cell : cells) {
    const Lattice::Part& part = lattice.parts[std::size_t(cell.part)];
    const bool is_other = cells_.empty() || cells_.back().part.material != part.material;
    cells_.push_back({cell, part, nonlinear_law(elements, cell.tet), 0});
    if (used == width || is_other) {
      blocks_.emplace_back();
      laws_.push_back(cells_.back().law.template as<Real>());
      for (int n = 0; n < 8; ++n) blocks_.back().nodes[std::size_t(n)].fill(part.nodes[std::size_t(n)]);
      used = 0;
    }
    CellBlock<Real>& block = blocks_.back();
    const auto lane = std::size_t(used++);
    cells_.back().slot = (blocks_.size() - 1) * width + lane;
    block.volume[lane] = static_cast<Real>(cell.volume);
    for (int n = 0; n < 8; ++n) {
      const Index node = part.nodes[std::size_t(n)];
      block.nodes[std::size_t(n)][lane] = node;
      places[std::size_t(node)].push_back(place(cells_.back().slot, n));
      for (int k = 0; k < 3 && n > 0; ++k)
        block.gradients[std::size_t(3 * (n - 1) + k)][lane] = static_cast<Real>(cell.gradients(n, k));
    }
    for (int n = 1, entry = 0; n < 8; ++n)
      for (int m = 1; m <= n; ++m, ++entry)
        block.fluctuation[std::size_t(entry)][lane] = static_cast<Real>(cell.fluctuation(n, m));
  }
  forces_.assign(blocks_.size() * 8 * width, {});
  places_begin_.assign(1, 0);
  places_.clear();
  for (const std::vector<Index>& own : places) {
    places_.insert(places_.end(), own.begin(), own.end());
    places_begin_.push_back(static_cast<Index>(places_.size()));
  }
}

// Where PaddedVectors::store() puts the force of a lane.
template <class Real>
Index LatticeCells<Real>::place(std::size_t slot, int corner) const {
  constexpr int width = CellBlock<Real>::width;
  const int lane = int(slot % width), lanes = kernels_.lanes, own = lane % lanes;
  const int offset = lanes % 4 != 0 ? own : lanes / 4 * (own % 4) + own / 4;
  return static_cast<Index>((slot / width * 8 + std::size_t(corner)) * width) + lane - own + offset;
}

template <class Real>
CellArrays<Real> LatticeCells<Real>::at(const Mat3X<Real>& q) {
  for (std::size_t n = 0; n < q_.size(); ++n) {
    const Real* own = q.data() + 3 * n;
    q_[n].xyz0 = {own[0], own[1], own[2], 0};
  }
  return {blocks_.data(), laws_.data(), q_.data()};
}

template <class Real>
void LatticeCells<Real>::find_forces(const Mat3X<Real>& q, Parallel& parallel) {
  const CellArrays<Real> arrays = at(q);
  parallel.for_ranges(static_cast<Index>(blocks_.size()), 8, [&](Index begin, Index end) {
    kernels_.find_forces(arrays, forces_.data(), begin, end);
  });
}

template <class Real>
Vec3<Real> LatticeCells<Real>::force(Index node) const {
  Vec3<Real> sum = Vec3<Real>::Zero();
  for (Index i = places_begin_[std::size_t(node)]; i < places_begin_[std::size_t(node) + 1]; ++i) {
    const auto& own = forces_[std::size_t(places_[std::size_t(i)])].xyz0;
    sum += Vec3<Real>(own[0], own[1], own[2]);
  }
  return sum;
}

template <class Real>
Mat3<double> LatticeCells<Real>::gradient(const Cell& data, const Mat3X<Real>& q) const {
  Mat3<double> H = Mat3<double>::Zero();
  for (int n = 0; n < 8; ++n)
    H += q.col(data.part.nodes[std::size_t(n)]).template cast<double>() * data.cell.gradients.row(n);
  return H;
}

template <class Real>
double LatticeCells<Real>::energy(const Mat3X<Real>& q) const {
  double sum = 0;
  for (const Cell& data : cells_) {
    Eigen::Matrix<double, 3, 8> at;
    for (int n = 0; n < 8; ++n)
      at.col(n) =
          (q.col(data.part.nodes[std::size_t(n)]) - q.col(data.part.nodes[0])).template cast<double>();
    sum += data.cell.volume * law_energy_density(data.law, gradient(data, q)) +
           0.5 * (at * data.cell.fluctuation).cwiseProduct(at).sum();
  }
  return sum;
}

template <class Real>
typename LatticeCells<Real>::Smallest LatticeCells<Real>::add_bounds(const Mat3X<Real>& q,
                                                                     std::vector<double>& bounds) {
  constexpr auto width = std::size_t(CellBlock<Real>::width);
  std::vector<CellTangents<Real>> of_blocks(blocks_.size());
  kernels_.find_tangents(at(q), of_blocks.data(), 0, static_cast<Index>(blocks_.size()));
  Smallest smallest;
  for (const Cell& data : cells_) {
    const CellTangents<Real>& found = of_blocks[data.slot / width];
    const std::size_t lane = data.slot % width;
    const auto ratio = double(found.volume_ratio[lane]);
    if (ratio < smallest.volume_ratio) smallest = {ratio, data.cell.tet};
    CellWeights tangents;
    for (int n = 0; n < 8; ++n) tangents[n] = double(found.bounds[std::size_t(n)][lane]);
    lobe::add_bounds(data.cell, data.part, tangents, bounds);
  }
  return smallest;
}

template class LatticeCells<float>;
template class LatticeCells<double>;

}  // namespace lobe
