#include "lobe/skin/skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "lobe/cut/distance.h"
#include "lobe/diagnostics/locate.h"
#include "lobe/error.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

void append(std::vector<Index>& to, std::span<const Index> items) {
  to.insert(to.end(), items.begin(), items.end());
}

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

// Writes vectors of four numbers as columns of three. The next column overwrites the fourth number; that of
// the last column is left out. The compiler must assume that vector registers alias everything, so loops have
// pointers of their own.
class Columns {
 public:
  explicit Columns(Mat3X<float>& to, Index count) : data_(to.data()), last_(count - 1), to_(to) {}
  void put_before_last(Index i, const Eigen::Vector4f& vector) const {
    Eigen::Map<Eigen::Vector4f>(data_ + 3 * std::size_t(i)) = vector;
  }
  void put_last(const Eigen::Vector4f& vector) const { to_.col(last_) = vector.head<3>(); }

 private:
  float* data_;
  Index last_;
  Mat3X<float>& to_;
};

// b × c of the first three numbers; the fourth is 0 where theirs are. (Eigen's cross3() does one number at a
// time.)
Eigen::Vector4f cross(const Eigen::Vector4f& b, const Eigen::Vector4f& c) {
  using Four [[gnu::vector_size(16)]] = float;
  const auto turned = [](Four a) { return __builtin_shufflevector(a, a, 1, 2, 0, 3); };
  const Four own_b = *reinterpret_cast<const Four*>(b.data()),
             own_c = *reinterpret_cast<const Four*>(c.data());
  const Four product = turned(own_b * turned(own_c) - turned(own_b) * own_c);
  return Eigen::Map<const Eigen::Vector4f>(reinterpret_cast<const float*>(&product));
}

}  // namespace

TexturedSurface textured_boundary(const TetMesh& mesh) {
  const Topology topology(mesh);
  TexturedSurface surface;
  surface.points = mesh.points;
  surface.triangles.resize(3, Eigen::Index(topology.boundary_faces().size()));
  for (std::size_t i = 0; i < topology.boundary_faces().size(); ++i)
    surface.triangles.col(Eigen::Index(i)) = topology.face(topology.boundary_faces()[i]);
  surface.texture_of = surface.normal_of = Triangles::Constant(3, surface.triangles.cols(), -1);
  return surface;
}

Skin::Skin(const TexturedSurface& surface, const TetMesh& mesh) : start_(mesh) {
  check_corners(surface.triangles, surface.triangles, 0, surface.points.cols(), "point");
  check_corners(surface.texture_of, surface.triangles, -1, surface.texture.cols(), "texture coordinate");
  check_corners(surface.normal_of, surface.triangles, -1, surface.normals.cols(), "normal");
  if (surface.triangles.cols() == 0) throw InputError("skin", "has no triangle");
  if (mesh.tet_count() == 0) throw InputError("skin", "the body has no tetrahedron that could carry it");
  add_vertices(surface);
  add_texture(surface);
  lies_on_ = tets_under(points_, corners_of_, start_);
  lying_on_ = inverse(lies_on_, start_.tet_count());
  NumberLists corners;
  for (const auto& triangle : corners_of_.colwise()) corners.append({triangle.data(), 3});
  around_ = inverse(corners, Index(points_.cols()));
  choose_carriers(Topology(start_));
  list_triangles_around();
  mesh_.revision = 1;
  mesh_.changed_triangles.restart(1);
  mesh_.changed_vertices.restart(1);
}

// Adds the carried vertices first, one for each normal of a point, and then those that differ in texture
// only.
void Skin::add_vertices(const TexturedSurface& surface) {
  using Normal = std::array<double, 3>;
  const auto count = static_cast<Index>(surface.triangles.cols());
  std::map<std::pair<Index, Normal>, Index> carried;
  corners_of_.resize(3, count);
  for (Index i = 0; i < 3 * count; ++i) {
    const Index point = surface.triangles.data()[i], n = surface.normal_of.data()[i];
    Normal normal{};
    if (n >= 0) Eigen::Map<Vec3d>(normal.data()) = surface.normals.col(n);
    const auto [at, is_new] = carried.emplace(std::pair(point, normal), mesh_.vertex_count());
    if (is_new) mesh_.file_vertex.push_back(point);
    corners_of_.data()[i] = at->second;
  }
  points_ = surface.points(Eigen::all, mesh_.file_vertex);
}

