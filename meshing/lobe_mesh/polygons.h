// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// What the readers of the formats share.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lobe/io/surface_io.h"
#include "lobe_mesh/surface.h"

namespace lobe::meshing {

// One file's content with a place in it, for messages. The readers below parse such a file.
struct FileText {
  std::string name;
  std::string text;

  [[noreturn]] void fail(const std::string& message) const;
  [[noreturn]] void fail_line(std::size_t line, const std::string& message) const;
};

// `groups`: if not null, it gets the name of the group of each polygon: the solid of an ascii STL file, what
// `g` says in OBJ, or `o` where all are in one of these, or `usemtl` where these are one, too.
Polygons parse_stl(const FileText& file, std::vector<std::string>* groups = nullptr);
Polygons parse_obj(const FileText& file, std::vector<std::string>* groups = nullptr);
Polygons parse_off(const FileText& file);
Polygons parse_ply(const FileText& file);

// Checks every index, triangulates, refuses a file without triangles.
Surface to_surface(const Polygons& polygons, const FileText& file);

// Lines of a text with their numbers; a comment from `#` on and surrounding blanks are cut off, empty lines
// skipped. In some formats a backslash at its end continues a line.
class Lines {
 public:
  explicit Lines(const FileText& file, std::size_t start = 0) : file_(file), position_(start) {}
  void continue_after_backslash() { continues_ = true; }
  bool next(std::vector<std::string_view>& words);
  std::size_t number() const { return first_; }  // of the line in which the words begin
  void count_from(std::size_t number) { number_ = first_ = number; }

 private:
  const FileText& file_;
  bool continues_ = false;
  std::size_t position_ = 0;
  std::size_t number_ = 0, first_ = 0;  // numbers of the last line read, and of the first of its words
};

// With blanks between them.
std::string joined_words(const std::vector<std::string_view>& words, std::size_t first);
std::optional<double> to_number(std::string_view word);  // accepts nan and inf
std::optional<std::int64_t> to_integer(std::string_view word);

}  // namespace lobe::meshing
