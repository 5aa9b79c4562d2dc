// How the pre-computed region follows edits. An edit promotes the components around it to the interface,
// changes stiffness and loads there, and demotes those that are interior afterwards.
#include <algorithm>
#include <iterator>
#include <utility>

#include "lobe/condense/interface_size.h"
#include "lobe/condense/precomputed.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

// Which components boundary conditions and tools fix or drive. If one component of a vertex is driven, all
// its held components count as driven; in a frame that turns, all its components.
class Hold {
 public:
  Hold(const Elements& elements, const HeldVertices& held)
      : elements_(elements), has_frame_(elements.precomputed_frame == RegionFrame::corotated) {
    state_.setZero(3, elements.topology.vertex_count());
    for (const HeldVertices::Held& item : held.all()) {
      const bool stays = item.holder == HeldVertices::boundary && item.start.isZero(0) && item.goal.isZero(0);
      for (int axis = 0; axis < 3; ++axis)
        if (item.axes[axis]) state_(axis, item.vertex) = stays ? fixed : driven;
    }
  }

  Role role(Index v, int axis) const {
    bool in_region = false, in_others = false;
    for (Index t : elements_.topology.around(v))
      (elements_.is_in(RegionModel::precomputed, t) ? in_region : in_others) = true;
    if (!in_region) return Role::none;
    if (has_frame_) return in_others || !state_.col(v).isZero() ? Role::interface : Role::interior;
    if (state_(axis, v) == fixed) return Role::none;
    return in_others || state_(axis, v) == driven ? Role::interface : Role::interior;
  }

 private:
  enum : std::uint8_t { nobody, fixed, driven };
  const Elements& elements_;
  bool has_frame_;
  Eigen::Matrix<std::uint8_t, 3, Eigen::Dynamic> state_;
};

std::vector<Index> components_of(const std::vector<Index>& vertices) {
  std::vector<Index> components;
  for (Index v : vertices)
    for (int axis = 0; axis < 3; ++axis) components.push_back(3 * v + axis);
  return components;
}

template <class Picks>
std::vector<Index> picked(const std::vector<Index>& components, Picks&& picks) {
  std::vector<Index> found;
  std::copy_if(components.begin(), components.end(), std::back_inserter(found), picks);
  return found;
}

// Adds the linearised forces of an element to the components that have a row.
template <int size, class Vertices>
void add_element(const Linearisation::Forces<size>& linear, const Vertices& vertices, double factor,
                 const std::vector<Index>& row, CondensedRegion::Change& sum) {
  std::vector<Index> at;
  for (Index v : vertices)
    for (int axis = 0; axis < 3; ++axis) at.push_back(row[std::size_t(3 * v + axis)]);
  const auto count = static_cast<Index>(at.size());
  for (Index i = 0; i < count; ++i) {
    if (at[i] < 0) continue;
    sum.loads(at[i], 0) += factor * linear.constant[i];
    for (Index j = 0; j < count; ++j)
      if (at[j] >= 0) sum.stiffness(at[i], at[j]) += factor * linear.K(i, j);
  }
}

}  // namespace

template <class Real>
void PrecomputedRegion<Real>::refuse_large(const Elements& elements, const HeldVertices& held) {
  const Hold hold(elements, held);
  Index interface = 0;
  for (Index v = 0; v < elements.topology.vertex_count(); ++v)
    for (int axis = 0; axis < 3; ++axis) interface += hold.role(v, axis) == Role::interface;
  refuse_interface(interface);
}

