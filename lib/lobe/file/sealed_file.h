// Binary files of lobe: the name of the format, its version, the contents, a checksum. A file that is
// damaged, cut off, of another kind or of another version is refused. Numbers are little-endian.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "lobe/error.h"

namespace lobe::io {

// FNV-1a of 64 bits. Every single byte that differs changes it.
inline std::uint64_t digest(std::string_view bytes, std::uint64_t start = 0xcbf29ce484222325u) {
  for (const char c : bytes) start = (start ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return start;
}
template <class Value>
std::uint64_t digest_of(std::span<const Value> values, std::uint64_t start = digest({})) {
  static_assert(std::is_trivially_copyable_v<Value>);
  return digest({reinterpret_cast<const char*>(values.data()), values.size_bytes()}, start);
}

class ByteWriter {
 public:
  template <class Value>
  void put(const Value& value) {
    static_assert(std::is_arithmetic_v<Value> || std::is_enum_v<Value>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <class Value>
  void put_all(std::span<const Value> values) {  // puts their number first
    static_assert(std::is_arithmetic_v<Value>);
    put(std::uint64_t(values.size()));
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

// Throws InputError, naming the file, where the contents end too early.
class ByteReader {
 public:
  ByteReader(std::string file, std::string_view bytes) : file_(std::move(file)), left_(bytes) {}

  template <class Value>
  Value get() {
    static_assert(std::is_arithmetic_v<Value>);
    Value value;
    std::memcpy(&value, take(sizeof value), sizeof value);
    return value;
  }
  // The number of entries that follow, each of at least `bytes_each`.
  std::size_t get_count(std::size_t bytes_each) {
    const auto count = get<std::uint64_t>();
    if (count > left_.size() / bytes_each) fail();
    return std::size_t(count);
  }
  template <class Value>
  std::vector<Value> get_all() {
    std::vector<Value> values(get_count(sizeof(Value)));
    if (!values.empty())
      std::memcpy(values.data(), take(values.size() * sizeof(Value)), values.size() * sizeof(Value));
    return values;
  }
  int get_choice(int count) {  // a number of an enumeration, in one byte
    const int value = get<std::uint8_t>();
    expect(value < count);
    return value;
  }
  void expect(bool holds) const {
    if (!holds) fail();
  }
  void expect_end() const { expect(left_.empty()); }
  [[noreturn]] void fail() const {
    throw InputError(file_, "holds values that are out of range; it was not written by this program");
  }

 private:
  const char* take(std::size_t bytes) {
    if (bytes > left_.size()) fail();
    const char* begin = left_.data();
    left_.remove_prefix(bytes);
    return begin;
  }

  std::string file_;
  std::string_view left_;
};

struct Format {
  std::string_view name;  // eight characters
  std::uint32_t version;
  const char* what;  // description in messages: "state of a world"
};

void write_sealed(const std::filesystem::path& file, const Format& format, const std::string& contents);
std::string read_sealed(const std::filesystem::path& file, const Format& format);  // the contents

// Seals contents in memory, and opens them; `file` is only named in messages.
std::string seal(const Format& format, const std::string& contents);
std::string_view unseal(const std::string& file, std::string_view bytes, const Format& format);

}  // namespace lobe::io
