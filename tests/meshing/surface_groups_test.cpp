// Groups of a surface's triangles, and the faces of a mesh that belong to them.
#include "lobe_mesh/surface_groups.h"

#include <algorithm>

#include "lobe/mesh/generators.h"
#include "meshing/shapes.h"
#include "near.h"

using namespace lobe;
using namespace lobe::meshing;

namespace {

std::vector<std::string> names_of(const std::vector<NamedSurface>& groups) {
  std::vector<std::string> names;
  for (const NamedSurface& group : groups) names.push_back(group.name);
  return names;
}

// The sides of a cube of 0.1 m.
std::string grouped_cube(const std::string& first, const std::string& top, const std::string& rest) {
  return first +
         "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nv 0 0 0.1\nv 0.1 0 0.1\nv 0.1 0.1 0.1\nv 0 0.1 0.1\n"
         "f 1 4 3 2\n" +
         top + "f 5 6 7 8\n" + rest + "f 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
}

}  // namespace

TEST_CASE("an OBJ file has the groups of the first word that names several") {
  const SurfaceFolder folder;
  const auto read = [&](const std::string& text) { return read_groups(folder.write("a.obj", text)); };
  const auto groups = read(grouped_cube("g bottom\n", "g top lid\n", "g sides\n"));
  CHECK(names_of(groups) == std::vector<std::string>{"bottom", "top lid", "sides"});
  CHECK(groups[0].surface.triangle_count() == 2);
  CHECK(groups[2].surface.triangle_count() == 8);
  CHECK(names_of(read(grouped_cube("g all\no low\n", "o high\n", "o low\n"))) ==
        std::vector<std::string>{"low", "high"});
  CHECK(names_of(read(grouped_cube("g all\n", "usemtl red\n", "usemtl blue\n"))) ==
        std::vector<std::string>{"unnamed", "red", "blue"});
  const auto one = read(grouped_cube("g all\nusemtl red\n", "", ""));
  CHECK(names_of(one) == std::vector<std::string>{""});
  CHECK(one[0].surface.triangle_count() == 12);
}

TEST_CASE("the solids of an ascii STL file are groups") {
  const SurfaceFolder folder;
  const auto solid = [](const std::string& name, int z) {
    const std::string height = std::to_string(z);
    return "solid " + name + "\nfacet normal 0 0 0\nouter loop\nvertex 0 0 " + height + "\nvertex 1 0 " +
           height + "\nvertex 0 1 " + height + "\nendloop\nendfacet\nendsolid " + name + "\n";
  };
  CHECK(names_of(read_groups(folder.write("a.stl", solid("low part", 0) + solid("high", 1)))) ==
        std::vector<std::string>{"low part", "high"});
  CHECK(names_of(read_groups(folder.write("b.stl", solid("one", 0)))) == std::vector<std::string>{""});
}

TEST_CASE("each face of a mesh is in the group that is nearest, and nameless groups get none") {
  const SurfaceFolder folder;
  const TetMesh mesh = box_mesh({0.1, 0.1, 0.1}, 3, 3, 3);
  auto groups = read_groups(folder.write("a.obj", grouped_cube("g bottom\n", "g top\n", "g sides\n")));
  const auto faces = groups_of_faces(mesh, groups);
  REQUIRE(faces.size() == 3);
  CHECK(faces[0].name == "bottom");
  CHECK(faces[1].number == 2);
  CHECK(faces[0].triangles.size() == 18);
  CHECK(faces[1].triangles.size() == 18);
  CHECK(faces[2].triangles.size() == 72);
  for (const auto& triangle : faces[1].triangles)
    for (const Index v : triangle) CHECK(mesh.points(2, v) == test::near(0.1, 1e-12));
  groups[0].name.clear();
  const auto named = groups_of_faces(mesh, groups);
  REQUIRE(named.size() == 2);
  CHECK(named[0].name == "top");
  CHECK(named[0].number == 1);
}
