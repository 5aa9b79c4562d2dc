// Scenes of several bodies: three boxes of 6, 12 and 18 tetrahedra, 0.1 m long, apart along x.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <numbers>

#include "folder.h"
#include "lobe/error.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/bind_groups.h"
#include "lobe/scene/describe.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/scene_mesh.h"
#include "lobe/scene/select.h"
#include "lobe/scene/write_scene.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;
using nlohmann::json;

namespace {

TetMesh labelled_box(int cells) {
  TetMesh box = box_mesh({0.1, 0.1, 0.1}, cells, 1, 1);
  for (Index t = 0; t < box.tet_count(); ++t) box.labels[std::size_t(t)] = t < 3 ? 2 : 1;
  return box;
}

struct Boxes {
  Folder folder;

  Boxes() {
    for (int cells : {1, 2, 3})
      write_vtu(folder.path / ("box_" + std::to_string(cells) + ".vtu"), labelled_box(cells));
  }

  json document() const {
    return json::parse(R"({
      "bodies": [
        {"name": "liver", "mesh": "box_1.vtu"},
        {"name": "stomach", "mesh": "box_2.vtu", "position": [0.2, 0, 0]},
        {"name": "kidney", "mesh": "box_3.vtu", "position": [0.4, 0, 0]}],
      "materials": [{"name": "soft", "lame_lambda": 4e4, "lame_mu": 1e4, "where": {"body": "liver"}},
                    {"name": "stiff", "lame_lambda": 4e5, "lame_mu": 1e5}],
      "contact": {"self": true}
    })");
  }
  Scene scene(const json& patch = json::object()) const {
    json text = document();
    text.update(patch);
    return parse_scene(text.dump(), folder.path / "scene.json");
  }
  Resolved resolved(const json& patch = json::object()) const {
    Scene scene_now = scene(patch);
    MeshFile file = read_scene_mesh(scene_now);
    bind_groups(file, scene_now);
    return resolve(scene_now, std::move(file.mesh));
  }
  std::string faults(const json& patch) const {
    try {
      resolved(patch);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  std::string faults_of_bodies(const json& bodies) const { return faults({{"bodies", bodies}}); }
};

}  // namespace

TEST_CASE("meshes of bodies become one mesh, each in its place") {
  const Boxes boxes;
  const TetMesh mesh = read_scene_mesh(boxes.scene()).mesh;
  CHECK(mesh.bodies.names == std::vector<std::string>{"liver", "stomach", "kidney"});
  CHECK(mesh.tet_count() == 36);
  CHECK(mesh.points.leftCols(8) == labelled_box(1).points);
  const Mat3X<double> moved = labelled_box(2).points.colwise() + Vec3d(0.2, 0, 0);
  CHECK(mesh.points.middleCols(8, 12) == moved);
  CHECK(mesh_paths(boxes.scene())[2] == boxes.folder.path / "box_3.vtu");
}

TEST_CASE("a body is scaled, turned about the origin of its mesh, and then moved") {
  const Boxes boxes;
  const double half = std::numbers::sqrt2 / 2;
  const json placed = {{{"name", "a"},
                        {"mesh", "box_1.vtu"},
                        {"mesh_scale", 2},
                        {"position", {1, 2, 3}},
                        {"orientation", {0, 0, half, half}}}};
  const TetMesh mesh =
      read_scene_mesh(boxes.scene({{"bodies", placed}, {"materials", boxes.document()["materials"]}})).mesh;
  const TetMesh given = labelled_box(1);
  for (Index v = 0; v < given.vertex_count(); ++v) {
    const Vec3d X = 2 * given.points.col(v);
    CHECK((mesh.points.col(v) - Vec3d(1 - X.y(), 2 + X.x(), 3 + X.z())).norm() < 1e-15);
  }
  CHECK(total_volume(mesh) == near(8e-3, 1e-12));
}

TEST_CASE("a selector of bodies combines with others wherever one stands") {
  const Boxes boxes;
  const TetMesh mesh = read_scene_mesh(boxes.scene()).mesh;
  const auto tets = [&](const Selector& selector) { return select_tets(selector, mesh).size(); };
  const Selector stomach{SelectBody{{"stomach"}}}, two{SelectBody{{"liver", "kidney"}}};
  CHECK(tets(stomach) == 12);
  CHECK(tets(two) == 24);
  CHECK(tets({SelectNot{{two}}}) == 12);
  CHECK(tets({SelectAllOf{{stomach, {SelectLabel{{2}}}}}}) == 3);
  CHECK(select_vertices(stomach, mesh).size() == 12);
  CHECK(select_vertices(stomach, mesh).front() == 8);
  CHECK(select_faces(stomach, mesh, outer_faces(mesh)).size() == 20);
}

TEST_CASE("materials, regions, held parts, grasps, loads and pressures are given by body") {
  const Boxes boxes;
  const json of_kidney = {{"body", "kidney"}}, of_stomach = {{"body", "stomach"}};
  const Setup setup =
      boxes
          .resolved(
              {{"regions", {{{"model", "tensor-mass"}, {"where", of_stomach}}}},
               {"boundary",
                {{{"fix", true}, {"where", of_stomach}},
                 {{"fix", true}, {"hold_by", "volume"}, {"where", {{"body", "liver"}}}},
                 {{"force", {0, 0, 1}}, {"where", of_kidney}},
                 {{"pressure", 10}, {"where", of_kidney}}}},
               {"tools",
                {{{"type", "grasp"}, {"where", of_kidney}, {"path", {{0, 0, 0, 0}, {1, 0, 0, 0.01}}}}}}})
          .setup;
  for (Index t = 0; t < 36; ++t) {
    CHECK(setup.material_of[std::size_t(t)] == (t < 6 ? 0 : 1));
    CHECK(setup.region_of[std::size_t(t)] ==
          (t >= 6 && t < 18 ? RegionModel::tensor_mass : RegionModel::nonlinear));
  }
  CHECK(setup.prescribed.size() == 12 + 8);
  CHECK(setup.vertex_loads.size() == 16);
  CHECK(setup.pressures.size() == 28);
  CHECK(setup.grasps[0].vertices.size() == 16);
}

TEST_CASE("names of labels are those of each body's own file") {
  const Boxes boxes;
  Scene scene = boxes.scene({{"boundary", {{{"fix", true}, {"where", {{"label", "lobe"}}}}}}});
  MeshFile file = read_scene_mesh(scene);
  file.body_label_names = {{"liver", 2, "lobe"}, {"kidney", 1, "lobe"}, {"stomach", 2, "wall"}};
  bind_groups(file, scene);
  CHECK(select_tets(scene.boundary[0].where, file.mesh).size() == 3 + 15);
  const Scene read_back = parse_scene(to_json(scene));
  CHECK(select_tets(read_back.boundary[0].where, file.mesh).size() == 3 + 15);
  scene.boundary[0].where = {SelectLabel{{2}, {"wal"}}};
  CHECK_THROWS_WITH_AS(bind_groups(file, scene),
                       "/boundary/0/where/label: the mesh's file names no label \"wal\"; it names \"lobe\", "
                       "\"wall\"; did you mean \"wall\"?",
                       InputError);
}

TEST_CASE("groups of surfaces of the same name are one group of all bodies") {
  const Folder folder;
  folder.write("a.mesh",
               "MeshVersionFormatted 1\nDimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"
               "Tetrahedra 1\n1 2 3 4 1\nTriangles 1\n1 2 3 7\nEnd\n");
  Scene scene = parse_scene(R"({"bodies": [{"name": "a", "mesh": "a.mesh"},
      {"name": "b", "mesh": "a.mesh", "position": [2, 0, 0]}],
    "materials": [{"lame_lambda": 1, "lame_mu": 1}],
    "boundary": [{"pressure": 1, "where": {"surface": 7}},
                 {"pressure": 1, "where": {"all_of": [{"surface": 7}, {"body": "b"}]}}]})",
                            folder.path / "scene.json");
  const MeshFile file = read_scene_mesh(scene);
  REQUIRE(file.surfaces.size() == 1);
  bind_groups(file, scene);
  const std::vector<TetFace> faces = outer_faces(file.mesh);
  CHECK(select_faces(scene.boundary[0].where, file.mesh, faces).size() == 2);
  const std::vector<TetFace> of_b = select_faces(scene.boundary[1].where, file.mesh, faces);
  REQUIRE(of_b.size() == 1);
  CHECK(of_b[0].tet == 1);
  save_scene_mesh(file.mesh, folder.path, "saved", scene);  // with the surfaces that the scene selects
  Scene saved = parse_scene(to_json(scene), folder.path / "saved.json");
  const MeshFile again = read_scene_mesh(saved);
  bind_groups(again, saved);
  CHECK(select_faces(saved.boundary[0].where, again.mesh, faces).size() == 2);
  CHECK(select_faces(saved.boundary[1].where, again.mesh, faces).size() == 1);
}

