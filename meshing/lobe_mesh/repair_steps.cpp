// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// The steps of Repair::basic, in the order that closed every real surface on which it was tried.
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/repair_self_intersections.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include <sstream>

#include "lobe_mesh/cgal_common.h"
#include "lobe_mesh/clean.h"
#include "lobe_mesh/repair.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Face = CgalMesh::Face_index;
using Halfedge = CgalMesh::Halfedge_index;

constexpr int most_rounds = 6;  // of the steps that may undo each other

void note(RepairReport& report, const std::string& name, std::size_t count, const std::string& done) {
  if (count == 0) return;
  report.steps.push_back({name, static_cast<Index>(count), done});
}

std::string plural(std::size_t n, const std::string& singular) {
  if (n == 1) return "1 " + singular;
  if (singular.back() == 'x')
    return std::to_string(n) + " " + singular.substr(0, singular.size() - 2) + "ices";
  return std::to_string(n) + " " + singular + "s";
}

double diagonal(const CGAL::Bbox_3& box) {
  return std::hypot(box.xmax() - box.xmin(), box.ymax() - box.ymin(), box.zmax() - box.zmin());
}

CgalMesh orient(const Surface& surface, RepairReport& report) {
  Soup soup = to_soup(surface.points, surface.triangles);
  const std::size_t points = soup.points.size();
  std::vector<std::array<std::size_t, 3>> before = soup.triangles;
  pmp::orient_polygon_soup(soup.points, soup.triangles);
  std::size_t turned = 0;
  for (std::size_t t = 0; t < before.size(); ++t) {
    // Duplicated vertices get new numbers: compare positions, up to rotation.
    const auto& old = before[t];
    const auto& now = soup.triangles[t];
    bool same = false;
    for (int k = 0; k < 3; ++k) {
      same = same || (soup.points[now[k]] == soup.points[old[0]] &&
                      soup.points[now[(k + 1) % 3]] == soup.points[old[1]]);
    }
    turned += !same;
  }
  turned = std::min(turned, before.size() - turned);  // the rest follows from the choice of the outside
  note(report, "orient", turned, "turned " + plural(turned, "triangle") + " to agree with the neighbours");
  const std::size_t split = soup.points.size() - points;
  note(report, "split", split, "separated the surface at " + plural(split, "non-manifold vertex"));
  CgalMesh mesh;
  pmp::polygon_soup_to_polygon_mesh(soup.points, soup.triangles, mesh);
  return mesh;
}

void stitch(CgalMesh& mesh, RepairReport& report) {
  const std::size_t pairs = pmp::stitch_borders(mesh);
  note(report, "stitch", pairs, "stitched " + plural(pairs, "pair") + " of open edges");
}

// Removes specks of a segmentation: closed pieces with less than a millionth of the largest volume, and open
// pieces with less than a thousandth of the area. All others stay, cavities and second bodies included.
void drop_specks(CgalMesh& mesh, RepairReport& report) {
  auto piece = mesh.add_property_map<Face, std::size_t>("f:piece", 0).first;
  const std::size_t count = pmp::connected_components(mesh, piece);
  if (count > 1) {
    std::vector<double> area(count, 0), volume(count, 0);
    std::vector<bool> open(count, false);
    for (const Face face : mesh.faces()) {
      area[piece[face]] += pmp::face_area(face, mesh);
      Point corner[3];
      int k = 0;
      for (const auto v : mesh.vertices_around_face(mesh.halfedge(face))) corner[k++] = mesh.point(v);
      volume[piece[face]] += CGAL::volume(Point(0, 0, 0), corner[0], corner[1], corner[2]);
      for (const auto h : mesh.halfedges_around_face(mesh.halfedge(face))) {
        if (mesh.is_border(mesh.opposite(h))) open[piece[face]] = true;
      }
    }
    double largest = 0, total_area = 0;
    for (std::size_t c = 0; c < count; ++c) {
      if (!open[c]) largest = std::max(largest, std::abs(volume[c]));
      total_area += area[c];
    }
    std::vector<std::size_t> specks;
    for (std::size_t c = 0; c < count; ++c) {
      if (open[c] ? area[c] < 1e-3 * total_area : std::abs(volume[c]) < 1e-6 * largest) specks.push_back(c);
    }
    if (specks.size() < count) {
      pmp::remove_connected_components(mesh, specks, piece);
      note(report, "specks", specks.size(),
           "dropped " + plural(specks.size(), "speck") + " apart from the body");
    }
  }
  mesh.remove_property_map(piece);
}

