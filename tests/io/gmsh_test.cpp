#include "io/fixture.h"
#include "lobe/io/raw_mesh.h"
#include "near.h"

using namespace lobe;
using test::near;

namespace {

MeshFile read_gmsh(const std::string& text) { return io::finish(io::read_gmsh("g.msh", text), "g.msh"); }
std::string fault_in_gmsh(const std::string& text) {
  return fixture::fault_of([&] { read_gmsh(text); });
}

const std::string format22 = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
const std::string nodes22 = "$Nodes\n4\n10 0 0 0\n7 1 0 0\n3000000000 0 1 0\n2 0 0 1\n$EndNodes\n";
const std::string tet22 = "$Elements\n1\n1 4 2 5 9 10 7 3000000000 2\n$EndElements\n";

const std::string nodes1 = "$NOD\n5\n10 0 0 0\n7 1 0 0\n4 0 1 0\n2 0 0 1\n8 1 1 1.5\n$ENDNOD\n";

const std::string format41 = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
const std::string entities41 =
    "$Entities\n1 1 1 2\n1 0 0 0 1 99\n1 0 0 0 1 1 1 0 2 1 -1\n1 0 0 0 1 1 1 1 98 1 1\n"
    "4 0 0 0 1 1 1 2 -6 8 1 1\n5 0 0 0 1 1 1 0 0\n$EndEntities\n";
const std::string nodes41 =
    "$Nodes\n2 5 1 50\n1 1 1 1\n50\n0 0 0 0.5\n3 4 0 4\n1\n2\n3\n4\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n$EndNodes\n";
const std::string tets41 = "$Elements\n2 2 1 2\n3 4 4 1\n1 50 1 2 3\n3 5 4 1\n2 1 2 3 4\n$EndElements\n";

}  // namespace

TEST_CASE("Gmsh 2.2: node numbers with gaps, comments and other sections") {
  const MeshFile file = read_gmsh(format22 + "$Comments\nmade $Nodes\n by hand\n$EndComments\n" +
                                  "$PhysicalNames\n1\n3 5 \"liver\"\n$EndPhysicalNames\n" + nodes22 + tet22 +
                                  "$NodeData\n1\n\"T\"\n$EndNodeData\n");
  CHECK(file.mesh.tets == Tets(Eigen::Vector4i(0, 1, 2, 3)));
  CHECK(file.mesh.points.col(1) == Vec3d(1, 0, 0));
  CHECK(file.mesh.labels == std::vector<int>{5});
}

TEST_CASE("Gmsh 2.2: elements may come before the nodes' order and without tags") {
  const MeshFile file =
      read_gmsh(format22 + nodes22 + "$Elements\n2\n1 15 0 10\n2 4 0 7 10 3000000000 2\n$EndElements");
  CHECK(file.ignored_cells == 1);
  CHECK(file.mesh.labels == std::vector<int>{0});
  CHECK(file.prepared.reoriented == 1);
}

TEST_CASE("Gmsh 4.1: the label is the first physical group of the volume, parametric nodes are read") {
  const MeshFile file = read_gmsh(format41 + entities41 + nodes41 + tets41);
  CHECK(file.mesh.labels == std::vector<int>{6, 0});
  CHECK(file.mesh.points.col(4) == Vec3d(1, 1, 1));
  CHECK(file.mesh.tets.col(0) == Eigen::Vector4i(0, 1, 2, 3));
}

TEST_CASE("Gmsh 2.2: of a tetrahedron in two groups one is kept, with the first label") {
  const MeshFile file = read_gmsh(format22 + nodes22 +
                                  "$Elements\n3\n1 4 2 5 9 10 7 3000000000 2\n2 4 2 6 9 7 10 3000000000 2\n"
                                  "3 4 2 5 9 2 3000000000 7 10\n$EndElements\n");
  CHECK(file.mesh.tets == Tets(Eigen::Vector4i(0, 1, 2, 3)));
  CHECK(file.mesh.labels == std::vector<int>{5});
  REQUIRE(file.warnings().size() == 1);
  CHECK(file.warnings()[0] ==
        "2 of 3 tetrahedra are copies of others, as of volumes in several groups: the first of each is kept, "
        "with its label");
}

