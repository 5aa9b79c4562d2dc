#include "lobe/scalpel/incise.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "lobe/scalpel/crumbs.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

using Edge = std::pair<Index, Index>;  // ascending

class Step {
 public:
  Step(Grains& grains, const Blade& blade, const Sheet& sheet, const std::vector<Sheet>& swept,
       const std::vector<Index>& elements, const Placements& placement);
  Incised cut();

 private:
  struct Point {
    Index number;
    Vec3d x;              // where it is now [m]
    double distance = 0;  // from the sheet, where it is to lie on it [m]
    bool is_on = false;   // from now on
  };
  struct Mark {
    Edge edge;
    double share;
    bool counts = true;
  };

  const Placement& placement_of(Index element);
  Vec3d place(Index grain, const Vec3d& X) { return placement_of(grains_[grain].element)(X); }
  std::size_t place_in(Index point) const;  // in points_, which has it
  bool is_on(Index point) const {
    return grains_.is_on(point, blade_.stroke) || points_[place_in(point)].is_on;
  }
  Mark* mark_of(const Edge& edge);
  std::optional<double> crossing(const Vec3d& p, const Vec3d& q) const;

  void find_near();
  void put_on();
  bool release_flat();
  void find_crossed();
  void refuse_too_many();
  void drop_third_marks();
  std::vector<Index> faces_on();
  std::vector<Index> faces_between_sides();
  bool is_near(Index grain, const Eigen::Vector3i& points);
  Vec3d middle_of_face(Index code);
  Vec3d middle_of(Index grain);
  void open(std::vector<Index> faces);

  Grains& grains_;
  const Blade blade_;
  const Sheet& sheet_;
  const std::vector<Sheet>& swept_;
  const Sheet* last_;  // none: there is no need of it
  const Placements& find_placement_;
  std::vector<std::pair<Index, Placement>> placements_, others_;  // by element, sorted; and of those beside
  std::vector<Point> points_;  // of grains near the sheet, by their numbers
  std::vector<Index> near_;    // grains, sorted
  std::vector<Mark> marks_;    // by their edges
  Incised result_;
};

Step::Step(Grains& grains, const Blade& blade, const Sheet& sheet, const std::vector<Sheet>& swept,
           const std::vector<Index>& elements, const Placements& placement)
    : grains_(grains),
      blade_(blade),
      sheet_(sheet),
      swept_(swept),
      last_(blade.looks_back && swept.size() > 1 ? &swept[swept.size() - 2] : nullptr),
      find_placement_(placement) {
  placements_.reserve(elements.size());
  for (Index t : elements) placements_.emplace_back(t, placement(t));
}

const Placement& Step::placement_of(Index element) {
  const auto at = std::lower_bound(placements_.begin(), placements_.end(), element,
                                   [](const auto& own, Index t) { return own.first < t; });
  if (at != placements_.end() && at->first == element) return at->second;
  for (const auto& [t, own] : others_)
    if (t == element) return own;
  return others_.emplace_back(element, find_placement_(element)).second;
}

std::size_t Step::place_in(Index point) const {
  const auto at = std::lower_bound(points_.begin(), points_.end(), point,
                                   [](const Point& own, Index p) { return own.number < p; });
  return std::size_t(at - points_.begin());
}

Step::Mark* Step::mark_of(const Edge& edge) {
  const auto at = std::lower_bound(marks_.begin(), marks_.end(), edge,
                                   [](const Mark& own, const Edge& e) { return own.edge < e; });
  return at != marks_.end() && at->edge == edge && at->counts ? &*at : nullptr;
}

std::optional<double> Step::crossing(const Vec3d& p, const Vec3d& q) const {
  const std::optional<double> share = sheet_.crossing(p, q);
  return share || !last_ ? share : last_->crossing(p, q);
}

