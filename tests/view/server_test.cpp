#include "server.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

#include "lobe/error.h"
#include "socket_client.h"

using namespace lobe;
using namespace lobe::view;
using lobe::test::Client;

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
    if (text == "fail") throw std::runtime_error("as you wish");
  }
  void received_file(const std::string& name, std::string_view content) override {
    if (name != "organ.stl") throw InputError(name, "is no organ");
    note(name + " of " + std::to_string(content.size()), 0);
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
  // Within half a minute: on a busy machine a thread may wait for seconds.
  bool has(const std::string& what) {
    for (int i = 0; i < 3000 && !knows(what); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
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

double seconds_of(const std::function<void()>& work) {
  const auto begun = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

TEST_CASE("128 connections that say nothing keep no page out, and are closed when their time is up") {
  ServerOptions options;
  options.patience = 1;
  Running running(options);
  const int port = running.server.port();
  std::vector<std::unique_ptr<Client>> idle;
  for (int i = 0; i < 128; ++i) idle.push_back(std::make_unique<Client>(port));
  CHECK(seconds_of([&] {
          CHECK(Client(port).get("/").starts_with("HTTP/1.1 200"));
          CHECK(Client(port).upgrade("/live?token=secret").starts_with("HTTP/1.1 101"));
        }) < 1);
  // And again, while more of them come than go.
  for (int round = 0; round < 5; ++round) {
    for (int i = 0; i < 64; ++i) idle.push_back(std::make_unique<Client>(port));
    CHECK(Client(port).upgrade("/live?token=secret").starts_with("HTTP/1.1 101"));
  }
  // The oldest made room at once; the youngest has waited for long enough after a second.
  CHECK(idle.front()->read(1).empty());
  CHECK(seconds_of([&] { CHECK(idle.back()->read(1).empty()); }) < 2.5);
}

TEST_CASE("one who has shown the token is not pressed for time, and is not pushed out") {
  ServerOptions options;
  options.patience = 0.2;
  options.most_strangers = 4;
  Running running(options);
  const int port = running.server.port();
  Client page(port), stranger(port);
  CHECK(page.get("/?token=secret").starts_with("HTTP/1.1 200"));
  CHECK(page.read(12) == "<p>organ</p>");
  CHECK(stranger.get("/?token=guess").starts_with("HTTP/1.1 200"));
  CHECK(stranger.read(12) == "<p>organ</p>");
  std::vector<std::unique_ptr<Client>> others;
  for (int i = 0; i < 20; ++i) others.push_back(std::make_unique<Client>(port));
  CHECK(stranger.read(1).empty());
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  CHECK(page.get("/page.js").starts_with("HTTP/1.1 200"));
}

TEST_CASE("a service that fails costs the connection that it fails for, and no other") {
  Running running;
  Client other(running.server.port());
  other.upgrade("/live?token=secret");
  other.hear();
  Client client(running.server.port());
  client.upgrade("/live?token=secret");
  client.hear();
  client.say("fail");
  CHECK(running.service.has("closed"));
  other.say("seen");
  CHECK(other.hear().first == binary_kind);
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

TEST_CASE("a page with the token sends files, which may be longer than messages") {
  ServerOptions options;
  options.largest_message = 1000;
  options.largest_file = 5000;
  Running running(options);
  const auto send = [&](const std::string& target, std::size_t size,
                        const char* origin = "http://localhost") {
    Client client(running.server.port());
    client.write("POST " + target + " HTTP/1.1\r\nHost: localhost\r\nOrigin: " + origin +
                 "\r\nContent-Length: " + std::to_string(size) + "\r\n\r\n" + std::string(size, 'a'));
    return client.head();
  };
  CHECK(send("/file?token=secret&name=organ.stl", 4000).starts_with("HTTP/1.1 200"));
  CHECK(running.service.has("organ.stl of 4000"));
  CHECK(send("/file?token=secret&name=other", 10).starts_with("HTTP/1.1 400"));
  CHECK(send("/file?token=secret&name=organ.stl", 5001).empty());
  CHECK(send("/file?token=guess&name=organ.stl", 10).starts_with("HTTP/1.1 405"));
  CHECK(send("/file?token=guess&name=organ.stl", 4000).empty());
  CHECK(send("/file?token=secret&name=organ.stl", 10, "http://evil.example").starts_with("HTTP/1.1 405"));
  CHECK(!running.service.knows("organ.stl of 10"));
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
