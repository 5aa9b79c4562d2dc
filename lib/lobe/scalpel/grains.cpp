#include "lobe/scalpel/grains.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "lobe/assert.h"
#include "lobe/mesh/surface_cells.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

int place_of(const Eigen::Vector4i& points, Index point) {
  for (int k = 0; k < 4; ++k)
    if (points[k] == point) return k;
  return -1;
}

// One bit per face of each tetrahedron.
std::vector<std::uint8_t> boundary_of_tets(const Topology& topology) {
  std::vector<std::uint8_t> boundary(std::size_t(topology.tet_count()), 0);
  const TetCells cells = TetCells::since_start(topology);
  for (Index code : cells.outer_faces())
    boundary[std::size_t(code / 4)] |= std::uint8_t(!cells.is_cut(code, true) << code % 4);
  return boundary;
}

}  // namespace

Grains::Grains(const Elements& elements) {
  constexpr Index room = 8;  // for what bisections add around a point
  const Topology& topology = elements.topology;
  std::vector<Index> lengths, grain_of(std::size_t(topology.tet_count()), -1);
  for (Index v = 0; v < topology.vertex_count(); ++v)
    lengths.push_back(static_cast<Index>(topology.around(v).size()) + room);
  around_ = VertexLists<Index>(lengths);
  is_whole_.reserve(lengths.size() + lengths.size() / 4);
  is_whole_.assign(lengths.size(), topology.stars_are_whole());
  of_element_ = VertexLists<Index>(std::vector<Index>(grain_of.size(), 1));
  divided_.assign(grain_of.size(), 1);
  const std::size_t points = lengths.size() + lengths.size() / 4;  // memory that nobody touches costs nothing
  points_.reserve(points);
  for (Index v = 0; v < topology.vertex_count(); ++v) points_.push_back(elements.points.col(v));
  shortest_.reserve(points);
  shortest_.assign(points_.size(), std::numeric_limits<double>::infinity());
  on_.reserve(points);
  on_.assign(points_.size(), 0);
  const std::size_t grains = grain_of.size() + grain_of.size() / 2;
  grains_.reserve(grains);
  other_sides_.reserve(grains);
  double sum = 0, volumes = 0;
  const std::vector<std::uint8_t> boundary = boundary_of_tets(topology);
  for (Index t = 0; t < topology.tet_count(); ++t) {
    if (!topology.alive(t)) continue;
    grain_of[std::size_t(t)] = count();
    of_element_.append(t, count());
    const Eigen::Vector4i corners = topology.corners(t);
    volumes += signed_volume(elements.corner_points(t));
    for (Index v : corners) around_.append(v, count());
    grains_.push_back({corners, t, -1, 0, boundary[std::size_t(t)], 1});
    for (const auto& edge : edge_corners) {
      const Index a = corners[edge[0]], b = corners[edge[1]];
      const double length = (point(a) - point(b)).norm();
      for (Index v : {a, b}) shortest_[std::size_t(v)] = std::min(shortest_[std::size_t(v)], length);
      longest_edge_ = std::max(longest_edge_, length);
      sum += length;
    }
  }
  other_sides_.assign(grains_.size(), {-1, -1, -1, -1});
  for (Index grain = 0; grain < count(); ++grain)  // of tetrahedra that share a face with several, in turn
    topology.for_neighbours((*this)[grain].element, [&](int face, Index tet) {
      const Index other = grain_of[std::size_t(tet)];
      for (int f = 0; f < 4; ++f)
        if (place_of((*this)[grain].points, (*this)[other].points[f]) < 0 && other_side(4 * other + f) < 0 &&
            other_side(4 * grain + face) < 0)
          link(4 * grain + face, 4 * other + f);
    });
  for (double shortest : shortest_)
    if (std::isfinite(shortest)) longest_shortest_ = std::max(longest_shortest_, shortest);
  scratch_.reserve(grains);
  scratch_.assign(grains_.size(), -1);
  mean_edge_ = count() > 0 ? sum / (6.0 * count()) : 0;
  mean_volume_ = count() > 0 ? volumes / count() : 0;
}

void Grains::link(Index code, Index other) {
  other_sides_[std::size_t(code / 4)][std::size_t(code % 4)] = other;
  if (other >= 0) other_sides_[std::size_t(other / 4)][std::size_t(other % 4)] = code;
}

// Unlinks a grain from all its neighbours.
void Grains::unlink(Index grain) {
  for (Index& code : other_sides_[std::size_t(grain)]) {
    if (code >= 0) other_sides_[std::size_t(code / 4)][std::size_t(code % 4)] = -1;
    code = -1;
  }
}

