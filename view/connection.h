// One connection of a client. It serves HTTP requests for files of the page, until a request turns it into
// the WebSocket.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "network.h"
#include "server.h"

namespace lobe::view {

// What the connections share.
struct Shared {
  ServerOptions options;
  std::span<const PageFile> page;
  Service& service;
  std::function<void(ClientId, bool is_open)> on_client = {};
};

class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(TcpSocket socket, ClientId id, Shared& shared);

  void start();
  void close();  // ends it at once, without a closing message

  bool is_live() const { return live_ && is_open_; }
  // It has shown the token, in the address of the page or of the socket.
  bool is_known() const { return is_known_; }
  Stranger stranger() const { return {id_, address_, has_asked_}; }
  void acknowledged();
  void offer_frame();  // sends the next frame, if the last was acknowledged and there is one
  void send(std::string text);
  void drop(std::string_view why);

 private:
  using Request = boost::beast::http::request<boost::beast::http::string_body>;
  using Response = boost::beast::http::response<boost::beast::http::string_body>;

  template <class Act>
  void guarded(const Act& act);
  void read_request();
  void read_body();
  void take(const Request& request);
  void answer(const Request& request);
  void respond(std::shared_ptr<Response> response);
  Response plain(const Request& request, boost::beast::http::status status, std::string text) const;
  Response file(const Request& request) const;
  bool sends_file(const boost::beast::http::request_header<>& request) const;
  Response take_file(const Request& request) const;
  std::string refusal(const Request& request) const;
  void become_live(const Request& request);
  void opened();
  void read_message();
  void write_next();
  void end();

  Shared& shared_;
  const ClientId id_;
  const std::string address_;  // address of the other machine
  bool is_known_ = false, has_asked_ = false;
  boost::beast::flat_buffer buffer_;
  std::optional<boost::beast::http::request_parser<boost::beast::http::string_body>> parser_;
  std::optional<TcpStream> http_;  // stream until it becomes live
  std::optional<WebSocket> live_;
  bool is_open_ = false;  // the service knows of it
  std::deque<std::string> texts_;
  std::string frame_;  // text that waits to be written, or is being written
  bool is_writing_ = false, is_frame_seen_ = true;
  std::optional<boost::beast::websocket::close_reason> closing_;
};

}  // namespace lobe::view
