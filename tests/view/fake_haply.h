// A stand-in for Haply's service.
#pragma once

#include <poll.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "network.h"

namespace lobe::test {

namespace asio = boost::asio;
namespace beast = boost::beast;
using Json = nlohmann::json;

inline Json state_at(double x, bool pressed) {
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
    view::TcpSocket knock(context);
    boost::system::error_code ignored;
    knock.connect({asio::ip::make_address("127.0.0.1"), static_cast<unsigned short>(port)}, ignored);
    thread_.join();
  }

  int port = 0;
  std::atomic<bool> ends = false, hangs_up = false, is_silent = false;
  std::atomic<int> clients = 0, forces = 0;
  // For how many states in a row another connection has waited beside the one that is served.
  std::atomic<int> longest_wait = 0;
  std::atomic<double> last_force = 0, x = 0;
  std::string nonsense = "[1, 2]";

 private:
  void serve() {
    while (!ends) {
      view::TcpSocket socket(context_);
      acceptor_.accept(socket);
      if (ends) return;
      ++clients;
      int wait = 0;
      boost::system::error_code error;
      view::WebSocket stream(std::move(socket));
      stream.accept(error);
      stream.write(asio::buffer(nonsense), error);
      stream.write(asio::buffer(std::string("{")), error);
      while (!error && !ends && !hangs_up) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        pollfd waiting{acceptor_.native_handle(), POLLIN, 0};
        wait = ::poll(&waiting, 1, 0) > 0 ? wait + 1 : 0;
        longest_wait = std::max(longest_wait.load(), wait);
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
  view::TcpAcceptor acceptor_;
  std::thread thread_;
};

}  // namespace lobe::test
