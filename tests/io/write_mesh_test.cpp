#include "io/fixture.h"
#include "lobe/io/grouped_mesh.h"

using namespace lobe;

TEST_CASE("every format that is written reads back as the same mesh, bit for bit, with its labels") {
  const fixture::Folder folder;
  TetMesh mesh = fixture::two_cubes();
  mesh.points.row(1) *= 0.1 / 3;  // numbers that need all their digits
  mesh.points.row(2) *= 1e-3 / 7;
  std::swap(mesh.labels[3], mesh.labels[8]);  // labels in no order
  mesh.labels[5] = 0;
  for (const std::string name : {"a.vtu", "a.vtk", "a.msh", "a.msh2", "a.mesh", "a.node", "b.ele", "c.MSH"}) {
    CAPTURE(name);
    REQUIRE(can_write_mesh(folder.path / name));
    write_mesh(folder.path / name, mesh);
    const MeshFile read = read_mesh(folder.path / name);
    CHECK(read.mesh.points == mesh.points);
    CHECK(read.mesh.tets == mesh.tets);
    CHECK(read.mesh.labels == mesh.labels);
    CHECK(read.ignored_cells == 0);
  }
  CHECK(folder.file_count() == 10);  // TetGen's come in pairs, and nothing else stays behind
}

TEST_CASE("groups of triangles and names read back from the formats that hold them") {
  const fixture::Folder folder;
  const TetMesh mesh = fixture::two_cubes();
  const Groups groups{{{3, "held side", {{{0, 1, 2}}, {{1, 2, 3}}}}, {7, "", {{{4, 5, 6}}}}},
                      {{1, "soft"}, {2, "stiff"}}};
  for (const std::string name : {"a.msh", "a.msh2", "a.mesh"}) {
    CAPTURE(name);
    REQUIRE(holds_groups(folder.path / name));
    write_grouped_mesh(folder.path / name, mesh, groups);
    const MeshFile read = read_mesh(folder.path / name);
    const bool has_names = name != "a.mesh";
    CHECK(read.mesh.tets == mesh.tets);
    CHECK(read.mesh.labels == mesh.labels);
    REQUIRE(read.surfaces.size() == 2);
    for (std::size_t g = 0; g < 2; ++g) {
      CHECK(read.surfaces[g].number == groups.surfaces[g].number);
      CHECK(read.surfaces[g].name == (has_names ? groups.surfaces[g].name : ""));
      CHECK(read.surfaces[g].triangles == groups.surfaces[g].triangles);
    }
    CHECK((read.label_names == groups.label_names) == has_names);
  }
  CHECK_FALSE(holds_groups("a.vtu"));
  CHECK_CONTAINS(fixture::fault_of([&] { write_grouped_mesh(folder.path / "a.vtk", mesh, groups); }),
                 "this format holds no groups");
}

TEST_CASE("a mesh without labels reads back with labels 0") {
  const fixture::Folder folder;
  TetMesh mesh = fixture::two_cubes();
  mesh.labels.clear();
  for (const std::string name : {"a.vtk", "a.msh", "a.msh2", "a.mesh", "a.ele"}) {
    CAPTURE(name);
    write_mesh(folder.path / name, mesh);
    CHECK(read_mesh(folder.path / name).mesh.labels == std::vector<int>(12, 0));
  }
}

TEST_CASE("what a format cannot hold is refused, and nothing is written") {
  const fixture::Folder folder;
  TetMesh mesh = fixture::two_cubes();
  const auto fault = [&](const char* name) {
    return fixture::fault_of([&] { write_mesh(folder.path / name, mesh); });
  };
  CHECK_CONTAINS(fault("a.stl"), "unknown extension '.stl', expected .vtu");
  mesh.labels[0] = -1;
  CHECK_CONTAINS(fault("a.msh"), "label -1");
  CHECK_CONTAINS(fault("a.msh2"), "label -1");
  CHECK(fault("a.mesh") == "no fault");
  mesh.tets.resize(4, 0);
  CHECK_CONTAINS(fault("b.mesh"), "no tetrahedron");
  CHECK(folder.file_count() == 1);
}
