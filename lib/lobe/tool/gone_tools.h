// Tools of hands that were taken away, and what they have done. In hours there are thousands of them: a frame
// does not look at them, and copies share them.
#pragma once

#include <tuple>
#include <utility>

#include "lobe/shared_chain.h"
#include "lobe/tool/tool_lists.h"

namespace lobe {

class GoneTools {
 public:
  std::size_t size() const;
  template <class Kind>
  void add(Kind tool) {
    std::get<SharedChain<Kind>>(chains_).push_back(std::move(tool));
  }
  ToolLists lists() const;  // tools in ascending order of ids
  // Calls visit(tool) for the tool of this id; O(size). False if there is none.
  template <class Visit>
  bool visit(ToolId id, Visit&& visit) const {
    bool found = false;
    const auto look = [&](const auto& tool) {
      if (tool.id != id) return true;
      found = true;
      visit(tool);
      return false;
    };
    std::apply([&](const auto&... chain) { (chain.visit_backwards(look), ...); }, chains_);
    return found;
  }

  ToolLists as_saved() const { return lists(); }
  static GoneTools from_saved(ToolLists lists);
  static std::size_t unshared_bytes() { return 0; }

 private:
  template <class... Kind>
  static std::tuple<SharedChain<Kind>...> chains_of(std::tuple<std::vector<Kind> ToolLists::*...>);

  decltype(chains_of(ToolLists::fields)) chains_;
};

}  // namespace lobe
