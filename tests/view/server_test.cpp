#include "server.h"

#include <arpa/inet.h>
#include <doctest/doctest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>
#include <vector>

#include "lobe/error.h"

using namespace lobe;
using namespace lobe::view;

namespace {

constexpr PageFile files[] = {{"/index.html", "<p>organ</p>"}, {"/page.js", "let x;"}};

// Has a new frame whenever it is asked, and notes what happens.
class Noting final : public Service {
 public:
  void opened(ClientId client) override { note("opened", client); }
  void closed(ClientId client) override { note("closed", client); }
  void received(ClientId client, std::string_view text) override {
    note(std::string(text), client);
    if (text == "seen") server->acknowledged(client);
    if (text == "say") server->send(client, "word");
    if (text == "say much") server->send(client, std::string(60000, 'a'));
    if (text == "drop me") server->drop(client, "as you wish");
  }
  std::string next_frame(ClientId) override { return "frame " + std::to_string(++frames); }

  void note(const std::string& what, ClientId) {
    const std::lock_guard lock(mutex);
    notes.push_back(what);
  }
  bool knows(const std::string& what) {
    const std::lock_guard lock(mutex);
    return std::find(notes.begin(), notes.end(), what) != notes.end();
  }
  // Within some seconds.
  bool has(const std::string& what) {
    for (int i = 0; i < 500 && !knows(what); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return knows(what);
  }

  Server* server = nullptr;
  std::atomic<int> frames = 0;
  std::mutex mutex;
  std::vector<std::string> notes;
};

struct Running {
  explicit Running(ServerOptions options = {}) : server(with_token(options), files, service) {
    service.server = &server;
    thread = std::thread([this] { server.run(); });
  }
  ~Running() {
    server.stop();
    thread.join();
  }
  static ServerOptions with_token(ServerOptions options) {
    options.port = 0;
    options.token = "secret";
    return options;
  }

  Noting service;
  Server server;
  std::thread thread;
};

// One connection, byte by byte.
class Client {
 public:
  explicit Client(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    timeval patience{3, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    REQUIRE(connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0);
  }
  ~Client() { die(); }
  void die() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
  }

  void write(const std::string& bytes) { (void)!::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL); }
  std::string read(std::size_t count) {
    std::string bytes(count, '\0');
    std::size_t have = 0;
    while (have < count) {
      const auto got = ::recv(socket_, bytes.data() + have, count - have, 0);
      if (got <= 0) break;
      have += std::size_t(got);
    }
    bytes.resize(have);
    return bytes;
  }
  std::string head() {
    std::string text;
    while (!text.ends_with("\r\n\r\n")) {
      const std::string next = read(1);
      if (next.empty()) break;
      text += next;
    }
    return text;
  }

