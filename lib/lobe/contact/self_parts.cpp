// The parts of the boundary layer whose motion is followed.
#include <algorithm>
#include <numeric>
#include <utility>

#include "lobe/contact/fill_lists.h"
#include "lobe/contact/self_contact.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

constexpr int tets_per_part = 48, most_parts = 256;
// In mean edges: how far the first search goes, and how much nearer pairs may come between two measurements.
constexpr double first_within = 0.7, most_room = 0.5;

}  // namespace

void SelfContact::rebuild(const ContactSurface& surface, const Model& model) {
  forget();
  is_searched_ = false;
  const Elements& elements = model.elements;
  boundary_.rebuild(surface, elements);
  const std::vector<BoundaryLayer::Tet>& layers = boundary_.tets();
  stamp_of_layer_.assign(layers.size(), -1);
  inverses_.assign(layers.size(), {});
  faces_now_.assign(surface.triangles().size(), {});
  known_faces_.assign(surface.triangles().size() * points_per_triangle, {});
  near_ = 0.01 * surface.mean_edge();
  within_ = first_within * surface.mean_edge();
  most_room_ = most_room * surface.mean_edge();
  next_look_room_ = 0.2 * most_room_;
  vertices_.clear();
  for (const BoundaryLayer::Tet& layer : layers)
    vertices_.insert(vertices_.end(), layer.corners.begin(), layer.corners.end());
  sort_unique(vertices_);
  place_of_vertex_.assign(std::size_t(elements.topology.vertex_count()), -1);
  for (std::size_t i = 0; i < vertices_.size(); ++i)
    place_of_vertex_[std::size_t(vertices_[i])] = static_cast<Index>(i);
  divide_into_parts(surface);
  number_places(surface);
  rest_x_.assign(placed_.x.size(), 0);
  for (std::size_t i = 0; i < vertices_.size(); ++i)
    Eigen::Map<Vec3<float>>(rest_x_.data() + 4 * i) =
        (elements.points.col(vertices_[i]) - elements.points.col(vertices_[0])).cast<float>();
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
  const std::vector<BoundaryLayer::Tet>& layers = boundary_.tets();
  std::vector<Vec3d> centres;
  places_of_.clear();
  for (const BoundaryLayer::Tet& layer : layers) {
    centres.emplace_back(layer.rest.rowwise().mean());
    Eigen::Vector4i& places = places_of_.emplace_back();
    for (int c = 0; c < 4; ++c) places[c] = place_of_vertex_[std::size_t(layer.corners[c])];
  }
  part_of_layer_ = divide(centres, std::max(tets_per_part, static_cast<int>(layers.size()) / most_parts));
  const int count = layers.empty() ? 0 : *std::max_element(part_of_layer_.begin(), part_of_layer_.end()) + 1;
  std::vector<std::vector<int>> points(static_cast<std::size_t>(count));
  for (std::size_t l = 0; l < layers.size(); ++l)
    for (int place : places_of_[l]) points[std::size_t(part_of_layer_[l])].push_back(place);
  part_of_triangle_.clear();
  for (const ContactSurface::Triangle& triangle : surface.triangles()) {
    const int part = part_of_layer_[std::size_t(boundary_.number_of(triangle.owner.tet))];
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
  std::vector<int> order(layers.size());
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

}  // namespace lobe
