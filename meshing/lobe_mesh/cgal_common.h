// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// What the translation units that include CGAL share. Private: never included by a public header.
#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Random.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/assertions_behaviour.h>

#include <array>
#include <new>
#include <string>
#include <vector>

#include "lobe_mesh/errors.h"
#include "lobe_mesh/surface.h"

namespace lobe::meshing {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using CgalMesh = CGAL::Surface_mesh<Point>;

struct Soup {
  std::vector<Point> points;
  std::vector<std::array<std::size_t, 3>> triangles;
};

inline Soup to_soup(const Mat3X<double>& points, const Triangles& triangles) {
  Soup soup;
  for (Index i = 0; i < points.cols(); ++i)
    soup.points.emplace_back(points(0, i), points(1, i), points(2, i));
  for (Index t = 0; t < triangles.cols(); ++t) {
    soup.triangles.push_back({static_cast<std::size_t>(triangles(0, t)),
                              static_cast<std::size_t>(triangles(1, t)),
                              static_cast<std::size_t>(triangles(2, t))});
  }
  return soup;
}

// Edges that are not shared by exactly two consistently oriented triangles make CGAL throw: check before.
inline CgalMesh to_cgal(const Mat3X<double>& points, const Triangles& triangles) {
  CgalMesh mesh;
  std::vector<CgalMesh::Vertex_index> vertices;
  for (Index i = 0; i < points.cols(); ++i) {
    vertices.push_back(mesh.add_vertex(Point(points(0, i), points(1, i), points(2, i))));
  }
  for (Index t = 0; t < triangles.cols(); ++t) {
    const auto face =
        mesh.add_face(vertices[triangles(0, t)], vertices[triangles(1, t)], vertices[triangles(2, t)]);
    if (face == CgalMesh::null_face()) {
      throw InputError("triangle " + std::to_string(t), "does not fit the others into a manifold surface");
    }
  }
  return mesh;
}

// Drops vertices without triangles.
inline Surface from_cgal(const CgalMesh& mesh) {
  std::vector<Index> number(mesh.number_of_vertices() + mesh.number_of_removed_vertices(), -1);
  Surface surface;
  surface.triangles.resize(3, mesh.number_of_faces());
  std::vector<Point> used;
  Index t = 0;
  for (const auto face : mesh.faces()) {
    int corner = 0;
    for (const auto vertex : mesh.vertices_around_face(mesh.halfedge(face))) {
      Index& n = number[vertex.idx()];
      if (n < 0) {
        n = static_cast<Index>(used.size());
        used.push_back(mesh.point(vertex));
      }
      surface.triangles(corner++, t) = n;
    }
    ++t;
  }
  surface.points.resize(3, used.size());
  for (std::size_t i = 0; i < used.size(); ++i)
    surface.points.col(i) << used[i].x(), used[i].y(), used[i].z();
  return surface;
}

// What CGAL says: the expression that failed, or else its message, or what the exception says.
inline std::string words_of(const CGAL::Failure_exception& failure) {
  if (!failure.expression().empty()) return failure.expression();
  return failure.message().empty() ? failure.what() : failure.message();
}

// Runs a step of CGAL: always the same random numbers, nothing printed, every failure of a precondition a
// MeshingFailure that names the step.
template <class Step>
auto guarded(const std::string& name, const Step& step) {
  CGAL::get_default_random() = CGAL::Random(0);
  const auto silent = [](const char*, const char*, const char*, int, const char*) {};
  CGAL::set_error_handler(silent);
  CGAL::set_warning_handler(silent);
  try {
    return step();
  } catch (const CGAL::Failure_exception& failure) {
    throw MeshingFailure(name + " failed inside CGAL (" + words_of(failure) + ")");
  } catch (const std::bad_alloc&) {
    throw MeshingFailure(name + " ran out of memory");
  }
}

}  // namespace lobe::meshing
