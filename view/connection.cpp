#include "connection.h"

#include <algorithm>
#include <utility>

namespace lobe::view {
namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;

namespace {

constexpr std::chrono::milliseconds long_enough(30000);  // for one who has the token, or is being answered
constexpr std::chrono::milliseconds long_for_files(600000);

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::duration<double>(seconds));
}

constexpr std::size_t largest_header = 16384;  // [bytes]

std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }

std::string_view path_of(std::string_view target) { return target.substr(0, target.find('?')); }

// Of "/live?token=abc" and "token=": "abc".
std::string_view value_of(std::string_view target, std::string_view key) {
  const std::size_t question = target.find('?');
  if (question == std::string_view::npos) return {};
  std::string_view query = target.substr(question + 1);
  while (!query.starts_with(key)) {
    const std::size_t next = query.find('&');
    if (next == std::string_view::npos) return {};
    query.remove_prefix(next + 1);
  }
  query.remove_prefix(key.size());
  return query.substr(0, query.find('&'));
}
std::string_view token_of(std::string_view target) { return value_of(target, "token="); }

// Takes the same time however many characters are right, so that the time reveals nothing.
bool same_secret(std::string_view a, std::string_view b) {
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= unsigned(a[i] ^ b[i % std::max<std::size_t>(1, b.size())]);
  return difference == 0 && !b.empty();
}

std::string address_of(const TcpSocket& socket) {
  beast::error_code error;
  const auto endpoint = socket.remote_endpoint(error);
  return error ? std::string() : endpoint.address().to_string();
}

const char* type_of(std::string_view path) {
  if (path.ends_with(".html")) return "text/html; charset=utf-8";
  if (path.ends_with(".js")) return "text/javascript; charset=utf-8";
  if (path.ends_with(".css")) return "text/css; charset=utf-8";
  if (path.ends_with(".svg")) return "image/svg+xml";
  return "text/plain; charset=utf-8";
}

}  // namespace

Connection::Connection(TcpSocket socket, ClientId id, Shared& shared)
    : shared_(shared), id_(id), address_(address_of(socket)), http_(std::in_place, std::move(socket)) {
  close_on_exec(http_->socket());
}

// What fails, for want of memory for example, ends this connection and no other.
template <class Act>
void Connection::guarded(const Act& act) {
  try {
    act();
  } catch (const std::exception&) {
    end();
  }
}

void Connection::start() {
  guarded([&] { read_request(); });
}

void Connection::close() {
  beast::error_code ignored;
  TcpSocket& socket = live_ ? live_->next_layer().socket() : http_->socket();
  socket.close(ignored);
}

// What it may be long is known when its head was read.
void Connection::read_request() {
  parser_.emplace();
  parser_->body_limit(shared_.options.largest_file);
  parser_->header_limit(largest_header);
  http_->expires_after(is_known_ ? long_enough : milliseconds(shared_.options.patience));
  http::async_read_header(*http_, buffer_, *parser_,
                          Moved([self = shared_from_this()](beast::error_code error, std::size_t) {
                            if (error) return self->end();
                            self->guarded([&] { self->read_body(); });
                          }));
}

void Connection::read_body() {
  if (sends_file(parser_->get())) {
    is_known_ = true;  // so that no stranger takes its place meanwhile
    http_->expires_after(long_for_files);
  } else {
    const auto length = parser_->content_length();
    if (length && *length > shared_.options.largest_message) return end();
    parser_->body_limit(shared_.options.largest_message);
  }
  http::async_read(*http_, buffer_, *parser_,
                   Moved([self = shared_from_this()](beast::error_code error, std::size_t) {
                     if (error) return self->end();
                     self->guarded([&] { self->take(self->parser_->release()); });
                   }));
}

void Connection::take(const Request& request) {
  has_asked_ = true;
  if (same_secret(token_of(view_of(request.target())), shared_.options.token)) is_known_ = true;
  if (websocket::is_upgrade(request))
    become_live(request);
  else
    answer(request);
}

void Connection::answer(const Request& request) {
  auto response = std::make_shared<Response>(sends_file(request) ? take_file(request) : file(request));
  response->set("X-Content-Type-Options", "nosniff");
  response->set("Content-Security-Policy",
                "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' blob: data:; "
                "media-src 'self' blob:; connect-src 'self' ws: wss:; frame-ancestors 'none'");
  response->set("Referrer-Policy", "no-referrer");
  response->keep_alive(request.keep_alive());
  response->prepare_payload();
  if (request.method() == http::verb::head) response->body().clear();
  respond(std::move(response));
}

Connection::Response Connection::plain(const Request& request, http::status status, std::string text) const {
  Response response{status, request.version()};
  response.set(http::field::content_type, "text/plain; charset=utf-8");
  response.body() = std::move(text);
  return response;
}

// Whether this is a file from one who may send it: the page itself, which has the token.
bool Connection::sends_file(const http::request_header<>& request) const {
  const std::string_view target = view_of(request.target());
  return request.method() == http::verb::post && path_of(target) == "/file" &&
         same_secret(token_of(target), shared_.options.token) &&
         may_connect(view_of(request[http::field::origin]), view_of(request[http::field::host]),
                     is_loopback(shared_.options.host));
}

Connection::Response Connection::take_file(const Request& request) const {
  try {
    shared_.service.received_file(std::string(value_of(view_of(request.target()), "name=")), request.body());
  } catch (const std::exception& error) {
    return plain(request, http::status::bad_request, error.what());
  }
  return plain(request, http::status::ok, "");
}

