// Performs one step of a blade through grains: finds the edges that it crosses and the faces that it opens.
#pragma once

#include "lobe/scalpel/placed_tets.h"

namespace lobe {

struct Blade {
  int stroke = 0;     // 0 … Grains::most_strokes − 1
  double snap = 0.1;  // a point nearer than this share of its shortest edge lies on the sheet
  // No grain is divided: what lies on both sides of the sheet goes to the side of its middle.
  bool along_faces = false;
  // The tissue has moved since the last sheet. The straight lines between the stored places may now lie ahead
  // of the end of that sheet. The last sheet finds the edges in between.
  bool looks_back = false;
  Index number = -1;  // number of the stroke among all strokes of the body
  // −1: all edges near the last sheet may be cut. Otherwise only edges of points from this number on are, by
  // any of the sheets: points that others have made since the last step.
  Index since = -1;

  // The distance from the sheet within which grains may have to be divided [m]: it holds the points that the
  // sheet takes and the edges that it crosses.
  double reach(const Grains& grains) const {
    constexpr double rounding = 1e-6;
    return along_faces ? 2 * grains.mean_edge() : (1 + rounding) * snap * grains.longest_shortest_edge();
  }
};

struct Incised {
  Incision caught_up;  // edges that other strokes have made behind the blade; comes before `incision`
  Incision incision;
  std::vector<Index> opened;  // the tetrahedra beside the faces that were opened
  double area = 0;            // area of these faces, at rest [m²]
  struct Face {
    Index element, neighbour;  // tetrahedra
    double area;               // area at rest [m²]
    Vec3d middle;              // present place [m]
  };
  std::vector<Face> faces;
  Index crumbs = 0;           // crumbs that stay attached
  Vec3d way = Vec3d::Zero();  // mean way of the edge through the tissue [m]
  Index refused = 0;          // edges not bisected, as their tetrahedra would have too many grains
  // Adds this to what was made up before.
  void follow(Incised&& before);
};

// Cuts where the last sheet meets these tetrahedra: all that are within reach of it. Faces open where all
// three points lie on the stroke's sheets, and their middle near what it has swept last. A face is looked at
// when the sheet has taken the last of its points. If its middle is not near then, it waits, and opens when
// the last sheet is near.
Incised incise(Grains& grains, const Blade& blade, const SweptSheets& swept, const PlacedTets& tets);

// Divides grains as a step has done, after which faces can be opened as it has. Throws InputError for an
// incision that does not fit the grains.
void divide_again(const Incision& incision, Grains& grains);

inline constexpr Index most_grains = 256;  // most grains of a tetrahedron of the start

}  // namespace lobe
