// The client of Haply's service, with a service that is made for the test.
#include "haply.h"

#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "near.h"
#include "network.h"

using namespace lobe;
using namespace lobe::test;
using namespace lobe::view;

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using Json = nlohmann::json;

Json state_at(double x, bool pressed) {
  return {{"inverse3",
           {{{"device_id", "049D"},
             {"state",
              {{"cursor_position", {{"x", x}, {"y", -0.1}, {"z", 0.2}}},
               {"cursor_velocity", {{"x", 0.01}, {"y", 0.0}, {"z", 0.0}}}}}}}},
          {"wireless_verse_grip",
           {{{"device_id", "1"},
             {"state",
              {{"orientation", {{"w", 0.0}, {"x", 0.0}, {"y", 0.0}, {"z", 2.0}}},
               {"buttons", {{"a", pressed}, {"b", false}, {"c", true}}}}}}}}};
}

// Serves one client at a time; answers each force with the next state, as the service does.
class FakeService {
 public:
  FakeService() : acceptor_(context_, {asio::ip::make_address("127.0.0.1"), 0}) {
    port = acceptor_.local_endpoint().port();
    thread_ = std::thread([this] { serve(); });
  }
  ~FakeService() {
    ends = true;
    asio::io_context context;
    TcpSocket knock(context);
    boost::system::error_code ignored;
    knock.connect({asio::ip::make_address("127.0.0.1"), static_cast<unsigned short>(port)}, ignored);
    thread_.join();
  }

  int port = 0;
  std::atomic<bool> ends = false, hangs_up = false, is_silent = false;
  std::atomic<int> clients = 0, forces = 0;
  std::atomic<double> last_force = 0, x = 0;
  std::string nonsense = "[1, 2]";

 private:
  void serve() {
    while (!ends) {
      TcpSocket socket(context_);
      acceptor_.accept(socket);
      if (ends) return;
      ++clients;
      boost::system::error_code error;
      WebSocket stream(std::move(socket));
      stream.accept(error);
      stream.write(asio::buffer(nonsense), error);
      stream.write(asio::buffer(std::string("{")), error);
      while (!error && !ends && !hangs_up) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        if (is_silent) continue;
        stream.write(asio::buffer(state_at(x, x > 0.05).dump()), error);
        beast::flat_buffer buffer;
        if (!error) stream.read(buffer, error);
        if (error) break;
        const Json answer = Json::parse(beast::buffers_to_string(buffer.data()));
        const Json& device = answer["inverse3"][0];
        if (device["device_id"] != "049D") return;
        last_force = device["commands"]["set_cursor_force"]["values"]["y"].get<double>();
        ++forces;
      }
      hangs_up = false;
    }
  }

  asio::io_context context_;
  TcpAcceptor acceptor_;
  std::thread thread_;
};

// Ticks of 1 ms until it is so, for some seconds.
template <class Until>
bool ticks_until(HaplyDevice& device, DeviceState& state, Until&& until) {
  for (int i = 0; i < 8000; ++i) {
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