void Step::find_near() {
  const double reach = blade_.reach() * grains_.mean_edge();
  std::vector<Index> own;
  for (const auto& [t, placement] : placements_)
    own.insert(own.end(), grains_.of(t).begin(), grains_.of(t).end());
  std::sort(own.begin(), own.end());
  for (Index grain : own) {
    Mat34<double> x;
    const Placement& placement = placement_of(grains_[grain].element);
    for (int k = 0; k < 4; ++k) x.col(k) = placement(grains_.point(grains_[grain].points[k]));
    if (!sheet_.may_reach(x, reach) && !(last_ && last_->may_reach(x, reach))) continue;
    near_.push_back(grain);
    for (int k = 0; k < 4; ++k) points_.push_back({grains_[grain].points[k], x.col(k)});
  }
  std::stable_sort(points_.begin(), points_.end(),
                   [](const Point& a, const Point& b) { return a.number < b.number; });
  points_.erase(std::unique(points_.begin(), points_.end(),
                            [](const Point& a, const Point& b) { return a.number == b.number; }),
                points_.end());
}

// Points near enough to the sheet lie on it from now on; but not all four of a grain: the farthest stays off.
void Step::put_on() {
  for (Point& point : points_) {
    const double within = blade_.snap * grains_.shortest_edge(point.number);
    if (grains_.is_on(point.number, blade_.stroke) ||
        sheet_.box().squaredExteriorDistance(point.x) >= within * within)
      continue;
    point.distance = sheet_.distance(point.x);
    point.is_on = point.distance < within;
  }
  while (release_flat()) {
  }
  for (const Point& point : points_)
    if (point.is_on) grains_.put_on(point.number, blade_.stroke);
}

bool Step::release_flat() {
  bool found = false;
  for (Index grain : near_) {
    const Eigen::Vector4i& points = grains_[grain].points;
    if (!std::all_of(points.begin(), points.end(), [&](Index p) { return is_on(p); })) continue;
    Point* worst = nullptr;
    for (Index p : points)
      if (Point& own = points_[place_in(p)]; own.is_on)
        if (!worst || std::pair(own.distance, p) > std::pair(worst->distance, worst->number)) worst = &own;
    if (!worst) continue;
    worst->is_on = false;
    found = true;
  }
  return found;
}

void Step::find_crossed() {
  std::vector<Edge> edges;
  for (Index grain : near_)
    for (const auto& edge : edge_corners) {
      const Index a = grains_[grain].points[edge[0]], b = grains_[grain].points[edge[1]];
      if (!grains_.is_on(a, blade_.stroke) && !grains_.is_on(b, blade_.stroke))
        edges.push_back(std::minmax(a, b));
    }
  sort_unique(edges);
  constexpr double least = 1e-3;
  for (const Edge& edge : edges)
    if (const auto share = crossing(points_[place_in(edge.first)].x, points_[place_in(edge.second)].x))
      marks_.push_back({edge, std::clamp(*share, least, 1 - least)});
}

void Step::refuse_too_many() {
  for (Index grain : near_) {
    if (static_cast<Index>(grains_.of(grains_[grain].element).size()) < most_grains) continue;
    for (const auto& edge : edge_corners)
      if (Mark* mark = mark_of(std::minmax(grains_[grain].points[edge[0]], grains_[grain].points[edge[1]]))) {
        mark->counts = false;
        ++result_.refused;
      }
  }
}

// Of three marks on one face the last does not count: a surface crosses two sides of a triangle, or none.
void Step::drop_third_marks() {
  if (marks_.size() < 3) return;
  for (Index grain : near_)
    for (const int* c : face_corners) {
      const Eigen::Vector4i& p = grains_[grain].points;
      std::array<Edge, 3> sides{std::minmax(p[c[0]], p[c[1]]), std::minmax(p[c[1]], p[c[2]]),
                                std::minmax(p[c[2]], p[c[0]])};
      if (std::all_of(sides.begin(), sides.end(), [&](const Edge& side) { return mark_of(side); }))
        mark_of(*std::max_element(sides.begin(), sides.end()))->counts = false;
    }
}