  std::string get(const std::string& target) {
    write("GET " + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
    return head();
  }
  std::string upgrade(const std::string& target, const std::string& origin = "http://localhost:80",
                      const std::string& host = "localhost:80") {
    write("GET " + target + " HTTP/1.1\r\nHost: " + host + "\r\nOrigin: " + origin +
          "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
          "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
    return head();
  }
  // A text message of less than 64 KiB, masked with zeros.
  void say(const std::string& text) {
    std::string frame = "\x81";
    if (text.size() < 126) {
      frame += static_cast<char>(0x80 | text.size());
    } else {
      frame += static_cast<char>(0xfe);
      frame += static_cast<char>(text.size() >> 8);
      frame += static_cast<char>(text.size() & 255);
    }
    write(frame + std::string(4, '\0') + text);
  }
  // Kind and content of a message of less than 126 bytes; 0 where there is none.
  std::pair<int, std::string> hear() {
    const std::string start = read(2);
    if (start.size() < 2) return {0, ""};
    return {start[0] & 15, read(std::size_t(start[1] & 127))};
  }

 private:
  int socket_;
};

constexpr int text_kind = 1, binary_kind = 2, closing_kind = 8;

}  // namespace

TEST_CASE("files of the page are served, and nothing else") {
  Running running;
  Client client(running.server.port());
  const std::string head = client.get("/");
  CHECK(head.starts_with("HTTP/1.1 200"));
  CHECK(head.find("text/html") != std::string::npos);
  CHECK(client.read(12) == "<p>organ</p>");
  CHECK(client.get("/page.js?x=1").starts_with("HTTP/1.1 200"));
  CHECK(client.read(6) == "let x;");
  CHECK(client.get("/../etc/passwd").starts_with("HTTP/1.1 404"));
}

TEST_CASE("what is no request ends the connection") {
  Running running;
  Client client(running.server.port());
  client.write("no request at all\r\n\r\n");
  CHECK(client.read(1).empty());
  Client other(running.server.port());
  CHECK(other.get("/").starts_with("HTTP/1.1 200"));
}

TEST_CASE("the socket opens with the token, from the server's own page, by a name of this machine") {
  Running running;
  const int port = running.server.port();
  CHECK(Client(port).upgrade("/live?token=secret").starts_with("HTTP/1.1 101"));
  CHECK(Client(port).upgrade("/live?a=b&token=secret").starts_with("HTTP/1.1 101"));
  for (const char* target :
       {"/live", "/live?token=", "/live?token=guess", "/live?token=secrets", "/?token=secret"})
    CHECK(Client(port).upgrade(target).starts_with("HTTP/1.1 403"));
  CHECK(Client(port).upgrade("/live?token=secret", "http://evil.example").starts_with("HTTP/1.1 403"));
  CHECK(Client(port)
            .upgrade("/live?token=secret", "http://evil.example", "evil.example")
            .starts_with("HTTP/1.1 403"));
}

TEST_CASE("a client gets the next frame when it has acknowledged the last") {
  Running running;
  Client client(running.server.port());
  client.upgrade("/live?token=secret");
  CHECK(client.hear() == std::pair(binary_kind, std::string("frame 1")));
  for (int i = 0; i < 5; ++i) running.server.wake();
  client.say("say");
  CHECK(client.hear() == std::pair(text_kind, std::string("word")));
  CHECK(running.service.frames == 1);
  client.say("seen");
  CHECK(client.hear() == std::pair(binary_kind, std::string("frame 2")));
}

TEST_CASE("a client that dies is noticed, and others go on") {
  Running running;
  Client other(running.server.port());
  other.upgrade("/live?token=secret");
  {
    Client client(running.server.port());
    client.upgrade("/live?token=secret");
    client.say("hello");
    CHECK(running.service.has("hello"));
  }
  CHECK(running.service.has("closed"));
  other.hear();
  other.say("seen");
  CHECK(other.hear().first == binary_kind);
}

TEST_CASE("a client that says nothing, and answers no ping, is let go") {
  ServerOptions options;
  options.silence = 0.3;
  Running running(options);
  Client client(running.server.port());
  client.upgrade("/live?token=secret");
  CHECK(running.service.has("closed"));
}

TEST_CASE("a message that is too long ends the connection") {
  ServerOptions options;
  options.largest_message = 1000;
  Running running(options);
  Client client(running.server.port());
  client.upgrade("/live?token=secret");
  client.hear();
  client.say(std::string(1000, 'a'));
  CHECK(running.service.has(std::string(1000, 'a')));
  client.say(std::string(1001, 'a'));
  CHECK(client.hear().first == closing_kind);
  CHECK(running.service.has("closed"));
}

TEST_CASE("one that takes its messages no faster than they come is let go, not waited for") {
  ServerOptions options;
  options.most_waiting_texts = 10;
  Running running(options);
  Client client(running.server.port());
  client.upgrade("/live?token=secret");
  for (int i = 0; i < 2000 && !running.service.knows("closed"); ++i) client.say("say much");
  CHECK(running.service.has("closed"));
}

TEST_CASE("a page that is one too many is told so") {
  ServerOptions options;
  options.most_clients = 1;
  Running running(options);
  Client first(running.server.port()), second(running.server.port());
  first.upgrade("/live?token=secret");
  first.hear();
  second.upgrade("/live?token=secret");
  std::pair<int, std::string> last = second.hear();
  while (last.first == binary_kind) last = second.hear();
  CHECK(last.first == closing_kind);
  CHECK(last.second.find("too many pages") != std::string::npos);
}

TEST_CASE("a client can be sent away with a reason") {
  Running running;
  Client client(running.server.port());
  client.upgrade("/live?token=secret");
  client.hear();
  client.say("drop me");
  const auto [kind, content] = client.hear();
  CHECK(kind == closing_kind);
  CHECK(content.find("as you wish") != std::string::npos);
}

TEST_CASE("a port that is taken, and an address that is none, are named") {
  Running running;
  Noting service;
  ServerOptions options;
  options.token = "secret";
  options.port = running.server.port();
  try {
    Server second(options, files, service);
    FAIL("two servers on one port");
  } catch (const InputError& error) {
    const std::string text = error.what();
    CHECK(text.find("127.0.0.1:" + std::to_string(options.port)) != std::string::npos);
    CHECK(text.find("taken") != std::string::npos);
    CHECK(text.find("--port") != std::string::npos);
  }
  options.host = "no.such.host.invalid";
  CHECK_THROWS_AS(Server(options, files, service), InputError);
  options.host = "127.0.0.1";
  options.token = "";
  CHECK_THROWS_AS(Server(options, files, service), InputError);
}
