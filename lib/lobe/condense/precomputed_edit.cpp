// The pre-computed region follows edits: each is a promotion of the components around it to the interface, a change of
// stiffness and loads there, and a demotion of those that are interior afterwards.
#include <algorithm>
#include <numeric>

#include "lobe/condense/precomputed.h"
#include "lobe/error.h"
#include "lobe/solve/tangent.h"

namespace lobe {
namespace {

constexpr double most_bytes = 2e9;  // of what is dense

bool is_member(const Elements& elements, Index tet) {
  return elements.topology.alive(tet) && elements.region_of[tet] == RegionModel::precomputed;
}

// What boundary conditions and tools do to the components of vertices. Where somebody leads one component of a vertex, he
// is taken to lead all that are held.
class Hold {
 public:
  Hold(const Elements& elements, const HeldVertices& held) : elements_(elements) {
    state_.setZero(3, elements.topology.vertex_count());
    for (const HeldVertices::Held& item : held.all()) {
      const bool stays = item.holder == HeldVertices::boundary && item.start.isZero(0) && item.goal.isZero(0);
      for (int axis = 0; axis < 3; ++axis)
        if (item.axes[axis]) state_(axis, item.vertex) = stays ? fixed : led;
    }
  }

  Role role(Index v, int axis) const {
    bool in_region = false, in_others = false;
    for (Index t : elements_.topology.around(v)) (is_member(elements_, t) ? in_region : in_others) = true;
    if (!in_region || state_(axis, v) == fixed) return Role::none;
    return in_others || state_(axis, v) == led ? Role::interface : Role::interior;
  }

