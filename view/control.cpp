#include "control.h"

#include <algorithm>
#include <utility>

#include "lobe/error.h"

namespace lobe::view {

void Control::opened(ClientId page) {
  pages_.push_back(page);
  if (pages_.size() == 1) give(page);
}

void Control::closed(ClientId page) {
  for (std::vector<ClientId>* list : {&pages_, &holders_, &askers_}) std::erase(*list, page);
  refused_.erase(page);
  if (page != holder_) return;
  if (!askers_.empty()) return give(askers_.front());
  if (!holders_.empty()) return give(holders_.back());
  give(pages_.size() == 1 ? pages_.front() : 0);
}

// Those who have asked go on asking the new holder.
void Control::give(ClientId page) {
  if (holder_ != 0 && std::count(pages_.begin(), pages_.end(), holder_) > 0) holders_.push_back(holder_);
  holder_ = page;
  for (std::vector<ClientId>* list : {&holders_, &askers_}) std::erase(*list, page);
  asked_ = last_act_ = std::chrono::steady_clock::now();
  refused_.clear();
}

void Control::ask(ClientId page, Time now) {
  if (page == holder_ || has_asked(page)) return;
  if (holder_ == 0) return give(page);
  if (const auto refused = refused_.find(page);
      refused != refused_.end() && now < refused->second + patience_)
    throw InputError("/do", "the page that holds the instruments keeps them: ask again in some seconds");
  if (askers_.empty()) asked_ = now;
  askers_.push_back(page);
}

void Control::grant() {
  if (!askers_.empty()) give(askers_.front());
}

std::vector<ClientId> Control::refuse(Time now) {
  for (const ClientId page : askers_) refused_[page] = now;
  return std::exchange(askers_, {});
}

void Control::settle(bool holds_tool, Time now) {
  if (!holds_tool && now >= deadline()) grant();
}

bool Control::has_asked(ClientId page) const { return std::count(askers_.begin(), askers_.end(), page) > 0; }

Control::Time Control::deadline() const {
  return askers_.empty() ? Time::max() : std::max(asked_, last_act_) + patience_;
}

}  // namespace lobe::view
