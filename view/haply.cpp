#include "haply.h"

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "network.h"

namespace lobe::view {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::ip::tcp;
using Error = boost::system::error_code;
using Json = nlohmann::json;

// ---- Messages

namespace {

// Missing numbers are 0. A value that is no number gives NaN, which the loop refuses.
double number(const Json& of, const char* key) {
  const auto found = of.find(key);
  if (found == of.end()) return 0;
  return found->is_number() ? found->get<double>() : std::numeric_limits<double>::quiet_NaN();
}

Vec3d vector(const Json& state, const char* key) {
  const auto found = state.find(key);
  if (found == state.end() || !found->is_object()) return Vec3d::Zero();
  return {number(*found, "x"), number(*found, "y"), number(*found, "z")};
}

const Json* first_state(const Json& message, const char* kind) {
  const auto devices = message.find(kind);
  if (devices == message.end() || !devices->is_array() || devices->empty() || !(*devices)[0].is_object())
    return nullptr;
  const auto state = (*devices)[0].find("state");
  return state == (*devices)[0].end() || !state->is_object() ? nullptr : &*state;
}

void read_grip(const Json& state, DeviceState& to) {
  if (const auto turn = state.find("orientation"); turn != state.end() && turn->is_object()) {
    const Eigen::Vector4d q(number(*turn, "x"), number(*turn, "y"), number(*turn, "z"), number(*turn, "w"));
    to.orientation = q.norm() > 0 ? Eigen::Vector4d(q.normalized()) : Eigen::Vector4d(0, 0, 0, 1);
  }
  const auto buttons = state.find("buttons");
  if (buttons == state.end() || !buttons->is_object()) return;
  std::uint32_t bit = 1;
  for (const char* name : {"a", "b", "c"}) {
    const auto button = buttons->find(name);
    if (button != buttons->end() && button->is_boolean() && button->get<bool>()) to.buttons |= bit;
    bit <<= 1;
  }
}

}  // namespace

bool read_haply(std::string_view text, HaplyMessage& message) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return false;
  const Json* state = first_state(json, "inverse3");
  if (!state || !state->contains("cursor_position")) return false;
  const Json& device = json["inverse3"][0];
  if (const auto id = device.find("device_id"); id != device.end() && id->is_string())
    message.device = id->get<std::string>();
  message.state = {.position = vector(*state, "cursor_position"),
                   .velocity = vector(*state, "cursor_velocity")};
  for (const char* kind : {"wireless_verse_grip", "verse_grip"})
    if (const Json* grip = first_state(json, kind)) {
      read_grip(*grip, message.state);
      break;
    }
  return true;
}

std::string haply_force(const std::string& device, const Vec3d& force) {
  const Json values = {{"x", force.x()}, {"y", force.y()}, {"z", force.z()}};
  const Json command = {{"device_id", device}, {"commands", {{"set_cursor_force", {{"values", values}}}}}};
  return Json{{"inverse3", Json::array({command})}}.dump();
}

// ---- The connection: all of it in one thread

struct HaplyDevice::Client {
  HaplyDevice& device;
  const std::string host, port;
  asio::io_context context{1};
  Timer watch{context};  // no message came for too long, or it is time to connect again
  std::optional<WebSocket> stream;
  beast::flat_buffer buffer;
  std::string answer;
  HaplyMessage message;
  std::uint64_t messages = 0;
  bool ends = false;

  Client(HaplyDevice& of, const std::string& host_name, int port_number)
      : device(of), host(host_name), port(std::to_string(port_number)) {}

  void run();
  void connect();
  void lost();
  void listen();
  void heard();
  void watch_out(std::chrono::milliseconds patience);
};

void HaplyDevice::Client::watch_out(std::chrono::milliseconds patience) {
  watch.expires_after(patience);
  watch.async_wait([this](Error error) {
    if (!error) lost();
  });
}

void HaplyDevice::Client::lost() {
  if (stream) {
    Error ignored;
    stream->next_layer().socket().close(ignored);
  }
  if (ends) return;
  watch.expires_after(std::chrono::milliseconds(300));
  watch.async_wait([this](Error error) {
    if (!error && !ends) connect();
  });
}

// What fails, memory for a message for example, costs the connection alone.
void HaplyDevice::Client::run() {
  asio::post(context, [this] { connect(); });
  while (!ends) try {
      context.run();
      return;
    } catch (const std::exception&) {
      lost();
    }
}

// The service is on this machine, so neither the name nor the connection takes long.
void HaplyDevice::Client::connect() {
  Error error;
  const auto places = TcpResolver(context).resolve(host, port, error);
  stream.emplace(context);
  if (!error) asio::connect(stream->next_layer().socket(), places, error);
  if (error) return lost();
  close_on_exec(stream->next_layer().socket());
  stream->next_layer().socket().set_option(tcp::no_delay(true), error);
  buffer.clear();
  watch_out(std::chrono::seconds(2));
  stream->async_handshake(host + ":" + port, "/",
                          Ended([this](Error failed) { failed ? lost() : listen(); }));
}

void HaplyDevice::Client::listen() {
  watch_out(std::chrono::seconds(1));
  stream->async_read(buffer, Moved([this](Error error, std::size_t) {
                       if (error == asio::error::operation_aborted) return;
                       error ? lost() : heard();
                     }));
}

void HaplyDevice::Client::heard() {
  const bool is_state = read_haply({static_cast<const char*>(buffer.data().data()), buffer.size()}, message);
  buffer.clear();
  if (!is_state) return listen();
  if (Stamped* to = device.states_.writable()) {
    *to = {++messages, message.state};
    device.states_.publish();
  }
  const auto force = device.forces_.latest();
  answer = haply_force(message.device, force ? *force : Vec3d(Vec3d::Zero()));
  stream->async_write(asio::buffer(answer), Moved([this](Error error, std::size_t) {
                        if (error == asio::error::operation_aborted) return;
                        error ? lost() : listen();
                      }));
}

HaplyDevice::HaplyDevice(const std::string& host, int port)
    : client_(std::make_unique<Client>(*this, host, port)) {
  thread_ = std::thread([client = client_.get()] { client->run(); });
}

HaplyDevice::~HaplyDevice() {
  asio::post(client_->context, [client = client_.get()] {
    client->ends = true;
    client->lost();
    client->context.stop();
  });
  thread_.join();
}

// The device counts as gone if nothing has come for a tenth of a second.
bool HaplyDevice::read(DeviceState& state) noexcept {
  constexpr int patience = 100;  // [ticks]
  const auto latest = states_.latest();
  if (latest && latest->number != last_.number) {
    last_ = *latest;
    ticks_without_ = 0;
  } else if (ticks_without_ < patience) {
    ++ticks_without_;
  }
  state = last_.state;
  return ticks_without_ < patience;
}

void HaplyDevice::write(const Vec3d& force, const Vec3d&) noexcept {
  if (Vec3d* to = forces_.writable()) {
    *to = force;
    forces_.publish();
  }
}

}  // namespace lobe::view
