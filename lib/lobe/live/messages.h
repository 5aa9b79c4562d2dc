// The last messages of a session.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "lobe/live/status.h"

namespace lobe {

class Messages {
 public:
  // Adds a message. One that has come before, with other figures at most, is listed once with a count, so
  // that it hides no others. If it is the last one it keeps its number; otherwise it gets a new one, at the
  // end.
  void say(double time, const std::string& name, const std::string& text);
  // The present messages; the same pointer until there are more.
  std::shared_ptr<const std::vector<SessionMessage>> all() const { return all_; }

 private:
  static constexpr std::size_t most = 64;
  std::shared_ptr<const std::vector<SessionMessage>> all_ =
      std::make_shared<const std::vector<SessionMessage>>();
  std::uint64_t last_number_ = 0;
};

// What a text is about: the tetrahedra, vertices and hands that it names with their numbers.
std::string elements_in(std::string_view text);
// Whether two texts say the same of the same elements: all but other numbers is equal.
bool same_but_for_figures(std::string_view a, std::string_view b);

}  // namespace lobe
