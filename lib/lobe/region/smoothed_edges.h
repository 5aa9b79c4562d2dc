// The smoothing domains (fem/smoothed_edge.h) of a body whose mesh is being cut: one for each edge, material
// and model of the tetrahedra whose element is edge-smoothed. Averages cross neither materials nor models.
// Domains come and go with their tetrahedra; the numbers of those that have gone are used again.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lobe/fem/smoothed_edge.h"
#include "lobe/mesh/vertex_lists.h"

namespace lobe {

class SmoothedEdges {
 public:
  SmoothedEdges() = default;
  // Makes the domains of all tetrahedra that are alive, or of those of one model.
  explicit SmoothedEdges(const Elements& elements, std::optional<RegionModel> only = {});

  // Follows tetrahedra that left, then those that entered, as in RegionEdit; if a model is given, only its
  // own enter. Returns the domains that are new, have changed or are gone, and adds them to `before` as
  // they were. O(tetrahedra around them).
  std::vector<Index> follow(const Elements& elements, const std::vector<Index>& leave,
                            const std::vector<Index>& enter, std::optional<RegionModel> only = {},
                            std::vector<SmoothedEdge>* before = nullptr);

  // Their count; numbers not in use are included: their domains have no volume.
  Index count() const { return static_cast<Index>(edges_.size()); }
  bool any() const { return edges_.size() > unused_.size(); }
  Eigen::Matrix<Index, 6, 1> of(Index tet) const {  // domains of a tetrahedron; −1 if it takes no part
    if (tet >= of_.cols()) return Eigen::Matrix<Index, 6, 1>::Constant(-1);
    return of_.col(tet);
  }
  std::span<const Index> tets_of(Index edge) const { return tets_of_[edge]; }
  const SmoothedEdge& operator[](Index edge) const { return edges_[std::size_t(edge)]; }

 private:
  Index edge_at(Index a, Index b, std::uint16_t material, RegionModel model);
  void drop(Index edge);

  std::vector<SmoothedEdge> edges_;
  VertexLists<Index> tets_of_;                  // tetrahedra of each domain
  VertexLists<Index> edges_at_;                 // domains of which a vertex is the lower end
  Eigen::Matrix<Index, 6, Eigen::Dynamic> of_;  // domains of each tetrahedron; −1 if it takes no part
  std::vector<Index> unused_;
};

}  // namespace lobe