bool Step::is_near(Index grain, const Eigen::Vector3i& points) {
  Eigen::Vector3i sorted = points;  // both sides find the same sum
  std::sort(sorted.begin(), sorted.end());
  const Vec3d middle = (grains_.point(sorted[0]) + grains_.point(sorted[1]) + grains_.point(sorted[2])) / 3;
  const Vec3d x = place(grain, middle);
  const double within = open_within * grains_.mean_edge();
  return std::any_of(swept_.rbegin(), swept_.rend(), [&](const Sheet& sheet) {
    return sheet.box().squaredExteriorDistance(x) < within * within && sheet.distance(x) < within;
  });
}

// Closed faces on the stroke's sheet, each from one side.
std::vector<Index> Step::faces_on() {
  std::vector<Index> faces, own;
  for (const auto& [t, placement] : placements_)
    own.insert(own.end(), grains_.of(t).begin(), grains_.of(t).end());
  std::sort(own.begin(), own.end());
  const auto has_placement = [&](Index element) {
    const auto at = std::lower_bound(placements_.begin(), placements_.end(), element,
                                     [](const auto& own, Index t) { return own.first < t; });
    return at != placements_.end() && at->first == element;
  };
  for (Index grain : own) {
    const Eigen::Vector4i& p = grains_[grain].points;
    std::array<bool, 4> on;
    int count = 0;
    for (int k = 0; k < 4; ++k) count += on[std::size_t(k)] = grains_.is_on(p[k], blade_.stroke);
    if (count < 3) continue;
    for (int f = 0; f < 4; ++f) {
      const int* c = face_corners[f];
      if (!on[std::size_t(c[0])] || !on[std::size_t(c[1])] || !on[std::size_t(c[2])]) continue;
      const Index other = grains_.neighbour(grain, f);
      if (other < 0 || (other < grain && has_placement(grains_[other].element))) continue;
      if (is_near(grain, {p[c[0]], p[c[1]], p[c[2]]})) faces.push_back(4 * grain + f);
    }
  }
  return faces;
}

Vec3d Step::middle_of(Index grain) {
  const Eigen::Vector4i& p = grains_[grain].points;
  return place(grain,
               (grains_.point(p[0]) + grains_.point(p[1]) + grains_.point(p[2]) + grains_.point(p[3])) / 4);
}

// Closed faces of which the sheet passes between the middles of both sides: who goes from one side of the
// sheet to the other, from middle to middle, comes through one of them.
std::vector<Index> Step::faces_between_sides() {
  std::vector<Index> faces;
  for (Index grain : near_)
    for (int f = 0; f < 4; ++f) {
      const Index other = grains_.neighbour(grain, f);
      if (other < 0 || (other < grain && std::binary_search(near_.begin(), near_.end(), other))) continue;
      const auto [first, second] = std::minmax(grain, other);
      if (crossing(middle_of(first), middle_of(second))) faces.push_back(4 * grain + f);
    }
  return faces;
}

Vec3d Step::middle_of_face(Index code) {
  const Grains::Grain& own = grains_[code / 4];
  const int* c = face_corners[code % 4];
  return place(code / 4, (grains_.point(own.points[c[0]]) + grains_.point(own.points[c[1]]) +
                          grains_.point(own.points[c[2]])) /
                             3);
}

void Step::open(std::vector<Index> faces) {
  result_.crumbs = keep_crumbs(grains_, faces);
  for (Index code : faces) {
    const Index beside = grains_.beside(code);
    result_.faces.push_back(
        {grains_[code / 4].element, grains_[beside / 4].element, grains_.area(code), middle_of_face(code)});
    result_.area += result_.faces.back().area;
  }
  result_.opened = grains_.open(faces);
  result_.incision.opened = std::move(faces);
}

Incised Step::cut() {
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

Incised incise(Grains& grains, const Blade& blade, const Sheet& sheet, const std::vector<Sheet>& swept,
               const std::vector<Index>& elements, const Placements& placement) {
  return Step(grains, blade, sheet, swept, elements, placement).cut();
}

}  // namespace lobe
