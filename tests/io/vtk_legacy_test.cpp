#include "folder.h"
#include "io/fixture.h"
#include "lobe/io/labelled_mesh.h"
#include "lobe/io/raw_mesh.h"

using namespace lobe;

namespace {

MeshFile read_legacy(const std::string& text) {
  return io::finish(io::read_vtk_legacy("v.vtk", text), "v.vtk");
}
std::string fault_in_legacy(const std::string& text) {
  return fixture::fault_of([&] { read_legacy(text); });
}

const std::string legacy_head = "# vtk DataFile Version 4.2\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\n";
const std::string points = "POINTS 5 float\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\n";
const std::string cells = "CELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 2\n10 10\n";

}  // namespace

TEST_CASE("legacy VTK: every kind of attribute is walked over on the way to the labels") {
  const MeshFile file = read_legacy(
      legacy_head + "FIELD FieldData 2\nTIME 1 1 double\n0.5\nnote 1 1 string\nby%20hand\n" + points +
      "METADATA\nINFORMATION 0\n\n" + cells +
      "POINT_DATA 5\nNORMALS n float\n1 1 1 1 1 1 1 1 1 1 1 1 1 1 1\n"
      "SCALARS s double 2\nLOOKUP_TABLE mine\n1 2 3 4 5 6 7 8 9 10\nLOOKUP_TABLE mine 1\n0 0 0 1\n"
      "TEXTURE_COORDINATES t 2 float\n1 2 3 4 5 6 7 8 9 10\nCOLOR_SCALARS c 1\n0 0 0 0 1\n"
      "CELL_DATA 2\nTENSORS t float\n1 2 3 4 5 6 7 8 9 1 2 3 4 5 6 7 8 9\nGLOBAL_IDS ids vtkIdType\n0 1\n"
      "FIELD FieldData 2\nCellEntityIds 1 2 int\n8 9\nMETADATA\nINFORMATION 0\n\nlabel 1 2 long\n-3 4\n");
  CHECK(file.mesh.labels == std::vector<int>{-3, 4});
}

TEST_CASE("legacy VTK: without labels they are 0") {
  CHECK(read_legacy(legacy_head + points + cells).mesh.labels == std::vector<int>{0, 0});
}

TEST_CASE("legacy VTK: labels are the only array of whole numbers, whatever its name, and that is said") {
  const std::string head = legacy_head + points + cells + "CELL_DATA 2\n";
  const std::string density = "SCALARS density double\nLOOKUP_TABLE default\n1000 1060\n";
  const std::string materials = "SCALARS Materials unsigned_char\nLOOKUP_TABLE default\n1 65\n";
  const std::string ids = "GLOBAL_IDS GlobalElementID vtkIdType\n7 8\n";
  const MeshFile file = read_legacy(head + density + ids + materials);
  CHECK(file.mesh.labels == std::vector<int>{1, 65});
  CHECK(file.warnings() ==
        std::vector<std::string>{"labels are those of the cell array \"Materials\" (1, 65)"});
  const MeshFile none = read_legacy(head + density + ids);
  CHECK(none.mesh.labels == std::vector<int>{0, 0});
  CHECK(none.warnings().empty());
}

TEST_CASE("legacy VTK: between several arrays of whole numbers it does not choose, but names them") {
  const std::string arrays = "CELL_DATA 2\nFIELD f 2\nModelRegionID 1 2 int\n1 2\nattribute 1 2 long\n5 5\n";
  const MeshFile file = read_legacy(legacy_head + points + cells + arrays);
  CHECK(file.mesh.labels == std::vector<int>{0, 0});
  REQUIRE(file.notes.size() == 1);
  CHECK_CONTAINS(file.notes[0],
                 "several cell arrays of whole numbers, \"ModelRegionID\" (1, 2), \"attribute\" (5)");
  const MeshFile known =
      read_legacy(legacy_head + points + cells + arrays + "SCALARS label int\nLOOKUP_TABLE d\n8 9\n");
  CHECK(known.mesh.labels == std::vector<int>{8, 9});
  CHECK(known.notes.empty());
}

TEST_CASE("legacy VTK: of several arrays of whole numbers the only one with a usual name is taken") {
  const std::string arrays = "CELL_DATA 2\nFIELD f 2\nitem 1 2 int\n3 4\nRegionID 1 2 int\n1 2\n";
  const MeshFile file = read_legacy(legacy_head + points + cells + arrays);
  CHECK(file.mesh.labels == std::vector<int>{1, 2});
  REQUIRE(file.notes.size() == 1);
  CHECK_CONTAINS(file.notes[0],
                 "labels are those of the cell array \"RegionID\" (1, 2), not those of \"item\" (3, 4)");
  const test::Folder folder;
  const auto with = [&](const std::string& name) {
    return read_labelled_mesh(folder.write("a.vtk", legacy_head + points + cells + arrays), name);
  };
  CHECK(with("item").mesh.labels == std::vector<int>{3, 4});
  CHECK(with("item").notes.empty());
  CHECK_CONTAINS(fixture::fault_of([&] { with("else"); }),
                 "has no cell array \"else\" of single numbers, but item, RegionID");
}

