// A body at rest, for its contact with itself: the triangles of its surface, the boundary layer of tetrahedra
// behind them, and the parts of that layer whose motion is followed.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "lobe/contact/self_contact.h"
#include "lobe/cut/distance.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

constexpr int tets_per_part = 48, most_parts = 256;
// In mean edges: how far the first search goes, and how much nearer pairs may come between two measurements.
constexpr double first_within = 0.7, most_room = 0.5;

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

void SelfContact::place_at_rest(const ContactSurface& surface, const Elements& elements) {
  planes_.clear();
  rest_.clear();
  balls_.clear();
  for (const ContactSurface::Triangle& triangle : surface.triangles()) {
    Mat3<double> X = Mat3<double>::Zero();
    for (int c = 0; c < 3; ++c) {
      const ContactSurface::Point& point = surface.points()[std::size_t(triangle.points[c])];
      for (int i = 0; i < point.count; ++i)
        X.col(c) += point.weights[i] * elements.points.col(point.corners[i]);
    }
    const Vec3d n = (X.col(1) - X.col(0)).cross(X.col(2) - X.col(0));
    planes_.push_back({n.norm() > 0 ? Vec3d(n.normalized()) : Vec3d::Zero(), X.col(0)});
    rest_.push_back(X);
    const Vec3d centre = X.rowwise().mean();
    balls_.push_back({centre, (X.colwise() - centre).colwise().norm().maxCoeff()});
  }
}

void SelfContact::rebuild(const ContactSurface& surface, const Model& model) {
  forget();
  is_searched_ = false;
  const Elements& elements = model.elements;
  const auto vertices = std::size_t(elements.topology.vertex_count());
  const auto& triangles = surface.triangles();
  place_at_rest(surface, elements);
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
  find_lips(surface, elements);
  stamp_of_vertex_.assign(vertices, -1);
  stamp_of_layer_.assign(layers_.size(), -1);
  list_own_layers(surface);
  inverses_.assign(layers_.size(), {});
  faces_now_.assign(triangles.size(), {});
  nearest_.assign(triangles.size() * points_per_triangle, {});
  near_ = 0.01 * surface.mean_edge();
  within_ = first_within * surface.mean_edge();
  most_room_ = most_room * surface.mean_edge();
  next_look_room_ = 0.2 * most_room_;
  vertices_.clear();
  for (const Layer& layer : layers_)
    vertices_.insert(vertices_.end(), layer.corners.begin(), layer.corners.end());
  sort_unique(vertices_);
  divide_into_parts(surface);
  number_places(surface);
  rest_x_.assign(placed_.x.size(), 0);
  for (std::size_t i = 0; i < vertices_.size(); ++i)
    Eigen::Map<Vec3<float>>(rest_x_.data() + 4 * i) =
        (elements.points.col(vertices_[i]) - elements.points.col(vertices_[0])).cast<float>();
}

// Of the layer that a tetrahedron is; it has a corner on the boundary.
int SelfContact::layer_of(Index tet) const {
  return static_cast<int>(
      std::lower_bound(layers_.begin(), layers_.end(), tet,
                       [](const Layer& layer, Index number) { return layer.tet < number; }) -
      layers_.begin());
}

void SelfContact::find_lips(const ContactSurface& surface, const Elements& elements) {
  const auto& triangles = surface.triangles();
  std::vector<int> first;
  fill_lists(layers_.size(), first, lips_, [&](auto&& add) {
    for (std::size_t t = 0; t < triangles.size(); ++t)
      if (const Index tet = triangles[t].owner.tet; triangles[t].is_cut && elements.share_of(tet) < 1)
        add(std::size_t(layer_of(tet)), static_cast<int>(t));
  });
  for (std::size_t l = 0; l < layers_.size(); ++l) {
    layers_[l].first_lip = first[l];
    layers_[l].lips = first[l + 1] - first[l];
  }
}

void SelfContact::number_places(const ContactSurface& surface) {
  placed_.vertices = vertices_;
  placed_.between.clear();
  place_of_point_.clear();
  for (const ContactSurface::Point& point : surface.points()) {
    const auto place = [&](int corner) { return place_of_vertex_[std::size_t(point.corners[corner])]; };
    if (point.count == 1) {
      place_of_point_.push_back(place(0));
      continue;
    }
    place_of_point_.push_back(static_cast<int>(vertices_.size() + placed_.between.size()));
    placed_.between.push_back({{place(0), place(1), place(2), place(3)}, point.weights});
  }
  placed_.fit();
  watched_place_of_.assign(vertices_.size() + placed_.between.size(), -1);
}

