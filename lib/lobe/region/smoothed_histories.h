// Keeps the strains of dashpots of smoothing domains across an edit. An edit may give domains other lanes,
// and other numbers around the copies of vertices: there, a domain has the history of the one that its
// tetrahedra had at the same edge.
#pragma once

#include <unordered_map>
#include <vector>

#include "lobe/region/smoothed_edges.h"
#include "lobe/region/viscosity.h"

namespace lobe {

template <class Real>
class SmoothedHistories {
 public:
  // Before the edit: the domains that these tetrahedra have then.
  void keep_domains(const SmoothedEdges& edges, const std::vector<Index>& tets);
  // Before a patch is written again: the histories of its domains, in the order of lanes.
  void keep(const Viscosity<Real>& viscosity, Index patch, const std::vector<Index>& domains);
  // After the edit: new domains of these tetrahedra have the history of the old domain at the same edge of
  // the tetrahedron, or of the one that it is a copy of.
  void inherit(const SmoothedEdges& edges, const std::vector<Index>& tets, const TetPairs& copied);
  // Gives the domains of a patch what they had, or else zero strains. Returns those that had nothing.
  std::vector<Index> give(Viscosity<Real>& viscosity, Index patch, const std::vector<Index>& domains) const;

 private:
  std::unordered_map<Index, Eigen::Matrix<Index, 6, 1>> domains_;           // of tetrahedra
  std::unordered_map<Index, typename Viscosity<Real>::Strains> histories_;  // of domains
};

extern template class SmoothedHistories<float>;
extern template class SmoothedHistories<double>;

}  // namespace lobe