TEST_CASE("legacy VTK: whole numbers that are stored as floating-point ones are labels, where they can be") {
  const auto notes = [](const std::string& arrays) {
    const MeshFile file = read_legacy(legacy_head + points + cells + "CELL_DATA 2\nFIELD f 2\n" + arrays);
    return std::pair(file.mesh.labels, file.notes);
  };
  const std::string density = "density 1 2 double\n1000 1060\n", share = "share 1 2 float\n0.5 1\n";
  const auto [labels, said] = notes(density + "Materials 1 2 double\n2000 4\n");
  CHECK(labels == std::vector<int>{2000, 4});
  CHECK(said == std::vector<std::string>{"labels are those of the cell array \"Materials\" (4, 2000), whole "
                                         "numbers that are stored as floating-point ones"});
  CHECK(notes(share + "organ 1 2 float\n3 0\n").first == std::vector<int>{3, 0});
  CHECK(notes(share + "organ 1 2 float\n3 3\n").first == std::vector<int>{0, 0});  // tells nothing apart
  CHECK(notes(share + "part 1 2 float\n3 3\n").first == std::vector<int>{3, 3});   // but its name does
  CHECK(notes(density + share).first == std::vector<int>{0, 0});
  CHECK(notes("rank 1 2 int\n0 1\nRegionId 1 2 float\n5 6\n").first == std::vector<int>{5, 6});
  CHECK(notes("rank 1 2 int\n0 1\norgan 1 2 float\n5 6\n").first == std::vector<int>{0, 1});
  CHECK_CONTAINS(notes("a 1 2 float\n0 1\nb 1 2 float\n5 6\n").second.at(0),
                 "several cell arrays of whole numbers, \"a\" (0, 1), \"b\" (5, 6)");
}

TEST_CASE("legacy VTK: triangles with a label are the group of that number") {
  const std::string five =
      "CELLS 5 25\n4 0 1 2 3\n3 0 1 2\n4 1 2 3 4\n3 1 2 3\n6 0 1 2 0 0 0\n"
      "CELL_TYPES 5\n10 5 10 5 22\n";
  const MeshFile file = read_legacy(legacy_head + points + five +
                                    "CELL_DATA 5\nSCALARS RegionId int\nLOOKUP_TABLE default\n1 11 2 0 12\n");
  CHECK(file.mesh.labels == std::vector<int>{1, 2});
  CHECK(file.ignored_cells == 1);
  REQUIRE(file.surfaces.size() == 2);
  CHECK(file.surfaces[0].number == 11);
  CHECK(file.surfaces[0].triangles == std::vector<std::array<Index, 3>>{{0, 1, 2}});
  CHECK(file.surfaces[1].number == 12);
  CHECK(read_legacy(legacy_head + points + five).ignored_cells == 3);
  CHECK_CONTAINS(fault_in_legacy(legacy_head + points + fixture::edited(five, "3 0 1 2", "3 0 1 9") +
                                 "CELL_DATA 5\nSCALARS label int\nLOOKUP_TABLE default\n1 11 2 0 0\n"),
                 "cell 1: names vertex 9, expected 0 … 4");
}

TEST_CASE("legacy VTK: numbers that tell cells apart are no labels") {
  std::string text = legacy_head + "POINTS 104 float\n0 0 0 1 0 0 0 1 0 ", connectivity, types, ids, labels;
  for (int i = 0; i < 101; ++i) {
    text += "0 0 " + std::to_string(i + 1) + " ";
    connectivity += i == 0 ? "4 0 1 2 3\n" : "3 0 1 2\n";
    types += i == 0 ? "10 " : "5 ";
    ids += std::to_string(900 - i) + " ";
    labels += std::to_string(i % 2) + " ";
  }
  const MeshFile file = read_legacy(text + "\nCELLS 101 405\n" + connectivity + "CELL_TYPES 101\n" + types +
                                    "\nCELL_DATA 101\nFIELD f 2\nnumber 1 101 int\n" + ids +
                                    "\nhalf 1 101 int\n" + labels + "\n");
  CHECK(file.notes == std::vector<std::string>{"labels are those of the cell array \"half\" (0)"});
}

TEST_CASE("legacy VTK: of ten-node tetrahedra the corners are taken") {
  const std::string ten =
      "POINTS 11 float\n9 9 9 0 0 0 1 0 0 0 1 0 0 0 1 .5 0 0 .5 .5 0 0 .5 0 0 0 .5 .5 0 .5 0 .5 .5\n";
  const MeshFile file =
      read_legacy(legacy_head + ten + "CELLS 2 14\n10 1 2 3 4 5 6 7 8 9 10\n2 1 2\nCELL_TYPES 2\n24 3\n");
  CHECK(file.mesh.tets == Tets(Eigen::Vector4i(1, 2, 3, 4)));
  CHECK(file.mesh.vertex_count() == 5);  // the point of no cell stays
  CHECK(file.ignored_cells == 1);
  CHECK(file.notes ==
        std::vector<std::string>{"1 tetrahedron has ten nodes: the corners are taken, 6 vertices in "
                                 "the middle of edges are left out"});
  CHECK_CONTAINS(fault_in_legacy(legacy_head + ten + "CELLS 1 10\n9 1 2 3 4 5 6 7 8 9\nCELL_TYPES 1\n24\n"),
                 "cell 0: is a tetrahedron of 9 vertices, expected 10");
}

