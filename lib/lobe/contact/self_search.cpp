// Which triangles of a surface may be in which tetrahedra of its boundary layer.
#include <algorithm>
#include <cmath>
#include <utility>

#include "lobe/contact/self_contact.h"
#include "lobe/cut/distance.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

// Lists of what `visit(add)` gives by add(key, value), in order.
template <class Visit>
void fill_lists(std::size_t keys, std::vector<int>& first, std::vector<int>& values, Visit&& visit) {
  first.assign(keys + 1, 0);
  visit([&](std::size_t key, int) { ++first[key + 1]; });
  for (std::size_t i = 0; i < keys; ++i) first[i + 1] += first[i];
  values.resize(std::size_t(first[keys]));
  std::vector<int> at(first.begin(), first.end() - 1);
  visit([&](std::size_t key, int value) { values[std::size_t(at[key]++)] = value; });
}

}  // namespace

double gap_between(const Mat3<double>& triangle, const Mat34<double>& tet) {
  const auto beyond = [&](const Vec3d& n, const Vec3d& from, const auto& points, double sign) {
    return (sign / n.norm() * n.transpose() * (points.colwise() - from)).minCoeff();
  };
  const Vec3d a = triangle.col(0), normal = (triangle.col(1) - a).cross(triangle.col(2) - a);
  double gap = std::max(beyond(normal, a, tet, 1), beyond(normal, a, tet, -1));
  for (int c = 0; c < 4; ++c) {  // the face opposite to this corner
    const Vec3d x = tet.col((c + 1) % 4);
    const Vec3d n = (tet.col((c + 2) % 4) - x).cross(tet.col((c + 3) % 4) - x);
    gap = std::max(gap, beyond(n, x, triangle, n.dot(tet.col(c) - x) < 0 ? 1 : -1));
  }
  return gap;
}

Mat34<double> SelfContact::corners_of(const Places& now, const Layer& layer) {
  Mat34<double> x;
  for (int c = 0; c < 4; ++c) x.col(c) = now.of_vertex(layer.corners[c]);
  return x;
}

void SelfContact::rebuild(const ContactSurface& surface, const Model& model) {
  forget();
  const Elements& elements = model.elements;
  const auto vertices = std::size_t(elements.topology.vertex_count());
  const auto& triangles = surface.triangles();
  planes_.clear();
  rest_.clear();
  for (const ContactSurface::Triangle& triangle : triangles) {
    Mat3<double> X = Mat3<double>::Zero();
    for (int c = 0; c < 3; ++c) {
      const ContactSurface::Point& point = surface.points()[std::size_t(triangle.points[c])];
      for (int i = 0; i < point.count; ++i)
        X.col(c) += point.weights[i] * elements.points.col(point.corners[i]);
    }
    const Vec3d n = (X.col(1) - X.col(0)).cross(X.col(2) - X.col(0));
    planes_.push_back({n.norm() > 0 ? Vec3d(n.normalized()) : Vec3d::Zero(), X.col(0)});
    rest_.push_back(X);
  }
  fill_lists(surface.points().size(), first_around_, around_, [&](auto&& add) {
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (int p : triangles[t].points) add(std::size_t(p), static_cast<int>(t));
  });
  fill_lists(vertices, first_of_vertex_, of_vertex_, [&](auto&& add) {
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (int p : triangles[t].points) {
        const ContactSurface::Point& point = surface.points()[std::size_t(p)];
        for (int i = 0; i < point.count; ++i) add(std::size_t(point.corners[i]), static_cast<int>(t));
      }
  });
  std::vector<Index> tets;
  for (std::size_t v = 0; v < vertices; ++v)
    if (first_of_vertex_[v + 1] > first_of_vertex_[v])
      for (Index t : elements.topology.around(static_cast<Index>(v))) tets.push_back(t);
  sort_unique(tets);
  layers_.clear();
  faces_.clear();
  for (Index t : tets) {
    layers_.push_back({t, elements.topology.corners(t), elements.corner_points(t)});
    find_faces(layers_.back());
  }
  stamp_of_vertex_.assign(vertices, -1);
  stamp_of_layer_.assign(layers_.size(), -1);
  list_own_layers(surface);
  inverses_.assign(layers_.size(), {});
  vertices_.clear();
  for (const Layer& layer : layers_)
    vertices_.insert(vertices_.end(), layer.corners.begin(), layer.corners.end());
  sort_unique(vertices_);
  near_ = 0.01 * surface.mean_edge();
}