TEST_CASE("Gmsh: binary files of the other byte order are read") {
  std::string text = "$MeshFormat\n2.2 1 8\n";
  const auto put = [&](auto value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    for (std::size_t k = sizeof value; k-- > 0;) text += raw[k];
  };
  put(1);
  text += "\n$EndMeshFormat\n$Nodes\n4\n";
  const double corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int i = 0; i < 4; ++i) {
    put(i + 1);
    for (const double x : corners[i]) put(x);
  }
  text += "\n$EndNodes\n$Elements\n1\n";
  for (const int n : {4, 1, 2, 1, 33, 0, 1, 2, 3, 4}) put(n);
  text += "\n$EndElements\n";
  CHECK(read_gmsh(text).mesh.labels == std::vector<int>{33});
  CHECK(read_gmsh(text).mesh.points.col(3) == Vec3d(0, 0, 1));
}

TEST_CASE("Gmsh 1: node numbers with gaps, regions as labels, elements of other types") {
  const MeshFile file = read_gmsh(nodes1 + "$ELM\n4\n1 15 9 1 1 10\n2 2 9 1 3 10 7 4\n3 4 5 1 4 10 7 4 2\n" +
                                  "9 4 6 2 4 7 4 2 8\n$ENDELM\n");
  CHECK(file.mesh.points.cols() == 5);
  CHECK(file.mesh.points.col(1) == Vec3d(1, 0, 0));
  CHECK(file.mesh.points.col(4) == Vec3d(1, 1, 1.5));
  CHECK(file.mesh.tets.col(0) == Eigen::Vector4i(0, 1, 2, 3));
  CHECK(file.mesh.tets.col(1) == Eigen::Vector4i(1, 2, 3, 4));
  CHECK(file.mesh.labels == std::vector<int>{5, 6});
  CHECK(file.ignored_cells == 1);
  REQUIRE(file.surfaces.size() == 1);
  CHECK(file.surfaces[0].number == 9);
  CHECK(file.surfaces[0].triangles == std::vector<std::array<Index, 3>>{{0, 1, 2}});
  CHECK(total_volume(file.mesh) == near(1.0 / 6 + 2.5 / 6, 1e-15));
}

TEST_CASE("Gmsh: without groups labels are the numbers of the volumes, if there are several") {
  const std::string note = "no tetrahedron is in a physical group: labels are the numbers of the volumes";
  const MeshFile one = read_gmsh(nodes1 + "$ELM\n2\n1 4 0 1 4 10 7 4 2\n2 4 0 2 4 7 4 2 8\n$ENDELM\n");
  CHECK(one.mesh.labels == std::vector<int>{1, 2});
  CHECK(one.notes == std::vector<std::string>{note});
  const std::string nodes2 =
      format22 + "$Nodes\n5\n10 0 0 0\n7 1 0 0\n4 0 1 0\n2 0 0 1\n8 1 1 1.5\n$EndNodes\n";
  const std::string elements2 =
      "$Elements\n3\n1 2 2 11 1 10 7 4\n2 4 2 0 6 10 7 4 2\n3 4 2 0 9 7 4 2 8\n$EndElements\n";
  CHECK(read_gmsh(nodes2 + elements2).mesh.labels == std::vector<int>{6, 9});
  CHECK(read_gmsh(nodes2 + fixture::edited(elements2, "2 0 9", "2 0 6")).mesh.labels ==
        std::vector<int>{0, 0});
  const MeshFile grouped = read_gmsh(nodes2 + fixture::edited(elements2, "2 0 9", "2 3 9"));
  CHECK(grouped.mesh.labels == std::vector<int>{0, 3});
  CHECK(grouped.notes.empty());
  const std::string entities = fixture::edited(entities41, "1 1 1 2 -6 8 1 1", "1 1 1 0 0");
  CHECK(read_gmsh(format41 + entities + nodes41 + tets41).mesh.labels == std::vector<int>{4, 5});
}

TEST_CASE("Gmsh: physical surfaces are groups of triangles, names are those of their dimension") {
  const std::string names =
      "$PhysicalNames\n4\n2 2 \"left side\"\n3 2 \"liver\"\n2 6 \"unused\"\n1 2 "
      "\"edge\"\n$EndPhysicalNames\n";
  const MeshFile two = read_gmsh(format22 + names + nodes22 +
                                 "$Elements\n5\n1 4 2 2 9 10 7 3000000000 2\n2 2 2 2 1 10 7 2\n"
                                 "3 2 2 4 1 10 7 2\n4 2 2 2 1 7 10 3000000000\n5 2 2 0 3 7 2 3000000000\n"
                                 "$EndElements\n");
  REQUIRE(two.surfaces.size() == 2);
  CHECK(two.surfaces[0].number == 2);
  CHECK(two.surfaces[0].name == "left side");
  CHECK(two.surfaces[0].triangles == std::vector<std::array<Index, 3>>{{0, 1, 3}, {1, 0, 2}});
  CHECK(two.surfaces[1].number == 4);
  CHECK(two.surfaces[1].name == "");
  CHECK(two.label_names == std::map<int, std::string>{{2, "liver"}});
  CHECK(two.ignored_cells == 1);  // of no group
  const MeshFile four = read_gmsh(
      format41 + fixture::edited(entities41, "1 0 0 0 1 1 1 1 98 1 1", "1 0 0 0 1 1 1 2 98 -2 0") + names +
      nodes41 + "$Elements\n2 2 1 2\n3 4 4 1\n1 50 1 2 3\n2 1 2 1\n2 1 2 3\n$EndElements\n");
  REQUIRE(four.surfaces.size() == 2);
  CHECK(four.surfaces[0].name == "left side");
  CHECK(four.surfaces[1].number == 98);
  for (const SurfaceGroup& surface : four.surfaces)
    CHECK(surface.triangles == std::vector<std::array<Index, 3>>{{1, 2, 3}});
  CHECK_CONTAINS(
      fault_in_gmsh(format22 + "$PhysicalNames\n1\n3 5 liver\n$EndPhysicalNames\n" + nodes22 + tet22),
      "expected the name of a group in quotes");
}

