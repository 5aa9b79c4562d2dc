// Pages that hold the instruments, ask for them and go, without a network.
#include <doctest/doctest.h>

#include "viewed.h"

using namespace lobe;
using namespace lobe::view;
using namespace lobe::test;

namespace {

constexpr std::chrono::milliseconds patience(300);

Viewed impatient() {
  return Viewed(false, "none", {}, [](ViewerOptions& options) { options.patience = patience; });
}

bool comes_to_control(Viewed& viewed, ClientId page) {
  return viewed.comes_to(page,
                         [](const Json& status, const Json&) { return status["controls"].get<bool>(); });
}

}  // namespace

TEST_CASE("a page that watches can do nothing, until it is handed the instruments") {
  Viewed viewed;
  viewed.viewer->opened(1);
  viewed.viewer->opened(2);
  viewed.take(1, 0, 0.03, 0.03);
  REQUIRE(viewed.holds(2, 1));
  CHECK_FALSE(viewed.frame(2)[0]["controls"].get<bool>());
  viewed.ask(2, {{"do", "let_go"}, {"hand", 0}});
  viewed.ask(2, {{"do", "restart"}});
  viewed.ask(2, {{"do", "control"}});
  for (int i = 0; i < 20; ++i) viewed.frame(2);
  CHECK(viewed.frame(2)[1].size() == 1);
  viewed.ask(1, {{"do", "hand_over"}});
  CHECK(viewed.comes_to(2, [](const Json& status, const Json& tools) {
    return status["controls"].get<bool>() && tools.empty();
  }));
  viewed.take(2, 0, 0.03, 0.03);
  CHECK(viewed.holds(1, 1));
}

TEST_CASE("a page that dies in the middle of a drag lets go, and the next one controls") {
  Viewed viewed;
  viewed.viewer->opened(1);
  viewed.viewer->opened(2);
  viewed.take(1, 0, 0.03, 0.03);
  viewed.lead(1, 0, 0.03, 0.03, 0.08);
  REQUIRE(viewed.holds(2, 1));
  viewed.viewer->closed(1);
  CHECK(viewed.holds(2, 0));
  viewed.ask(2, {{"do", "control"}});
  viewed.take(2, 3, 0.03, 0.03);
  CHECK(viewed.holds(2, 1));
}

TEST_CASE("a page is told who controls, that it has asked, and how many ask it") {
  Viewed viewed;
  for (const ClientId page : {1, 2, 3}) viewed.viewer->opened(page);
  viewed.take(1, 0, 0.03, 0.03);
  REQUIRE(viewed.holds(1, 1));
  viewed.ask(2, {{"do", "control"}});
  viewed.ask(3, {{"do", "control"}});
  const auto status = [&](ClientId page) { return viewed.frame(page)[0]; };
  CHECK(viewed.comes_to(1, [](const Json& status, const Json&) { return status["askers"] == 2; }));
  CHECK(status(1)["controls"] == true);
  CHECK(status(1)["asks"] == false);
  CHECK(status(2)["asks"] == true);
  CHECK(status(2)["controlled"] == true);
  viewed.ask(1, {{"do", "keep"}});
  CHECK(viewed.comes_to(2, [](const Json& status, const Json&) { return status["asks"] == false; }));
  CHECK(status(1)["askers"] == 0);
  viewed.ask(2, {{"do", "control"}});  // too soon after that
  CHECK(status(2)["asks"] == false);
  CHECK(status(1)["controls"] == true);
}

TEST_CASE("a hand that holds something keeps it, however long its page is silent; an empty one does not") {
  Viewed viewed = impatient();
  viewed.viewer->opened(1);
  viewed.viewer->opened(2);
  viewed.take(1, 0, 0.03, 0.03);
  REQUIRE(viewed.holds(1, 1));
  viewed.ask(2, {{"do", "control"}});
  const auto begun = std::chrono::steady_clock::now();
  while (std::chrono::steady_clock::now() - begun < 4 * patience) {
    const std::vector<Json> seen = viewed.frame(2);
    CHECK(seen[0]["controls"] == false);
    CHECK(seen[1].size() == 1);
  }
  viewed.ask(1, {{"do", "let_go"}, {"hand", 0}});
  CHECK(comes_to_control(viewed, 2));  // a moment later
  CHECK(viewed.frame(1)[0]["controls"] == false);
}

TEST_CASE("an empty hand whose page paints or acts keeps the instruments") {
  Viewed viewed = impatient();
  viewed.viewer->opened(1);
  viewed.viewer->opened(2);
  viewed.ask(2, {{"do", "control"}});
  const auto begun = std::chrono::steady_clock::now();
  while (std::chrono::steady_clock::now() - begun < 4 * patience) {
    viewed.ask(1, {{"do", "speed"}, {"factor", 1}});
    CHECK(viewed.frame(2)[0]["controls"] == false);
  }
  CHECK(comes_to_control(viewed, 2));
}

TEST_CASE("an idle page loses the instruments while the simulation pauses, too") {
  Viewed viewed = impatient();
  viewed.viewer->opened(1);
  viewed.viewer->opened(2);
  viewed.pause(1);
  viewed.ask(2, {{"do", "control"}});
  CHECK(comes_to_control(viewed, 2));
}

TEST_CASE("control returns to the page that is left, and to the one that had it before") {
  Viewed viewed;
  for (const ClientId page : {1, 2, 3}) viewed.viewer->opened(page);
  viewed.ask(2, {{"do", "control"}});
  viewed.ask(1, {{"do", "hand_over"}});
  REQUIRE(comes_to_control(viewed, 2));
  viewed.viewer->closed(2);
  REQUIRE(comes_to_control(viewed, 1));
  viewed.viewer->opened(4);
  viewed.viewer->closed(1);  // of 3 and 4 neither had it
  CHECK(viewed.comes_to(3, [](const Json& status, const Json&) {
    return !status["controls"].get<bool>() && !status["controlled"].get<bool>();
  }));
  viewed.take(4, 0, 0.03, 0.03);  // is refused
  viewed.viewer->closed(4);
  CHECK(viewed.comes_to(3, [](const Json& status, const Json& tools) {
    return !status["controlled"].get<bool>() && tools.empty();
  }));
  viewed.ask(3, {{"do", "control"}});
  CHECK(comes_to_control(viewed, 3));
  viewed.take(3, 0, 0.03, 0.03);
  CHECK(viewed.holds(3, 1));
}
