#include "lobe/contact/contact_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/numerics/symmetric_eigen.h"
#include "lobe/region/smoothed_edges.h"
#include "lobe/time/vertex_frequencies.h"

namespace lobe {
namespace {

constexpr double least_room = 0.05;  // θ
constexpr double filled = 1.15;      // φ

Eigen::Vector<double, 6> upper_triangle(const Mat3<double>& B) {
  return {B(0, 0), B(0, 1), B(0, 2), B(1, 1), B(1, 2), B(2, 2)};
}

// What the smoothing domains give.
void add_domains(const Elements& elements, DiagonalStiffness& K) {
  const SmoothedEdges edges(elements);
  for (Index e = 0; e < edges.count(); ++e) {
    const SmoothedEdge& edge = edges[e];
    if (edge.volume == 0) continue;
    const bool linear = is_linear(edge.model);
    const Law<double> law = linear ? smoothed_linear_law(elements, edge) : smoothed_law(elements, edge);
    for (std::size_t j = 0; j < edge.vertices.size(); ++j) {
      const Vec3d b = edge.gradients[j];
      const Mat3<double> B = edge.volume * (linear ? linear_block(law, b, b)
                                                   : law_diagonal_block(law, Mat3<double>::Zero().eval(), b));
      K.col(edge.vertices[j]) += upper_triangle(B);
    }
  }
}

// What is left to a tetrahedron itself whose strain is smoothed.
CornerStiffness corner_stiffness_of_volume(const Elements& elements, Index tet) {
  CornerStiffness K = CornerStiffness::Zero();
  if (is_linear(elements.region_of[tet])) return K;
  const Law<double> law = unsmoothed_law(elements, tet);
  if (!law.terms.volume && !law.terms.guard) return K;
  const Shape s = elements.shape_of(tet);
  for (int c = 0; c < 4; ++c) {
    const Mat3<double> B = law_diagonal_block(law, Mat3<double>::Zero().eval(), Vec3d(s.gradients.col(c)));
    K.col(c) = s.volume * upper_triangle(B);
  }
  return K;
}

// What vertices feel at rest when they move alone, of those that `is_wanted`, upper triangles [N/m]. Each
// tetrahedron is asked once.
DiagonalStiffness stiffness_at_rest(const Elements& elements, const std::vector<double>& is_wanted) {
  const Topology& topology = elements.topology;
  DiagonalStiffness K = DiagonalStiffness::Zero(6, topology.vertex_count());
  if (any_smoothed(elements.materials)) add_domains(elements, K);
  std::vector<std::uint8_t> is_known(std::size_t(topology.tet_count()), 0);
  for (Index v = 0; v < topology.vertex_count(); ++v) {
    if (is_wanted[std::size_t(v)] == 0) continue;
    for (Index t : topology.around(v)) {
      if (std::exchange(is_known[std::size_t(t)], 1)) continue;
      const Eigen::Vector4i corners = topology.corners(t);
      const CornerStiffness stiffness = elements.elastic_of(t).is_smoothed()
                                            ? corner_stiffness_of_volume(elements, t)
                                            : corner_stiffness(elements, t, Mat34<double>::Zero());
      for (int c = 0; c < 4; ++c) K.col(corners[c]) += stiffness.col(c);
    }
  }
  return K;
}

// Vertices that follow a lattice have given their masses to its nodes. What is pressed moves by itself, with
// the mass of its tetrahedra.
double mass_of(const BodyView& now, Index v) {
  const double own = now.mass[std::size_t(v)];
  const Elements& elements = now.model.elements;
  const auto around = elements.topology.around(v);
  const bool is_embedded = own == 0 && std::any_of(around.begin(), around.end(), [&](Index t) {
                             return elements.region_of[std::size_t(t)] == RegionModel::reduced;
                           });
  return is_embedded ? lumped_mass(elements, v) : own;
}

double largest_of(const Eigen::Matrix<double, 6, 1>& K) {
  Mat3<double> block;
  block << K[0], K[1], K[2], K[1], K[3], K[4], K[2], K[4], K[5];
  return largest_eigenvalue(block);
}

}  // namespace

bool ContactSurface::is_outdated(const BodyView& now) const {
  const Revisions& revisions = now.model.revisions;
  return revision_ == 0 || surface_ != now.surface.revision || structure_ != revisions.structure ||
         inertia_ != revisions.inertia || mass_degree_ != now.mass_degree;
}

void ContactSurface::rebuild(const BodyView& now) {
  ++revision_;
  surface_ = now.surface.revision;
  structure_ = now.model.revisions.structure;
  inertia_ = now.model.revisions.inertia;
  omega_ = now.omega;
  take_triangles(now);
  find_stiffness(now);
  mass_degree_ = now.mass_degree;
  softening_ = now.softening && omega_ > 0 ? now.softening() : 1;
  for (Triangle& t : triangles_) t.stiffness *= softening_;
  for (std::size_t body = 0; body < bodies_.size(); ++body) bodies_[body].quartile = quartile_of(body);
}

// Sorted by their owners. A crease of the surface is two vertices there and one point here.
void ContactSurface::take_triangles(const BodyView& now) {
  const SurfaceMesh& surface = now.surface;
  std::vector<Index> order(surface.triangles.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    const FaceOwner &x = surface.owner[std::size_t(a)], &y = surface.owner[std::size_t(b)];
    return std::pair(x.tet, x.code) < std::pair(y.tet, y.code);
  });
  std::vector<const SurfaceMesh::Within*> within(std::size_t(surface.vertex_count()), nullptr);
  for (const SurfaceMesh::Within& inner : surface.within) within[std::size_t(inner.vertex)] = &inner;
  std::vector<int> of_vertex(std::size_t(now.model.elements.topology.vertex_count()), -1);
  std::vector<int> of_within(within.size(), -1);
  triangles_.clear();
  points_.clear();
  const auto point_of = [&](Index s) {
    const SurfaceMesh::Within* inside = within[std::size_t(s)];
    int& known =
        inside ? of_within[std::size_t(s)] : of_vertex[std::size_t(surface.mesh_vertex[std::size_t(s)])];
    if (known >= 0) return known;
    known = static_cast<int>(points_.size());
    if (inside)
      points_.push_back({inside->corners, inside->weights, 4});
    else
      points_.push_back({Eigen::Vector4i::Constant(surface.mesh_vertex[std::size_t(s)])});
    return known;
  };
  bodies_.assign(now.model.elements.bodies.count(), {});
  std::vector<double> edges(bodies_.size(), 0);
  for (Index t : order) {
    Triangle triangle{.points = {},
                      .owner = surface.owner[std::size_t(t)],
                      .is_cut = surface.cut[std::size_t(t)] != 0,
                      .body = surface.body[std::size_t(t)]};
    Mat3<double> X;
    for (int c = 0; c < 3; ++c) {
      triangle.points[c] = point_of(surface.triangles[std::size_t(t)][c]);
      const Point& point = points_[std::size_t(triangle.points[c])];
      X.col(c).setZero();
      for (int i = 0; i < point.count; ++i)
        X.col(c) += point.weights[i] * now.model.elements.points.col(point.corners[i]);
    }
    triangle.area = (X.col(1) - X.col(0)).cross(X.col(2) - X.col(0)).norm() / 2;
    for (int c = 0; c < 3; ++c) {
      const double edge = (X.col(c) - X.col((c + 1) % 3)).norm();
      triangle.longest = std::max(triangle.longest, edge);
      edges[triangle.body] += edge;
    }
    triangles_.push_back(triangle);
  }
  find_mean_edges(edges);
}

