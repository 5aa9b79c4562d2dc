#include "lobe/forces/applied_forces.h"

#include <algorithm>
#include <cmath>

#include "lobe/error.h"
#include "lobe/file/fields.h"

namespace lobe {
namespace {

void check_vertex(Index v, Index vertices) {
  if (v < 0 || v >= vertices)
    throw InputError("vertex " + std::to_string(v),
                     "there are " + std::to_string(vertices) + ", numbered from 0");
}

template <class Force>
void drop_orphans(std::vector<Force>& forces, const Topology& topology) {
  std::erase_if(forces, [&](const Force& f) { return topology.around(f.vertex).empty(); });
}

}  // namespace

template <class Real>
void AppliedForces<Real>::set(const std::vector<VertexLoad>& forces, Index vertices) {
  for (const VertexLoad& load : forces) {
    check_vertex(load.vertex, vertices);
    if (!load.force.allFinite())
      throw InputError("force on vertex " + std::to_string(load.vertex), "is not finite");
  }
  forces_ = forces;
}

template <class Real>
void AppliedForces<Real>::set(const std::vector<Spring>& springs, Index vertices) {
  for (const Spring& spring : springs) {
    check_vertex(spring.vertex, vertices);
    if (!(spring.stiffness > 0) || !std::isfinite(spring.stiffness) || !spring.point.allFinite())
      throw InputError("spring at vertex " + std::to_string(spring.vertex),
                       "needs a stiffness above 0 N/m and a point that are finite");
  }
  springs_ = springs;
  moves_.resize(3, 0);
  targets_.resize(3, 0);
}

template <class Real>
void AppliedForces<Real>::move(const Mat3X<double>& points) {
  if (points.cols() != Eigen::Index(springs_.size()) || !points.allFinite())
    throw InputError("springs", "there are " + std::to_string(springs_.size()) +
                                    ": give as many points, with finite coordinates");
  targets_ = points;
}

template <class Real>
void AppliedForces<Real>::begin_frame(double time, double duration) {
  for (Eigen::Index i = 0; i < moves_.cols(); ++i) springs_[std::size_t(i)].point += moves_.col(i);
  moves_ = targets_;
  for (Eigen::Index i = 0; i < moves_.cols(); ++i) moves_.col(i) -= springs_[std::size_t(i)].point;
  targets_.resize(3, 0);
  begin_ = time;
  duration_ = duration;
}

template <class Real>
Vec3d AppliedForces<Real>::point_at(std::size_t spring, double time) const {
  const Vec3d& start = springs_[spring].point;
  if (moves_.cols() == 0) return start;
  const double share = duration_ > 0 ? std::clamp((time - begin_) / duration_, 0.0, 1.0) : 1;
  return start + share * moves_.col(Eigen::Index(spring));
}

template <class Real>
void AppliedForces<Real>::add_forces(const At& at, Mat3X<Real>& f) {
  for (const VertexLoad& load : forces_) f.col(load.vertex) += load.force.template cast<Real>();
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    const Index v = springs_[i].vertex;
    const Vec3d x = at.model.elements.points.col(v) + at.u.col(v).template cast<double>();
    f.col(v) += (springs_[i].stiffness * (point_at(i, at.time) - x)).template cast<Real>();
  }
}

template <class Real>
void AppliedForces<Real>::add_diagonal_stiffness(const At&, DiagonalStiffness& K) {
  for (const Spring& spring : springs_)
    for (int entry : {0, 3, 5}) K(entry, spring.vertex) += spring.stiffness;
}

template <class Real>
double AppliedForces<Real>::energy(const At& at) {
  double sum = 0;
  for (const VertexLoad& load : forces_) sum -= load.force.dot(at.u.col(load.vertex).template cast<double>());
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    const Index v = springs_[i].vertex;
    const Vec3d x = at.model.elements.points.col(v) + at.u.col(v).template cast<double>();
    sum += springs_[i].stiffness * (point_at(i, at.time) - x).squaredNorm() / 2;
  }
  return sum;
}

template <class Real>
std::vector<Index> AppliedForces<Real>::acts_on(const Model&) const {
  std::vector<Index> vertices;
  for (const VertexLoad& load : forces_) vertices.push_back(load.vertex);
  for (const Spring& spring : springs_) vertices.push_back(spring.vertex);
  return vertices;
}

// If a vertex is split, its force stays with it and not with the copy. It ends with the last tetrahedron
// around the vertex.
template <class Real>
void AppliedForces<Real>::follow(const Topology& topology, const MeshEdit&) {
  drop_orphans(forces_, topology);
  const auto is_orphan = [&](const Spring& spring) { return topology.around(spring.vertex).empty(); };
  if (std::none_of(springs_.begin(), springs_.end(), is_orphan)) return;
  for (Mat3X<double>* columns : {&moves_, &targets_}) {
    Eigen::Index remaining = 0;
    for (Eigen::Index i = 0; i < columns->cols(); ++i)
      if (!is_orphan(springs_[std::size_t(i)])) columns->col(remaining++) = columns->col(i);
    columns->conservativeResize(3, remaining);
  }
  drop_orphans(springs_, topology);
}

template <class Real>
std::string AppliedForces<Real>::save() const {
  io::ByteWriter out;
  io::put(out, forces_);
  io::put(out, springs_);
  io::put(out, moves_);
  io::put(out, targets_);
  io::put(out, begin_);
  io::put(out, duration_);
  return out.bytes();
}

template <class Real>
void AppliedForces<Real>::load(const std::string& saved, Index vertices) {
  io::ByteReader in("checkpoint", saved);
  AppliedForces found;
  std::vector<VertexLoad> forces;
  std::vector<Spring> springs;
  io::get(in, forces);
  io::get(in, springs);
  found.set(forces, vertices);
  found.set(springs, vertices);
  io::get(in, found.moves_);
  io::get(in, found.targets_);
  for (const Mat3X<double>* columns : {&found.moves_, &found.targets_})
    in.expect((columns->cols() == 0 || columns->cols() == Eigen::Index(springs.size())) &&
              columns->allFinite());
  io::get(in, found.begin_);
  io::get(in, found.duration_);
  in.expect(std::isfinite(found.begin_) && std::isfinite(found.duration_));
  in.expect_end();
  *this = std::move(found);
}

template class AppliedForces<float>;
template class AppliedForces<double>;

}  // namespace lobe
