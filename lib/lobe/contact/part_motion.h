// Parts of a body, and how much nearer any two may have come, from the motion of their vertices alone.
//
// Since remember() each part has moved by the affine motion that fits its vertices best, and a remainder:
//   x = a(X) + r,  a(X) = c + (I + H) (X − C),  |r| ≤ ρ,  C and c its centre then and now.
// An affine motion makes a distance shorter by a factor of no less than σ, the least singular value of I + H.
// So points of the parts A and B that were g apart are now apart by at least
//   σ_A g − ρ_A − ρ_B − max |a_A(X) − a_B(X)| over X in B,
// and if g is at most w, X need only be where B is within w of A.
// If the whole body moves rigidly, that bound is g. If it is strained uniformly, the bound is σ g. Parts that
// are far from each other are bounded by their boxes as well.
//
// Cost: some 4 ns per vertex and 20 ns per pair of parts.
#pragma once

#include <vector>

#include "lobe/types.h"

namespace lobe {

// Divides points into parts of at most `most`, halved again and again along the longest side of their box:
// the part of each point.
std::vector<int> divide(const std::vector<Vec3d>& points, int most);

class PartMotion {
 public:
  // A lower bound of a present distance, from the distance `then` at remember() [m].
  struct Bound {
    double share = 1, approach = 0;
    double now(double then) const { return share * then - approach; }
  };

  void set_parts(const std::vector<std::vector<int>>& points);  // points of each part: numbers of x below
  int count() const { return static_cast<int>(parts_.size()); }
  // x: places of points about one of the body, so that single precision suffices wherever that is; four
  // numbers each, of which the last is not used [m].
  void remember(const float* x);
  void measure(const float* x);

  // Two parts a and b, and a ball that contains b, or at least the points of b that lay within a distance w
  // of a at remember(). bound() holds for pairs of points that were at most w apart. All other pairs are now
  // at least bound().now(w) apart.
  struct Meeting {
    int a = 0, b = 0;
    Vec3d of_a = Vec3d::Zero(), of_b = Vec3d::Zero();  // the centre, from those of the parts [m]
    double radius = 0;
  };
  Meeting meeting(int a, int b, double within) const;  // motion between remember() and measure()
  Meeting all_of(int a, int b) const;
  Bound bound(const Meeting& meeting) const;
  Bound bound(int a, int b) const { return bound(all_of(a, b)); }
  bool meets_box(int part, const Vec3<float>& low, const Vec3<float>& high) const {
    const auto p = std::size_t(part);
    for (int i = 0; i < 3; ++i)
      if (low_[i][p] > high[i] || high_[i][p] < low[i]) return false;
    return true;
  }
  double rounding() const { return rounding_; }  // a generous bound of the rounding of bounds [m]
  // Finds squares[b], bounds below the squared distances of the boxes of a and each part b after it [m²].
  void find_box_distances(int a, std::vector<float>& squares) const;

 private:
  using Lanes = Eigen::Array4f;
  struct Part {
    int first = 0, count = 0;      // groups of four points
    Vec3d centre = Vec3d::Zero();  // then
    double radius = 0;             // radius of the points about it, at remember() [m]
    Vec3d place = Vec3d::Zero();   // place of the centre now
    Mat3<double> H = Mat3<double>::Zero();
    double remainder = 0, share = 1;  // ρ [m], σ
  };
  struct Group {
    Eigen::Vector4i points;               // columns; the last perhaps several times
    Eigen::Array<float, 4, 3> then, fit;  // X − C [m]; by which displacements are multiplied for H [1/m]
    Lanes share;                          // share of each point in the mean
  };
  static void load(const Group& group, const float* x, Eigen::Array<float, 4, 3>& now);
  void fit(Part& part);

  std::vector<Part> parts_;
  std::vector<Group> groups_;
  double rounding_ = 0;                  // [m]
  std::vector<float> low_[3], high_[3];  // boxes of the parts [m]
  std::vector<Eigen::Array<float, 4, 3>> now_;
};

}  // namespace lobe
