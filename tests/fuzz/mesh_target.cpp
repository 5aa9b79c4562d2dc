// Whatever the bytes, a mesh reader gives a mesh or an InputError. The first byte chooses the format.
#include <string>

#include "fuzz/target.h"
#include "lobe/error.h"
#include "lobe/io/raw_mesh.h"

using namespace lobe;

namespace {

void read(char format, std::string_view bytes) {
  if (format == 'u') io::read_vtu("mesh", bytes);
  if (format == 'k') io::finish(io::read_vtk_legacy("mesh", bytes), "mesh");
  if (format == 'g') io::finish(io::read_gmsh("mesh", bytes), "mesh");
  if (format == 'm') io::finish(io::read_medit("mesh", bytes), "mesh");
  if (format != 't') return;  // TetGen: nodes, a line of dashes, elements
  constexpr std::string_view dashes = "\n--\n";
  const std::size_t end = std::min(bytes.find(dashes), bytes.size());
  const std::string_view elements = bytes.substr(std::min(end + dashes.size(), bytes.size()));
  io::finish(io::read_tetgen("node", bytes.substr(0, end), "ele", elements), "mesh");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  try {
    read(static_cast<char>(data[0]), {reinterpret_cast<const char*>(data) + 1, size - 1});
  } catch (const InputError&) {
  }
  return 0;
}
