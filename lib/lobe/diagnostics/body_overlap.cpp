#include "lobe/diagnostics/body_overlap.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <set>

#include "lobe/cut/distance.h"
#include "lobe/diagnostics/locate.h"
#include "lobe/mesh/joined_mesh.h"
#include "lobe/mesh/outer_faces.h"
#include "lobe/mesh/quality.h"

namespace lobe {
namespace {

constexpr double rounding = 1e-6;  // of an edge

struct Faces {  // of a surface, with a ball around each
  explicit Faces(const TetMesh& mesh) : faces(outer_faces(mesh)), centres(3, Index(faces.size())) {
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const Mat3<double> X = corners(mesh, f);
      centres.col(Index(f)) = X.rowwise().mean();
      radii.push_back((X.colwise() - centres.col(Index(f))).colwise().norm().maxCoeff());
    }
  }
  Mat3<double> corners(const TetMesh& mesh, std::size_t f) const {
    Mat3<double> X;
    for (int k = 0; k < 3; ++k)
      X.col(k) = mesh.points.col(mesh.tets(face_corners[faces[f].face][k], faces[f].tet));
    return X;
  }

  std::vector<TetFace> faces;
  Mat3X<double> centres;
  std::vector<double> radii;
};

struct Part {  // one of the bodies
  Part(const TetMesh& mesh, int body)
      : tets(tets_of_body(mesh, body)), surface(tets), locator(tets), edge(mesh_quality(tets).mean_edge) {
    const Box bounds = bounding_box(tets);
    box = {bounds.min, bounds.max};
  }
  Part(const Part&) = delete;  // the locator refers to the mesh

  TetMesh tets;
  Faces surface;
  Locator locator;
  double edge;  // mean [m]
  Eigen::AlignedBox3d box;
};

// From a point inside to the surface, or at least `enough` [m].
double depth_of(const Vec3d& p, const Part& in, double enough) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < in.surface.faces.size() && least > enough; ++f) {
    if ((in.surface.centres.col(Index(f)) - p).norm() - in.surface.radii[f] >= least) continue;
    const Mat3<double> X = in.surface.corners(in.tets, f);
    least = std::min(least, (nearest_on_triangle(p, X.col(0), X.col(1), X.col(2)) - p).norm());
  }
  return least;
}

// Looks how deep the surface of one body lies in the other.
void look(const Part& one, const Part& in, BodyOverlap& found) {
  Index guess = -1;
  const auto look_at = [&](const Vec3d& p) {
    if (!in.box.contains(p)) return;
    const Locator::Found at = in.locator.nearest(p, guess);
    guess = at.tet;
    if (at.distance > 0) return;
    const double depth = depth_of(p, in, found.depth);
    if (depth <= found.depth) return;
    found.depth = depth;
    found.place = p;
  };
  std::set<Index> seen;
  for (std::size_t f = 0; f < one.surface.faces.size(); ++f) {
    const Mat3<double> X = one.surface.corners(one.tets, f);
    look_at(one.surface.centres.col(Index(f)));
    const auto& [tet, face] = one.surface.faces[f];
    for (int k = 0; k < 3; ++k) {
      look_at((X.col(k) + X.col((k + 1) % 3)) / 2);
      if (seen.insert(one.tets.tets(face_corners[face][k], tet)).second) look_at(X.col(k));
    }
  }
}

}  // namespace

std::vector<BodyOverlap> body_overlaps(const TetMesh& mesh) {
  std::vector<BodyOverlap> overlaps;
  std::vector<std::unique_ptr<Part>> parts;
  for (std::size_t b = 0; mesh.bodies.any() && b < mesh.bodies.count(); ++b)
    parts.push_back(std::make_unique<Part>(mesh, int(b)));
  for (std::size_t b = 1; b < parts.size(); ++b)
    for (std::size_t a = 0; a < b; ++a) {
      if (!parts[a]->box.intersects(parts[b]->box)) continue;
      BodyOverlap found{.body = int(a), .other = int(b), .edge = std::min(parts[a]->edge, parts[b]->edge)};
      found.depth = rounding * found.edge;
      look(*parts[a], *parts[b], found);
      look(*parts[b], *parts[a], found);
      if (found.depth > rounding * found.edge) overlaps.push_back(found);
    }
  return overlaps;
}

}  // namespace lobe
