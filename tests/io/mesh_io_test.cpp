#include "lobe/io/mesh_io.h"

#include <doctest/doctest.h>

#include "io/fixture.h"

using namespace lobe;

TEST_CASE("every format gives the same mesh, tetrahedra in order, with labels and ignored cells") {
  const TetMesh expected = fixture::two_cubes();
  for (const std::string file : fixture::files) {
    CAPTURE(file);
    const MeshFile read = read_mesh(fixture::data / file);
    REQUIRE(read.mesh.vertex_count() == 12);
    REQUIRE(read.mesh.tet_count() == 12);
    CHECK(read.mesh.labels == expected.labels);
    const bool has_groups = file != "tetgen.ele";
    CHECK(read.ignored_cells == 0);
    REQUIRE(read.surfaces.size() == (has_groups ? 1u : 0u));
    for (const SurfaceGroup& surface : read.surfaces) {
      CHECK(surface.number == 7);
      CHECK(surface.triangles.size() == 2);
    }
    CHECK(read.prepared.warnings().empty());
    for (Index t = 0; t < 12; ++t) CHECK(tet_points(read.mesh, t) == tet_points(expected, t));
    if (file.find("gmsh41") == file.npos)
      CHECK(read.mesh.points == expected.points);  // sorted by entity there
  }
}

TEST_CASE("text files with Windows line ends give the same mesh") {
  const fixture::Folder folder;
  for (const std::string file :
       {"legacy20_ascii.vtk", "legacy42_ascii.vtk", "legacy51_ascii.vtk", "gmsh1.msh", "gmsh22_ascii.msh",
        "gmsh41_ascii.msh", "medit.mesh", "ascii.vtu"}) {
    CAPTURE(file);
    std::string text;
    for (const char c : fixture::bytes(file)) text += c == '\n' ? "\r\n" : std::string(1, c);
    const MeshFile read = read_mesh(folder.write(file, text));
    CHECK(read.mesh.points == read_mesh(fixture::data / file).mesh.points);
    CHECK(read.mesh.tets == read_mesh(fixture::data / file).mesh.tets);
    CHECK(read.mesh.labels == fixture::two_cubes().labels);
  }
}

TEST_CASE("files that cannot be read are named, with what was expected") {
  const fixture::Folder folder;
  const auto fault = [](const std::filesystem::path& file) {
    return fixture::fault_of([&] { read_mesh(file); });
  };
  CHECK_CONTAINS(fault(folder.path / "none.vtu"), "none.vtu: no such file");
  CHECK_CONTAINS(fault(folder.path), "unknown extension");
  CHECK_CONTAINS(fault(folder.write("liver.stl", "solid")), "unknown extension '.stl', expected .vtu");
  std::filesystem::create_directory(folder.path / "folder.msh");
  CHECK_CONTAINS(fault(folder.path / "folder.msh"), "is not a regular file");
  for (const char* name : {"a.vtu", "a.vtk", "a.msh", "a.mesh"})
    CHECK_CONTAINS(fault(folder.write(name, "")), std::string(name) + ": is empty");
  folder.write("a.node", "");
  CHECK_CONTAINS(fault(folder.path / "a.ele"), "a.node: is empty");
  folder.write("a.node", "0 3 0 0");
  CHECK_CONTAINS(fault(folder.path / "a.node"), "a.ele: no such file; TetGen's .node and .ele");
  folder.write("a.ele", "");
  CHECK_CONTAINS(fault(folder.path / "a.ele"), "a.ele: is empty");
}
