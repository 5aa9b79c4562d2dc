#include "lobe/scene/select.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include "lobe/error.h"
#include "lobe/scene/inside.h"
#include "lobe/scene/nearest_word.h"

namespace lobe {
namespace {

using Mask = std::vector<char>;  // one per vertex or per tetrahedron

std::array<Index, 3> sorted(std::array<Index, 3> triangle) {
  std::sort(triangle.begin(), triangle.end());
  return triangle;
}

std::array<Index, 3> sorted_face(const TetMesh& mesh, const TetFace& face) {
  const int* c = face_corners[face.face];
  return sorted({mesh.tets(c[0], face.tet), mesh.tets(c[1], face.tet), mesh.tets(c[2], face.tet)});
}

Vec3d area_vector(const TetMesh& mesh, const TetFace& face) {
  const auto corner = [&](int k) -> Vec3d {
    return mesh.points.col(mesh.tets(face_corners[face.face][k], face.tet));
  };
  return (corner(1) - corner(0)).cross(corner(2) - corner(0)) / 2;
}

Vec3d centre(const TetMesh& mesh, const TetFace& face) {
  Vec3d sum = Vec3d::Zero();
  for (const int k : face_corners[face.face]) sum += mesh.points.col(mesh.tets(k, face.tet));
  return sum / 3;
}

// The faces of a patch, sorted corners each: spreads from the first face across edges. Faces of one patch
// that meet at an edge only with others (a boundary that touches itself) do not spread there.
std::set<std::array<Index, 3>> triangles_of(const SelectPatch& patch, const TetMesh& mesh) {
  const std::vector<TetFace> faces = outer_faces(mesh);
  std::map<std::pair<Index, Index>, std::vector<std::size_t>> at_edge;
  const auto edge = [&](std::size_t f, int k) -> std::pair<Index, Index> {
    const auto corners = sorted_face(mesh, faces[f]);
    return std::minmax(corners[std::size_t(k)], corners[std::size_t((k + 1) % 3)]);
  };
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (int k = 0; k < 3; ++k) at_edge[edge(f, k)].push_back(f);
  const auto nearest = std::min_element(faces.begin(), faces.end(), [&](const TetFace& a, const TetFace& b) {
    return (centre(mesh, a) - patch.point).squaredNorm() < (centre(mesh, b) - patch.point).squaredNorm();
  });
  std::vector<char> chosen(faces.size(), 0);
  std::vector<std::size_t> queue{std::size_t(nearest - faces.begin())};
  chosen[queue.front()] = 1;
  const double least = std::cos(patch.angle * std::numbers::pi / 180) - 1e-12;
  std::set<std::array<Index, 3>> triangles;
  for (std::size_t at = 0; at < queue.size(); ++at) {
    const std::size_t face = queue[at];
    triangles.insert(sorted_face(mesh, faces[face]));
    const Vec3d n = area_vector(mesh, faces[face]).normalized();
    for (int k = 0; k < 3; ++k)
      for (const std::size_t other : at_edge[edge(face, k)]) {
        if (chosen[other] || n.dot(area_vector(mesh, faces[other]).normalized()) < least) continue;
        chosen[other] = 1;
        queue.push_back(other);
      }
  }
  return triangles;
}

std::set<std::array<Index, 3>> sorted_triangles(const SelectSurface& select, const std::string& place) {
  if (!select.is_bound)
    throw InputError(place + "/surface", "surfaces are known only where the mesh is read from a file");
  std::set<std::array<Index, 3>> triangles;
  for (const auto& triangle : select.triangles) triangles.insert(sorted(triangle));
  return triangles;
}

std::size_t body_called(const std::string& name, const MeshBodies& bodies, const std::string& place) {
  const auto found = std::find(bodies.names.begin(), bodies.names.end(), name);
  if (found != bodies.names.end()) return std::size_t(found - bodies.names.begin());
  if (!bodies.any())
    throw InputError(place + "/body",
                     "\"" + name + "\": the scene has one mesh, and no \"bodies\" with names");
  std::string text = "no body is called \"" + name + "\"; there are";
  for (const std::string& known : bodies.names)
    text += (known == bodies.names[0] ? " \"" : ", \"") + known + "\"";
  const std::string nearest = nearest_word(name, bodies.names);
  if (!nearest.empty()) text += "; did you mean \"" + nearest + "\"?";
  throw InputError(place + "/body", text);
}

// Evaluates a selector on the points of one kind of item: vertices, or barycentres of tetrahedra.
class Evaluation {
 public:
  enum class Kind { vertices, tets };

