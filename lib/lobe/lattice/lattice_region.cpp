#include "lobe/lattice/lattice_region.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_set>

namespace lobe {
namespace {

// An upper bound of the largest eigenvalue of a symmetric matrix: xx, xy, xz, yy, yz, zz.
double bound_of(const Eigen::Matrix<double, 6, 1>& K) {
  const double mean = (K[0] + K[3] + K[5]) / 3;
  const double on =
      (K[0] - mean) * (K[0] - mean) + (K[3] - mean) * (K[3] - mean) + (K[5] - mean) * (K[5] - mean);
  return mean + std::sqrt(2.0 / 3 * (on + 2 * (K[1] * K[1] + K[2] * K[2] + K[4] * K[4])));
}

// The residual of nodes that are settled, squared and relative.
template <class Real>
constexpr double settled = std::is_same_v<Real, float> ? 1e-10 : 1e-24;

}  // namespace

// ---- Edits

template <class Real>
void LatticeRegion<Real>::follow(const Elements& elements, const RegionEdit& edit) {
  const auto enters = [&](Index t) { return elements.is_in(RegionModel::reduced, t); };
  if (!any() && std::none_of(edit.entered.begin(), edit.entered.end(), enters)) return;
  inner_.clear();
  all_.follow(elements, edit, RegionModel::reduced);
  member_.resize(std::size_t(elements.topology.tet_count()), 0);
  for (Index t : edit.left) {
    if (!member_[std::size_t(t)]) continue;
    member_[std::size_t(t)] = 0;
    --tet_count_;
    has_lost_ = true;
    const bool is_elsewhere = elements.topology.alive(t) && !enters(t);
    if (!is_elsewhere) is_outdated_ = true;
    if (!is_outdated_) take_out(elements, t, lattice_, whole_);
  }
  for (Index t : edit.entered) {
    if (!enters(t) || member_[std::size_t(t)]) continue;
    member_[std::size_t(t)] = 1;
    ++tet_count_;
    is_outdated_ = true;
  }
  if (is_outdated_) list_vertices(elements.topology);
  if (any() && lattice_.frame.edge == 0) lattice_.frame = choose_lattice(elements, cell_);
}

// Those of before stay until embed(): their masses and loads change.
template <class Real>
void LatticeRegion<Real>::list_vertices(const Topology& topology) {
  std::vector<std::uint8_t> is_vertex(std::size_t(topology.vertex_count()), 0);
  for (Index v : vertices_) is_vertex[std::size_t(v)] = 1;
  for (Index t = 0; t < topology.tet_count(); ++t)
    if (member_[std::size_t(t)])
      for (Index v : topology.corners(t)) is_vertex[std::size_t(v)] = 1;
  vertices_.clear();
  for (Index v = 0; v < topology.vertex_count(); ++v)
    if (is_vertex[std::size_t(v)]) vertices_.push_back(v);
}

template <class Real>
VertexRoles LatticeRegion<Real>::roles(const Model& model, std::vector<std::uint8_t> is_embedded) const {
  VertexRoles roles{std::move(is_embedded), Flags(std::size_t(model.elements.topology.vertex_count()), 0)};
  for (const HeldVertices::Held& item : model.held.all())
    roles.is_still[std::size_t(item.vertex)] = item.holder == HeldVertices::boundary &&
                                               item.axes == all_axes && item.start.isZero(0) &&
                                               item.goal.isZero(0);
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
void LatticeRegion<Real>::find_inner(const Model& model) {
  const Topology& topology = model.elements.topology;
  inner_.assign(std::size_t(topology.vertex_count()), 0);
  for (Index v : vertices_) {
    const auto around = topology.around(v);
    inner_[std::size_t(v)] =
        !around.empty() && std::all_of(around.begin(), around.end(), [&](Index t) { return has(t); });
  }
  for (const HeldVertices::Held& item : model.held.all()) {
    if (item.holder != HeldVertices::boundary) continue;  // what tools hold is in a zone (zones.h)
    for (Index t : topology.around(item.vertex))
      for (Index v : topology.corners(t)) inner_[std::size_t(v)] = 0;
  }
}

// Nodes count with their masses in the norms of displacement and speed.
template <class Real>
void LatticeRegion<Real>::look(const Elements& elements, const Motion<Real>& motion,
                               const std::vector<double>& mass, double damping,
                               const std::vector<Index>& held, const std::vector<Index>& pressed) {
  if (!any()) return;
  const auto norm = [&](const Mat3X<Real>& of_vertices, const Mat3X<Real>& of_nodes) {
    double sum = 0;
    for (std::size_t v = 0; v < mass.size(); ++v)
      if (!embeds(static_cast<Index>(v)))
        sum += mass[v] * double(of_vertices.col(Eigen::Index(v)).squaredNorm());
    for (std::size_t n = 0; n < embedding_.mass.size(); ++n)
      sum += embedding_.mass[n] * double(of_nodes.col(Eigen::Index(n)).squaredNorm());
    return std::sqrt(sum);
  };
  zones_.look(elements, lattice_.frame.edge, motion.time,
              {held, pressed, norm(motion.u.padded(), motion.nodes.u),
               norm(motion.v.padded(), motion.nodes.v), damping});
}

// Two sides of a cut must have no node in common: those that are left are half a cell away from what is cut.
template <class Real>
std::vector<Index> LatticeRegion<Real>::in_the_way(const Elements& elements,
                                                   const std::vector<Index>& tets) const {
  constexpr double least = 0.75, at_once = 1.25;  // cells
  std::vector<Index> found;
  const auto add = [&](double distance) {
    const Flags is_near = within(elements, tets, distance * lattice_.frame.edge);
    for (Index t = 0; t < static_cast<Index>(member_.size()); ++t)
      if (member_[std::size_t(t)] && is_near[std::size_t(t)]) found.push_back(t);
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
    elements.topology.for_neighbours(tet, [&](int, Index other) {
      if ((middle(other) - middle(start)).norm() <= distance) meet(other, start);
    });
  }
  return is_near;
}

// Nodes take the values of former ones at the same corner of the lattice, until they are settled.
template <class Real>
void LatticeRegion<Real>::make_lattice_anew(const Elements& elements, Nodes<Real>& nodes) {
  using Corner = std::array<int, 3>;
  const auto at = [](const Eigen::Vector3i& corner) { return Corner{corner[0], corner[1], corner[2]}; };
  std::map<Corner, Index> former;
  for (Index n = 0; n < lattice_.node_count(); ++n)
    former.emplace(at(lattice_.corner_of_node[std::size_t(n)]), n);
  Lattice fresh = make_lattice(elements, lattice_.frame);
  Nodes<Real> values;
  values.u.setZero(3, fresh.node_count());
  values.v.setZero(3, fresh.node_count());
  for (Index n = 0; n < fresh.node_count(); ++n) {
    const auto found = former.find(at(fresh.corner_of_node[std::size_t(n)]));
    if (found == former.end()) continue;
    values.u.col(n) = nodes.u.col(found->second);
    values.v.col(n) = nodes.v.col(found->second);
  }
  lattice_ = std::move(fresh);
  whole_ = sum_cells(elements, lattice_);
  whole_cells_ =
      lobe::embed(elements, lattice_, whole_, {Flags(std::size_t(elements.topology.vertex_count()), 1), {}})
          .cells;
  nodes = std::move(values);
}

template <class Real>
std::vector<std::uint8_t> LatticeRegion<Real>::touched_nodes(const Embedding& before, bool all) const {
  Flags touched(std::size_t(lattice_.node_count()), 0);
  for (Index v : embedding_.vertices)
    if (all || !before.embeds(v))
      for (Index n : lattice_.parts[std::size_t(lattice_.part_of_vertex[std::size_t(v)])].nodes)
        touched[std::size_t(n)] = 1;
  return touched;
}

// Of vertices that were embedded, or are not any more: those may change their velocity for the momentum's
// sake.
template <class Real>
std::vector<std::uint8_t> LatticeRegion<Real>::nodes_of_changed(const Embedding& before, bool all) const {
  Flags changed = touched_nodes(before, all);
  for (Index v : before.vertices)
    if (const Index part = lattice_.part_of_vertex[std::size_t(v)]; part >= 0 && !embeds(v))
      for (Index n : lattice_.parts[std::size_t(part)].nodes) changed[std::size_t(n)] = 1;
  return changed;
}

// New nodes begin with the mean of their vertices.
template <class Real>
void LatticeRegion<Real>::begin_fresh_nodes(const Elements& elements, const Flags& fresh,
                                            const Mat3X<double>& u, Mat3X<double>& q) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(q.cols());
  for (Index n = 0; n < lattice_.node_count(); ++n)
    if (fresh[std::size_t(n)]) q.col(n).setZero();
  for (Index v : embedding_.vertices) {
    const CellWeights w = lattice_.weights(v, elements.points.col(v)).cwiseAbs();
    const Lattice::Part& part = lattice_.parts[std::size_t(lattice_.part_of_vertex[std::size_t(v)])];
    for (int i = 0; i < 8; ++i) {
      const Index n = part.nodes[std::size_t(i)];
      if (!fresh[std::size_t(n)]) continue;
      q.col(n) += w[i] * u.col(v);
      sum[n] += w[i];
    }
  }
  for (Index n = 0; n < lattice_.node_count(); ++n)
    if (fresh[std::size_t(n)] && sum[n] > 0) q.col(n) /= sum[n];
}

template <class Real>
void LatticeRegion<Real>::add_nodes(const Lattice& lattice, const std::vector<double>& mass,
                                    const Nodes<Real>& nodes, const Flags* which, MovingMasses& sum) const {
  for (std::size_t n = 0; n < mass.size(); ++n) {
    if (mass[n] == 0 || (which && !(*which)[n])) continue;
    const auto column = Eigen::Index(n);
    sum.add(mass[n], lattice.nodes.col(column) + nodes.u.col(column).template cast<double>(),
            nodes.v.col(column).template cast<double>());
  }
}

// The momentum of what an edit has removed goes with it: vertices are counted then by the masses that are
// left.
template <class Real>
void LatticeRegion<Real>::embed(const Model& model, VertexRoles wanted, double omega,
                                std::vector<double>& mass, Loads<Real>& loads, Motion<Real>& motion) {
  const Elements& elements = model.elements;
  const Embedding former = std::move(embedding_);
  const auto was_embedded = [&](Index v) { return former.embeds(v); };
  const auto add_vertex = [&](Index v, MovingMasses& sum) {
    sum.add(mass[std::size_t(v)], elements.points.col(v) + motion.u.col(v).template cast<double>(),
            motion.v.col(v).template cast<double>());
  };
  MovingMasses before, after, free_to_change;
  for (Index v : vertices_)
    if (is_outdated_ ? was_embedded(v) || wanted.embeds(v) : !was_embedded(v) && wanted.embeds(v))
      add_vertex(v, before);
  if (!is_outdated_) add_nodes(lattice_, former.mass, motion.nodes, nullptr, before);

  const bool is_anew = is_outdated_;
  if (is_anew) make_lattice_anew(elements, motion.nodes);
  is_outdated_ = has_lost_ = false;
  embedding_ = lobe::embed(elements, lattice_, whole_, std::move(wanted));
  mass_added_ = give_mass(elements, lattice_, mass, omega, embedding_);

  const Flags touched = touched_nodes(former, is_anew);
  Flags fresh = touched;
  for (std::size_t n = 0; n < fresh.size(); ++n)
    fresh[n] = fresh[n] && (is_anew ? motion.nodes.u.col(Eigen::Index(n)).isZero(0)
                                    : former.mass.empty() || former.mass[n] == 0);
  const auto take = [&](const auto& of_vertices, Mat3X<Real>& of_nodes) {
    const Mat3X<double> u = of_vertices.view().template cast<double>();
    Mat3X<double> q = of_nodes.template cast<double>();
    begin_fresh_nodes(elements, fresh, u, q);
    settle(elements, lattice_, embedding_, whole_cells_, mass, omega, touched, u, settled<Real>, q);
    of_nodes = q.template cast<Real>();
  };
  take(motion.u, motion.nodes.u);
  take(motion.v, motion.nodes.v);

  std::vector<Index> freed;
  for (Index v : vertices_)
    if (was_embedded(v) && !embeds(v)) {
      add_vertex(v, after);
      if (model.held.holds(v) || mass[std::size_t(v)] == 0) continue;
      freed.push_back(v);
      add_vertex(v, free_to_change);
    }
  add_nodes(lattice_, embedding_.mass, motion.nodes, nullptr, after);
  const Flags changed = nodes_of_changed(former, is_anew);
  add_nodes(lattice_, embedding_.mass, motion.nodes, &changed, free_to_change);
  const MovingMasses::Motion change = free_to_change.moved_by(before.momentum() - after.momentum());
  for (Index v : freed)
    motion.v.col(v) +=
        change(elements.points.col(v) + motion.u.col(v).template cast<double>()).template cast<Real>();
  for (Index n = 0; n < lattice_.node_count(); ++n)
    if (changed[std::size_t(n)])
      motion.nodes.v.col(n) +=
          change(lattice_.nodes.col(n) + motion.nodes.u.col(n).template cast<double>()).template cast<Real>();

  take_over(elements, mass, loads);
  build(elements);
  motion.node_forces.setZero(3, lattice_.node_count());
  motion.node_turns.assign(std::size_t(lattice_.node_count()), 0);
  std::erase_if(vertices_, [&](Index v) {
    const auto around = elements.topology.around(v);
    return std::none_of(around.begin(), around.end(), [&](Index t) { return member_[std::size_t(t)] != 0; });
  });
}

// Loads and masses of embedded vertices go to the nodes.
template <class Real>
void LatticeRegion<Real>::take_over(const Elements& elements, std::vector<double>& mass, Loads<Real>& loads) {
  external_.setZero(3, lattice_.node_count());
  dead_.setZero(3, lattice_.node_count());
  for (Index v : embedding_.vertices) {
    const CellWeights w = lattice_.weights(v, elements.points.col(v));
    const Lattice::Part& part = lattice_.parts[std::size_t(lattice_.part_of_vertex[std::size_t(v)])];
    for (int n = 0; n < 8; ++n) {
      external_.col(part.nodes[std::size_t(n)]) += Real(w[n]) * loads.external().col(v);
      dead_.col(part.nodes[std::size_t(n)]) += Real(w[n]) * loads.dead().col(v);
    }
    loads.external().col(v).setZero();
    loads.dead().col(v).setZero();
    mass[std::size_t(v)] = 0;
  }
}

template <class Real>
void LatticeRegion<Real>::build(const Elements& elements) {
  full_.visit_patches([&](const auto&, const auto& sums) {
    past_patches_.evaluated += sums.count().evaluated;
    past_patches_.skipped += sums.count().skipped;
  });
  full_ = NonlinearRegion<Real>(evaluator_);
  RegionEdit edit;
  if (any_embedded()) edit.entered = embedding_.full;
  full_.follow(elements, edit, RegionModel::reduced);
  cells_.build(elements, lattice_, embedding_.cells);
  place_interface(elements);
  moving_.clear();
  for (std::size_t n = 0; n < embedding_.mass.size(); ++n)
    if (embedding_.mass[n] > 0)
      moving_.push_back({static_cast<Index>(n), static_cast<Real>(1 / embedding_.mass[n])});
}

template <class Real>
void LatticeRegion<Real>::place_interface(const Elements& elements) {
  places_.clear();
  std::vector<std::vector<Share>> shares(std::size_t(lattice_.node_count()));
  for (Index v : embedding_.interface) {
    const CellWeights w = lattice_.weights(v, elements.points.col(v));
    Place place{.vertex = v,
                .nodes = lattice_.parts[std::size_t(lattice_.part_of_vertex[std::size_t(v)])].nodes};
    for (std::size_t n = 0; n < 8; ++n) {
      place.weights[n] = static_cast<Real>(w[Eigen::Index(n)]);
      shares[std::size_t(place.nodes[n])].push_back({v, place.weights[n]});
    }
    places_.push_back(place);
  }
  shares_begin_.assign(1, 0);
  shares_.clear();
  for (const std::vector<Share>& list : shares) {
    shares_.insert(shares_.end(), list.begin(), list.end());
    shares_begin_.push_back(static_cast<Index>(shares_.size()));
  }
}

template <class Real>
void LatticeRegion<Real>::settle_all(const Elements& elements, double omega, Motion<Real>& motion) const {
  if (!any_embedded()) return;
  std::vector<double> mass(std::size_t(elements.topology.vertex_count()), 0);
  for (Index v : embedding_.vertices) mass[std::size_t(v)] = lumped_mass(elements, v);
  const Flags touched = touched_nodes({}, true);
  const auto take = [&](const auto& of_vertices, Mat3X<Real>& of_nodes) {
    const Mat3X<double> u = of_vertices.view().template cast<double>();
    Mat3X<double> q = Mat3X<double>::Zero(3, lattice_.node_count());
    begin_fresh_nodes(elements, touched, u, q);
    settle(elements, lattice_, embedding_, whole_cells_, mass, omega, touched, u, settled<Real>, q);
    of_nodes = q.template cast<Real>();
  };
  take(motion.u, motion.nodes.u);
  take(motion.v, motion.nodes.v);
}

template <class Real>
typename LatticeRegion<Real>::State LatticeRegion<Real>::state(const Motion<Real>& motion) const {
  return {motion.nodes.u, motion.nodes.v, embedding_.roles.is_embedded, zones_.state()};
}

template <class Real>
bool LatticeRegion<Real>::fits(const State& state, const Elements& elements) const {
  const Index vertices = elements.topology.vertex_count();
  const auto are_vertices = [&](const std::vector<Index>& list) {
    return std::is_sorted(list.begin(), list.end()) &&
           (list.empty() || (list.front() >= 0 && list.back() < vertices));
  };
  bool fits = state.u.cols() == lattice_.node_count() &&
              state.is_embedded.size() == embedding_.roles.is_embedded.size() &&
              state.zones.until.size() <= std::size_t(vertices) && are_vertices(state.zones.held) &&
              are_vertices(state.zones.touched);
  for (std::size_t v = 0; fits && v < state.is_embedded.size(); ++v) {
    if (!state.is_embedded[v]) continue;
    const auto around = elements.topology.around(static_cast<Index>(v));
    fits = std::all_of(around.begin(), around.end(), [&](Index t) { return member_[std::size_t(t)] != 0; }) &&
           !around.empty();
  }
  return fits;
}

// ---- A step

// From differences to the first node, so that a translation strains nothing.
template <class Real>
void LatticeRegion<Real>::place(Motion<Real>& motion, Parallel& parallel) const {
  parallel.for_ranges(static_cast<Index>(places_.size()), 1024, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const Place& own = places_[std::size_t(i)];
      const Vec3<Real> first = motion.nodes.u.col(own.nodes[0]);
      Vec3<Real> sum = Vec3<Real>::Zero();
      for (std::size_t n = 1; n < 8; ++n) sum += own.weights[n] * (motion.nodes.u.col(own.nodes[n]) - first);
      motion.u.col(own.vertex) = first + sum;
    }
  });
}

