// The last things that a session had to say.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lobe/live/status.h"

namespace lobe {

class Messages {
 public:
  // What is said many times in a row is one message, so that nobody can drown the others out.
  void say(double time, const std::string& name, const std::string& text);
  // As they are now; the same pointer until more is said.
  std::shared_ptr<const std::vector<SessionMessage>> all() const { return all_; }

 private:
  static constexpr std::size_t most = 64;
  std::shared_ptr<const std::vector<SessionMessage>> all_ =
      std::make_shared<const std::vector<SessionMessage>>();
};

}  // namespace lobe
