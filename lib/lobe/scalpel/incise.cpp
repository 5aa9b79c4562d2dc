#include "lobe/scalpel/incise.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <limits>

#include "lobe/scalpel/crumbs.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

using Edge = std::pair<Index, Index>;  // ascending

// Places of numbers that are there once each.
class Places {
 public:
  explicit Places(std::size_t most) : table_(std::bit_ceil(2 * most + 2), {-1, -1}) {}
  // That of a number; `place`, which it has from now on, where it has none yet.
  Index of(std::int64_t number, Index place) {
    std::size_t at = std::size_t(number) * 0x9E3779B97F4A7C15U >> 32 & (table_.size() - 1);
    while (table_[at].number >= 0 && table_[at].number != number) at = (at + 1) & (table_.size() - 1);
    if (table_[at].number < 0) table_[at] = {number, place};
    return table_[at].place;
  }

 private:
  struct Entry {
    std::int64_t number;
    Index place;
  };
  std::vector<Entry> table_;
};

class Step {
 public:
  Step(Grains& grains, const Blade& blade, const SweptSheets& swept, const PlacedTets& tets)
      : grains_(grains),
        blade_(blade),
        sheet_(swept.last()),
        swept_(swept),
        last_(blade.looks_back ? swept.before_last() : nullptr),
        tets_(tets) {}
  Incised cut();

 private:
  struct Point {
    Index number;
    Vec3d x;                             // where it is now [m]
    double distance = 0;                 // from the sheet, where it is to lie on it [m]
    bool was_on = false, is_on = false;  // before this step; from now on
    int side = 0, last_side = 0;         // beyond which of its planes; and of the last sheet's
  };
  struct Near {
    Index grain;
    std::array<Index, 4> points;  // in points_
    bool is_beyond;               // all on one side of the sheets
    int marks = 0;                // on its edges
  };
  struct Mark {
    Edge edge;
    double share;
    bool counts = true;
  };

  Vec3d place(Index grain, const Vec3d& X) const { return tets_.of(grains_[grain].element)(X); }
  bool is_on(const Point& point) const { return point.was_on || point.is_on; }
  bool are_apart(const Point& a, const Point& b) const {  // not on one side of the sheets
    return a.side == 0 || a.side != b.side || (last_ && (a.last_side == 0 || a.last_side != b.last_side));
  }
  Mark* mark_of(const Edge& edge);
  Mark* mark_of(const Near& near, int a, int b);
  bool is_near_grain(Index grain) const;
  std::optional<double> crossing(const Vec3d& p, const Vec3d& q) const;

  void find_near();
  void put_on();
  bool release_flat();
  void find_crossed();
  void refuse_too_many();
  void drop_third_marks();
  std::vector<Index> faces_on() const;
  std::vector<Index> faces_between_sides() const;
  bool is_near(Index grain, const Eigen::Vector3i& points) const;
  Vec3d middle_of_face(Index code) const;
  Vec3d middle_of(Index grain) const;
  void open(std::vector<Index> faces);

  Grains& grains_;
  const Blade blade_;
  const Sheet& sheet_;
  const SweptSheets& swept_;
  const Sheet* last_;  // none: there is no need of it
  const PlacedTets& tets_;
  std::vector<Point> points_;  // of grains near the sheet
  std::vector<Near> near_;     // by their grains
  std::vector<Mark> marks_;    // by their edges
  Incised result_;
};

Step::Mark* Step::mark_of(const Edge& edge) {
  const auto at = std::lower_bound(marks_.begin(), marks_.end(), edge,
                                   [](const Mark& mark, const Edge& e) { return mark.edge < e; });
  return at != marks_.end() && at->edge == edge && at->counts ? &*at : nullptr;
}

Step::Mark* Step::mark_of(const Near& near, int a, int b) {
  const Point &p = points_[std::size_t(near.points[std::size_t(a)])],
              &q = points_[std::size_t(near.points[std::size_t(b)])];
  return are_apart(p, q) ? mark_of(std::minmax(p.number, q.number)) : nullptr;
}

bool Step::is_near_grain(Index grain) const {
  const auto at = std::lower_bound(near_.begin(), near_.end(), grain,
                                   [](const Near& near_grain, Index g) { return near_grain.grain < g; });
  return at != near_.end() && at->grain == grain;
}

std::optional<double> Step::crossing(const Vec3d& p, const Vec3d& q) const {
  const std::optional<double> share = sheet_.crossing(p, q);
  return share || !last_ ? share : last_->crossing(p, q);
}

