// The boundary of a body as contact sees it: triangles between points that are vertices of the mesh, or lie
// within a tetrahedron where a blade has cut, and how stiff contact may be there.
//
// Contact is as stiff as the stable step allows. A vertex v of mass m whose own frequency at rest is ω_v may
// be given
//   k_v = max(θ φ, φ − r² ω_v²/ω_max²) ω_max² m_v,   θ = 0.05,  φ = 1.15,
// and contact of v with a rigid body then leaves the highest frequency of the body, ω_max, about where it is:
// by Gershgorin's theorem ω² ≤ ω_max² + max k_v/m_v in the worst case. r is ω_max over the largest ω_v. φ is
// above 1 since a vertex that moves against its neighbours moves with some of them, too. Per
// area that is κ_v = k_v/A_v, A_v the area around v; a triangle has the least κ of its corners.
//
// Beside selective masses contact is softer (softening.h).
#pragma once

#include <algorithm>

#include "lobe/forces/force_term.h"

namespace lobe {

class ContactSurface {
 public:
  struct Point {  // x = Σ weights[i] x_corner[i]
    Eigen::Vector4i corners = Eigen::Vector4i::Zero();
    Eigen::Vector4d weights{1, 0, 0, 0};
    int count = 1;  // number of corners: 1, or 4 for a point within a tetrahedron
  };
  struct Triangle {
    Eigen::Vector3i points;
    FaceOwner owner;
    double area = 0;        // area at rest [m²]
    double longest = 0;     // longest edge at rest [m]
    double stiffness = 0;   // κ [Pa/m]
    bool is_cut = false;    // whether it was inside at the start
    std::uint8_t body = 0;  // number of its body among several (MeshBodies)
  };

  // Whether the boundary, the masses or the degree of selective masses have changed since rebuild().
  bool is_outdated(const BodyView& now) const;
  // Builds the surface in an order that depends on the body alone, not on the edits before. O(#triangles log
  // #triangles).
  void rebuild(const BodyView& now);

  std::uint64_t revision() const { return revision_; }  // grows with each rebuild
  const std::vector<Triangle>& triangles() const { return triangles_; }
  const std::vector<Point>& points() const { return points_; }
  double mean_edge() const { return mean_edge_; }  // at rest [m]
  std::size_t body_count() const { return bodies_.size(); }
  double mean_edge_of(int body) const { return bodies_[std::size_t(body)].mean_edge; }  // at rest [m]
  // The stiffness of contact of a body with parts of itself and with other bodies [Pa/m]. It is uniform, so
  // that blocks that press flat on each other keep flat faces. It is the value that a quarter of the body's
  // area cannot bear, but at most `most_beyond` times the stiffness of a triangle.
  double self_stiffness(int triangle) const {
    const Triangle& own = triangles_[std::size_t(triangle)];
    return std::min(bodies_[own.body].quartile, most_beyond * own.stiffness);
  }
  double softening() const { return softening_; }  // the share of the stiffness that is left, at most 1
  double omega() const { return omega_; }          // ω_max, which the stiffness fills up to [1/s]
  // f −= share K_c u [N], with K_c the stiffness of contact all over the surface.
  void add_forces(const Elements& elements, const Mat3X<double>& u, double share, Mat3X<double>& f) const;

 private:
  static constexpr double most_beyond = 24;
  struct OfBody {
    double mean_edge = 0;  // [m]
    double quartile = 0;   // [Pa/m]
  };
  void take_triangles(const BodyView& now);
  void find_mean_edges(const std::vector<double>& edges);
  void find_stiffness(const BodyView& now);
  double quartile_of(std::size_t body) const;

  std::uint64_t revision_ = 0, surface_ = ~std::uint64_t(0), structure_ = 0, inertia_ = 0;
  std::vector<Triangle> triangles_;
  std::vector<Point> points_;
  std::vector<OfBody> bodies_;
  double mean_edge_ = 0, omega_ = 0;
  double softening_ = 1;
  int mass_degree_ = 1;
};

}  // namespace lobe
