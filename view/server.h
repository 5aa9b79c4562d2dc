// The network side of `lobe view`: the files of the page by HTTP, and a WebSocket that carries frames out and
// commands in, on
// one port. It knows nothing of organs: what is said is the service's.
//
// A client gets one frame at a time: the next one is asked for when it has acknowledged the last, so that a
// slow link
// carries the latest state and nothing piles up. Everything but Server::wake() and stop() happens on the
// thread that runs it.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace lobe::view {

struct ServerOptions {
  std::string host = "127.0.0.1";        // address to listen on; a name is looked up
  int port = 8080;                       // 0: a free one
  std::string token;                     // that a client must name: not empty
  std::size_t largest_message = 65536;   // of a client [bytes]; a longer one ends its connection
  std::size_t most_clients = 16;         // at a time, pages that are only being loaded included
  std::size_t most_waiting_texts = 100;  // for one client; one that takes them no faster is let go
  double silence = 10;  // after which a client that does not even answer a ping is let go [s]
};

// A file of the page, in the program itself.
struct PageFile {
  std::string_view path;  // "/page.js"
  std::string_view content;
};

using ClientId = int;

// What the server serves.
class Service {
 public:
  virtual ~Service() = default;
  virtual void opened(ClientId client) = 0;
  virtual void closed(ClientId client) = 0;  // also of one that died
  virtual void received(ClientId client, std::string_view text) = 0;
  // The frame that this client is to see next; empty: it has seen what there is.
  virtual std::string next_frame(ClientId client) = 0;
};

class Server {
 public:
  // Listens from here on. Throws InputError where it cannot: the port is taken, say.
  Server(const ServerOptions& options, std::span<const PageFile> page, Service& service);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  int port() const;
  void run();  // until stop()

  // ---- From any thread.

  void wake();  // there may be a new frame
  void stop();

  // ---- On the thread that runs it.

  void acknowledged(ClientId client);  // its last frame has been seen
  void send(ClientId client, std::string text);
  void drop(ClientId client, std::string_view why);  // the client is told

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// Whether a WebSocket may be opened by a page from `origin` with the header `Host`: a page of another site
// may not, whatever
// address it has found us by, nor may one by a name that was bent to this machine (DNS rebinding), where we
// listen on
// this machine alone.
bool may_connect(std::string_view origin, std::string_view host, bool this_machine_alone);

// Whether an address is of this machine alone.
bool is_loopback(std::string_view host);

}  // namespace lobe::view