TEST_CASE("Gmsh: of ten-node tetrahedra the corners are taken") {
  const std::string nodes =
      "$Nodes\n10\n1 .5 0 0\n2 .5 .5 0\n3 0 .5 0\n4 0 0 .5\n5 0 .5 .5\n6 .5 0 .5\n"
      "7 0 0 0\n8 1 0 0\n9 0 1 0\n10 0 0 1\n$EndNodes\n";
  const MeshFile file = read_gmsh(format22 + nodes +
                                  "$Elements\n2\n1 11 2 5 9 7 8 9 10 1 2 3 4 5 6\n"
                                  "2 9 2 1 1 7 8 9 1 2 3\n$EndElements\n");
  CHECK(file.mesh.points.cols() == 4);
  CHECK(file.mesh.points.col(1) == Vec3d(1, 0, 0));
  CHECK(file.mesh.labels == std::vector<int>{5});
  CHECK(file.ignored_cells == 0);
  REQUIRE(file.surfaces.size() == 1);
  CHECK(file.surfaces[0].triangles == std::vector<std::array<Index, 3>>{{0, 1, 2}});
  CHECK(total_volume(file.mesh) == near(1.0 / 6, 1e-15));
}

TEST_CASE("Gmsh 1: the sections may be in lines of Windows and end in any case") {
  std::string text = nodes1 + "$ELM\n1\n1 4 0 0 4 10 7 4 2\n$EndElm\n";
  for (std::size_t at = 0; (at = text.find('\n', at)) != text.npos; at += 2) text.replace(at, 1, "\r\n");
  CHECK(read_gmsh(text).mesh.tets == Tets(Eigen::Vector4i(0, 1, 2, 3)));
}

TEST_CASE("Gmsh 1: bad files are refused at their line") {
  const std::string tet = "$ELM\n1\n3 4 5 1 4 10 7 4 2\n$ENDELM\n";
  REQUIRE(read_gmsh(nodes1 + tet).mesh.tet_count() == 1);
  CHECK_CONTAINS(fault_in_gmsh(tet), "element 3 uses node 10, which $NOD does not have");
  CHECK_CONTAINS(fault_in_gmsh(nodes1), "has no tetrahedron");
  CHECK_CONTAINS(fault_in_gmsh("$ELM\n0\n$ENDELM\n"), "has no $NOD section");
  CHECK_CONTAINS(fault_in_gmsh(nodes1 + "$ELM\n1\n3 4 5 1 3 10 7 4\n$ENDELM"),
                 "g.msh:11: element 3 has 3 nodes, expected 4 of type 4");
  CHECK_CONTAINS(fault_in_gmsh(nodes1 + "$ELM\n1\n3 4 5 1 4 10 7 4 11\n$ENDELM"),
                 "g.msh:11: element 3 uses node 11, which $NOD does not have");
  CHECK_CONTAINS(fault_in_gmsh(nodes1 + "$ELM\n1\n3 99 5 1 4 10 7 4 2\n$ENDELM"), "unknown element type 99");
  CHECK_CONTAINS(fault_in_gmsh(nodes1 + "$ELM\n2\n3 4 5 1 4 10 7 4 2\n$ENDELM"),
                 "g.msh:12: '$ENDELM', expected an element");
  CHECK_CONTAINS(fault_in_gmsh(nodes1 + "$ELM\n1\n3 4 5 1 4 10 7 4 2\n4 4 5 1 4 10 7 4 2\n$ENDELM"),
                 "g.msh:12: '4', expected $ENDELM");
  CHECK_CONTAINS(fault_in_gmsh(nodes1 + "$ELM\n400\n3 4 5 1 4 10 7 4 2\n$ENDELM"),
                 "g.msh:10: 400 elements are announced");
  CHECK_CONTAINS(fault_in_gmsh(nodes1 + "$ELM\n1\n3 4 5 1 4 10 7"),
                 "g.msh:11: the file ends where a node of an element is expected");
  CHECK_CONTAINS(fault_in_gmsh(nodes1 + "$ELM\n1\n3 4 9999999999 1 4 10 7 4 2\n$ENDELM"),
                 "physical group 9999999999");
  CHECK_CONTAINS(fault_in_gmsh("$NOD\n2\n1 0 0 0\n1 1 0 0\n$ENDNOD"), "g.msh:4: node 1 is given twice");
  CHECK_CONTAINS(fault_in_gmsh("$NOD\n1\n1 0 0 zero\n$ENDNOD"), "g.msh:3: 'zero'");
  CHECK_CONTAINS(fault_in_gmsh(nodes1 + format22), "$MeshFormat after a section of Gmsh 1");
}

