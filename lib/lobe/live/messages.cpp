#include "lobe/live/messages.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace lobe {
namespace {

constexpr std::array<std::string_view, 3> kinds = {"tetrahedron", "vertex", "hand"};  // of elements

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

// The length of the number at the start of a text, 0 if there is none: "-2.1e-05 of" → 8.
std::size_t number_length(std::string_view text) {
  std::size_t at = text.starts_with('-') ? 1 : 0;
  if (at >= text.size() || !is_digit(text[at])) return 0;
  const auto pass_digits = [&] {
    while (at < text.size() && is_digit(text[at])) ++at;
  };
  pass_digits();
  if (at + 1 < text.size() && text[at] == '.' && is_digit(text[at + 1])) {
    ++at;
    pass_digits();
  }
  const std::size_t sign = at + 1 < text.size() && (text[at + 1] == '-' || text[at + 1] == '+') ? 1 : 0;
  if (at + 1 + sign < text.size() && text[at] == 'e' && is_digit(text[at + 1 + sign])) {
    at += 1 + sign;
    pass_digits();
  }
  return at;
}

// Whether a number that begins at `at` is the name of an element, and not a figure.
std::string_view kind_before(std::string_view text, std::size_t at) {
  const auto found = std::find_if(kinds.begin(), kinds.end(), [&](std::string_view kind) {
    return text.substr(0, at).ends_with(std::string(kind) + ' ');
  });
  return found == kinds.end() ? std::string_view() : *found;
}

// A text with each figure as "#", and the elements that it names.
struct Parted {
  std::string words, elements;
};
Parted parted(std::string_view text) {
  Parted result;
  for (std::size_t at = 0; at < text.size();) {
    const bool may_begin = at == 0 || !std::isalnum(static_cast<unsigned char>(text[at - 1]));
    const std::size_t length = may_begin ? number_length(text.substr(at)) : 0;
    const std::string_view kind = length > 0 ? kind_before(text, at) : std::string_view();
    const std::string_view number = text.substr(at, length);
    if (!kind.empty()) {
      result.elements += result.elements.empty() ? "" : " ";
      result.elements.append(kind).append(" ").append(number);
    }
    if (length == 0)
      result.words += text[at++];
    else if (kind.empty())
      result.words += '#';
    else
      result.words += number;
    at += length;
  }
  return result;
}

}  // namespace

std::string elements_in(std::string_view text) { return parted(text).elements; }

bool same_but_for_figures(std::string_view a, std::string_view b) {
  return a == b || parted(a).words == parted(b).words;
}

void Messages::say(double time, const std::string& name, const std::string& text) {
  std::vector<SessionMessage> messages = *all_;
  const auto before = std::find_if(messages.begin(), messages.end(), [&](const SessionMessage& message) {
    return message.name == name && same_but_for_figures(message.text, text);
  });
  if (before == messages.end()) {
    if (messages.size() == most) messages.erase(messages.begin());
    messages.push_back({++last_number_, time, name, text, elements_in(text)});
  } else {
    std::rotate(before, before + 1, messages.end());
    SessionMessage& message = messages.back();
    if (message.number != last_number_) message.number = ++last_number_;
    message.text = text;
    ++message.times;
  }
  all_ = std::make_shared<const std::vector<SessionMessage>>(std::move(messages));
}

}  // namespace lobe