 private:
  enum : std::uint8_t { nobody, fixed, led };
  const Elements& elements_;
  Eigen::Matrix<std::uint8_t, 3, Eigen::Dynamic> state_;
};

template <class Visit>  // visit(axis, vertex)
void for_components(const std::vector<Index>& vertices, Visit&& visit) {
  for (Index v : vertices)
    for (int axis = 0; axis < 3; ++axis) visit(axis, v);
}

void refuse_large(Index interface) {
  const double bytes = 36.0 * interface * interface;
  if (bytes <= most_bytes) return;
  throw InputError("precomputed region",
                   "its interface of " + std::to_string(interface / 3) + " vertices would take " +
                       std::to_string(std::lround(bytes / 1e6)) + " MB of dense matrices; at most " +
                       std::to_string(std::lround(most_bytes / 1e6)) +
                       " MB are used: let it end at a narrower part of the body, or make it tensor-mass");
}

}  // namespace

template <class Real>
std::vector<Index> PrecomputedRegion<Real>::follow(const Elements& elements, const HeldVertices& held,
                                                   const RegionEdit& edit, Mat3X<Real>& external,
                                                   Mat3X<Real>& dead) {
  const Index tets = elements.topology.tet_count(), vertices = elements.topology.vertex_count();
  const auto enters = [&](Index t) { return is_member(elements, t); };
  if (tet_count_ == 0 && std::none_of(edit.entered.begin(), edit.entered.end(), enters)) return {};
  member_.resize(std::size_t(tets), 0);
  corners_.conservativeResize(4, tets);
  roles_.conservativeResizeLike(Roles::Constant(3, vertices, Role::none));
  dof_.conservativeResizeLike(ComponentNumbers::Constant(3, vertices, -1));
  for (Mat3X<double>& load : loads_) load.conservativeResizeLike(Mat3X<double>::Zero(3, vertices));

  const Hold hold(elements, held);
  for_components(edit.vertices, [&](int axis, Index v) { roles_(axis, v) = hold.role(v, axis); });
  const bool afresh = !condensed_ || condensed_->touched() > most_touched_;
  std::vector<Index> mechanism;
  if (afresh) {
    change_members(elements, edit);
    take_loads(edit.vertices, external, dead);
    build(elements);
  } else {
    open(edit.vertices);
    change(elements, edit, external, dead);
    mechanism = close(elements, edit.vertices);
  }
  prepare_step(elements);
  return mechanism;
}

// On the interface what belongs to it from now on, and what is new.
template <class Real>
void PrecomputedRegion<Real>::open(const std::vector<Index>& vertices) {
  std::vector<Index> leaving, fresh;
  for_components(vertices, [&](int axis, Index v) {
    const Index dof = dof_(axis, v);
    if (dof < 0 && roles_(axis, v) != Role::none)
      fresh.push_back(3 * v + axis);
    else if (dof >= 0 && condensed_->column(dof) < 0 && roles_(axis, v) == Role::interface)
      leaving.push_back(dof);
  });
  condensed_->promote(leaving);
  Index dof = fresh.empty() ? 0 : condensed_->add(static_cast<Index>(fresh.size()), scale_);
  for (Index component : fresh) dof_.data()[component] = dof++;
}

// Stiffness and loads where they change. Components that nothing is attached to any more are held by a spring, unless
// they are on the interface, which they leave; what becomes fixed does so, too. A mechanism becomes one of the interface,
// for close() to find.
template <class Real>
void PrecomputedRegion<Real>::change(const Elements& elements, const RegionEdit& edit, Mat3X<Real>& external,
                                     Mat3X<Real>& dead) {
  std::vector<Index> dofs, components, inside, fixed;
  for_components(edit.vertices, [&](int axis, Index v) {
    if (dof_(axis, v) < 0) return;
    const auto around = elements.topology.around(v);
    if (roles_(axis, v) == Role::none && condensed_->column(dof_(axis, v)) < 0 &&
        std::any_of(around.begin(), around.end(), [&](Index t) { return is_member(elements, t); }))
      fixed.push_back(dof_(axis, v));
  });
  condensed_->promote(fixed);
  for_components(edit.vertices, [&](int axis, Index v) {
    if (dof_(axis, v) < 0) return;
    dofs.push_back(dof_(axis, v));
    components.push_back(3 * v + axis);
    if (condensed_->column(dofs.back()) < 0) inside.push_back(dofs.back());
  });
  const auto count = Eigen::Index(dofs.size());
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(count, count), loads(count, amplitudes);
  std::vector<Index> row(roles_.size(), -1);
  for (std::size_t i = 0; i < components.size(); ++i) row[std::size_t(components[i])] = static_cast<Index>(i);
  for (Index t : edit.left)
    if (member_[t]) add_stiffness(elements, t, -1, row, stiffness);
  change_members(elements, edit);
  for (Index t : edit.entered)
    if (member_[t]) add_stiffness(elements, t, 1, row, stiffness);
  const Loads before = loads_;
  take_loads(edit.vertices, external, dead);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Index component = components[std::size_t(i)];
    for (int a = 0; a < amplitudes; ++a)
      loads(i, a) = loads_[a].data()[component] - before[a].data()[component];
    const bool is_inside = condensed_->column(dofs[std::size_t(i)]) < 0;
    if (roles_.data()[component] == Role::none && is_inside) stiffness(i, i) += scale_;
  }
  if (stiffness.isZero(0) && loads.isZero(0)) return;
  if (condensed_->change(dofs, stiffness, loads)) return;
  condensed_->promote(inside);
  condensed_->change(dofs, stiffness, loads);
}

template <class Real>
void PrecomputedRegion<Real>::change_members(const Elements& elements, const RegionEdit& edit) {
  for (Index t : edit.left) {
    tet_count_ -= member_[t];
    member_[t] = 0;
  }
  for (Index t : edit.entered) {
    member_[t] = is_member(elements, t);
    tet_count_ += member_[t];
    corners_.col(t) = elements.topology.corners(t);
  }
}

// Between the corners that a member had when it was last followed. `row`: of each component, or −1.
template <class Real>
void PrecomputedRegion<Real>::add_stiffness(const Elements& elements, Index tet, double sign,
                                            const std::vector<Index>& row, Eigen::MatrixXd& sum) const {
  const TetStiffness K = tet_stiffness(elements, tet, Mat34<double>::Zero());
  std::array<Index, 12> at;
  for (int i = 0; i < 12; ++i) at[i] = row[std::size_t(3 * corners_(i / 3, tet) + i % 3)];
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j)
      if (at[i] >= 0 && at[j] >= 0) sum(at[i], at[j]) += sign * K(i, j);
}

