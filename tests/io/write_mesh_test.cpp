#include <Eigen/Geometry>

#include "io/fixture.h"
#include "lobe/io/grouped_mesh.h"
#include "lobe/mesh/refine.h"

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
  for (const std::string name : {"a.vtu", "a.msh", "a.msh2", "a.mesh"}) {
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
  CHECK_FALSE(holds_groups("a.vtk"));
  CHECK_CONTAINS(fixture::fault_of([&] { write_grouped_mesh(folder.path / "a.vtk", mesh, groups); }),
                 "this format holds no groups");
}

TEST_CASE("a VTU file with groups keeps its arrays, and names of any letters") {
  const fixture::Folder folder;
  TetMesh mesh = fixture::two_cubes();
  mesh.fibres = Mat3X<double>::Random(3, mesh.tet_count());
  const Groups groups{{{2, "Größe \"7\" & <x>", {{{0, 1, 2}}}}}, {{0, "rest"}, {2, "2 b"}}};
  const DataArray place{"place", mesh.points}, number{"number", Eigen::MatrixXd::Random(2, mesh.tet_count())};
  write_grouped_vtu(folder.path / "a.vtu", mesh, groups, {place}, {number});
  const MeshFile read = read_mesh(folder.path / "a.vtu");
  CHECK(read.warnings().empty());
  CHECK(read.mesh.points == mesh.points);
  CHECK(read.mesh.tets == mesh.tets);
  CHECK(read.mesh.labels == mesh.labels);
  CHECK(read.mesh.fibres == mesh.fibres);
  CHECK(read.point_data.at("place") == place.values);
  CHECK(read.cell_data.at("number") == number.values);
  CHECK(read.label_names == groups.label_names);
  REQUIRE(read.surfaces.size() == 1);
  CHECK(read.surfaces[0].name == groups.surfaces[0].name);
  CHECK(read.surfaces[0].triangles == groups.surfaces[0].triangles);
  const std::string text = io::read_file(folder.path / "a.vtu");
  CHECK_CONTAINS(text,
                 "<Array type=\"String\" Name=\"surface_names\" NumberOfTuples=\"1\"");  // as VTK writes it
  CHECK_CONTAINS(
      fixture::fault_of([&] {
        write_grouped_vtu(folder.path / "b.vtu", mesh, groups, {}, {{"few", number.values.leftCols(3)}});
      }),
      "array 'few' has 3 columns, expected 12 for CellData");
}

TEST_CASE("groups on a refinement are four triangles for each, and others are left out") {
  const TetMesh mesh = box_mesh({1, 1, 1}, 1, 1, 1);
  const RefinedMesh fine = refine(mesh);
  const auto corners = mesh.tets.col(0);
  const auto parts = refined_triangles({{corners[0], corners[1], corners[2]}, {0, 0, 1}}, mesh, fine);
  REQUIRE(parts.size() == 4);
  Vec3d sum = Vec3d::Zero();
  const auto area = [](const TetMesh& of, const std::array<Index, 3>& t) {
    return Vec3d(
        (of.points.col(t[1]) - of.points.col(t[0])).cross(of.points.col(t[2]) - of.points.col(t[0])));
  };
  for (const auto& part : parts) sum += area(fine.mesh, part);
  CHECK((sum - area(mesh, {corners[0], corners[1], corners[2]})).norm() < 1e-15);
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
  CHECK_CONTAINS(
      fixture::fault_of([&] {
        write_grouped_mesh(folder.path / "a.msh", fixture::two_cubes(), {{{-3, "", {{{0, 1, 2}}}}}, {}});
      }),
      "surface -3: Gmsh's groups are not negative");
  CHECK(fault("a.mesh") == "no fault");
  mesh.tets.resize(4, 0);
  CHECK_CONTAINS(fault("b.mesh"), "no tetrahedron");
  CHECK(folder.file_count() == 1);
}
