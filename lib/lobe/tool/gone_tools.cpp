#include "lobe/tool/gone_tools.h"

#include <algorithm>

namespace lobe {

std::size_t GoneTools::size() const {
  return std::apply([](const auto&... chain) { return (chain.size() + ...); }, chains_);
}

ToolLists GoneTools::lists() const {
  ToolLists lists;
  for_each_kind(lists, [&]<class Kind>(std::vector<Kind>& tools) {
    std::get<SharedChain<Kind>>(chains_).visit_backwards([&](const Kind& tool) {
      tools.push_back(tool);
      return true;
    });
    std::sort(tools.begin(), tools.end(), [](const Kind& a, const Kind& b) { return a.id < b.id; });
  });
  return lists;
}

GoneTools GoneTools::from_saved(ToolLists lists) {
  GoneTools gone;
  for_each_tool(lists, [&](auto& tool) { gone.add(std::move(tool)); });
  return gone;
}

}  // namespace lobe
