#include "lobe/condense/anchors.h"

#include <algorithm>

#include "lobe/error.h"
#include "lobe/solve/floating.h"

namespace lobe {
namespace {

bool is_member(const Elements& elements, Index tet) {
  return elements.topology.alive(tet) && elements.region_of[tet] == RegionModel::precomputed;
}

std::vector<std::vector<Index>> parts_of_region(const Elements& elements) {
  std::vector<std::vector<Index>> parts;
  std::vector<char> found(std::size_t(elements.topology.tet_count()), 0);
  for (Index first = 0; first < elements.topology.tet_count(); ++first) {
    if (found[first] || !is_member(elements, first)) continue;
    std::vector<Index>& part = parts.emplace_back(1, first);
    found[first] = 1;
    for (std::size_t at = 0; at < part.size(); ++at)
      for (int face = 0; face < 4; ++face) {
        const Index other = elements.topology.neighbour(part[at], face);
        if (other < 0 || found[other] || !is_member(elements, other)) continue;
        found[other] = 1;
        part.push_back(other);
      }
  }
  return parts;
}

class Anchors {
 public:
  Anchors(const Elements& elements, const HeldVertices& held) : elements_(elements) {
    given_.setZero(3, elements.topology.vertex_count());
    for (const HeldVertices::Held& item : held.all())
      if (item.holder == HeldVertices::boundary)
        for (int axis = 0; axis < 3; ++axis) given_(axis, item.vertex) |= item.axes[axis];
  }

  bool hold(const std::vector<Index>& part) const {
    const bool held = any_corner(part, [&](Index v) { return given_.col(v).any(); });
    return held && (shares_a_face(part) || is_held(elements_, part, [&](Index v, int axis) {
                      return given_(axis, v) || is_shared(v);
                    }));
  }

 private:
  template <class Holds>
  bool any_corner(const std::vector<Index>& part, Holds&& holds) const {
    return std::any_of(part.begin(), part.end(), [&](Index t) {
      const Eigen::Vector4i corners = elements_.topology.corners(t);
      return std::any_of(corners.begin(), corners.end(), holds);
    });
  }
  bool shares_a_face(const std::vector<Index>& part) const {
    return std::any_of(part.begin(), part.end(), [&](Index t) {
      for (int face = 0; face < 4; ++face) {
        const Index other = elements_.topology.neighbour(t, face);
        if (other >= 0 && !is_member(elements_, other)) return true;
      }
      return false;
    });
  }
  bool is_shared(Index v) const {
    const auto around = elements_.topology.around(v);
    return std::any_of(around.begin(), around.end(), [&](Index t) { return !is_member(elements_, t); });
  }

  const Elements& elements_;
  Eigen::Matrix<bool, 3, Eigen::Dynamic> given_;
};

}  // namespace

std::vector<Index> unanchored_tets(const Elements& elements, const HeldVertices& held) {
  const Anchors anchors(elements, held);
  std::vector<Index> tets;
  for (const std::vector<Index>& part : parts_of_region(elements))
    if (!anchors.hold(part)) tets.insert(tets.end(), part.begin(), part.end());
  return tets;
}

void refuse_unanchored(const Elements& elements, const HeldVertices& held) {
  const std::vector<Index> tets = unanchored_tets(elements, held);
  if (tets.empty()) return;
  throw InputError(
      "precomputed region",
      std::to_string(tets.size()) + " of its tetrahedra, among them " + std::to_string(tets[0]) +
          ", are in parts without enough fixed vertices of their own, and a linear part that turned "
          "would grow; fix some of their vertices, or make them tensor-mass or nonlinear");
}

}  // namespace lobe
