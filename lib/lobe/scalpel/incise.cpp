#include "lobe/scalpel/incise.h"

#include <algorithm>
#include <limits>

#include "lobe/error.h"
#include "lobe/scalpel/opened_faces.h"

namespace lobe {
namespace {

using Edge = std::pair<Index, Index>;  // ascending

class Step {
 public:
  Step(Grains& grains, const Blade& blade, const SweptSheets& swept, const PlacedTets& tets)
      : grains_(grains),
        blade_(blade),
        sheet_(swept.last()),
        swept_(swept),
        last_(blade.looks_back ? swept.before_last() : nullptr),
        tets_(tets) {
    sheets_ = catches_up() ? swept.all() : std::vector<const Sheet*>{&sheet_};
    if (last_) sheets_.push_back(last_);
  }
  Incised cut();

 private:
  struct Point {
    Index number;
    Vec3d x;                             // where it is now [m]
    double distance = 0;                 // from the sheet, where it is to lie on it [m]
    bool was_on = false, is_on = false;  // before this step; from now on
    int side = 0, last_side = 0;         // beyond which of its planes; and of the last sheet's
    Index first_edge = -1;               // to a point of a higher number that was tested, in edges_
  };
  struct Tested {  // an edge
    Index other;   // in points_
    Index next;    // of the same point, in edges_; −1: the last
    std::optional<double> share;
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

  bool catches_up() const { return blade_.since >= 0; }
  bool is_new(Index point) const { return point >= blade_.since; }
  bool is_on(const Point& point) const { return point.was_on || point.is_on; }
  bool are_apart(const Point& a, const Point& b) const {  // not on one side of the sheets
    return catches_up() || a.side == 0 || a.side != b.side ||
           (last_ && (a.last_side == 0 || a.last_side != b.last_side));
  }
  Mark* mark_of(const Edge& edge);
  Mark* mark_of(const Near& near, int a, int b);
  bool is_crossed(Index a, Index b);
  bool may_be_cut(Index grain, const Mat34<double>& x, double reach) const;
  double distance_of(const Point& point, double within) const;

  void find_near();
  void put_on();
  void release_flat();
  void find_crossed();
  void refuse_too_many();
  void drop_third_marks();
  std::vector<Index> near_grains() const;

