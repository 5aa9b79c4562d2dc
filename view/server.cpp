#include "server.h"

#include <atomic>
#include <map>
#include <vector>

#include "connection.h"
#include "lobe/error.h"

namespace lobe::view {
namespace asio = boost::asio;

struct Server::Parts {
  Parts(const ServerOptions& options, std::span<const PageFile> page, Service& service)
      : shared{options, page, service} {}

  Shared shared;
  asio::io_context context{1};
  TcpAcceptor acceptor{context};
  Timer pause{context};  // before it accepts again, where that has failed
  std::map<ClientId, std::shared_ptr<Connection>> connections;
  ClientId next = 1;
  std::atomic<bool> is_woken = false;  // and has not looked yet

  void listen();
  void accept();
  void greet(TcpSocket socket);
  bool make_room();
  void offer_frames();
  std::shared_ptr<Connection> find(ClientId client) const {
    const auto found = connections.find(client);
    return found == connections.end() ? nullptr : found->second;
  }
};

void Server::Parts::listen() {
  const ServerOptions& options = shared.options;
  const std::string place = options.host + ":" + std::to_string(options.port);
  boost::system::error_code error;
  const auto found =
      TcpResolver(context).resolve(options.host, std::to_string(options.port), TcpResolver::passive, error);
  if (error || found.empty()) throw InputError(place, "no such address: " + error.message());
  const asio::ip::tcp::endpoint endpoint = *found.begin();
  acceptor.open(endpoint.protocol(), error);
  if (!error) close_on_exec(acceptor);
  if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error == asio::error::address_in_use)
    throw InputError(
        place, "the port is taken by another program; choose one with --port, or --port 0 for a free one");
  if (error) throw InputError(place, "cannot listen there: " + error.message());
}

// Where no more connections can be opened at present, a moment passes first.
void Server::Parts::accept() {
  acceptor.async_accept([this](boost::system::error_code error, TcpSocket socket) {
    if (error == asio::error::operation_aborted) return;
    if (!error) {
      greet(std::move(socket));
      return accept();
    }
    pause.expires_after(std::chrono::milliseconds(50));
    pause.async_wait([this](boost::system::error_code ended) {
      if (!ended) accept();
    });
  });
}

void Server::Parts::greet(TcpSocket socket) try {
  if (!make_room()) return;  // which closes it
  const ClientId id = next++;
  const auto connection = std::make_shared<Connection>(std::move(socket), id, shared);
  connections[id] = connection;
  connection->start();
} catch (const std::exception&) {  // no memory for it
}

// Strangers make room for strangers, so that they keep nobody out. A browser opens several connections for
// the files of one page.
bool Server::Parts::make_room() {
  constexpr std::size_t connections_per_page = 8;
  std::vector<Stranger> strangers;
  for (const auto& [id, connection] : connections)
    if (!connection->is_known()) strangers.push_back(connection->stranger());
  const std::size_t known = connections.size() - strangers.size();
  if (known >= connections_per_page * shared.options.most_clients) return false;
  if (strangers.size() < shared.options.most_strangers) return true;
  const auto unwanted = connections.find(least_wanted(strangers));
  unwanted->second->close();
  connections.erase(unwanted);
  return true;
}

void Server::Parts::offer_frames() {
  const auto all = connections;
  for (const auto& [id, connection] : all) connection->offer_frame();
}

Server::Server(const ServerOptions& options, std::span<const PageFile> page, Service& service)
    : parts_(std::make_unique<Parts>(options, page, service)) {
  if (options.token.empty()) throw InputError("token", "is empty: anybody could connect");
  parts_->shared.on_client = [parts = parts_.get()](ClientId client, bool is_open) {
    if (!is_open) return void(parts->connections.erase(client));
    std::size_t live = 0;
    for (const auto& [id, connection] : parts->connections) live += connection->is_live();
    if (live > parts->shared.options.most_clients)
      asio::post(parts->context, [parts, client] {
        if (const auto connection = parts->find(client)) connection->drop("too many pages are open");
      });
  };
  parts_->listen();
  parts_->accept();
}

Server::~Server() {
  const auto connections = parts_->connections;
  for (const auto& [id, connection] : connections) connection->close();
}

int Server::port() const { return parts_->acceptor.local_endpoint().port(); }

void Server::run() { parts_->context.run(); }

void Server::wake() {
  if (parts_->is_woken.exchange(true)) return;
  try {
    asio::post(parts_->context, [parts = parts_.get()] {
      parts->is_woken = false;
      parts->offer_frames();
    });
  } catch (const std::exception&) {  // no memory: the next picture wakes it
    parts_->is_woken = false;
  }
}

void Server::stop() { parts_->context.stop(); }

void Server::acknowledged(ClientId client) {
  if (const auto connection = parts_->find(client)) connection->acknowledged();
}

void Server::send(ClientId client, std::string text) {
  if (const auto connection = parts_->find(client)) connection->send(std::move(text));
}

void Server::drop(ClientId client, std::string_view why) {
  if (const auto connection = parts_->find(client)) connection->drop(why);
}

}  // namespace lobe::view
