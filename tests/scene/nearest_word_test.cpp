#include "lobe/scene/nearest_word.h"

#include <doctest/doctest.h>

using lobe::nearest_word;

TEST_CASE("a misspelt word finds its neighbour") {
  const std::vector<std::string> known = {"density", "name", "where", "lame_mu", "poisson_ratio"};
  CHECK(nearest_word("densty", known) == "density");
  CHECK(nearest_word("nmae", known) == "name");
  CHECK(nearest_word("poisons_ratio", known) == "poisson_ratio");
  CHECK(nearest_word("Where", known) == "where");
}

TEST_CASE("a strange word has no neighbour") {
  CHECK(nearest_word("viscosity", {"name", "where"}) == "");
  CHECK(nearest_word("", {"all", "x"}) == "");
  CHECK(nearest_word(std::string(1000, 'a'), {std::string(999, 'a')}) == "");
  CHECK(nearest_word("word", {}) == "");
}
