// The depths h at which contact is held (contact_law.h), one for each point of the surface where it touches.
// Within a triangle h is linear. With w_qp the weight of point p in the q-th point where contact is
// evaluated,
//   h_q = Σ_p w_qp h_p,  ḣ_p = ρ Σ_q κ A_q w_qp d_q / Σ_q κ A_q w_qp,
// so that what is held brings the mean depth around each point to 0. It cannot bring each d_q to 0, since
// flat triangles do not follow a curved tool. The means are a projection of the depths, so they are no
// larger, and ρ has the same bound as in contact_law.h.
#pragma once

#include <utility>

#include "lobe/contact/contact_law.h"
#include "lobe/contact/contact_surface.h"

namespace lobe {

class HeldDepths {
 public:
  // ---- Of the last step

  bool any() const { return !kept_.empty(); }
  double most() const { return most_; }  // [m]
  // Call it before at(), with the surface of now. O(1) unless that is another.
  void use(const ContactSurface& surface);
  double at(const Eigen::Vector3i& points, const Vec3d& weights) const {  // h_q [m]
    return weights[0] * now_[std::size_t(points[0])] + weights[1] * now_[std::size_t(points[1])] +
           weights[2] * now_[std::size_t(points[2])];
  }

  // ---- An evaluation of forces

  void begin();
  // A point of a triangle touches; k = κ A_q [N/m].
  void add(int triangle, const Eigen::Vector3i& points, const Vec3d& weights, double k, double depth);
  // After all of them; since the last step of `time` [s].
  void end(const ContactSurface& surface, const ContactLaw& law, double time);
  void end_step();  // what the last evaluation has found holds from now on

  // ---- What is kept: by the owners of triangles, since points have other numbers after a cut

  struct OfTriangle {
    Index tet = -1;
    std::uint32_t code = 0;       // FaceOwner
    Vec3d depth = Vec3d::Zero();  // depths of its points [m]
    bool is_valid() const { return depth.allFinite() && depth.minCoeff() >= 0; }
    static constexpr auto fields = std::tuple(&OfTriangle::tet, &OfTriangle::code, &OfTriangle::depth);
  };
  const std::vector<OfTriangle>& kept() const { return kept_; }  // in the order of the surface
  void set(std::vector<OfTriangle> kept) {
    kept_ = std::move(kept);
    revision_ = 0;
  }

 private:
  struct Sum {
    double depth = 0, weight = 0;
  };
  std::vector<OfTriangle> kept_, next_;
  double most_ = 0, next_most_ = 0;
  std::uint64_t revision_ = 0;  // revision of the surface whose points these are
  std::vector<double> now_;     // per point of the surface
  std::vector<Sum> sums_;
  std::vector<int> triangles_;             // triangles that touch
  std::vector<int> points_, next_points_;  // points where now_, sums_ are not 0
};

}  // namespace lobe
