#include "lobe/contact/part_motion.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "lobe/numerics/symmetric_eigen.h"

namespace lobe {

std::vector<int> divide(const std::vector<Vec3d>& points, int most) {
  std::vector<int> part_of(points.size(), 0), order(points.size());
  std::iota(order.begin(), order.end(), 0);
  int parts = 0;
  struct Range {
    std::size_t begin, end;
  };
  std::vector<Range> left;
  if (!points.empty()) left.push_back({0, points.size()});
  while (!left.empty()) {
    const Range range = left.back();
    left.pop_back();
    if (range.end - range.begin <= std::size_t(most)) {
      for (std::size_t i = range.begin; i < range.end; ++i) part_of[std::size_t(order[i])] = parts;
      ++parts;
      continue;
    }
    Vec3d low = points[std::size_t(order[range.begin])], high = low;
    for (std::size_t i = range.begin; i < range.end; ++i) {
      low = low.cwiseMin(points[std::size_t(order[i])]);
      high = high.cwiseMax(points[std::size_t(order[i])]);
    }
    int axis;
    (high - low).maxCoeff(&axis);
    const std::size_t middle = (range.begin + range.end) / 2;
    std::nth_element(order.begin() + long(range.begin), order.begin() + long(middle),
                     order.begin() + long(range.end), [&](int a, int b) {
                       return std::pair(points[std::size_t(a)][axis], a) <
                              std::pair(points[std::size_t(b)][axis], b);
                     });
    left.push_back({middle, range.end});
    left.push_back({range.begin, middle});
  }
  return part_of;
}

void PartMotion::set_parts(const std::vector<std::vector<int>>& points) {
  parts_.clear();
  groups_.clear();
  for (const std::vector<int>& own : points) {
    const auto groups = (static_cast<int>(own.size()) + 3) / 4;
    parts_.push_back({.first = static_cast<int>(groups_.size()), .count = groups});
    for (std::size_t i = 0; i < own.size(); i += 4) {
      Group& group = groups_.emplace_back();
      for (std::size_t k = 0; k < 4; ++k) {
        group.points[long(k)] = own[std::min(i + k, own.size() - 1)];
        group.share[long(k)] = i + k < own.size() ? 1 / static_cast<float>(own.size()) : 0;
      }
    }
  }
  now_.resize(groups_.size());
  for (int axis = 0; axis < 3; ++axis) {
    low_[axis].assign(parts_.size(), 0);
    high_[axis].assign(parts_.size(), 0);
  }
}

void PartMotion::load(const Group& group, const float* x, Eigen::Array<float, 4, 3>& now) {
  Eigen::Array4f of[4];
  for (int k = 0; k < 4; ++k) of[k] = Eigen::Map<const Eigen::Array4f>(x + 4 * std::size_t(group.points[k]));
  for (int k = 0; k < 4; ++k) now.row(k) = of[k].head<3>();
}

void PartMotion::remember(const float* x) {
  const auto place = [&](int point) -> Vec3d {
    return Eigen::Map<const Vec3<float>>(x + 4 * std::size_t(point)).cast<double>();
  };
  for (Part& part : parts_) {
    part.centre.setZero();
    for (int i = part.first; i < part.first + part.count; ++i)
      for (int k = 0; k < 4; ++k)
        part.centre += double(groups_[std::size_t(i)].share[k]) * place(groups_[std::size_t(i)].points[k]);
    Mat3<double> moment = Mat3<double>::Zero();
    part.radius = 0;
    for (int i = part.first; i < part.first + part.count; ++i) {
      Group& group = groups_[std::size_t(i)];
      for (int k = 0; k < 4; ++k) {
        const Vec3d X = place(group.points[k]) - part.centre;
        group.then.row(k) = X.cast<float>().array();
        part.radius = std::max(part.radius, X.norm());
        if (group.share[k] > 0) moment += X * X.transpose();
      }
    }
    // Where all lie in a plane, H has nothing across it.
    moment.diagonal().array() += 1e-4 * moment.trace() + std::numeric_limits<double>::min();
    const Mat3<double> inverse = moment.inverse();
    for (int i = part.first; i < part.first + part.count; ++i) {
      Group& group = groups_[std::size_t(i)];
      for (int k = 0; k < 4; ++k) {
        const Vec3d X = group.then.row(k).cast<double>().transpose();
        group.fit.row(k) = (inverse * X).cast<float>().array();
        if (group.share[k] == 0) group.fit.row(k).setZero();
      }
    }
  }
  measure(x);
}

void PartMotion::measure(const float* x) {
  for (std::size_t i = 0; i < groups_.size(); ++i) load(groups_[i], x, now_[i]);
  for (Part& part : parts_) fit(part);
  float size = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t p = 0; p < parts_.size(); ++p)
      size = std::max({size, std::abs(low_[axis][p]), std::abs(high_[axis][p])});
  rounding_ = 4e-6 * double(size);
}

