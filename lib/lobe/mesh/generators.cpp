#include "lobe/mesh/generators.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "lobe/error.h"

namespace lobe {
namespace {

void require(bool condition, const char* generator, const char* message) {
  if (!condition) throw InputError(generator, message);
}

void require_countable(double vertices, double tets, const char* generator) {
  require(std::max(vertices, tets) < 2147483647.0, generator, "more than 2^31 - 1 tetrahedra or vertices");
}

void orient(TetMesh& mesh) {
  for (Index t = 0; t < mesh.tet_count(); ++t)
    if (signed_volume(tet_points(mesh, t)) < 0) std::swap(mesh.tets(2, t), mesh.tets(3, t));
}

// On a disc, ring r begins at 1 + 3 r (r−1), for r > 0; the axis is vertex 0. `i` counts around the ring.
Index ring_vertex(Index ring, Index i) { return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1) + i % (6 * ring); }

// Each sixth of the band inside ring r has r triangles that stand on ring r and r−1 that hang from it.
std::vector<std::array<Index, 3>> disc_triangles(int rings) {
  std::vector<std::array<Index, 3>> triangles;
  for (Index r = 1; r <= rings; ++r)
    for (Index sector = 0; sector < 6; ++sector)
      for (Index i = 0; i < r; ++i) {
        const Index outer = sector * r + i, inner = sector * (r - 1) + i;
        triangles.push_back({ring_vertex(r, outer), ring_vertex(r, outer + 1), ring_vertex(r - 1, inner)});
        if (i + 1 < r)
          triangles.push_back(
              {ring_vertex(r, outer + 1), ring_vertex(r - 1, inner + 1), ring_vertex(r - 1, inner)});
      }
  return triangles;
}

void place_disc(Mat3X<double>& points, Index first, double radius, double z, int rings) {
  points.col(first) = Vec3d(0, 0, z);
  for (Index r = 1; r <= rings; ++r)
    for (Index i = 0; i < 6 * r; ++i) {
      const double angle = std::numbers::pi * i / (3.0 * r), distance = radius * r / rings;
      points.col(first + ring_vertex(r, i)) =
          Vec3d(distance * std::cos(angle), distance * std::sin(angle), z);
    }
}

}  // namespace

TetMesh box_mesh(Vec3d size, int nx, int ny, int nz) {
  require(nx > 0 && ny > 0 && nz > 0, "box_mesh", "needs at least one cell along each axis");
  require(size.minCoeff() > 0 && size.allFinite(), "box_mesh", "needs a size above 0 along each axis");
  require_countable((nx + 1.0) * (ny + 1.0) * (nz + 1.0), 6.0 * nx * ny * nz, "box_mesh");
  const auto vertex = [&](int i, int j, int k) { return i + (nx + 1) * (j + (ny + 1) * k); };
  TetMesh mesh;
  mesh.points.resize(3, vertex(nx, ny, nz) + 1);
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i)
        mesh.points.col(vertex(i, j, k)) = Vec3d(size[0] * i / nx, size[1] * j / ny, size[2] * k / nz);
  // A tetrahedron for each order of walking from the lower to the upper corner along the axes; odd orders
  // would be inside out.
  constexpr int walks[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  mesh.tets.resize(4, 6 * Index{nx} * ny * nz);
  Index tet = 0;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        for (int w = 0; w < 6; ++w, ++tet) {
          std::array<int, 3> at = {i, j, k};
          mesh.tets(0, tet) = vertex(i, j, k);
          for (int step = 0; step < 3; ++step) {
            ++at[static_cast<std::size_t>(walks[w][step])];
            mesh.tets(step + 1, tet) = vertex(at[0], at[1], at[2]);
          }
          if (w >= 3) std::swap(mesh.tets(2, tet), mesh.tets(3, tet));
        }
  mesh.labels.assign(static_cast<std::size_t>(tet), 0);
  return mesh;
}

