#include "io/fixture.h"
#include "lobe/io/raw_mesh.h"

using namespace lobe;

namespace {

MeshFile read_vtu(const std::string& text) { return io::read_vtu("v.vtu", text); }
std::string fault_in_vtu(const std::string& text) {
  return fixture::fault_of([&] { read_vtu(text); });
}
// The fault of a small file in which `old` became `now`.
std::string fault_in_vtu_with(const std::string& old, const std::string& now) {
  const std::string good =
      "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n"
      "<Piece NumberOfPoints=\"5\" NumberOfCells=\"2\">\n"
      "<PointData>\n<DataArray type=\"Float32\" Name=\"p\" NumberOfComponents=\"2\">1 2 3 4 5 6 7 8 9 "
      "10</DataArray>\n"
      "<DataArray type=\"String\" Name=\"s\">97 0</DataArray></PointData>\n"
      "<CellData><DataArray type=\"Int32\" Name=\"label\">3 4</DataArray></CellData>\n"
      "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n"
      "0 0 0 1 0 0 0 1 0 0 0 1 1 1 1</DataArray></Points>\n<Cells>\n"
      "<DataArray type=\"Int32\" Name=\"connectivity\">0 1 2 3 1 2 3 4</DataArray>\n"
      "<DataArray type=\"Int32\" Name=\"offsets\">4 8</DataArray>\n"
      "<DataArray type=\"UInt8\" Name=\"types\">10 10</DataArray>\n"
      "</Cells></Piece></UnstructuredGrid></VTKFile>\n";
  return fault_in_vtu(fixture::edited(good, old, now));
}

}  // namespace

TEST_CASE("VTU: point and cell data come with the mesh, cell data of tetrahedra only") {
  for (const char* file :
       {"raw_zlib_64.vtu", "raw_big_endian_32.vtu", "base64_64.vtu", "base64_zlib_big_endian_32.vtu",
        "inline_64.vtu", "inline_zlib_big_endian_32.vtu"}) {
    CAPTURE(file);
    const MeshFile read = read_mesh(fixture::data / file);
    REQUIRE(read.point_data.count("displacement") == 1);
    const Eigen::MatrixXd& u = read.point_data.at("displacement");
    CHECK(u.rows() == 3);
    CHECK(u.cols() == 12);
    CHECK(u(2, 11) == 35 * 0.1);
    CHECK(read.cell_data.empty());  // "label" became the labels
  }
}

TEST_CASE("VTU: labels are found under their other names, which stay cell data") {
  const std::string text =
      fixture::edited(fixture::bytes("ascii.vtu"), "Name=\"label\"", "Name=\"medit:ref\"");
  const MeshFile file = read_vtu(text);
  CHECK(file.mesh.labels == fixture::two_cubes().labels);
  CHECK(file.cell_data.at("medit:ref").cols() == 12);
}

