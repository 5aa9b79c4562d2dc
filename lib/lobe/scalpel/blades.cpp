#include "lobe/scalpel/blades.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "lobe/scalpel/opened_faces.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

constexpr std::size_t most_rows = 12;
constexpr double least_way = 0.01;  // of an edge: a blade that has moved less waits until it has

// A station is moved off its place by 1e-7 of an edge, never twice alike: a mesh and a path that are in line
// with each other would else meet in ties at every turn.
Vec3d off_line(int row, std::size_t station) {
  const auto part = [](double x) { return x - std::floor(x) - 0.5; };
  const double n = 64.0 * row + double(station) + 1;
  return {part(n * 0.8191725133961645), part(n * 0.6710436067037893), part(n * 0.5497004779019703)};
}

bool is_in(const Grains& grains, Index grain, const Vec3d& X) {
  constexpr double rounding = 1e-9;
  const Eigen::Vector4i& p = grains[grain].points;
  const Vec3d start = grains.point(p[0]);
  Mat3<double> edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = grains.point(p[k + 1]) - start;
  const Vec3d low = edges.rowwise().minCoeff().cwiseMin(0), high = edges.rowwise().maxCoeff().cwiseMax(0);
  const Vec3d x = X - start, spare = 1e-6 * (high - low);
  if ((x.array() < (low - spare).array()).any() || (x.array() > (high + spare).array()).any()) return false;
  const Vec3d inner = edges.inverse() * x;
  return inner.minCoeff() >= -rounding && inner.sum() <= 1 + rounding;
}

// A little more than what grains are in now.
Eigen::AlignedBox3d box_around(std::span<const PlacedTets::PlacedGrain> of_tet) {
  Eigen::AlignedBox3d box;
  for (const PlacedTets::PlacedGrain& grain : of_tet)
    box.extend(Eigen::AlignedBox3d(grain.x.rowwise().minCoeff(), grain.x.rowwise().maxCoeff()));
  const Vec3d spare = Vec3d::Constant(1e-6 * box.sizes().maxCoeff());
  return {box.min() - spare, box.max() + spare};
}

}  // namespace

std::vector<BladeMove> Blades::steps(const BladeMove& move) const {
  const Vec3d of_tip = move.to.tip - move.from.tip, of_heel = move.to.heel - move.from.heel;
  const double way = std::max(of_tip.norm(), of_heel.norm()), turn = (of_heel - of_tip).norm();
  const int count =
      static_cast<int>(std::clamp(std::ceil(std::max(way / 2, 2 * turn) / grains.mean_edge()), 1.0, 1000.0));
  std::vector<BladeMove> steps(std::size_t(count), move);
  BladePose from = move.from;
  for (int i = 0; i < count; ++i) {
    const double share = double(i + 1) / count;
    BladeMove& step = steps[std::size_t(i)];
    step.from = from;
    from = step.to = {move.from.tip + share * of_tip, move.from.heel + share * of_heel};
  }
  return steps;
}

BladePose Blades::start_of(const BladeMove& move, const BodyNow& body) const {
  for (const Stroke& stroke : strokes_) {
    if (stroke.tool != move.tool || stroke.number != move.stroke) continue;
    const std::vector<Vec3d> places = places_of(stroke.rows.back(), body);
    return {places.front(), places.back()};
  }
  return move.from;
}

std::optional<Incised> Blades::cut(const BladeMove& step, const BodyNow& body) {
  Stroke* stroke = stroke_of(step);
  if (!stroke) return std::nullopt;
  if (stroke->rows.empty()) {
    Row row = first_row(step, *stroke);
    std::vector<Vec3d> places;
    for (const BladePoint& station : row) places.push_back(station.place);
    const Sheet edge(places, places);
    const auto is_at_edge = [&](const auto& x) { return edge.may_reach(x, 0); };
    const std::vector<Index> near = body.tets_in({edge.box(), is_at_edge, is_at_edge});
    find_in_body(row, PlacedTets(grains, near, body.placement, body.corners));
    stroke->rows = {std::move(row)};
  }
  return advance(*stroke, step, body);
}

