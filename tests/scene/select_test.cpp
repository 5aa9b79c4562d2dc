// Counts on a box of cells that are each split into six tetrahedra (Kuhn): 4 × 2 × 2 cells of edge 1.
#include "lobe/scene/select.h"

#include <doctest/doctest.h>

#include "lobe/error.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/bind_groups.h"
#include "lobe/scene/each_selector.h"
#include "lobe/scene/prolongated.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/write_scene.h"

using namespace lobe;

namespace {

const TetMesh mesh = [] {
  TetMesh box = box_mesh({4, 2, 2}, 4, 2, 2);
  for (Index t = 0; t < box.tet_count(); ++t) box.labels[static_cast<std::size_t>(t)] = t < 12 ? 1 : 0;
  return box;
}();

Selector plane(const Vec3d& point, const Vec3d& normal, SelectPlane::Side side, double within = 0) {
  return {SelectPlane{point, normal, side, within}};
}
Selector negation(const Selector& part) { return {SelectNot{{part}}}; }

std::size_t vertices(const Selector& selector) { return select_vertices(selector, mesh).size(); }
std::size_t tets(const Selector& selector) { return select_tets(selector, mesh).size(); }
std::size_t faces(const Selector& selector) { return select_faces(selector, mesh, outer_faces(mesh)).size(); }

using Side = SelectPlane::Side;
const Selector everything = {SelectAll{}};

}  // namespace

TEST_CASE("the outer faces of a box are two triangles per square") {
  CHECK(outer_faces(mesh).size() == 2 * (2 * 2 * 2 + 4 * (4 * 2)));
  for (const TetFace& face : outer_faces(mesh)) {
    Vec3d centre = Vec3d::Zero();
    for (const int corner : face_corners[face.face])
      centre += mesh.points.col(mesh.tets(corner, face.tet)) / 3;
    const bool outside =
        centre.minCoeff() < 1e-12 || centre[0] > 4 - 1e-12 || centre.tail<2>().maxCoeff() > 2 - 1e-12;
    CHECK(outside);
  }
}

TEST_CASE("all selects everything, not all nothing") {
  CHECK(vertices(everything) == 45);
  CHECK(tets(everything) == 96);
  CHECK(faces(everything) == 80);
  CHECK(vertices(negation(everything)) == 0);
  CHECK(tets(negation(everything)) == 0);
  CHECK(faces(negation(everything)) == 0);
}

TEST_CASE("a box takes vertices on its faces, and tetrahedra by barycentre") {
  const Selector first_cells = {SelectBox{{0, 0, 0}, {1, 2, 2}}};
  CHECK(vertices(first_cells) == 18);
  CHECK(tets(first_cells) == 24);
  CHECK(faces(first_cells) == 8 + 4 * 4);
  CHECK(vertices({SelectBox{{0.1, 0.1, 0.1}, {0.9, 0.9, 0.9}}}) == 0);
}

TEST_CASE("a sphere takes what is within its radius, its surface included") {
  CHECK(vertices({SelectSphere{{0, 0, 0}, 1}}) == 4);
  CHECK(vertices({SelectSphere{{0, 0, 0}, 0.999}}) == 1);
  CHECK(vertices({SelectSphere{{2, 1, 1}, 1}}) == 7);
  CHECK(tets({SelectSphere{{2, 1, 1}, 10}}) == 96);
}

TEST_CASE("a plane takes a distance or a side, its length of normal apart") {
  CHECK(vertices(plane({4, 0, 0}, {1, 0, 0}, Side::within, 1e-9)) == 9);
  CHECK(faces(plane({4, 0, 0}, {1, 0, 0}, Side::within, 1e-9)) == 8);
  CHECK(vertices(plane({4, 0, 0}, {5, 0, 0}, Side::within, 1)) == 18);
  CHECK(vertices(plane({1, 0, 0}, {-3, 0, 0}, Side::above)) == 18);
  CHECK(vertices(plane({1, 0, 0}, {-3, 0, 0}, Side::below)) == 36);
  CHECK(tets(plane({1, 0, 0}, {1, 0, 0}, Side::below)) == 24);
  CHECK(tets(plane({1, 0, 0}, {1, 0, 0}, Side::above)) == 72);
}

TEST_CASE("nearest takes exactly as many as asked, and all if there are fewer") {
  CHECK(select_vertices({SelectNearest{{0.1, 0, 0}, 2}}, mesh) == std::vector<Index>{0, 1});
  CHECK(tets({SelectNearest{{0, 0, 0}, 7}}) == 7);
  CHECK(vertices({SelectNearest{{0, 0, 0}, 1000}}) == 45);
}

