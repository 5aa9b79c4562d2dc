#include "lobe/numerics/symmetric_product.h"

#include <algorithm>
#include <cstdint>

namespace lobe {

template <class Real>
void SymmetricProduct<Real>::set(const Eigen::Ref<const Eigen::MatrixXd>& S) {
  constexpr Index columns = SymmetricHalf::panel_columns, rows = SymmetricHalf::tile_rows;
  const auto n = static_cast<Index>(S.rows());
  shape_ = {n};
  tiles_.assign(std::size_t(shape_.tiles_before(shape_.panels())) * SymmetricHalf::tile_size, 0);
  diagonal_.assign(std::size_t(shape_.padded()), 0);
  for (Index j = 0; j < n; ++j) {
    const Index panel = j / columns, first_tile = panel * columns / rows;
    Real* column = tiles_.data() + std::size_t(shape_.tiles_before(panel)) * SymmetricHalf::tile_size +
                   j % columns * rows;
    for (Index i = j + 1; i < n; ++i)
      column[std::size_t(i / rows - first_tile) * SymmetricHalf::tile_size + i % rows] =
          static_cast<Real>(S(i, j));
    diagonal_[j] = static_cast<Real>(S(j, j));
  }
  divide();
  x_.assign(std::size_t(shape_.padded()), 0);
  y_ = x_;
  sums_.assign((parts_.size() - 1) * std::size_t(shape_.padded()), 0);
}

// Divides the panels into parts of equal size, so many that it is worth waking threads for them.
template <class Real>
void SymmetricProduct<Real>::divide() {
  constexpr Index tiles_of_part = 4096;  // some 30 us
  const Index panels = shape_.panels(), tiles = shape_.tiles_before(panels);
  const Index count = std::clamp<Index>(tiles / tiles_of_part, 1, 16);
  parts_.assign(1, 0);
  for (Index p = 1; p < count; ++p) {
    Index next = parts_.back();
    while (shape_.tiles_before(next) < std::int64_t(tiles) * p / count) ++next;
    parts_.push_back(next);
  }
  parts_.push_back(panels);
}

// Each part has sums of its own, which are added in order.
template <class Real>
const std::vector<Real>& SymmetricProduct<Real>::multiply(Parallel& parallel) {
  const Index parts = static_cast<Index>(parts_.size()) - 1, padded = shape_.padded();
  parallel.for_ranges(parts, 1, [&](Index begin, Index end) {
    for (Index p = begin; p < end; ++p) {
      Real* sums = sums_.data() + std::size_t(p) * padded;
      std::fill_n(sums, padded, Real(0));
      kernels_.symmetric_product(tiles_.data(), shape_, x_.data(), parts_[p], parts_[p + 1], sums);
    }
  });
  for (Index i = 0; i < padded; ++i) y_[i] = diagonal_[i] * x_[i];
  for (Index p = 0; p < parts; ++p)
    for (Index i = 0; i < padded; ++i) y_[i] += sums_[std::size_t(p) * padded + i];
  return y_;
}

template class SymmetricProduct<float>;
template class SymmetricProduct<double>;

}  // namespace lobe
