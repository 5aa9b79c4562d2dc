#include "lobe/region/stored_terms.h"

#include <algorithm>

namespace lobe {

template <class Terms>
std::size_t TermSet<Terms>::Hash::operator()(const Key& key) const {
  std::uint64_t h = 1469598103934665603ull;
  for (Index v : key) h = (h ^ std::uint64_t(v)) * 1099511628211ull;
  return static_cast<std::size_t>(h ^ (h >> 29));
}

template <class Terms>
void TermSet<Terms>::add(const Key& key, const Terms& terms) {
  const auto [found, is_new] = slot_of_.try_emplace(key, count());
  const Index slot = found->second;
  if (is_new) {
    keys_.push_back(key);
    values_.emplace_back().fill(0.0);
    for (int i = 0; i < n; ++i) outputs_of_.append(key[i], n * slot + i);
  }
  for (int i = 0; i < Terms::size; ++i) values_[slot][i] += terms.values[i];
}

template <class Terms>
void TermSet<Terms>::erase(Index slot) {
  const Index last = count() - 1;
  for (int i = 0; i < n; ++i) outputs_of_.erase_value(keys_[slot][i], n * slot + i);
  slot_of_.erase(keys_[slot]);
  if (slot != last) {
    for (int i = 0; i < n; ++i)
      for (Index& place : outputs_of_[keys_[last][i]])
        if (place == n * last + i) place = n * slot + i;
    keys_[slot] = keys_[last];
    values_[slot] = values_[last];
    slot_of_[keys_[slot]] = slot;
  }
  keys_.pop_back();
  values_.pop_back();
}

template <class Terms>
void TermSet<Terms>::erase_around(Index vertex) {
  while (!outputs_of_[vertex].empty()) erase(outputs_of_[vertex].back() / n);
}

template <class Terms>
void TermSet<Terms>::evaluate(const Mat3X<double>& u, Index slot) {
  const double* c = values_[slot].data();
  std::array<Vec3d, std::size_t(n)> in, out;
  for (int i = 0; i < n; ++i) in[i] = u.col(keys_[slot][i]);
  if constexpr (n == 1) out[0] = vertex_force(c, in[0]);
  if constexpr (n == 2) edge_forces(c, in[0], in[1], out[0], out[1]);
  if constexpr (n == 3) triangle_forces(c, in[0], in[1], in[2], out[0], out[1], out[2]);
  if constexpr (n == 4) tet_term_forces(c, in[0], in[1], in[2], in[3], out[0], out[1], out[2], out[3]);
  for (int i = 0; i < n; ++i) forces_.col(n * slot + i) = out[i];
}

template <class Terms>
void TermSet<Terms>::add_forces(const Mat3X<double>& u, Mat3X<double>& f, Parallel& parallel) {
  if (forces_.cols() < n * count()) forces_.resize(3, n * count());
  parallel.for_ranges(count(), 1024, [&](Index begin, Index end) {
    for (Index slot = begin; slot < end; ++slot) evaluate(u, slot);
  });
  parallel.for_ranges(outputs_of_.vertex_count(), 1024, [&](Index begin, Index end) {
    for (Index v = begin; v < end; ++v)
      for (Index place : outputs_of_[v]) f.col(v) += forces_.col(place);
  });
}

namespace {

// Calls add(corners in ascending order of their vertices) for every subset of n corners with a vertex in
// `fresh`.
template <int n, class Add>
void for_subsets(const Eigen::Vector4i& corners, const std::vector<std::uint8_t>& fresh, Add&& add) {
  std::array<int, 4> order{0, 1, 2, 3};
  std::sort(order.begin(), order.end(), [&](int a, int b) { return corners[a] < corners[b]; });
  for (unsigned mask = 1; mask < 16; ++mask) {
    std::array<int, std::size_t(n)> subset{};
    int size = 0;
    bool is_fresh = false;
    for (int i = 0; i < 4; ++i) {
      if (!(mask >> i & 1u)) continue;
      if (size < n) subset[size] = order[i];
      ++size;
      is_fresh = is_fresh || fresh[corners[order[i]]];
    }
    if (size == n && is_fresh) add(subset);
  }
}

}  // namespace

void StoredTerms::follow(const Elements& elements, const std::vector<Index>& vertices) {
  const Topology& topology = elements.topology;
  const auto for_all_sets = [&](auto&& f) { f(vertices_), f(edges_), f(triangles_), f(tets_); };
  for_all_sets([&](auto& set) { set.add_vertices(topology.vertex_count()); });
  std::vector<std::uint8_t> fresh(std::size_t(topology.vertex_count()), 0);
  std::vector<Index> around;
  for (Index v : vertices) {
    for_all_sets([&](auto& set) { set.erase_around(v); });
    fresh[v] = 1;
    around.insert(around.end(), topology.around(v).begin(), topology.around(v).end());
  }
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  for (Index t : around) {
    if (elements.region_of[t] != RegionModel::nonlinear) continue;
    const Eigen::Vector4i v = topology.corners(t);
    const Shape s = elements.shape_of(t);
    const double l = elements.elastic_of(t).lambda, m = elements.elastic_of(t).mu;
    for_subsets<1>(v, fresh, [&](const auto& i) { vertices_.add({v[i[0]]}, vertex_terms(s, l, m, i[0])); });
    for_subsets<2>(v, fresh, [&](const auto& i) {
      edges_.add({v[i[0]], v[i[1]]}, edge_terms(s, l, m, i[0], i[1]));
    });
    for_subsets<3>(v, fresh, [&](const auto& i) {
      triangles_.add({v[i[0]], v[i[1]], v[i[2]]}, triangle_terms(s, l, m, i[0], i[1], i[2]));
    });
    for_subsets<4>(v, fresh, [&](const auto& i) {
      tets_.add({v[i[0]], v[i[1]], v[i[2]], v[i[3]]}, tet_terms(s, l, m, i[0], i[1], i[2], i[3]));
    });
  }
}

template <class Real>
void StoredTerms::add_forces(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel) {
  u_ = u.template cast<double>();
  f_.setZero(3, u.cols());
  vertices_.add_forces(u_, f_, parallel);
  edges_.add_forces(u_, f_, parallel);
  triangles_.add_forces(u_, f_, parallel);
  tets_.add_forces(u_, f_, parallel);
  f += f_.template cast<Real>();
}

std::size_t StoredTerms::bytes() const {
  const auto of = [](const auto& set, std::size_t values, std::size_t vertices) {
    return std::size_t(set.count()) * (values * sizeof(double) + vertices * sizeof(Index));
  };
  return of(vertices_, VertexTerms::size, 1) + of(edges_, EdgeTerms::size, 2) +
         of(triangles_, TriangleTerms::size, 3) + of(tets_, TetTerms::size, 4);
}

template void StoredTerms::add_forces(const Mat3X<float>&, Mat3X<float>&, Parallel&);
template void StoredTerms::add_forces(const Mat3X<double>&, Mat3X<double>&, Parallel&);

}  // namespace lobe