TEST_CASE("a scene of bodies is written and read back, and its mesh is saved body by body") {
  const Boxes boxes;
  const Scene scene = with_absolute_paths(boxes.scene());
  const TetMesh mesh = read_scene_mesh(scene).mesh;
  const Folder other;
  Scene kept = parse_scene(to_json(scene), other.path / "kept.json");
  CHECK(read_scene_mesh(kept).mesh.points == mesh.points);
  CHECK(to_json(kept) == to_json(scene));
  save_scene_mesh(mesh, other.path, "saved", kept);
  const Scene moved = parse_scene(to_json(kept), other.path / "kept.json");
  const TetMesh again = read_scene_mesh(moved).mesh;
  CHECK(again.points == mesh.points);
  CHECK(again.tets == mesh.tets);
  CHECK(again.labels == mesh.labels);
  CHECK(again.bodies.names == mesh.bodies.names);
  CHECK(again.bodies.of == mesh.bodies.of);
  CHECK(std::filesystem::exists(other.path / "saved_3.vtu"));
}

TEST_CASE("the description says what each body is") {
  const Boxes boxes;
  const Scene scene = boxes.scene();
  const Resolved resolved = boxes.resolved();
  const json summary = json::parse(describe_json(scene, resolved));
  REQUIRE(summary["bodies"].size() == 3);
  const json& kidney = summary["bodies"][2];
  CHECK(kidney["name"] == "kidney");
  CHECK(kidney["file"] == "box_3.vtu");
  CHECK(kidney["tetrahedra"] == 18);
  CHECK(kidney["mass_kg"].get<double>() == near(1, 1e-12));
  CHECK(kidney["box_min_m"][0].get<double>() == near(0.4, 1e-12));
  CHECK(describe(scene, resolved)
            .find("body       stomach: box_2.vtu, 12 tetrahedra, 0.001 m³, 1 kg, [0.2, 0, 0] to") !=
        std::string::npos);
  const Resolved plain = resolve(
      parse_scene(R"({"mesh": "a", "materials": [{"lame_lambda": 1, "lame_mu": 1}]})"), labelled_box(1));
  CHECK_FALSE(json::parse(describe_json(scene, plain)).contains("bodies"));
}