double Grains::volume(Index grain) const {
  const Eigen::Vector4i& p = (*this)[grain].points;
  const Vec3d a = point(p[0]);
  return (point(p[1]) - a).dot((point(p[2]) - a).cross(point(p[3]) - a)) / 6;
}

double Grains::area(Index code) const {
  const int* c = face_corners[code % 4];
  const Eigen::Vector4i& p = (*this)[code / 4].points;
  const Vec3d a = point(p[c[0]]);
  return (point(p[c[1]]) - a).cross(point(p[c[2]]) - a).norm() / 2;
}

// A grain's face lies on that of its tetrahedron where the coordinate that belongs to the corner opposite is
// 0.
Vec3d Grains::boundary_share_of(Index element, int face, const Elements& elements) const {
  constexpr double rounding = 1e-9;
  const Mat34<double> X = elements.corner_points(element);
  const Mat34<double> gradients = shape(X).gradients;
  const int* c = face_corners[face];
  const double whole = (X.col(c[1]) - X.col(c[0])).cross(X.col(c[2]) - X.col(c[0])).norm() / 2;
  Vec3d sum = Vec3d::Zero();
  for (Index grain : of(element))
    for (int f = 0; f < 4; ++f) {
      if (!was_boundary(grain, f)) continue;
      Vec3d middle = Vec3d::Zero();
      bool is_on_face = true;
      for (int k : face_corners[f]) {
        const Vec3d x = point((*this)[grain].points[k]) - X.col(c[0]);
        is_on_face = is_on_face && std::abs(gradients.col(face).dot(x)) < rounding;
        const double second = gradients.col(c[1]).dot(x), third = gradients.col(c[2]).dot(x);
        middle += Vec3d(1 - second - third, second, third) / 3;
      }
      if (is_on_face) sum += 3 * area(4 * grain + f) / whole * middle;
    }
  return sum;
}

bool Grains::can_bisect(const std::vector<Incision::Bisection>& edges) const {
  const auto is_point = [&](Index p) { return p >= 0 && p < point_count(); };
  return std::all_of(edges.begin(), edges.end(), [&](const Incision::Bisection& edge) {
    return is_point(edge.a) && is_point(edge.b) && edge.a != edge.b && edge.share > 0 && edge.share < 1;
  });
}

bool Grains::can_open(const std::vector<Index>& faces) const {
  return std::all_of(faces.begin(), faces.end(),
                     [&](Index code) { return code >= 0 && code / 4 < count() && other_side(code) >= 0; });
}

bool Grains::fills(Index vertex, const Elements& elements) const {
  const Vec3d X = elements.points.col(vertex);
  for (Index t : elements.topology.around(vertex))
    for (Index grain : of(t))
      for (Index p : (*this)[grain].points)
        if (point(p) == X) return true;
  return false;
}

void Grains::forget_stroke(int stroke) {
  for (std::uint32_t& on : on_) on &= ~(1u << stroke);
  waiting_[std::size_t(stroke)].clear();
}

void Grains::set_on(std::vector<std::uint32_t> on) {
  on_ = std::move(on);
  for (int stroke = 0; stroke < most_strokes; ++stroke) {
    std::vector<Index>& waiting = waiting_[std::size_t(stroke)];
    waiting.clear();
    if (std::none_of(on_.begin(), on_.end(), [&](std::uint32_t bits) { return bits >> stroke & 1; }))
      continue;
    for (Index grain = 0; grain < count(); ++grain)
      if (has_closed_face_on(grain, stroke)) waiting.push_back(grain);
  }
}

bool Grains::is_closed_on(Index grain, int face, int stroke) const {
  if (neighbour(grain, face) < 0) return false;
  const int* c = face_corners[face];
  return std::all_of(c, c + 3, [&](int k) { return is_on((*this)[grain].points[k], stroke); });
}

bool Grains::has_closed_face_on(Index grain, int stroke) const {
  const Eigen::Vector4i& points = (*this)[grain].points;
  if (std::count_if(points.begin(), points.end(), [&](Index p) { return is_on(p, stroke); }) < 3)
    return false;
  for (int f = 0; f < 4; ++f)
    if (is_closed_on(grain, f, stroke)) return true;
  return false;
}

