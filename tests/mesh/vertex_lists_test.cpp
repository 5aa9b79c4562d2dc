#include "lobe/mesh/vertex_lists.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>

using namespace lobe;

TEST_CASE("lists that move into places that others have left hold what plain lists hold") {
  std::mt19937 random(1);
  const auto below = [&](int n) { return static_cast<int>(random() % unsigned(n)); };
  VertexLists<int> lists(std::vector<Index>{3, 0, 5, 1});
  std::vector<std::vector<int>> plain(4);
  for (int i = 0; i < 20000; ++i) {
    const int v = below(static_cast<int>(plain.size()));
    std::vector<int>& list = plain[std::size_t(v)];
    switch (below(list.size() > 40 ? 3 : 12)) {
      case 0:
        lists.clear(v);
        list.clear();
        break;
      case 1:
        list.resize(std::size_t(below(12)));
        for (int& item : list) item = below(1000);
        lists.assign(v, list);
        break;
      case 2:
        if (list.empty()) break;
        lists.erase_value(v, list[list.size() / 2]);
        *std::find(list.begin(), list.end(), int(list[list.size() / 2])) = list.back();
        list.pop_back();
        break;
      case 3:
        if (plain.size() == 200) break;
        lists.add_vertex();
        plain.emplace_back();
        break;
      default:
        list.push_back(i);
        lists.append(v, i);
    }
  }
  for (std::size_t v = 0; v < plain.size(); ++v)
    CHECK(std::equal(plain[v].begin(), plain[v].end(), lists[Index(v)].begin(), lists[Index(v)].end()));
  CHECK(lists.items().size() < 45 * plain.size());  // a list of 41 has had places for 130 in all
}