  Evaluation(const TetMesh& mesh, Kind kind) : mesh_(mesh), kind_(kind) {
    if (kind == Kind::vertices) {
      points_ = mesh.points;
    } else {
      points_.resize(3, mesh.tet_count());
      for (Index t = 0; t < mesh.tet_count(); ++t) points_.col(t) = barycentre(mesh, t);
    }
  }

  Mask mask(const Selector& selector, const std::string& place) const {
    return std::visit([&](const auto& select) { return mask(select, place); }, selector.value);
  }

  Mask in_use() const {
    if (kind_ == Kind::tets) return Mask(size(), 1);
    Mask used(size(), 0);
    for (Index t = 0; t < mesh_.tet_count(); ++t) mark_corners(t, used);
    return used;
  }

 private:
  std::size_t size() const { return static_cast<std::size_t>(points_.cols()); }

  template <class Test>
  Mask where(const Test& test) const {
    Mask chosen(size());
    for (std::size_t i = 0; i < size(); ++i) chosen[i] = test(points_.col(static_cast<Index>(i)));
    return chosen;
  }

  Mask mask(const SelectAll&, const std::string&) const { return Mask(size(), 1); }

  Mask mask(const SelectBox& box, const std::string&) const {
    return where([&](const Vec3d& X) { return is_inside(box, X); });
  }

  Mask mask(const SelectSphere& sphere, const std::string&) const {
    return where([&](const Vec3d& X) { return is_inside(sphere, X); });
  }

  Mask mask(const SelectPlane& plane, const std::string&) const {
    return where([&](const Vec3d& X) { return is_inside(plane, X); });
  }

  // Equal distances: the lower index first.
  Mask mask(const SelectNearest& nearest, const std::string&) const {
    const Mask used = in_use();
    std::vector<std::pair<double, std::size_t>> candidates;
    for (std::size_t i = 0; i < size(); ++i) {
      if (used[i]) candidates.push_back({(points_.col(static_cast<Index>(i)) - nearest.point).norm(), i});
    }
    const std::size_t count =
        std::min(candidates.size(), static_cast<std::size_t>(std::max(0, nearest.count)));
    const auto end = candidates.begin() + static_cast<std::ptrdiff_t>(count);
    std::partial_sort(candidates.begin(), end, candidates.end());
    Mask chosen(size(), 0);
    for (auto it = candidates.begin(); it != end; ++it) chosen[it->second] = 1;
    return chosen;
  }

  Mask mask(const SelectLabel& select, const std::string& place) const {
    if (!select.names.empty())
      throw InputError(place + "/label", "names of labels are known only where the mesh is read from a file");
    Mask tets(static_cast<std::size_t>(mesh_.tet_count()), 0);
    for (std::size_t t = 0; t < tets.size() && t < mesh_.labels.size(); ++t) {
      tets[t] = std::find(select.labels.begin(), select.labels.end(), mesh_.labels[t]) != select.labels.end();
    }
    return kind_ == Kind::tets ? tets : corners_of(tets);
  }

  Mask mask(const SelectBody& select, const std::string& place) const {
    std::vector<char> is_chosen(mesh_.bodies.count(), 0);
    for (const std::string& name : select.names) is_chosen[body_called(name, mesh_.bodies, place)] = 1;
    Mask tets(static_cast<std::size_t>(mesh_.tet_count()), 0);
    for (Index t = 0; t < mesh_.tet_count(); ++t)
      tets[std::size_t(t)] = is_chosen[std::size_t(mesh_.bodies.body_of(t))];
    return kind_ == Kind::tets ? tets : corners_of(tets);
  }