Connection::Response Connection::file(const Request& request) const {
  if (request.method() != http::verb::get && request.method() != http::verb::head)
    return plain(request, http::status::method_not_allowed, "only GET is answered here\n");
  std::string_view path = path_of(view_of(request.target()));
  if (path == "/") path = "/index.html";
  const auto found = std::find_if(shared_.page.begin(), shared_.page.end(),
                                  [&](const PageFile& candidate) { return candidate.path == path; });
  if (found == shared_.page.end())
    return plain(request, http::status::not_found, "the page has no such file\n");
  Response response{http::status::ok, request.version()};
  response.set(http::field::content_type, type_of(path));
  response.set(http::field::cache_control,
               path.starts_with("/third_party/") ? "max-age=31536000, immutable" : "no-store");
  response.body() = found->content;
  return response;
}

void Connection::respond(std::shared_ptr<Response> response) {
  http_->expires_after(long_enough);
  http::async_write(*http_, *response,
                    Moved([self = shared_from_this(), response](beast::error_code error, std::size_t) {
                      if (error || response->need_eof()) return self->end();
                      self->guarded([&] { self->read_request(); });
                    }));
}

// Why this request may not become the WebSocket; empty: it may.
std::string Connection::refusal(const Request& request) const {
  const std::string_view target = view_of(request.target());
  if (path_of(target) != "/live") return "the socket is at /live\n";
  if (!may_connect(view_of(request[http::field::origin]), view_of(request[http::field::host]),
                   is_loopback(shared_.options.host)))
    return "a page of another site may not connect\n";
  if (!same_secret(token_of(target), shared_.options.token))
    return "the token is missing or wrong: open the address that the program has printed\n";
  return {};
}

void Connection::become_live(const Request& request) {
  if (const std::string why = refusal(request); !why.empty()) {
    auto response = std::make_shared<Response>(http::status::forbidden, request.version());
    response->body() = why;
    response->keep_alive(false);
    response->prepare_payload();
    return respond(std::move(response));
  }
  http_->expires_never();
  live_.emplace(std::move(*http_));
  http_.reset();
  websocket::stream_base::timeout timeout{};
  timeout.handshake_timeout = long_enough;
  timeout.idle_timeout = milliseconds(shared_.options.silence);
  timeout.keep_alive_pings = true;
  live_->set_option(timeout);
  live_->read_message_max(shared_.options.largest_message);
  live_->async_accept(request, Ended([self = shared_from_this()](beast::error_code error) {
                        if (error) return self->end();
                        self->guarded([&] { self->opened(); });
                      }));
}

void Connection::opened() {
  beast::error_code ignored;
  live_->next_layer().socket().set_option(asio::ip::tcp::no_delay(true), ignored);
  is_open_ = true;
  shared_.on_client(id_, true);
  shared_.service.opened(id_);
  offer_frame();
  read_message();
}

void Connection::read_message() {
  buffer_.clear();
  live_->async_read(
      buffer_, Moved([self = shared_from_this()](beast::error_code error, std::size_t) {
        if (error) return self->end();
        self->guarded([&] {
          const auto data = self->buffer_.cdata();
          self->shared_.service.received(self->id_, {static_cast<const char*>(data.data()), data.size()});
          self->read_message();
        });
      }));
}

void Connection::acknowledged() {
  is_frame_seen_ = true;
  offer_frame();
}

void Connection::offer_frame() {
  if (!is_live() || !is_frame_seen_ || !frame_.empty()) return;
  guarded([&] {
    frame_ = shared_.service.next_frame(id_);
    if (frame_.empty()) return;
    is_frame_seen_ = false;
    write_next();
  });
}

void Connection::send(std::string text) {
  if (!is_live() || closing_) return;
  if (texts_.size() >= shared_.options.most_waiting_texts) return close();
  texts_.push_back(std::move(text));
  write_next();
}

void Connection::drop(std::string_view why) {
  if (!is_live() || closing_) return;
  closing_.emplace(websocket::close_code::policy_error,
                   beast::string_view(why.data(), std::min<std::size_t>(why.size(), 120)));
  write_next();
}

// Writes one message at a time: texts first, then the frame, then the closing message.
void Connection::write_next() {
  if (is_writing_) return;
  const bool is_text = !texts_.empty();
  if (!is_text && frame_.empty()) {
    if (!closing_) return;
    is_writing_ = true;  // for good
    return live_->async_close(*closing_,
                              Ended([self = shared_from_this()](beast::error_code) { self->close(); }));
  }
  is_writing_ = true;
  live_->text(is_text);
  live_->binary(!is_text);
  const std::string& next = is_text ? texts_.front() : frame_;
  live_->async_write(asio::buffer(next),
                     Moved([self = shared_from_this(), is_text](beast::error_code error, std::size_t) {
                       self->is_writing_ = false;
                       if (error) return;  // the reading side ends it
                       if (is_text)
                         self->texts_.pop_front();
                       else
                         self->frame_.clear();
                       self->guarded([&] {
                         self->write_next();
                         self->offer_frame();
                       });
                     }));
}

void Connection::end() {
  if (std::exchange(is_open_, false)) shared_.service.closed(id_);
  close();
  shared_.on_client(id_, false);
}

}  // namespace lobe::view
