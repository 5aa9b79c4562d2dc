#include "token.h"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include <thread>
#include <vector>

#include "folder.h"

using lobe::test::Folder;
using lobe::view::kept_token;

namespace {

mode_t mode_of(const std::filesystem::path& file) {
  struct stat facts {};
  REQUIRE(::lstat(file.c_str(), &facts) == 0);
  return facts.st_mode & 07777;
}

// What happens in a folder from now on.
class Watch {
 public:
  explicit Watch(const std::filesystem::path& folder) : events_(inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
    REQUIRE(inotify_add_watch(events_, folder.c_str(), IN_ALL_EVENTS) >= 0);
  }
  ~Watch() { ::close(events_); }
  std::uint32_t seen() const {
    alignas(inotify_event) char bytes[4096];
    std::uint32_t mask = 0;
    for (ssize_t size = 0; (size = ::read(events_, bytes, sizeof bytes)) > 0;)
      for (ssize_t at = 0; at < size;) {
        const auto* event = reinterpret_cast<const inotify_event*>(bytes + at);
        mask |= event->mask;
        at += ssize_t(sizeof *event + event->len);
      }
    return mask;
  }

 private:
  const int events_;
};

}  // namespace

TEST_CASE("the token's file is private from when it is there, whatever others may do by default") {
  Folder folder;
  const std::filesystem::path file = folder.path / "view_token";
  const mode_t before = ::umask(0);
  const Watch watch(folder.path);
  const std::string token = kept_token(file);
  ::umask(before);
  const std::uint32_t seen = watch.seen();
  CHECK(mode_of(file) == 0600);
  CHECK((seen & IN_CREATE) != 0);
  CHECK((seen & IN_ATTRIB) == 0);  // its mode was never another one
  CHECK(token.size() >= 24);
  CHECK(lobe::test::bytes_of(file) == token + "\n");
  CHECK(kept_token(file) == token);
}

TEST_CASE("a token that others could have read, that is a link or is none, is replaced") {
  Folder folder;
  const std::filesystem::path file = folder.path / "view_token";
  const std::string old = "abcdefghijklmnopqrstuvwx";
  const auto replaced = [&] {
    const std::string token = kept_token(file);
    CHECK(token != old);
    CHECK(token.size() >= 24);
    CHECK(mode_of(file) == 0600);
    CHECK(kept_token(file) == token);
    std::filesystem::remove(file);
  };
  folder.write("view_token", old + "\n");
  std::filesystem::permissions(file, std::filesystem::perms(0644));
  replaced();
  const std::filesystem::path other = folder.write("other", old + "\n");
  std::filesystem::permissions(other, std::filesystem::perms(0600));
  std::filesystem::create_symlink(other, file);
  replaced();
  CHECK(lobe::test::bytes_of(other) == old + "\n");
  folder.write("view_token", "short\n");
  std::filesystem::permissions(file, std::filesystem::perms(0600));
  replaced();
}

TEST_CASE("without a place for its file a token is good for one run") {
  Folder folder;
  const std::filesystem::path file = folder.write("file", "") / "view_token";
  const std::string token = kept_token(file);
  CHECK(token.size() >= 24);
  CHECK(kept_token(file) != token);
}

TEST_CASE("programs that start at the same time have the same token") {
  for (int round = 0; round < 20; ++round) {
    Folder folder;
    const std::filesystem::path file = folder.path / "a" / "view_token";
    std::vector<std::string> tokens(4);
    std::vector<std::thread> threads;
    for (std::string& token : tokens) threads.emplace_back([&token, &file] { token = kept_token(file); });
    for (std::thread& thread : threads) thread.join();
    for (const std::string& token : tokens) CHECK(token == tokens.front());
  }
}
