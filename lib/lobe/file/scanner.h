// Private to io/: walks through the bytes of a file, text and binary, and never past their end. Every fault
// is an InputError that names the file, the line (or the byte, in a binary part), and what was expected.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

namespace lobe::io {

// The whole of a regular file; throws InputError.
std::string read_file(const std::filesystem::path& file);

std::string lower_case(std::string_view text);

class Scanner {
 public:
  // `comment`: from this character to the end of the line is blank, as in MEDIT and TetGen files.
  Scanner(std::string file, std::string_view bytes, char comment = '\0', std::size_t first_line = 1);

  // ---- Text. Words are separated by blanks, which include both characters of a Windows line end.
  bool at_end();                                   // skips blanks
  char peek();                                     // first character of the next word, '\0' at the end
  std::string_view word(const std::string& what);  // `what` names it in messages
  void expect(std::string_view keyword);           // the next word, in any case
  bool next_is(std::string_view keyword);          // whether the next word begins so
  std::string_view line();                         // the rest of this line, without its end
  bool skip_past_line(std::string_view whole);     // goes on after the next line that equals `whole`
  double real(const std::string& what);            // "nan" and "inf" are numbers, too
  std::int64_t integer(const std::string& what);
  std::int64_t integer(const std::string& what, std::int64_t lowest, std::int64_t highest);
  // A number of items, each of at least `bytes_each` bytes. A number that the rest of the file cannot hold is
  // refused, so that a damaged file cannot cause a large allocation.
  std::size_t count(const std::string& what, std::size_t bytes_each);

  // ---- Binary.
  std::string_view bytes(std::size_t size, const std::string& what);
  template <class T>
  T binary(const std::string& what) {
    char raw[sizeof(T)];
    std::memcpy(raw, bytes(sizeof(T), what).data(), sizeof(T));
    if (swap_)
      for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(raw[i], raw[sizeof(T) - 1 - i]);
    T value;
    std::memcpy(&value, raw, sizeof(T));
    return value;
  }
  void set_binary(bool swap) { binary_ = true, swap_ = swap; }
  bool is_binary() const { return binary_; }
  bool swaps() const { return swap_; }

  // Throws that `items` of `bytes_each` do not fit into the rest of the file, if so.
  void require_room(std::uint64_t items, std::size_t bytes_each, const std::string& what) const;
  std::size_t remaining() const { return bytes_.size() - at_; }
  std::string place() const;  // "cube.mesh:12"
  [[noreturn]] void fail(const std::string& message) const;

 private:
  void skip_blanks();

  std::string file_;
  std::string_view bytes_;
  std::size_t at_ = 0;
  std::size_t token_ = 0;  // place where the last word began, at which messages point
  std::size_t first_line_;
  char comment_;
  bool binary_ = false;
  bool swap_ = false;
};

}  // namespace lobe::io