  Mask mask(const SelectTetrahedra& select, const std::string& place) const {
    const Mask tets = listed(select.tetrahedra, mesh_.tet_count(), "tetrahedra", place);
    return kind_ == Kind::tets ? tets : corners_of(tets);
  }

  Mask mask(const SelectVertices& select, const std::string& place) const {
    const Mask vertices = listed(select.vertices, mesh_.vertex_count(), "vertices", place);
    if (kind_ == Kind::vertices) return vertices;
    Mask tets(size());
    for (Index t = 0; t < mesh_.tet_count(); ++t) {
      const auto corners = mesh_.tets.col(t);
      tets[static_cast<std::size_t>(t)] = std::all_of(corners.begin(), corners.end(), [&](Index v) {
        return vertices[static_cast<std::size_t>(v)] != 0;
      });
    }
    return tets;
  }

  Mask mask(const SelectSurface& select, const std::string& place) const {
    return having(sorted_triangles(select, place));
  }
  Mask mask(const SelectPatch& patch, const std::string&) const { return having(triangles_of(patch, mesh_)); }

  // Vertices or tetrahedra of these faces.
  Mask having(const std::set<std::array<Index, 3>>& triangles) const {
    Mask chosen(size(), 0);
    if (kind_ == Kind::vertices) {
      for (const auto& triangle : triangles)
        for (const Index v : triangle) chosen[std::size_t(v)] = 1;
      return chosen;
    }
    for (Index t = 0; t < mesh_.tet_count(); ++t)
      for (int face = 0; face < 4; ++face)
        if (triangles.contains(sorted_face(mesh_, {t, face}))) chosen[std::size_t(t)] = 1;
    return chosen;
  }

  Mask mask(const SelectAnyOf& any, const std::string& place) const {
    Mask chosen(size(), 0);
    for (std::size_t i = 0; i < any.parts.size(); ++i) {
      const Mask part = mask(any.parts[i], place + "/any_of/" + std::to_string(i));
      for (std::size_t k = 0; k < chosen.size(); ++k) chosen[k] |= part[k];
    }
    return chosen;
  }

  Mask mask(const SelectAllOf& all, const std::string& place) const {
    Mask chosen(size(), 1);
    for (std::size_t i = 0; i < all.parts.size(); ++i) {
      const Mask part = mask(all.parts[i], place + "/all_of/" + std::to_string(i));
      for (std::size_t k = 0; k < chosen.size(); ++k) chosen[k] &= part[k];
    }
    return chosen;
  }

  Mask mask(const SelectNot& negated, const std::string& place) const {
    Mask chosen = mask(negated.part.at(0), place + "/not");
    for (char& item : chosen) item = !item;
    return chosen;
  }

  Mask listed(const std::vector<Index>& items, Index count, const std::string& what,
              const std::string& place) const {
    Mask chosen(static_cast<std::size_t>(count), 0);
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (items[i] < 0 || items[i] >= count) {
        throw InputError(place + "/" + what + "/" + std::to_string(i),
                         std::to_string(items[i]) + ", must be from 0 to " + std::to_string(count - 1) +
                             ": the mesh has " + std::to_string(count) + " " + what);
      }
      chosen[static_cast<std::size_t>(items[i])] = 1;
    }
    return chosen;
  }

  void mark_corners(Index tet, Mask& vertices) const {
    for (int k = 0; k < 4; ++k) vertices[static_cast<std::size_t>(mesh_.tets(k, tet))] = 1;
  }

  Mask corners_of(const Mask& tets) const {
    Mask vertices(static_cast<std::size_t>(mesh_.vertex_count()), 0);
    for (std::size_t t = 0; t < tets.size(); ++t) {
      if (tets[t]) mark_corners(static_cast<Index>(t), vertices);
    }
    return vertices;
  }

  const TetMesh& mesh_;
  Kind kind_;
  Mat3X<double> points_;  // 3 × #items [m]
};

Mask vertex_mask(const Selector& selector, const TetMesh& mesh, const std::string& place) {
  const Evaluation evaluation(mesh, Evaluation::Kind::vertices);
  Mask chosen = evaluation.mask(selector, place);
  const Mask used = evaluation.in_use();
  for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i] &= used[i];
  return chosen;
}