TEST_CASE("legacy VTK: bad files are refused at their line") {
  CHECK_CONTAINS(fault_in_legacy("solid x\n"), "v.vtk:1: expected '# vtk DataFile Version …'");
  CHECK_CONTAINS(fault_in_legacy("# vtk DataFile Version 7.0\n"), "unknown version, expected 2.0 … 5.1");
  CHECK_CONTAINS(fault_in_legacy("# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\n"),
                 "v.vtk:4: expected DATASET UNSTRUCTURED_GRID");
  CHECK_CONTAINS(fault_in_legacy(legacy_head), "has no CELLS");
  CHECK_CONTAINS(fault_in_legacy(legacy_head + points + "NONSENSE 3\n"),
                 "v.vtk:7: unknown keyword, expected POINTS");
  CHECK_CONTAINS(fault_in_legacy(legacy_head + "POINTS 6000000000000000000 float\n0"),
                 "6000000000000000000 points are announced");
  CHECK_CONTAINS(fault_in_legacy(legacy_head + "POINTS 1 quad\n0 0 0"),
                 "type 'quad' of points, expected float");
  CHECK_CONTAINS(fault_in_legacy(legacy_head + "POINTS 1 float\n0 0 x"),
                 "v.vtk:6: 'x', expected a value of points");
  CHECK_CONTAINS(fault_in_legacy(legacy_head + points + fixture::edited(cells, "4 1 2 3 4", "4 1 2 3 5")),
                 "v.vtk: cell 1: names vertex 5, expected 0 … 4");
  CHECK_CONTAINS(fault_in_legacy(legacy_head + points + fixture::edited(cells, "4 1 2 3 4", "4 1 2 3 -1")),
                 "names vertex -1");
  CHECK_CONTAINS(fault_in_legacy(legacy_head + points + fixture::edited(cells, "4 1 2 3 4", "5 1 2 3 4")),
                 "the vertices of cell 1 go beyond the 10 numbers");
  CHECK_CONTAINS(fault_in_legacy(legacy_head + points + fixture::edited(cells, "4 0 1 2 3", "3 0 1 2 4")),
                 "cell 0: is a tetrahedron of 3 vertices, expected 4");
  CHECK_CONTAINS(
      fault_in_legacy(legacy_head + points + fixture::edited(cells, "TYPES 2\n10 10", "TYPES 1\n10")),
      "1 cell types for 2 cells");
  CHECK_CONTAINS(fault_in_legacy(legacy_head + points + fixture::edited(cells, "10 10\n", "12 13\n")),
                 "has no tetrahedron, only 1 hexahedron and 1 wedge; a surface is meshed");
  CHECK_CONTAINS(fault_in_legacy(legacy_head + fixture::edited(points, "1 1 1\n", "1 nan 1\n") + cells),
                 "vertex 4: its position is (1, nan, 1)");
  CHECK_CONTAINS(fault_in_legacy(legacy_head + fixture::edited(points, "1 1 1\n", "1 0 0\n") + cells),
                 "tetrahedron 1: is flat");
  CHECK_CONTAINS(fault_in_legacy(legacy_head + points + cells + "CELL_DATA 3\n"),
                 "data of another number of cells, expected 2");
  CHECK_CONTAINS(fault_in_legacy(legacy_head + points + cells +
                                 "CELL_DATA 2\nSCALARS label int\nLOOKUP_TABLE default\n1.5 2"),
                 "v.vtk: label: cell 0: its label is 1.5");
  CHECK_CONTAINS(fault_in_legacy(legacy_head + points + cells +
                                 "CELL_DATA 2\nFIELD f 1\nx 9000000000000000000 9000000000000000000 int\n"),
                 "are announced");
}

TEST_CASE("legacy VTK: an inside-out tetrahedron is turned round, an unused point kept") {
  const MeshFile file = read_legacy(legacy_head + points + "CELLS 1 5\n4 0 2 1 3\nCELL_TYPES 1\n10\n");
  CHECK(file.prepared.reoriented == 1);
  CHECK(file.prepared.unreferenced == 1);
  CHECK(file.mesh.vertex_count() == 5);
}

TEST_CASE("legacy VTK: binary strings and bits are walked over") {
  const std::string bytes = fixture::bytes("legacy42_binary.vtk");
  const std::string extra = std::string("FIELD FieldData 2\nnote 1 2 string\n") + '\xc2' + "ab" + '\x80' +
                            '\x01' + "c\nbits 1 9 bit\n" + "ab" + "\n";
  const std::size_t at = bytes.find("POINTS");
  CHECK(read_legacy(bytes.substr(0, at) + extra + bytes.substr(at)).mesh.tet_count() == 12);
}