// A stays at its end, b goes to the new point; a copy does the opposite. The face between the two is new.
void Grains::bisect(Index grain, Index a, Index b, Index point, double share) {
  const Index other = count();
  grains_.push_back(Grain((*this)[grain]));
  other_sides_.push_back({-1, -1, -1, -1});
  Grain &near_a = grains_[std::size_t(grain)], &near_b = grains_.back();
  const int at_a = place_of(near_a.points, a), at_b = place_of(near_a.points, b);
  lobe_assert(at_a >= 0 && at_b >= 0 && share > 0 && share < 1, "grains: a bisection of an edge inside it");
  near_a.points[at_b] = near_b.points[at_a] = point;
  near_a.share *= share;
  near_b.share *= 1 - share;
  near_a.open &= std::uint8_t(~(1 << at_a));
  near_b.open &= std::uint8_t(~(1 << at_b));
  near_a.boundary &= std::uint8_t(~(1 << at_a));
  near_b.boundary &= std::uint8_t(~(1 << at_b));
  for (Grain* half : {&near_a, &near_b})
    if (half->open == 0) half->stroke = -1;
  link(4 * other + at_a, side(4 * grain + at_a));
  link(4 * grain + at_a, 4 * other + at_b);
  around_.erase_value(b, grain);
  for (Index p : near_b.points)
    if (p != point) around_.append(p, other);
  of_element_.append(near_b.element, other);
  ++divided_[std::size_t(parent(other))];
  changed_.push_back(grain);
  changed_.push_back(other);
}

void Grains::bisect(const std::vector<Incision::Bisection>& edges, std::uint32_t strokes) {
  const Index first = point_count();
  for (const Incision::Bisection& edge : edges) {
    const auto a = std::size_t(edge.a), b = std::size_t(edge.b);
    points_.push_back((1 - edge.share) * points_[a] + edge.share * points_[b]);
    shortest_.push_back(std::min(shortest_[a], shortest_[b]));
    on_.push_back((on_[a] & on_[b]) | strokes);
    around_.add_vertex();
  }
  std::uint32_t waiting = 0;
  for (int stroke = 0; stroke < most_strokes; ++stroke)
    waiting |= std::uint32_t(!waiting_[std::size_t(stroke)].empty()) << stroke;
  std::vector<Index> star, both;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto [a, b, share] = edges[i];
    star.assign(around_[a].begin(), around_[a].end());
    std::erase_if(star, [&, b = b](Index grain) { return place_of((*this)[grain].points, b) < 0; });
    const Index halves = count(), point = first + static_cast<Index>(i);
    for (Index grain : star) bisect(grain, a, b, point, share);
    link_halves(star, halves, a, point);
    both.clear();
    for (std::size_t k = 0; k < star.size(); ++k)
      both.insert(both.end(), {star[k], halves + static_cast<Index>(k)});
    around_.assign(point, both);  // of exactly its size
    wait_with(both, (waiting | on_[std::size_t(point)]) & ~strokes);
    waiting |= on_[std::size_t(point)];
  }
}

// Halves of grains have the faces that waited, and perhaps others. `strokes`: as bits.
void Grains::wait_with(const std::vector<Index>& halves, std::uint32_t strokes) {
  for (; strokes != 0; strokes &= strokes - 1) {
    const int stroke = std::countr_zero(strokes);
    for (Index grain : halves)
      if (has_closed_face_on(grain, stroke)) waiting_[std::size_t(stroke)].push_back(grain);
  }
}

// Faces that an edge from `a` was a side of are two now, and so is what is beside them: the halves at the
// other end are numbered from `halves` on, in the order of the star.
void Grains::link_halves(const std::vector<Index>& star, Index halves, Index a, Index point) {
  scratch_.resize(std::size_t(count()), -1);
  for (std::size_t i = 0; i < star.size(); ++i)
    scratch_[std::size_t(star[i])] = halves + static_cast<Index>(i);
  for (Index grain : star) {
    const Eigen::Vector4i& points = (*this)[grain].points;
    for (int f = 0; f < 4; ++f) {
      if (points[f] == a || points[f] == point) continue;
      const Index code = side(4 * grain + f);
      other_sides_[std::size_t(scratch_[std::size_t(grain)])][std::size_t(f)] =
          code < 0 ? code : 4 * scratch_[std::size_t(code / 4)] + code % 4;
    }
  }
  for (Index grain : star) scratch_[std::size_t(grain)] = -1;
}

std::vector<Index> Grains::open(const std::vector<Index>& faces, Index stroke) {
  const auto number = static_cast<std::int16_t>(std::clamp(stroke, Index(-1), most_numbered));
  const Index opened = -2 - std::clamp(stroke, Index(-1), std::numeric_limits<Index>::max() - 2);
  std::vector<Index> points, elements;
  for (Index code : faces) {
    const Index grain = code / 4, other = other_side(code);
    elements.push_back((*this)[grain].element);
    changed_.push_back(grain);
    Grain& data = grains_[std::size_t(grain)];
    data.open |= std::uint8_t(1 << code % 4);
    data.stroke = number;
    for (int c : face_corners[code % 4]) points.push_back(data.points[c]);
    if (other < 0) continue;
    parted_.emplace_back(grain, other / 4);
    elements.push_back((*this)[other / 4].element);
    changed_.push_back(other / 4);
    grains_[std::size_t(other / 4)].open |= std::uint8_t(1 << other % 4);
    grains_[std::size_t(other / 4)].stroke = number;
    for (Index face : {code, other}) link(face, opened);
  }
  sort_unique(points);
  for (Index p : points) split_if_apart(p);
  sort_unique(elements);
  return elements;
}

