// Internal, not part of the public interface: reads JSON text, more strictly than the parser that it uses.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "lobe/types.h"

namespace lobe {

inline constexpr std::size_t max_json_bytes = std::size_t{64} << 20;
inline constexpr std::size_t max_json_depth = 64;  // most arrays and objects in each other

// Throws InputError: a syntax error as "NAME:line:column: …", a key given twice (the parser would silently
// keep the last), a number beyond double precision, too much nesting, too long a text.
nlohmann::json parse_json(std::string_view text, const std::string& name);

// Returns the JSON pointer (RFC 6901) of a child. Control characters are spelt out, so that it stays on one
// line.
std::string child_pointer(const std::string& pointer, std::string_view key);
std::string child_pointer(const std::string& pointer, std::size_t index);

inline Vec3d read_vector(const nlohmann::json& row, std::size_t from = 0) {  // three numbers from there on
  return Vec3d(row[from].get<double>(), row[from + 1].get<double>(), row[from + 2].get<double>());
}
inline nlohmann::ordered_json vector_json(const Vec3d& v) { return {v[0], v[1], v[2]}; }

// A value as messages show it: compact, on one line, cut after some 40 bytes.
std::string excerpt(const nlohmann::json& value);

}  // namespace lobe
