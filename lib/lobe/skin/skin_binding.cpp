#include "lobe/skin/skin_binding.h"

#include <array>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include "lobe/error.h"

namespace lobe {
namespace {

void check_corners(const Triangles& corners, const Triangles& triangles, Index least, Eigen::Index count,
                   const std::string& what) {
  if (corners.cols() != triangles.cols())
    throw InputError("skin", "the " + what + "s of its corners are for " + std::to_string(corners.cols()) +
                                 " triangles, expected " + std::to_string(triangles.cols()));
  for (Eigen::Index t = 0; t < corners.cols(); ++t)
    if (corners.col(t).minCoeff() < least || corners.col(t).maxCoeff() >= count)
      throw InputError("skin: triangle " + std::to_string(t), "a corner's " + what + " is not within " +
                                                                  std::to_string(least) + " … " +
                                                                  std::to_string(count - 1));
}

// Adds the carried vertices first, one for each normal of a point, and then those that differ in texture
// only.
void add_vertices(const TexturedSurface& surface, SkinBinding& binding, SkinMesh& drawn) {
  using Normal = std::array<double, 3>;
  const auto count = static_cast<Index>(surface.triangles.cols());
  std::map<std::pair<Index, Normal>, Index> carried;
  binding.corners.resize(3, count);
  for (Index i = 0; i < 3 * count; ++i) {
    const Index point = surface.triangles.data()[i], n = surface.normal_of.data()[i];
    Normal normal{};
    if (n >= 0) Eigen::Map<Vec3d>(normal.data()) = surface.normals.col(n);
    const auto [at, is_new] = carried.emplace(std::pair(point, normal), drawn.vertex_count());
    if (is_new) drawn.file_vertex.push_back(point);
    binding.corners.data()[i] = at->second;
  }
  binding.points = surface.points(Eigen::all, drawn.file_vertex);
}

void add_texture(const TexturedSurface& surface, SkinBinding& binding, SkinMesh& drawn) {
  const auto count = static_cast<Index>(surface.triangles.cols());
  const Index carried_count = drawn.vertex_count();
  using Textured = std::tuple<Index, double, double>;
  std::vector<Eigen::Vector2d> texture(std::size_t(carried_count), Eigen::Vector2d::Zero());
  std::vector<std::uint8_t> has_texture(std::size_t(carried_count), 0);
  std::map<Textured, Index> number_of;
  for (Index t = 0; t < count; ++t) {
    Eigen::Vector3i& triangle = drawn.triangles.emplace_back(binding.corners.col(t));
    drawn.file_triangle.push_back(t);
    for (int c = 0; c < 3; ++c) {
      const Index vertex = binding.corners(c, t), coordinate = surface.texture_of(c, t);
      if (coordinate < 0) continue;
      const Eigen::Vector2d st = surface.texture.col(coordinate);
      const Index next = has_texture[vertex] ? Index(texture.size()) : vertex;
      const auto [at, is_new] = number_of.emplace(Textured{vertex, st[0], st[1]}, next);
      triangle[c] = at->second;
      if (!is_new) continue;
      if (next == vertex) {
        texture[vertex] = st;
        has_texture[vertex] = 1;
      } else {
        texture.push_back(st);
        binding.copied_from.push_back(vertex);
        drawn.file_vertex.push_back(Index(drawn.file_vertex[vertex]));
      }
    }
  }
  for (const Eigen::Vector2d& st : texture) drawn.texture.push_back(st.cast<float>());
}

}  // namespace

SkinBinding bind(const TexturedSurface& surface, const TetMesh& mesh, SkinMesh& drawn) {
  check_corners(surface.triangles, surface.triangles, 0, surface.points.cols(), "point");
  check_corners(surface.texture_of, surface.triangles, -1, surface.texture.cols(), "texture coordinate");
  check_corners(surface.normal_of, surface.triangles, -1, surface.normals.cols(), "normal");
  if (surface.triangles.cols() == 0) throw InputError("skin", "has no triangle");
  if (mesh.tet_count() == 0) throw InputError("skin", "the body has no tetrahedron that could carry it");
  SkinBinding binding;
  binding.start = mesh;
  add_vertices(surface, binding, drawn);
  add_texture(surface, binding, drawn);
  binding.lies_on = tets_under(binding.points, binding.corners, binding.start);
  binding.lying_on = inverse(binding.lies_on, binding.start.tet_count());
  NumberLists corners;
  for (const auto& triangle : binding.corners.colwise()) corners.append({triangle.data(), 3});
  binding.around = inverse(corners, binding.carried_count());
  return binding;
}

}  // namespace lobe