TEST_CASE("labels, vertices and tetrahedra select each other") {
  CHECK(tets({SelectLabel{{1}}}) == 12);
  CHECK(tets({SelectLabel{{0, 1}}}) == 96);
  CHECK(tets({SelectLabel{{7}}}) == 0);
  CHECK(vertices({SelectLabel{{1}}}) == 12);  // of the cells (0,0,0) and (1,0,0)
  CHECK(select_tets({SelectTetrahedra{{95, 3, 3}}}, mesh) == std::vector<Index>{3, 95});
  CHECK(vertices({SelectTetrahedra{{3}}}) == 4);
  CHECK(select_vertices({SelectVertices{{7, 2}}}, mesh) == std::vector<Index>{2, 7});
  const std::vector<Index> corners(mesh.tets.col(5).begin(), mesh.tets.col(5).end());
  CHECK(select_tets({SelectVertices{corners}}, mesh) == std::vector<Index>{5});
}

TEST_CASE("any_of, all_of and not are union, intersection and complement") {
  const Selector left = {SelectBox{{0, 0, 0}, {1, 2, 2}}}, label = {SelectLabel{{1}}};
  CHECK(tets({SelectAnyOf{{left, label}}}) == 30);
  CHECK(tets({SelectAllOf{{left, label}}}) == 6);
  CHECK(tets({SelectAllOf{{left, negation(label)}}}) == 18);
  CHECK(tets(negation({SelectAnyOf{{left, label}}})) == 66);
}

TEST_CASE("a vertex of no tetrahedron is never selected") {
  TetMesh loose = mesh;
  loose.points.conservativeResize(3, 46);
  loose.points.col(45) = Vec3d(0, 0, 0);
  CHECK(select_vertices(everything, loose).size() == 45);
  CHECK(select_vertices({SelectNearest{{0, 0, 0}, 1}}, loose) == std::vector<Index>{0});
  CHECK(select_vertices({SelectVertices{{45}}}, loose).empty());
}

TEST_CASE("an index beyond the mesh is named") {
  CHECK_THROWS_WITH_AS(select_vertices({SelectVertices{{0, 45}}}, mesh, "/boundary/0/where"),
                       "/boundary/0/where/vertices/1: 45, must be from 0 to 44: the mesh has 45 vertices",
                       InputError);
  const Selector nested = {SelectAnyOf{{everything, negation({SelectTetrahedra{{-1}}})}}};
  CHECK_THROWS_WITH_AS(
      select_tets(nested, mesh, "/regions/0/where"),
      "/regions/0/where/any_of/1/not/tetrahedra/0: -1, must be from 0 to 95: the mesh has 96 "
      "tetrahedra",
      InputError);
}

