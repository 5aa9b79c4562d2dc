// Which of the close pairs (gap_watch.h) are so near now that they may touch soon. The answer depends on
// where the body is, not on when it was searched.
#pragma once

#include <cstdint>
#include <utility>

#include "lobe/contact/gap_watch.h"

namespace lobe {

class SelfNear {
 public:
  SelfNear(const SelfRest& rest, const PairSearch& search, const GapWatch& watch)
      : rest_(rest), search_(search), watch_(watch) {}

  void rebuild() { inverses_.assign(rest_.boundary.tets().size(), {}); }  // after that of `rest`
  // triangle(number in the surface), tetrahedron(corners) of each such pair.
  template <class Triangle, class Tetrahedron>
  void visit(const SelfAt& at, Triangle&& triangle, Tetrahedron&& tetrahedron);

 private:
  struct Inverse {  // inverse map of a tetrahedron where it is now
    Vec3d origin = Vec3d::Zero();
    Mat3<double> to_weights = Mat3<double>::Zero();
    Eigen::Vector4d heights = Eigen::Vector4d::Zero();  // [m]
    bool is_sound = false;                              // it is neither flat nor inverted
    int visit = -1;                                     // number of the last visit that asked for it
    Eigen::Vector4d weights(const Vec3d& x) const;      // barycentric coordinates
    double gap(const Eigen::Vector4d& weights) const { return (-weights.cwiseProduct(heights)).maxCoeff(); }
  };

  Mat34<double> corners_of(const Places& now, int layer) const;
  const Inverse& inverse(const Mat34<double>& corners, int layer);
  bool is_parted(int pair, const Mat34<double>& tet, const Mat3<double>& points);
  bool is_near(const Mat3<double>& triangle, int divisions, const Mat34<double>& tet, int layer);

  const SelfRest& rest_;
  const PairSearch& search_;
  const GapWatch& watch_;

  std::vector<std::uint8_t> faces_;  // per pair: the face whose plane parted it last
  int search_number_ = 0;            // number of the search whose pairs these are

  // Scratch of a visit.
  int visit_ = 0;                  // its number
  std::vector<Inverse> inverses_;  // per layer
};

template <class Triangle, class Tetrahedron>
void SelfNear::visit(const SelfAt& at, Triangle&& triangle, Tetrahedron&& tetrahedron) {
  ++visit_;
  if (std::exchange(search_number_, search_.number()) != search_.number()) {
    faces_.clear();
    for (const PairSearch::Pair& pair : search_.pairs()) faces_.push_back(pair.face);
  }
  for (const ClosePairs::OfCandidate& ones : watch_.close().candidates) {
    const auto& [number, owner, divisions, first, count] = search_.candidates()[std::size_t(ones.candidate)];
    Mat3<double> x;
    for (int c = 0; c < 3; ++c)
      x.col(c) = at.places.of_point(at.surface.triangles()[std::size_t(number)].points[c]);
    const Mat3<double> points = outermost(x);
    bool is_any_near = false;
    for (int i : watch_.close().of(ones)) {
      const int layer = search_.pairs()[std::size_t(i)].layer;
      const Mat34<double> tet = corners_of(at.places, layer);
      if (is_parted(i, tet, points) || !is_near(x, divisions, tet, layer)) continue;
      is_any_near = true;
      tetrahedron(rest_.layer(layer).corners);
    }
    if (is_any_near) triangle(number);
  }
}

}  // namespace lobe
