// The last messages of a session.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lobe/live/status.h"

namespace lobe {

class Messages {
 public:
  // Adds a message. If the same message comes many times in a row, it is listed once with a count, so that it
  // hides no others.
  void say(double time, const std::string& name, const std::string& text);
  // The present messages; the same pointer until there are more.
  std::shared_ptr<const std::vector<SessionMessage>> all() const { return all_; }

 private:
  static constexpr std::size_t most = 64;
  std::shared_ptr<const std::vector<SessionMessage>> all_ =
      std::make_shared<const std::vector<SessionMessage>>();
};

}  // namespace lobe