void SelfContact::divide_into_parts(const ContactSurface& surface) {
  place_of_vertex_.assign(stamp_of_vertex_.size(), -1);
  for (std::size_t i = 0; i < vertices_.size(); ++i)
    place_of_vertex_[std::size_t(vertices_[i])] = static_cast<Index>(i);
  std::vector<Vec3d> centres;
  places_of_.clear();
  for (const Layer& layer : layers_) {
    centres.emplace_back(layer.rest.rowwise().mean());
    Eigen::Vector4i& places = places_of_.emplace_back();
    for (int c = 0; c < 4; ++c) places[c] = place_of_vertex_[std::size_t(layer.corners[c])];
  }
  part_of_layer_ = divide(centres, std::max(tets_per_part, static_cast<int>(layers_.size()) / most_parts));
  const int count = layers_.empty() ? 0 : *std::max_element(part_of_layer_.begin(), part_of_layer_.end()) + 1;
  std::vector<std::vector<int>> points(static_cast<std::size_t>(count));
  for (std::size_t l = 0; l < layers_.size(); ++l)
    for (int place : places_of_[l]) points[std::size_t(part_of_layer_[l])].push_back(place);
  part_of_triangle_.clear();
  for (const ContactSurface::Triangle& triangle : surface.triangles()) {
    const int part = part_of_layer_[std::size_t(layer_of(triangle.owner.tet))];
    part_of_triangle_.push_back(part);
    for (int p : triangle.points) {
      const ContactSurface::Point& point = surface.points()[std::size_t(p)];
      for (int i = 0; i < point.count; ++i)
        points[std::size_t(part)].push_back(place_of_vertex_[std::size_t(point.corners[i])]);
    }
  }
  for (std::vector<int>& own : points) sort_unique(own);
  parts_.set_parts(points);
  // Of each part those that are near each other are in fours, which have parts of their own.
  const std::vector<int> four_of = divide(centres, 4);
  std::vector<int> order(layers_.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return std::pair(four_of[std::size_t(a)], a) < std::pair(four_of[std::size_t(b)], b);
  });
  fill_lists(std::size_t(count), first_of_part_, of_part_, [&](auto&& add) {
    for (int l : order) add(std::size_t(part_of_layer_[std::size_t(l)]), l);
  });
  first_four_.assign(1, 0);
  fours_.clear();
  for (int part = 0; part < count; ++part) {
    const int first = first_of_part_[std::size_t(part)], end = first_of_part_[std::size_t(part) + 1];
    for (int i = first; i < end; i += 4) {
      Four& four = fours_.emplace_back();
      for (int k = 0; k < 4; ++k) four.layers[k] = i + k < end ? of_part_[std::size_t(i + k)] : -1;
    }
    first_four_.push_back(static_cast<int>(fours_.size()));
  }
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
        if (std::exchange(stamp_of_layer_[l], t) != t && is_on_its_side(surface, t, layers_[l]))
          own_.push_back(with[std::size_t(i)]);
      }
    first_own_.push_back(static_cast<int>(own_.size()));
  }
}

// Nearly: of one that is filled in part, a place behind its cut faces.
Vec3d SelfContact::middle_of_filled(const Layer& layer) const {
  if (layer.lips == 0) return layer.rest.rowwise().mean();
  const double behind = 0.2 * (layer.rest.col(1) - layer.rest.col(0)).norm();
  Vec3d sum = Vec3d::Zero();
  for (int i = layer.first_lip; i < layer.first_lip + layer.lips; ++i) {
    const auto f = std::size_t(lips_[std::size_t(i)]);
    sum += balls_[f].centre - behind * planes_[f].normal;
  }
  return sum / layer.lips;
}

bool SelfContact::is_on_its_side(const ContactSurface& surface, int triangle, const Layer& layer) const {
  if (surface.triangles()[std::size_t(triangle)].owner.tet == layer.tet) return true;
  const Plane& plane = planes_[std::size_t(triangle)];
  return plane.normal.dot(middle_of_filled(layer) - plane.corner) <
         0.05 * (layer.rest.col(1) - layer.rest.col(0)).norm();
}

}  // namespace lobe
