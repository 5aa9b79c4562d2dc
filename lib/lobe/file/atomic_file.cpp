#include "lobe/file/atomic_file.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <system_error>

#include "lobe/error.h"

namespace lobe::io {
namespace {

// A name that is unique among the processes and threads that may write the same file.
std::filesystem::path temporary_name(std::filesystem::path file) {
  static std::atomic<unsigned> counter = 0;
  const std::string process = std::to_string(getpid()), number = std::to_string(counter++);
  file += '.';
  file += process;
  file += '-';
  file += number;
  file += ".part";
  return file;
}

[[noreturn]] void fail(const std::filesystem::path& file, int error) {
  const std::string why = error ? ": " + std::generic_category().message(error) : "";
  throw InputError(file.string(), "cannot be written" + why + "; check the folder and the space on the disk");
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path file)
    : file_(std::move(file)), temporary_(temporary_name(file_)) {
  std::error_code none;  // the file may not exist yet
  const auto kind = std::filesystem::status(file_, none).type();
  using Kind = std::filesystem::file_type;
  if (kind == Kind::block || kind == Kind::character || kind == Kind::fifo || kind == Kind::socket)
    throw InputError(file_.string(),
                     "is a device or a pipe, which a file would take the place of; name a file");
  errno = 0;
  stream_.open(temporary_, std::ios::binary | std::ios::trunc);
  if (!stream_) fail(file_, errno);
  stream_.imbue(std::locale::classic());
}

AtomicFile::~AtomicFile() {
  if (committed_) return;
  stream_.close();
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

void AtomicFile::commit() {
  errno = 0;
  stream_.close();
  if (!stream_) fail(file_, errno);
  std::error_code error;
  std::filesystem::rename(temporary_, file_, error);
  if (error) fail(file_, error.value());
  committed_ = true;
}

void write_file(const std::filesystem::path& file, const std::string& contents) {
  AtomicFile out(file);
  out.write(contents.data(), contents.size());
  out.commit();
}

std::string xml_escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  return escaped;
}

}  // namespace lobe::io