void ContactSurface::find_mean_edges(const std::vector<double>& edges) {
  double all = 0;
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    const auto triangles = std::count_if(triangles_.begin(), triangles_.end(),
                                         [&](const Triangle& t) { return t.body == body; });
    bodies_[body].mean_edge = triangles > 0 ? edges[body] / (3.0 * double(triangles)) : 0;
    all += edges[body];
  }
  mean_edge_ = triangles_.empty() ? 0 : all / (3.0 * double(triangles_.size()));
}

void ContactSurface::find_stiffness(const BodyView& now) {
  const auto vertices = std::size_t(now.model.elements.topology.vertex_count());
  std::vector<double> area(vertices, 0), kappa(vertices, -1);
  for (const Triangle& t : triangles_)
    for (int p : t.points) {
      const Point& point = points_[std::size_t(p)];
      for (int i = 0; i < point.count; ++i)
        area[std::size_t(point.corners[i])] += point.weights[i] * t.area / 3;
    }
  const DiagonalStiffness K = stiffness_at_rest(now.model.elements, area);
  const double square = now.lumped_omega * now.lumped_omega, ratio = now.ratio * now.ratio;
  const auto kappa_of = [&](Index v) {
    double& known = kappa[std::size_t(v)];
    if (known >= 0) return known;
    const double full = filled * square * mass_of(now, v);
    const double room = full - ratio * largest_of(K.col(v));
    known = area[std::size_t(v)] > 0 ? std::max(least_room * full, room) / area[std::size_t(v)] : 0;
    return known;
  };
  for (Triangle& t : triangles_) {
    t.stiffness = std::numeric_limits<double>::infinity();
    for (int p : t.points) {
      const Point& point = points_[std::size_t(p)];
      for (int i = 0; i < point.count; ++i)
        if (point.weights[i] > 0) t.stiffness = std::min(t.stiffness, kappa_of(point.corners[i]));
    }
  }
}

// The stiffness that a quarter of the body's area cannot bear.
double ContactSurface::quartile_of(std::size_t body) const {
  std::vector<std::pair<double, double>> sorted;  // κ, area
  double area = 0;
  for (const Triangle& t : triangles_) {
    if (t.body != body) continue;
    sorted.emplace_back(t.stiffness, t.area);
    area += t.area;
  }
  std::sort(sorted.begin(), sorted.end());
  double quartile = 0, below = 0;
  for (const auto& [stiffness, share] : sorted) {
    quartile = stiffness;
    if ((below += share) >= area / 4) break;
  }
  return quartile;
}

// K_c of each triangle is a third of κ A along its normal at each corner, which is no less than what its
// points give.
void ContactSurface::add_forces(const Elements& elements, const Mat3X<double>& u, double share,
                                Mat3X<double>& f) const {
  const auto at_point = [](const Point& point, const auto& values) {
    Vec3d sum = Vec3d::Zero();
    for (int i = 0; i < point.count; ++i) sum += point.weights[i] * values.col(point.corners[i]);
    return sum;
  };
  for (const Triangle& t : triangles_) {
    Mat3<double> X;
    for (int c = 0; c < 3; ++c) X.col(c) = at_point(points_[std::size_t(t.points[c])], elements.points);
    const Vec3d n = (X.col(1) - X.col(0)).cross(X.col(2) - X.col(0)).normalized();
    for (int p : t.points) {
      const Point& point = points_[std::size_t(p)];
      const Vec3d force = share * t.stiffness * t.area / 3 * n.dot(at_point(point, u)) * n;
      for (int i = 0; i < point.count; ++i) f.col(point.corners[i]) -= point.weights[i] * force;
    }
  }
}

}  // namespace lobe
