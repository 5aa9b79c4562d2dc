#include "lobe/scene/select_shares.h"

#include <Eigen/Geometry>
#include <functional>
#include <type_traits>

#include "lobe/assert.h"
#include "lobe/error.h"
#include "lobe/scene/inside.h"
#include "lobe/scene/select.h"

namespace lobe {
namespace {

struct PointOnMesh {
  Vec3d X;
  Index tet = 0, face = -1;  // a tetrahedron; by area the number of a boundary face
};
using Contains = std::function<bool(const PointOnMesh&)>;

// ---- Whether points lie in a selection

class ShareSelection {
 public:
  ShareSelection(const TetMesh& mesh, const std::vector<TetFace>& faces, HoldBy by)
      : mesh_(mesh), faces_(faces), by_(by) {}

  Contains test(const Selector& selector, const std::string& place) const {
    return std::visit([&](const auto& select) { return test_of(select, place); }, selector.value);
  }

 private:
  Contains test_of(const SelectAll&, const std::string&) const {
    return [](const PointOnMesh&) { return true; };
  }
  template <class Region>
  Contains test_of(const Region& region, const std::string&) const requires requires(Vec3d X) {
    is_inside(region, X);
  }
  {
    return [region](const PointOnMesh& at) { return is_inside(region, at.X); };
  }
  Contains test_of(const SelectLabel& select, const std::string& place) const {
    return of_tets(select_tets({select}, mesh_, place));
  }
  Contains test_of(const SelectBody& select, const std::string& place) const {
    return of_tets(select_tets({select}, mesh_, place));
  }
  Contains test_of(const SelectTetrahedra& select, const std::string& place) const {
    return of_tets(select_tets({select}, mesh_, place));
  }
  template <class Surface>
  Contains test_of(const Surface& select, const std::string& place)
      const requires std::is_same_v<Surface, SelectSurface> || std::is_same_v<Surface, SelectPatch> {
    if (by_ != HoldBy::area) throw InputError(place, "a surface has no volume: use \"hold_by\": \"area\"");
    std::vector<char> chosen(faces_.size(), 0);
    const std::vector<TetFace> selected = select_faces({select}, mesh_, faces_, place);
    std::size_t next = 0;  // both lists have the same order
    for (std::size_t i = 0; i < faces_.size() && next < selected.size(); ++i)
      if (faces_[i].tet == selected[next].tet && faces_[i].face == selected[next].face) {
        chosen[i] = 1;
        ++next;
      }
    return [chosen](const PointOnMesh& at) { return chosen[std::size_t(at.face)] != 0; };
  }
  Contains test_of(const SelectVertices&, const std::string& place) const { return refuse_vertices(place); }
  Contains test_of(const SelectNearest&, const std::string& place) const { return refuse_vertices(place); }

  Contains test_of(const SelectAnyOf& any, const std::string& place) const {
    return [parts = tests(any.parts, place + "/any_of/")](const PointOnMesh& at) {
      for (const Contains& part : parts)
        if (part(at)) return true;
      return false;
    };
  }
  Contains test_of(const SelectAllOf& all, const std::string& place) const {
    return [parts = tests(all.parts, place + "/all_of/")](const PointOnMesh& at) {
      for (const Contains& part : parts)
        if (!part(at)) return false;
      return true;
    };
  }
  Contains test_of(const SelectNot& negated, const std::string& place) const {
    return [part = test(negated.part.at(0), place + "/not")](const PointOnMesh& at) { return !part(at); };
  }

  std::vector<Contains> tests(const std::vector<Selector>& parts, const std::string& list) const {
    std::vector<Contains> all;
    for (const Selector& part : parts) all.push_back(test(part, list + std::to_string(all.size())));
    return all;
  }
  Contains of_tets(const std::vector<Index>& tets) const {
    std::vector<char> chosen(std::size_t(mesh_.tet_count()), 0);
    for (const Index t : tets) chosen[std::size_t(t)] = 1;
    return [chosen](const PointOnMesh& at) { return chosen[std::size_t(at.tet)] != 0; };
  }
  [[noreturn]] static Contains refuse_vertices(const std::string& place) {
    throw InputError(place,
                     "names vertices, which have no volume and no area: use \"hold_by\": \"vertices\", or a "
                     "box, sphere, plane or label");
  }