void fill_holes(CgalMesh& mesh, double largest_hole, RepairReport& report) {
  std::vector<Halfedge> holes;
  pmp::extract_boundary_cycles(mesh, std::back_inserter(holes));
  const double body = diagonal(pmp::bbox(mesh));
  std::size_t filled = 0;
  for (const Halfedge hole : holes) {
    CGAL::Bbox_3 box;
    for (const auto h : mesh.halfedges_around_face(hole)) box += mesh.point(mesh.target(h)).bbox();
    const double width = diagonal(box) / body;
    if (width > largest_hole) {
      std::ostringstream message;
      message << plural(holes.size(), "hole") << ", one as wide as " << std::lround(100 * width)
              << " % of the surface's diagonal; at most " << std::lround(100 * largest_hole)
              << " % are filled: use --largest-hole, or --repair wrap to wrap what is there";
      throw InputError("open surface", message.str());
    }
    std::vector<Face> patch;
    pmp::triangulate_and_refine_hole(mesh, hole, std::back_inserter(patch), CGAL::Emptyset_iterator());
    if (patch.empty()) throw InputError("open surface", "a hole could not be filled: use --repair wrap");
    filled += patch.size();
  }
  note(report, "holes", holes.size(),
       "filled " + plural(holes.size(), "hole") + " with " + plural(filled, "triangle"));
}

std::vector<Face> nearly_degenerate_faces(const CgalMesh& mesh) {
  std::vector<Face> faces;
  for (const Face face : mesh.faces()) {
    Vec3d corner[3];
    int k = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(face)))
      corner[k++] = {mesh.point(v).x(), mesh.point(v).y(), mesh.point(v).z()};
    if (degenerate(corner[0], corner[1], corner[2])) faces.push_back(face);
  }
  return faces;
}

// Removes triangles that are exactly flat first. Then it removes those whose area is only rounding: caps are
// flipped, and needles are collapsed.
void remove_degenerate(CgalMesh& mesh, RepairReport& report) {
  constexpr double cap = -1 + 1e-12, needle = 1e6,
                   longest_collapse = 1e-6;  // cosine, ratio of edges, of the size
  std::vector<Face> flat;
  pmp::degenerate_faces(mesh, std::back_inserter(flat));
  if (!flat.empty() && !pmp::remove_degenerate_faces(mesh))
    throw InputError("degenerate triangles", "could not be removed: use --repair wrap");
  const std::vector<Face> nearly = nearly_degenerate_faces(mesh);
  if (!nearly.empty())
    pmp::experimental::remove_almost_degenerate_faces(nearly, mesh, cap, needle, longest_collapse);
  const std::size_t count = flat.size() + nearly.size();
  note(report, "degenerate", count, "removed " + plural(count, "triangle") + " without area");
}

Index remove_intersections(CgalMesh& mesh, RepairReport& report) {
  // CGAL's own test is not used: it reports pieces that were separated at a common edge as intersecting.
  const auto pairs = self_intersections(from_cgal(mesh));
  if (pairs.empty()) return 0;
  if (!pmp::experimental::remove_self_intersections(mesh, CGAL::parameters::preserve_genus(false))) {
    throw InputError("self-intersections",
                     plural(pairs.size(), "pair") +
                         " of triangles intersect and could not be separated (two bodies that "
                         "overlap?): use --repair wrap");
  }
  note(report, "self-intersections", pairs.size(),
       "replaced the surroundings of " + plural(pairs.size(), "pair") + " of intersecting triangles");
  return static_cast<Index>(pairs.size());
}

void face_outwards(CgalMesh& mesh, RepairReport& report) {
  if (!CGAL::is_closed(mesh)) throw InputError("open surface", "still open after repair: use --repair wrap");
  std::vector<std::array<CgalMesh::Vertex_index, 2>> edges;
  for (const Face face : mesh.faces()) {
    edges.push_back({mesh.source(mesh.halfedge(face)), mesh.target(mesh.halfedge(face))});
  }
  pmp::orient_to_bound_a_volume(mesh);
  std::size_t turned = 0, i = 0;
  for (const Face face : mesh.faces()) {
    bool same = false;
    for (const auto h : mesh.halfedges_around_face(mesh.halfedge(face))) {
      same = same || (mesh.source(h) == edges[i][0] && mesh.target(h) == edges[i][1]);
    }
    turned += !same;
    ++i;
  }
  note(report, "inverted", turned,
       "turned " + plural(turned, "triangle") + " of an inverted piece to face outwards");
}

}  // namespace

Surface repair_in_steps(const Surface& surface, double largest_hole, RepairReport& report,
                        const std::function<void(const Surface&)>& done) {
  CgalMesh mesh;
  const auto run_step = [&](const std::string& name, const auto& step) {
    const std::size_t steps = report.steps.size();
    guarded("repair (" + name + ")", step);
    if (report.steps.size() > steps) done(from_cgal(mesh));
  };
  run_step("orient", [&] { mesh = orient(surface, report); });
  run_step("stitch", [&] { stitch(mesh, report); });
  run_step("specks", [&] { drop_specks(mesh, report); });
  run_step("holes", [&] { fill_holes(mesh, largest_hole, report); });
  // The triangles that replace intersecting ones may be degenerate, and their replacements may intersect.
  Index changed = 1;
  for (int round = 0; round < most_rounds && changed > 0; ++round) {
    run_step("degenerate", [&] { remove_degenerate(mesh, report); });
    run_step("self-intersections", [&] { changed = remove_intersections(mesh, report); });
  }
  run_step("orientation", [&] { face_outwards(mesh, report); });
  mesh.collect_garbage();
  return from_cgal(mesh);
}

}  // namespace lobe::meshing
