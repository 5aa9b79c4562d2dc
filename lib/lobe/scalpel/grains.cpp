#include "lobe/scalpel/grains.h"

#include <algorithm>
#include <cmath>
#include <limits>

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
std::vector<std::uint8_t> skin_of_tets(const Topology& topology) {
  std::vector<std::uint8_t> skin(std::size_t(topology.tet_count()), 0);
  const TetCells cells = TetCells::since_start(topology);
  for (Index code : cells.outer_faces())
    skin[std::size_t(code / 4)] |= std::uint8_t(!cells.is_cut(code, true) << code % 4);
  return skin;
}

}  // namespace

Grains::Grains(const Elements& elements) {
  const Topology& topology = elements.topology;
  for (Index v = 0; v < topology.vertex_count(); ++v) {
    points_.push_back(elements.points.col(v));
    around_.add_vertex();
  }
  shortest_.assign(points_.size(), std::numeric_limits<double>::infinity());
  on_.assign(points_.size(), 0);
  double sum = 0, volumes = 0;
  const std::vector<std::uint8_t> skin = skin_of_tets(topology);
  for (Index t = 0; t < topology.tet_count(); ++t) {
    of_element_.add_vertex();
    if (!topology.alive(t)) continue;
    of_element_.append(t, count());
    const Eigen::Vector4i corners = topology.corners(t);
    volumes += signed_volume(elements.corner_points(t));
    for (Index v : corners) around_.append(v, count());
    grains_.push_back({corners, t, 1, 0, skin[std::size_t(t)]});
    for (const auto& edge : edge_corners) {
      const Index a = corners[edge[0]], b = corners[edge[1]];
      const double length = (point(a) - point(b)).norm();
      for (Index v : {a, b}) shortest_[std::size_t(v)] = std::min(shortest_[std::size_t(v)], length);
      sum += length;
    }
  }
  mean_edge_ = count() > 0 ? sum / (6.0 * count()) : 0;
  mean_volume_ = count() > 0 ? volumes / count() : 0;
}

Index Grains::neighbour(Index grain, int face) const {
  const Grain& own = (*this)[grain];
  if (own.open >> face & 1) return -1;
  const int* c = face_corners[face];
  const Index p = own.points[c[0]], q = own.points[c[1]], r = own.points[c[2]];
  for (Index other : around_[p]) {
    if (other == grain) continue;
    const Eigen::Vector4i& points = (*this)[other].points;
    const int at_p = place_of(points, p), at_q = place_of(points, q), at_r = place_of(points, r);
    if (at_q < 0 || at_r < 0 || is_open(other, 6 - at_p - at_q - at_r)) continue;
    return other;
  }
  return -1;
}

Index Grains::beside(Index code) const {
  const Index other = neighbour(code / 4, code % 4);
  if (other < 0) return -1;
  for (int f = 0; f < 4; ++f)
    if (place_of((*this)[code / 4].points, (*this)[other].points[f]) < 0) return 4 * other + f;
  return -1;
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
Vec3d Grains::skin_of(Index element, int face, const Elements& elements) const {
  constexpr double rounding = 1e-9;
  const Mat34<double> X = elements.corner_points(element);
  const Mat34<double> gradients = shape(X).gradients;
  const int* c = face_corners[face];
  const double whole = (X.col(c[1]) - X.col(c[0])).cross(X.col(c[2]) - X.col(c[0])).norm() / 2;
  Vec3d sum = Vec3d::Zero();
  for (Index grain : of(element))
    for (int f = 0; f < 4; ++f) {
      if (!is_skin(grain, f)) continue;
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
  return std::all_of(faces.begin(), faces.end(), [&](Index code) { return code >= 0 && code / 4 < count(); });
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
}

// A stays at its end, b goes to the new point; a copy does the opposite. The face between the two is new.
void Grains::bisect(Index grain, Index a, Index b, Index point, double share) {
  const Index other = count();
  grains_.push_back((*this)[grain]);
  Grain &near_a = grains_[std::size_t(grain)], &near_b = grains_.back();
  const int at_a = place_of(near_a.points, a), at_b = place_of(near_a.points, b);
  near_a.points[at_b] = near_b.points[at_a] = point;
  near_a.share *= share;
  near_b.share *= 1 - share;
  near_a.open &= std::uint8_t(~(1 << at_a));
  near_b.open &= std::uint8_t(~(1 << at_b));
  near_a.skin &= std::uint8_t(~(1 << at_a));
  near_b.skin &= std::uint8_t(~(1 << at_b));
  around_.erase_value(b, grain);
  around_.append(point, grain);
  for (Index p : near_b.points) around_.append(p, other);
  of_element_.append(near_b.element, other);
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
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto [a, b, share] = edges[i];
    const std::vector<Index> star(around_[a].begin(), around_[a].end());
    for (Index grain : star)
      if (place_of((*this)[grain].points, b) >= 0) bisect(grain, a, b, first + static_cast<Index>(i), share);
  }
}

std::vector<Index> Grains::open(const std::vector<Index>& faces) {
  std::vector<Index> points, elements;
  for (Index code : faces) {
    const Index grain = code / 4, other = neighbour(grain, code % 4);
    elements.push_back((*this)[grain].element);
    changed_.push_back(grain);
    Grain& own = grains_[std::size_t(grain)];
    own.open |= std::uint8_t(1 << code % 4);
    for (int c : face_corners[code % 4]) points.push_back(own.points[c]);
    if (other < 0) continue;
    elements.push_back((*this)[other].element);
    changed_.push_back(other);
    for (int f = 0; f < 4; ++f)
      if (place_of(own.points, (*this)[other].points[f]) < 0)
        grains_[std::size_t(other)].open |= std::uint8_t(1 << f);
  }
  sort_unique(points);
  for (Index p : points) split_if_apart(p);
  sort_unique(elements);
  return elements;
}

// The grains around a point that hang together by faces which have it for a corner. The largest part keeps
// the point, the first of several.
void Grains::split_if_apart(Index point) {
  std::vector<Index> left(around_[point].begin(), around_[point].end());
  std::sort(left.begin(), left.end());
  std::vector<std::vector<Index>> parts;
  while (!left.empty()) {
    std::vector<Index>& part = parts.emplace_back(1, left.front());
    left.erase(left.begin());
    for (std::size_t at = 0; at < part.size(); ++at)
      for (int f = 0; f < 4; ++f) {
        if ((*this)[part[at]].points[f] == point) continue;
        const Index other = neighbour(part[at], f);
        const auto found = std::lower_bound(left.begin(), left.end(), other);
        if (other < 0 || found == left.end() || *found != other) continue;
        part.push_back(other);
        left.erase(found);
      }
  }
  if (parts.size() < 2) return;
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
      Eigen::Vector4i& own = grains_[std::size_t(grain)].points;
      own[place_of(own, point)] = copy;
      around_.erase_value(point, grain);
      around_.append(copy, grain);
    }
  }
}

void Grains::forget(const std::vector<Index>& elements) {
  std::vector<Index> points;
  for (Index t : elements) {
    for (Index grain : of(t)) {
      changed_.push_back(grain);
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
  return grains_.capacity() * sizeof(Grain) + points_.capacity() * sizeof(Vec3d) +
         shortest_.capacity() * sizeof(double) + on_.capacity() * sizeof(std::uint32_t) +
         (around_.items().size() + of_element_.items().size()) * sizeof(Index);
}

}  // namespace lobe
