// Which vertices of a reduced region are embedded and which are full, and which tetrahedra a cut takes out.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "lobe/error.h"
#include "lobe/lattice/lattice_region.h"

namespace lobe {
namespace {

// Held at its rest position for ever.
bool is_at_rest(const HeldVertices::Held& item) {
  return item.holder == HeldVertices::boundary && item.axes == all_axes && item.start.isZero(0) &&
         item.goal.isZero(0);
}

// The mean square of F − F̄ over the tetrahedra around a vertex.
template <class Real>
double square_roughness(const Elements& elements, Index v, const Mat3X<Real>& u) {
  Mat3<double> mean = Mat3<double>::Zero();
  double volume = 0, squares = 0;
  for (Index t : elements.topology.around(v)) {
    const Shape shape = elements.shape_of(t);
    const Mat34<double> corners = u(Eigen::all, elements.topology.corners(t)).template cast<double>();
    const Mat3<double> H = corners * shape.gradients.transpose();
    mean += shape.volume * H;
    squares += shape.volume * H.squaredNorm();
    volume += shape.volume;
  }
  return volume > 0 ? squares / volume - (mean / volume).squaredNorm() : 0;
}

}  // namespace

template <class Real>
VertexRoles LatticeRegion<Real>::roles(const Model& model, std::vector<std::uint8_t> is_embedded) const {
  VertexRoles roles{std::move(is_embedded), Flags(std::size_t(model.elements.topology.vertex_count()), 0)};
  for (const HeldVertices::Held& item : model.held.all())
    roles.is_still[std::size_t(item.vertex)] = is_at_rest(item);
  return roles;
}

template <class Real>
VertexRoles LatticeRegion<Real>::roles(const Model& model, double time, bool may_embed) {
  Flags may(std::size_t(model.elements.topology.vertex_count()), 0);
  if (any() && may_embed) {
    if (inner_.size() != may.size()) find_inner(model);
    for (Index v : vertices_) may[std::size_t(v)] = inner_[std::size_t(v)] && !zones_.is_full(v, time);
  }
  return roles(model, std::move(may));
}

template <class Real>
bool LatticeRegion<Real>::is_at_cut_end(Index v) const {
  if (v >= static_cast<Index>(lattice_.part_of_vertex.size())) return false;
  const Index part = lattice_.part_of_vertex[std::size_t(v)];
  return part >= 0 && lattice_.parts[std::size_t(part)].has_cut_end;
}

template <class Real>
void LatticeRegion<Real>::find_inner(const Model& model) {
  const Topology& topology = model.elements.topology;
  inner_.assign(std::size_t(topology.vertex_count()), 0);
  for (Index v : vertices_) {
    const auto around = topology.around(v);
    inner_[std::size_t(v)] = !around.empty() && (is_outdated_ || !is_at_cut_end(v)) &&
                             std::all_of(around.begin(), around.end(), [&](Index t) { return has(t); });
  }
  for (const HeldVertices::Held& item : model.held.all()) {
    if (item.holder != HeldVertices::boundary) continue;  // what tools hold is in a zone (zones.h)
    inner_[std::size_t(item.vertex)] = 0;
    if (is_at_rest(item)) continue;
    for (Index t : topology.around(item.vertex))
      for (Index v : topology.corners(t)) inner_[std::size_t(v)] = 0;
  }
}

template <class Real>
void LatticeRegion<Real>::keep_full(const Elements& elements, const std::vector<Index>& vertices, double time,
                                    double duration) {
  if (!(duration > 0) || !std::isfinite(duration))
    throw InputError("keep full", "the duration must be above 0 s and finite");
  const Index count = elements.topology.vertex_count();
  for (Index v : vertices)
    if (v < 0 || v >= count)
      throw InputError("keep full", "there is no vertex " + std::to_string(v) + ", only " +
                                        std::to_string(count) + " vertices");
  if (any()) zones_.ask(vertices, count, time + duration);
}

// Nodes count with their masses in the norms of displacement and speed.
template <class Real>
void LatticeRegion<Real>::look(const Elements& elements, const Motion<Real>& motion,
                               const std::vector<double>& mass, FullZones::Sight sight) {
  if (!any()) return;
  fading_.forget_if_over(motion.time);
  const auto norm = [&](const Mat3X<Real>& of_vertices, const Mat3X<Real>& of_nodes) {
    double sum = 0;
    for (std::size_t v = 0; v < mass.size(); ++v)
      if (!embeds(static_cast<Index>(v)))
        sum += mass[v] * double(of_vertices.col(Eigen::Index(v)).squaredNorm());
    for (std::size_t n = 0; n < embedding_.mass.size(); ++n)
      sum += embedding_.mass[n] * double(of_nodes.col(Eigen::Index(n)).squaredNorm());
    return std::sqrt(sum);
  };
  sight.displacement = norm(motion.u.padded(), motion.nodes.u);
  sight.speed = norm(motion.v.padded(), motion.nodes.v);
  zones_.look(elements, lattice_.frame.edge, motion.time, sight);
  ask_again_where_rough(elements, motion);
}

// What was asked to be full for a while stays so, part by part, until its tissue is smooth.
template <class Real>
void LatticeRegion<Real>::ask_again_where_rough(const Elements& elements, const Motion<Real>& motion) {
  constexpr double smooth = 0.02;
  std::vector<Index> due = zones_.take_due(motion.time);
  std::erase_if(due, [&](Index v) {
    return v >= static_cast<Index>(lattice_.part_of_vertex.size()) ||
           lattice_.part_of_vertex[std::size_t(v)] < 0;
  });
  if (due.empty()) return;
  struct Sum {
    double squares = 0;
    int count = 0;
  };
  std::vector<Sum> sums(lattice_.parts.size());
  const auto sum_of = [&](Index v) -> Sum& {
    return sums[std::size_t(lattice_.part_of_vertex[std::size_t(v)])];
  };
  for (Index v : due) {
    sum_of(v).squares += square_roughness(elements, v, motion.u.padded());
    ++sum_of(v).count;
  }
  std::erase_if(due, [&](Index v) { return sum_of(v).squares < smooth * smooth * sum_of(v).count; });
  zones_.ask(due, elements.topology.vertex_count(), motion.time + FullZones::linger);
}

// Two sides of a cut must have no node in common: those that are left are 0.75 cells away from what is cut.
template <class Real>
std::vector<Index> LatticeRegion<Real>::in_the_way(const Elements& elements,
                                                   const std::vector<Index>& tets) const {
  constexpr double least = 0.75, at_once = 1.25;  // cells
  std::vector<Index> found;
  const auto add = [&](double distance) {
    const Flags is_near = within(elements, tets, distance * lattice_.frame.edge);
    for (Index t = 0; t < static_cast<Index>(member_.size()); ++t)
      if (has(t) && is_near[std::size_t(t)]) found.push_back(t);
  };
  if (any()) add(least);
  if (found.empty()) return found;
  found.clear();
  add(at_once);
  return found;
}

// Per tetrahedron: whether it is as near to one of these, along others.
template <class Real>
std::vector<std::uint8_t> LatticeRegion<Real>::within(const Elements& elements,
                                                      const std::vector<Index>& tets, double distance) const {
  Flags is_near(std::size_t(elements.topology.tet_count()), 0);
  std::vector<std::pair<Index, Index>> queue;  // and from where
  const auto middle = [&](Index t) -> Vec3d { return elements.corner_points(t).rowwise().mean(); };
  const auto meet = [&](Index t, Index start) {
    if (std::exchange(is_near[std::size_t(t)], 1) == 0) queue.emplace_back(t, start);
  };
  for (Index t : tets)
    if (elements.topology.alive(t)) meet(t, t);
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const auto [tet, start] = queue[i];
    elements.topology.for_neighbours(tet, [&, start = start](int, Index other) {
      if ((middle(other) - middle(start)).norm() <= distance) meet(other, start);
    });
  }
  return is_near;
}

}  // namespace lobe
