#include "lobe/io/vtu_data.h"

#include <zlib.h>

#include <algorithm>

#include "lobe/error.h"

namespace lobe::io {
namespace {

constexpr std::uint64_t max_zlib_ratio = 1100;  // deflate cannot compress better than 1032 to 1

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

// The bytes of one array, from raw or base64 text. Header and data may be two base64 streams in a row: a
// padding in the middle only ends a group of four digits.
class ByteStream {
 public:
  ByteStream(std::string place, std::string_view text, bool base64)
      : place_(std::move(place)), text_(text), base64_(base64) {}

  std::string read(std::uint64_t size, const char* what) {
    if (size > text_.size() + ready_.size()) fail_truncated(what);
    if (base64_)
      while (ready_.size() < size && decode_group()) {
      }
    else
      take_raw(size);
    if (ready_.size() < size) fail_truncated(what);
    std::string bytes = ready_.substr(0, size);
    ready_.erase(0, size);
    return bytes;
  }

 private:
  [[noreturn]] void fail_truncated(const char* what) const {
    throw InputError(place_,
                     std::string("its data ends within ") + what + "; the file is truncated or damaged");
  }

  void take_raw(std::uint64_t size) {
    ready_.assign(text_.substr(0, size));
    text_.remove_prefix(size);
  }

  bool decode_group() {
    std::uint32_t bits = 0;
    int digits = 0, padding = 0;
    while (digits + padding < 4 && !text_.empty()) {
      const char c = text_.front();
      const int digit = base64_digit(c);
      if (digit < 0 && c != '=' && c != ' ' && c != '\n' && c != '\r' && c != '\t') break;
      text_.remove_prefix(1);
      if (c == '=')
        ++padding;
      else if (digit >= 0)
        bits = bits << 6 | static_cast<std::uint32_t>(digit), ++digits;
    }
    if (digits < 2 || digits + padding < 4) return false;
    bits <<= 6 * (4 - digits);
    for (int k = 0; k < digits - 1; ++k) ready_ += static_cast<char>(bits >> (16 - 8 * k) & 255);
    return true;
  }

  std::string place_;
  std::string_view text_;
  bool base64_;
  std::string ready_;
};

std::uint64_t read_header(ByteStream& stream, const VtuContext& context) {
  const std::string bytes = stream.read(context.wide_headers ? 8 : 4, "a header");
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const bool little = (std::endian::native == std::endian::little) != context.swap;
    const auto byte = static_cast<unsigned char>(bytes[little ? bytes.size() - 1 - i : i]);
    value = value << 8 | byte;
  }
  return value;
}

std::string inflate_block(const std::string& packed, std::uint64_t size, const std::string& place) {
  if (size > max_zlib_ratio * (packed.size() + 1))
    throw InputError(place, "a block of " + std::to_string(packed.size()) + " compressed bytes cannot hold " +
                                std::to_string(size) + "; the file is damaged");
  std::string bytes(size, '\0');
  uLongf done = size;
  const int status = uncompress(reinterpret_cast<Bytef*>(bytes.data()), &done,
                                reinterpret_cast<const Bytef*>(packed.data()), packed.size());
  if (status != Z_OK || done != size)
    throw InputError(place, "its compressed data is damaged, expected " + std::to_string(size) + " bytes");
  return bytes;
}

// Header: number of blocks, size of a block, size of the last one if smaller (else 0), compressed sizes.
std::string read_compressed(ByteStream& stream, const VtuContext& context, const std::string& place) {
  const std::uint64_t blocks = read_header(stream, context), size = read_header(stream, context),
                      last = read_header(stream, context);
  std::vector<std::uint64_t> packed;
  for (std::uint64_t b = 0; b < blocks; ++b) packed.push_back(read_header(stream, context));
  std::string bytes;
  for (std::uint64_t b = 0; b < blocks; ++b)
    bytes += inflate_block(stream.read(packed[b], "a compressed block"),
                           b + 1 == blocks && last > 0 ? last : size, place);
  return bytes;
}

std::vector<double> read_binary(const VtuContext& context, Number type, std::string_view text, bool base64,
                                const std::string& place) {
  ByteStream stream(place, text, base64);
  const std::string bytes = context.zlib ? read_compressed(stream, context, place)
                                         : stream.read(read_header(stream, context), "its numbers");
  if (bytes.size() % size_of(type))
    throw InputError(place, std::to_string(bytes.size()) + " bytes are no whole number of values");
  return decode(type, bytes, context.swap);
}

std::size_t line_of(const VtuContext& context, const pugi::xml_node& node) {
  const auto offset =
      std::clamp<std::ptrdiff_t>(node.offset_debug(), 0, static_cast<std::ptrdiff_t>(context.xml.size()));
  return 1 + static_cast<std::size_t>(std::count(context.xml.begin(), context.xml.begin() + offset, '\n'));
}

std::vector<double> read_ascii(const VtuContext& context, const pugi::xml_node& array) {
  std::vector<double> values;
  const std::string_view text = array.text().get();
  Scanner scan(context.file, text, '\0', line_of(context, array));
  const std::string what = std::string("a value of DataArray '") + array.attribute("Name").value() + "'";
  while (!scan.at_end()) values.push_back(scan.real(what));
  return values;
}

}  // namespace

std::string place_of(const VtuContext& context, const pugi::xml_node& node) {
  std::string place = context.file + ":" + std::to_string(line_of(context, node)) + ": " + node.name();
  if (const auto name = node.attribute("Name")) place += " '" + std::string(name.value()) + "'";
  return place;
}

std::vector<double> read_data_array(const VtuContext& context, const pugi::xml_node& array) {
  const std::string place = place_of(context, array);
  const bool is_text = std::string_view(array.attribute("type").value()) == "String";
  const auto type = is_text ? Number::u8 : vtu_number(array.attribute("type").value());
  if (!type)
    throw InputError(place, std::string("type '") + array.attribute("type").value() +
                                "', expected Int8 … UInt64, Float32 or Float64");
  const std::string_view format = array.attribute("format").as_string("ascii");
  if (format == "ascii") return read_ascii(context, array);
  if (format == "binary") return read_binary(context, *type, array.text().get(), true, place);
  if (format != "appended")
    throw InputError(place, "format '" + std::string(format) + "', expected ascii, binary or appended");
  const auto offset = array.attribute("offset").as_ullong(~0ULL);
  if (offset >= context.appended.size())
    throw InputError(place, std::string("offset '") + array.attribute("offset").value() +
                                "' is not within the " + std::to_string(context.appended.size()) +
                                " bytes of AppendedData; the file is truncated or damaged");
  return read_binary(context, *type, context.appended.substr(offset), context.appended_base64, place);
}

}  // namespace lobe::io