// A prism is split by the numbers a < b < c of its bottom vertices: every side is cut along the diagonal from
// its lower number below to its higher number above, so that neighbours agree.
TetMesh cylinder_mesh(double radius, double length, int rings, int layers) {
  require(rings > 0 && layers > 0, "cylinder_mesh", "needs at least one ring and one layer");
  require(radius > 0 && length > 0 && std::isfinite(radius) && std::isfinite(length), "cylinder_mesh",
          "needs a radius and a length above 0");
  require_countable((3.0 * rings * (rings + 1.0) + 1) * (layers + 1.0), 18.0 * rings * rings * layers,
                    "cylinder_mesh");
  const Index disc = 3 * rings * (rings + 1) + 1;  // vertices
  TetMesh mesh;
  mesh.points.resize(3, disc * (layers + 1));
  for (int k = 0; k <= layers; ++k) place_disc(mesh.points, disc * k, radius, length * k / layers, rings);
  auto triangles = disc_triangles(rings);
  for (auto& triangle : triangles) std::sort(triangle.begin(), triangle.end());
  mesh.tets.resize(4, 3 * static_cast<Index>(triangles.size()) * layers);
  Index tet = 0;
  for (int k = 0; k < layers; ++k)
    for (const auto& triangle : triangles) {
      const Index a = triangle[0] + disc * k, b = triangle[1] + disc * k, c = triangle[2] + disc * k;
      mesh.tets.col(tet++) << a, b, c, c + disc;
      mesh.tets.col(tet++) << a, b, b + disc, c + disc;
      mesh.tets.col(tet++) << a, a + disc, b + disc, c + disc;
    }
  mesh.labels.assign(static_cast<std::size_t>(tet), 0);
  orient(mesh);
  return mesh;
}

namespace {

// A place in the wall: `height` from 0 at the apex to 1 at the base, `depth` from 0 inside to 1 outside.
struct WallPlace {
  double height, depth;
};

class Wall {
 public:
  explicit Wall(const VentricleShape& shape) : shape_(shape) {}

  Vec3d point(const WallPlace& place, double around) const {
    const auto [radius, length] = half_axes(place.depth);
    const double angle = polar_angle(place, length);
    return {radius * std::sin(angle) * std::cos(around), radius * std::sin(angle) * std::sin(around),
            -length * std::cos(angle)};
  }

  Vec3d fibre(const WallPlace& place, double around) const {
    const auto [radius, length] = half_axes(place.depth);
    const double angle = polar_angle(place, length);
    const Vec3d upward = Vec3d(radius * std::cos(angle) * std::cos(around),
                               radius * std::cos(angle) * std::sin(around), length * std::sin(angle))
                             .normalized();
    const Vec3d sideways(-std::sin(around), std::cos(around), 0);
    const double slope = std::lerp(shape_.inner_angle, shape_.outer_angle, place.depth);
    return std::cos(slope) * sideways + std::sin(slope) * upward;
  }

 private:
  std::pair<double, double> half_axes(double depth) const {
    return {std::lerp(shape_.inner_radius, shape_.outer_radius, depth),
            std::lerp(shape_.inner_length, shape_.outer_length, depth)};
  }
  // From the apex, the parameter of the ellipse.
  double polar_angle(const WallPlace& place, double length) const {
    return place.height * std::acos(-shape_.base / length);
  }

  const VentricleShape& shape_;
};

void check(const VentricleShape& s) {
  require(s.inner_radius > 0 && s.outer_radius > s.inner_radius && s.inner_length > 0 &&
              s.outer_length > s.inner_length && std::isfinite(s.outer_radius + s.outer_length),
          "ventricle_mesh", "needs half axes above 0, and those outside larger than those inside");
  require(std::abs(s.base) < s.inner_length, "ventricle_mesh", "needs a base that cuts the inner ellipsoid");
  require(std::isfinite(s.inner_angle + s.outer_angle), "ventricle_mesh", "needs finite angles of fibres");
}

}  // namespace

TetMesh ventricle_mesh(const VentricleShape& shape, int rings, int layers) {
  check(shape);
  TetMesh mesh = cylinder_mesh(1, 1, rings, layers);
  const Wall wall(shape);
  const Mat3X<double> flat = mesh.points;
  const auto place = [](const Vec3d& p) { return WallPlace{p.head<2>().norm(), p.z()}; };
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    mesh.points.col(v) = wall.point(place(flat.col(v)), std::atan2(flat(1, v), flat(0, v)));
  orient(mesh);
  mesh.fibres.resize(3, mesh.tet_count());
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    WallPlace mean{0, 0};
    for (int c = 0; c < 4; ++c) {
      const WallPlace corner = place(flat.col(mesh.tets(c, t)));
      mean.height += corner.height / 4;
      mean.depth += corner.depth / 4;
    }
    const Vec3d centre = tet_points(mesh, t).rowwise().mean();
    mesh.fibres.col(t) = wall.fibre(mean, std::atan2(centre.y(), centre.x()));
  }
  return mesh;
}

}  // namespace lobe