// Whether the grains around a point are connected by faces that have it for a corner.
bool Grains::hangs_together(Index point) {
  const std::span<const Index> star = around(point);
  if (star.empty()) return true;
  scratch_.resize(std::size_t(count()), -1);
  std::vector<Index>& front = front_;
  front.assign(1, star.front());
  scratch_[std::size_t(star.front())] = 0;
  for (std::size_t at = 0; at < front.size() && front.size() < star.size(); ++at) {
    const Grain& next = (*this)[front[at]];
    for (int f = 0; f < 4; ++f) {
      if (next.points[f] == point) continue;
      const Index other = neighbour(front[at], f);
      if (other < 0 || scratch_[std::size_t(other)] >= 0) continue;
      scratch_[std::size_t(other)] = 0;
      front.push_back(other);
    }
  }
  for (Index grain : front) scratch_[std::size_t(grain)] = -1;
  return front.size() == star.size();
}

// In order of their first grains.
std::vector<std::vector<Index>> Grains::parts_around(Index point) {
  std::vector<Index> left(around_[point].begin(), around_[point].end());
  for (Index grain : left) scratch_[std::size_t(grain)] = 0;
  std::vector<std::vector<Index>> parts;
  while (!left.empty()) {
    std::vector<Index>& part = parts.emplace_back();
    part.reserve(left.size());
    part.push_back(*std::min_element(left.begin(), left.end()));
    scratch_[std::size_t(part.front())] = -1;
    for (std::size_t at = 0; at < part.size(); ++at)
      for (int f = 0; f < 4; ++f) {
        if ((*this)[part[at]].points[f] == point) continue;
        const Index other = neighbour(part[at], f);
        if (other < 0 || scratch_[std::size_t(other)] < 0) continue;
        scratch_[std::size_t(other)] = -1;
        part.push_back(other);
      }
    std::erase_if(left, [&](Index grain) { return scratch_[std::size_t(grain)] < 0; });
  }
  return parts;
}

// The largest part of what is around a point keeps it, the first of several.
void Grains::split_if_apart(Index point) {
  if (hangs_together(point)) return;
  std::vector<std::vector<Index>> parts = parts_around(point);
  changed_.insert(changed_.end(), around_[point].begin(), around_[point].end());
  const auto keeps = std::max_element(parts.begin(), parts.end(),
                                      [](const auto& a, const auto& b) { return a.size() < b.size(); });
  std::swap(*keeps, parts.front());
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const Index copy = point_count();
    points_.push_back(Vec3d(this->point(point)));
    shortest_.push_back(shortest_edge(point));
    on_.push_back(std::uint32_t(on_[std::size_t(point)]));
    around_.add_vertex();
    for (Index grain : parts[i]) {
      Eigen::Vector4i& points = grains_[std::size_t(grain)].points;
      points[place_of(points, point)] = copy;
      around_.erase_value(point, grain);
      around_.append(copy, grain);
    }
  }
}

void Grains::forget(const std::vector<Index>& elements) {
  is_whole_.clear();
  std::vector<Index> points;
  for (Index t : elements) {
    for (Index grain : of(t)) {
      changed_.push_back(grain);
      unlink(grain);
      for (Index p : (*this)[grain].points) {
        around_.erase_value(p, grain);
        points.push_back(p);
      }
    }
    of_element_.clear(t);
  }
  sort_unique(points);
  for (Index p : points) changed_.insert(changed_.end(), around_[p].begin(), around_[p].end());
  for (Index p : points) split_if_apart(p);
}

std::size_t Grains::bytes() const {
  return grains_.size() * (sizeof(Grain) + sizeof other_sides_[0]) + points_.size() * sizeof(Vec3d) +
         shortest_.size() * sizeof(double) + on_.size() * sizeof(std::uint32_t) +
         grains_.size() * (sizeof scratch_[0] + sizeof place_scratch_[0]) +
         (around_.items().size() + of_element_.items().size() + divided_.size() + parent_of_copy_.size()) *
             sizeof(Index);
}

}  // namespace lobe
