#include "benchmarks/validation/quadrature.h"

namespace lobe::validation {
namespace {

std::vector<TetPoint> walkington() {
  std::vector<TetPoint> points;
  for (const auto& [a, weight] : {std::pair(0.31088591926330060980, 0.11268792571801585080),
                                  std::pair(0.09273525031089122640, 0.07349304311636194954)})
    for (int i = 0; i < 4; ++i) {
      points.push_back({Eigen::Vector4d::Constant(a), weight});
      points.back().barycentric[i] = 1 - 3 * a;
    }
  const double a = 0.04550370412564964949, weight = 0.04254602077708146644;
  for (int i = 0; i < 4; ++i)
    for (int j = i + 1; j < 4; ++j) {
      points.push_back({Eigen::Vector4d::Constant(a), weight});
      points.back().barycentric[i] = points.back().barycentric[j] = 0.5 - a;
    }
  return points;
}

std::vector<TrianglePoint> dunavant() {
  std::vector<TrianglePoint> points;
  for (const auto& [a, weight] : {std::pair(0.44594849091596488632, 0.22338158967801146570),
                                  std::pair(0.09157621350977074346, 0.10995174365532186764)})
    for (int i = 0; i < 3; ++i) {
      points.push_back({Vec3d::Constant(a), weight});
      points.back().barycentric[i] = 1 - 2 * a;
    }
  return points;
}

}  // namespace

const std::vector<TetPoint>& tet_quadrature() {
  static const std::vector<TetPoint> points = walkington();
  return points;
}

const std::vector<TrianglePoint>& triangle_quadrature() {
  static const std::vector<TrianglePoint> points = dunavant();
  return points;
}

}  // namespace lobe::validation