void PartMotion::fit(Part& part) {
  const auto p = std::size_t(&part - parts_.data());
  const auto end = std::size_t(part.first + part.count);
  float place[3], gradient[3][3];
  for (int i = 0; i < 3; ++i) {
    Lanes sum = Lanes::Zero(), x = sum, y = sum, z = sum,
          low = Lanes::Constant(std::numeric_limits<float>::infinity()), high = -low;
    for (auto g = std::size_t(part.first); g < end; ++g) {
      const Group& group = groups_[g];
      const Lanes now = now_[g].col(i), moved = now - group.then.col(i);
      low = low.min(now);
      high = high.max(now);
      sum += group.share * moved;
      x += moved * group.fit.col(0);
      y += moved * group.fit.col(1);
      z += moved * group.fit.col(2);
    }
    low_[i][p] = low.minCoeff();
    high_[i][p] = high.maxCoeff();
    place[i] = sum.sum();
    gradient[i][0] = x.sum();
    gradient[i][1] = y.sum();
    gradient[i][2] = z.sum();
  }
  Lanes centre[3], H[3][3], farthest = Lanes::Zero();
  for (int i = 0; i < 3; ++i) {
    centre[i].setConstant(place[i]);
    for (int j = 0; j < 3; ++j) H[i][j].setConstant(gradient[i][j]);
  }
  for (auto g = std::size_t(part.first); g < end; ++g) {
    const Lanes X = groups_[g].then.col(0), Y = groups_[g].then.col(1), Z = groups_[g].then.col(2);
    const Lanes x = now_[g].col(0) - X - centre[0] - H[0][0] * X - H[0][1] * Y - H[0][2] * Z;
    const Lanes y = now_[g].col(1) - Y - centre[1] - H[1][0] * X - H[1][1] * Y - H[1][2] * Z;
    const Lanes z = now_[g].col(2) - Z - centre[2] - H[2][0] * X - H[2][1] * Y - H[2][2] * Z;
    farthest = farthest.max(x * x + y * y + z * z);
  }
  part.remainder = std::sqrt(double(farthest.maxCoeff()));
  for (int i = 0; i < 3; ++i) {
    part.place[i] = double(place[i]);
    for (int j = 0; j < 3; ++j) part.H(i, j) = double(gradient[i][j]);
  }
  const Mat3<double> E = part.H + part.H.transpose() + part.H.transpose() * part.H;
  const double least = 1 - E.norm();  // of the squares of the singular values
  part.share =
      least > 0.8
          ? std::sqrt(least)
          : std::sqrt(std::max(0.0, direct_symmetric_eigenvalues(E + Mat3<double>::Identity())[0] - 1e-6));
  if (!std::isfinite(part.remainder)) part.share = 0;
}

// With boxes, a point of B that is by e outside of where B is within w of A is by w + e outside of A.
auto PartMotion::meeting(int a, int b, double within) const -> Meeting {
  const auto of = [&](int first, int second) -> Meeting {
    Vec3d low, high;
    for (int i = 0; i < 3; ++i) {
      const auto f = std::size_t(first), s = std::size_t(second);
      low[i] = std::max(double(low_[i][s]), double(low_[i][f]) - within) - rounding_;
      high[i] = std::min(double(high_[i][s]), double(high_[i][f]) + within) + rounding_;
    }
    const Vec3d centre = (low + high) / 2;
    return {first, second, centre - parts_[std::size_t(first)].centre,
            centre - parts_[std::size_t(second)].centre, (high - low).norm() / 2};
  };
  const Meeting in_b = of(a, b), in_a = of(b, a);
  const Meeting& smaller = in_a.radius < in_b.radius ? in_a : in_b;
  return smaller.radius < parts_[std::size_t(smaller.b)].radius ? smaller : all_of(smaller.a, smaller.b);
}

auto PartMotion::all_of(int a, int b) const -> Meeting {
  const Part &A = parts_[std::size_t(a)], &B = parts_[std::size_t(b)];
  return {a, b, B.centre - A.centre, Vec3d::Zero(), B.radius};
}

auto PartMotion::bound(const Meeting& meeting) const -> Bound {
  const Part &A = parts_[std::size_t(meeting.a)], &B = parts_[std::size_t(meeting.b)];
  if (meeting.a == meeting.b) return {A.share, 2 * A.remainder + rounding_};
  const Vec3d between =
      A.place + meeting.of_a + A.H * meeting.of_a - B.place - meeting.of_b - B.H * meeting.of_b;
  const double turn = (A.H - B.H).norm();
  // Beyond the ball points are farther apart, but not if the motions differ by more than all.
  const double radius = turn > A.share ? meeting.of_b.norm() + B.radius : meeting.radius;
  return {A.share, A.remainder + B.remainder + between.norm() + turn * radius + rounding_};
}

void PartMotion::find_box_distances(int a, std::vector<float>& squares) const {
  squares.resize(parts_.size());
  const auto p = std::size_t(a);
  const float low[3]{low_[0][p], low_[1][p], low_[2][p]}, high[3]{high_[0][p], high_[1][p], high_[2][p]};
  const auto margin = static_cast<float>(rounding_);
  for (std::size_t b = p + 1; b < parts_.size(); ++b) {
    float square = 0;
    for (int i = 0; i < 3; ++i) {
      const float gap = std::max(std::max(low_[i][b] - high[i], low[i] - high_[i][b]) - margin, 0.0F);
      square += gap * gap;
    }
    squares[b] = square;
  }
}

}  // namespace lobe
