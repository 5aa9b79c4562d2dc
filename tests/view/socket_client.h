// A client of lobe view's server, for tests: HTTP and WebSocket by hand.
#pragma once

#include <arpa/inet.h>
#include <doctest/doctest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <string>
#include <utility>

namespace lobe::test {

// One connection, byte by byte.
class Client {
 public:
  explicit Client(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    timeval patience{30, 0};
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
  // Kind and content of a message; 0 where there is none.
  std::pair<int, std::string> hear() {
    constexpr int last = 0x80;
    std::pair<int, std::string> message{0, ""};
    for (int flags = 0; (flags & last) == 0;) {  // its parts
      const std::string start = read(2);
      if (start.size() < 2) return {0, ""};
      flags = static_cast<unsigned char>(start[0]);
      if ((flags & 15) != 0) message.first = flags & 15;
      std::size_t size = static_cast<unsigned char>(start[1]) & 127;
      if (size >= 126) {
        const std::string bytes = read(size == 126 ? 2 : 8);
        size = 0;
        for (const char byte : bytes) size = 256 * size + static_cast<unsigned char>(byte);
      }
      message.second += read(size);
    }
    return message;
  }

 private:
  int socket_;
};

}  // namespace lobe::test