void Skin::add_texture(const TexturedSurface& surface) {
  const auto count = static_cast<Index>(surface.triangles.cols());
  const Index carried_count = mesh_.vertex_count();
  using Textured = std::tuple<Index, double, double>;
  std::vector<Eigen::Vector2d> texture(std::size_t(carried_count), Eigen::Vector2d::Zero());
  std::vector<std::uint8_t> has_texture(std::size_t(carried_count), 0);
  std::map<Textured, Index> number_of;
  for (Index t = 0; t < count; ++t) {
    Eigen::Vector3i& triangle = mesh_.triangles.emplace_back(corners_of_.col(t));
    for (int c = 0; c < 3; ++c) {
      const Index vertex = corners_of_(c, t), coordinate = surface.texture_of(c, t);
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
        copied_from_.push_back(vertex);
        mesh_.file_vertex.push_back(Index(mesh_.file_vertex[vertex]));
      }
    }
    mesh_.file_triangle.push_back(t);
    slot_of_.push_back(t);
    number_of_.push_back(t);
    shown_.push_back(corners_of_.col(t));
  }
  for (const Eigen::Vector2d& st : texture) mesh_.texture.push_back(st.cast<float>());
}

void Skin::choose_carriers(const Topology& topology) {
  const Eigen::Index count = points_.cols();
  carrier_.assign(std::size_t(count), -1);
  element_ = carrier_;
  weights_.resize(std::size_t(count));
  carrier_corners_.resize(std::size_t(count));
  std::vector<Index> lengths(std::size_t(start_.tet_count()), 0);
  std::vector<Index> chosen;
  for (Index vertex = 0; vertex < count; ++vertex) {
    chosen.push_back(nearest_of(candidates(vertex), start_, points_.col(vertex)));
    ++lengths[chosen.back()];
  }
  carried_by_ = VertexLists<Index>(lengths);
  for (Index vertex = 0; vertex < count; ++vertex) {
    carry(vertex, chosen[vertex], topology);
    farthest_ = std::max(farthest_, distance_to_tet(points_.col(vertex), tet_points(start_, chosen[vertex])));
  }
  is_loose_.assign(slot_of_.size(), 0);
  for (Index triangle = 0; triangle < file_count(); ++triangle)
    is_loose_[triangle] = bond_of(topology, triangle, corners_in(triangle)) != Bond::firm;
}

Index Skin::loose_count() const {
  return static_cast<Index>(std::count(is_loose_.begin(), is_loose_.end(), 1));
}

// The tetrahedra under the shown triangles around a vertex, and under those of which parts are shown.
std::vector<Index> Skin::candidates(Index vertex) const {
  std::vector<Index> tets;
  for (Index triangle : around_[vertex])
    if (slot_of_[triangle] >= 0 || divided_.contains(triangle)) append(tets, lies_on_[triangle]);
  return tets;
}

void Skin::carry(Index vertex, Index element, const Topology& topology) {
  const Index tet = topology.parent(element);
  if (carrier_[vertex] >= 0) carried_by_.erase_value(carrier_[vertex], vertex);
  carried_by_.append(tet, vertex);
  carrier_[vertex] = tet;
  element_[vertex] = element;
  carrier_corners_[vertex] = topology.corners(element);
  weights_[vertex] = barycentric(start_, tet, points_.col(vertex)).cast<float>();
}

void Skin::follow(const Topology& topology, const MeshEdit& edit, const Grains* grains) {
  std::vector<Index> triangles, vertices, cut;
  const auto touched = [&](Index element) {
    const Index tet = topology.parent(element);
    append(triangles, lying_on_[tet]);
    append(vertices, carried_by_[tet]);
    for (Index vertex : carried_by_[tet])
      if (topology.alive(element_[vertex])) carrier_corners_[vertex] = topology.corners(element_[vertex]);
  };
  for (Index t : edit.removed) touched(t);
  for (const VertexSplit& split : edit.splits)
    for (Index t : split.tets) touched(t);
  for (const TetCopy& tet_copy : edit.copies)
    copies_of_[topology.parent(tet_copy.copy)].push_back(tet_copy.copy);
  for (const TetShare& tet_share : edit.shares) {
    touched(tet_share.tet);
    cut.push_back(topology.parent(tet_share.tet));
  }
  follow(topology, triangles, vertices, cut, grains);
}

