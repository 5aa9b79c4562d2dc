#include "held_parts.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "lobe/error.h"
#include "lobe/mesh/outer_faces.h"
#include "lobe/scene/unit_checks.h"
#include "lobe/text.h"

namespace lobe::program {
namespace {

using Json = nlohmann::ordered_json;

constexpr double slab = 0.1;             // of the body's extent: what counts as one of its sides
constexpr double depth = 0.05;           // of the body's extent: what of a side is held
constexpr double pin_radius = 0.02;      // of the body's diagonal
constexpr std::size_t least_of_pin = 4;  // vertices
constexpr double farthest_pin = 0.1;     // of the body's diagonal, from its nearest vertex
constexpr const char* no_side = "none";

struct Side {
  const char* name;
  int axis, sign;
  Vec3d normal() const { return sign * Vec3d::Unit(axis); }
};
constexpr std::array<Side, 6> sides{
    {{"x-", 0, -1}, {"x+", 0, 1}, {"y-", 1, -1}, {"y+", 1, 1}, {"z-", 2, -1}, {"z+", 2, 1}}};

Mat3<double> corners_of(const TetMesh& mesh, const TetFace& face) {
  const int* c = face_corners[face.face];
  Mat3<double> x;
  for (int k = 0; k < 3; ++k) x.col(k) = mesh.points.col(mesh.tets(c[k], face.tet));
  return x;
}

// How much of the boundary within the outer tenth of the body faces to a side [m²].
double breadth(const TetMesh& mesh, const std::vector<TetFace>& boundary, const Side& side) {
  const Vec3d n = side.normal();
  const Box box = bounding_box(mesh);
  const double end = std::max(n.dot(box.min), n.dot(box.max)),
               begin = end - slab * (box.max - box.min)[side.axis];
  double sum = 0;
  for (const TetFace& face : boundary) {
    const Mat3<double> x = corners_of(mesh, face);
    if ((n.transpose() * x).minCoeff() < begin) continue;
    sum += std::max(0.0, n.dot((x.col(1) - x.col(0)).cross(x.col(2) - x.col(0))) / 2);
  }
  return sum;
}

const Side& chosen_side(const MakeSceneOptions& options, const TetMesh& mesh,
                        const std::vector<TetFace>& boundary) {
  if (options.hold.empty())
    return *std::max_element(sides.begin(), sides.end(), [&](const Side& a, const Side& b) {
      return breadth(mesh, boundary, a) < breadth(mesh, boundary, b);
    });
  return *std::find_if(sides.begin(), sides.end(),
                       [&](const Side& side) { return options.hold == side.name; });
}

// The height of a plane beyond which a twentieth of the body's extent lies, or more where that has too few
// vertices or, for springs, no whole face.
double height_of_plane(const TetMesh& mesh, const std::vector<TetFace>& boundary, const Vec3d& n,
                       bool needs_faces) {
  std::vector<double> heights(static_cast<std::size_t>(mesh.vertex_count()));
  for (Index v = 0; v < mesh.vertex_count(); ++v) heights[std::size_t(v)] = n.dot(mesh.points.col(v));
  std::sort(heights.begin(), heights.end(), std::greater<>());
  const double extent = heights.front() - heights.back();
  const std::size_t least = std::min(heights.size(), std::max<std::size_t>(8, heights.size() / 50));
  double height = std::min(heights.front() - depth * extent, heights[least - 1] - 1e-6 * extent);
  const auto has_face = [&] {
    return std::any_of(boundary.begin(), boundary.end(), [&](const TetFace& face) {
      return (n.transpose() * corners_of(mesh, face)).minCoeff() >= height;
    });
  };
  while (needs_faces && height > heights.back() && !has_face()) height -= depth * extent;
  return height;
}

// A ball with some vertices, even where these are far apart.
HeldParts::Pin pin_at(const Vec3d& center, const TetMesh& mesh) {
  const double diagonal = box_diagonal(mesh);
  std::vector<double> distances(static_cast<std::size_t>(mesh.vertex_count()));
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    distances[std::size_t(v)] = (mesh.points.col(v) - center).norm();
  std::sort(distances.begin(), distances.end());
  if (distances.front() > farthest_pin * diagonal)
    throw InputError("--pin", rounded(center.x()) + "," + rounded(center.y()) + "," + rounded(center.z()) +
                                  " is " + rounded(distances.front()) +
                                  " m from the body: pins are given in metres, at the body at rest");
  const double enough = distances[std::min(least_of_pin, distances.size()) - 1];
  return {center, std::max(pin_radius * diagonal, (1 + 1e-3) * enough)};
}

// A number as people write it: four digits.
double four_digits(double value) { return std::stod(rounded(value)); }

Json triple(const Vec3d& v) {
  const Vec3d no_minus = v + Vec3d::Zero();  // −0 + 0 = 0
  return {no_minus[0], no_minus[1], no_minus[2]};
}

}  // namespace

std::vector<std::string> names_of_sides() {
  std::vector<std::string> names;
  for (const Side& side : sides) names.emplace_back(side.name);
  names.emplace_back(no_side);
  return names;
}

HeldParts find_held_parts(const MakeSceneOptions& options, const TetMesh& mesh) {
  HeldParts parts;
  for (const Vec3d& pin : options.pins) parts.pins.push_back(pin_at(pin, mesh));
  if (options.hold == no_side) return parts;
  const std::vector<TetFace> boundary = outer_faces(mesh);
  const Side& side = chosen_side(options, mesh, boundary);
  parts.side = side.name;
  parts.normal = side.normal();
  parts.springs = options.springs;
  const double height = height_of_plane(mesh, boundary, parts.normal, parts.springs > 0);
  parts.point = height * parts.normal;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    parts.vertices += parts.normal.dot(mesh.points.col(v)) >= height ? 1 : 0;
  return parts;
}

void write_held_parts(const HeldParts& parts, Json& scene) {
  Json boundary = Json::array();
  const Json beyond{
      {"plane", {{"point", triple(parts.point)}, {"normal", triple(parts.normal)}, {"side", "above"}}}};
  if (parts.side && parts.springs == 0) boundary.push_back({{"fix", true}, {"where", beyond}});
  for (const HeldParts::Pin& pin : parts.pins)
    boundary.push_back(
        {{"fix", true},
         {"where", {{"sphere", {{"center", triple(pin.center)}, {"radius", four_digits(pin.radius)}}}}}});
  if (!boundary.empty()) scene["boundary"] = boundary;
  if (parts.side && parts.springs > 0)
    scene["attachments"] = {
        {{"name", "springs"}, {"bed", {{"from", beyond}, {"to_world", true}, {"stiffness", parts.springs}}}}};
}

std::vector<std::string> words_of(const HeldParts& parts, const MakeSceneOptions& options) {
  std::vector<std::string> lines;
  const std::string chosen = options.hold.empty() ? ", the broadest one" : "";
  if (parts.side)
    lines.push_back(std::to_string(parts.vertices) + " vertices at the side " + parts.side + chosen +
                    " (--hold)" +
                    (parts.springs > 0 ? ", on springs of " + rounded(parts.springs) + " Pa/m" : ""));
  for (const HeldParts::Pin& pin : parts.pins)
    lines.push_back("a pin of radius " + rounded(pin.radius) + " m at (" + rounded(pin.center.x()) + ", " +
                    rounded(pin.center.y()) + ", " + rounded(pin.center.z()) + ") m");
  return lines;
}

}  // namespace lobe::program