template <class Real>
std::vector<Index> PrecomputedRegion<Real>::follow(const Elements& elements, const HeldVertices& held,
                                                   const RegionEdit& edit, Mat3X<Real>& external,
                                                   Mat3X<Real>& dead) {
  const auto enters = [&](Index t) { return elements.is_in(RegionModel::precomputed, t); };
  has_changed_ = false;
  if (tet_count_ == 0 && std::none_of(edit.entered.begin(), edit.entered.end(), enters)) return {};
  has_frame_ = elements.precomputed_frame == RegionFrame::corotated;
  grow(elements, edit);
  const Hold hold(elements, held);
  DomainChange domains;
  domains.changed =
      domains_.follow(elements, edit.left, edit.entered, RegionModel::precomputed, &domains.before);
  const std::vector<Index> components = components_of(concerned(edit, domains));
  const auto has_role = [&](Index i) { return roles_.data()[i] != Role::none; };
  has_changed_ = !condensed_ || std::any_of(components.begin(), components.end(), has_role);
  for (Index i : components) roles_.data()[i] = hold.role(i / 3, i % 3);
  has_changed_ = has_changed_ || std::any_of(components.begin(), components.end(), has_role);
  if (!has_changed_) {
    change_members(elements, edit);
    return {};
  }
  std::vector<Index> mechanism;
  if (!condensed_) {
    change_members(elements, edit);
    take_loads(edit.vertices, external, dead);
    build(elements);
  } else if (is_expanded_) {
    change_members(elements, edit);
    take_loads(edit.vertices, external, dead);
    is_outdated_ = recondensed_is_outdated_ = true;
    return {};
  } else {
    open(components);
    change(elements, edit, domains, components, external, dead);
    mechanism = close(elements, components);
    if (mechanism.empty()) keep_exact(elements, components);
  }
  prepare_step(elements);
  return mechanism;
}

// The vertices whose stiffness or role an edit changes.
template <class Real>
std::vector<Index> PrecomputedRegion<Real>::concerned(const RegionEdit& edit,
                                                      const DomainChange& domains) const {
  if (domains.changed.empty()) return edit.vertices;
  std::vector<Index> vertices = edit.vertices;
  const auto add = [&](const SmoothedEdge& domain) {
    if (domain.volume > 0) vertices.insert(vertices.end(), domain.vertices.begin(), domain.vertices.end());
  };
  for (const SmoothedEdge& domain : domains.before) add(domain);
  for (Index e : domains.changed) add(domains_[e]);
  sort_unique(vertices);
  return vertices;
}

// Makes room for tetrahedra and vertices that are new.
template <class Real>
void PrecomputedRegion<Real>::grow(const Elements& elements, const RegionEdit& edit) {
  const Index tets = elements.topology.tet_count(), vertices = elements.topology.vertex_count();
  member_.resize(std::size_t(tets), 0);
  shares_.resize(std::size_t(tets), 1);
  if (!condensed_)
    corners_ = elements.topology.tets();
  else
    corners_.conservativeResize(4, tets);
  roles_.conservativeResizeLike(Roles::Constant(3, vertices, Role::none));
  for (Mat3X<double>& load : loads_) load.conservativeResizeLike(Mat3X<double>::Zero(3, vertices));
  extend(linearisation_, edit);
  extend(recondensed_linearisation_, edit);
}

// Promotes the components that belong to the interface from now on, and those that are new.
template <class Real>
void PrecomputedRegion<Real>::open(const std::vector<Index>& components) {
  const auto role = [&](Index i) { return roles_.data()[i]; };
  condensed_->promote(
      picked(components, [&](Index i) { return condensed_->is_interior(i) && role(i) == Role::interface; }));
  condensed_->add(picked(components, [&](Index i) { return !condensed_->has(i) && role(i) != Role::none; }));
}

