// prepare(): everything the rest of the library takes for granted about a mesh is checked here, once.
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "lobe/error.h"
#include "lobe/mesh/quality.h"
#include "lobe/mesh/tet_mesh.h"
#include "lobe/text.h"

namespace lobe {
namespace {

constexpr double flat_ratio = 1e-7;  // smallest altitude / longest edge below which a tetrahedron is flat

// All offenders of one kind become one fault, which names the first few of them.
class Offenders {
 public:
  // `message` is that of the first offender; it is asked for only once.
  template <class Message>
  void add(Index id, const Message& message) {
    if (ids_.empty()) message_ = message();
    if (ids_.size() < shown) ids_.push_back(id);
    ++count_;
  }

  void report(const std::string& mesh, const char* kind, const char* remedy,
              std::vector<Fault>& faults) const {
    if (ids_.empty()) return;
    std::string message = message_;
    if (count_ > 1) message += " (" + std::to_string(count_) + " such: " + list() + ")";
    faults.push_back({mesh + ": " + kind + " " + std::to_string(ids_.front()), message + "; " + remedy});
  }

 private:
  static constexpr std::size_t shown = 5;

  std::string list() const {
    std::string text;
    for (const Index id : ids_) text += (text.empty() ? "" : ", ") + std::to_string(id);
    return count_ > ids_.size() ? text + ", …" : text;
  }

  std::vector<Index> ids_;
  std::string message_;
  std::size_t count_ = 0;
};

std::string corner_list(const TetMesh& mesh, Index tet) {
  std::string text;
  for (int k = 0; k < 4; ++k) text += (k ? ", " : "") + std::to_string(mesh.tets(k, tet));
  return text;
}

void throw_if_any(std::vector<Fault>& faults) {
  if (!faults.empty()) throw InputError(std::move(faults));
}

void check_sizes(const TetMesh& mesh, const std::string& name) {
  if (mesh.tet_count() == 0)
    throw InputError(name, "has no tetrahedron; a volume mesh of 4-node tetrahedra is expected");
  if (!mesh.labels.empty() && mesh.labels.size() != static_cast<std::size_t>(mesh.tet_count()))
    throw InputError(name, std::to_string(mesh.labels.size()) + " labels for " +
                               std::to_string(mesh.tet_count()) +
                               " tetrahedra; give one per tetrahedron, or none");
  if (mesh.fibres.cols() > 0 && mesh.fibres.cols() != mesh.tet_count())
    throw InputError(name, std::to_string(mesh.fibres.cols()) + " fibre directions for " +
                               std::to_string(mesh.tet_count()) +
                               " tetrahedra; give one per tetrahedron, or none");
  const MeshBodies& bodies = mesh.bodies;
  const bool bodies_fit =
      bodies.names.size() <= MeshBodies::most &&
      bodies.of.size() == (bodies.any() ? static_cast<std::size_t>(mesh.tet_count()) : 0) &&
      std::all_of(bodies.of.begin(), bodies.of.end(), [&](auto body) { return body < bodies.names.size(); });
  if (!bodies_fit)
    throw InputError(name, "its bodies do not fit; give the place of a name per tetrahedron, or none");
}

// Beyond these, in metres, volumes or their products leave the range of double precision.
constexpr double largest_coordinate = 1e50, shortest_edge = 1e-50;

void check_coordinates(const TetMesh& mesh, const std::string& name, std::vector<Fault>& faults) {
  Offenders bad;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3d x = mesh.points.col(v);
    if (x.allFinite() && x.cwiseAbs().maxCoeff() < largest_coordinate) continue;
    bad.add(v, [&] {
      return "its position is (" + rounded(x[0]) + ", " + rounded(x[1]) + ", " + rounded(x[2]) +
             "), expected finite numbers below " + rounded(largest_coordinate);
    });
  }
  bad.report(name, "vertex", "export the mesh anew", faults);
}

void check_corners(const TetMesh& mesh, const std::string& name, std::vector<Fault>& faults) {
  Offenders out_of_range, repeated;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    std::array<Index, 4> c = {mesh.tets(0, t), mesh.tets(1, t), mesh.tets(2, t), mesh.tets(3, t)};
    std::sort(c.begin(), c.end());
    if (c[0] < 0 || c[3] >= mesh.vertex_count())
      out_of_range.add(t, [&] {
        return "its vertices are " + corner_list(mesh, t) + ", expected 0 … " +
               std::to_string(mesh.vertex_count() - 1);
      });
    else if (std::adjacent_find(c.begin(), c.end()) != c.end())
      repeated.add(t, [&] { return "uses a vertex twice: " + corner_list(mesh, t); });
  }
  out_of_range.report(name, "tetrahedron", "the file is damaged or counts its vertices otherwise", faults);
  repeated.report(name, "tetrahedron", "remove it, or mesh the surface anew", faults);
}

// Smallest altitude over longest edge, with the sign of the volume. Taken in units of the longest edge, so
// that neither tiny nor huge coordinates under- or overflow.
double signed_altitude_ratio(const Mat34<double>& corners) {
  double longest = 0;
  for (const auto& [a, b] : edge_corners)
    longest = std::max(longest, (corners.col(a) - corners.col(b)).lpNorm<Eigen::Infinity>());
  if (!(longest > shortest_edge)) return 0;
  const Mat34<double> unit = (corners.colwise() - corners.col(0).eval()) / longest;
  double longest_unit = 0;
  for (const auto& [a, b] : edge_corners)
    longest_unit = std::max(longest_unit, (unit.col(a) - unit.col(b)).norm());
  const auto heights = altitudes(unit);
  const double ratio = *std::min_element(heights.begin(), heights.end()) / longest_unit;
  return std::copysign(ratio, signed_volume(unit));
}

