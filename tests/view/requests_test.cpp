#include <doctest/doctest.h>

#include "lobe/error.h"
#include "protocol.h"

using namespace lobe;
using namespace lobe::view;

namespace {

std::string fault(const std::string& json) {
  try {
    parse_request(json);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a request has its fields and its number") {
  const Request request = parse_request(
      R"({"do": "take", "number": 7, "hand": 2, "from": [0, -1, 0.5], "along": [0, 1, 0], "radius": 0.012})");
  CHECK(request.number == 7);
  const auto& take = std::get<request::Take>(request.what);
  CHECK(take.hand == 2);
  CHECK(take.from == Vec3d(0, -1, 0.5));
  CHECK(take.along == Vec3d(0, 1, 0));
  CHECK(take.radius == 0.012);
  CHECK(std::get<request::Paint>(
            parse_request(R"({"do": "paint", "at": [0, 0, 0], "radius": 1, "as": "held"})").what)
            .as == "held");
  CHECK(std::holds_alternative<request::Seen>(parse_request(R"({"do": "seen"})").what));
}

TEST_CASE("a page sews: threads and bites have numbers, and bites may be counted from the last") {
  const auto thread = std::get<request::TakeThread>(
      parse_request(
          R"({"do": "thread", "thread": 12, "stiffness": 98, "friction": 0, "strength": 20, "holds": 1.5})")
          .what);
  CHECK(thread.thread.value == 12);
  CHECK(thread.friction == 0);
  CHECK(thread.holds == 1.5);
  const auto tie = std::get<request::TieThread>(
      parse_request(R"({"do": "tie", "thread": 12, "first": 0, "last": -1, "tighten": 0.002})").what);
  CHECK(tie.first.value == 0);
  CHECK(tie.last.value == -1);
  CHECK(tie.tighten == 0.002);
  CHECK(fault(R"({"do": "drop_thread", "thread": 1.5})") == "/thread: must be an integer");
  CHECK(fault(R"({"do": "drop_thread", "thread": 1e300})") == "/thread: must be an integer");
  CHECK(fault(R"({"do": "drop_thread", "thread": 2000000})") == "/thread: is out of range");
  CHECK(fault(R"({"do": "pull_thread", "thread": 1})") == "/to: is missing from pull_thread");
}

TEST_CASE("what is wrong with a request is named") {
  CHECK(fault("") == "request: is no JSON");
  CHECK(fault("[1]") == "request: must be an object");
  CHECK(fault("{}") == "/do: must name the request");
  CHECK(fault(R"({"do": "tke"})") == "/do: \"tke\" is no request; did you mean \"take\"?");
  CHECK(fault(R"({"do": "lead", "hand": 1})") == "/to: is missing from lead");
  CHECK(fault(R"({"do": "lead", "hand": 8, "to": [0, 0, 0]})") == "/hand: must be 0 to 7");
  CHECK(fault(R"({"do": "lead", "hand": 1.5, "to": [0, 0, 0]})") == "/hand: must be an integer");
  CHECK(fault(R"({"do": "lead", "hand": 1, "to": [0, 0]})") == "/to: must be three numbers");
  CHECK(fault(R"({"do": "lead", "hand": 1, "to": [0, 0, 1e300]})") == "/to/2: is out of range");
  CHECK(fault(R"({"do": "lead", "hand": 1, "to": [0, 0, null]})") == "/to/2: must be a number");
  CHECK(fault(R"({"do": "pause", "on": 1})") == "/on: must be true or false");
  CHECK(fault(R"({"do": "save", "to": 1})") == "/to: must be a text of at most 100 bytes");
  CHECK(fault(R"({"do": "restart", "now": true})") == "/now: is no field of restart");
}

TEST_CASE("a page brings a tool by what a scene says of it, without a file") {
  const auto bring = [](const std::string& tool) {
    return R"({"do": "bring", "hand": 1, "tool": )" + tool + "}";
  };
  const Request request =
      parse_request(bring(R"({"type": "probe", "shape": {"sphere": {"radius": 0.01}}, "at": [1, 2, 3]})"));
  const auto& brought = std::get<request::Bring>(request.what).tool;
  CHECK(brought.position == Vec3d(1, 2, 3));
  CHECK(std::get<BringProbe>(brought.command).shape.radius == 0.01);
  CHECK(std::holds_alternative<BringCautery>(
      std::get<request::Bring>(
          parse_request(bring(R"({"type": "cautery", "radius": 1, "at": [0, 0, 0]})")).what)
          .tool.command));
  CHECK(fault(bring("[]")) == "/tool: must be a JSON object");
  CHECK(fault(bring(R"({"type": "cautery", "radius": -1, "at": [0, 0, 0]})")) ==
        "/tool/radius: -1, must be above 0");
  CHECK(fault(bring(R"({"type": "cautery", "radius": 1, "at": [0, 0, 1e300]})")) ==
        "/tool/at/2: is out of range");
  CHECK(fault(bring(R"({"type": "probe", "shape": {"mesh": "/etc/passwd"}, "at": [0, 0, 0]})")) ==
        "/tool/shape/mesh: a page cannot name a file of the server");
  CHECK(fault(bring(R"({"type": "grasp", "where": {"all": true}, "at": [0, 0, 0]})"))
            .find("a hand takes hold of vertices") != std::string::npos);
  CHECK(fault(bring(std::string(30000, '[') + std::string(30000, ']'))).find("at most 8 deep") !=
        std::string::npos);
}

TEST_CASE("deep and long requests are refused without harm") {
  CHECK(fault(std::string(50000, '[')) == "request: is no JSON");
  CHECK(fault(R"({"do": "save", "to": ")" + std::string(101, 'a') + "\"}") ==
        "/to: must be a text of at most 100 bytes");
}
