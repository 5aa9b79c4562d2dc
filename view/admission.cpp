#include <algorithm>
#include <cctype>
#include <map>
#include <string>
#include <tuple>

#include "server.h"

namespace lobe::view {
namespace {

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return result;
}

// "localhost:8080" → "localhost", "[::1]:8080" → "[::1]"
std::string without_port(const std::string& host) {
  const std::size_t bracket = host.find(']');
  const std::size_t colon = host.find(':', bracket == std::string::npos ? 0 : bracket);
  return host.substr(0, colon);
}

}  // namespace

bool is_loopback(std::string_view host) {
  const std::string name = lower(host);
  const bool is_number = name.find_first_not_of("0123456789.") == std::string::npos;  // not 127.example.org
  return name == "localhost" || name == "::1" || name == "[::1]" || (is_number && name.starts_with("127."));
}

bool may_connect(std::string_view origin, std::string_view host, bool this_machine_alone) {
  const std::string asked = lower(host), from = lower(origin);
  if (asked.empty()) return false;
  if (this_machine_alone && !is_loopback(without_port(asked))) return false;
  return from == "http://" + asked || from == "https://" + asked;
}

ClientId least_wanted(std::span<const Stranger> strangers) {
  std::map<std::string_view, int> count;
  for (const Stranger& stranger : strangers) ++count[stranger.address];
  const auto worth = [&](const Stranger& stranger) {
    return std::tuple(-count[stranger.address], stranger.has_asked, stranger.id);
  };
  return std::min_element(strangers.begin(), strangers.end(),
                          [&](const Stranger& a, const Stranger& b) { return worth(a) < worth(b); })
      ->id;
}

}  // namespace lobe::view