Index orient(TetMesh& mesh, const std::string& name, std::vector<Fault>& faults) {
  Offenders flat;
  Index reoriented = 0;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Mat34<double> corners = tet_points(mesh, t);
    const double ratio = signed_altitude_ratio(corners);
    if (!(std::abs(ratio) >= flat_ratio)) {
      flat.add(t, [&] {
        const auto heights = altitudes(corners);
        return "is flat: its smallest altitude is " +
               rounded(*std::min_element(heights.begin(), heights.end())) + " m, " +
               rounded(std::isfinite(ratio) ? std::abs(ratio) : 0.0) +
               " of its longest edge, must be above 1e-07 of it";
      });
    } else if (ratio < 0) {
      std::swap(mesh.tets(2, t), mesh.tets(3, t));
      ++reoriented;
    }
  }
  flat.report(name, "tetrahedron", "remove it, or improve the mesh (lobe-mesh does)", faults);
  return reoriented;
}

struct SortedCorners {
  std::array<Index, 4> key;
  Index tet;
  bool operator<(const SortedCorners& other) const {
    return std::tie(key, tet) < std::tie(other.key, other.tet);
  }
};

void check_duplicates(const TetMesh& mesh, const std::string& name, std::vector<Fault>& faults) {
  std::vector<SortedCorners> all(static_cast<std::size_t>(mesh.tet_count()));
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    auto& [key, tet] = all[static_cast<std::size_t>(t)];
    key = {mesh.tets(0, t), mesh.tets(1, t), mesh.tets(2, t), mesh.tets(3, t)};
    std::sort(key.begin(), key.end());
    tet = t;
  }
  std::sort(all.begin(), all.end());
  Offenders twice;
  for (std::size_t i = 1; i < all.size(); ++i)
    if (all[i].key == all[i - 1].key)
      twice.add(all[i].tet, [&] {
        return "has the same vertices as tetrahedron " + std::to_string(all[i - 1].tet) + ": " +
               corner_list(mesh, all[i].tet);
      });
  twice.report(name, "tetrahedron",
               "remove the copy (mesh generators write one per group when groups overlap)", faults);
}

struct Face {
  std::array<Index, 3> key;
  Index tet;
  bool operator<(const Face& other) const { return std::tie(key, tet) < std::tie(other.key, other.tet); }
};

void check_faces(const TetMesh& mesh, const std::string& name, std::vector<Fault>& faults) {
  std::vector<Face> all;
  all.reserve(4 * static_cast<std::size_t>(mesh.tet_count()));
  for (Index t = 0; t < mesh.tet_count(); ++t)
    for (const auto& [a, b, c] : face_corners) {
      all.push_back({{mesh.tets(a, t), mesh.tets(b, t), mesh.tets(c, t)}, t});
      std::sort(all.back().key.begin(), all.back().key.end());
    }
  std::sort(all.begin(), all.end());
  Offenders crowded;
  for (std::size_t i = 0, end = 0; i < all.size(); i = end) {
    while (end < all.size() && all[end].key == all[i].key) ++end;
    if (end - i < 3) continue;
    crowded.add(all[i].tet, [&] {
      const auto& [a, b, c] = all[i].key;
      return "its face (" + std::to_string(a) + ", " + std::to_string(b) + ", " + std::to_string(c) +
             ") is shared by " + std::to_string(end - i) + " tetrahedra, among them " +
             std::to_string(all[i + 1].tet) + " and " + std::to_string(all[i + 2].tet) +
             ", expected at most 2";
    });
  }
  crowded.report(name, "tetrahedron", "tetrahedra overlap; mesh the surface anew", faults);
}

Index count_unreferenced(const TetMesh& mesh) {
  std::vector<char> used(static_cast<std::size_t>(mesh.vertex_count()), 0);
  for (const Index v : mesh.tets.reshaped()) used[static_cast<std::size_t>(v)] = 1;
  return static_cast<Index>(std::count(used.begin(), used.end(), 0));
}

}  // namespace

std::vector<std::string> PrepareReport::warnings() const {
  std::vector<std::string> lines;
  if (reoriented)
    lines.push_back(std::to_string(reoriented) + (reoriented == 1 ? " tetrahedron was" : " tetrahedra were") +
                    " inside out and turned round");
  if (unreferenced)
    lines.push_back(std::to_string(unreferenced) +
                    (unreferenced == 1 ? " vertex belongs to no tetrahedron and stays"
                                       : " vertices belong to no tetrahedron and stay") +
                    " at rest");
  return lines;
}

PrepareReport prepare(TetMesh& mesh, const std::string& name) {
  check_sizes(mesh, name);
  std::vector<Fault> faults;
  check_coordinates(mesh, name, faults);
  check_corners(mesh, name, faults);
  throw_if_any(faults);  // what follows needs valid indices and coordinates
  PrepareReport report;
  report.reoriented = orient(mesh, name, faults);
  check_duplicates(mesh, name, faults);
  check_faces(mesh, name, faults);
  throw_if_any(faults);
  report.unreferenced = count_unreferenced(mesh);
  mesh.labels.resize(static_cast<std::size_t>(mesh.tet_count()), 0);
  return report;
}

}  // namespace lobe
