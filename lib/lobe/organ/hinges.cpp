#include "lobe/organ/hinges.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "lobe/sort_unique.h"

namespace lobe {
namespace {

// Collects held vertices, until the piece cannot turn about them any more.
class HeldPlaces {
 public:
  explicit HeldPlaces(const Model& model) : model_(model) {}

  // Whether the held vertices of this tetrahedron, with those before, fix a piece in all directions.
  bool add(Index tet) {
    for (Index v : model_.elements.topology.corners(tet)) {
      if (!model_.held.anchors(v)) continue;
      const Vec3d X = model_.elements.points.col(v);
      if (count_ == 0)
        first_ = X;
      else if (count_ == 1 && X != first_)
        second_ = X;
      else if (count_ == 1 || !is_off_line(X))
        continue;
      ++count_;
    }
    return count_ >= 3;
  }
  bool any() const { return count_ > 0; }

 private:
  bool is_off_line(const Vec3d& X) const {
    constexpr double rounding = 1e-6;
    const Vec3d a = second_ - first_, b = X - first_;
    return a.cross(b).norm() > rounding * a.norm() * b.norm();
  }

  const Model& model_;
  int count_ = 0;  // not in a line, at most 3
  Vec3d first_ = Vec3d::Zero(), second_ = Vec3d::Zero();
};

bool is_hinged(const Model& model, const std::vector<Index>& piece) {
  HeldPlaces places(model);
  return std::none_of(piece.begin(), piece.end(), [&](Index t) { return places.add(t); }) && places.any();
}

// Returns the tetrahedra of what is left of a body, if held vertices are left but do not fix it.
std::vector<Index> hinged_rest(Model& model, Index next_to_it) {
  HeldPlaces places(model);
  std::vector<Index> piece;
  const bool is_fixed = model.elements.topology.visit_piece(next_to_it, [&](Index t) {
    piece.push_back(t);
    return places.add(t);
  });
  return is_fixed || !places.any() ? std::vector<Index>{} : piece;
}

}  // namespace

std::vector<Index> hinged_tets(Model& model, const MeshEdit& edit) {
  std::vector<Index> found;
  bool may_have_lost_anchors = false;
  const auto is_held = [&](Index t) {
    const Eigen::Vector4i corners = model.elements.topology.corners(t);
    return std::any_of(corners.begin(), corners.end(), [&](Index v) { return model.held.anchors(v); });
  };
  for (const std::vector<Index>& piece : edit.cut_off) {
    if (is_hinged(model, piece)) found.insert(found.end(), piece.begin(), piece.end());
    may_have_lost_anchors = may_have_lost_anchors || std::any_of(piece.begin(), piece.end(), is_held);
  }
  const auto has_lost = [&](Index t) {  // a held vertex of which no tetrahedron is left
    const Eigen::Vector4i corners = model.elements.topology.corners(t);
    return std::any_of(corners.begin(), corners.end(), [&](Index v) {
      return model.held.anchors(v) && model.elements.topology.around(v).empty();
    });
  };
  if (std::any_of(edit.removed.begin(), edit.removed.end(), has_lost)) may_have_lost_anchors = true;
  if (may_have_lost_anchors)
    for (Index next_to_it : edit.next_to_removed) {
      const std::vector<Index> rest = hinged_rest(model, next_to_it);
      found.insert(found.end(), rest.begin(), rest.end());
    }
  sort_unique(found);
  std::erase_if(found, [&](Index t) { return model.elements.region_of[t] != RegionModel::tensor_mass; });
  return found;
}

}  // namespace lobe
