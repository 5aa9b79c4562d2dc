#include "lobe/contact/self_rest.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "lobe/contact/fill_lists.h"
#include "lobe/contact/part_motion.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

constexpr int tets_per_part = 48, most_parts = 256;
constexpr double always_near = 0.01;  // in mean edges
constexpr double larger = 1.2;        // edges of one body than those of another
constexpr double least_share = 0.1;   // of the mean edge that a reach has: ten times what is always near

}  // namespace

void SelfRest::rebuild(const ContactSurface& surface, const Elements& elements) {
  boundary.rebuild(surface, elements);
  mean_edge = surface.mean_edge();
  near = always_near * mean_edge;
  choose_divisions(surface, elements.bodies);
  choose_reaches(surface);
  take_points(surface, elements);
  divide_into_parts(surface);
}

// Points are half of the other body's edge apart, which is what that can follow.
void SelfRest::choose_divisions(const ContactSurface& surface, const MeshBodies& bodies) {
  bodies_ = int(bodies.count());
  several_bodies_ = bodies_ > 1;
  divisions_.assign(std::size_t(bodies_ * bodies_), self_divisions);
  edge_ratios_.assign(divisions_.size(), 1);
  body_of.clear();
  for (const BoundaryLayer::Tet& own : boundary.tets())
    body_of.push_back(std::uint8_t(bodies.body_of(own.tet)));
  for (int own = 0; own < bodies_; ++own)
    for (int other = 0; other < bodies_; ++other) {
      const double edge = surface.mean_edge_of(own), partner = surface.mean_edge_of(other);
      if (!(edge > 0 && partner > 0)) continue;  // nothing is left of one of them
      edge_ratios_[std::size_t(own * bodies_ + other)] = std::max(edge, partner) / mean_edge;
      if (own == other) continue;
      divisions_[std::size_t(own * bodies_ + other)] =
          edge > larger * partner ? 0 : std::clamp(int(std::ceil(2 * edge / partner)), 1, self_divisions);
    }
}

// A thin duct beside a coarse organ would have far too many pairs within the mean edge of both.
void SelfRest::choose_reaches(const ContactSurface& surface) {
  reaches_.assign(divisions_.size(), mean_edge);
  least_reach_ = mean_edge;
  for (int own = 0; own < bodies_; ++own)
    for (int other = 0; other < bodies_; ++other) {
      const double edge = surface.mean_edge_of(own), partner = surface.mean_edge_of(other);
      if (!(edge > 0 && partner > 0)) continue;
      double& reach = reaches_[std::size_t(own * bodies_ + other)];
      reach = std::clamp((edge + partner) / 2, least_share * mean_edge, mean_edge);
      least_reach_ = std::min(least_reach_, reach);
    }
}

void SelfRest::take_points(const ContactSurface& surface, const Elements& elements) {
  points = {};
  for (const BoundaryLayer::Tet& own : boundary.tets())
    points.vertices.insert(points.vertices.end(), own.corners.begin(), own.corners.end());
  sort_unique(points.vertices);
  std::vector<int> place_of_vertex(std::size_t(elements.topology.vertex_count()), -1);
  for (std::size_t i = 0; i < points.vertices.size(); ++i)
    place_of_vertex[std::size_t(points.vertices[i])] = static_cast<int>(i);
  const auto places = [&](const Eigen::Vector4i& corners) -> Eigen::Vector4i {
    return corners.unaryExpr([&](int corner) { return place_of_vertex[std::size_t(corner)]; });
  };
  places_of.clear();
  for (const BoundaryLayer::Tet& own : boundary.tets()) places_of.push_back(places(own.corners));
  place_of_point.clear();
  for (const ContactSurface::Point& point : surface.points()) {
    if (point.count == 1) {
      place_of_point.push_back(place_of_vertex[std::size_t(point.corners[0])]);
      continue;
    }
    place_of_point.push_back(points.count());
    points.between.push_back({places(point.corners), point.weights});
  }
  points.fit();
  for (std::size_t i = 0; i < points.vertices.size(); ++i)
    Eigen::Map<Vec3<float>>(points.x.data() + 4 * i) =
        (elements.points.col(points.vertices[i]) - elements.points.col(points.vertices[0])).cast<float>();
  points.find_between();
}

