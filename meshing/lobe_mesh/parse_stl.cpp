// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <cstring>

#include "lobe_mesh/polygons.h"

namespace lobe::meshing {
namespace {

constexpr std::size_t header_bytes = 84, triangle_bytes = 50;

std::size_t binary_count(const std::string& text) {
  std::uint32_t count = 0;
  if (text.size() >= header_bytes) std::memcpy(&count, text.data() + 80, 4);
  return count;
}

Polygons parse_binary(const FileText& file) {
  const std::size_t count = binary_count(file.text);
  Polygons polygons;
  for (std::size_t t = 0; t < count; ++t) {
    float numbers[9];
    std::memcpy(numbers, file.text.data() + header_bytes + t * triangle_bytes + 12, sizeof numbers);
    const auto n = static_cast<std::int64_t>(polygons.points.size());
    for (int k = 0; k < 3; ++k)
      polygons.points.emplace_back(numbers[3 * k], numbers[3 * k + 1], numbers[3 * k + 2]);
    polygons.corners.push_back({n, n + 1, n + 2});
  }
  return polygons;
}

Polygons parse_ascii(const FileText& file, std::vector<std::string>* groups) {
  Polygons polygons;
  Lines lines(file);
  std::vector<std::string_view> words;
  std::vector<std::int64_t> loop;
  bool ended = false;
  std::string solid;
  while (lines.next(words)) {
    const std::string_view word = words[0];
    if (word == "solid" || word == "facet" || word == "outer") {
      ended = false;
      loop.clear();
      if (word == "solid") solid = joined_words(words, 1);
    } else if (word == "vertex") {
      if (words.size() < 4) file.fail_line(lines.number(), "expected three coordinates");
      Vec3d p;
      for (int k = 0; k < 3; ++k) {
        const auto value = to_number(words[static_cast<std::size_t>(k) + 1]);
        if (!value) file.fail_line(lines.number(), "expected a coordinate");
        p[k] = *value;
      }
      loop.push_back(static_cast<std::int64_t>(polygons.points.size()));
      polygons.points.push_back(p);
    } else if (word == "endloop") {
      if (loop.size() < 3)
        file.fail_line(lines.number(), "expected three vertices in the loop that ends here");
      polygons.corners.push_back(loop);
      if (groups) groups->push_back(solid);
    } else if (word == "endsolid") {
      ended = true;
    } else if (word != "endfacet") {
      file.fail_line(lines.number(), "expected ascii STL (facet, vertex, …)");
    }
  }
  if (!ended) file.fail("truncated: no endsolid at the end");
  return polygons;
}

}  // namespace

Polygons parse_stl(const FileText& file, std::vector<std::string>* groups) {
  const std::size_t size = file.text.size();
  const std::size_t expected = header_bytes + triangle_bytes * binary_count(file.text);
  if (size >= header_bytes && size == expected) return parse_binary(file);
  if (file.text.starts_with("solid")) return parse_ascii(file, groups);
  if (size < header_bytes) file.fail("neither ascii STL (first word solid) nor long enough for binary STL");
  if (size < expected) {
    file.fail("truncated binary STL: " + std::to_string(size) + " bytes, but " +
              std::to_string(binary_count(file.text)) + " triangles take " + std::to_string(expected));
  }
  return parse_binary(file);  // some programs append their own data
}

}  // namespace lobe::meshing
