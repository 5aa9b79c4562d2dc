// Private to io/: arrays of numbers as files hold them.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "lobe/file/scanner.h"

namespace lobe::io {

enum class Number { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

std::size_t size_of(Number type);
std::optional<Number> vtu_number(std::string_view name);     // "Float64", "UInt8", …
std::optional<Number> legacy_number(std::string_view name);  // "double", "unsigned_char", … in lower case

// Whole numbers beyond 2^53 are rounded: no index or label of ours is that large, so range checks still
// refuse them.
std::vector<double> decode(Number type, std::string_view bytes, bool swap);

// A whole number within lowest … highest (both below 2^53), or nothing.
std::optional<std::int64_t> whole_number(double value, std::int64_t lowest, std::int64_t highest);

}  // namespace lobe::io
