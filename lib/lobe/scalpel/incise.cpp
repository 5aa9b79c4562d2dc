#include "lobe/scalpel/incise.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <map>

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
  Vec3d place(Index grain, Index point) const {
    return placement_.at(grains_[grain].element)(grains_.point(point));
  }
  void find_near();
  void put_on();
  void find_crossed();
  void drop_third_marks();
  std::vector<Index> own_grains() const;
  std::vector<Index> faces_on() const;
  bool is_near(Index grain, const Eigen::Vector3i& points) const;
  double area(Index code) const;

  Grains& grains_;
  const Blade blade_;
  const Sheet& sheet_;
  const std::vector<Sheet>& swept_;
  std::vector<Index> elements_;
  std::map<Index, Placement> placement_;
  std::map<Index, Vec3d> positions_;  // of the points of grains near the sheet [m]
  std::vector<Index> near_;           // grains
  std::map<Edge, double> marks_;
  Incised result_;
};

Step::Step(Grains& grains, const Blade& blade, const Sheet& sheet, const std::vector<Sheet>& swept,
           const std::vector<Index>& elements, const Placements& placement)
    : grains_(grains), blade_(blade), sheet_(sheet), swept_(swept), elements_(elements) {
  for (Index t : elements) placement_.emplace(t, placement(t));
}

std::vector<Index> Step::own_grains() const {
  std::vector<Index> own;
  for (Index t : elements_) own.insert(own.end(), grains_.of(t).begin(), grains_.of(t).end());
  std::sort(own.begin(), own.end());
  return own;
}

void Step::find_near() {
  const double reach = blade_.snap * 2 * grains_.mean_edge();
  for (Index grain : own_grains()) {
    std::array<Vec3d, 4> x;
    Eigen::AlignedBox3d box;
    for (int k = 0; k < 4; ++k) box.extend(x[std::size_t(k)] = place(grain, grains_[grain].points[k]));
    if (box.squaredExteriorDistance(sheet_.box()) > reach * reach) continue;
    near_.push_back(grain);
    for (int k = 0; k < 4; ++k) positions_.emplace(grains_[grain].points[k], x[std::size_t(k)]);
  }
}

// Points near enough to the sheet lie on it from now on; but not all four of a grain: the farthest stays off.
void Step::put_on() {
  std::map<Index, double> on;
  for (const auto& [point, x] : positions_) {
    if (grains_.is_on(point, blade_.stroke)) continue;
    const double distance = sheet_.distance(x);
    if (distance < blade_.snap * grains_.shortest_edge(point)) on.emplace(point, distance);
  }
  for (bool is_flat = true; is_flat;) {
    is_flat = false;
    for (Index grain : near_) {
      const Eigen::Vector4i& points = grains_[grain].points;
      const bool all_on = std::all_of(points.begin(), points.end(), [&](Index p) {
        return grains_.is_on(p, blade_.stroke) || on.contains(p);
      });
      if (!all_on) continue;
      auto worst = on.end();
      for (Index p : points)
        if (const auto at = on.find(p); at != on.end())
          if (worst == on.end() || std::pair(at->second, p) > std::pair(worst->second, worst->first))
            worst = at;
      if (worst == on.end()) continue;
      on.erase(worst);
      is_flat = true;
    }
  }
  for (const auto& [point, distance] : on) grains_.put_on(point, blade_.stroke);
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
  for (const auto& [a, b] : edges)
    if (const auto share = sheet_.crossing(positions_.at(a), positions_.at(b)))
      marks_[{a, b}] = std::clamp(*share, least, 1 - least);
  for (Index grain : near_) {
    if (static_cast<Index>(grains_.of(grains_[grain].element).size()) < most_grains) continue;
    for (const auto& edge : edge_corners)
      result_.refused += static_cast<Index>(
          marks_.erase(std::minmax(grains_[grain].points[edge[0]], grains_[grain].points[edge[1]])));
  }
}

// Of three marks on one face the last does not count: a surface crosses two sides of a triangle, or none.
void Step::drop_third_marks() {
  for (Index grain : near_)
    for (const int* c : face_corners) {
      const Eigen::Vector4i& p = grains_[grain].points;
      const std::array<Edge, 3> sides{std::minmax(p[c[0]], p[c[1]]), std::minmax(p[c[1]], p[c[2]]),
                                      std::minmax(p[c[2]], p[c[0]])};
      if (std::all_of(sides.begin(), sides.end(), [&](const Edge& side) { return marks_.contains(side); }))
        marks_.erase(*std::max_element(sides.begin(), sides.end()));
    }
}

bool Step::is_near(Index grain, const Eigen::Vector3i& points) const {
  Eigen::Vector3i sorted = points;  // both sides find the same sum
  std::sort(sorted.begin(), sorted.end());
  const Vec3d middle = (grains_.point(sorted[0]) + grains_.point(sorted[1]) + grains_.point(sorted[2])) / 3;
  const Vec3d x = placement_.at(grains_[grain].element)(middle);
  return std::any_of(swept_.begin(), swept_.end(),
                     [&](const Sheet& sheet) { return sheet.distance(x) < 0.3 * grains_.mean_edge(); });
}

// Closed faces on the stroke's sheet, each from one side.
std::vector<Index> Step::faces_on() const {
  std::vector<Index> faces;
  for (Index grain : own_grains())
    for (int f = 0; f < 4; ++f) {
      const int* c = face_corners[f];
      const Eigen::Vector4i& p = grains_[grain].points;
      const Eigen::Vector3i points{p[c[0]], p[c[1]], p[c[2]]};
      if (!std::all_of(points.begin(), points.end(),
                       [&](Index point) { return grains_.is_on(point, blade_.stroke); }))
        continue;
      const Index other = grains_.neighbour(grain, f);
      if (other < 0 || (other < grain && placement_.contains(grains_[other].element))) continue;
      if (is_near(grain, points)) faces.push_back(4 * grain + f);
    }
  return faces;
}

double Step::area(Index code) const {
  const int* c = face_corners[code % 4];
  const Eigen::Vector4i& p = grains_[code / 4].points;
  const Vec3d a = grains_.point(p[c[0]]), b = grains_.point(p[c[1]]), d = grains_.point(p[c[2]]);
  return (b - a).cross(d - a).norm() / 2;
}

Incised Step::cut() {
  find_near();
  put_on();
  find_crossed();
  drop_third_marks();
  for (const auto& [edge, share] : marks_)
    result_.incision.bisections.push_back({edge.first, edge.second, share});
  grains_.bisect(result_.incision.bisections, 1u << blade_.stroke);
  result_.incision.opened = faces_on();
  for (Index code : result_.incision.opened) result_.area += area(code);
  result_.opened = grains_.open(result_.incision.opened);
  return std::move(result_);
}

}  // namespace

Incised incise(Grains& grains, const Blade& blade, const Sheet& sheet, const std::vector<Sheet>& swept,
               const std::vector<Index>& elements, const Placements& placement) {
  return Step(grains, blade, sheet, swept, elements, placement).cut();
}

}  // namespace lobe