namespace {

// The faces of the box at x = 0, and one of them again.
MeshFile with_groups() {
  MeshFile file;
  file.mesh = mesh;
  SurfaceGroup left{4, "left", {}};
  for (const TetFace& face : outer_faces(mesh)) {
    const int* c = face_corners[face.face];
    const std::array<Index, 3> v{mesh.tets(c[1], face.tet), mesh.tets(c[0], face.tet),
                                 mesh.tets(c[2], face.tet)};
    if (mesh.points(0, v[0]) + mesh.points(0, v[1]) + mesh.points(0, v[2]) == 0) left.triangles.push_back(v);
  }
  file.surfaces = {left, {5, "", {left.triangles[0]}}};
  file.label_names[1] = "stiff";
  return file;
}

Scene selecting(const std::string& selector) {
  return parse_scene(R"({"mesh": "m.msh", "materials": [{"lame_lambda": 1, "lame_mu": 1}],
    "boundary": [{"traction": [1, 0, 0], "where": )" +
                         selector + "}]}",
                     "s.json");
}

Selector bound(const std::string& selector) {
  Scene scene = selecting(selector);
  bind_groups(with_groups(), scene);
  return scene.boundary[0].where;
}

std::string fault_in_binding(const std::string& selector) {
  try {
    bound(selector);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a surface selects its own faces, their vertices, and the tetrahedra that have them") {
  CHECK(faces(bound(R"({"surface": "left"})")) == 8);
  CHECK(vertices(bound(R"({"surface": 4})")) == 9);
  CHECK(tets(bound(R"({"surface": "left"})")) == 8);
  CHECK(faces(bound(R"({"surface": 5})")) == 1);
  CHECK(faces(bound(R"({"surface": ["left", 5]})")) == 8);
  CHECK(faces(bound(R"({"not": {"surface": "5"}})")) == 79);  // but not by their three vertices
  CHECK(faces(bound(R"({"all_of": [{"surface": "left"}, {"not": {"surface": 5}}]})")) == 7);
  CHECK(
      faces(bound(
          R"({"any_of": [{"surface": 5}, {"plane": {"point": [4, 0, 0], "normal": [1, 0, 0], "within": 0}}]})")) ==
      9);
  CHECK(tets(bound(R"({"label": "stiff"})")) == 12);
  CHECK(tets(bound(R"({"label": [0, "stiff"]})")) == 96);
}

TEST_CASE("names of surfaces and labels that the file does not have are refused, with those that it has") {
  CHECK(fault_in_binding(R"({"surface": "lefd"})") ==
        "/boundary/0/where/surface: the mesh's file names no surface \"lefd\"; it names \"left\", \"5\"; did "
        "you mean \"left\"?");
  CHECK(fault_in_binding(R"({"any_of": [{"all": true}, {"label": "soft"}]})") ==
        "/boundary/0/where/any_of/1/label: the mesh's file names no label \"soft\"; it names \"stiff\"");
  const Scene unbound = selecting(R"({"surface": "left"})");
  CHECK_THROWS_WITH_AS(select_faces(unbound.boundary[0].where, mesh, outer_faces(mesh), "/w"),
                       "/w/surface: surfaces are known only where the mesh is read from a file", InputError);
  const Scene kept = parse_scene(
      to_json(selecting(R"({"any_of": [{"surface": [4, "left"]}, {"label": ["stiff", 2]}]})")), "s");
  const auto& parts = std::get<SelectAnyOf>(kept.boundary[0].where.value).parts;
  CHECK(std::get<SelectSurface>(parts[0].value).names == std::vector<std::string>{"4", "left"});
  CHECK(std::get<SelectLabel>(parts[1].value).names == std::vector<std::string>{"stiff"});
  CHECK(std::get<SelectLabel>(parts[1].value).labels == std::vector<int>{2});
}

TEST_CASE("a patch is the part of the boundary that turns little from the face nearest to a point") {
  const Selector end = {SelectPatch{{4.5, 1, 1}, 40}}, all = {SelectPatch{{4.5, 1, 1}, 90}};
  CHECK(faces(end) == 2 * 2 * 2);
  CHECK(vertices(end) == 3 * 3);
  CHECK(faces(all) == outer_faces(mesh).size());
  CHECK(faces({SelectAnyOf{{end, {SelectPatch{{2, -1, 1}, 40}}}}}) == 2 * 2 * 2 + 2 * 4 * 2);
  CHECK(faces({SelectAllOf{{end, {SelectBox{{4, 0, 0}, {4, 1, 2}}}}}}) == 2 * 2);
  CHECK(tets(end) == 2 * 2 * 2);
}

TEST_CASE("a scene selects by number if a part of any selector counts vertices or tetrahedra") {
  const auto holding = [](const Selector& where) {
    Scene scene;
    scene.boundary.emplace_back();
    scene.boundary[0].where = where;
    return scene;
  };
  const Selector box = {SelectBox{{0, 0, 0}, {1, 1, 1}}};
  const auto beside_box = [&](const Selector& part) {
    return Selector{SelectAnyOf{{box, {SelectAllOf{{box, negation(part)}}}}}};
  };
  CHECK_FALSE(selects_by_number(holding(beside_box(everything))));
  CHECK_FALSE(selects_by_number(holding(beside_box({SelectSurface{{"capsule"}}}))));
  for (const Selector& part : {Selector{SelectVertices{{1, 2}}}, Selector{SelectTetrahedra{{3}}},
                               Selector{SelectNearest{{0, 0, 0}, 4}}}) {
    CHECK(selects_by_number(holding(part)));
    CHECK(selects_by_number(holding(beside_box(part))));
    Scene fibres, gesture;
    fibres.materials.emplace_back().fibre = FibreHarmonic{box, part};
    CHECK(selects_by_number(fibres));
    gesture.auto_regions.emplace().gestures.emplace_back().where = part;
    CHECK(selects_by_number(gesture));
  }
}

// Edges of the refined box are half as long: 8 × 4 × 4 cells.
TEST_CASE("on the refined mesh a selection means the same part of the body, however it is named") {
  const RefinedMesh refined = refine(mesh);
  const Selector left = plane({0, 0, 0}, {1, 0, 0}, Side::within, 0.1);
  const auto prolongated_from = [&](const Selector& where) {
    Scene scene = selecting(R"({"box": {"min": [0, 0, 0], "max": [1, 1, 1]}})");
    scene.boundary[0].where = where;
    return prolongated(scene, mesh, refined).boundary[0].where;
  };
  const Selector surface = prolongated_from(bound(R"({"surface": "left"})"));
  const std::vector<TetFace> outer = outer_faces(refined.mesh);
  CHECK(select_vertices(surface, refined.mesh) == select_vertices(left, refined.mesh));
  CHECK(select_faces(surface, refined.mesh, outer).size() == 4 * 8);
  CHECK(select_faces(surface, refined.mesh, outer).size() == select_faces(left, refined.mesh, outer).size());
  CHECK(select_tets(surface, refined.mesh).size() == 4 * 8);
  const Selector numbers = prolongated_from({SelectVertices{select_vertices(left, mesh)}});
  CHECK(select_vertices(numbers, refined.mesh) == select_vertices(left, refined.mesh));
  const Selector both = prolongated_from(
      {SelectAllOf{{bound(R"({"surface": "left"})"), negation({SelectBox{{-1, -1, -1}, {1, 0.9, 3}}})}}});
  CHECK(select_vertices(both, refined.mesh).size() == 3 * 5);
  // Triangles that are none of the mesh have no parts.
  CHECK(
      select_vertices(prolongated_from({SelectSurface{{"far"}, {{0, 20, 44}}, true}}), refined.mesh).empty());
}
