// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#pragma once

#include <filesystem>
#include <string>

#include "lobe/io/atomic_file.h"

namespace lobe::meshing {

// Whole or absent, like a mesh.
inline void write_text(const std::filesystem::path& file, const std::string& text) {
  io::AtomicFile out(file);
  out.stream() << text;
  out.commit();
}

}  // namespace lobe::meshing
