// Files that benchmarks write.
#pragma once

#include <filesystem>
#include <string>

#include "lobe/io/atomic_file.h"

namespace lobe::bench {

inline void write_file(const std::filesystem::path& file, const std::string& text) {
  io::AtomicFile out(file);
  out.stream() << text;
  out.commit();
}

}  // namespace lobe::bench
