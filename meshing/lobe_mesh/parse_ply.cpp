// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>

#include "lobe_mesh/polygons.h"

namespace lobe::meshing {
namespace {

struct Property {
  std::string name;
  char kind = 0;  // i signed, u unsigned, f floating point
  int bytes = 0;
  char count_kind = 0;  // of a list's length; 0: not a list
  int count_bytes = 0;
};

struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<Property> properties;
};

enum class Format { ascii, little, big };

struct Header {
  Format format = Format::ascii;
  std::vector<PlyElement> elements;
  std::size_t body = 0;   // byte where the data begin
  std::size_t lines = 0;  // of the header
};

std::pair<char, int> scalar_type(const FileText& file, std::string_view name) {
  static const std::map<std::string_view, std::pair<char, int>> types{
      {"char", {'i', 1}},  {"int8", {'i', 1}},    {"uchar", {'u', 1}},  {"uint8", {'u', 1}},
      {"short", {'i', 2}}, {"int16", {'i', 2}},   {"ushort", {'u', 2}}, {"uint16", {'u', 2}},
      {"int", {'i', 4}},   {"int32", {'i', 4}},   {"uint", {'u', 4}},   {"uint32", {'u', 4}},
      {"float", {'f', 4}}, {"float32", {'f', 4}}, {"double", {'f', 8}}, {"float64", {'f', 8}}};
  const auto found = types.find(name);
  if (found == types.end()) file.fail("unknown PLY type " + std::string(name.substr(0, 40)));
  return found->second;
}

Property property(const FileText& file, const std::vector<std::string_view>& words) {
  Property p;
  p.name = words.back();
  if (words.size() == 5 && words[1] == "list") {
    std::tie(p.count_kind, p.count_bytes) = scalar_type(file, words[2]);
    std::tie(p.kind, p.bytes) = scalar_type(file, words[3]);
  } else if (words.size() == 3) {
    std::tie(p.kind, p.bytes) = scalar_type(file, words[1]);
  } else {
    file.fail("garbled property in the PLY header");
  }
  return p;
}

Header parse_header(const FileText& file) {
  Header header;
  if (!file.text.starts_with("ply")) file.fail("expected a PLY file (first word ply)");
  const std::size_t end = file.text.find("\nend_header");
  const std::size_t body = end == std::string::npos ? end : file.text.find('\n', end + 1);
  if (body == std::string::npos) file.fail("truncated: no end_header");
  header.body = body + 1;
  const FileText text{file.name, file.text.substr(0, end + 1)};
  header.lines = static_cast<std::size_t>(std::count(text.text.begin(), text.text.end(), '\n')) + 1;
  Lines lines(text);
  std::vector<std::string_view> words;
  while (lines.next(words)) {
    if (words[0] == "format" && words.size() > 1) {
      if (words[1] == "binary_little_endian")
        header.format = Format::little;
      else if (words[1] == "binary_big_endian")
        header.format = Format::big;
      else if (words[1] != "ascii")
        file.fail("unknown PLY format " + std::string(words[1].substr(0, 40)));
    } else if (words[0] == "element" && words.size() == 3) {
      const auto count = to_integer(words[2]);
      if (!count || *count < 0) file.fail_line(lines.number(), "expected a number of elements");
      header.elements.push_back({std::string(words[1]), *count, {}});
    } else if (words[0] == "property" && words.size() >= 3 && !header.elements.empty()) {
      header.elements.back().properties.push_back(property(file, words));
    }
  }
  return header;
}

// The next scalar of the body, whatever its encoding.
class Body {
 public:
  Body(const FileText& file, const Header& header)
      : file_(file), format_(header.format), position_(header.body), lines_(file, header.body) {
    lines_.count_from(header.lines);
  }

  double scalar(char kind, int bytes) {
    return format_ == Format::ascii ? from_text() : from_bytes(kind, bytes);
  }

 private:
  double from_text() {
    if (word_ == words_.size()) {
      if (!lines_.next(words_)) file_.fail("truncated PLY body");
      word_ = 0;
    }
    const auto value = to_number(words_[word_++]);
    if (!value) file_.fail_line(lines_.number(), "expected a number");
    return *value;
  }

  double from_bytes(char kind, int bytes) {
    const auto n = static_cast<std::size_t>(bytes);
    if (position_ + n > file_.text.size()) file_.fail("truncated PLY body");
    unsigned char raw[8] = {};
    std::memcpy(raw, file_.text.data() + position_, n);
    position_ += n;
    if ((format_ == Format::big) == (std::endian::native == std::endian::little)) std::reverse(raw, raw + n);
    const auto as = [&]<class T>(T value) {
      std::memcpy(&value, raw, sizeof value);
      return static_cast<double>(value);
    };
    if (kind == 'f') return bytes == 4 ? as(float{}) : as(double{});
    if (bytes == 1) return kind == 'i' ? as(std::int8_t{}) : as(std::uint8_t{});
    if (bytes == 2) return kind == 'i' ? as(std::int16_t{}) : as(std::uint16_t{});
    return kind == 'i' ? as(std::int32_t{}) : as(std::uint32_t{});
  }

  const FileText& file_;
  Format format_;
  std::size_t position_;
  Lines lines_;
  std::vector<std::string_view> words_;
  std::size_t word_ = 0;
};

void read_element(const FileText& file, const PlyElement& element, Body& body, Polygons& polygons) {
  const bool vertex = element.name == "vertex", face = element.name == "face";
  Vec3d point = Vec3d::Zero();
  if (element.properties.empty()) return;
  for (std::int64_t i = 0; i < element.count; ++i) {
    for (const Property& p : element.properties) {
      if (p.count_kind == 0) {
        const double value = body.scalar(p.kind, p.bytes);
        if (p.name.size() == 1 && p.name[0] >= 'x' && p.name[0] <= 'z') point[p.name[0] - 'x'] = value;
        continue;
      }
      const double length = body.scalar(p.count_kind, p.count_bytes);
      if (!(length >= 0 && length < 1e6))
        file.fail("element " + std::to_string(i) + ": a list of impossible length");
      std::vector<std::int64_t> list;
      for (int k = 0; k < static_cast<int>(length); ++k) {
        const double value = body.scalar(p.kind, p.bytes);
        list.push_back(std::isfinite(value) && std::abs(value) < 1e15 ? static_cast<std::int64_t>(value)
                                                                      : -1);
      }
      if (face && (p.name == "vertex_indices" || p.name == "vertex_index"))
        polygons.corners.push_back(std::move(list));
    }
    if (vertex) polygons.points.push_back(point);
  }
}

}  // namespace

Polygons parse_ply(const FileText& file) {
  const Header header = parse_header(file);
  Body body(file, header);
  Polygons polygons;
  for (const PlyElement& element : header.elements) read_element(file, element, body, polygons);
  return polygons;
}

}  // namespace lobe::meshing
