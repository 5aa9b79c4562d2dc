#include "lobe/region/smoothed_histories.h"

namespace lobe {

template <class Real>
void SmoothedHistories<Real>::keep_domains(const SmoothedEdges& edges, const std::vector<Index>& tets) {
  for (Index t : tets) domains_[t] = edges.of(t);
}

template <class Real>
void SmoothedHistories<Real>::keep(const Viscosity<Real>& viscosity, Index p,
                                   const std::vector<Index>& domains) {
  if (!viscosity.has(p)) return;
  for (std::size_t i = 0; i < domains.size(); ++i)
    histories_[domains[i]] = viscosity.strains(p, static_cast<Index>(i));
}

template <class Real>
void SmoothedHistories<Real>::inherit(const SmoothedEdges& edges, const std::vector<Index>& tets,
                                      const TetPairs& copied) {
  std::unordered_map<Index, Index> source;
  for (const auto& [tet, copy] : copied) source[copy] = tet;
  for (Index t : tets) {
    const auto copy = source.find(t);
    const auto former = domains_.find(copy == source.end() ? t : copy->second);
    if (former == domains_.end()) continue;
    const Eigen::Matrix<Index, 6, 1> now = edges.of(t);
    for (int e = 0; e < 6; ++e)
      if (const auto known = histories_.find(former->second[e]); now[e] >= 0 && known != histories_.end())
        histories_.try_emplace(now[e], typename Viscosity<Real>::Strains(known->second));
  }
}

template <class Real>
std::vector<Index> SmoothedHistories<Real>::give(Viscosity<Real>& viscosity, Index p,
                                                 const std::vector<Index>& domains) const {
  const typename Viscosity<Real>::Strains no_strains{};
  std::vector<Index> without;
  for (std::size_t i = 0; i < domains.size(); ++i) {
    const auto known = histories_.find(domains[i]);
    const bool has_history = known != histories_.end();
    viscosity.set(p, static_cast<Index>(i), has_history ? known->second : no_strains);
    if (!has_history) without.push_back(domains[i]);
  }
  return without;
}

template class SmoothedHistories<float>;
template class SmoothedHistories<double>;

}  // namespace lobe
