#include "lobe/live/messages.h"

namespace lobe {

void Messages::say(double time, const std::string& name, const std::string& text) {
  std::vector<SessionMessage> messages = *all_;
  if (!messages.empty() && messages.back().name == name && messages.back().text == text) {
    ++messages.back().times;
  } else {
    const std::uint64_t number = messages.empty() ? 1 : messages.back().number + 1;
    if (messages.size() == most) messages.erase(messages.begin());
    messages.push_back({number, time, name, text});
  }
  all_ = std::make_shared<const std::vector<SessionMessage>>(std::move(messages));
}

}  // namespace lobe