  const TetMesh& mesh_;
  const std::vector<TetFace>& faces_;
  HoldBy by_;
};

// ---- Points of a simplex, in barycentric coordinates

template <int corners>
using Barycentric = Eigen::Matrix<double, corners, 1>;
template <int corners>
using Simplex = Eigen::Matrix<double, corners, corners>;  // a column per corner

// The parts of equal size into which the middles of the edges divide it.
std::vector<Simplex<3>> divided(const Simplex<3>& s) {
  const auto mid = [&](int a, int b) -> Barycentric<3> { return (s.col(a) + s.col(b)) / 2; };
  std::vector<Simplex<3>> parts(4);
  for (int c = 0; c < 3; ++c) parts[std::size_t(c)] << s.col(c), mid(c, (c + 1) % 3), mid(c, (c + 2) % 3);
  parts[3] << mid(0, 1), mid(1, 2), mid(2, 0);
  return parts;
}

std::vector<Simplex<4>> divided(const Simplex<4>& s) {
  const auto mid = [&](int a, int b) -> Barycentric<4> { return (s.col(a) + s.col(b)) / 2; };
  std::vector<Simplex<4>> parts(8);
  for (int c = 0; c < 4; ++c)
    parts[std::size_t(c)] << s.col(c), mid(c, (c + 1) % 4), mid(c, (c + 2) % 4), mid(c, (c + 3) % 4);
  const Barycentric<4> a = mid(0, 2), b = mid(1, 3);  // the diagonal of the octahedron that is left
  const Barycentric<4> around[] = {mid(0, 1), mid(1, 2), mid(2, 3), mid(3, 0)};
  for (int i = 0; i < 4; ++i) parts[std::size_t(4 + i)] << a, b, around[i], around[(i + 1) % 4];
  return parts;
}

template <int corners>
std::vector<Barycentric<corners>> points_of_parts(int levels) {
  std::vector<Simplex<corners>> parts{Simplex<corners>::Identity()};
  for (int level = 0; level < levels; ++level) {
    std::vector<Simplex<corners>> finer;
    for (const auto& part : parts)
      for (const auto& child : divided(part)) finer.push_back(child);
    parts = std::move(finer);
  }
  std::vector<Barycentric<corners>> points;
  for (const auto& part : parts) points.push_back(part.rowwise().mean());
  return points;
}

// ---- Sums over a mesh

class Shares {
 public:
  Shares(const TetMesh& mesh, Contains contains)
      : mesh_(mesh),
        contains_(std::move(contains)),
        inside_(std::size_t(mesh.vertex_count()), 0),
        all_(inside_) {}

  // Adds a simplex of these vertices. A point counts for its nearest corner, or in parts for several.
  template <int corners>
  void add(const Eigen::Matrix<Index, corners, 1>& vertices, double size, PointOnMesh at,
           const std::vector<Barycentric<corners>>& points) {
    Eigen::Matrix<double, 3, corners> X;
    for (int c = 0; c < corners; ++c) X.col(c) = mesh_.points.col(vertices[c]);
    for (const Barycentric<corners>& point : points) {
      at.X = X * point;
      const bool is_in = contains_(at);
      const auto nearest = (point.array() > point.maxCoeff() - 1e-9).eval();
      const double part = size / double(points.size()) / double(nearest.count());
      for (int c = 0; c < corners; ++c) {
        if (!nearest[c]) continue;
        all_[std::size_t(vertices[c])] += part;
        if (is_in) inside_[std::size_t(vertices[c])] += part;
      }
    }
  }

  std::vector<SelectedShare> found() const {
    std::vector<SelectedShare> shares;
    for (std::size_t v = 0; v < all_.size(); ++v) {
      if (!(inside_[v] > 0)) continue;
      const double share = inside_[v] / all_[v];
      shares.push_back({static_cast<Index>(v), share < wholly_from ? share : 1});
    }
    return shares;
  }

 private:
  const TetMesh& mesh_;
  Contains contains_;
  std::vector<double> inside_, all_;  // per vertex [m³] or [m²]
};

}  // namespace

std::vector<SelectedShare> select_shares(const Selector& selector, const TetMesh& mesh, HoldBy by,
                                         const std::string& place) {
  lobe_assert(by != HoldBy::vertices, "select_shares: whole vertices have no shares");
  const std::vector<TetFace> faces = by == HoldBy::area ? outer_faces(mesh) : std::vector<TetFace>{};
  Shares shares(mesh, ShareSelection(mesh, faces, by).test(selector, place));
  if (by == HoldBy::volume) {
    const auto points = points_of_parts<4>(3);
    for (Index t = 0; t < mesh.tet_count(); ++t)
      shares.add<4>(mesh.tets.col(t), signed_volume(tet_points(mesh, t)), {Vec3d::Zero(), t}, points);
    return shares.found();
  }
  const auto points = points_of_parts<3>(4);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto& [tet, face] = faces[i];
    const int* c = face_corners[face];
    const Mat34<double> X = tet_points(mesh, tet);
    const double area = (X.col(c[1]) - X.col(c[0])).cross(X.col(c[2]) - X.col(c[0])).norm() / 2;
    const Eigen::Matrix<Index, 3, 1> corners{mesh.tets(c[0], tet), mesh.tets(c[1], tet),
                                             mesh.tets(c[2], tet)};
    shares.add<3>(corners, area, {Vec3d::Zero(), tet, static_cast<Index>(i)}, points);
  }
  return shares.found();
}

}  // namespace lobe