void Step::find_near() {
  const double reach = blade_.reach() * grains_.mean_edge();
  std::vector<std::pair<Index, const Mat34<double>*>> placed;  // grains, and where their points are
  placed.reserve(tets_.grains().size());
  for (const auto& [grain, x] : tets_.grains())
    if (sheet_.may_reach(x, reach) || (last_ && last_->may_reach(x, reach))) placed.emplace_back(grain, &x);
  std::sort(placed.begin(), placed.end());
  near_.reserve(placed.size());
  points_.reserve(2 * placed.size());
  Places places(2 * placed.size());
  for (const auto& [grain, placed_at] : placed) {
    const Mat34<double>& x = *placed_at;
    const Eigen::Vector4i& numbers = grains_[grain].points;
    Near& near = near_.emplace_back(Near{grain, {}, true});
    for (int k = 0; k < 4; ++k) {
      const Index next = static_cast<Index>(points_.size()), place = places.of(numbers[k], next);
      near.points[std::size_t(k)] = place;
      if (place < next) continue;
      Point& point = points_.emplace_back(Point{numbers[k], x.col(k)});
      point.was_on = grains_.is_on(point.number, blade_.stroke);
      point.side = sheet_.side(point.x);
      if (last_) point.last_side = last_->side(point.x);
    }
    for (int k = 1; k < 4; ++k)
      near.is_beyond = near.is_beyond && !are_apart(points_[std::size_t(near.points[0])],
                                                    points_[std::size_t(near.points[std::size_t(k)])]);
  }
}

// Points near enough to the sheet lie on it from now on; but not all four of a grain: the farthest stays off.
void Step::put_on() {
  for (Point& point : points_) {
    const double within = blade_.snap * grains_.shortest_edge(point.number);
    if (point.was_on || sheet_.beyond(point.x) >= within ||
        sheet_.box().squaredExteriorDistance(point.x) >= within * within)
      continue;
    point.distance = sheet_.distance(point.x, within);
    point.is_on = point.distance < within;
  }
  while (release_flat()) {
  }
  for (const Point& point : points_)
    if (point.is_on) grains_.put_on(point.number, blade_.stroke);
}

bool Step::release_flat() {
  bool found = false;
  for (const Near& near : near_) {
    const auto& points = near.points;
    if (!std::all_of(points.begin(), points.end(), [&](Index p) { return is_on(points_[std::size_t(p)]); }))
      continue;
    Point* worst = nullptr;
    for (Index p : points) {
      Point& point = points_[std::size_t(p)];
      if (!point.is_on) continue;
      if (!worst || std::pair(point.distance, point.number) > std::pair(worst->distance, worst->number))
        worst = &point;
    }
    if (!worst) continue;
    worst->is_on = false;
    found = true;
  }
  return found;
}

// Each edge is tested once.
void Step::find_crossed() {
  constexpr double least = 1e-3;
  const auto points = static_cast<std::int64_t>(points_.size());
  Places places(6 * near_.size());
  std::vector<std::optional<double>> shares;  // of the edges that were tested, by their places
  for (Near& near : near_) {
    if (near.is_beyond) continue;
    for (const auto& edge : edge_corners) {
      const auto [a, b] = std::minmax(
          near.points[std::size_t(edge[0])], near.points[std::size_t(edge[1])],
          [&](Index i, Index j) { return points_[std::size_t(i)].number < points_[std::size_t(j)].number; });
      const Point &p = points_[std::size_t(a)], &q = points_[std::size_t(b)];
      if (is_on(p) || is_on(q) || !are_apart(p, q)) continue;
      const auto next = static_cast<Index>(shares.size());
      const auto place = std::size_t(places.of(a * points + b, next));
      if (place == shares.size()) {
        shares.push_back(crossing(p.x, q.x));
        if (shares[place])
          marks_.push_back({{p.number, q.number}, std::clamp(*shares[place], least, 1 - least)});
      }
      near.marks += shares[place].has_value();
    }
  }
  std::sort(marks_.begin(), marks_.end(), [](const Mark& a, const Mark& b) { return a.edge < b.edge; });
}

void Step::refuse_too_many() {
  for (const Near& near : near_) {
    if (near.marks == 0 || static_cast<Index>(grains_.of(grains_[near.grain].element).size()) < most_grains)
      continue;
    for (const auto& edge : edge_corners)
      if (Mark* mark = mark_of(near, edge[0], edge[1])) {
        mark->counts = false;
        ++result_.refused;
      }
  }
}

// Of three marks on one face the last does not count: a surface crosses two sides of a triangle, or none.
void Step::drop_third_marks() {
  if (marks_.size() < 3) return;
  for (const Near& near : near_) {
    if (near.marks < 3) continue;
    for (const int* c : face_corners) {
      const std::array<Mark*, 3> sides{mark_of(near, c[0], c[1]), mark_of(near, c[1], c[2]),
                                       mark_of(near, c[2], c[0])};
      if (std::find(sides.begin(), sides.end(), nullptr) == sides.end())
        (*std::max_element(sides.begin(), sides.end(), [](const Mark* a, const Mark* b) {
          return a->edge < b->edge;
        }))->counts = false;
    }
  }
}

bool Step::is_near(Index grain, const Eigen::Vector3i& points) const {
  Eigen::Vector3i sorted = points;  // both sides find the same sum
  std::sort(sorted.begin(), sorted.end());
  const Vec3d middle = (grains_.point(sorted[0]) + grains_.point(sorted[1]) + grains_.point(sorted[2])) / 3;
  return swept_.is_near(place(grain, middle), open_within * grains_.mean_edge());
}

