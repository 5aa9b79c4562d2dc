#include "lobe/lattice/lattice_region.h"

#include <algorithm>
#include <cmath>

#include "lobe/numerics/symmetric_eigen.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

Mat3<double> symmetric(const Eigen::Matrix<double, 6, 1>& K) {  // xx, xy, xz, yy, yz, zz
  Mat3<double> matrix;
  matrix << K[0], K[1], K[2], K[1], K[3], K[4], K[2], K[4], K[5];
  return matrix;
}

}  // namespace

// ---- Edits

template <class Real>
void LatticeRegion<Real>::follow(const Elements& elements, const RegionEdit& edit) {
  const auto enters = [&](Index t) { return elements.is_in(RegionModel::reduced, t); };
  if (!any() && std::none_of(edit.entered.begin(), edit.entered.end(), enters)) return;
  inner_.clear();
  zones_.forget_around();
  all_.follow(elements, edit, RegionModel::reduced);
  member_.resize(std::size_t(elements.topology.tet_count()), Membership::outside);
  for (Index t : edit.left) {
    const bool was_inside = has(t), is_elsewhere = elements.topology.alive(t) && !enters(t),
               is_freed = is_elsewhere && elements.is_in(RegionModel::nonlinear, t);
    Membership& own = member_[std::size_t(t)];
    if (own != Membership::outside) own = is_freed ? Membership::freed : Membership::outside;
    if (!was_inside) continue;
    --tet_count_;
    misses_tets_ = true;
    if (!is_elsewhere) is_outdated_ = true;
    if (!is_outdated_) take_out(elements, t, lattice_, whole_);
  }
  for (Index t : edit.entered) {
    if (!enters(t) || has(t)) continue;
    member_[std::size_t(t)] = Membership::inside;
    ++tet_count_;
    is_outdated_ = true;
  }
  zone_mass_.follow(elements, edit.vertices, [&](Index t) { return membership(t) != Membership::outside; });
  for (Index v : edit.vertices)
    if (zone_mass_.may_raise(v)) vertices_.push_back(v);
  sort_unique(vertices_);
  if (is_outdated_) list_vertices(elements.topology);
  if (any() && lattice_.frame.edge == 0) lattice_.frame = choose_lattice(elements, cell_);
}

// Vertices that were listed before stay so until embed(), which changes their masses and loads.
template <class Real>
void LatticeRegion<Real>::list_vertices(const Topology& topology) {
  std::vector<std::uint8_t> is_vertex(std::size_t(topology.vertex_count()), 0);
  for (Index v : vertices_) is_vertex[std::size_t(v)] = 1;
  for (Index t = 0; t < topology.tet_count(); ++t)
    if (has(t))
      for (Index v : topology.corners(t)) is_vertex[std::size_t(v)] = 1;
  vertices_.clear();
  for (Index v = 0; v < topology.vertex_count(); ++v)
    if (is_vertex[std::size_t(v)]) vertices_.push_back(v);
}

template <class Real>
void LatticeRegion<Real>::make_lattice_anew(const Elements& elements, Nodes<Real>& nodes) {
  Lattice fresh = make_lattice(elements, lattice_.frame);
  nodes = values_of(fresh, lattice_, nodes);
  lattice_ = std::move(fresh);
  whole_ = sum_cells(elements, lattice_);
  whole_cells_ =
      lobe::embed(elements, lattice_, whole_, {Flags(std::size_t(elements.topology.vertex_count()), 1), {}})
          .cells;
}

// The momentum of what an edit has removed goes with it: vertices are counted then by the masses that are
// left.
template <class Real>
MovingMasses LatticeRegion<Real>::in_motion_before(const Elements& elements, const Embedding& former,
                                                   const VertexRoles& wanted, const std::vector<double>& mass,
                                                   const Motion<Real>& motion) const {
  MovingMasses sum;
  for (Index v : vertices_)
    if (is_outdated_ ? former.embeds(v) || wanted.embeds(v) : !former.embeds(v) && wanted.embeds(v))
      sum.add(mass[std::size_t(v)], elements.points.col(v) + motion.u.col(v).template cast<double>(),
              motion.v.col(v).template cast<double>());
  if (!is_outdated_) add_nodes(lattice_, former.mass, motion.nodes, nullptr, sum);
  zone_mass_.add_to(sum, elements, motion, [](Index) { return true; });
  return sum;
}

