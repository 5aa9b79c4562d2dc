// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// OBJ and OFF.
#include <algorithm>
#include <array>
#include <cctype>

#include "lobe_mesh/polygons.h"

namespace lobe::meshing {
namespace {

using Words = std::vector<std::string_view>;

std::string quoted(std::string_view word) {
  std::string text(word.substr(0, 40));
  for (char& c : text) {
    if (!std::isprint(static_cast<unsigned char>(c))) c = '?';
  }
  return "'" + text + "'";
}

Vec3d point(const FileText& file, std::size_t line, const Words& words, std::size_t first) {
  if (words.size() < first + 3) file.fail_line(line, "expected three coordinates");
  Vec3d p;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto value = to_number(words[first + k]);
    if (!value) file.fail_line(line, "expected a coordinate, found " + quoted(words[first + k]));
    p[static_cast<Index>(k)] = *value;
  }
  return p;
}

// "7", "7/1", "7//3", "-2" → 0-based.
std::int64_t obj_corner(const FileText& file, std::size_t line, std::string_view word, std::size_t points) {
  const auto index = to_integer(word.substr(0, word.find('/')));
  if (!index || *index == 0) file.fail_line(line, "expected a vertex index (not 0), found " + quoted(word));
  return *index > 0 ? *index - 1 : static_cast<std::int64_t>(points) + *index;
}

}  // namespace

namespace {

// By which of three words an OBJ file divides its faces: the first that names more than one group.
class ObjGroups {
 public:
  bool takes(const Words& words) {
    const auto kind = std::find(kinds.begin(), kinds.end(), words[0]);
    if (kind == kinds.end()) return false;
    const auto k = std::size_t(kind - kinds.begin());
    names_[k].push_back(joined_words(words, 1));
    present_[k] = names_[k].size() - 1;
    return true;
  }
  void add_face() { faces_.push_back(present_); }
  std::vector<std::string> names() const {
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      std::vector<std::string> names;
      for (const auto& face : faces_) names.push_back(names_[k][face[k]]);
      if (std::any_of(names.begin(), names.end(), [&](const auto& name) { return name != names[0]; }))
        return names;
    }
    return std::vector<std::string>(faces_.size());
  }

 private:
  static constexpr std::array<std::string_view, 3> kinds{"g", "o", "usemtl"};
  std::array<std::vector<std::string>, 3> names_{{{""}, {""}, {""}}};
  std::array<std::size_t, 3> present_{};
  std::vector<std::array<std::size_t, 3>> faces_;
};

}  // namespace

Polygons parse_obj(const FileText& file, std::vector<std::string>* groups) {
  static const std::array<std::string_view, 24> ignored{
      "vt",     "vn",   "vp",  "g",      "o",          "s",         "mg",    "usemtl",
      "mtllib", "l",    "p",   "maplib", "lod",        "usemap",    "curv",  "curv2",
      "surf",   "parm", "deg", "cstype", "shadow_obj", "trace_obj", "bevel", "end"};
  Polygons polygons;
  Lines lines(file);
  lines.continue_after_backslash();
  Words words;
  ObjGroups found;
  while (lines.next(words)) {
    if (groups && found.takes(words)) continue;
    if (words[0] == "v") {
      polygons.points.push_back(point(file, lines.number(), words, 1));
    } else if (words[0] == "f") {
      if (words.size() < 4) file.fail_line(lines.number(), "expected at least three corners of a face");
      auto& corners = polygons.corners.emplace_back();
      for (std::size_t i = 1; i < words.size(); ++i) {
        corners.push_back(obj_corner(file, lines.number(), words[i], polygons.points.size()));
      }
      if (groups) found.add_face();
    } else if (std::find(ignored.begin(), ignored.end(), words[0]) == ignored.end()) {
      file.fail_line(lines.number(), "expected OBJ (v, f, …), found " + quoted(words[0]));
    }
  }
  if (groups) *groups = found.names();
  return polygons;
}

Polygons parse_off(const FileText& file) {
  Lines lines(file);
  Words words;
  if (!lines.next(words) || (words[0] != "OFF" && words[0] != "COFF" && words[0] != "NOFF")) {
    file.fail("expected an OFF file (first word OFF)");
  }
  if (words.size() > 1 && words[1] == "BINARY") file.fail("binary OFF is not supported: save it as ascii");
  words.erase(words.begin());
  if (words.empty() && !lines.next(words)) file.fail("truncated: no counts");
  std::array<std::int64_t, 2> counts{};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto count = k < words.size() ? to_integer(words[k]) : std::nullopt;
    if (!count || *count < 0) file.fail_line(lines.number(), "expected the numbers of vertices and faces");
    counts[k] = *count;
  }
  Polygons polygons;
  for (std::int64_t i = 0; i < counts[0]; ++i) {
    if (!lines.next(words))
      file.fail("truncated: " + std::to_string(i) + " of " + std::to_string(counts[0]) + " vertices");
    polygons.points.push_back(point(file, lines.number(), words, 0));
  }
  for (std::int64_t f = 0; f < counts[1]; ++f) {
    if (!lines.next(words))
      file.fail("truncated: " + std::to_string(f) + " of " + std::to_string(counts[1]) + " faces");
    const auto n = to_integer(words[0]);
    if (!n || *n < 3)
      file.fail_line(lines.number(), "expected a number of corners of at least 3, found " + quoted(words[0]));
    if (static_cast<std::int64_t>(words.size()) <= *n) file.fail_line(lines.number(), "truncated face");
    auto& corners = polygons.corners.emplace_back();
    for (std::int64_t k = 1; k <= *n; ++k) {
      const auto v = to_integer(words[static_cast<std::size_t>(k)]);
      if (!v)
        file.fail_line(lines.number(),
                       "expected a vertex index, found " + quoted(words[static_cast<std::size_t>(k)]));
      corners.push_back(*v);
    }
  }
  return polygons;
}

}  // namespace lobe::meshing