TEST_CASE("bodies are named once, have a mesh, and a unit quaternion") {
  const Boxes boxes;
  const json liver = {{"name", "liver"}, {"mesh", "box_1.vtu"}};
  const auto changed = [&](const json& patch) {
    json body = liver;
    body.update(patch);
    return boxes.faults_of_bodies(json::array({body}));
  };
  CHECK(boxes.faults_of_bodies({liver, {{"name", "liver"}, {"mesh", "box_2.vtu"}}}) ==
        "/bodies/1/name: \"liver\" is the name of /bodies/0 already");
  CHECK(boxes.faults_of_bodies(json::array({{{"name", "liver"}}})) == "/bodies/0: needs \"mesh\"");
  CHECK(boxes.faults_of_bodies({{{"mesh", "box_1.vtu"}}}) == "/bodies/0: needs \"name\"");
  CHECK(boxes.faults_of_bodies(json::array()) == "/bodies: 0 items, must be at least 1");
  CHECK(changed({{"name", ""}}) == "/bodies/0/name: must not be empty");
  CHECK(changed({{"orientation", {0, 0, 0, 0}}}) ==
        "/bodies/0/orientation: the quaternion has length 0, must be 1");
  CHECK(changed({{"orientation", {0, 0, 1}}}) == "/bodies/0/orientation: 3 items, must be 4");
  CHECK(changed({{"position", {0, nullptr, 1}}}) == "/bodies/0/position/1: null, must be a number");
  CHECK(changed({{"mesh_scale", 0}}) == "/bodies/0/mesh_scale: 0, must be above 0");
  CHECK(changed({{"postion", {0, 0, 0}}}) ==
        "/bodies/0: unknown key \"postion\"; did you mean \"position\"?");
  CHECK(changed({{"mesh", "none.vtu"}}).find("none.vtu") != std::string::npos);
  CHECK(changed({{"position", {1e60, 0, 0}}})
            .starts_with("/bodies/0: " + (boxes.folder.path / "box_1.vtu").string()));
  CHECK(boxes.faults({{"mesh", "box_1.vtu"}}) ==
        (boxes.folder.path / "scene.json").string() + ": needs exactly one of \"mesh\" or \"bodies\", has 2");
  CHECK(boxes.faults({{"mesh_scale", 2}}) ==
        (boxes.folder.path / "scene.json").string() + ": \"mesh_scale\" also needs \"mesh\"");
}