// Closed faces on the stroke's sheet, each from one side.
std::vector<Index> Step::faces_on() const {
  std::vector<Index> faces, touching;
  const auto is_point_on = [&](Index p) { return grains_.is_on(p, blade_.stroke); };
  for (const PlacedTets::Placed& placed : tets_)
    for (Index grain : grains_.of(placed.tet)) {
      const Eigen::Vector4i& p = grains_[grain].points;
      if (std::count_if(p.begin(), p.end(), is_point_on) >= 3) touching.push_back(grain);
    }
  std::sort(touching.begin(), touching.end());
  for (Index grain : touching) {
    const Eigen::Vector4i& p = grains_[grain].points;
    for (int f = 0; f < 4; ++f) {
      const int* c = face_corners[f];
      if (!std::all_of(c, c + 3, [&](int k) { return is_point_on(p[k]); })) continue;
      const Index other = grains_.neighbour(grain, f);
      if (other < 0 || (other < grain && tets_.has(grains_[other].element))) continue;
      if (is_near(grain, {p[c[0]], p[c[1]], p[c[2]]})) faces.push_back(4 * grain + f);
    }
  }
  return faces;
}

Vec3d Step::middle_of(Index grain) const {
  const Eigen::Vector4i& p = grains_[grain].points;
  return place(grain,
               (grains_.point(p[0]) + grains_.point(p[1]) + grains_.point(p[2]) + grains_.point(p[3])) / 4);
}

// Closed faces of which the sheet passes between the middles of both sides: who goes from one side of the
// sheet to the other, from middle to middle, comes through one of them.
std::vector<Index> Step::faces_between_sides() const {
  std::vector<Index> faces;
  for (const Near& near : near_)
    for (int f = 0; f < 4; ++f) {
      const Index grain = near.grain, other = grains_.neighbour(grain, f);
      if (other < 0 || (other < grain && is_near_grain(other))) continue;
      const auto [first, second] = std::minmax(grain, other);
      if (crossing(middle_of(first), middle_of(second))) faces.push_back(4 * grain + f);
    }
  return faces;
}

Vec3d Step::middle_of_face(Index code) const {
  const Grains::Grain& data = grains_[code / 4];
  const int* c = face_corners[code % 4];
  return place(code / 4, (grains_.point(data.points[c[0]]) + grains_.point(data.points[c[1]]) +
                          grains_.point(data.points[c[2]])) /
                             3);
}

void Step::open(std::vector<Index> faces) {
  result_.crumbs = keep_crumbs(grains_, faces);
  for (Index code : faces) {
    const Index neighbour = grains_.other_side(code);
    result_.faces.push_back({grains_[code / 4].element, grains_[neighbour / 4].element, grains_.area(code),
                             middle_of_face(code)});
    result_.area += result_.faces.back().area;
  }
  result_.opened = grains_.open(faces, blade_.number);
  result_.incision.opened = std::move(faces);
}

Incised Step::cut() {
  result_.incision.stroke = blade_.number;
  find_near();
  if (blade_.along_faces) {
    open(faces_between_sides());
    return std::move(result_);
  }
  put_on();
  find_crossed();
  refuse_too_many();
  drop_third_marks();
  for (const Mark& mark : marks_)
    if (mark.counts) result_.incision.bisections.push_back({mark.edge.first, mark.edge.second, mark.share});
  grains_.bisect(result_.incision.bisections, 1u << blade_.stroke);
  open(faces_on());
  return std::move(result_);
}

}  // namespace

PlacedTets::PlacedTets(const Grains& grains, const std::vector<Index>& tets, Placements find)
    : find_(std::move(find)) {
  placed_.reserve(tets.size());
  grains_.reserve(2 * tets.size());
  for (Index t : tets) {
    const Placement placement = find_(t);
    const auto begin = static_cast<Index>(grains_.size());
    for (Index grain : grains.of(t)) {
      const Eigen::Vector4i& points = grains[grain].points;
      Mat34<double>& x = grains_.emplace_back(PlacedGrain{grain, {}}).x;
      for (int k = 0; k < 4; ++k) x.col(k) = placement(grains.point(points[k]));
    }
    placed_.push_back({t, begin, static_cast<Index>(grains_.size()), placement});
  }
}

const Placement* PlacedTets::find(Index tet) const {
  const auto at = std::lower_bound(placed_.begin(), placed_.end(), tet,
                                   [](const Placed& placed, Index t) { return placed.tet < t; });
  return at != placed_.end() && at->tet == tet ? &at->placement : nullptr;
}

Placement PlacedTets::of(Index tet) const {
  const Placement* known = find(tet);
  return known ? *known : find_(tet);
}

Incised incise(Grains& grains, const Blade& blade, const SweptSheets& swept, const PlacedTets& tets) {
  return Step(grains, blade, swept, tets).cut();
}

}  // namespace lobe
