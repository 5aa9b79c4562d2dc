// Points embedded in tetrahedra: ends of threads and of attachments. A point moves with the tetrahedron that
// it lies in, and passes forces on to its corners:
//   x = Σ w_c x_c,  f_c += w_c f,
// so that neither momentum nor work is lost. Corners come from the topology at each use, so the split of a
// vertex needs nothing. A point ends with its tetrahedron.
#pragma once

#include "lobe/diagnostics/locate.h"
#include "lobe/fem/elements.h"
#include "lobe/setup/embedded_point.h"

namespace lobe {

class Grains;

// ---- Where a point lies

struct FoundPoint {
  EmbeddedPoint point;
  double distance = 0;  // distance from the wanted place to the nearest tetrahedron [m]; 0 inside of one
};
// The point of a mesh that is at X, or the point of it that is nearest to X. O(log #tets).
FoundPoint embed(const Locator& locator, const Vec3d& X);  // [m]

// The point of the body as it is now that is at x, or the nearest one. O(#tets).
template <class Real>
FoundPoint embed_now(const Vec3d& x, const Elements& elements,
                     const Grains* grains,   // null: no blade has cut
                     const Mat3X<Real>& u);  // 3 × at least #vertices [m]

inline bool exists(const EmbeddedPoint& point, const Topology& topology) {
  return point.tet >= 0 && point.tet < topology.tet_count() && topology.alive(point.tet);
}
Vec3d rest_position(const EmbeddedPoint& point, const Elements& elements);  // [m]

template <class Real>
Vec3d position(const EmbeddedPoint& point, const Elements& elements,
               const Mat3X<Real>& u) {  // 3 × at least #vertices [m]
  const Eigen::Vector4i corners = elements.topology.corners(point.tet);
  Vec3d x = Vec3d::Zero();
  for (int c = 0; c < 4; ++c)
    x += point.weights[c] * (elements.points.col(corners[c]) + u.col(corners[c]).template cast<double>());
  return x;
}

// Adds a force [N] on the point to the forces on its corners.
template <class Real>
void add_force(const EmbeddedPoint& point, const Topology& topology, const Vec3d& force, Mat3X<Real>& f) {
  const Eigen::Vector4i corners = topology.corners(point.tet);
  for (int c = 0; c < 4; ++c) f.col(corners[c]) += (point.weights[c] * force).template cast<Real>();
}

// ---- Cuts

// Moves a point in a tetrahedron that a blade has divided to the copy whose grains it lies in; to the nearest
// if rounding has put it between two of them. O(#copies).
void follow_division(EmbeddedPoint& point, const Elements& elements, const Grains& grains,
                     const MeshEdit& edit);
// Distance of a point at rest to the material of a tetrahedron; 0 if nothing has divided it [m].
double distance_to_material(const Vec3d& X, Index tet, const Elements& elements, const Grains* grains);

// ---- Motion through tissue

// Where a point comes out if it is moved through the tissue to x [m], from tetrahedron to tetrahedron. The
// result has no tetrahedron if it comes to the surface first, that of cuts included.
template <class Real>
EmbeddedPoint moved_through(const EmbeddedPoint& point, const Vec3d& x, const Elements& elements,
                            const Grains* grains,   // null: no blade has cut
                            const Mat3X<Real>& u);  // 3 × at least #vertices [m]

}  // namespace lobe