TEST_CASE("places of a scene built in code are checked like those of a file") {
  const Boxes boxes;
  const TetMesh mesh = read_scene_mesh(boxes.scene()).mesh;
  Scene scene = boxes.scene();
  scene.bodies[1].position[2] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH_AS(resolve(scene, mesh), "/bodies/1/position/2: not a number, must be finite",
                       InputError);
  scene = boxes.scene();
  scene.bodies[1].orientation.setConstant(std::numeric_limits<double>::infinity());
  CHECK_THROWS_AS(resolve(scene, mesh), InputError);
}

TEST_CASE("a selector of a body that there is not is refused with those that there are") {
  const Boxes boxes;
  const auto fix = [&](const json& where) {
    return boxes.faults({{"boundary", {{{"fix", true}, {"where", where}}}}});
  };
  CHECK(fix({{"body", "livr"}}) ==
        "/boundary/0/where/body: no body is called \"livr\"; there are \"liver\", \"stomach\", \"kidney\"; "
        "did you "
        "mean \"liver\"?");
  CHECK(fix({{"not", {{"body", {"liver", "spleen"}}}}}) ==
        "/boundary/0/where/not/body: no body is called \"spleen\"; there are \"liver\", \"stomach\", "
        "\"kidney\"");
  const Scene plain = parse_scene(R"({"mesh": "a", "materials": [{"lame_lambda": 1, "lame_mu": 1}],
    "boundary": [{"fix": true, "where": {"body": "liver"}}]})");
  CHECK_THROWS_WITH_AS(
      resolve(plain, labelled_box(1)),
      "/boundary/0/where/body: \"liver\": the scene has one mesh, and no \"bodies\" with names", InputError);
}

TEST_CASE("bodies that overlap are refused, by how much and where") {
  const Boxes boxes;
  const auto at = [&](double x) {
    return boxes.faults_of_bodies({{{"name", "liver"}, {"mesh", "box_1.vtu"}},
                                   {{"name", "stomach"}, {"mesh", "box_2.vtu"}, {"position", {x, 0, 0}}}});
  };
  CHECK(at(0.1).empty());  // they touch
  CHECK(at(0.08).starts_with("/bodies/1/position: overlaps \"liver\" by 0.02 m at [0."));
  CHECK(at(0.08).ends_with("] m; move one of them"));
}

TEST_CASE("a small overlap is warned of, and so are bodies that do not feel each other") {
  const Boxes boxes;
  const json two = {{{"name", "liver"}, {"mesh", "box_1.vtu"}},
                    {{"name", "stomach"}, {"mesh", "box_2.vtu"}, {"position", {0.0999, 0, 0}}}};
  const json held = {{{"fix", true}, {"where", {{"all", true}}}}};
  const auto warnings = [&](const json& patch) {
    json all = {{"bodies", two}, {"boundary", held}};
    all.update(patch);
    return boxes.resolved(all).warnings;
  };
  REQUIRE(warnings(json::object()).size() == 1);
  CHECK(warnings(json::object())[0].starts_with("/bodies/1/position: overlaps \"liver\" by 0.0001 m at [0."));
  CHECK(warnings(json::object())[0].ends_with("; contact will push them apart"));
  REQUIRE(warnings({{"contact", {{"self", false}}}}).size() == 2);
  CHECK(warnings({{"contact", {{"self", false}}}})[1] ==
        "/contact/self: is false, so that the bodies do not feel each other");
}

TEST_CASE("a body that nothing holds is named") {
  const Boxes boxes;
  const Resolved resolved =
      boxes.resolved({{"boundary", {{{"fix", true}, {"where", {{"body", {"liver", "kidney"}}}}}}}});
  REQUIRE(resolved.warnings.size() == 1);
  CHECK(resolved.warnings[0].starts_with("/boundary: a piece of 12 tetrahedra of \"stomach\", among them 6"));
}

TEST_CASE("another mesh than that of the bodies is refused, and none can replace it") {
  const Boxes boxes;
  CHECK_THROWS_WITH_AS(resolve(boxes.scene(), labelled_box(1)),
                       "/bodies: the mesh is not that of these bodies: read it with read_scene_mesh()",
                       InputError);
  Scene scene = boxes.scene();
  CHECK_THROWS_AS(replace_mesh("other.vtu", scene), InputError);
  CHECK_THROWS_WITH_AS(
      mesh_path(scene),
      (scene.file.string() + ": has several bodies; here a scene of one mesh is needed").c_str(), InputError);
}