Incised Blades::advance(Stroke& stroke, const BladeMove& step, const BodyNow& body) {
  const std::vector<Row>& rows = stroke.rows;
  Incised caught_up = catch_up(stroke, step, body);
  const std::vector<Vec3d> from = places_of(rows.back(), body);
  Row now = places_at(step.to, stroke, rows.back().size());
  std::vector<Vec3d> there;
  there.reserve(now.size());
  for (const BladePoint& station : now) there.push_back(station.place);
  double way = 0;  // beyond that of the tissue
  for (std::size_t i = 0; i < there.size(); ++i) way = std::max(way, (there[i] - from[i]).norm());
  if (way < least_way * grains.mean_edge()) return caught_up;
  SweptSheets swept;
  swept.begin_with(rows.size() - 1, [&](std::size_t i) { return places_of(rows[i], body); });
  swept.add(from);
  swept.add(there);
  const Blade blade{stroke.bit, step.snap, step.along_faces, has_moved_since(rows.back(), from),
                    stroke.begun};
  const PlacedTets tets(grains, tets_near(swept, blade, body), body.placement, body.corners);
  Incised incised;
  if (tets.size() > 0 || !grains.waiting(blade.stroke).empty()) {
    find_in_body(now, tets);
    incised = incise(grains, blade, swept, tets);
  }
  stroke.points_seen = grains.point_count();
  incised.follow(std::move(caught_up));
  incised.way = way_of(now, rows.back(), there, from);
  const bool is_new = is_new_beside(now, rows.size() > 1 ? swept.row(rows.size() - 2) : std::vector<Vec3d>{});
  keep(std::move(now), is_new, stroke);
  return incised;
}

// Of a tetrahedron that a blade has cut half, the sheet says where it was cut only at the edges that it has
// crossed. If another stroke has divided the rest since, new edges cross the sheet behind the blade: they are
// cut now, and what has come between faces that wait is opened.
Incised Blades::catch_up(Stroke& stroke, const BladeMove& step, const BodyNow& body) {
  const Index since = stroke.points_seen;
  const std::vector<Index> divided = follow_divided(stroke);
  if (since == grains.point_count() || stroke.rows.size() < 2) return {};
  std::vector<Index> tets;
  SweptSheets swept;
  Eigen::AlignedBox3d box;
  for (const Row& row : stroke.rows) {
    std::vector<Vec3d> places = places_of(row, body);
    for (const Vec3d& p : places) box.extend(p);
    swept.add(std::move(places));
  }
  for (Index grain : divided) tets.push_back(grains[grain].element);
  sort_unique(tets);
  std::erase_if(tets, [&](Index t) {
    if (!body.corners) return false;
    const Mat34<double> x = body.corners(t);
    return !box.intersects({x.rowwise().minCoeff(), x.rowwise().maxCoeff()});
  });
  Blade blade{stroke.bit, step.snap, step.along_faces, false, stroke.begun};
  blade.since = since;
  Incised incised = incise(grains, blade, swept, PlacedTets(grains, tets, body.placement, body.corners));
  incised.caught_up = std::exchange(incised.incision, {});
  stroke.points_seen = grains.point_count();
  return incised;
}

// Grains around the points that others have made since the stroke's last step, ascending.
std::vector<Index> Blades::follow_divided(Stroke& stroke) const {
  std::vector<Index> divided;
  for (Index p = std::exchange(stroke.points_seen, grains.point_count()); p < grains.point_count(); ++p)
    divided.insert(divided.end(), grains.around(p).begin(), grains.around(p).end());
  sort_unique(divided);
  if (!divided.empty()) find_stations_again(stroke, divided);
  return divided;
}

// A station stays where it is in the material. The grain that it was in may have been divided.
void Blades::find_stations_again(Stroke& stroke, const std::vector<Index>& divided) const {
  for (Row& row : stroke.rows)
    for (BladePoint& station : row) {
      if (station.grain < 0 || !std::binary_search(divided.begin(), divided.end(), station.grain) ||
          is_in(grains, station.grain, station.rest))
        continue;
      const auto in = std::find_if(divided.begin(), divided.end(),
                                   [&](Index grain) { return is_in(grains, grain, station.rest); });
      if (in != divided.end()) station.grain = *in;
    }
}

