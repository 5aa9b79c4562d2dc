// Wavefront OBJ with texture coordinates and normals.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "lobe/error.h"
#include "lobe/file/scanner.h"
#include "lobe/io/surface_io.h"

namespace lobe {
namespace {

constexpr std::string_view blanks = " \t\r\v\f";

struct Corner {
  std::array<std::int64_t, 3> numbers;  // of point, texture coordinate, normal; −1: none
  std::size_t line = 0;
};

class ObjReader {
 public:
  explicit ObjReader(const std::filesystem::path& file) : name_(file.string()), bytes_(io::read_file(file)) {}

  TexturedSurface read() {
    while (next_line()) read_line();
    if (corners_.empty()) throw InputError(name_, "has no face, expected lines that begin with f");
    for (const Corner& corner : corners_) check(corner);
    TexturedSurface surface;
    surface.points = columns<3>(values_[0]);
    surface.texture = columns<2>(values_[1]);
    surface.normals = columns<3>(values_[2]);
    surface.triangles = numbers(0);
    surface.texture_of = numbers(1);
    surface.normal_of = numbers(2);
    return surface;
  }

 private:
  [[noreturn]] void fail(const std::string& message, std::size_t line) const {
    throw InputError(name_ + ":" + std::to_string(line), message);
  }

  // Splits the next line into words, with those that go on after a backslash; false at the end.
  bool next_line() {
    words_.clear();
    bool goes_on = true;
    for (first_line_ = line_ + 1; goes_on && at_ < bytes_.size(); ++line_) {
      const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
      std::string_view text(bytes_.data() + at_, end - at_);
      at_ = end + 1;
      text = text.substr(0, text.find('#'));
      text = text.substr(0, text.find_last_not_of(blanks) + 1);
      goes_on = !text.empty() && text.back() == '\\';
      if (goes_on) text.remove_suffix(1);
      for (std::size_t from = text.find_first_not_of(blanks); from != text.npos;) {
        const std::size_t to = std::min(text.find_first_of(blanks, from), text.size());
        words_.push_back(text.substr(from, to - from));
        from = text.find_first_not_of(blanks, to);
      }
    }
    return !words_.empty() || at_ < bytes_.size();
  }

  void read_line() {
    static constexpr std::string_view left_out[] = {
        "vp",       "g",        "o",          "s",         "mg",    "usemtl", "mtllib", "l",   "p",
        "maplib",   "lod",      "usemap",     "curv",      "curv2", "surf",   "parm",   "deg", "cstype",
        "bmat",     "step",     "trim",       "hole",      "scrv",  "sp",     "end",    "con", "bevel",
        "c_interp", "d_interp", "shadow_obj", "trace_obj", "ctech", "stech"};
    if (words_.empty()) return;
    if (words_[0] == "v") return read_numbers(0, 3);
    if (words_[0] == "vt") return read_numbers(1, 1);
    if (words_[0] == "vn") return read_numbers(2, 3);
    if (words_[0] == "f") return read_face();
    if (std::find(std::begin(left_out), std::end(left_out), words_[0]) == std::end(left_out))
      fail(quoted(words_[0]) + ", expected OBJ (v, vt, vn, f, …)", first_line_);
  }

  // The first three of the line, or two of a texture coordinate, whose second is 0 if missing.
  void read_numbers(int kind, std::size_t least) {
    if (words_.size() <= least)
      fail("expected " + std::to_string(least) + " numbers after " + std::string(words_[0]), first_line_);
    for (std::size_t i = 1; i <= (kind == 1 ? 2U : 3U); ++i)
      values_[kind].push_back(i < words_.size() ? number(words_[i]) : 0.0);
  }

  double number(std::string_view word) const {
    double value = 0;
    const char* const begin = word.data() + (word.front() == '+');
    const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
      fail(quoted(word) + ", expected a finite number", first_line_);
    return value;
  }

  void read_face() {
    if (words_.size() < 4) fail("expected at least three corners of a face", first_line_);
    std::vector<Corner> polygon;
    for (std::size_t i = 1; i < words_.size(); ++i) polygon.push_back(corner(words_[i]));
    for (std::size_t i = 2; i < polygon.size(); ++i)
      corners_.insert(corners_.end(), {polygon[0], polygon[i - 1], polygon[i]});
  }

  // "7", "7/1", "7//3", "7/1/3"; negative: from the last that was read.
  Corner corner(std::string_view word) const {
    Corner corner{{-1, -1, -1}, first_line_};
    std::string_view rest = word;
    for (int kind = 0; kind < 3; ++kind) {
      const std::size_t slash = std::min(rest.find('/'), rest.size());
      if (slash > 0 || kind == 0) corner.numbers[kind] = index(rest.substr(0, slash), kind, word);
      if (slash == rest.size()) return corner;
      rest.remove_prefix(slash + 1);
    }
    fail(quoted(word) + ", expected a corner like 1, 1/2, 1//3 or 1/2/3", first_line_);
  }

  std::int64_t index(std::string_view digits, int kind, std::string_view word) const {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || value == 0)
      fail(quoted(word) + ", expected a corner of whole numbers from 1 like 1/2/3", first_line_);
    const std::int64_t from_zero = value > 0 ? value - 1 : count(kind) + value;
    if (from_zero < 0) fail(quoted(word) + " counts back beyond the first", first_line_);
    return from_zero;
  }

  std::int64_t count(int kind) const {
    return static_cast<std::int64_t>(values_[kind].size()) / (kind == 1 ? 2 : 3);
  }

  void check(const Corner& corner) const {
    static constexpr const char* names[] = {"point", "texture coordinate", "normal"};
    for (int kind = 0; kind < 3; ++kind)
      if (corner.numbers[kind] >= count(kind))
        fail("a corner names " + std::string(names[kind]) + " " + std::to_string(corner.numbers[kind] + 1) +
                 ", but there are " + std::to_string(count(kind)),
             corner.line);
  }

  template <int rows>
  static Eigen::Matrix<double, rows, Eigen::Dynamic> columns(const std::vector<double>& values) {
    using Columns = Eigen::Matrix<double, rows, Eigen::Dynamic>;
    return Eigen::Map<const Columns>(values.data(), rows, Eigen::Index(values.size()) / rows);
  }

  Triangles numbers(int kind) const {
    Triangles result(3, Eigen::Index(corners_.size()) / 3);
    for (std::size_t i = 0; i < corners_.size(); ++i)
      result.data()[i] = static_cast<Index>(corners_[i].numbers[kind]);
    return result;
  }

  static std::string quoted(std::string_view word) {
    std::string text;
    for (const char c : word.substr(0, 40)) text += (c >= 32 && c < 127) ? c : '?';
    return "'" + text + "'";
  }

  std::string name_, bytes_;
  std::size_t at_ = 0, line_ = 0, first_line_ = 0;
  std::vector<std::string_view> words_;
  std::array<std::vector<double>, 3> values_;  // of v, vt, vn
  std::vector<Corner> corners_;                // three per triangle
};

}  // namespace

TexturedSurface read_obj(const std::filesystem::path& file) { return ObjReader(file).read(); }

}  // namespace lobe