// Changes stiffness and loads. Components that become fixed are first promoted to the interface. Components
// to which nothing is attached any more are held by a spring.
template <class Real>
void PrecomputedRegion<Real>::change(const Elements& elements, const RegionEdit& edit,
                                     const DomainChange& domains, const std::vector<Index>& all,
                                     Mat3X<Real>& external, Mat3X<Real>& dead) {
  condensed_->promote(picked(all, [&](Index i) {
    const auto around = elements.topology.around(i / 3);
    return condensed_->is_interior(i) && roles_.data()[i] == Role::none &&
           std::any_of(around.begin(), around.end(),
                       [&](Index t) { return elements.is_in(RegionModel::precomputed, t); });
  }));
  const std::vector<Index> components = picked(all, [&](Index i) { return condensed_->has(i); });
  const auto count = Eigen::Index(components.size());
  const auto nothing = [&] {
    return CondensedRegion::Change{Eigen::MatrixXd::Zero(count, count),
                                   Eigen::MatrixXd::Zero(count, amplitudes())};
  };
  CondensedRegion::Change now = nothing(), repeated = nothing();
  std::vector<Index> row(std::size_t(roles_.size()), -1);
  for (std::size_t i = 0; i < components.size(); ++i) row[std::size_t(components[i])] = static_cast<Index>(i);
  const auto add_members = [&](const std::vector<Index>& tets, double sign) {
    for (Index t : tets) {
      if (!member_[t]) continue;
      add(linearisation_, elements, t, sign, row, now);
      if (is_condensing()) add(recondensed_linearisation_, elements, t, sign, row, repeated);
    }
  };
  const auto add_domain = [&](const SmoothedEdge& domain, double sign) {
    if (!(domain.volume > 0)) return;
    add_element(linearisation_.forces(elements, domain), domain.vertices, sign, row, now);
    if (is_condensing())
      add_element(recondensed_linearisation_.forces(elements, domain), domain.vertices, sign, row, repeated);
  };
  add_members(edit.left, -1);
  for (const SmoothedEdge& domain : domains.before) add_domain(domain, -1);
  change_members(elements, edit);
  add_members(edit.entered, 1);
  for (Index e : domains.changed) add_domain(domains_[e], 1);
  const Loads before = loads_;
  take_loads(edit.vertices, external, dead);
  for (CondensedRegion::Change* change : {&now, &repeated})
    for (Eigen::Index i = 0; i < count; ++i) {
      const Index component = components[std::size_t(i)];
      change->loads.row(i) += load_row(loads_, component) - load_row(before, component);
      if (roles_.data()[component] == Role::none && condensed_->is_interior(component))
        change->stiffness(i, i) += condensed_->spring();
    }
  if (!now.stiffness.isZero(0) || !now.loads.isZero(0)) condensed_->change(components, now, repeated);
}

template <class Real>
void PrecomputedRegion<Real>::change_members(const Elements& elements, const RegionEdit& edit) {
  for (Index t : edit.left) {
    tet_count_ -= member_[t];
    member_[t] = 0;
  }
  for (Index t : edit.entered) {
    member_[t] = elements.is_in(RegionModel::precomputed, t);
    tet_count_ += member_[t];
    corners_.col(t) = elements.topology.corners(t);
    shares_[t] = elements.share_of(t);
  }
}

// Adds the stiffness of a member with the corners and the share that it had when it was last followed. `row`:
// of each component, or −1.
template <class Real>
void PrecomputedRegion<Real>::add(const Linearisation& linearisation, const Elements& elements, Index tet,
                                  double sign, const std::vector<Index>& row,
                                  CondensedRegion::Change& sum) const {
  if (!linearisation.is_element(elements, tet)) return;
  const Eigen::Vector4i corners = corners_.col(tet);
  const double factor = sign * shares_[tet] / elements.share_of(tet);
  add_element(linearisation.forces(elements, tet, corners), corners, factor, row, sum);
}

template <class Real>
void PrecomputedRegion<Real>::extend(Linearisation& linearisation, const RegionEdit& edit) const {
  if (linearisation.is_at_rest()) return;
  linearisation.about.conservativeResize(3, roles_.cols());
  for (const auto& [vertex, copy] : edit.copied)
    linearisation.about.col(copy) = linearisation.about.col(vertex);
}

// Takes the loads on the interior over from the world. They act through the region; all others stay with the
// world.
template <class Real>
void PrecomputedRegion<Real>::take_loads(const std::vector<Index>& vertices, Mat3X<Real>& external,
                                         Mat3X<Real>& dead) {
  for (Index i : components_of(vertices)) {
    const Index v = i / 3;
    const int axis = i % 3;
    loads_[0](axis, v) = loads_[1](axis, v) = 0;
    if (roles_(axis, v) != Role::interior) continue;
    loads_[0](axis, v) = double(std::exchange(external(axis, v), Real(0)));
    loads_[1](axis, v) = -double(std::exchange(dead(axis, v), Real(0)));
  }
}

// Demotes components that do not belong to the interface any more.
template <class Real>
std::vector<Index> PrecomputedRegion<Real>::close(const Elements& elements,
                                                  const std::vector<Index>& components) {
  condensed_->forget(
      picked(components, [&](Index i) { return condensed_->has(i) && roles_.data()[i] == Role::none; }));
  const std::vector<Index> interior = picked(
      components, [&](Index i) { return roles_.data()[i] == Role::interior && condensed_->column(i) >= 0; });
  std::vector<Index> mechanism;
  if (condensed_->demote(interior)) return mechanism;
  for (Index i : interior)
    for (Index t : elements.topology.around(i / 3)) mechanism.push_back(t);
  sort_unique(mechanism);
  return mechanism;
}

}  // namespace lobe
