// A file that is whole or absent.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace lobe::io {

// Writes to a temporary name in the same folder; commit() renames it. Without commit() nothing is left
// behind, and an older file is untouched. Throws InputError where the disk is full or the folder
// cannot be written to.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path file);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  std::ostream& stream() { return stream_; }
  void write(const void* data, std::size_t bytes) {
    stream_.write(static_cast<const char*>(data), static_cast<std::streamsize>(bytes));
  }
  void commit();

 private:
  std::filesystem::path file_, temporary_;
  std::ofstream stream_;
  bool committed_ = false;
};

// Writes the whole file or nothing. Throws as AtomicFile does.
void write_file(const std::filesystem::path& file, const std::string& contents);

std::string xml_escaped(const std::string& text);

}  // namespace lobe::io
