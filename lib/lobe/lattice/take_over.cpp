#include "lobe/lattice/take_over.h"

#include <array>
#include <map>

namespace lobe {
namespace {

// The residual of nodes that are settled, squared and relative.
template <class Real>
constexpr double settled = std::is_same_v<Real, float> ? 1e-10 : 1e-24;

}  // namespace

template <class Real>
void add_nodes(const Lattice& lattice, const std::vector<double>& node_mass, const Nodes<Real>& nodes,
               const std::vector<std::uint8_t>* which, MovingMasses& sum) {
  for (std::size_t n = 0; n < node_mass.size(); ++n) {
    if (node_mass[n] == 0 || (which && !(*which)[n])) continue;
    const auto column = Eigen::Index(n);
    sum.add(node_mass[n], lattice.nodes.col(column) + nodes.u.col(column).template cast<double>(),
            nodes.v.col(column).template cast<double>());
  }
}

template <class Real>
Nodes<Real> values_of(const Lattice& fresh, const Lattice& former, const Nodes<Real>& nodes) {
  using Corner = std::array<int, 3>;
  const auto at = [](const Eigen::Vector3i& corner) { return Corner{corner[0], corner[1], corner[2]}; };
  std::map<Corner, Index> node_at;
  for (Index n = 0; n < former.node_count(); ++n)
    node_at.emplace(at(former.corner_of_node[std::size_t(n)]), n);
  Nodes<Real> values;
  values.u.setZero(3, fresh.node_count());
  values.v.setZero(3, fresh.node_count());
  for (Index n = 0; n < fresh.node_count(); ++n) {
    const auto found = node_at.find(at(fresh.corner_of_node[std::size_t(n)]));
    if (found == node_at.end()) continue;
    values.u.col(n) = nodes.u.col(found->second);
    values.v.col(n) = nodes.v.col(found->second);
  }
  return values;
}

template <class Real>
TakeOver<Real>::TakeOver(const Elements& elements, const Lattice& lattice,
                         const std::vector<LatticeCell>& whole, const Embedding& former, const Embedding& now,
                         bool is_anew)
    : elements_(elements), lattice_(lattice), whole_(whole), former_(former), now_(now), is_anew_(is_anew) {}

// visit(node, weight)
template <class Real>
template <class Visit>
void TakeOver<Real>::for_nodes(Index vertex, Visit&& visit) const {
  const CellWeights w = lattice_.weights(vertex, elements_.points.col(vertex));
  const auto& nodes = lattice_.parts[std::size_t(lattice_.part_of_vertex[std::size_t(vertex)])].nodes;
  for (int n = 0; n < 8; ++n) visit(nodes[std::size_t(n)], w[n]);
}

// Of vertices that were not embedded before.
template <class Real>
std::vector<std::uint8_t> TakeOver<Real>::touched_nodes() const {
  Flags touched(std::size_t(lattice_.node_count()), 0);
  for (Index v : now_.vertices)
    if (is_anew_ || !former_.embeds(v)) for_nodes(v, [&](Index n, double) { touched[std::size_t(n)] = 1; });
  return touched;
}

// Also of vertices that are embedded no more: all these may change their velocity for the momentum's sake.
template <class Real>
std::vector<std::uint8_t> TakeOver<Real>::changed_nodes() const {
  Flags changed = touched_nodes();
  for (Index v : former_.vertices)
    if (lattice_.part_of_vertex[std::size_t(v)] >= 0 && !now_.embeds(v))
      for_nodes(v, [&](Index n, double) { changed[std::size_t(n)] = 1; });
  return changed;
}

// The mean of their vertices, to begin with.
template <class Real>
void TakeOver<Real>::begin_fresh_nodes(const Flags& fresh, const Mat3X<double>& u, Mat3X<double>& q) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(q.cols());
  for (Index n = 0; n < lattice_.node_count(); ++n)
    if (fresh[std::size_t(n)]) q.col(n).setZero();
  for (Index v : now_.vertices)
    for_nodes(v, [&](Index n, double w) {
      if (!fresh[std::size_t(n)]) return;
      q.col(n) += std::abs(w) * u.col(v);
      sum[n] += std::abs(w);
    });
  for (Index n = 0; n < lattice_.node_count(); ++n)
    if (fresh[std::size_t(n)] && sum[n] > 0) q.col(n) /= sum[n];
}

template <class Real>
void TakeOver<Real>::settle_nodes(const std::vector<double>& mass, double omega, Motion<Real>& motion) const {
  const Flags touched = touched_nodes();
  Flags fresh = touched;  // nothing moved these
  for (std::size_t n = 0; n < fresh.size(); ++n)
    fresh[n] = fresh[n] && (is_anew_ ? motion.nodes.u.col(Eigen::Index(n)).isZero(0)
                                     : former_.mass.empty() || former_.mass[n] == 0);
  const auto take = [&](const auto& of_vertices, Mat3X<Real>& of_nodes) {
    const Mat3X<double> u = of_vertices.view().template cast<double>();
    Mat3X<double> q = of_nodes.template cast<double>();
    begin_fresh_nodes(fresh, u, q);
    settle(elements_, lattice_, now_, whole_, mass, omega, touched, u, settled<Real>, q);
    of_nodes = q.template cast<Real>();
  };
  take(motion.u, motion.nodes.u);
  take(motion.v, motion.nodes.v);
}

template <class Real>
void TakeOver<Real>::keep_momentum(const Model& model, const std::vector<double>& mass,
                                   const MovingMasses& before, MovingMasses after,
                                   Motion<Real>& motion) const {
  MovingMasses free_to_change;
  std::vector<Index> freed;
  const auto place = [&](Index v) -> Vec3d {
    return elements_.points.col(v) + motion.u.col(v).template cast<double>();
  };
  for (Index v : former_.vertices) {
    if (now_.embeds(v)) continue;
    const double m = mass[std::size_t(v)];
    const Vec3d velocity = motion.v.col(v).template cast<double>();
    after.add(m, place(v), velocity);
    if (model.held.holds(v) || m == 0) continue;
    freed.push_back(v);
    free_to_change.add(m, place(v), velocity);
  }
  add_nodes(lattice_, now_.mass, motion.nodes, nullptr, after);
  const Flags changed = changed_nodes();
  add_nodes(lattice_, now_.mass, motion.nodes, &changed, free_to_change);
  const MovingMasses::Motion change = free_to_change.moved_by(before.momentum() - after.momentum());
  for (Index v : freed) motion.v.col(v) += change(place(v)).template cast<Real>();
  for (Index n = 0; n < lattice_.node_count(); ++n)
    if (changed[std::size_t(n)])
      motion.nodes.v.col(n) +=
          change(lattice_.nodes.col(n) + motion.nodes.u.col(n).template cast<double>()).template cast<Real>();
}

template void add_nodes(const Lattice&, const std::vector<double>&, const Nodes<float>&,
                        const std::vector<std::uint8_t>*, MovingMasses&);
template void add_nodes(const Lattice&, const std::vector<double>&, const Nodes<double>&,
                        const std::vector<std::uint8_t>*, MovingMasses&);
template Nodes<float> values_of(const Lattice&, const Lattice&, const Nodes<float>&);
template Nodes<double> values_of(const Lattice&, const Lattice&, const Nodes<double>&);
template class TakeOver<float>;
template class TakeOver<double>;

}  // namespace lobe
