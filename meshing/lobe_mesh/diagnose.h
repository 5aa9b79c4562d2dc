// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// What is wrong with a surface, and where.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lobe_mesh/surface.h"

namespace lobe::meshing {

// One kind of fault.
struct Finding {
  std::string name, single;  // "open edges", "open edge"
  Index count = 0;
  std::vector<std::string> places = {};  // the first few: "edge 3-17 near (0.1, 0, 0.02)"
  std::vector<Index> triangles = {};     // triangles concerned, all of them; one may occur several times
  std::vector<Index> points = {};        // vertices concerned, for faults of vertices

  std::string counted() const;  // "3 open edges"
};

struct Diagnosis {
  Index points = 0;
  Index unused_points = 0;  // vertices in no triangle: harmless
  Index triangles = 0;
  double diagonal = 0;                                     // diagonal of the box [m]
  Index components = 0;                                    // parts connected by edges
  Vec3d box_min = Vec3d::Zero(), box_max = Vec3d::Zero();  // [m]
  double volume = 0;  // [m³] enclosed; negative if the triangles face inwards; NaN if a coordinate is
  Finding not_finite{"coordinates that are not finite", "coordinate that is not finite"};
  Finding duplicate_points{"duplicate vertices", "duplicate vertex"};
  Finding degenerate{"degenerate triangles", "degenerate triangle"};         // no area, or a vertex twice
  Finding duplicate_triangles{"duplicate triangles", "duplicate triangle"};  // corners in the same places
  Finding open_edges{"open edges", "open edge"};
  Finding non_manifold_edges{"non-manifold edges", "non-manifold edge"};  // edges of three or more triangles
  // Vertices whose triangles form several fans.
  Finding non_manifold_points{"non-manifold vertices", "non-manifold vertex"};
  Finding inconsistent_edges{"inconsistently oriented edges", "inconsistently oriented edge"};
  // Pairs of triangles; not if coordinates are NaN.
  Finding self_intersections{"self-intersections", "self-intersection"};
  // Closed pieces that face inwards, and pieces inside another one that face outwards.
  Finding wrong_sides{"pieces facing the wrong way", "piece facing the wrong way"};
  Index cavities = 0;      // closed pieces inside another one that face inwards, as they must
  std::string scale_hint;  // "" or a doubt about the unit
  bool inverted = false;   // closed, but facing inwards

  std::vector<const Finding*> findings() const;
  bool closed() const;    // every edge has exactly two triangles that agree about the outside
  bool meshable() const;  // closed, manifold, free of intersections, facing outwards
};

// Costs one sort of the edges and one box-intersection sweep: 0.1 s for 10,000 triangles.
Diagnosis diagnose(const Surface& surface);

// The surface with its faults, for a viewer: .vtp, .vtu or .ply with one number (0 or 1) per triangle and
// kind of fault that occurs, named after it, and `faults`, their sum.
void write_marked(const std::filesystem::path& file, const Surface& surface, const Diagnosis& diagnosis);

std::string in_words(const Diagnosis& diagnosis);
std::string in_json(const Diagnosis& diagnosis);

}  // namespace lobe::meshing