// Of the triangles around its corners, but for those that it is in front of, and those that are farther from
// all of it than another is. The distance to a triangle is a convex function, and no larger in the
// tetrahedron than at one of its corners. The nearest come first.
void SelfContact::find_faces(Layer& layer) {
  std::vector<int> around;
  for (Index v : layer.corners)
    around.insert(around.end(), of_vertex_.begin() + first_of_vertex_[std::size_t(v)],
                  of_vertex_.begin() + first_of_vertex_[std::size_t(v) + 1]);
  sort_unique(around);
  const auto distance = [&](const Vec3d& x, int f) {
    const Mat3<double>& X = rest_[std::size_t(f)];
    return (x - nearest_on_triangle(x, X.col(0), X.col(1), X.col(2))).norm();
  };
  const Vec3d centre = layer.rest.rowwise().mean();
  const double radius = (layer.rest.colwise() - centre).colwise().norm().maxCoeff();
  const auto heights = [&](int f) -> Eigen::RowVector4d {  // over its plane
    const Plane& plane = planes_[std::size_t(f)];
    return plane.normal.transpose() * (layer.rest.colwise() - plane.corner);
  };
  double most = std::numeric_limits<double>::infinity();
  for (int f : around) {
    if (heights(f).maxCoeff() > 1e-9 * radius) continue;  // no face for all of its points
    double farthest = 0;
    for (int c = 0; c < 4; ++c) farthest = std::max(farthest, distance(layer.rest.col(c), f));
    most = std::min(most, farthest);
  }
  layer.first = static_cast<int>(faces_.size());
  for (int f : around)
    if (heights(f).minCoeff() < -1e-9 * radius && distance(centre, f) - radius <= most * (1 + 1e-9))
      faces_.push_back(f);
  layer.count = static_cast<int>(faces_.size()) - layer.first;
  std::sort(faces_.begin() + layer.first, faces_.end(), [&](int a, int b) {
    return std::pair(distance(centre, a), a) < std::pair(distance(centre, b), b);
  });
}

// Each box is in all cells that it meets.
void SelfContact::fill_grid(const Places& now, double margin, double cell) {
  box_low_.clear();
  box_high_.clear();
  Vec3d high = Vec3d::Constant(-std::numeric_limits<double>::infinity());
  low_ = -high;
  for (const Layer& layer : layers_) {
    const Mat34<double> x = corners_of(now, layer);
    box_low_.push_back(x.rowwise().minCoeff().array() - margin);
    box_high_.push_back(x.rowwise().maxCoeff().array() + margin);
    low_ = low_.cwiseMin(box_low_.back());
    high = high.cwiseMax(box_high_.back());
  }
  constexpr double most = 128;  // cells along an axis
  cell_ = std::max(cell, (high - low_).maxCoeff() / most);
  if (!(cell_ > 0) || !std::isfinite(cell_)) cell_ = 1;
  for (int i = 0; i < 3; ++i) count_[i] = std::clamp(int((high[i] - low_[i]) / cell_) + 1, 1, int(most) + 1);
  const auto place = [&](const Vec3d& x, int i) {
    return std::clamp(static_cast<int>((x[i] - low_[i]) / cell_), 0, count_[i] - 1);
  };
  fill_lists(std::size_t(count_.prod()), first_in_, in_cell_, [&](auto&& add) {
    for (std::size_t l = 0; l < layers_.size(); ++l) {
      const Vec3d &a = box_low_[l], &b = box_high_[l];
      for (int z = place(a, 2); z <= place(b, 2); ++z)
        for (int y = place(a, 1); y <= place(b, 1); ++y)
          for (int x = place(a, 0); x <= place(b, 0); ++x)
            add(std::size_t(x + count_[0] * (y + count_[1] * z)), static_cast<int>(l));
    }
  });
}

// The vertices of a triangle and its neighbours.
std::vector<int> SelfContact::vertices_around(const ContactSurface& surface, int triangle) {
  std::vector<int> found;
  for (int around : surface.triangles()[std::size_t(triangle)].points)
    for (int i = first_around_[std::size_t(around)]; i < first_around_[std::size_t(around) + 1]; ++i)
      for (int p : surface.triangles()[std::size_t(around_[std::size_t(i)])].points) {
        const ContactSurface::Point& point = surface.points()[std::size_t(p)];
        for (int c = 0; c < point.count; ++c)
          if (std::exchange(stamp_of_vertex_[std::size_t(point.corners[c])], triangle) != triangle)
            found.push_back(point.corners[c]);
      }
  return found;
}

// Of each triangle: the tetrahedra that have a vertex of those and are on its side of the surface.
void SelfContact::list_own_layers(const ContactSurface& surface) {
  std::vector<int> first_with, with;  // tetrahedra around each vertex
  fill_lists(stamp_of_vertex_.size(), first_with, with, [&](auto&& add) {
    for (std::size_t l = 0; l < layers_.size(); ++l)
      for (int v : layers_[l].corners) add(std::size_t(v), static_cast<int>(l));
  });
  own_.clear();
  first_own_.assign(1, 0);
  const auto count = static_cast<int>(surface.triangles().size());
  for (int t = 0; t < count; ++t) {
    for (int v : vertices_around(surface, t))
      for (int i = first_with[std::size_t(v)]; i < first_with[std::size_t(v) + 1]; ++i) {
        const auto l = std::size_t(with[std::size_t(i)]);
        if (std::exchange(stamp_of_layer_[l], t) != t && is_on_its_side(t, layers_[l]))
          own_.push_back(with[std::size_t(i)]);
      }
    first_own_.push_back(static_cast<int>(own_.size()));
  }
}

