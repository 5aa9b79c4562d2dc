// Anchors are what friction remembers from step to step: one for each touching point of a triangle.
#pragma once

#include "lobe/mesh/surface.h"

namespace lobe {

struct Anchors {
  struct OfTriangle {
    Index tet = -1;
    std::uint32_t code = 0;  // FaceOwner
    int divisions = 1;       // of its edges: it has divisions² points
    int first = 0;           // of its points below
    static constexpr auto fields =
        std::tuple(&OfTriangle::tet, &OfTriangle::code, &OfTriangle::divisions, &OfTriangle::first);
  };
  std::vector<OfTriangle> triangles;  // in the order of the surface
  std::vector<Vec3d> at;              // what it is of each point [m]
  std::vector<std::uint8_t> holds;    // whether the point has one

  void clear() {
    triangles.clear();
    at.clear();
    holds.clear();
  }
  int add(const FaceOwner& owner, int divisions);  // without any; the number of its first point
  void take_over(const Anchors& old);              // those of triangles that both have
  void let_go() { std::fill(holds.begin(), holds.end(), 0); }

  bool is_valid() const;
  static constexpr auto fields = std::tuple(&Anchors::triangles, &Anchors::at, &Anchors::holds);
};

}  // namespace lobe