// Parts of one body each, since the motion of a part is fitted as a whole.
void SelfRest::find_parts_of_layers(const std::vector<Vec3d>& centres) {
  const int most = std::max(tets_per_part, static_cast<int>(centres.size()) / most_parts);
  part_of_layer.assign(centres.size(), 0);
  body_of_part.clear();
  std::vector<Vec3d> of_body;
  for (int body = 0; body < bodies_; ++body) {
    const auto is_of_body = [&](std::size_t layer) { return !several_bodies_ || body_of[layer] == body; };
    of_body.clear();
    for (std::size_t l = 0; l < centres.size(); ++l)
      if (is_of_body(l)) of_body.push_back(centres[l]);
    const std::vector<int> parts_of_body = divide(of_body, most);
    const auto first = static_cast<int>(body_of_part.size());
    auto next = parts_of_body.begin();
    for (std::size_t l = 0; l < centres.size(); ++l)
      if (is_of_body(l)) part_of_layer[l] = first + *next++;
    if (!of_body.empty())
      body_of_part.resize(
          std::size_t(first + *std::max_element(parts_of_body.begin(), parts_of_body.end()) + 1),
          std::uint8_t(body));
  }
}

void SelfRest::divide_into_parts(const ContactSurface& surface) {
  const std::vector<BoundaryLayer::Tet>& layers = boundary.tets();
  std::vector<Vec3d> centres;
  for (const BoundaryLayer::Tet& own : layers) centres.emplace_back(own.rest.rowwise().mean());
  find_parts_of_layers(centres);
  parts.assign(body_of_part.size(), {});
  for (std::size_t l = 0; l < layers.size(); ++l)
    for (int place : places_of[l]) parts[std::size_t(part_of_layer[l])].push_back(place);
  part_of_triangle.clear();
  for (const ContactSurface::Triangle& triangle : surface.triangles()) {
    const int part = part_of_layer[std::size_t(boundary.number_of(triangle.owner.tet))];
    part_of_triangle.push_back(part);
    std::vector<int>& own = parts[std::size_t(part)];
    for (int p : triangle.points) {
      const int place = place_of_point[std::size_t(p)] - static_cast<int>(points.vertices.size());
      if (place < 0)
        own.push_back(place_of_point[std::size_t(p)]);
      else
        own.insert(own.end(), points.between[std::size_t(place)].of.begin(),
                   points.between[std::size_t(place)].of.end());
    }
  }
  for (std::vector<int>& own : parts) sort_unique(own);
  divide_into_fours(centres);
}

void SelfRest::divide_into_fours(const std::vector<Vec3d>& centres) {
  const std::vector<int> four_of = divide(centres, 4);
  std::vector<int> order(centres.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return std::pair(four_of[std::size_t(a)], a) < std::pair(four_of[std::size_t(b)], b);
  });
  std::vector<int> first_of_part, of_part;  // layers
  fill_lists(parts.size(), first_of_part, of_part, [&](auto&& add) {
    for (int l : order) add(std::size_t(part_of_layer[std::size_t(l)]), l);
  });
  first_four.assign(1, 0);
  fours.clear();
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const int first = first_of_part[part], end = first_of_part[part + 1];
    for (int i = first; i < end; i += 4) {
      Four& four = fours.emplace_back(Four::Constant(-1));
      for (int k = 0; k < 4 && i + k < end; ++k) four[k] = of_part[std::size_t(i + k)];
    }
    first_four.push_back(static_cast<int>(fours.size()));
  }
}

}  // namespace lobe
