// Numbers as text, the same in every locale.
#pragma once

#include <charconv>
#include <string>

namespace lobe {

// The shortest text that reads back as the same number, for files.
inline std::string exact(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

// Four significant digits, for messages.
inline std::string rounded(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::general, 4).ptr};
}

}  // namespace lobe
