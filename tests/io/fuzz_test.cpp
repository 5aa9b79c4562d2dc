// Damaged files: whatever the bytes, a reader gives a mesh or an InputError.
#include "io/fixture.h"
#include "lobe/io/raw_mesh.h"

using namespace lobe;

namespace {

MeshFile read_any(const std::string& file, std::string_view bytes) {
  const std::string extension = std::filesystem::path(file).extension();
  if (extension == ".vtu") return io::read_vtu(file, bytes);
  if (extension == ".vtk") return io::finish(io::read_vtk_legacy(file, bytes), file);
  if (extension == ".msh") return io::finish(io::read_gmsh(file, bytes), file);
  if (extension == ".mesh") return io::finish(io::read_medit(file, bytes), file);
  return io::finish(io::read_tetgen(file, fixture::bytes("tetgen.node"), file, bytes), file);
}

// True if it was read; any exception but InputError, and any crash, fails the test.
bool survives(const std::string& file, const std::string& bytes) {
  try {
    // A copy on the heap of exactly this size: the sanitizer sees a byte read beyond it.
    const std::vector<char> exact(bytes.begin(), bytes.end());
    const MeshFile result = read_any(file, {exact.data(), exact.size()});
    CHECK(result.mesh.tet_count() > 0);
    return true;
  } catch (const InputError& error) {
    CHECK(std::string(error.what()).find(file) == 0);  // every message begins with the file
    return false;
  }
}

}  // namespace

TEST_CASE("a file cut off anywhere is refused, or was complete") {
  for (const std::string file : fixture::files) {
    CAPTURE(file);
    const std::string whole = fixture::bytes(file);
    CHECK(survives(file, whole));
    for (std::size_t size = 0; size < whole.size(); ++size) {
      CAPTURE(size);
      const bool read = survives(file, whole.substr(0, size));
      if (size < whole.size() / 2) CHECK_FALSE(read);
    }
  }
}

TEST_CASE("a file with any one byte changed gives a mesh or a message") {
  for (const std::string file : fixture::files) {
    CAPTURE(file);
    std::string bytes = fixture::bytes(file);
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      CAPTURE(at);
      const char before = bytes[at];
      for (const char now : {'\0', '\xff', '9', '-', '\n', static_cast<char>(before ^ 0x40)}) {
        bytes[at] = now;
        survives(file, bytes);
      }
      bytes[at] = before;
    }
  }
}

TEST_CASE("a file with a number made huge, negative or no number gives a mesh or a message") {
  for (const std::string file : fixture::files) {
    CAPTURE(file);
    const std::string whole = fixture::bytes(file);
    for (std::size_t at = 1; at < whole.size(); ++at) {
      const bool begins_number = std::isdigit(static_cast<unsigned char>(whole[at])) &&
                                 !std::isalnum(static_cast<unsigned char>(whole[at - 1])) &&
                                 whole[at - 1] != '.';
      if (!begins_number) continue;
      CAPTURE(at);
      for (const char* now : {"9223372036854775807", "18446744073709551615", "4294967296", "-", "1e400",
                              "nan", "2147483647", "0x10"})
        survives(file, whole.substr(0, at) + now + whole.substr(at + 1));
    }
  }
}

TEST_CASE("a file with eight bytes overwritten by an extreme number gives a mesh or a message") {
  for (const std::string file : fixture::files) {
    CAPTURE(file);
    const std::string whole = fixture::bytes(file);
    for (std::size_t at = 0; at + 8 <= whole.size(); ++at) {
      CAPTURE(at);
      survives(file, std::string(whole).replace(at, 8, "\xff\xff\xff\xff\xff\xff\xff\x7f"));
      survives(file, std::string(whole).replace(at, 8, 8, '\0'));
      survives(file, std::string(whole).replace(at, 8, 8, '\xff'));
    }
  }
}
