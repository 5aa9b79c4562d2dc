// Shared by the tests of io/: files in data/, files made by a test, and the messages of faults.
//
// The files in data/ all hold the same mesh: the tetrahedra of box_mesh({2, 1, 1}, 2, 1, 1) in its order,
// those of the first cube with label 1, of the second with label 2, and two triangles with label 7, written
// by Gmsh 4.8, VTK 9.1, meshio 5 or by hand. TetGen's pair has no triangles.
#pragma once

#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "folder.h"
#include "lobe/error.h"
#include "lobe/file/scanner.h"
#include "lobe/mesh/generators.h"

#define CHECK_CONTAINS(text, part)                   \
  do {                                               \
    const std::string found_text = (text);           \
    CAPTURE(found_text);                             \
    CHECK(found_text.find(part) != found_text.npos); \
  } while (false)

namespace fixture {

inline const std::filesystem::path data = LOBE_IO_DATA;

inline const char* const files[] = {"ascii.vtu",
                                    "base64_64.vtu",
                                    "base64_zlib_big_endian_32.vtu",
                                    "inline_64.vtu",
                                    "inline_meshio.vtu",
                                    "inline_meshio_zlib.vtu",
                                    "inline_zlib_big_endian_32.vtu",
                                    "raw_big_endian_32.vtu",
                                    "raw_zlib_64.vtu",
                                    "legacy20_ascii.vtk",
                                    "legacy42_ascii.vtk",
                                    "legacy42_binary.vtk",
                                    "legacy51_ascii.vtk",
                                    "legacy51_binary.vtk",
                                    "gmsh1.msh",
                                    "gmsh22_ascii.msh",
                                    "gmsh22_binary.msh",
                                    "gmsh41_ascii.msh",
                                    "gmsh41_binary.msh",
                                    "medit.mesh",
                                    "tetgen.ele"};

inline lobe::TetMesh two_cubes() {
  lobe::TetMesh mesh = lobe::box_mesh({2, 1, 1}, 2, 1, 1);
  for (std::size_t t = 0; t < 12; ++t) mesh.labels[t] = t < 6 ? 1 : 2;
  return mesh;
}

inline std::string bytes(const std::string& file) { return lobe::io::read_file(data / file); }

// `text` with its first `old` replaced.
inline std::string edited(std::string text, const std::string& old, const std::string& now) {
  const std::size_t at = text.find(old);
  REQUIRE(at != text.npos);
  return text.replace(at, old.size(), now);
}

using lobe::test::Folder;

template <class Call>
std::string fault_of(const Call& call) {
  try {
    call();
  } catch (const lobe::InputError& error) {
    return error.what();
  }
  return "no fault";
}

}  // namespace fixture
