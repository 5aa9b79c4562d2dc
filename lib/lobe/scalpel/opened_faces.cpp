#include "lobe/scalpel/opened_faces.h"

#include <algorithm>

#include "lobe/scalpel/crumbs.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

Vec3d place(const Grains& grains, const PlacedTets& tets, Index grain, const Vec3d& X) {
  return tets.of(grains[grain].element)(X);
}

Vec3d middle_of_grain(const Grains& grains, const PlacedTets& tets, Index grain) {
  const Eigen::Vector4i& p = grains[grain].points;
  return place(grains, tets, grain,
               (grains.point(p[0]) + grains.point(p[1]) + grains.point(p[2]) + grains.point(p[3])) / 4);
}

Vec3d middle_of_face(const Grains& grains, const PlacedTets& tets, Index code) {
  const Grains::Grain& data = grains[code / 4];
  const int* c = face_corners[code % 4];
  return place(
      grains, tets, code / 4,
      (grains.point(data.points[c[0]]) + grains.point(data.points[c[1]]) + grains.point(data.points[c[2]])) /
          3);
}

void open_all_but_crumbs(Grains& grains, const PlacedTets& tets, std::vector<Index> faces, Incised& incised) {
  incised.crumbs = keep_crumbs(grains, faces);
  open_faces(grains, tets, std::move(faces), incised);
}

// Whether the middle of a face is near what was swept; of a face that has waited, near the last sheet.
bool is_near(const Grains& grains, const PlacedTets& tets, const SweptSheets& swept,
             const std::vector<Index>& new_on, Index grain, const Eigen::Vector3i& points) {
  Eigen::Vector3i sorted = points;  // both sides find the same sum
  std::sort(sorted.begin(), sorted.end());
  const Vec3d middle = place(
      grains, tets, grain, (grains.point(sorted[0]) + grains.point(sorted[1]) + grains.point(sorted[2])) / 3);
  const double within = open_within * grains.mean_edge();
  const bool is_new = std::any_of(sorted.begin(), sorted.end(), [&](Index p) {
    return std::binary_search(new_on.begin(), new_on.end(), p);
  });
  return is_new ? swept.is_near(middle, within) : swept.last().distance(middle, within) < within;
}

// Grains, ascending, beside closed faces on the stroke's sheets: those around its new points, and those that
// wait.
std::vector<Index> grains_with_closed_faces(Grains& grains, int stroke, const std::vector<Index>& new_on) {
  std::vector<Index> closed = grains.waiting(stroke);
  for (Index p : new_on)
    for (Index grain : grains.around(p))
      if (grains.has_closed_face_on(grain, stroke)) closed.push_back(grain);
  sort_unique(closed);
  return closed;
}

void let_wait(Grains& grains, int stroke, std::vector<Index> closed) {
  std::erase_if(closed, [&](Index grain) { return !grains.has_closed_face_on(grain, stroke); });
  grains.waiting(stroke) = std::move(closed);
}

}  // namespace

void open_faces(Grains& grains, const PlacedTets& tets, std::vector<Index> faces, Incised& incised) {
  for (Index code : faces) {
    const Index neighbour = grains.other_side(code);
    incised.faces.push_back({grains[code / 4].element, grains[neighbour / 4].element, grains.area(code),
                             middle_of_face(grains, tets, code)});
    incised.area += incised.faces.back().area;
  }
  incised.opened = grains.open(faces, incised.incision.stroke);
  incised.incision.opened = std::move(faces);
}

void open_on_sheets(Grains& grains, const PlacedTets& tets, const SweptSheets& swept, int stroke,
                    const std::vector<Index>& new_on, Incised& incised) {
  std::vector<Index> closed = grains_with_closed_faces(grains, stroke, new_on);
  std::vector<Index> faces;  // each from the side of the lower number
  for (Index grain : closed) {
    const Eigen::Vector4i& p = grains[grain].points;
    for (int f = 0; f < 4; ++f) {
      if (grains.neighbour(grain, f) < grain || !grains.is_closed_on(grain, f, stroke)) continue;
      const int* c = face_corners[f];
      if (is_near(grains, tets, swept, new_on, grain, {p[c[0]], p[c[1]], p[c[2]]}))
        faces.push_back(4 * grain + f);
    }
  }
  open_all_but_crumbs(grains, tets, std::move(faces), incised);
  let_wait(grains, stroke, std::move(closed));
}

void open_between_sides(Grains& grains, const PlacedTets& tets, std::span<const Sheet* const> sheets,
                        const std::vector<Index>& near, Incised& incised) {
  std::vector<Index> faces;
  for (Index grain : near)
    for (int f = 0; f < 4; ++f) {
      const Index other = grains.neighbour(grain, f);
      if (other < 0 || (other < grain && std::binary_search(near.begin(), near.end(), other))) continue;
      const auto [first, second] = std::minmax(grain, other);
      if (first_crossing(sheets, middle_of_grain(grains, tets, first), middle_of_grain(grains, tets, second)))
        faces.push_back(4 * grain + f);
    }
  open_all_but_crumbs(grains, tets, std::move(faces), incised);
}

}  // namespace lobe
