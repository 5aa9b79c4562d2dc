// A step of a blade is repeated from what a recording says of it: no predicate asks where the blade is.
#include <algorithm>
#include <utility>

#include "lobe/error.h"
#include "lobe/scalpel/blades.h"
#include "lobe/scalpel/opened_faces.h"

namespace lobe {

Incised Blades::repeat(const BladeMove& move, const BladeCut& made, std::size_t number, const BodyNow& body) {
  const BladeCut::Step& step = made.steps[number];
  Stroke* stroke = stroke_of(move);
  if (!stroke) throw InputError("frame", "has cuts of a blade that waits");
  if (stroke->rows.empty()) {
    Row row = first_row(move, *stroke);
    put_at(made.begun, row);
    stroke->rows = {std::move(row)};
  }
  follow_divided(*stroke);
  Incised caught_up = repeat(step.caught_up, step.taken_before, *stroke, move, body);
  Row now = places_at(move.to, *stroke, stroke->rows.back().size());
  if (step.row) put_at(step.row->stations, now);
  Incised incised = repeat(step.incision, step.taken, *stroke, move, body);
  stroke->points_seen = grains.point_count();
  if (step.row) keep(std::move(now), step.row->is_new, *stroke);
  incised.follow(std::move(caught_up));
  incised.way = step.way;
  incised.crumbs = step.crumbs;
  incised.refused = step.refused;
  return incised;
}

Incised Blades::repeat(const Incision& incision, const std::vector<Index>& taken, const Stroke& stroke,
                       const BladeMove& move, const BodyNow& body) {
  Incised incised;
  if (incision.stroke < 0 && incision.empty() && taken.empty()) return incised;  // the step made none
  if (incision.stroke != stroke.begun) throw InputError("incision", "is of another stroke");
  if (!std::all_of(taken.begin(), taken.end(), [&](Index p) { return p >= 0 && p < grains.point_count(); }))
    throw InputError("incision", "takes a point that there is not");
  for (Index p : taken) grains.put_on(p, stroke.bit);
  std::vector<Index> new_on = taken;
  for (std::size_t i = 0; i < incision.bisections.size(); ++i)
    new_on.push_back(grains.point_count() + static_cast<Index>(i));
  divide_again(incision, grains, 1u << stroke.bit);
  incised.incision.stroke = incision.stroke;
  const PlacedTets tets(grains, {}, body.placement);
  if (move.along_faces)
    open_faces(grains, tets, incision.opened, incised);
  else
    open_again(grains, tets, stroke.bit, new_on, incision.opened, incised);
  return incised;
}

// Puts points of an edge where they were found in the body.
void Blades::put_at(const std::vector<BladeCut::Station>& stations, Row& row) const {
  const auto is_there = [&](const BladeCut::Station& s) {
    return s.at >= 0 && std::size_t(s.at) < row.size() && s.grain >= 0 && s.grain < grains.count() &&
           s.rest.allFinite();
  };
  if (!std::all_of(stations.begin(), stations.end(), is_there) ||
      !std::all_of(row.begin(), row.end(), [](const BladePoint& point) { return point.place.allFinite(); }))
    throw InputError("frame", "has a blade's edge in grains that there are not");
  for (const BladeCut::Station& s : stations) {
    row[std::size_t(s.at)].grain = s.grain;
    row[std::size_t(s.at)].rest = s.rest;
  }
}

}  // namespace lobe
