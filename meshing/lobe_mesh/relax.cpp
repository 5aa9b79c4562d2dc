// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/relax.h"
#include "lobe/numerics/symmetric_eigen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lobe/fem/hooke.h"
#include "lobe/fem/shape.h"
#include "lobe/sort_unique.h"

namespace lobe::meshing {
namespace {

constexpr int most_rounds = 40;
constexpr double least_gain = 0.01;     // of a round: less ends the relaxation
constexpr double flattest = 1e-3;       // smallest volume of a tetrahedron, of the regular one
constexpr double first_step = 0.12;     // of an edge
constexpr int step_sizes = 4;           // each half as long as the one before
constexpr double frequency_weight = 4;  // of a vertex against a dihedral angle

double shortfall(double value, double goal) {
  const double ratio = goal / value - 1;
  return ratio > 0 ? ratio * ratio : 0;
}

// Stiffness and mass that one tetrahedron of unit wave speed and density adds to its vertices, and a measure
// of how bad its angles are.
struct Element {
  Eigen::Matrix<double, 6, 4> stiffness;  // xx, xy, xz, yy, yz, zz of V B_kk, one column per corner
  double mass = 0;                        // V/4
  double angle_cost = 0;
  bool valid = false;
};

class Relaxation {
 public:
  Relaxation(TetMesh& mesh, const Freedom& freedom, const RelaxGoal& goal);
  std::size_t run();
  Bottleneck slowest_vertex() const;

 private:
  Element element(Index t) const;
  double angle_cost(const Mat34<double>& gradients) const;
  void add(Index t, const Element& e, double sign);
  double square_frequency(Index v) const;
  double vertex_cost(Index v) const;
  double total_cost() const;
  std::vector<Index> vertices_near_cost() const;
  double cost_around(Index v) const;
  bool try_position(Index v, const Vec3d& x, double& cost);
  void improve(Index v);
  Vec3d target(Index v, const Vec3d& shift) const;