template <class Real>
void LatticeRegion<Real>::embed(const Model& model, VertexRoles wanted, double omega,
                                std::vector<double>& mass, Loads<Real>& loads, Motion<Real>& motion) {
  const Elements& elements = model.elements;
  const Embedding former = std::move(embedding_);
  const Mat3X<Real> faded_before = notes_lost_ ? fading(motion) : Mat3X<Real>();
  const bool is_anew = is_outdated_;
  if (is_anew) {
    make_lattice_anew(elements, motion.nodes);
    inner_.clear();  // where cuts end in it was not known before
    for (Index v : vertices_)
      if (is_at_cut_end(v)) wanted.is_embedded[std::size_t(v)] = 0;
  }
  const MovingMasses before = in_motion_before(elements, former, wanted, mass, motion);
  is_outdated_ = misses_tets_ = false;
  embedding_ = lobe::embed(elements, lattice_, whole_, std::move(wanted));
  omega_ = omega;
  mass_added_ = give_mass(elements, lattice_, mass, omega, zone_mass_.stiffness(), embedding_);
  zone_mass_.raise(embedding_, omega, vertices_, mass);

  const TakeOver<Real> change(elements, lattice_, whole_cells_, former, embedding_, is_anew);
  change.settle_nodes(mass, omega, motion);
  MovingMasses after;  // and what keep_momentum() adds
  zone_mass_.add_to(after, elements, motion, [&](Index v) { return !former.embeds(v); });
  change.keep_momentum(model, mass, before, std::move(after), motion);
  if (notes_lost_) note_lost(elements, faded_before, motion);
  fading_.begin(elements, lattice_, embedding_, motion);

  take_loads(elements, mass, loads);
  build(elements);
  motion.node_forces.setZero(3, lattice_.node_count());
  motion.node_turns.assign(std::size_t(lattice_.node_count()), 0);
  std::erase_if(vertices_, [&](Index v) {
    const auto around = elements.topology.around(v);
    return around.empty() || (!zone_mass_.may_raise(v) &&
                              std::none_of(around.begin(), around.end(), [&](Index t) { return has(t); }));
  });
}