// It goes on. One that begins has no row yet.
Blades::Stroke* Blades::stroke_of(const BladeMove& step) {
  std::uint32_t taken = 0;
  for (Stroke& stroke : strokes_) {
    taken |= 1u << stroke.bit;
    if (stroke.tool != step.tool || stroke.number != step.stroke) continue;
    stroke.goes_on = true;
    return &stroke;
  }
  if (taken == ~0u) return nullptr;
  Stroke& stroke = strokes_.emplace_back();
  stroke.tool = step.tool;
  stroke.number = step.stroke;
  stroke.begun = begun_++;
  stroke.points_seen = grains.point_count();
  while (taken >> stroke.bit & 1) ++stroke.bit;
  return &stroke;
}

Blades::Row Blades::first_row(const BladeMove& step, Stroke& stroke) const {
  const double length = (step.from.heel - step.from.tip).norm();
  const auto count = std::size_t(std::clamp(std::ceil(length / (grains.mean_edge() / 2)), 1.0, 63.0)) + 1;
  return places_at(step.from, stroke, count);
}

// The mean of those stations that are in the body, or were; of all where it has leapt through it.
Vec3d Blades::way_of(const Row& now, const Row& before, const std::vector<Vec3d>& there,
                     const std::vector<Vec3d>& from) {
  Vec3d sum = Vec3d::Zero(), all = Vec3d::Zero();
  int count = 0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    all += (there[i] - from[i]) / double(now.size());
    if (now[i].grain < 0 && before[i].grain < 0) continue;
    sum += there[i] - from[i];
    ++count;
  }
  return count > 0 ? Vec3d(sum / count) : all;
}

void Blades::end_strokes() {
  for (const Stroke& stroke : strokes_)
    if (!stroke.goes_on) grains.forget_stroke(stroke.bit);
  std::erase_if(strokes_, [](const Stroke& stroke) { return !stroke.goes_on; });
  for (Stroke& stroke : strokes_) stroke.goes_on = false;
}

// Tetrahedra near the last sheet, and that before if the blade looks back.
std::vector<Index> Blades::tets_near(const SweptSheets& swept, const Blade& blade,
                                     const BodyNow& body) const {
  const Sheet* last = blade.looks_back ? swept.before_last() : nullptr;
  const double reach = blade.reach(grains);
  const Eigen::AlignedBox3d box = last ? swept.last_box().merged(last->box()) : swept.last_box();
  const Vec3d around = Vec3d::Constant(reach);
  const Sheet* now = nullptr;  // made when the first tetrahedron is near
  const auto may_reach = [&](const auto& x) {
    if (!now) now = &swept.last();
    return now->may_reach(x, reach) || (last && last->may_reach(x, reach));
  };
  return body.tets_in({{box.min() - around, box.max() + around}, may_reach, may_reach});
}

Blades::Row Blades::places_at(const BladePose& pose, Stroke& stroke, std::size_t count) const {
  Row row(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double share = double(i) / double(count - 1);
    row[i].place = (1 - share) * pose.tip + share * pose.heel +
                   1e-7 * grains.mean_edge() * off_line(stroke.rows_made, i);
  }
  ++stroke.rows_made;
  return row;
}

// The first grain that each is in. Stations stand in a line: those in a box follow each other.
void Blades::find_in_body(Row& row, const PlacedTets& tets) const {
  constexpr double flat = 1e-3;
  auto left = std::count_if(row.begin(), row.end(), [](const BladePoint& point) { return point.grain < 0; });
  const Vec3d start = row.front().place, way = row.back().place - start;
  Eigen::Index axis = 0;
  way.cwiseAbs().maxCoeff(&axis);
  const double per_station = way[axis] / double(row.size() - 1);
  const auto station_at = [&](double x) {
    return std::clamp((x - start[axis]) / per_station, -1.0, double(row.size()));
  };
  for (std::size_t i = 0; i < tets.size() && left > 0; ++i) {
    const auto of_tet = tets.grains_of(tets[i]);
    const Eigen::AlignedBox3d box = box_around(of_tet);
    const auto [first, last] = std::minmax({station_at(box.min()[axis]), station_at(box.max()[axis])});
    const auto end = static_cast<std::size_t>(std::floor(last) + 1);
    for (auto at = static_cast<std::size_t>(std::max(0.0, std::ceil(first))); at < end && at < row.size();
         ++at) {
      BladePoint& station = row[at];
      if (station.grain >= 0 || !box.contains(station.place)) continue;
      const Placement& placement = tets.of(tets[i]);
      if (placement.gradient.determinant() < flat) break;
      const Vec3d rest = placement.start + placement.gradient.inverse() * (station.place - placement.image);
      const auto in = std::find_if(of_tet.begin(), of_tet.end(),
                                   [&](const auto& placed) { return is_in(grains, placed.grain, rest); });
      if (in == of_tet.end()) continue;
      station.grain = in->grain;
      station.rest = rest;
      --left;
    }
  }
}