  TetMesh& mesh_;
  const Freedom& freedom_;
  const RelaxGoal goal_;
  double mu_ = 0, lambda_ = 0;  // of wave speed 1 and density 1
  double highest_square_ = 0;   // ω² at the goal
  double smallest_volume_ = 0;
  std::size_t work_ = 0;
  double largest_cosine_ = 0;
  std::vector<std::vector<Index>> tets_at_;
  Eigen::Matrix<double, 6, Eigen::Dynamic> stiffness_;  // of each vertex
  std::vector<double> mass_, angle_cost_;
  std::vector<Index> ring_;           // vertices of the tetrahedra around the one that moves
  std::vector<Element> now_, moved_;  // those tetrahedra
};

Relaxation::Relaxation(TetMesh& mesh, const Freedom& freedom, const RelaxGoal& goal)
    : mesh_(mesh), freedom_(freedom), goal_(goal), tets_at_(mesh.vertex_count()) {
  // λ + 2μ = 1 and ν = λ / 2(λ + μ).
  mu_ = (1 - 2 * goal.poisson_ratio) / (2 - 2 * goal.poisson_ratio);
  lambda_ = 1 - 2 * mu_;
  highest_square_ = std::pow(2 / (goal.time_step_star * goal.edge), 2);
  smallest_volume_ = flattest * std::pow(goal.edge, 3) / (6 * std::numbers::sqrt2);
  largest_cosine_ = std::cos(goal.min_dihedral * std::numbers::pi / 180);
  stiffness_.setZero(6, mesh.vertex_count());
  mass_.assign(mesh.vertex_count(), 0);
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    for (int k = 0; k < 4; ++k) tets_at_[mesh.tets(k, t)].push_back(t);
    const Element e = element(t);
    add(t, e, 1);
    angle_cost_.push_back(e.angle_cost);
  }
}

Element Relaxation::element(Index t) const {
  const Shape s = shape(tet_points(mesh_, t));
  Element e;
  e.valid = s.volume > smallest_volume_;
  e.mass = s.volume / 4;
  for (int k = 0; k < 4; ++k) {
    const Vec3d a = s.gradients.col(k);
    const Mat3<double> B = s.volume * hooke_block<double>(a, a, lambda_, mu_);
    e.stiffness.col(k) << B(0, 0), B(0, 1), B(0, 2), B(1, 1), B(1, 2), B(2, 2);
  }
  e.angle_cost = angle_cost(s.gradients);
  return e;
}

// The gradients are the normals of the faces.
double Relaxation::angle_cost(const Mat34<double>& gradients) const {
  double cost = 0;
  for (const auto& edge : edge_corners) {
    const Vec3d a = gradients.col(edge[0]), b = gradients.col(edge[1]);
    const double cosine = -a.dot(b) / std::sqrt(a.squaredNorm() * b.squaredNorm());
    if (cosine <= largest_cosine_) continue;
    const double angle = std::acos(std::min(cosine, 1.0)) * 180 / std::numbers::pi;
    cost += shortfall(std::max(angle, 1e-3), goal_.min_dihedral);
  }
  return cost;
}

void Relaxation::add(Index t, const Element& e, double sign) {
  for (int k = 0; k < 4; ++k) {
    stiffness_.col(mesh_.tets(k, t)) += sign * e.stiffness.col(k);
    mass_[mesh_.tets(k, t)] += sign * e.mass;
  }
}

// ω² = λ_max(K_vv)/m_v
double Relaxation::square_frequency(Index v) const {
  const auto K = stiffness_.col(v);
  Mat3<double> block;
  block << K[0], K[1], K[2], K[1], K[3], K[4], K[2], K[4], K[5];
  return largest_eigenvalue(block) / mass_[v];
}

double Relaxation::vertex_cost(Index v) const {
  const double trace = stiffness_(0, v) + stiffness_(3, v) + stiffness_(5, v);
  if (trace <= highest_square_ * mass_[v])
    return 0;  // bounds λ_max, and saves most of the eigenvalue problems
  return frequency_weight * shortfall(1, std::sqrt(square_frequency(v) / highest_square_));
}

double Relaxation::total_cost() const {
  double cost = 0;
  for (Index v = 0; v < mesh_.vertex_count(); ++v) {
    if (!tets_at_[v].empty()) cost += vertex_cost(v);
  }
  for (const double angle : angle_cost_) cost += angle;
  return cost;
}

std::vector<Index> Relaxation::vertices_near_cost() const {
  std::vector<bool> slow(mesh_.vertex_count()), near(mesh_.vertex_count());
  for (Index v = 0; v < mesh_.vertex_count(); ++v) slow[v] = !tets_at_[v].empty() && vertex_cost(v) > 0;
  for (Index t = 0; t < mesh_.tet_count(); ++t) {
    const auto corners = mesh_.tets.col(t);
    const bool bad =
        angle_cost_[t] > 0 || std::any_of(corners.begin(), corners.end(), [&](Index v) { return slow[v]; });
    if (!bad) continue;
    for (const Index v : corners) near[v] = true;
  }
  std::vector<Index> vertices;
  for (Index v = 0; v < mesh_.vertex_count(); ++v) {
    if (near[v] && !freedom_.is_fixed[v]) vertices.push_back(v);
  }
  return vertices;
}

double Relaxation::cost_around(Index v) const {
  double cost = 0;
  for (const Index w : ring_) cost += vertex_cost(w);
  for (const Index t : tets_at_[v]) cost += angle_cost_[t];
  return cost;
}

bool Relaxation::try_position(Index v, const Vec3d& x, double& cost) {
  const Vec3d old = mesh_.points.col(v);
  const std::vector<Index>& tets = tets_at_[v];
  mesh_.points.col(v) = x;
  moved_.clear();
  work_ += tets.size();
  for (const Index t : tets) {
    moved_.push_back(element(t));
    if (moved_.back().valid) continue;
    mesh_.points.col(v) = old;
    return false;
  }
  const auto replace = [&](const std::vector<Element>& from, const std::vector<Element>& to) {
    for (std::size_t i = 0; i < tets.size(); ++i) {
      add(tets[i], from[i], -1);
      add(tets[i], to[i], 1);
      angle_cost_[tets[i]] = to[i].angle_cost;
    }
  };
  replace(now_, moved_);
  const double trial = cost_around(v);
  if (trial < 0.999 * cost) {
    cost = trial;
    now_.swap(moved_);
    return true;
  }
  replace(moved_, now_);
  mesh_.points.col(v) = old;
  return false;
}

// Moves a vertex of a surface along the surface. Its distance from the surface stays.
Vec3d Relaxation::target(Index v, const Vec3d& shift) const {
  const Vec3d x = mesh_.points.col(v);
  return x + freedom_.on_surfaces(v, x + shift) - freedom_.on_surfaces(v, x);
}

void Relaxation::improve(Index v) {
  ring_.clear();
  now_.clear();
  for (const Index t : tets_at_[v]) {
    now_.push_back(element(t));
    if (!now_.back().valid) return;
    for (int k = 0; k < 4; ++k) ring_.push_back(mesh_.tets(k, t));
  }
  sort_unique(ring_);
  double cost = cost_around(v), step = first_step * goal_.edge;
  for (int size = 0; size < step_sizes && cost > 0; ++size) {
    bool better = false;
    for (const int direction : {0, 1, 2, 3, 4, 5}) {
      const Vec3d shift = (direction % 2 == 0 ? step : -step) * Vec3d::Unit(direction / 2);
      better = try_position(v, target(v, shift), cost) || better;
    }
    if (!better) step /= 2;
  }
}

std::size_t Relaxation::run() {
  double cost = total_cost();
  for (int round = 0; round < most_rounds && cost > 0; ++round) {
    for (const Index v : vertices_near_cost())
      if (work_ < goal_.most_work * static_cast<std::size_t>(mesh_.tet_count())) improve(v);
    const double before = cost;
    cost = total_cost();
    if (cost > (1 - least_gain) * before) break;
  }
  return work_;
}

Bottleneck Relaxation::slowest_vertex() const {
  Bottleneck worst;
  double highest = 0;
  for (Index v = 0; v < mesh_.vertex_count(); ++v) {
    if (tets_at_[v].empty()) continue;
    const double square = square_frequency(v);
    if (square <= highest) continue;
    highest = square;
    worst = {v, mesh_.points.col(v), static_cast<Index>(tets_at_[v].size()), false};
  }
  return worst;
}

}  // namespace

Bottleneck slowest_vertex(const TetMesh& mesh, const RelaxGoal& goal) {
  TetMesh copy = mesh;
  return Relaxation(copy, {}, goal).slowest_vertex();
}

std::size_t relax(TetMesh& mesh, const Freedom& freedom, const RelaxGoal& goal) {
  return Relaxation(mesh, freedom, goal).run();
}

}  // namespace lobe::meshing
