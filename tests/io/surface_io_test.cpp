#include "lobe/io/surface_io.h"

#include "io/fixture.h"

using namespace lobe;

namespace {

struct Triangulation {
  Mat3X<double> points;
  Triangles triangles;
};

Triangulation tetrahedron() {
  Triangulation surface{Mat3X<double>(3, 4), Triangles(3, 4)};
  surface.points << 0, 0.1, 0, 0, /**/ 0, 0, 1, 0, /**/ 0, 0, 0, 1;
  surface.triangles << 0, 0, 0, 1, /**/ 2, 1, 3, 2, /**/ 1, 3, 2, 3;
  return surface;
}

std::string written(const fixture::Folder& folder, const char* name) {
  const Triangulation surface = tetrahedron();
  write_surface(folder.path / name, surface.points, surface.triangles);
  return io::read_file(folder.path / name);
}

}  // namespace

TEST_CASE("surfaces as OBJ and OFF are exact text") {
  const fixture::Folder folder;
  CHECK(written(folder, "a.obj") ==
        "v 0 0 0\nv 0.1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  CHECK(written(folder, "a.OFF") ==
        "OFF\n4 4 0\n0 0 0\n0.1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
}

TEST_CASE("surfaces as PLY and STL have the size their header announces") {
  const fixture::Folder folder;
  const std::string ply = written(folder, "a.ply"), end = "end_header\n";
  CHECK(ply.size() - ply.find(end) - end.size() == 4 * 24 + 4 * 13);
  const std::string stl = written(folder, "a.stl");
  CHECK(stl.size() == 84 + 4 * 50);
  float normal[3];
  std::memcpy(normal, stl.data() + 84, sizeof normal);  // the face z = 0 looks down
  CHECK(normal[0] == 0);
  CHECK(normal[1] == 0);
  CHECK(normal[2] == -1);
}

TEST_CASE("data of triangles become properties of the faces of a PLY") {
  const fixture::Folder folder;
  const Triangulation surface = tetrahedron();
  const std::vector<DataArray> data{{"open edges", Eigen::RowVector4d(0, 1, 0, 2), DataArray::Type::int32},
                                    {"area", Eigen::RowVector4d(0.5, 1, 2, 4)}};
  write_surface(folder.path / "a.ply", surface.points, surface.triangles, data);
  const std::string ply = io::read_file(folder.path / "a.ply"), end = "end_header\n";
  CHECK_CONTAINS(ply, "property int open_edges\nproperty double area\nend_header");
  const std::size_t faces = ply.find(end) + end.size() + 4 * 24, face = 13 + 4 + 8;
  REQUIRE(ply.size() == faces + 4 * face);
  std::int32_t edges = 0;
  double area = 0;
  std::memcpy(&edges, ply.data() + faces + 3 * face + 13, sizeof edges);
  std::memcpy(&area, ply.data() + faces + 3 * face + 17, sizeof area);
  CHECK(edges == 2);
  CHECK(area == 4);
  const auto fault = [&](const char* name, const DataArray& array) {
    return fixture::fault_of(
        [&] { write_surface(folder.path / name, surface.points, surface.triangles, {array}); });
  };
  CHECK_CONTAINS(fault("a.stl", data[0]), "holds no data of triangles: use .vtp");
  CHECK_CONTAINS(fault("b.ply", {"normal", Eigen::MatrixXd::Zero(3, 4)}), "several components");
  CHECK_CONTAINS(fault("b.vtu", {"few", Eigen::RowVector2d(0, 1)}), "one value per triangle");
}

TEST_CASE("a surface as VTP reads back bit for bit") {
  const fixture::Folder folder;
  const Triangulation surface = tetrahedron();
  const DataArray faults{"faults", Eigen::RowVector4d(0, 1, 0, 2), DataArray::Type::int32};
  write_surface(folder.path / "a.vtp", surface.points, surface.triangles, {faults});
  const Polygons read = read_vtp(folder.path / "a.vtp");
  REQUIRE(read.points.size() == 4);
  REQUIRE(read.corners.size() == 4);
  for (int i = 0; i < 4; ++i) {
    CHECK(read.points[i] == surface.points.col(i));
    REQUIRE(read.corners[i].size() == 3);
    for (int k = 0; k < 3; ++k) CHECK(read.corners[i][k] == surface.triangles(k, i));
  }
  CHECK_CONTAINS(fixture::fault_of([&] { read_vtp(fixture::data / "ascii.vtu"); }), "expected PolyData");
  const std::string whole = io::read_file(folder.path / "a.vtp");
  for (std::size_t size = 0; size + 40 < whole.size(); size += 7)
    CHECK(fixture::fault_of([&] { read_vtp(folder.write("cut.vtp", whole.substr(0, size))); }) != "no fault");
}

TEST_CASE("surfaces of unknown extension, with bad vertices or without a folder are refused") {
  const fixture::Folder folder;
  Triangulation surface = tetrahedron();
  const auto fault = [&](const std::filesystem::path& file) {
    return fixture::fault_of([&] { write_surface(file, surface.points, surface.triangles); });
  };
  CHECK_CONTAINS(fault(folder.path / "a.x3d"), "unknown extension '.x3d', expected .obj");
  CHECK_CONTAINS(fault(folder.path / "none" / "a.obj"), "cannot be written: No such file");
  surface.triangles(0, 2) = 4;
  CHECK_CONTAINS(fault(folder.path / "a.obj"), "triangle 2 names a vertex beyond 0 … 3");
  CHECK(folder.file_count() == 0);
}