bool SelfContact::is_on_its_side(int triangle, const Layer& layer) const {
  const Plane& plane = planes_[std::size_t(triangle)];
  const Vec3d centre = layer.rest.rowwise().mean();
  return plane.normal.dot(centre - plane.corner) < 0.05 * (layer.rest.col(1) - layer.rest.col(0)).norm();
}

// Vertices may move by a margin: whatever is not found is farther away than twice of it.
void SelfContact::search(const ContactSurface& surface, const Places& now, double moved) {
  slack_ = left_ = 0.2 * surface.mean_edge();
  measured_at_ = moved;
  searched_at_.clear();
  for (Index v : vertices_) searched_at_.push_back(now.of_vertex(v));
  find_pairs(surface, now, 2 * slack_);
  take_candidates(surface, moved);
}

bool SelfContact::is_outdated(const Places& now, double moved) {
  if (slack_ < 0) return true;
  if (moved - measured_at_ <= left_) return false;
  left_ = slack_ - moved_since_search(now);
  measured_at_ = moved;
  return left_ < 0.3 * slack_;
}

// By how much the vertices, less their mean motion [m].
double SelfContact::moved_since_search(const Places& now) const {
  Vec3d mean = Vec3d::Zero();
  for (std::size_t i = 0; i < vertices_.size(); ++i) mean += now.of_vertex(vertices_[i]) - searched_at_[i];
  mean /= double(std::max<std::size_t>(1, vertices_.size()));
  double square = 0;
  for (std::size_t i = 0; i < vertices_.size(); ++i)
    square = std::max(square, (now.of_vertex(vertices_[i]) - searched_at_[i] - mean).squaredNorm());
  return std::sqrt(square);
}

void SelfContact::find_pairs(const ContactSurface& surface, const Places& now, double within) {
  found_.clear();
  fill_grid(now, within, 1.5 * surface.mean_edge());
  std::fill(stamp_of_layer_.begin(), stamp_of_layer_.end(), -1);
  const auto count = static_cast<int>(surface.triangles().size());
  for (int t = 0; t < count; ++t) {
    Mat3<double> corners;
    for (int c = 0; c < 3; ++c) corners.col(c) = now.of_point(surface.triangles()[std::size_t(t)].points[c]);
    for (int i = first_own_[std::size_t(t)]; i < first_own_[std::size_t(t) + 1]; ++i)
      stamp_of_layer_[std::size_t(own_[std::size_t(i)])] = t;
    const Vec3d low = corners.rowwise().minCoeff(), high = corners.rowwise().maxCoeff();
    Eigen::Vector3i from, to;
    for (int i = 0; i < 3; ++i) {
      from[i] = std::clamp(static_cast<int>((low[i] - low_[i]) / cell_), 0, count_[i] - 1);
      to[i] = std::clamp(static_cast<int>((high[i] - low_[i]) / cell_), 0, count_[i] - 1);
    }
    for (int k = from[2]; k <= to[2]; ++k)
      for (int j = from[1]; j <= to[1]; ++j)
        for (int i = from[0]; i <= to[0]; ++i) {
          const auto cell = std::size_t(i + count_[0] * (j + count_[1] * k));
          for (int n = first_in_[cell]; n < first_in_[cell + 1]; ++n) {
            const auto l = std::size_t(in_cell_[std::size_t(n)]);
            if (std::exchange(stamp_of_layer_[l], t) == t) continue;
            if ((box_low_[l].array() > high.array()).any() || (box_high_[l].array() < low.array()).any())
              continue;
            const double gap = gap_between(corners, corners_of(now, layers_[l]));
            if (gap <= within) found_.push_back({t, static_cast<int>(l), gap});
          }
        }
  }
  std::sort(found_.begin(), found_.end(), [](const Found& a, const Found& b) {
    return std::pair(a.triangle, a.layer) < std::pair(b.triangle, b.layer);
  });
}

// Triangles of which a point is held are looked at in any case.
void SelfContact::take_candidates(const ContactSurface& surface, double moved) {
  candidates_.clear();
  pairs_.clear();
  auto anchor = memory_.all_anchors().begin();
  bool is_held = false;
  for (const Found& found : found_) {
    if (candidates_.empty() || candidates_.back().triangle != found.triangle) {
      candidates_.push_back({.triangle = found.triangle, .first = static_cast<int>(pairs_.size())});
      candidates_.back().due = std::numeric_limits<double>::infinity();
      const FaceOwner& owner = surface.triangles()[std::size_t(found.triangle)].owner;
      const std::pair own(owner.tet, owner.code);
      while (anchor != memory_.all_anchors().end() && std::pair(anchor->tet, anchor->code) < own) ++anchor;
      is_held = anchor != memory_.all_anchors().end() && std::pair(anchor->tet, anchor->code) == own;
    }
    const double gap = is_held ? 0 : found.gap;
    pairs_.push_back({found.layer, moved + std::max(0.0, gap - near_) / 2});
    Candidate& candidate = candidates_.back();
    ++candidate.count;
    candidate.due = std::min(candidate.due, pairs_.back().due);
  }
  gaps_.resize(pairs_.size());
}

}  // namespace lobe