std::vector<Index> indices(const Mask& mask) {
  std::vector<Index> list;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask[i]) list.push_back(static_cast<Index>(i));
  }
  return list;
}

}  // namespace

std::vector<Index> select_vertices(const Selector& selector, const TetMesh& mesh, const std::string& place) {
  return indices(vertex_mask(selector, mesh, place));
}

std::vector<Index> select_tets(const Selector& selector, const TetMesh& mesh, const std::string& place) {
  return indices(Evaluation(mesh, Evaluation::Kind::tets).mask(selector, place));
}

namespace {

bool names_surface(const Selector& selector) {
  const auto any = [](const std::vector<Selector>& parts) {
    return std::any_of(parts.begin(), parts.end(), names_surface);
  };
  if (std::holds_alternative<SelectSurface>(selector.value)) return true;
  if (std::holds_alternative<SelectPatch>(selector.value)) return true;
  if (const auto* some = std::get_if<SelectAnyOf>(&selector.value)) return any(some->parts);
  if (const auto* all = std::get_if<SelectAllOf>(&selector.value)) return any(all->parts);
  const auto* negated = std::get_if<SelectNot>(&selector.value);
  return negated && any(negated->part);
}

// Selects faces: those of a surface one by one, others by their three vertices.
class FaceEvaluation {
 public:
  FaceEvaluation(const TetMesh& mesh, const std::vector<TetFace>& faces) : mesh_(mesh), faces_(faces) {}

  Mask mask(const Selector& selector, const std::string& place) const {
    if (!names_surface(selector)) return by_vertices(selector, place);
    if (const auto* surface = std::get_if<SelectSurface>(&selector.value)) {
      const auto triangles = sorted_triangles(*surface, place);
      return where([&](const TetFace& face) { return triangles.contains(sorted_face(mesh_, face)); });
    }
    if (const auto* patch = std::get_if<SelectPatch>(&selector.value)) {
      const auto triangles = triangles_of(*patch, mesh_);
      return where([&](const TetFace& face) { return triangles.contains(sorted_face(mesh_, face)); });
    }
    if (const auto* any = std::get_if<SelectAnyOf>(&selector.value))
      return combined(any->parts, place + "/any_of/", [](char a, char b) { return char(a | b); });
    if (const auto* all = std::get_if<SelectAllOf>(&selector.value))
      return combined(all->parts, place + "/all_of/", [](char a, char b) { return char(a & b); });
    Mask chosen = mask(std::get<SelectNot>(selector.value).part.at(0), place + "/not");
    for (char& item : chosen) item = !item;
    return chosen;
  }

 private:
  template <class Test>
  Mask where(const Test& test) const {
    Mask chosen;
    for (const TetFace& face : faces_) chosen.push_back(test(face));
    return chosen;
  }
  Mask by_vertices(const Selector& selector, const std::string& place) const {
    const Mask chosen = vertex_mask(selector, mesh_, place);
    return where([&](const TetFace& face) {
      const auto corners = sorted_face(mesh_, face);
      return std::all_of(corners.begin(), corners.end(),
                         [&](Index v) { return chosen[std::size_t(v)] != 0; });
    });
  }
  template <class Join>
  Mask combined(const std::vector<Selector>& parts, const std::string& list, const Join& join) const {
    Mask chosen = mask(parts.at(0), list + "0");
    for (std::size_t i = 1; i < parts.size(); ++i) {
      const Mask part = mask(parts[i], list + std::to_string(i));
      for (std::size_t k = 0; k < chosen.size(); ++k) chosen[k] = join(chosen[k], part[k]);
    }
    return chosen;
  }

  const TetMesh& mesh_;
  const std::vector<TetFace>& faces_;
};

}  // namespace

std::vector<TetFace> select_faces(const Selector& selector, const TetMesh& mesh,
                                  const std::vector<TetFace>& faces, const std::string& place) {
  const Mask chosen = FaceEvaluation(mesh, faces).mask(selector, place);
  std::vector<TetFace> selected;
  for (std::size_t i = 0; i < faces.size(); ++i)
    if (chosen[i]) selected.push_back(faces[i]);
  return selected;
}

}  // namespace lobe
