// The client of Haply's service, with a service that is made for the test.
#include "haply.h"

#include <doctest/doctest.h>

#include <chrono>
#include <thread>

#include "fake_haply.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;
using namespace lobe::view;

namespace {

// Ticks of 1 ms until it is so, for a minute.
template <class Until>
bool ticks_until(HaplyDevice& device, DeviceState& state, Until&& until) {
  for (int i = 0; i < 60000; ++i) {
    const bool is_there = device.read(state);
    device.write({0, 1.5, 0}, Vec3d::Zero());
    if (until(is_there)) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

}  // namespace

TEST_CASE("what the service says of a device") {
  HaplyMessage message;
  REQUIRE(read_haply(state_at(0.07, true).dump(), message));
  CHECK(message.device == "049D");
  CHECK(message.state.position.isApprox(Vec3d(0.07, -0.1, 0.2)));
  CHECK(message.state.velocity.isApprox(Vec3d(0.01, 0, 0)));
  CHECK(message.state.orientation.isApprox(Eigen::Vector4d(0, 0, 1, 0)));
  CHECK(message.state.buttons == 5);
  const Json answer = Json::parse(haply_force("049D", {1, 2, 3}));
  CHECK(answer["inverse3"][0]["commands"]["set_cursor_force"]["values"]["z"] == 3.0);
}

TEST_CASE("what is no message of a device is left out, and a number that is none stays none") {
  HaplyMessage message;
  for (const char* text : {"", "{", "[]", "7", "{}", R"({"inverse3": []})", R"({"inverse3": [3]})",
                           R"({"inverse3": [{"state": 1}]})", R"({"inverse3": [{"state": {}}]})"})
    CHECK_FALSE(read_haply(text, message));
  REQUIRE(read_haply(R"({"inverse3": [{"state": {"cursor_position": {"x": "a", "y": null, "z": 1}}}]})",
                     message));
  CHECK_FALSE(message.state.is_finite());
}

TEST_CASE("a device answers with its force, is gone when the service is, and comes back with it") {
  FakeService service;
  HaplyDevice device("127.0.0.1", service.port);
  DeviceState state;
  service.x = 0.04;
  REQUIRE(ticks_until(device, state, [&](bool there) { return there && state.position.x() == 0.04; }));
  CHECK(state.buttons == 4);
  service.x = 0.06;
  REQUIRE(ticks_until(device, state, [&](bool there) { return there && state.buttons == 5; }));
  REQUIRE(ticks_until(device, state, [&](bool) { return service.last_force == 1.5; }));
  service.is_silent = true;  // it hangs
  REQUIRE(ticks_until(device, state, [&](bool there) { return !there; }));
  service.is_silent = false;
  service.hangs_up = true;  // and goes
  REQUIRE(ticks_until(device, state, [&](bool there) { return there && service.clients >= 2; }));
}

TEST_CASE("no service: the device is not there, and nothing waits") {
  HaplyDevice device("127.0.0.1", 1);
  DeviceState state;
  for (int i = 0; i < 50; ++i) {
    CHECK_FALSE(device.read(state));
    device.write({1, 0, 0}, Vec3d::Zero());
  }
}
