#include "lobe/io/numeric.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace lobe::io {
namespace {

template <class T>
void append(std::string_view bytes, bool swap, std::vector<double>& values) {
  values.reserve(bytes.size() / sizeof(T));
  for (std::size_t at = 0; at + sizeof(T) <= bytes.size(); at += sizeof(T)) {
    char raw[sizeof(T)];
    std::memcpy(raw, bytes.data() + at, sizeof(T));
    if (swap) std::reverse(raw, raw + sizeof(T));
    T value;
    std::memcpy(&value, raw, sizeof(T));
    values.push_back(static_cast<double>(value));
  }
}

using Name = std::pair<std::string_view, Number>;

constexpr Name vtu_names[] = {{"Int8", Number::i8},    {"UInt8", Number::u8},   {"Int16", Number::i16},
                              {"UInt16", Number::u16}, {"Int32", Number::i32},  {"UInt32", Number::u32},
                              {"Int64", Number::i64},  {"UInt64", Number::u64}, {"Float32", Number::f32},
                              {"Float64", Number::f64}};

// `long` is as on 64-bit Unix; vtkIdType was written as 32-bit integers.
constexpr Name legacy_names[] = {
    {"char", Number::i8},          {"signed_char", Number::i8},     {"unsigned_char", Number::u8},
    {"short", Number::i16},        {"unsigned_short", Number::u16}, {"int", Number::i32},
    {"unsigned_int", Number::u32}, {"long", Number::i64},           {"unsigned_long", Number::u64},
    {"long_long", Number::i64},    {"vtktypeint64", Number::i64},   {"vtktypeuint64", Number::u64},
    {"vtkidtype", Number::i32},    {"float", Number::f32},          {"double", Number::f64}};

template <std::size_t N>
std::optional<Number> find(const Name (&names)[N], std::string_view name) {
  for (const auto& [text, number] : names)
    if (text == name) return number;
  return std::nullopt;
}

}  // namespace

std::size_t size_of(Number type) {
  switch (type) {
    case Number::i8:
    case Number::u8:
      return 1;
    case Number::i16:
    case Number::u16:
      return 2;
    case Number::i32:
    case Number::u32:
    case Number::f32:
      return 4;
    default:
      return 8;
  }
}

std::optional<Number> vtu_number(std::string_view name) { return find(vtu_names, name); }
std::optional<Number> legacy_number(std::string_view name) { return find(legacy_names, name); }

std::vector<double> decode(Number type, std::string_view bytes, bool swap) {
  std::vector<double> values;
  switch (type) {
    case Number::i8:
      append<std::int8_t>(bytes, swap, values);
      break;
    case Number::u8:
      append<std::uint8_t>(bytes, swap, values);
      break;
    case Number::i16:
      append<std::int16_t>(bytes, swap, values);
      break;
    case Number::u16:
      append<std::uint16_t>(bytes, swap, values);
      break;
    case Number::i32:
      append<std::int32_t>(bytes, swap, values);
      break;
    case Number::u32:
      append<std::uint32_t>(bytes, swap, values);
      break;
    case Number::i64:
      append<std::int64_t>(bytes, swap, values);
      break;
    case Number::u64:
      append<std::uint64_t>(bytes, swap, values);
      break;
    case Number::f32:
      append<float>(bytes, swap, values);
      break;
    case Number::f64:
      append<double>(bytes, swap, values);
      break;
  }
  return values;
}

std::optional<std::int64_t> whole_number(double value, std::int64_t lowest, std::int64_t highest) {
  if (!(value >= static_cast<double>(lowest) && value <= static_cast<double>(highest))) return std::nullopt;
  if (value != std::floor(value)) return std::nullopt;
  return static_cast<std::int64_t>(value);
}

}  // namespace lobe::io