bool Blades::has_moved_since(const Row& row, const std::vector<Vec3d>& places) {
  for (std::size_t i = 0; i < row.size(); ++i)
    if (row[i].place != places[i]) return true;
  return false;
}

// A station that has not moved is exactly where it was: sheets of a body at rest have their rows in common.
// One outside the body goes with the nearest within, so that the edge stays a line.
std::vector<Vec3d> Blades::places_of(const Row& row, const BodyNow& body) const {
  std::vector<Vec3d> places, moves(row.size(), Vec3d::Zero());
  std::vector<std::size_t> inside;
  inside.reserve(row.size());
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (row[i].grain < 0 || grains.of(grains[row[i].grain].element).empty()) continue;
    inside.push_back(i);
    const Vec3d move = body.placement(grains[row[i].grain].element)(row[i].rest) - row[i].place;
    if (move.norm() > 1e-9 * grains.mean_edge()) moves[i] = move;
  }
  places.reserve(row.size());
  for (std::size_t i = 0, next = 0; i < row.size(); ++i) {  // next: in inside, the first not before i
    while (next < inside.size() && inside[next] < i) ++next;
    const bool has_before = next > 0, has_after = next < inside.size();
    Vec3d move = Vec3d::Zero();
    if (has_before && (!has_after || i - inside[next - 1] <= inside[next] - i))
      move = moves[inside[next - 1]];
    else if (has_after)
      move = moves[inside[next]];
    places.push_back(row[i].place + move);
  }
  return places;
}

// Rows that would stand nearer to each other than a quarter of an edge tell nothing more of what was swept.
bool Blades::is_new_beside(const Row& row, const std::vector<Vec3d>& before) const {
  double apart = 0;
  for (std::size_t i = 0; i < before.size(); ++i) apart = std::max(apart, (row[i].place - before[i]).norm());
  return before.empty() || !(apart < grains.mean_edge() / 4);
}

void Blades::keep(Row row, bool is_new, Stroke& stroke) {
  if (is_new)
    stroke.rows.push_back(std::move(row));
  else
    stroke.rows.back() = std::move(row);
  if (stroke.rows.size() > most_rows) stroke.rows.erase(stroke.rows.begin());
}

void Blades::set_state(const State& state) {
  grains.set_on(state.on);
  strokes_ = state.strokes;
  begun_ = state.begun;
}

bool Blades::fits(const State& state, const Grains* grains) {
  if (!grains) return state.on.empty() && state.strokes.empty() && state.begun == 0;
  const auto is_station = [&](const BladePoint& s) {
    return s.grain >= -1 && s.grain < grains->count() && s.rest.allFinite() && s.place.allFinite();
  };
  for (const Stroke& stroke : state.strokes) {
    if (stroke.bit < 0 || stroke.bit >= Grains::most_strokes || stroke.rows.empty() || stroke.begun < 0 ||
        stroke.begun >= state.begun || stroke.points_seen < 0 || stroke.points_seen > grains->point_count())
      return false;
    for (const Row& row : stroke.rows)
      if (row.size() < 2 || row.size() != stroke.rows.front().size() ||
          !std::all_of(row.begin(), row.end(), is_station))
        return false;
  }
  return Index(state.on.size()) == grains->point_count();
}

}  // namespace lobe
