#include "axes.h"

#include <algorithm>
#include <cmath>

#include "lobe/error.h"

namespace lobe::c {

Axes::Axes(const double* rows) {
  if (std::all_of(rows, rows + 12, [](double value) { return value == 0; })) return;
  const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> all(rows);
  const Mat3<double> A = all.leftCols<3>();
  scale_ = std::cbrt(std::abs(A.determinant()));
  if (!all.allFinite() || !(scale_ > 0) ||
      !(A * A.transpose()).isApprox(scale_ * scale_ * Mat3<double>::Identity(), 1e-9))
    throw InputError("options.axes", "must be a turn or a mirroring, times a scale above 0");
  turn_ = A / scale_;
  shift_ = all.col(3);
}

}  // namespace lobe::c
