#include "token.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <random>

namespace lobe::view {
namespace {

constexpr std::size_t least = 24, most = 1000;  // characters of a token

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  operator int() const { return number_; }

 private:
  int number_;
};

// The token in a file that is this user's alone; empty if it is not, or holds none.
std::string read_token(const std::filesystem::path& name) {
  const Descriptor file(::open(name.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK));
  struct stat facts {};
  if (file < 0 || ::fstat(file, &facts) != 0) return {};
  if (!S_ISREG(facts.st_mode) || facts.st_uid != ::geteuid() || (facts.st_mode & 077) != 0) return {};
  std::string text(most, '\0');
  text.resize(std::size_t(std::max<ssize_t>(0, ::read(file, text.data(), text.size()))));
  text.resize(std::min(text.size(), text.find_first_of(" \t\r\n")));
  return text.size() >= least ? text : std::string();
}

// A new file beside `name`, whole, and readable by its owner alone from the start; empty if there can be
// none.
std::filesystem::path write_beside(const std::filesystem::path& name, const std::string& token) {
  std::string beside = name.string() + ".XXXXXX";
  const Descriptor file(::mkostemp(beside.data(), O_CLOEXEC));  // of mode 0600
  if (file < 0) return {};
  const std::string line = token + '\n';
  if (::write(file, line.data(), line.size()) == ssize_t(line.size())) return beside;
  ::unlink(beside.c_str());
  return {};
}

}  // namespace

std::string random_token() {
  std::random_device device;
  std::string token;
  for (std::size_t i = 0; i < least; ++i) token += "abcdefghijklmnopqrstuvwxyz234567"[device() % 32];
  return token;
}

// Of two programs that start at once, the one that comes second takes the token of the first.
std::string kept_token(const std::filesystem::path& file) {
  if (const std::string token = read_token(file); !token.empty()) return token;
  const std::string token = random_token();
  std::error_code ignored;
  std::filesystem::create_directories(file.parent_path(), ignored);
  const std::filesystem::path beside = write_beside(file, token);
  if (beside.empty()) return token;
  const bool is_first = ::link(beside.c_str(), file.c_str()) == 0;
  const std::string other = is_first ? std::string() : read_token(file);
  if (is_first || !other.empty() || ::rename(beside.c_str(), file.c_str()) != 0) ::unlink(beside.c_str());
  return other.empty() ? token : other;
}

std::filesystem::path token_file() {
  const char *state = std::getenv("XDG_STATE_HOME"), *home = std::getenv("HOME");
  if (!state && !home) return {};
  return (state ? std::filesystem::path(state) : std::filesystem::path(home) / ".local/state") / "lobe" /
         "view_token";
}

}  // namespace lobe::view
