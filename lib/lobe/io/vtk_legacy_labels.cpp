// Reads POINT_DATA and CELL_DATA of legacy VTK files. It skips all but the arrays with one value per cell,
// because the labels are among these.
#include <charconv>

#include "lobe/io/vtk_legacy.h"

namespace lobe::io {
namespace {

std::string next_type(Scanner& scan) { return lower_case(scan.word("a type")); }

// The number at the end of a SCALARS line, 1 where there is none.
std::size_t components_in(std::string_view rest_of_line) {
  const std::size_t begin = rest_of_line.find_first_not_of(" \t");
  if (begin == rest_of_line.npos) return 1;
  std::size_t value = 1;
  std::from_chars(rest_of_line.data() + begin, rest_of_line.data() + rest_of_line.size(), value);
  return value;
}

// Binary strings: the top bits of the first byte say how many bytes, 8 >> bits, hold the length.
void skip_binary_string(Scanner& scan) {
  const auto first = scan.binary<std::uint8_t>("a string");
  std::uint64_t length = first & 63u;
  for (unsigned more = (8u >> (first >> 6)) - 1; more > 0; --more)
    length = length << 8 | scan.binary<std::uint8_t>("the length of a string");
  scan.bytes(length, "a string");
}

void skip_strings(Scanner& scan, std::size_t count) {
  scan.require_room(count, 1, "strings");
  scan.line();
  for (std::size_t i = 0; i < count; ++i) scan.is_binary() ? skip_binary_string(scan) : (void)scan.line();
}

// `arrays` is null where the values are of no interest.
void read_values(Scanner& scan, const std::string& name, const std::string& type, std::size_t components,
                 std::size_t tuples, LegacyArrays* arrays) {
  if (tuples > 0) scan.require_room(components, 1, "components of " + name);
  scan.require_room(tuples, components > 0 && type != "bit" ? 1 : 0, "values of " + name);
  const std::size_t count = components * tuples;
  if (type == "string" || type == "utf8_string")
    skip_strings(scan, count);
  else if (auto values = read_legacy_array(scan, type, count, name); arrays && components == 1)
    arrays->push_back({name, std::move(values), type != "bit" && type != "float" && type != "double"});
  skip_legacy_metadata(scan, components);
}

void read_scalars(Scanner& scan, std::size_t tuples, LegacyArrays* arrays) {
  const std::string name(scan.word("a name")), type = next_type(scan);
  const std::size_t components = components_in(scan.line());
  scan.expect("LOOKUP_TABLE");
  scan.word("the name of a lookup table");
  read_values(scan, name, type, components, tuples, arrays);
}

void read_vectors(Scanner& scan, std::size_t components, std::size_t tuples, LegacyArrays* arrays) {
  const std::string name(scan.word("a name"));
  read_values(scan, name, next_type(scan), components, tuples, arrays);
}

void read_texture_coordinates(Scanner& scan, std::size_t tuples) {
  const std::string name(scan.word("a name"));
  const auto components = static_cast<std::size_t>(scan.integer("the dimension", 1, 3));
  read_values(scan, name, next_type(scan), components, tuples, nullptr);
}

// Colours are bytes in a binary file, numbers up to 1 in a text.
void read_colours(Scanner& scan, bool is_table, std::size_t tuples) {
  const std::string name(scan.word("a name"));
  const std::size_t size = scan.count("colours", 1);
  const char* type = scan.is_binary() ? "unsigned_char" : "float";
  read_values(scan, name, type, is_table ? 4 : size, is_table ? size : tuples, nullptr);
}

// False if the keyword is not that of an attribute.
bool read_attribute(Scanner& scan, const std::string& keyword, std::size_t tuples, LegacyArrays* arrays) {
  if (keyword == "scalars")
    read_scalars(scan, tuples, arrays);
  else if (keyword == "vectors" || keyword == "normals")
    read_vectors(scan, 3, tuples, nullptr);
  else if (keyword == "tensors" || keyword == "tensors6")
    read_vectors(scan, keyword == "tensors" ? 9 : 6, tuples, nullptr);
  else if (keyword == "global_ids" || keyword == "pedigree_ids" || keyword == "edge_flags")
    read_vectors(scan, 1, tuples, arrays);
  else if (keyword == "texture_coordinates")
    read_texture_coordinates(scan, tuples);
  else if (keyword == "color_scalars" || keyword == "lookup_table")
    read_colours(scan, keyword == "lookup_table", tuples);
  else if (keyword == "field")
    read_legacy_field(scan, arrays);
  else
    return false;
  return true;
}

}  // namespace

// An empty line ends the block; but names of components, one on each line, may be empty, too.
void skip_legacy_metadata(Scanner& scan, std::size_t components) {
  if (!scan.next_is("METADATA")) return;
  scan.line();
  while (scan.remaining() > 0) {
    const std::string_view line = scan.line();
    if (line.empty()) return;
    if (line == "COMPONENT_NAMES")
      for (std::size_t k = 0; k < components && scan.remaining() > 0; ++k) scan.line();
  }
}

void read_legacy_field(Scanner& scan, LegacyArrays* arrays) {
  scan.word("the name of a field");
  const std::size_t count = scan.count("arrays", 4);
  for (std::size_t i = 0; i < count; ++i) {
    const std::string name(scan.word("the name of an array"));
    const std::size_t components = scan.count("components", 0);
    const std::size_t tuples = scan.count("tuples", 0);
    read_values(scan, name, next_type(scan), components, tuples, arrays);
  }
}

LegacyArrays read_legacy_attributes(Scanner& scan, std::string keyword, std::size_t points,
                                    std::size_t cells) {
  LegacyArrays kept, *arrays = nullptr;
  std::size_t tuples = 0;
  for (;;) {
    if (keyword == "point_data" || keyword == "cell_data") {
      arrays = keyword == "cell_data" ? &kept : nullptr;
      tuples = arrays ? cells : points;
      if (static_cast<std::size_t>(scan.integer("the number of points or cells", 0, 1LL << 40)) != tuples)
        scan.fail("data of another number of " + std::string(arrays ? "cells" : "points") + ", expected " +
                  std::to_string(tuples));
    } else if (!read_attribute(scan, keyword, tuples, arrays)) {
      scan.fail("unknown keyword, expected SCALARS, VECTORS, FIELD …");
    }
    if (scan.at_end()) break;
    keyword = lower_case(scan.word("a keyword"));
  }
  // A field may hold arrays of any length; only one value per cell can be labels.
  std::erase_if(kept, [&](const CellArray& array) { return array.values.size() != cells; });
  return kept;
}

}  // namespace lobe::io
