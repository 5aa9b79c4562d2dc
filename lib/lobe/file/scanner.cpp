#include "lobe/file/scanner.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <limits>
#include <system_error>

#include "lobe/error.h"

namespace lobe::io {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f'; }

// As much of a word as fits into a message, without control characters.
std::string quoted(std::string_view word) {
  std::string text;
  for (const char c : word.substr(0, 40)) text += (c >= 32 && c < 127) ? c : '?';
  return "'" + text + (word.size() > 40 ? "…'" : "'");
}

// Out of range of a double: tiny numbers are 0, the others infinite.
double saturated(std::string_view word) {
  const bool tiny = word.find("e-") != word.npos || word.find("E-") != word.npos;
  const double size = tiny ? 0.0 : std::numeric_limits<double>::infinity();
  return word.front() == '-' ? -size : size;
}

}  // namespace

std::string read_file(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) throw InputError(file.string(), "no such file");
  if (!std::filesystem::is_regular_file(status)) throw InputError(file.string(), "is not a regular file");
  const auto size = std::filesystem::file_size(file, error);
  if (error) throw InputError(file.string(), "cannot be read: " + error.message());
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file.string(), "cannot be opened; check its permissions");
  std::string bytes(size, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  if (bytes.empty()) throw InputError(file.string(), "is empty");
  return bytes;
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

Scanner::Scanner(std::string file, std::string_view bytes, char comment, std::size_t first_line)
    : file_(std::move(file)), bytes_(bytes), first_line_(first_line), comment_(comment) {}

void Scanner::skip_blanks() {
  while (at_ < bytes_.size()) {
    if (comment_ != '\0' && bytes_[at_] == comment_)
      while (at_ < bytes_.size() && bytes_[at_] != '\n') ++at_;
    else if (is_blank(bytes_[at_]))
      ++at_;
    else
      return;
  }
}

bool Scanner::at_end() { return peek() == '\0' && at_ == bytes_.size(); }

char Scanner::peek() {
  skip_blanks();
  token_ = at_;
  return at_ < bytes_.size() ? bytes_[at_] : '\0';
}

std::string_view Scanner::word(const std::string& what) {
  if (at_end()) fail("the file ends where " + what + " is expected; it is truncated");
  while (at_ < bytes_.size() && !is_blank(bytes_[at_]) && (comment_ == '\0' || bytes_[at_] != comment_))
    ++at_;
  return bytes_.substr(token_, at_ - token_);
}

bool Scanner::next_is(std::string_view keyword) {
  skip_blanks();
  return bytes_.substr(at_).starts_with(keyword);
}

void Scanner::expect(std::string_view keyword) {
  const std::string_view found = word(std::string(keyword));
  if (lower_case(found) != lower_case(keyword)) fail(quoted(found) + ", expected " + std::string(keyword));
}

std::string_view Scanner::line() {
  token_ = at_;
  const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
  std::string_view text = bytes_.substr(at_, end - at_);
  at_ = std::min(end + 1, bytes_.size());
  if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
  return text;
}

bool Scanner::skip_past_line(std::string_view whole) {
  std::size_t found = bytes_.find(whole, at_);
  while (found != bytes_.npos) {
    const std::size_t end = found + whole.size();
    if (found == 0 || bytes_[found - 1] == '\n')
      if (end == bytes_.size() || is_blank(bytes_[end])) {
        at_ = end;
        return true;
      }
    found = bytes_.find(whole, end);
  }
  return false;
}

double Scanner::real(const std::string& what) {
  const std::string_view text = word(what);
  const std::string_view digits = text.front() == '+' ? text.substr(1) : text;
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::invalid_argument || end != digits.data() + digits.size())
    fail(quoted(text) + ", expected " + what + ", a number");
  return error == std::errc::result_out_of_range ? saturated(digits) : value;
}

std::int64_t Scanner::integer(const std::string& what) {
  const std::string_view text = word(what);
  const std::string_view digits = text.front() == '+' ? text.substr(1) : text;
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size())
    fail(quoted(text) + ", expected " + what + ", a whole number");
  return value;
}

std::int64_t Scanner::integer(const std::string& what, std::int64_t lowest, std::int64_t highest) {
  const std::int64_t value = integer(what);
  if (value < lowest || value > highest)
    fail(what + " is " + std::to_string(value) + ", expected " + std::to_string(lowest) + " … " +
         std::to_string(highest));
  return value;
}

std::size_t Scanner::count(const std::string& what, std::size_t bytes_each) {
  const std::int64_t value = integer("the number of " + what);
  if (value < 0) fail("the number of " + what + " is " + std::to_string(value) + ", expected 0 or more");
  require_room(static_cast<std::uint64_t>(value), bytes_each, what);
  return static_cast<std::size_t>(value);
}

void Scanner::require_room(std::uint64_t items, std::size_t bytes_each, const std::string& what) const {
  // The last number of a text file needs no blank after it.
  if (items == 0 || items <= (remaining() + 1) / std::max<std::size_t>(bytes_each, 1)) return;
  fail(std::to_string(items) + " " + what + " are announced, but only " + std::to_string(remaining()) +
       " bytes follow; the file is truncated or damaged");
}

std::string_view Scanner::bytes(std::size_t size, const std::string& what) {
  token_ = at_;
  if (size > remaining())
    fail("the file ends within " + what + ": " + std::to_string(size) + " bytes expected, " +
         std::to_string(remaining()) + " left; it is truncated");
  at_ += size;
  return bytes_.substr(token_, size);
}

std::string Scanner::place() const {
  if (binary_) return file_ + ": byte " + std::to_string(token_);
  const auto lines = std::count(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(token_), '\n');
  return file_ + ":" + std::to_string(first_line_ + static_cast<std::size_t>(lines));
}

void Scanner::fail(const std::string& message) const { throw InputError(place(), message); }

}  // namespace lobe::io