  Grains& grains_;
  const Blade blade_;
  const Sheet& sheet_;
  const SweptSheets& swept_;
  const Sheet* last_;                 // none: there is no need of it
  std::vector<const Sheet*> sheets_;  // that cut edges
  const PlacedTets& tets_;
  std::vector<Point> points_;  // of grains near the sheet
  std::vector<Near> near_;     // by their grains
  std::vector<Mark> marks_;    // by their edges
  std::vector<Tested> edges_;
  std::vector<Index> new_on_;  // points that the sheet takes in this step, ascending
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

bool Step::may_be_cut(Index grain, const Mat34<double>& x, double reach) const {
  const Eigen::Vector4i& points = grains_[grain].points;
  if (catches_up()) return std::any_of(points.begin(), points.end(), [&](Index p) { return is_new(p); });
  return std::any_of(sheets_.begin(), sheets_.end(),
                     [&](const Sheet* sheet) { return sheet->may_reach(x, reach); });
}

// From the sheets that take points; infinite where it is above `within` [m]. The last sheet is the first.
double Step::distance_of(const Point& point, double within) const {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < (catches_up() ? sheets_.size() : 1); ++i)
    if (const Sheet& sheet = *sheets_[i];
        sheet.beyond(point.x) < within && sheet.box().squaredExteriorDistance(point.x) < within * within)
      least = std::min(least, sheet.distance(point.x, within));
  return least;
}

void Step::find_near() {
  const double reach = blade_.reach(grains_);
  struct Found {
    Index grain, place;  // in tets_.grains()
  };
  std::vector<Found> found;
  found.reserve(tets_.grains().size());
  for (const PlacedTets::Placed& placed : tets_)
    for (Index at = placed.begin; at < placed.end; ++at) {
      const auto& [grain, x] = tets_.grains()[std::size_t(at)];
      if (placed.is_whole || may_be_cut(grain, x, reach)) found.push_back({grain, at});
    }
  std::sort(found.begin(), found.end(), [](const Found& a, const Found& b) { return a.grain < b.grain; });
  near_.reserve(found.size());
  points_.reserve(2 * found.size());
  std::vector<Index>& place_of = grains_.point_scratch();
  for (const auto& [grain, at] : found) {
    const Mat34<double>& x = tets_.grains()[std::size_t(at)].x;
    const Eigen::Vector4i& numbers = grains_[grain].points;
    Near& near = near_.emplace_back(Near{grain, {}, true});
    for (int k = 0; k < 4; ++k) {
      Index& place = place_of[std::size_t(numbers[k])];
      if (place < 0) {
        place = static_cast<Index>(points_.size());
        Point& point = points_.emplace_back(Point{numbers[k], x.col(k)});
        point.was_on = grains_.is_on(point.number, blade_.stroke);
        point.side = sheet_.side(point.x);
        if (last_) point.last_side = last_->side(point.x);
      }
      near.points[std::size_t(k)] = place;
    }
    for (int k = 1; k < 4; ++k)
      near.is_beyond = near.is_beyond && !are_apart(points_[std::size_t(near.points[0])],
                                                    points_[std::size_t(near.points[std::size_t(k)])]);
  }
  for (const Point& point : points_) place_of[std::size_t(point.number)] = -1;
}

// Points near enough to the sheet lie on it from now on; but not all four of a grain: the farthest stays off.
void Step::put_on() {
  bool is_any_on = false;
  for (Point& point : points_) {
    const double within = blade_.snap * grains_.shortest_edge(point.number);
    if (point.was_on || !is_new(point.number)) continue;
    point.distance = distance_of(point, within);
    point.is_on = point.distance < within;
    is_any_on = is_any_on || point.is_on;
  }
  if (is_any_on) release_flat();
  for (const Point& point : points_) {
    if (!point.is_on) continue;
    grains_.put_on(point.number, blade_.stroke);
    new_on_.push_back(point.number);
  }
  std::sort(new_on_.begin(), new_on_.end());
}

// Points are only released, so that what is not flat when it is looked at stays so.
void Step::release_flat() {
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
    if (worst) worst->is_on = false;
  }
}

// Whether the sheet crosses the edge between two points, the lower number first. Each edge is tested once.
bool Step::is_crossed(Index a, Index b) {
  constexpr double least = 1e-3;
  Point &p = points_[std::size_t(a)], &q = points_[std::size_t(b)];
  for (Index edge = p.first_edge; edge >= 0; edge = edges_[std::size_t(edge)].next)
    if (edges_[std::size_t(edge)].other == b) return edges_[std::size_t(edge)].share.has_value();
  const std::optional<double> share = first_crossing(sheets_, p.x, q.x);
  edges_.push_back({b, p.first_edge, share});
  p.first_edge = static_cast<Index>(edges_.size()) - 1;
  if (share) marks_.push_back({{p.number, q.number}, std::clamp(*share, least, 1 - least)});
  return share.has_value();
}

void Step::find_crossed() {
  for (Near& near : near_) {
    if (near.is_beyond) continue;
    for (const auto& edge : edge_corners) {
      const auto [a, b] = std::minmax(
          near.points[std::size_t(edge[0])], near.points[std::size_t(edge[1])],
          [&](Index i, Index j) { return points_[std::size_t(i)].number < points_[std::size_t(j)].number; });
      const Point &p = points_[std::size_t(a)], &q = points_[std::size_t(b)];
      if (!is_on(p) && !is_on(q) && (is_new(p.number) || is_new(q.number)) && are_apart(p, q))
        near.marks += is_crossed(a, b);
    }
  }
  std::sort(marks_.begin(), marks_.end(), [](const Mark& a, const Mark& b) { return a.edge < b.edge; });
}

// Marks of a tetrahedron of the start that would be divided into too many grains do not count.
void Step::refuse_too_many() {
  // How many grains a grain with 0, 1, … marks adds at most: two marks on edges that do not meet, three on a
  // line of edges, four on a ring. Of more than four, three are on one face, whose last one is dropped.
  constexpr std::array<Index, 7> added{0, 1, 3, 4, 5, 5, 5};
  constexpr Index most_at_once = 6;           // grains that a step makes of one
  std::vector<std::pair<Index, Index>> more;  // a tetrahedron of the start, grains added
  for (const Near& near : near_)
    if (const Index parent = grains_.parent(near.grain);
        near.marks > 0 && most_at_once * grains_.divided(parent) > most_grains)
      more.push_back({parent, added[std::size_t(near.marks)]});
  if (more.empty()) return;
  std::sort(more.begin(), more.end());
  std::vector<Index> full;  // ascending
  for (std::size_t i = 0; i < more.size();) {
    const Index parent = more[i].first;
    Index grains = grains_.divided(parent);
    for (; i < more.size() && more[i].first == parent; ++i) grains += more[i].second;
    if (grains > most_grains) full.push_back(parent);
  }
  for (const Near& near : near_) {
    if (near.marks == 0 || !std::binary_search(full.begin(), full.end(), grains_.parent(near.grain)))
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

std::vector<Index> Step::near_grains() const {
  std::vector<Index> grains;
  for (const Near& near : near_) grains.push_back(near.grain);
  return grains;
}

Incised Step::cut() {
  result_.incision.stroke = blade_.number;
  find_near();
  if (blade_.along_faces) {
    open_between_sides(grains_, tets_, sheets_, near_grains(), result_);
    return std::move(result_);
  }
  put_on();
  find_crossed();
  refuse_too_many();
  drop_third_marks();
  for (const Mark& mark : marks_)
    if (mark.counts) result_.incision.bisections.push_back({mark.edge.first, mark.edge.second, mark.share});
  for (std::size_t i = 0; i < result_.incision.bisections.size(); ++i)
    new_on_.push_back(grains_.point_count() + static_cast<Index>(i));
  grains_.bisect(result_.incision.bisections, 1u << blade_.stroke);
  open_on_sheets(grains_, tets_, swept_, blade_.stroke, new_on_, result_);
  return std::move(result_);
}

}  // namespace

void Incised::follow(Incised&& before) {
  caught_up = std::move(before.caught_up);
  opened.insert(opened.end(), before.opened.begin(), before.opened.end());
  faces.insert(faces.end(), before.faces.begin(), before.faces.end());
  area += before.area;
  crumbs += before.crumbs;
  refused += before.refused;
}

void divide_again(const Incision& incision, Grains& grains) {
  if (!grains.can_bisect(incision.bisections))
    throw InputError("incision", "names a point that there is not, or divides an edge at its end");
  grains.bisect(incision.bisections);
  if (!grains.can_open(incision.opened)) throw InputError("incision", "opens a face that there is not");
}

Incised incise(Grains& grains, const Blade& blade, const SweptSheets& swept, const PlacedTets& tets) {
  return Step(grains, blade, swept, tets).cut();
}

}  // namespace lobe
