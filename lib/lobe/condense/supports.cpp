#include "lobe/condense/supports.h"

#include <algorithm>

#include "lobe/error.h"
#include "lobe/solve/floating.h"

namespace lobe {
namespace {

std::vector<std::vector<Index>> parts_of_region(const Elements& elements) {
  std::vector<std::vector<Index>> parts;
  std::vector<char> found(std::size_t(elements.topology.tet_count()), 0);
  for (Index first = 0; first < elements.topology.tet_count(); ++first) {
    if (found[first] || !elements.is_in(RegionModel::precomputed, first)) continue;
    std::vector<Index>& part = parts.emplace_back(1, first);
    found[first] = 1;
    for (std::size_t at = 0; at < part.size(); ++at)
      elements.topology.for_neighbours(part[at], [&](int, Index other) {
        if (found[other] || !elements.is_in(RegionModel::precomputed, other)) return;
        found[other] = 1;
        part.push_back(other);
      });
  }
  return parts;
}

class Supports {
 public:
  Supports(const Elements& elements, const HeldVertices& held) : elements_(elements) {
    prescribed_.setZero(3, elements.topology.vertex_count());
    for (const HeldVertices::Held& item : held.all())
      if (item.holder == HeldVertices::boundary)
        for (int axis = 0; axis < 3; ++axis) prescribed_(axis, item.vertex) |= item.axes[axis];
  }

  bool hold(const std::vector<Index>& part) const {
    return any_corner(part, [&](Index v) { return prescribed_.col(v).any(); }) &&
           keep_shape(part, [&](Index v, int axis) { return prescribed_(axis, v); });
  }
  // In a frame, a vertex that is held in any component is driven in all.
  bool hold_in_frame(const std::vector<Index>& part) const {
    return keep_shape(part, [&](Index v, int) { return prescribed_.col(v).any(); });
  }

 private:
  template <class Prescribed>
  bool keep_shape(const std::vector<Index>& part, Prescribed&& prescribed) const {
    return shares_a_face(part) ||
           is_held(elements_, part, [&](Index v, int axis) { return prescribed(v, axis) || is_shared(v); });
  }
  template <class Holds>
  bool any_corner(const std::vector<Index>& part, Holds&& holds) const {
    return std::any_of(part.begin(), part.end(), [&](Index t) {
      const Eigen::Vector4i corners = elements_.topology.corners(t);
      return std::any_of(corners.begin(), corners.end(), holds);
    });
  }
  bool shares_a_face(const std::vector<Index>& part) const {
    return std::any_of(part.begin(), part.end(), [&](Index t) {
      bool shares = false;
      elements_.topology.for_neighbours(
          t, [&](int, Index other) { shares = shares || !elements_.is_in(RegionModel::precomputed, other); });
      return shares;
    });
  }
  bool is_shared(Index v) const {
    const auto around = elements_.topology.around(v);
    return std::any_of(around.begin(), around.end(),
                       [&](Index t) { return !elements_.is_in(RegionModel::precomputed, t); });
  }

  const Elements& elements_;
  Eigen::Matrix<bool, 3, Eigen::Dynamic> prescribed_;
};

}  // namespace

std::vector<Index> unsupported_tets(const Elements& elements, const HeldVertices& held) {
  const Supports supports(elements, held);
  const std::vector<std::vector<Index>> parts = parts_of_region(elements);
  const auto largest = std::max_element(parts.begin(), parts.end(),
                                        [](const auto& a, const auto& b) { return a.size() < b.size(); });
  const bool has_frame = elements.precomputed_frame == RegionFrame::corotated;
  std::vector<Index> tets;
  for (auto part = parts.begin(); part != parts.end(); ++part)
    if (has_frame ? part != largest || !supports.hold_in_frame(*part) : !supports.hold(*part))
      tets.insert(tets.end(), part->begin(), part->end());
  return tets;
}

void refuse_unsupported(const Elements& elements, const HeldVertices& held) {
  const std::vector<Index> tets = unsupported_tets(elements, held);
  if (tets.empty()) return;
  const std::string some =
      std::to_string(tets.size()) + " of its tetrahedra, among them " + std::to_string(tets[0]);
  if (elements.precomputed_frame == RegionFrame::corotated)
    throw InputError("precomputed region",
                     some +
                         ", are outside of the largest part, which is the one that its frame follows, or "
                         "share too few vertices with other regions: three that are not in line are "
                         "needed; make them tensor-mass or nonlinear");
  throw InputError("precomputed region",
                   some +
                       ", are in parts without enough fixed vertices; a linear part that turns grows, so "
                       "fix some of their vertices, let one part have \"frame\": \"corotated\", or make "
                       "them tensor-mass or nonlinear");
}

}  // namespace lobe
