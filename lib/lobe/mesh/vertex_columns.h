// A matrix of one column per vertex, or per tetrahedron, with spare columns behind them. So a cut that adds
// columns seldom copies the others. Spare columns are never touched, so they take no memory.
#pragma once

#include <Eigen/Core>

#include "lobe/types.h"

namespace lobe {

template <class Matrix>  // Matrix: a type with a fixed number of rows
class VertexColumns {
 public:
  using View = Eigen::Map<const Matrix>;

  explicit VertexColumns(Index count = 0) : padded_(rows, with_spare(count)), count_(count) {
    view().setZero();
  }
  explicit VertexColumns(const Matrix& columns) : VertexColumns(static_cast<Index>(columns.cols())) {
    view() = columns;
  }

  Index count() const { return count_; }
  void extend(Index count) {  // new columns are zero
    if (count > padded_.cols()) padded_.conservativeResize(rows, with_spare(count));
    if (count > count_) padded_.middleCols(count_, count - count_).setZero();
    count_ = count;
  }

  auto col(Index vertex) { return padded_.col(vertex); }
  auto col(Index vertex) const { return padded_.col(vertex); }
  auto& operator()(int row, Index vertex) { return padded_(row, vertex); }
  const auto& operator()(int row, Index vertex) const { return padded_(row, vertex); }

  // The columns of the vertices alone; until the next extend().
  View view() const { return {padded_.data(), rows, count_}; }
  Eigen::Map<Matrix> view() { return {padded_.data(), rows, count_}; }

  // The columns with the spare ones, for code that takes a matrix and finds columns by the vertices' numbers.
  const Matrix& padded() const { return padded_; }
  Matrix& padded() { return padded_; }

 private:
  static constexpr Eigen::Index rows = Matrix::RowsAtCompileTime;
  static Eigen::Index with_spare(Index count) { return Eigen::Index(count) + count / 4; }

  Matrix padded_;
  Index count_ = 0;
};

}  // namespace lobe
