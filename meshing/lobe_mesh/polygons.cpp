// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/polygons.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <charconv>
#include <limits>

#include "lobe/error.h"

namespace lobe::meshing {
namespace {

// Area vector of a polygon by Newell's formula.
Vec3d area_vector(const std::vector<Vec3d>& points, const std::vector<std::int64_t>& corners) {
  Vec3d sum = Vec3d::Zero();
  const Vec3d& origin = points[corners[0]];
  for (std::size_t i = 0; i < corners.size(); ++i) {
    sum += (points[corners[i]] - origin).cross(points[corners[(i + 1) % corners.size()]] - origin);
  }
  return sum;
}

bool inside(const Vec3d& p, const std::array<Vec3d, 3>& triangle, const Vec3d& normal) {
  for (int k = 0; k < 3; ++k) {
    if ((triangle[(k + 1) % 3] - triangle[k]).cross(p - triangle[k]).dot(normal) < 0) return false;
  }
  return true;
}

// Ear clipping: cuts off one ear after the other, the one with the best angles first. So quadrilaterals are
// split along their better diagonal, and concave polygons are triangulated correctly.
void triangulate(const std::vector<Vec3d>& points, std::vector<std::int64_t> corners,
                 std::vector<std::array<std::int64_t, 3>>& triangles) {
  const Vec3d normal = area_vector(points, corners);
  while (corners.size() > 3) {
    const std::size_t n = corners.size();
    std::size_t best = 0;
    double best_quality = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i) {
      const std::array ear{corners[(i + n - 1) % n], corners[i], corners[(i + 1) % n]};
      const std::array<Vec3d, 3> x{points[ear[0]], points[ear[1]], points[ear[2]]};
      const double area = (x[1] - x[0]).cross(x[2] - x[0]).dot(normal);
      double quality =
          area / ((x[1] - x[0]).squaredNorm() + (x[2] - x[1]).squaredNorm() + (x[0] - x[2]).squaredNorm());
      const bool blocked = std::any_of(corners.begin(), corners.end(), [&](std::int64_t v) {
        return std::find(ear.begin(), ear.end(), v) == ear.end() && inside(points[v], x, normal);
      });
      if (blocked) quality -= 1e30;
      if (quality > best_quality) {
        best_quality = quality;
        best = i;
      }
    }
    triangles.push_back({corners[(best + n - 1) % n], corners[best], corners[(best + 1) % n]});
    corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(best));
  }
  triangles.push_back({corners[0], corners[1], corners[2]});
}

}  // namespace

void FileText::fail(const std::string& message) const { throw InputError(name, message); }

void FileText::fail_line(std::size_t line, const std::string& message) const {
  throw InputError(name + ": line " + std::to_string(line), message);
}

Surface to_surface(const Polygons& polygons, const FileText& file) {
  const auto point_count = static_cast<std::int64_t>(polygons.points.size());
  if (point_count > std::numeric_limits<Index>::max() / 8) file.fail("more points than can be indexed");
  std::vector<std::array<std::int64_t, 3>> triangles;
  for (std::size_t f = 0; f < polygons.corners.size(); ++f) {
    const auto& corners = polygons.corners[f];
    const std::string face = "face " + std::to_string(f);
    if (corners.size() < 3)
      file.fail(face + " has " + std::to_string(corners.size()) + " corners, expected at least 3");
    for (const std::int64_t v : corners) {
      if (v >= 0 && v < point_count) continue;
      file.fail(face + " uses vertex " + std::to_string(v) + " (counted from 0), but there are " +
                std::to_string(point_count));
    }
    triangulate(polygons.points, corners, triangles);
  }
  if (triangles.empty()) file.fail("no triangles in this file");
  Surface surface;
  surface.points.resize(3, point_count);
  for (std::int64_t i = 0; i < point_count; ++i) surface.points.col(i) = polygons.points[i];
  surface.triangles.resize(3, static_cast<Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) surface.triangles(k, t) = static_cast<Index>(triangles[t][k]);
  }
  return surface;
}

bool Lines::next(std::vector<std::string_view>& words) {
  const std::string_view text = file_.text;
  const std::string_view blanks = " \t\r\v\f";
  words.clear();
  bool goes_on = false;
  while (position_ < text.size()) {
    const std::size_t end = std::min(text.find('\n', position_), text.size());
    std::string_view line = text.substr(position_, end - position_);
    position_ = end + 1;
    ++number_;
    if (!goes_on) first_ = number_;
    line = line.substr(0, line.find('#'));
    line = line.substr(0, line.find_last_not_of(blanks) + 1);
    goes_on = continues_ && line.ends_with('\\');
    if (goes_on) line.remove_suffix(1);
    for (std::size_t i = line.find_first_not_of(blanks); i != line.npos;
         i = line.find_first_not_of(blanks, i)) {
      const std::size_t stop = std::min(line.find_first_of(blanks, i), line.size());
      words.push_back(line.substr(i, stop - i));
      i = stop;
    }
    if (!words.empty() && !goes_on) return true;
  }
  return !words.empty();
}

std::string joined_words(const std::vector<std::string_view>& words, std::size_t first) {
  std::string text;
  for (std::size_t i = first; i < words.size(); ++i)
    text += (text.empty() ? "" : " ") + std::string(words[i]);
  return text;
}

std::optional<double> to_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size()) return {};
  if (error == std::errc::result_out_of_range) return 0.0;  // below the smallest double
  if (error != std::errc()) return {};
  return value;
}

std::optional<std::int64_t> to_integer(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return {};
  return value;
}

}  // namespace lobe::meshing