template <class Real>
void LatticeRegion<Real>::collect(double missing, Motion<Real>& motion, Parallel& parallel) {
  cells_.find_forces(motion.nodes.u, parallel);
  parallel.for_ranges(static_cast<Index>(moving_.size()), 1024, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const Index n = moving_[std::size_t(i)].vertex;
      Vec3<Real> sum = external_.col(n) + cells_.force(n);
      if (missing > 0) sum -= Real(missing) * dead_.col(n);
      for (Index s = shares_begin_[std::size_t(n)]; s < shares_begin_[std::size_t(n) + 1]; ++s)
        sum += shares_[std::size_t(s)].weight * motion.forces.col(shares_[std::size_t(s)].vertex);
      motion.node_forces.col(n) = sum;
    }
  });
}

// ---- Displacements, velocities and energies

template <class Real>
void LatticeRegion<Real>::recover(const Elements& elements, bool velocities,
                                  StateColumns<Real>& state) const {
  for (Index v : embedding_.vertices) {
    const Eigen::Matrix<Real, 8, 1> w = lattice_.weights(v, elements.points.col(v)).template cast<Real>();
    const auto& nodes = lattice_.parts[std::size_t(lattice_.part_of_vertex[std::size_t(v)])].nodes;
    const auto value = [&](const Mat3X<Real>& q) -> Vec3<Real> {
      const Vec3<Real> first = q.col(nodes[0]);
      Vec3<Real> sum = Vec3<Real>::Zero();
      for (int n = 1; n < 8; ++n) sum += w[n] * (q.col(nodes[std::size_t(n)]) - first);
      return first + sum;
    };
    state.u.col(v) = value(state.nodes.u);
    if (velocities) state.v.col(v) = value(state.nodes.v);
  }
}

