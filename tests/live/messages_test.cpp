#include "lobe/live/messages.h"

#include <doctest/doctest.h>

using namespace lobe;

TEST_CASE("figures may differ between two messages of one kind; elements and words may not") {
  const std::string crushed = "tetrahedron 2898 is at -0.02145 of its volume, inverted: 2e-05 of 3 N";
  CHECK(
      same_but_for_figures(crushed, "tetrahedron 2898 is at 0.5 of its volume, inverted: 17 of -3.5e+12 N"));
  CHECK(!same_but_for_figures(crushed,
                              "tetrahedron 2899 is at -0.02145 of its volume, inverted: 2e-05 of 3 N"));
  CHECK(!same_but_for_figures("hand 0 of page: 3 N", "hand 1 of page: 3 N"));
  CHECK(!same_but_for_figures("hand 0 of page1: 3 N", "hand 0 of page2: 3 N"));  // a name, not a figure
  CHECK(!same_but_for_figures("3 N", "3 m"));
  CHECK(!same_but_for_figures("", "3"));
  CHECK(same_but_for_figures("", ""));
}

TEST_CASE("the elements that a text names") {
  CHECK(elements_in("vertex 3 of tetrahedron 12 was the fastest; 4 N") == "vertex 3 tetrahedron 12");
  CHECK(elements_in("hand 0 of page: it slipped off, pulled with 20.51 N, more than 20 N") == "hand 0");
  CHECK(elements_in("12 tetrahedra came loose").empty());
  CHECK(elements_in("tetrahedron ").empty());
}

TEST_CASE("what is said again is one message with a count, whatever was said between, and hides nothing") {
  Messages messages;
  for (int i = 0; i < 500; ++i) {
    const std::string figure = std::to_string(0.001 * i);
    messages.say(0.1 * i, "crushed", "tetrahedron 1 is at " + figure);
    messages.say(0.1 * i, "crushed", "tetrahedron 2 is at " + figure);
    if (i == 0) messages.say(0, "refused", "page: no such hand");
  }
  const auto all = messages.all();
  REQUIRE(all->size() == 3);
  CHECK(all->at(0).name == "refused");
  for (const std::size_t i : {1, 2}) {
    CHECK(all->at(i).times == 500);
    CHECK(all->at(i).time == 0);
    CHECK(all->at(i).about == "tetrahedron " + std::to_string(i));
    CHECK(all->at(i).text == "tetrahedron " + std::to_string(i) + " is at 0.499000");
  }
}

TEST_CASE("a message has a new number when it is said again after others, so that a reader sees it") {
  Messages messages;
  messages.say(0, "a", "1 N");
  messages.say(0, "a", "2 N");
  CHECK(messages.all()->back().number == 1);
  messages.say(0, "b", "x");
  messages.say(0, "a", "3 N");
  CHECK(messages.all()->back().number == 3);
  CHECK(messages.all()->back().text == "3 N");
  CHECK(messages.all()->front().number == 2);
  messages.say(0, "a", "other words");
  CHECK(messages.all()->back().number == 4);
}
