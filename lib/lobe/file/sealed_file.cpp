#include "lobe/file/sealed_file.h"

#include "lobe/file/atomic_file.h"
#include "lobe/file/scanner.h"

namespace lobe::io {
namespace {

constexpr std::size_t name_size = 8, head_size = name_size + sizeof(std::uint32_t) + sizeof(std::uint64_t),
                      seal_size = sizeof(std::uint64_t);

}  // namespace

std::string seal(const Format& format, const std::string& contents) {
  ByteWriter head;
  head.put(format.version);
  head.put(std::uint64_t(contents.size()));
  std::string bytes = std::string(format.name) + head.bytes() + contents;
  ByteWriter checksum;
  checksum.put(digest(bytes));
  return bytes + checksum.bytes();
}

std::string_view unseal(const std::string& file, std::string_view bytes, const Format& format) {
  const auto refuse = [&](const std::string& why) { throw InputError(file, why); };
  const std::string what = format.what;
  if (bytes.substr(0, name_size) != format.name) refuse("is not the " + what);
  if (bytes.size() < head_size + seal_size) refuse("is cut off");
  ByteReader head(file, bytes.substr(name_size));
  if (const auto version = head.get<std::uint32_t>(); version != format.version)
    refuse("is the " + what + " in version " + std::to_string(version) + "; this program knows version " +
           std::to_string(format.version));
  if (head.get<std::uint64_t>() != bytes.size() - head_size - seal_size)
    refuse("is cut off, or has extra bytes after its end");
  const std::string_view sealed = bytes.substr(0, bytes.size() - seal_size);
  ByteReader checksum(file, bytes.substr(sealed.size()));
  if (checksum.get<std::uint64_t>() != digest(sealed)) refuse("is damaged: its checksum is wrong");
  return sealed.substr(head_size);
}

void write_sealed(const std::filesystem::path& file, const Format& format, const std::string& contents) {
  write_file(file, seal(format, contents));
}

std::string read_sealed(const std::filesystem::path& file, const Format& format) {
  const std::string bytes = read_file(file);
  return std::string(unseal(file.string(), bytes, format));
}

}  // namespace lobe::io