TEST_CASE("Gmsh: bad files are refused at their line") {
  CHECK_CONTAINS(fault_in_gmsh("solid"), "g.msh:1: expected a section, such as $Nodes");
  CHECK_CONTAINS(fault_in_gmsh("$Nodes\n"), "expected $MeshFormat before any other section");
  CHECK_CONTAINS(fault_in_gmsh("$MeshFormat\n4.0 0 8\n$EndMeshFormat"),
                 "Gmsh format 4.0, expected 1, 2.2 or 4.1; convert it");
  CHECK_CONTAINS(fault_in_gmsh(format22), "has no $Nodes section");
  CHECK_CONTAINS(fault_in_gmsh(format22 + nodes22), "has no tetrahedron");
  CHECK_CONTAINS(fault_in_gmsh(format22 + "$Nodes\n3\n1 0 0 0\n1 1 0 0\n2 0 1 0\n"),
                 "g.msh:7: node 1 is given twice");
  CHECK_CONTAINS(fault_in_gmsh(format22 + "$Nodes\n400000\n1 0 0 0\n"),
                 "g.msh:5: 400000 nodes are announced");
  CHECK_CONTAINS(fault_in_gmsh(format22 + "$Nodes\n1\n1 0 0 0\n2 0 0 0\n$EndNodes"),
                 "'2', expected $EndNodes");
  CHECK_CONTAINS(fault_in_gmsh(format22 + nodes22 + "$Elements\n1\n7 4 2 5 9 10 7 11 2\n"),
                 "element 7 uses node 11, which $Nodes does not have");
  CHECK_CONTAINS(fault_in_gmsh(format22 + nodes22 + "$Elements\n1\n1 4 1 9999999999 10 7 2 2\n"),
                 "physical group 9999999999");
  CHECK_CONTAINS(fault_in_gmsh(format22 + nodes22 + "$Elements\n1\n1 777 0 10 7 2 2\n"),
                 "unknown element type 777");
  CHECK_CONTAINS(fault_in_gmsh(format22 + nodes22 + "$Elements\n1\n1 2 0 10 7 2\n$EndElements"),
                 "has no tetrahedron, only 1 triangle");
  CHECK_CONTAINS(fault_in_gmsh(format22 + nodes22 + "$Elements\n1\n1 4 0 10 7 7 2\n$EndElements"),
                 "uses a vertex twice");
  CHECK_CONTAINS(fault_in_gmsh(format22 + fixture::edited(nodes22, "7 1 0 0", "7 inf 0 0") + tet22),
                 "vertex 1: its position is (inf, 0, 0)");
  CHECK_CONTAINS(fault_in_gmsh(format22 + fixture::edited(nodes22, "2 0 0 1", "2 1 1 0") + tet22), "is flat");
  CHECK_CONTAINS(fault_in_gmsh(format22 + "$Periodic\n1\n"), "expected $EndPeriodic");
  CHECK_CONTAINS(fault_in_gmsh(format41 + "$PartitionedEntities\n1\n"), "save it in one piece");
  CHECK_CONTAINS(fault_in_gmsh(format41 + nodes41 + fixture::edited(tets41, "4 1\n1 50", "4 -1\n1 50")),
                 "a negative number of elements");
}

TEST_CASE("Gmsh: binary faults name the byte") {
  const std::string bytes = fixture::bytes("gmsh41_binary.msh");
  CHECK_CONTAINS(fault_in_gmsh(bytes.substr(0, bytes.size() / 2)), "g.msh: byte ");
}
