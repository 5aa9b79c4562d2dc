// Whatever the text, reading it succeeds or throws InputError; nothing else.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "lobe/error.h"
#include "lobe/scene/read_scene.h"
#include "scene/scenes.h"

using namespace lobe;

namespace {

// 1 if it is a scene, 0 if it is refused in one line per fault.
int accepted(const std::string& text) {
  try {
    parse_scene(text);
    return 1;
  } catch (const InputError& error) {
    REQUIRE(!error.faults().empty());
    const std::string_view what = error.what();
    CHECK(static_cast<std::size_t>(std::count(what.begin(), what.end(), '\n')) + 1 == error.faults().size());
    for (const Fault& fault : error.faults()) CHECK(!fault.message.empty());
    return 0;
  }
}

}  // namespace

TEST_CASE("no prefix of a scene is a scene, and none crashes") {
  for (std::size_t length = 0; length < full_scene.size(); ++length) {
    CAPTURE(length);
    REQUIRE(accepted(full_scene.substr(0, length)) == 0);
  }
  CHECK(accepted(full_scene) == 1);
}

TEST_CASE("random changes of bytes never crash") {
  std::mt19937 random(20240917);
  const std::string tokens = "{}[]\",:0123456789.eE+-ntf\\ \x80\xff";
  int good = 0;
  for (int round = 0; round < 4000; ++round) {
    std::string text = full_scene;
    for (unsigned change = random() % 4 + 1; change > 0; --change) {
      const std::size_t at = random() % text.size();
      switch (random() % 4) {
        case 0:
          text[at] = static_cast<char>(random() & 0xFF);
          break;
        case 1:
          text[at] = tokens[random() % tokens.size()];
          break;
        case 2:
          text.erase(at, random() % 20 + 1);
          break;
        default:
          text.insert(at, text.substr(random() % text.size(), random() % 30));
      }
    }
    CAPTURE(text);
    good += accepted(text);
  }
  CHECK(good > 0);
}
