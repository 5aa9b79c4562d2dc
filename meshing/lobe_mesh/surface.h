// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// A triangle surface as it comes from a segmentation or a modelling program.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lobe/types.h"

namespace lobe::meshing {

struct Surface {
  Mat3X<double> points;  // 3 × #vertices [m]
  Triangles triangles;   // 3 × #triangles, counter-clockwise seen from outside

  Index point_count() const { return static_cast<Index>(points.cols()); }
  Index triangle_count() const { return static_cast<Index>(triangles.cols()); }
};

// (Written by write_surface() of lobe/io/surface_io.h.)
// Reads by extension: .stl and .ply (ascii and binary), .obj, .off, .vtp. Polygons are triangulated; STL,
// which has no indices, gets equal points welded. Coordinates that are not finite are kept for diagnose().
// Throws InputError naming file and line (or byte): missing, empty, truncated or garbled files, wrong
// indices.
Surface read_surface(const std::filesystem::path& file);

double enclosed_volume(const Surface& surface);  // [m³], negative if the triangles face inwards
double box_diagonal(const Surface& surface);     // [m], over the vertices that triangles use

// Centre and size of a surface. The geometry libraries work in a box of unit diagonal, because some of their
// tolerances are absolute.
struct UnitBox {
  explicit UnitBox(const Surface& surface);

  Mat3X<double> to_unit(const Mat3X<double>& points) const;
  Mat3X<double> from_unit(const Mat3X<double>& points) const;

  Vec3d centre = Vec3d::Zero();  // [m]
  double size = 1;               // [m], a power of two near the diagonal, so that scaling is exact
};

// One feature line: vertices in order, first = last for a closed one.
using Polyline = std::vector<Index>;

// Edges whose two triangles turn by more than `angle` [degrees], and those of more triangles, as lines from
// corner to corner. Creases of a coarse or rough surface are left out: lines of edges of two triangles that
// end on a smooth part or zigzag, and connected groups shorter than `shortest` [m]. The edges of a box and
// the rims of a cylinder stay. Lines from corner to corner that are shorter than `finest` [m] are left out as
// well, with what then ends nowhere: a mesher that keeps them makes edges as short as they are. Those are
// counted.
struct FeatureLines {
  std::vector<Polyline> lines;
  Index fine = 0;                 // lines that were left out because they are short
  Vec3d fine_at = Vec3d::Zero();  // [m] where the first of them begins
};
FeatureLines feature_lines(const Surface& surface, double angle, double shortest, double finest);

}  // namespace lobe::meshing
