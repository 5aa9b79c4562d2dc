#include <numbers>

#include "organs.h"

namespace organs {
namespace {

constexpr double radius = 0.02;  // [m]
constexpr double length = 0.1;   // [m]
constexpr int rings = 6;  // of a disc; ring r has 6 r vertices, so that triangles are almost equilateral
constexpr int around = 6 * rings;
constexpr int layers = 33;  // of the wall

// Vertex j of ring r of a disc whose vertices are numbered from its centre outwards.
int disc_vertex(int r, int j) { return r == 0 ? 0 : 1 + 3 * r * (r - 1) + j % (6 * r); }
constexpr int disc_size = 1 + 3 * rings * (rings + 1);

void add_disc(Surface& surface, double z, double turn, bool upwards) {
  const int first = static_cast<int>(surface.points.size());
  surface.points.emplace_back(0, 0, z);
  for (int r = 1; r <= rings; ++r) {
    for (int j = 0; j < 6 * r; ++j) {
      const double angle = 2 * std::numbers::pi * (j + turn * r / rings) / (6 * r);
      const double distance = radius * r / rings;
      surface.points.emplace_back(distance * std::cos(angle), distance * std::sin(angle), z);
    }
  }
  const auto add = [&](int a, int b, int c) {
    if (!upwards) std::swap(b, c);
    surface.triangles.push_back({first + a, first + b, first + c});
  };
  for (int r = 1; r <= rings; ++r) {
    for (int sector = 0; sector < 6; ++sector) {
      for (int i = 0; i < r; ++i) {
        const int outer = sector * r + i;
        const int inner = sector * (r - 1) + i;
        add(disc_vertex(r - 1, inner), disc_vertex(r, outer), disc_vertex(r, outer + 1));
        if (i + 1 < r)
          add(disc_vertex(r - 1, inner), disc_vertex(r, outer + 1), disc_vertex(r - 1, inner + 1));
      }
    }
  }
}

}  // namespace

// Two discs of hexagonal rings; between their rims a wall of layers, each turned by half a triangle against
// the one below.
Surface cylinder() {
  Surface surface;
  add_disc(surface, 0, 0, false);
  add_disc(surface, length, layers % 2 * 0.5, true);
  const int rim = disc_vertex(rings, 0);
  const int wall = static_cast<int>(surface.points.size());
  for (int layer = 1; layer < layers; ++layer) {
    for (int j = 0; j < around; ++j) {
      const double angle = 2 * std::numbers::pi * (j + layer % 2 * 0.5) / around;
      surface.points.emplace_back(radius * std::cos(angle), radius * std::sin(angle),
                                  length * layer / layers);
    }
  }
  const auto vertex = [&](int layer, int j) {
    if (layer == 0) return rim + j % around;
    return layer == layers ? disc_size + rim + j % around : wall + (layer - 1) * around + j % around;
  };
  for (int layer = 0; layer < layers; ++layer) {
    const int shift = layer % 2;  // where the layer above starts half a triangle later, or earlier
    for (int j = 0; j < around; ++j) {
      const int a = vertex(layer, j), b = vertex(layer, j + 1);
      const int c = vertex(layer + 1, j), d = vertex(layer + 1, j + 1);
      if (shift == 0) {
        surface.triangles.push_back({a, b, c});
        surface.triangles.push_back({b, d, c});
      } else {
        surface.triangles.push_back({a, b, d});
        surface.triangles.push_back({a, d, c});
      }
    }
  }
  return surface;
}

}  // namespace organs
