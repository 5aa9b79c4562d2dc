#include <doctest/doctest.h>

#include <vector>

#include "server.h"

using namespace lobe::view;

TEST_CASE("the page of the server itself may connect, through a forwarded port as well") {
  CHECK(may_connect("http://localhost:8080", "localhost:8080", true));
  CHECK(may_connect("http://127.0.0.1:9000", "127.0.0.1:9000", true));
  CHECK(may_connect("http://[::1]:8080", "[::1]:8080", true));
  CHECK(may_connect("https://LOCALHOST", "localhost", true));
}

TEST_CASE("the page of another site may not connect") {
  CHECK_FALSE(may_connect("http://evil.example", "localhost:8080", true));
  CHECK_FALSE(may_connect("http://localhost:8081", "localhost:8080", true));
  CHECK_FALSE(may_connect("null", "localhost:8080", true));
  CHECK_FALSE(may_connect("", "localhost:8080", true));
  CHECK_FALSE(may_connect("http://localhost:8080.evil.example", "localhost:8080", true));
}

TEST_CASE("a name that was bent to this machine is refused, unless others may use it") {
  CHECK_FALSE(may_connect("http://evil.example:8080", "evil.example:8080", true));
  CHECK_FALSE(may_connect("http://localhost.evil.example", "localhost.evil.example", true));
  CHECK_FALSE(may_connect("http://127.evil.example", "127.evil.example", true));
  CHECK_FALSE(may_connect("http://", "", true));
  CHECK(may_connect("http://simulator.hospital:8080", "simulator.hospital:8080", false));
}

TEST_CASE("addresses of this machine alone are told from others") {
  for (const char* host : {"localhost", "127.0.0.1", "127.1.2.3", "::1"}) CHECK(is_loopback(host));
  for (const char* host : {"0.0.0.0", "::", "192.168.0.1", "127.example.org", "example.org", ""})
    CHECK_FALSE(is_loopback(host));
}

TEST_CASE("who makes room: of the address with the most connections the oldest that has asked for nothing") {
  const std::vector<Stranger> strangers = {
      {1, "a", true}, {2, "b", false}, {3, "b", true}, {4, "b", false}, {5, "a", false}};
  CHECK(least_wanted(strangers) == 2);
  CHECK(least_wanted(std::vector<Stranger>{{1, "a", true}, {5, "a", false}, {7, "b", false}}) == 5);
  CHECK(least_wanted(std::vector<Stranger>{{3, "a", true}, {5, "a", true}}) == 3);
}