template <class Real>
double LatticeRegion<Real>::elastic_energy(const Mat3X<Real>& u, const Nodes<Real>& nodes) {
  return full().energy(u) + cells_.energy(nodes.u);
}

template <class Real>
double LatticeRegion<Real>::energy_of_loads(const Nodes<Real>& nodes) const {
  return -external_.template cast<double>().cwiseProduct(nodes.u.template cast<double>()).sum();
}

template <class Real>
double LatticeRegion<Real>::kinetic_energy(const Nodes<Real>& nodes) const {
  double twice = 0;
  for (std::size_t n = 0; n < embedding_.mass.size(); ++n)
    twice += embedding_.mass[n] * nodes.v.col(Eigen::Index(n)).template cast<double>().squaredNorm();
  return twice / 2;
}

template <class Real>
typename LatticeRegion<Real>::Frequency LatticeRegion<Real>::highest_frequency(const Nodes<Real>& nodes,
                                                                               const DiagonalStiffness& K,
                                                                               double ratio) const {
  Frequency found;
  if (!any_embedded()) return found;
  std::vector<double> bounds(std::size_t(lattice_.node_count()), 0);
  found.smallest = cells_.add_bounds(nodes.u, bounds);
  for (const Place& own : places_) {
    double sum = 0;
    for (Real w : own.weights) sum += std::abs(double(w));
    const double stiffness = ratio * ratio * sum * bound_of(K.col(own.vertex));
    for (std::size_t n = 0; n < 8; ++n)
      bounds[std::size_t(own.nodes[n])] += std::abs(double(own.weights[n])) * stiffness;
  }
  double square = 0;
  for (const MovingVertex<Real>& moving : moving_)
    square =
        std::max(square, bounds[std::size_t(moving.vertex)] / embedding_.mass[std::size_t(moving.vertex)]);
  found.omega = std::sqrt(square);
  return found;
}

template class LatticeRegion<float>;
template class LatticeRegion<double>;

}  // namespace lobe
