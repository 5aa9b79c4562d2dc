#include "lobe/scalpel/orientation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

namespace lobe {
namespace {

// A sum of doubles that do not overlap, smallest first: its sign is that of the last.
class ExactSum {
 public:
  void add(double x) {
    for (double& part : parts_) {
      const double sum = part + x, virtual_x = sum - part;
      part = (part - (sum - virtual_x)) + (x - virtual_x);
      x = sum;
    }
    std::erase(parts_, 0);
    if (x != 0) parts_.push_back(x);
  }

  void add_product(double x, double y, double z) {
    const double xy = x * y, rest = std::fma(x, y, -xy);
    for (const double factor : {rest, xy}) {
      const double product = factor * z;
      add(std::fma(factor, z, -product));
      add(product);
    }
  }

  int sign() const { return parts_.empty() ? 0 : parts_.back() > 0 ? 1 : -1; }

 private:
  std::vector<double> parts_;
};

void add_determinant(const Vec3d& a, const Vec3d& b, const Vec3d& c, double sign, ExactSum& sum) {
  constexpr int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (int i = 0; i < 6; ++i)
    sum.add_product(i < 3 ? sign * a[orders[i][0]] : -sign * a[orders[i][0]], b[orders[i][1]],
                    c[orders[i][2]]);
}

// det[a − d, b − d, c − d] = [a b c] − [b c d] + [a c d] − [a b d] in 24 products of coordinates.
int exact_orientation(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  ExactSum sum;
  add_determinant(a, b, c, 1, sum);
  add_determinant(b, c, d, -1, sum);
  add_determinant(a, c, d, 1, sum);
  add_determinant(a, b, d, -1, sum);
  return sum.sign();
}

// The sign of the first component of (b − a) × (d − c) that is not zero, exactly.
int first_sign_of_cross(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    ExactSum sum;
    for (const auto& [x, y, sign] : {std::tuple(&b, &d, 1.0), std::tuple(&b, &c, -1.0),
                                     std::tuple(&a, &d, -1.0), std::tuple(&a, &c, 1.0)}) {
      sum.add_product((*x)[i], (*y)[j], sign);
      sum.add_product((*x)[j], (*y)[i], -sign);
    }
    if (sum.sign() != 0) return sum.sign();
  }
  return 0;
}

}  // namespace

int orientation(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const Vec3d u = a - d, v = b - d, w = c - d;
  const double determinant = u.dot(v.cross(w));
  const double size = std::abs(u[0]) * (std::abs(v[1] * w[2]) + std::abs(v[2] * w[1])) +
                      std::abs(u[1]) * (std::abs(v[2] * w[0]) + std::abs(v[0] * w[2])) +
                      std::abs(u[2]) * (std::abs(v[0] * w[1]) + std::abs(v[1] * w[0]));
  constexpr double rounding = 1e-15;  // above 7.8e-16, the bound of all roundings on the way
  if (std::abs(determinant) > rounding * size) return determinant > 0 ? 1 : -1;
  return exact_orientation(a, b, c, d);
}

// det[a − d, b − d, c − d] changes by −e·((b − a) × (c − a)) if d moves by e.
int side_of_plane(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const int sign = orientation(a, b, c, d);
  return sign != 0 ? sign : -first_sign_of_cross(a, b, a, c);
}

// And by −e·((b − a) × (c − d)) if c and d do.
int side_of_line(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const int sign = orientation(a, b, c, d);
  return sign != 0 ? sign : -first_sign_of_cross(a, b, d, c);
}

}  // namespace lobe
