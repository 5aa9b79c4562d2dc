// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/diagnose.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "lobe_mesh/clean.h"
#include "lobe_mesh/disjoint_sets.h"
#include "lobe_mesh/model.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {
namespace {

constexpr std::size_t places_kept = 3;

std::string position(const Vec3d& p) {
  std::ostringstream text;
  text << "(" << p.x() << ", " << p.y() << ", " << p.z() << ")";
  return text.str();
}

void add(Finding& finding, const std::string& place, const std::vector<Index>& triangles) {
  ++finding.count;
  finding.triangles.insert(finding.triangles.end(), triangles.begin(), triangles.end());
  if (finding.places.size() < places_kept) finding.places.push_back(place);
}

void add_point(Finding& finding, const std::string& place, Index point) {
  add(finding, place, {});
  finding.points.push_back(point);
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

void check_points(const Surface& surface, const std::vector<Index>& first, Diagnosis& d) {
  std::vector<bool> used(surface.point_count(), false);
  for (const Index v : surface.triangles.reshaped()) used[v] = true;
  for (Index i = 0; i < surface.point_count(); ++i) {
    const std::string name = "vertex " + std::to_string(i);
    if (!usable(surface.points.col(i)))
      add_point(d.not_finite, name + " at " + position(surface.points.col(i)), i);
    if (!used[i])
      ++d.unused_points;
    else if (first[i] != i)
      add_point(d.duplicate_points, name + " = vertex " + std::to_string(first[i]), i);
  }
}

void check_triangles(const Surface& surface, const std::vector<Index>& first, Diagnosis& d) {
  std::set<std::array<Index, 3>> seen;
  for (Index t = 0; t < surface.triangle_count(); ++t) {
    const auto corner = [&](int k) -> Vec3d { return surface.points.col(surface.triangles(k, t)); };
    const std::string name = "triangle " + std::to_string(t) + " near " + position(corner(0));
    if (degenerate(corner(0), corner(1), corner(2))) add(d.degenerate, name, {t});
    std::array<Index, 3> key;
    for (int k = 0; k < 3; ++k) key[k] = first[surface.triangles(k, t)];
    std::sort(key.begin(), key.end());
    if (!seen.insert(key).second) add(d.duplicate_triangles, name, {t});
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
    add(*finding,
        "edge " + std::to_string(edge.first) + "-" + std::to_string(edge.second) + " near " +
            position(surface.points.col(edge.first)),
        use.triangles);
  }
}

DisjointSets pieces_of(const Surface& surface, const Edges& edges) {
  DisjointSets pieces(surface.triangle_count());
  for (const auto& [edge, use] : edges) {
    for (const Index t : use.triangles) pieces.join(t, use.triangles[0]);
  }
  return pieces;
}

void check_fans(const Surface& surface, const Edges& edges, Diagnosis& d) {
  // Corners (3 per triangle) that share an edge at their vertex belong to one fan.
  DisjointSets corners(static_cast<std::size_t>(surface.triangle_count()) * 3),
      pieces = pieces_of(surface, edges);
  const auto corner_at = [&](Index t, Index v) {
    for (int k = 0; k < 3; ++k) {
      if (surface.triangles(k, t) == v) return 3 * t + k;
    }
    return 3 * t;
  };
  for (const auto& [edge, use] : edges) {
    for (const Index t : use.triangles) {
      for (const Index v : {edge.first, edge.second})
        corners.join(corner_at(t, v), corner_at(use.triangles[0], v));
    }
  }
  for (Index t = 0; t < surface.triangle_count(); ++t) d.components += pieces.root(t) == t;
  std::map<Index, std::set<Index>> fans;
  for (Index c = 0; c < 3 * surface.triangle_count(); ++c)
    fans[surface.triangles(c % 3, c / 3)].insert(corners.root(c));
  for (const auto& [v, fan] : fans) {
    if (fan.size() > 1) {
      add_point(d.non_manifold_points,
                "vertex " + std::to_string(v) + " near " + position(surface.points.col(v)), v);
    }
  }
}

std::vector<Surface> split(const Surface& surface, const Edges& edges,
                           std::vector<std::vector<Index>>& triangles) {
  DisjointSets groups = pieces_of(surface, edges);
  std::map<Index, std::vector<Index>> of_root;
  for (Index t = 0; t < surface.triangle_count(); ++t) of_root[groups.root(t)].push_back(t);
  std::vector<Surface> pieces;
  for (const auto& [root, its] : of_root) {
    pieces.push_back({surface.points, surface.triangles(Eigen::all, its)});
    triangles.push_back(its);
  }
  return pieces;
}

// Checks that closed pieces face outwards, and that cavities of another piece face inwards.
void check_sides(const Surface& surface, const Edges& edges, Diagnosis& d) {
  constexpr Index most_pieces = 200;  // with more, it is rather noise than cavities
  if (d.components > most_pieces) return;
  std::vector<std::vector<Index>> triangles;
  const std::vector<Surface> pieces = split(surface, edges, triangles);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Vec3d point = surface.points.col(pieces[i].triangles(0, 0));
    int around = 0;  // how many others it lies in, whatever way they face
    for (std::size_t j = 0; j < pieces.size(); ++j)
      around += j != i && std::abs(winding_number(pieces[j], point)) > 0.5;
    const bool inwards = enclosed_volume(pieces[i]) < 0, nested = around % 2 == 1;
    d.cavities += inwards && nested;
    if (inwards != nested) {
      add(d.wrong_sides,
          "triangle " + std::to_string(triangles[i][0]) + " near " + position(point) +
              (nested ? ", inside another" : ""),
          triangles[i]);
    }
  }
}

}  // namespace