TEST_CASE("VTU: bad files are refused, naming the line and the array") {
  CHECK(fault_in_vtu_with("3 4", "3 4") == "no fault");
  CHECK_CONTAINS(fault_in_vtu("solid x"), "v.vtu");
  CHECK_CONTAINS(fault_in_vtu_with("</Cells>", "</Sells>"), "v.vtu:14: is not XML");
  CHECK_CONTAINS(fault_in_vtu_with("type=\"UnstructuredGrid\"", "type=\"PolyData\""),
                 "v.vtu:1: VTKFile: type 'PolyData', expected UnstructuredGrid");
  CHECK_CONTAINS(fault_in_vtu_with("LittleEndian\"", "LittleEndian\" compressor=\"vtkLZ4DataCompressor\""),
                 "compressor 'vtkLZ4DataCompressor', expected vtkZLibDataCompressor");
  CHECK_CONTAINS(fault_in_vtu_with("LittleEndian\"", "LittleEndian\" header_type=\"Int\""),
                 "header_type 'Int'");
  CHECK_CONTAINS(fault_in_vtu_with("LittleEndian", "Middle"), "byte_order 'Middle'");
  CHECK_CONTAINS(fault_in_vtu_with("</Piece>", "</Piece><Piece/>"), "has several pieces");
  CHECK_CONTAINS(fault_in_vtu_with("NumberOfPoints=\"5\"", "NumberOfPoints=\"6\""),
                 "v.vtu:3: Piece: NumberOfPoints is '6', but 5 are in the file");
  CHECK_CONTAINS(fault_in_vtu_with("NumberOfCells=\"2\"", "NumberOfCells=\"99999999999\""),
                 "NumberOfCells is '99999999999'");
  CHECK_CONTAINS(fault_in_vtu_with("Name=\"offsets\"", "Name=\"off\""),
                 "v.vtu:10: Cells: has no DataArray 'offsets'");
  CHECK_CONTAINS(fault_in_vtu_with("0 1 2 3 1", "0 1 2 three 1"),
                 "v.vtu:11: 'three', expected a value of DataArray 'connectivity'");
  CHECK_CONTAINS(fault_in_vtu_with("0 1 2 3 1", "0 1 2 5 1"),
                 "v.vtu: cell 0: names vertex 5, expected 0 … 4");
  CHECK_CONTAINS(fault_in_vtu_with("0 1 2 3 1", "0 1 2 -3 1"), "names vertex -3");
  CHECK_CONTAINS(fault_in_vtu_with(">4 8<", ">4 9<"), "cell 1: its offset is 9, expected 4 … 8");
  CHECK_CONTAINS(fault_in_vtu_with(">4 8<", ">4 3<"), "cell 1: its offset is 3");
  CHECK_CONTAINS(fault_in_vtu_with(">10 10<", ">5 5<"), "has no tetrahedron, only 2 triangles");
  CHECK_CONTAINS(fault_in_vtu_with("1 1 1</", "1 1 nan</"), "vertex 4: its position is (1, 1, nan)");
  CHECK_CONTAINS(fault_in_vtu_with("1 1 1</", "1 0 0</"), "v.vtu: tetrahedron 1: is flat");
  CHECK_CONTAINS(fault_in_vtu_with("1 2 3 4</", "2 1 3 0</"), "has the same vertices");
  CHECK_CONTAINS(fault_in_vtu_with("1 1 1</", "1 1 1 1</"), "16 coordinates, expected three of each point");
  CHECK_CONTAINS(fault_in_vtu_with(">3 4<", ">3 4.5<"),
                 "v.vtu: label: cell 1: its label is 4.5, expected a whole number");
  CHECK_CONTAINS(fault_in_vtu_with(">3 4<", ">3 4 5<"),
                 "v.vtu:7: DataArray 'label': 3 numbers, expected 1 for each of 2");
  CHECK_CONTAINS(fault_in_vtu_with("Components=\"2\"", "Components=\"0\""),
                 "10 numbers, expected 0 for each of 5");
  CHECK_CONTAINS(fault_in_vtu_with("type=\"UInt8\"", "type=\"Float16\""), "type 'Float16', expected Int8 …");
  CHECK_CONTAINS(fault_in_vtu_with("format=\"ascii\"", "format=\"hex\""),
                 "format 'hex', expected ascii, binary or appended");
  CHECK_CONTAINS(fault_in_vtu_with("format=\"ascii\"", "format=\"appended\" offset=\"7\""),
                 "offset '7' is not within the 0 bytes of AppendedData");
  CHECK_CONTAINS(fault_in_vtu_with("format=\"ascii\"", "format=\"binary\""), "its data ends within");
}

TEST_CASE("VTU: labels under any name, ten-node tetrahedra, and the point data of what is left") {
  const MeshFile file = read_vtu(
      "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"10\" NumberOfCells=\"1\">"
      "<PointData><DataArray type=\"Float32\" Name=\"p\">10 11 12 13 14 15 16 17 18 "
      "19</DataArray></PointData>"
      "<CellData><DataArray type=\"Int64\" Name=\"RegionId\">42</DataArray>"
      "<DataArray type=\"Float64\" Name=\"density\">1000</DataArray></CellData>"
      "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">"
      ".5 0 0 .5 .5 0 0 .5 0 0 0 .5 .5 0 .5 0 .5 .5 0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points><Cells>"
      "<DataArray type=\"Int32\" Name=\"connectivity\">6 7 8 9 0 1 2 3 4 5</DataArray>"
      "<DataArray type=\"Int32\" Name=\"offsets\">10</DataArray>"
      "<DataArray type=\"UInt8\" Name=\"types\">24</DataArray>"
      "</Cells></Piece></UnstructuredGrid></VTKFile>");
  CHECK(file.mesh.labels == std::vector<int>{42});
  CHECK(file.mesh.tets == Tets(Eigen::Vector4i(0, 1, 2, 3)));
  CHECK(file.mesh.points.col(3) == Vec3d(0, 0, 1));
  CHECK(file.point_data.at("p") == Eigen::RowVector4d(16, 17, 18, 19));
  CHECK(file.cell_data.at("density")(0, 0) == 1000);
  CHECK(file.notes.size() == 2);
}

TEST_CASE("VTU: damaged compressed data is refused") {
  const std::string bytes = fixture::bytes("raw_zlib_64.vtu");
  std::string damaged = bytes;
  const std::size_t data = bytes.find('_', bytes.find("<AppendedData"));
  damaged[data + 1] = '\x7f';  // number of blocks
  CHECK_CONTAINS(fault_in_vtu(damaged), "v.vtu:");
  damaged = bytes;
  damaged[data + 1 + 8 + 6] = '\x7f';  // size of a block
  CHECK_CONTAINS(fault_in_vtu(damaged), "compressed bytes cannot hold");
}