void Skin::follow_all(const Topology& topology, const Grains* grains) {
  std::vector<Index> triangles, vertices, cut;
  copies_of_.clear();
  for (Index t = start_.tet_count(); t < topology.tet_count(); ++t) {
    copies_of_[topology.parent(t)].push_back(t);
    cut.push_back(topology.parent(t));
  }
  for (Index vertex = 0; vertex < points_.cols(); ++vertex) {
    vertices.push_back(vertex);
    if (topology.alive(element_[vertex])) carrier_corners_[vertex] = topology.corners(element_[vertex]);
  }
  for (Index triangle = 0; triangle < file_count(); ++triangle) triangles.push_back(triangle);
  follow(topology, triangles, vertices, cut, grains);
}

void Skin::follow(const Topology& topology, std::vector<Index>& triangles, std::vector<Index>& vertices,
                  std::vector<Index>& cut, const Grains* grains) {
  sort_unique(vertices);
  if (!grains) return check(topology, triangles, vertices);
  has_new_revision_ = false;
  sort_unique(cut);
  follow_grains({topology, *grains}, cut);
  open({topology, *grains}, triangles, vertices);
}

// Hides triangles that have lost tetrahedra under them, then chooses new carriers, then hides triangles whose
// carriers are not connected.
void Skin::check(const Topology& topology, std::vector<Index>& triangles,
                 const std::vector<Index>& vertices) {
  std::vector<Index> drops;
  const auto collect = [&](auto&& stays) {
    sort_unique(triangles);
    for (Index triangle : triangles)
      if (slot_of_[triangle] >= 0 && !stays(triangle)) drops.push_back(triangle);
  };
  collect([&](Index triangle) { return bond_of(topology, triangle, {}) != Bond::none; });
  drop(drops);
  for (Index vertex : vertices) {
    append(triangles, around_[vertex]);
    if (holds_to_any(topology, vertex)) continue;
    const Index tet = nearest_of(candidates(vertex), start_, points_.col(vertex));
    if (tet >= 0) carry(vertex, tet, topology);
  }
  collect([&](Index triangle) { return holds(topology, triangle, corners_in(triangle)); });
  drop(drops);
}

// The bond of the tetrahedra under a triangle and those that carry some of its corners.
Bond Skin::bond_of(const Topology& topology, Index triangle, std::span<const Index> corners) const {
  const std::span<const Index> under = lies_on_[triangle];
  std::vector<Index> tets(under.begin(), under.end());
  for (Index vertex : corners)
    if (std::find(tets.begin(), tets.end(), element_[vertex]) == tets.end()) tets.push_back(element_[vertex]);
  return bond(topology, tets);
}

bool Skin::holds(const Topology& topology, Index triangle, std::span<const Index> corners) const {
  const Bond found = bond_of(topology, triangle, corners);
  return found == Bond::firm || (found == Bond::loose && is_loose_[triangle]);
}

// Whether the tetrahedron that carries a vertex is connected with those under a shown triangle around it.
bool Skin::holds_to_any(const Topology& topology, Index vertex) const {
  const std::span<const Index> around = around_[vertex];
  return std::any_of(around.begin(), around.end(), [&](Index triangle) {
    return slot_of_[triangle] >= 0 && holds(topology, triangle, {&vertex, 1});
  });
}

// Removes triangles. The last ones take their slots, highest slots first.
void Skin::drop(std::vector<Index>& triangles) {
  if (triangles.empty()) return;
  has_new_revision_ = false;
  begin_revision();
  std::sort(triangles.begin(), triangles.end(), [&](Index a, Index b) { return slot_of_[a] > slot_of_[b]; });
  for (Index triangle : triangles) take_out(triangle);
  triangles.clear();
}

void Skin::update(const Eigen::Ref<const Mat3X<double>>& X, const Eigen::Ref<const Mat3X<float>>& u,
                  Mat3X<float>& x, Mat3X<float>& normals) {
  update_from<float>(X, u, x, normals);
}

void Skin::update(const Eigen::Ref<const Mat3X<double>>& X, const Eigen::Ref<const Mat3X<double>>& u,
                  Mat3X<float>& x, Mat3X<float>& normals) {
  update_from<double>(X, u, x, normals);
}

template <class Real>
void Skin::update_from(const Eigen::Ref<const Mat3X<double>>& X, const Eigen::Ref<const Mat3X<Real>>& u,
                       Mat3X<float>& x, Mat3X<float>& normals) {
  mesh_x_.resize(std::size_t(X.cols()));
  for (Eigen::Index v = 0; v < X.cols(); ++v)
    mesh_x_[v] << (X.col(v) + u.col(v).template cast<double>()).template cast<float>(), 0.0F;
  x.resize(3, mesh_.vertex_count());
  normals.resize(3, mesh_.vertex_count());
  find_positions(x);
  find_normals(normals);
  const auto carried = static_cast<Index>(points_.cols());
  for (Index i = carried; i < carried + static_cast<Index>(copied_from_.size()); ++i) {
    x.col(i) = x.col(copied_from_[i - carried]);
    normals.col(i) = normals.col(copied_from_[i - carried]);
  }
}