// Loads and masses of embedded vertices go to the nodes.
template <class Real>
void LatticeRegion<Real>::take_loads(const Elements& elements, std::vector<double>& mass,
                                     Loads<Real>& loads) {
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
  full_ = NonlinearRegion<Real>();
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
void LatticeRegion<Real>::settle_all(const Elements& elements, double omega, Motion<Real>& motion) {
  if (!any_embedded()) return;
  std::vector<double> mass(std::size_t(elements.topology.vertex_count()), 0);
  for (Index v : embedding_.vertices) mass[std::size_t(v)] = lumped_mass(elements, v);
  const Nodes<Real> none = {Mat3X<Real>::Zero(3, lattice_.node_count()),
                            Mat3X<Real>::Zero(3, lattice_.node_count())};
  motion.nodes = none;
  TakeOver<Real>(elements, lattice_, whole_cells_, {}, embedding_, true).settle_nodes(mass, omega, motion);
  fading_.begin(elements, lattice_, embedding_, motion);
}

template <class Real>
typename LatticeRegion<Real>::Slowed LatticeRegion<Real>::slow_strained(
    const std::vector<double>& mass, const std::function<double(Index, double)>& square,
    Motion<Real>& motion) {
  Slowed slowed;
  if (!any_embedded()) return slowed;
  const double highest = omega_ * omega_, least = ZoneMass::strained * highest;
  for (Index v : vertices_) {
    if (embeds(v) || !zone_mass_.may_raise(v)) continue;
    const double own = square(v, least);
    if (!(own > least)) continue;
    const double more = ZoneMass::spare * own / highest, before = mass[std::size_t(v)];
    const double energy = 0.5 * before * double(motion.v.col(v).squaredNorm());
    slowed.kinetic += energy / more - energy;
    zone_mass_.ask(v, more * before);
    motion.v.col(v) /= Real(more);
    slowed.vertices.push_back(v);
  }
  return slowed;
}

template <class Real>
typename LatticeRegion<Real>::State LatticeRegion<Real>::state(const Motion<Real>& motion) const {
  return {motion.nodes.u, motion.nodes.v,  embedding_.roles.is_embedded,
          zones_.state(), fading_.state(), zone_mass_.asked()};
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
              std::max({state.zones.until.size(), state.zones.asked_until.size(), state.asked_mass.size()}) <=
                  std::size_t(vertices) &&
              are_vertices(state.zones.held) && are_vertices(state.zones.touched);
  fits = fits && are_vertices(state.fading.vertices) &&
         std::all_of(state.fading.vertices.begin(), state.fading.vertices.end(), [&](Index v) {
           return v < static_cast<Index>(state.is_embedded.size()) && state.is_embedded[std::size_t(v)];
         });
  for (std::size_t v = 0; fits && v < state.is_embedded.size(); ++v) {
    if (!state.is_embedded[v]) continue;
    const auto around = elements.topology.around(static_cast<Index>(v));
    fits = std::all_of(around.begin(), around.end(), [&](Index t) { return has(t); }) && !around.empty();
  }
  return fits;
}

template <class Real>
std::vector<Index> LatticeRegion<Real>::set_asked_mass(const std::vector<double>& asked) {
  std::vector<Index> changed;
  const std::vector<double>& former = zone_mass_.asked();
  const auto value = [](const std::vector<double>& of, std::size_t v) { return v < of.size() ? of[v] : 0; };
  for (std::size_t v = 0; v < std::max(former.size(), asked.size()); ++v)
    if (value(former, v) != value(asked, v) && !embeds(static_cast<Index>(v)))
      changed.push_back(static_cast<Index>(v));
  zone_mass_.set_asked(asked);
  return changed;
}

// ---- A step

// From differences to the first node, so that a translation strains nothing.
template <class Real>
void LatticeRegion<Real>::place(bool velocities, Motion<Real>& motion, Parallel& parallel) const {
  const auto value = [](const Place& own, const Mat3X<Real>& q) -> Vec3<Real> {
    const Vec3<Real> first = q.col(own.nodes[0]);
    Vec3<Real> sum = Vec3<Real>::Zero();
    for (std::size_t n = 1; n < 8; ++n) sum += own.weights[n] * (q.col(own.nodes[n]) - first);
    return first + sum;
  };
  parallel.for_ranges(static_cast<Index>(places_.size()), 1024, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const Place& own = places_[std::size_t(i)];
      motion.u.col(own.vertex) = value(own, motion.nodes.u);
      if (velocities) motion.v.col(own.vertex) = value(own, motion.nodes.v);
    }
  });
  fading_.add_at_full(velocities, motion, parallel);
}

template <class Real>
std::vector<Index> LatticeRegion<Real>::pressed_unseen(const Motion<Real>& motion) const {
  std::vector<Index> found;
  for (Index v : embedding_.vertices)
    if (!motion.forces.col(v).isZero(0) &&
        !std::binary_search(embedding_.interface.begin(), embedding_.interface.end(), v))
      found.push_back(v);
  return found;
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
  fading_.add_forces(motion);
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
  fading_.add(velocities, state);
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
typename LatticeRegion<Real>::Frequency LatticeRegion<Real>::highest_frequency(
    const StateColumns<Real>& state, const DiagonalStiffness& K, double ratio) {
  Frequency found;
  if (!any_embedded()) return found;
  std::vector<double> bounds(std::size_t(lattice_.node_count()), 0);
  found.smallest = cells_.add_bounds(state.nodes.u, bounds);
  for (const Place& own : places_) {
    std::array<Real, 8> weights = fading_.change_of_weights(own.vertex, state.time);
    double sum = 0;
    for (std::size_t n = 0; n < 8; ++n) sum += std::abs(double(weights[n] += own.weights[n]));
    const double stiffness = ratio * ratio * sum * largest_eigenvalue(symmetric(K.col(own.vertex)));
    for (std::size_t n = 0; n < 8; ++n)
      bounds[std::size_t(own.nodes[n])] += std::abs(double(weights[n])) * stiffness;
  }
  double square = 0;
  for (const MovingVertex<Real>& moving : moving_) {
    found.squares.push_back(bounds[std::size_t(moving.vertex)] / embedding_.mass[std::size_t(moving.vertex)]);
    square = std::max(square, found.squares.back());
  }
  found.omega = std::sqrt(square);
  return found;
}

template class LatticeRegion<float>;
template class LatticeRegion<double>;

}  // namespace lobe
