#include "meshing/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "lobe/io/surface_io.h"
#include "lobe_mesh/diagnose.h"
#include "near.h"

namespace lobe::meshing {
namespace {

Surface surface_of(const std::vector<Vec3d>& points, const std::vector<std::array<Index, 3>>& triangles) {
  Surface surface;
  surface.points.resize(3, static_cast<Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) surface.points.col(static_cast<Index>(i)) = points[i];
  surface.triangles.resize(3, static_cast<Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k)
      surface.triangles(k, static_cast<Index>(t)) = triangles[t][static_cast<std::size_t>(k)];
  }
  return surface;
}

}  // namespace

Surface make_cube(double side) {
  std::vector<Vec3d> points;
  for (int i = 0; i < 8; ++i) points.emplace_back(side * (i & 1), side * (i >> 1 & 1), side * (i >> 2));
  return surface_of(points, {{0, 2, 3},
                             {0, 3, 1},
                             {4, 5, 7},
                             {4, 7, 6},
                             {0, 1, 5},
                             {0, 5, 4},
                             {2, 6, 7},
                             {2, 7, 3},
                             {0, 4, 6},
                             {0, 6, 2},
                             {1, 3, 7},
                             {1, 7, 5}});
}

Surface make_sphere(double radius, int subdivisions) {
  const double g = std::numbers::phi;
  std::vector<Vec3d> points{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                            {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<std::array<Index, 3>> triangles{{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                              {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                              {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                              {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int s = 0; s < subdivisions; ++s) {
    std::map<std::pair<Index, Index>, Index> middle;
    const auto between = [&](Index a, Index b) {
      const auto [entry, is_new] = middle.try_emplace(std::minmax(a, b), static_cast<Index>(points.size()));
      if (is_new)
        points.push_back((points[static_cast<std::size_t>(a)] + points[static_cast<std::size_t>(b)]) / 2);
      return entry->second;
    };
    std::vector<std::array<Index, 3>> finer;
    for (const auto& [a, b, c] : triangles) {
      const Index ab = between(a, b), bc = between(b, c), ca = between(c, a);
      for (const auto& t : {std::array{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}})
        finer.push_back(t);
    }
    triangles = finer;
    for (Vec3d& p : points) p = p.normalized() * radius;
  }
  for (Vec3d& p : points) p = p.normalized() * radius;
  return surface_of(points, triangles);
}

Surface make_cylinder(double radius, double height, int segments) {
  std::vector<Vec3d> points{{0, 0, 0}, {0, 0, height}};
  std::vector<std::array<Index, 3>> triangles;
  for (int i = 0; i < segments; ++i) {
    const double angle = 2 * std::numbers::pi * i / segments;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), height);
    const Index a = 2 + 2 * i, b = 2 + 2 * ((i + 1) % segments);
    for (const auto& t :
         {std::array<Index, 3>{0, b, a}, {1, a + 1, b + 1}, {a, b, b + 1}, {a, b + 1, a + 1}}) {
      triangles.push_back(t);
    }
  }
  return surface_of(points, triangles);
}

Surface joined(const Surface& a, const Surface& b) {
  Surface both;
  both.points.resize(3, a.point_count() + b.point_count());
  both.points << a.points, b.points;
  both.triangles.resize(3, a.triangle_count() + b.triangle_count());
  both.triangles << a.triangles, (b.triangles.array() + a.point_count()).matrix();
  return both;
}

Surface moved(Surface surface, const Vec3d& by) {
  surface.points.colwise() += by;
  return surface;
}

Surface scaled(Surface surface, double factor) {
  surface.points *= factor;
  return surface;
}

Surface inverted(Surface surface) {
  surface.triangles.row(1).swap(surface.triangles.row(2));
  return surface;
}

Surface without_triangle(const Surface& surface, Index triangle) {
  Surface rest = surface;
  rest.triangles.col(triangle) = rest.triangles.col(surface.triangle_count() - 1).eval();
  rest.triangles.conservativeResize(3, surface.triangle_count() - 1);
  return rest;
}

std::filesystem::path SurfaceFolder::write(const std::string& name, const Surface& surface) const {
  write_surface(path / name, surface.points, surface.triangles);
  return path / name;
}

namespace {

// The faces that belong to one tetrahedron; checks the others.
Surface boundary_of(const TetMesh& mesh) {
  std::map<std::array<Index, 3>, std::vector<std::array<Index, 3>>> faces;
  for (const auto& tet : mesh.tets.colwise()) {
    for (const auto& face : face_corners) {
      const std::array<Index, 3> corners{tet[face[0]], tet[face[1]], tet[face[2]]};
      auto key = corners;
      std::sort(key.begin(), key.end());
      faces[key].push_back(corners);
    }
  }
  const auto turned =
      [](const std::array<Index, 3>& f) {  // 1 if f is an even permutation of its sorted corners
        return (f[0] < f[1]) == ((f[1] < f[2]) == (f[0] < f[2]));
      };
  std::vector<std::array<Index, 3>> boundary;
  for (const auto& [key, uses] : faces) {
    REQUIRE(uses.size() <= 2);
    if (uses.size() == 1)
      boundary.push_back(uses.front());
    else
      CHECK(turned(uses[0]) != turned(uses[1]));
  }
  Surface surface{mesh.points, {}};
  surface.triangles.resize(3, static_cast<Index>(boundary.size()));
  for (std::size_t t = 0; t < boundary.size(); ++t) {
    for (int k = 0; k < 3; ++k)
      surface.triangles(k, static_cast<Index>(t)) = boundary[t][static_cast<std::size_t>(k)];
  }
  return surface;
}

}  // namespace

void check_faces(const TetMesh& mesh) {
  CHECK(enclosed_volume(boundary_of(mesh)) == test::near(total_volume(mesh), 1e-9));
}

void check_boundary(const TetMesh& mesh) {
  const Diagnosis diagnosis = diagnose(boundary_of(mesh));
  CHECK(diagnosis.closed());
  CHECK(diagnosis.non_manifold_points.count == 0);
  CHECK(diagnosis.self_intersections.count == 0);
}

}  // namespace lobe::meshing