// A load on the interior acts through the region, all others are the world's.
template <class Real>
void PrecomputedRegion<Real>::take_loads(const std::vector<Index>& vertices, Mat3X<Real>& external,
                                         Mat3X<Real>& dead) {
  for_components(vertices, [&](int axis, Index v) {
    std::array<double, amplitudes> load{};
    if (roles_(axis, v) == Role::interior) {
      load = {double(external(axis, v)), -double(dead(axis, v))};
      external(axis, v) = dead(axis, v) = 0;
    }
    for (int a = 0; a < amplitudes; ++a) loads_[a](axis, v) = load[a];
  });
}

// Back to the interior with what does not belong to the interface.
template <class Real>
std::vector<Index> PrecomputedRegion<Real>::close(const Elements& elements,
                                                  const std::vector<Index>& vertices) {
  std::vector<Index> interior, gone, interior_vertices;
  for_components(vertices, [&](int axis, Index v) {
    Index& dof = dof_(axis, v);
    if (dof < 0) return;
    const bool is_outside = condensed_->column(dof) >= 0;
    if (roles_(axis, v) == Role::interior && is_outside) {
      interior.push_back(dof);
      interior_vertices.push_back(v);
    } else if (roles_(axis, v) == Role::none) {
      if (is_outside) gone.push_back(dof);
      dof = -1;
    }
  });
  condensed_->forget(gone);
  std::vector<Index> mechanism;
  if (condensed_->demote(interior)) return mechanism;
  for (Index v : interior_vertices)
    for (Index t : elements.topology.around(v)) mechanism.push_back(t);
  std::sort(mechanism.begin(), mechanism.end());
  mechanism.erase(std::unique(mechanism.begin(), mechanism.end()), mechanism.end());
  return mechanism;
}

template <class Real>
void PrecomputedRegion<Real>::build(const Elements& elements) {
  std::vector<Index> interface;
  for (Eigen::Index i = 0; i < roles_.size(); ++i)
    if (roles_.data()[i] == Role::interface) interface.push_back(static_cast<Index>(i));
  refuse_large(static_cast<Index>(interface.size()));
  const RegionFactor K(elements, roles_);
  dof_ = K.number;
  scale_ = K.mean_stiffness;
  Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(K.size, amplitudes);
  for (Eigen::Index i = 0; i < dof_.size(); ++i)
    for (int a = 0; a < amplitudes && dof_.data()[i] >= 0; ++a)
      loads(dof_.data()[i], a) = loads_[a].data()[i];
  std::vector<Index> dofs;
  for (Index component : interface) dofs.push_back(dof_.data()[component]);
  condensed_ = cache_.condense(K, loads, dofs, make_factor_);
  most_touched_ = 2 * condensed_->touched() + 600;
}

template <class Real>
void PrecomputedRegion<Real>::prepare_step(const Elements& elements) {
  const Eigen::MatrixXd& S = condensed_->stiffness();
  const auto n = static_cast<Index>(S.rows());
  stiffness_.set(S.rightCols(n));
  given_.resize(std::size_t(n));
  missing_.resize(std::size_t(n));
  for (Index i = 0; i < n; ++i) {
    given_[i] = static_cast<Real>(-S(i, 0));
    missing_[i] = static_cast<Real>(-S(i, 1));
  }
  components_.resize(std::size_t(n));
  for (Eigen::Index i = 0; i < dof_.size(); ++i)
    if (dof_.data()[i] >= 0 && condensed_->column(dof_.data()[i]) >= 0)
      components_[std::size_t(condensed_->column(dof_.data()[i]))] = static_cast<Index>(i);
  shared_.clear();
  for (Index component : components_) {
    const auto around = elements.topology.around(component / 3);
    if (std::any_of(around.begin(), around.end(), [&](Index t) { return !member_[t]; }))
      shared_.push_back(component / 3);
  }
  std::sort(shared_.begin(), shared_.end());
  shared_.erase(std::unique(shared_.begin(), shared_.end()), shared_.end());
}

template class PrecomputedRegion<float>;
template class PrecomputedRegion<double>;

}  // namespace lobe
