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
  CHECK(fault(R"({"do": "jaws", "hand": 1, "at": [0, 0, 0], "orientation": [0, 0, 1]})") ==
        "/orientation: must be four numbers");
  CHECK(fault(R"({"do": "pause", "on": 1})") == "/on: must be true or false");
  CHECK(fault(R"({"do": "save", "to": 1})") == "/to: must be a text of at most 100 bytes");
  CHECK(fault(R"({"do": "restart", "now": true})") == "/now: is no field of restart");
}

TEST_CASE("deep and long requests are refused without harm") {
  CHECK(fault(std::string(50000, '[')) == "request: is no JSON");
  CHECK(fault(R"({"do": "save", "to": ")" + std::string(101, 'a') + "\"}") ==
        "/to: must be a text of at most 100 bytes");
}
