// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/diagnose.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <sstream>

#include "lobe_mesh/clean.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {
namespace {

constexpr std::size_t places_kept = 3;

std::string position(const Vec3d& p) {
  std::ostringstream text;
  text << "(" << p.x() << ", " << p.y() << ", " << p.z() << ")";
  return text.str();
}

void add(Finding& finding, const std::string& place) {
  ++finding.count;
  if (finding.places.size() < places_kept) finding.places.push_back(place);
}

// The triangles at one edge and in which direction each runs along it.
struct EdgeUse {
  std::vector<Index> triangles;
  Index forward = 0;
};
using Edges = std::map<std::pair<Index, Index>, EdgeUse>;

Edges collect_edges(const Surface& surface) {
  Edges edges;
  for (Index t = 0; t < surface.triangle_count(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const Index a = surface.triangles(k, t), b = surface.triangles((k + 1) % 3, t);
      if (a == b) continue;
      EdgeUse& use = edges[std::minmax(a, b)];
      use.triangles.push_back(t);
      use.forward += a < b;
    }
  }
  return edges;
}

void check_points(const Surface& surface, Diagnosis& d) {
  std::vector<bool> used(surface.point_count(), false);
  for (const Index v : surface.triangles.reshaped()) used[v] = true;
  const std::vector<Index> first = first_of_equal_points(surface.points);
  for (Index i = 0; i < surface.point_count(); ++i) {
    const std::string name = "vertex " + std::to_string(i);
    if (!usable(surface.points.col(i))) add(d.not_finite, name + " at " + position(surface.points.col(i)));
    if (!used[i])
      ++d.unused_points;
    else if (first[i] != i)
      add(d.duplicate_points, name + " = vertex " + std::to_string(first[i]));
  }
}

void check_triangles(const Surface& surface, Diagnosis& d) {
  std::set<std::array<Index, 3>> seen;
  for (Index t = 0; t < surface.triangle_count(); ++t) {
    const auto corner = [&](int k) -> Vec3d { return surface.points.col(surface.triangles(k, t)); };
    const double twice_area = (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
    const double longest =
        std::max({(corner(1) - corner(0)).squaredNorm(), (corner(2) - corner(1)).squaredNorm(),
                  (corner(0) - corner(2)).squaredNorm()});
    const std::string name = "triangle " + std::to_string(t) + " near " + position(corner(0));
    if (!(twice_area > 1e-14 * longest)) add(d.degenerate, name);
    std::array<Index, 3> key{surface.triangles(0, t), surface.triangles(1, t), surface.triangles(2, t)};
    std::sort(key.begin(), key.end());
    if (!seen.insert(key).second) add(d.duplicate_triangles, name);
  }
}

void check_edges(const Surface& surface, const Edges& edges, Diagnosis& d) {
  for (const auto& [edge, use] : edges) {
    Finding* finding = nullptr;
    if (use.triangles.size() == 1)
      finding = &d.open_edges;
    else if (use.triangles.size() > 2)
      finding = &d.non_manifold_edges;
    else if (use.forward != 1)
      finding = &d.inconsistent_edges;
    if (finding == nullptr) continue;
    add(*finding, "edge " + std::to_string(edge.first) + "-" + std::to_string(edge.second) + " near " +
                      position(surface.points.col(edge.first)));
  }
}

// Sets of numbers that are joined pair by pair.
class Groups {
 public:
  explicit Groups(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  Index root(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(Index a, Index b) { parent_[root(a)] = root(b); }

 private:
  std::vector<Index> parent_;
};

void check_fans(const Surface& surface, const Edges& edges, Diagnosis& d) {
  // Corners (3 per triangle) that share an edge at their vertex belong to one fan.
  Groups corners(static_cast<std::size_t>(surface.triangle_count()) * 3), pieces(surface.triangle_count());
  const auto corner_at = [&](Index t, Index v) {
    for (int k = 0; k < 3; ++k) {
      if (surface.triangles(k, t) == v) return 3 * t + k;
    }
    return 3 * t;
  };
  for (const auto& [edge, use] : edges) {
    for (const Index t : use.triangles) {
      pieces.join(t, use.triangles[0]);
      for (const Index v : {edge.first, edge.second})
        corners.join(corner_at(t, v), corner_at(use.triangles[0], v));
    }
  }
  std::set<Index> roots;
  for (Index t = 0; t < surface.triangle_count(); ++t) roots.insert(pieces.root(t));
  d.components = static_cast<Index>(roots.size());
  std::map<Index, std::set<Index>> fans;
  for (Index c = 0; c < 3 * surface.triangle_count(); ++c)
    fans[surface.triangles(c % 3, c / 3)].insert(corners.root(c));
  for (const auto& [v, fan] : fans) {
    if (fan.size() > 1) {
      add(d.non_manifold_points, "vertex " + std::to_string(v) + " near " + position(surface.points.col(v)));
    }
  }
}

}  // namespace

std::vector<const Finding*> Diagnosis::findings() const {
  return {&not_finite,         &duplicate_points,    &degenerate,         &duplicate_triangles, &open_edges,
          &non_manifold_edges, &non_manifold_points, &inconsistent_edges, &self_intersections};
}

bool Diagnosis::closed() const {
  return triangles > 0 && open_edges.count + non_manifold_edges.count + inconsistent_edges.count == 0;
}

bool Diagnosis::meshable() const {
  return closed() && volume > 0 &&
         not_finite.count + degenerate.count + duplicate_triangles.count + non_manifold_points.count +
                 self_intersections.count ==
             0;
}

Diagnosis diagnose(const Surface& surface) {
  Diagnosis d;
  d.points = surface.point_count();
  d.triangles = surface.triangle_count();
  check_points(surface, d);
  check_triangles(surface, d);
  const Edges edges = collect_edges(surface);
  check_edges(surface, edges, d);
  check_fans(surface, edges, d);
  d.volume = enclosed_volume(surface);
  if (d.not_finite.count > 0) {
    d.volume = std::numeric_limits<double>::quiet_NaN();
    return d;
  }
  if (d.triangles > 0) {
    Eigen::AlignedBox3d box;
    for (const Index v : surface.triangles.reshaped()) box.extend(surface.points.col(v));
    d.box_min = box.min();
    d.box_max = box.max();
  }
  const UnitBox unit(surface);
  for (const auto& [a, b] : self_intersections({unit.to_unit(surface.points), surface.triangles})) {
    add(d.self_intersections, "triangles " + std::to_string(a) + " and " + std::to_string(b) + " near " +
                                  position(surface.points.col(surface.triangles(0, a))));
  }
  d.inverted = d.closed() && d.volume < 0;
  return d;
}

std::string in_words(const Diagnosis& d) {
  std::ostringstream text;
  text << d.points << " vertices (" << d.unused_points << " unused), " << d.triangles << " triangles in "
       << d.components << (d.components == 1 ? " component\n" : " components\n");
  text << "box " << position(d.box_min) << " to " << position(d.box_max) << ", enclosed volume " << d.volume
       << "\n";
  for (const Finding* finding : d.findings()) {
    if (finding->count == 0) continue;
    text << finding->count << " " << finding->name << ": ";
    for (std::size_t i = 0; i < finding->places.size(); ++i) text << (i ? "; " : "") << finding->places[i];
    text << (finding->count > static_cast<Index>(finding->places.size()) ? "; …\n" : "\n");
  }
  if (d.inverted) text << "inverted: the triangles face inwards\n";
  text << (d.meshable() ? "can be meshed as it is\n" : "needs repair before it can be meshed\n");
  return text.str();
}

std::string in_json(const Diagnosis& d) {
  nlohmann::ordered_json json;
  json["vertices"] = d.points;
  json["unused_vertices"] = d.unused_points;
  json["triangles"] = d.triangles;
  json["components"] = d.components;
  json["box"] = {{"min", {d.box_min.x(), d.box_min.y(), d.box_min.z()}},
                 {"max", {d.box_max.x(), d.box_max.y(), d.box_max.z()}}};
  json["volume"] = d.volume;
  for (const Finding* finding : d.findings()) {
    json["findings"].push_back(
        {{"name", finding->name}, {"count", finding->count}, {"places", finding->places}});
  }
  json["inverted"] = d.inverted;
  json["closed"] = d.closed();
  json["meshable"] = d.meshable();
  return json.dump(2);
}

}  // namespace lobe::meshing