std::string Finding::counted() const { return std::to_string(count) + " " + (count == 1 ? single : name); }

std::vector<const Finding*> Diagnosis::findings() const {
  return {&not_finite,         &duplicate_points,    &degenerate,         &duplicate_triangles, &open_edges,
          &non_manifold_edges, &non_manifold_points, &inconsistent_edges, &self_intersections,  &wrong_sides};
}

bool Diagnosis::closed() const {
  return triangles > 0 && open_edges.count + non_manifold_edges.count + inconsistent_edges.count == 0;
}

bool Diagnosis::meshable() const {
  return closed() && volume > 0 &&
         not_finite.count + degenerate.count + duplicate_triangles.count + non_manifold_points.count +
                 self_intersections.count + wrong_sides.count ==
             0;
}

Diagnosis diagnose(const Surface& surface) {
  Diagnosis d;
  d.points = surface.point_count();
  d.triangles = surface.triangle_count();
  const std::vector<Index> first = first_of_equal_points(surface.points);
  check_points(surface, first, d);
  check_triangles(surface, first, d);
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
    d.diagonal = box.diagonal().norm();
    if (d.diagonal > 2) d.scale_hint = "large for metres: in millimetres? use --scale 0.001";
    if (d.diagonal < 1e-3) d.scale_hint = "small for an organ in metres: use --scale";
  }
  const UnitBox unit(surface);
  for (const auto& [a, b] : self_intersections({unit.to_unit(surface.points), surface.triangles})) {
    add(d.self_intersections,
        "triangles " + std::to_string(a) + " and " + std::to_string(b) + " near " +
            position(surface.points.col(surface.triangles(0, a))),
        {a, b});
  }
  if (d.closed()) check_sides(surface, edges, d);
  d.inverted = d.closed() && d.volume < 0;
  return d;
}

std::string in_words(const Diagnosis& d) {
  std::ostringstream text;
  text << d.points << " vertices (" << d.unused_points << " unused), " << d.triangles << " triangles in "
       << d.components << (d.components == 1 ? " component\n" : " components\n");
  text << "box " << position(d.box_min) << " to " << position(d.box_max) << " m, enclosed volume " << d.volume
       << " m³\n";
  text << "size " << d.diagonal << " m" << (d.scale_hint.empty() ? "" : ", " + d.scale_hint) << "\n";
  if (d.cavities > 0) text << d.cavities << (d.cavities == 1 ? " cavity\n" : " cavities\n");
  for (const Finding* finding : d.findings()) {
    if (finding->count == 0) continue;
    text << finding->counted() << ": ";
    for (std::size_t i = 0; i < finding->places.size(); ++i) text << (i ? "; " : "") << finding->places[i];
    text << (finding->count > static_cast<Index>(finding->places.size()) ? "; …\n" : "\n");
  }
  if (d.inverted) text << "inverted: the triangles face inwards\n";
  text << (d.meshable() ? "can be meshed as it is\n" : "needs repair before it can be meshed\n");
  return text.str();
}

namespace {

// The lowest of these numbers, each once: an inverted piece has all of its triangles.
std::vector<Index> first_of(const std::vector<Index>& numbers) {
  constexpr std::size_t most = 100;
  const std::set<Index> sorted(numbers.begin(), numbers.end());
  std::vector<Index> first(sorted.begin(), sorted.end());
  if (first.size() > most) first.resize(most);
  return first;
}

}  // namespace

std::string in_json(const Diagnosis& d) {
  nlohmann::ordered_json json;
  json["vertices"] = d.points;
  json["unused_vertices"] = d.unused_points;
  json["triangles"] = d.triangles;
  json["components"] = d.components;
  json["box"] = {{"min", {d.box_min.x(), d.box_min.y(), d.box_min.z()}},
                 {"max", {d.box_max.x(), d.box_max.y(), d.box_max.z()}}};
  json["diagonal"] = d.diagonal;
  json["scale_hint"] = d.scale_hint;
  json["volume"] = d.volume;
  json["cavities"] = d.cavities;
  for (const Finding* finding : d.findings()) {
    json["findings"].push_back({{"name", finding->name},
                                {"count", finding->count},
                                {"places", finding->places},
                                {"triangles", first_of(finding->triangles)},
                                {"vertices", first_of(finding->points)}});
  }
  json["inverted"] = d.inverted;
  json["closed"] = d.closed();
  json["meshable"] = d.meshable();
  return json.dump(2);
}

}  // namespace lobe::meshing
