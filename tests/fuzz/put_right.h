// So that a sealed file that was changed (sealed_file.h) is looked into and not refused at once.
#pragma once

#include <cstring>
#include <string>

#include "lobe/file/sealed_file.h"

namespace lobe::fuzz {

// Gives it the right length and checksum and, at the begin of its contents, the number of what it belongs to.
inline void put_right(std::string& file, std::uint64_t belongs_to) {
  constexpr std::size_t length_at = 12, contents_at = 20, checksum_size = 8;
  if (file.size() < contents_at + 2 * checksum_size) return;
  const auto write = [&](std::size_t at, std::uint64_t value) {
    std::memcpy(&file[at], &value, sizeof value);
  };
  const std::size_t end = file.size() - checksum_size;
  write(length_at, end - contents_at);
  write(contents_at, belongs_to);
  write(end, io::digest(std::string_view(file).substr(0, end)));
}

}  // namespace lobe::fuzz
