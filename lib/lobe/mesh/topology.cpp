#include "lobe/mesh/topology.h"

#include <algorithm>
#include <array>

#include "lobe/sort_unique.h"

namespace lobe {
namespace {

struct FaceKey {
  std::array<Index, 3> vertices;  // ascending
  Index code;
  bool is_odd;  // the order of its corners, seen from outside
  bool operator<(const FaceKey& other) const { return vertices < other.vertices; }
};

std::vector<FaceKey> sorted_faces(const Tets& tets) {
  std::vector<FaceKey> faces;
  faces.reserve(std::size_t(4 * tets.cols()));
  for (Index t = 0; t < tets.cols(); ++t)
    for (int f = 0; f < 4; ++f) {
      const int* c = face_corners[f];
      FaceKey key{{tets(c[0], t), tets(c[1], t), tets(c[2], t)}, 4 * t + f, false};
      const auto& v = key.vertices;
      key.is_odd = (v[0] > v[1]) ^ (v[1] > v[2]) ^ (v[0] > v[2]);
      std::sort(key.vertices.begin(), key.vertices.end());
      faces.push_back(key);
    }
  std::sort(faces.begin(), faces.end());
  return faces;
}

std::vector<Index> tets_per_vertex(const TetMesh& mesh) {
  std::vector<Index> count(std::size_t(mesh.vertex_count()), 0);
  for (Index i = 0; i < mesh.tets.size(); ++i) ++count[std::size_t(mesh.tets.data()[i])];
  return count;
}

int corner_of(const Tets& tets, Index t, Index v) {
  for (int c = 0; c < 4; ++c)
    if (tets(c, t) == v) return c;
  return -1;
}

}  // namespace

Topology::Topology(const TetMesh& mesh)
    : tets_(mesh.tets),
      neighbours_(Tets::Constant(4, mesh.tet_count(), -1)),
      alive_(std::size_t(mesh.tet_count()), 1),
      alive_count_(mesh.tet_count()),
      around_(tets_per_vertex(mesh)),
      found_by_(std::size_t(mesh.tet_count()), -1) {
  for (Index t = 0; t < mesh.tet_count(); ++t)
    for (int c = 0; c < 4; ++c) around_.append(tets_(c, t), t);
  const std::vector<FaceKey> faces = sorted_faces(mesh.tets);
  for (std::size_t i = 0; i < faces.size(); ++i)  // copies share a face with others on the same side of it
    for (std::size_t j = i + 1; j < faces.size() && faces[i].vertices == faces[j].vertices; ++j) {
      if (faces[i].is_odd == faces[j].is_odd) continue;
      add_neighbour(faces[i].code / 4, faces[i].code % 4, faces[j].code / 4);
      add_neighbour(faces[j].code / 4, faces[j].code % 4, faces[i].code / 4);
    }
  for (Index code = 0; code < 4 * mesh.tet_count(); ++code)
    if (neighbours_.padded().data()[code] < 0) open_face(code);
  for (Index v = 0; v < vertex_count() && stars_are_whole_; ++v) stars_are_whole_ = parts_around(v) < 2;
}

Eigen::Vector3i Topology::face(Index code) const {
  const int* c = face_corners[code % 4];
  const Index t = code / 4;
  return {tets_(c[0], t), tets_(c[1], t), tets_(c[2], t)};
}

void Topology::open_face(Index code) {
  neighbours_.padded().data()[code] = -1 - static_cast<Index>(boundary_.size());
  boundary_.push_back(code);
}

void Topology::close_face(Index code) {
  const Index place = -1 - neighbours_.padded().data()[code];
  boundary_[place] = boundary_.back();
  neighbours_.padded().data()[boundary_[place]] = -1 - place;
  boundary_.pop_back();
}

// Adds a neighbour across a face that is not known to be on the boundary.
void Topology::add_neighbour(Index tet, int face, Index other) {
  if (neighbours_(face, tet) < 0) {
    neighbours_(face, tet) = other;
    return;
  }
  stars_are_whole_ = false;  // the tetrahedra around an edge are no ring any more
  if (more_.vertex_count() == 0) more_ = VertexLists<Across>(std::vector<Index>(std::size_t(tet_count()), 0));
  while (more_.vertex_count() < tet_count()) more_.add_vertex();
  has_more_.resize(std::size_t(tet_count()), 0);
  more_.append(tet, {face, other});
  has_more_[std::size_t(tet)] = 1;
}

// Removes a neighbour. If it was the first of several, another one takes its place.
void Topology::forget_neighbour(Index tet, Index other) {
  std::array<std::vector<Index>, 4> left;
  std::array<bool, 4> had{};
  for_neighbours(tet, [&](int face, Index neighbour) {
    if (neighbour == other)
      had[face] = true;
    else
      left[face].push_back(neighbour);
  });
  for (int f = 0; f < 4; ++f)
    if (had[f]) set_neighbours(tet, f, left[f]);
}

void Topology::set_neighbours(Index tet, int face, std::span<const Index> others) {
  const Index now = std::max(neighbours_(face, tet), -1);
  if (others.size() < 2 && !has_more(tet) && now == (others.empty() ? -1 : others[0])) return;
  if (neighbours_(face, tet) < 0) close_face(4 * tet + face);
  neighbours_(face, tet) = -1;
  if (has_more(tet))
    for (std::size_t i = more_[tet].size(); i-- > 0;)
      if (more_[tet][i].face == face) more_.erase(tet, &more_[tet][i]);
  if (has_more(tet)) has_more_[std::size_t(tet)] = !more_[tet].empty();
  for (Index other : others) add_neighbour(tet, face, other);
  if (others.empty()) open_face(4 * tet + face);
}

void Topology::unlink(Index tet) {
  --alive_count_;
  const bool is_shared = has_more(tet);
  if (is_shared)
    for (const Across& more : std::vector<Across>(more_[tet].begin(), more_[tet].end()))
      forget_neighbour(more.tet, tet);
  for (int f = 0; f < 4; ++f) {
    around_.erase_value(tets_(f, tet), tet);
    const Index other = neighbours_(f, tet);
    if (other < 0) {
      close_face(4 * tet + f);
    } else if (has_more(other)) {
      forget_neighbour(other, tet);
    } else {
      for (int g = 0; g < 4; ++g)
        if (neighbours_(g, other) == tet) open_face(4 * other + g);
    }
    neighbours_(f, tet) = -1;
  }
  if (is_shared) {
    more_.clear(tet);
    has_more_[std::size_t(tet)] = 0;
  }
}

MeshEdit Topology::remove(std::span<const Index> tets) {
  MeshEdit edit;
  for (Index t : tets) {
    if (!alive(t)) continue;
    alive_[t] = 0;
    edit.removed.push_back(t);
  }
  std::vector<Index> ends, touched;
  const std::vector<Index> rims = rims_of(edit.removed, ends);
  for (Index t : edit.removed) {
    const Eigen::Vector4i neighbours = neighbours_.col(t);
    unlink(t);
    std::array<bool, 4> whole{};
    if (stars_are_whole_) whole = stays_whole(tets_.col(t), neighbours);
    for (int c = 0; c < 4; ++c)
      if (!whole[c]) touched.push_back(tets_(c, t));
  }
  find_cut_off(rims, ends, edit);
  sort_unique(touched);
  for (Index v : touched) split_if_apart(v, edit.splits);
  return edit;
}

// Whether the ring of tetrahedra around the edge v w leads from one to another; `behind`: the corner of the
// first that is left behind.
bool Topology::ring_closes(Index from, Index to, Index v, Index w, Index behind) const {
  while (from != to) {
    const auto corners = tets_.col(from);
    const Index next = neighbours_(corner_of(tets_.padded(), from, behind), from);
    if (next < 0) return false;
    behind ^= corners[0] ^ corners[1] ^ corners[2] ^ corners[3] ^ v ^ w;
    from = next;
  }
  return true;
}

// For a tetrahedron that was unlinked: at which corners the rings around its edges show that its neighbours
// are still connected. If the tetrahedra around such a corner were connected before, they still are.
std::array<bool, 4> Topology::stays_whole(
    const Eigen::Vector4i& corners,
    const Eigen::Vector4i& neighbours) const {  // per face; negative: none
  std::array<int, 4> parts;
  for (int c = 0; c < 4; ++c)
    parts[c] = static_cast<int>((neighbours.array() >= 0).count()) - (neighbours[c] >= 0);
  for (int edge = 0; edge < 6; ++edge) {
    const auto [i, j] = edge_corners[edge];
    const auto [k, l] = edge_corners[5 - edge];  // the opposite one
    if (neighbours[k] < 0 || neighbours[l] < 0) continue;
    const bool closes = ring_closes(neighbours[k], neighbours[l], corners[i], corners[j], corners[l]);
    parts[i] -= closes;
    parts[j] -= closes;
  }
  return {parts[0] < 2, parts[1] < 2, parts[2] < 2, parts[3] < 2};
}

// Numbers the face-connected parts of the tetrahedra around v; part_of_ runs parallel to around(v).
Index Topology::parts_around(Index v) {
  const std::span<const Index> star = around(v);
  for (std::size_t i = 0; i < star.size(); ++i) found_by_[star[i]] = static_cast<Index>(i);
  part_of_.assign(star.size(), -1);
  Index parts = 0;
  std::size_t reached = 0;
  for (std::size_t first = 0; reached < star.size(); ++first) {
    if (part_of_[first] >= 0) continue;
    part_of_[first] = parts;
    ++reached;
    front_.assign(1, static_cast<Index>(first));
    while (!front_.empty() && reached < star.size()) {
      const Index t = star[front_.back()];
      front_.pop_back();
      for_neighbours(t, [&](int f, Index other) {
        if (tets_(f, t) == v) return;
        const Index at = found_by_[other];
        if (part_of_[at] >= 0) return;
        part_of_[at] = parts;
        ++reached;
        front_.push_back(at);
      });
    }
    ++parts;
  }
  for (Index t : star) found_by_[t] = -1;
  return parts;
}

void Topology::split_if_apart(Index v, std::vector<VertexSplit>& splits) {
  const Index parts = parts_around(v);
  if (parts < 2) return;
  const std::vector<Index> star(around(v).begin(), around(v).end());
  std::vector<Index> size(std::size_t(parts), 0);
  for (Index part : part_of_) ++size[part];
  const Index keeps = static_cast<Index>(std::max_element(size.begin(), size.end()) - size.begin());
  for (Index part = 0; part < parts; ++part) {
    if (part == keeps) continue;
    VertexSplit split{v, vertex_count(), {}};
    origins_.push_back(origin(v));
    around_.add_vertex();
    for (std::size_t i = 0; i < star.size(); ++i) {
      if (part_of_[i] != part) continue;
      around_.erase_value(v, star[i]);
      around_.append(split.copy, star[i]);
      tets_(corner_of(tets_.padded(), star[i], v), star[i]) = split.copy;
      split.tets.push_back(star[i]);
    }
    splits.push_back(std::move(split));
  }
}

CompactMesh compact(const Topology& topology, const Mat3X<double>& points, const std::vector<int>& labels) {
  CompactMesh result;
  result.vertex_target.assign(std::size_t(topology.vertex_count()), -1);
  result.tet_target.assign(std::size_t(topology.tet_count()), -1);
  for (Index v = 0; v < topology.vertex_count(); ++v) {
    if (topology.around(v).empty()) continue;
    result.vertex_target[v] = static_cast<Index>(result.vertex_source.size());
    result.vertex_source.push_back(v);
  }
  for (Index t = 0; t < topology.tet_count(); ++t) {
    if (!topology.alive(t)) continue;
    result.tet_target[t] = static_cast<Index>(result.tet_source.size());
    result.tet_source.push_back(t);
  }
  result.mesh.points.resize(3, Eigen::Index(result.vertex_source.size()));
  for (std::size_t v = 0; v < result.vertex_source.size(); ++v)
    result.mesh.points.col(Eigen::Index(v)) = points.col(result.vertex_source[v]);
  result.mesh.tets.resize(4, Eigen::Index(result.tet_source.size()));
  for (std::size_t t = 0; t < result.tet_source.size(); ++t) {
    for (int c = 0; c < 4; ++c)
      result.mesh.tets(c, Eigen::Index(t)) = result.vertex_target[topology.tets()(c, result.tet_source[t])];
    result.mesh.labels.push_back(labels.empty() ? 0 : labels[result.tet_source[t]]);
  }
  return result;
}

}  // namespace lobe