void Skin::find_positions(Mat3X<float>& x) {
  const auto count = static_cast<Index>(points_.cols());
  if (count == 0) return;
  x_.resize(std::size_t(count) + cut_.size());
  const Eigen::Vector4f *const mesh = mesh_x_.data(), *const weights = weights_.data();
  const Eigen::Vector4i* const corners = carrier_corners_.data();
  Eigen::Vector4f* const carried = x_.data();
  const Columns columns(x, count);
  for (Index i = 0; i < count; ++i) {
    const Eigen::Vector4f& w = weights[i];
    const Eigen::Vector4i& c = corners[i];
    carried[i] = (w[0] * mesh[c[0]] + w[1] * mesh[c[1]]) + (w[2] * mesh[c[2]] + w[3] * mesh[c[3]]);
    if (i + 1 < count) columns.put_before_last(i, carried[i]);
  }
  columns.put_last(carried[count - 1]);
  find_cut_positions(x);
}

// Lists six triangles for each vertex, so that the loop over them always has the same length.
void Skin::list_triangles_around() {
  const Index of_no_area = file_count();
  slot_of_.push_back(-1);
  twice_area_.assign(slot_of_.size(), Eigen::Vector4f::Zero());
  for (Index vertex = 0; vertex < around_.count(); ++vertex) {
    auto& six = six_around_.emplace_back();
    six.fill(of_no_area);
    const std::span<const Index> around = around_[vertex];
    for (std::size_t i = 0; i < around.size(); ++i) {
      if (i < six.size())
        six[i] = around[i];
      else
        others_around_.push_back({vertex, around[i]});
    }
  }
}

void Skin::find_areas() {
  const Eigen::Vector4f* const x = x_.data();
  Eigen::Vector4f* const areas = twice_area_.data();
  const Eigen::Vector3i* const shown = shown_.data();
  const Index* const numbers = number_of_.data();
  const std::size_t count = shown_.size();
  for (std::size_t slot = 0; slot < count; ++slot) {
    const Eigen::Vector3i& t = shown[slot];
    const Eigen::Vector4f a = x[t[0]], b = x[t[1]] - a, c = x[t[2]] - a;
    areas[numbers[slot]] = cross(b, c);
  }
}

// A vertex sums the triangles around it. To add each triangle to its corners would be slower, because it
// would wait for sums that were just written. Four square roots are computed at a time. A vertex without area
// has no normal.
void Skin::find_normals(Mat3X<float>& normals) {
  find_areas();
  if (listed_at_ != mesh_.revision) list_parts_around();
  const auto count = static_cast<Index>(six_around_.size());
  if (count == 0) return;
  const Eigen::Vector4f* const areas = twice_area_.data();
  const std::array<Index, 6>* const around = six_around_.data();
  const Columns columns(normals, count);
  auto other = others_around_.cbegin(), part = parts_around_.cbegin();
  const auto end = others_around_.cend(), end_of_parts = parts_around_.cend();
  for (Index i = 0; i < count; i += 4) {
    const Index here = std::min(4, count - i);
    Eigen::Matrix4f sums = Eigen::Matrix4f::Zero();
    for (Index k = 0; k < here; ++k) {
      const std::array<Index, 6>& t = around[i + k];
      sums.col(k) = (areas[t[0]] + areas[t[1]]) + (areas[t[2]] + areas[t[3]]) + (areas[t[4]] + areas[t[5]]);
    }
    for (; other != end && (*other)[0] < i + 4; ++other) sums.col((*other)[0] - i) += areas[(*other)[1]];
    for (; part != end_of_parts && (*part)[0] < i + 4; ++part) sums.col((*part)[0] - i) += areas[(*part)[1]];
    const Eigen::Array4f squares = sums.colwise().squaredNorm().transpose();
    const Eigen::Array4f factors = (squares > 0).select(squares.sqrt().inverse(), 0.0F);
    for (Index k = 0; k < here && i + k + 1 < count; ++k)
      columns.put_before_last(i + k, factors[k] * sums.col(k));
    if (i + 4 >= count) columns.put_last(factors[here - 1] * sums.col(here - 1));
  }
  find_cut_normals(normals);
}

}  // namespace lobe
