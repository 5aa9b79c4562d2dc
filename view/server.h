// The network side of `lobe view`, on one port: the files of the page by HTTP, files that the page sends, and
// a WebSocket for frames to and commands from the page. It knows nothing of organs; a Service makes and reads
// the messages.
//
// A client gets one frame at a time. The next one is made when it has acknowledged the last. So a slow link
// carries the latest state, and nothing piles up. All of it but Server::wake() and stop() happens on the
// thread that calls run().
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace lobe::view {

struct ServerOptions {
  std::string host = "127.0.0.1";       // address to listen on; a name is looked up
  int port = 8080;                      // 0: a free one
  std::string token;                    // token that a client must name: not empty
  std::size_t largest_message = 65536;  // size of a message [bytes]; a longer one ends its connection
  std::size_t largest_file = std::size_t(128) << 20;  // size of a file from one who has the token [bytes]
  std::size_t most_clients = 16;                      // clients at a time, also while a page is being loaded
  // Connections that have not shown the token yet: how many there may be, and how long one of them may take
  // to make its next request [s].
  std::size_t most_strangers = 64;
  double patience = 2;
  std::size_t most_waiting_texts =
      100;              // texts for one client; if it is too slow for these, its connection is closed
  double silence = 10;  // time after which a client that does not answer a ping is disconnected [s]
};

// A file of the page, compiled into the program.
struct PageFile {
  std::string_view path;  // "/page.js"
  std::string_view content;
};

using ClientId = int;

// Makes the frames that the server sends, and takes the messages of clients.
class Service {
 public:
  virtual ~Service() = default;
  virtual void opened(ClientId client) = 0;
  virtual void closed(ClientId client) = 0;  // closed, or died
  virtual void received(ClientId client, std::string_view text) = 0;
  // A page has sent a file. Throws InputError for one that is not wanted.
  virtual void received_file(const std::string& name, std::string_view content) = 0;
  // The next frame for this client; empty if there is nothing new.
  virtual std::string next_frame(ClientId client) = 0;
};

class Server {
 public:
  // Listens from now on. Throws InputError if it cannot, for instance because the port is in use.
  Server(const ServerOptions& options, std::span<const PageFile> page, Service& service);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  int port() const;
  void run();  // serves until stop()

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

// Whether a page from `origin` may open a WebSocket with the header `Host`. A page of another site may not,
// whatever address it uses. If the server listens to this machine only, neither may a page that uses a
// foreign name which resolves to this machine (DNS rebinding).
bool may_connect(std::string_view origin, std::string_view host, bool this_machine_alone);

// Whether an address can be reached from this machine only.
bool is_loopback(std::string_view host);

// A connection that has not shown the token.
struct Stranger {
  ClientId id = 0;         // grows with each connection
  std::string address;     // address of the other machine
  bool has_asked = false;  // whether it asked for a file of the page
};
// Which of them makes room for another one: of the address that has most of them, the oldest one that has
// asked for nothing, else the oldest. So who opens many connections loses his own. There must be one.
ClientId least_wanted(std::span<const Stranger> strangers);

}  // namespace lobe::view
