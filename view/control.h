// Which page holds the instruments, and which have asked for them.
//
// The first page gets them. Another one asks; the holder grants or refuses. A holder that has no tool in its
// hands and does nothing for some seconds after it was asked loses them. One that has a tool in its hands
// never does. When the holder goes, the instruments go to the page that asked first, else to the one that
// held them last before, else to the only page that is left, else to nobody.
#pragma once

#include <chrono>
#include <map>
#include <vector>

#include "server.h"

namespace lobe::view {

class Control {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Duration = std::chrono::steady_clock::duration;

  // `patience`: how long a holder without a tool may leave a question unanswered; and how long after a
  // refusal the same page cannot ask again.
  explicit Control(Duration patience) : patience_(patience) {}

  void opened(ClientId page);
  void closed(ClientId page);
  // Throws InputError if the holder has just refused this page.
  void ask(ClientId page, Time now);
  void acted(Time now) { last_act_ = now; }  // the holder
  void grant();                              // gives them to the page that asked first; nothing if none has
  std::vector<ClientId> refuse(Time now);    // returns those who had asked
  // Takes the instruments from a holder that neither holds a tool nor answers.
  void settle(bool holds_tool, Time now);

  ClientId holder() const { return holder_; }  // 0: nobody
  const std::vector<ClientId>& askers() const { return askers_; }
  bool has_asked(ClientId page) const;
  // When settle() may change something; never: Time::max().
  Time deadline() const;

 private:
  void give(ClientId page);

  const Duration patience_;
  ClientId holder_ = 0;
  std::vector<ClientId> pages_;    // pages that are open
  std::vector<ClientId> holders_;  // those of them that held the instruments before, the latest at the end
  std::vector<ClientId> askers_;   // pages that have asked, the first one first
  Time asked_{}, last_act_{};
  std::map<ClientId, Time> refused_;
};

}  // namespace lobe::view
