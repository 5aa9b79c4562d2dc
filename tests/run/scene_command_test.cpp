// lobe scene, lobe view of what is no scene, and lobe tissues as their callers use them.
#include <doctest/doctest.h>

#include "lobe/mesh/generators.h"
#include "lobe/scene/tissues.h"
#include "lobe_command.h"
#include "near.h"
#include "run/small_scene.h"

using namespace lobe;
using namespace lobe::test;

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// A plate of 80 × 40 × 10 mm, its lower half label 0 and its upper half label 1, in millimetres.
void write_plate(const Folder& folder) {
  TetMesh mesh = box_mesh({0.08, 0.04, 0.01}, 8, 4, 2);
  for (Index t = 0; t < mesh.tet_count(); ++t)
    mesh.labels[std::size_t(t)] = barycentre(mesh, t).z() < 0.005 ? 0 : 1;
  mesh.points *= 1000;
  write_vtu(folder.path / "plate.vtu", mesh);
}

}  // namespace

TEST_CASE("lobe scene proposes units, tissue, and the broadest side to hold, and says so") {
  const Folder folder;
  write_plate(folder);
  const Ended ended = lobe_in(folder, "scene plate.vtu -o organ.json --tissue kidney");
  REQUIRE_MESSAGE(ended.status == 0, ended.err);
  CHECK(ended.err.empty());
  CHECK(has(ended.out, "384 tetrahedra, 0.08 × 0.04 × 0.01 m"));
  CHECK(has(ended.out, "units      millimetres"));
  CHECK(has(ended.out, "material   kidney: E 5 kPa, nu 0.45, density 1050 kg/m³"));
  CHECK(has(ended.out, "held       45 vertices at the side z-, the broadest one"));
  const Json scene = Json::parse(bytes_of(folder.path / "organ.json"));
  CHECK(scene["mesh"] == "plate.vtu");
  CHECK(scene["mesh_scale"] == 0.001);
  REQUIRE(scene["materials"].size() == 2);
  CHECK(scene["materials"][1]["tissue"] == "kidney");
  CHECK(scene["materials"][1]["where"]["label"] == 1);
  CHECK(scene["guard_below"] == 0.2);
  CHECK(scene["volume_penalty"].get<double>() == near(2 * 5000 / 0.3, 1e-3));  // twice the bulk modulus
  const Ended check = lobe_in(folder, "check organ.json");
  CHECK(check.status == 0);
  CHECK(has(check.out, "held       45 vertices fixed"));
  CHECK_FALSE(has(check.out, "warning"));
}

TEST_CASE("the side that is held and the scale can be chosen") {
  const Folder folder;
  write_plate(folder);
  const Ended ended = lobe_in(folder, "scene plate.vtu --hold x+ --scale 0.002");
  REQUIRE_MESSAGE(ended.status == 0, ended.err);
  CHECK_FALSE(has(ended.out, "units"));
  const Json scene = Json::parse(bytes_of(folder.path / "plate_scene.json"));
  CHECK(scene["mesh_scale"] == 0.002);
  CHECK(scene["materials"][0]["tissue"] == "liver");
  const Json plane = scene["boundary"][0]["where"]["plane"];
  CHECK(plane["normal"] == Json({1.0, 0.0, 0.0}));
  CHECK(plane["point"][0].get<double>() == near(0.95 * 0.16, 1e-9));
  CHECK(has(ended.out, "held       15 vertices at the side x+ (--hold)"));
}

TEST_CASE("a side lies on springs, and pins hold with a side or alone") {
  const Folder folder;
  write_plate(folder);
  const Ended bed = lobe_in(folder, "scene plate.vtu -o bed.json --springs 50000 --pin 0.08,0.04,0.01");
  REQUIRE_MESSAGE(bed.status == 0, bed.err);
  CHECK(bed.err.empty());
  CHECK(has(bed.out,
            "held       45 vertices at the side z-, the broadest one (--hold), on springs of 5e+04 Pa/m"));
  CHECK(has(bed.out, "held       a pin of radius"));
  const Json scene = Json::parse(bytes_of(folder.path / "bed.json"));
  REQUIRE(scene["boundary"].size() == 1);
  const Json ball = scene["boundary"][0]["where"]["sphere"];
  CHECK(ball["center"] == Json({0.08, 0.04, 0.01}));
  CHECK(ball["radius"].get<double>() == near(0.01, 0.01));  // to the fourth vertex
  CHECK(scene["attachments"][0]["bed"]["stiffness"] == 50000);
  CHECK(lobe_in(folder, "check bed.json").status == 0);
  const Ended alone = lobe_in(folder, "scene plate.vtu -o bed.json --springs 50000");
  REQUIRE_MESSAGE(alone.status == 0, alone.err);
  CHECK(alone.err.empty());  // a bed holds the body: it does not float
  const Ended pins = lobe_in(folder, "scene plate.vtu -o pins.json --hold none --pin 0,0,0 --pin 0.08,0,0");
  REQUIRE_MESSAGE(pins.status == 0, pins.err);
  CHECK(Json::parse(bytes_of(folder.path / "pins.json"))["boundary"].size() == 2);
  CHECK(has(lobe_in(folder, "scene plate.vtu --hold none").err, "--hold: none: then nothing holds the body"));
  CHECK(has(lobe_in(folder, "scene plate.vtu --pin 1,0,0").err, "--pin: 1,0,0 is 0.92 m from the body"));
  for (const char* wrong : {"1,2", "1,2,3,4", "a,b,c", "1,2,inf", "1 2 3"})
    CHECK(lobe_in(folder, std::string("scene plate.vtu --pin '") + wrong + "'").status == 2);
}

TEST_CASE("what lobe scene cannot do is refused before anything is written") {
  const Folder folder;
  write_plate(folder);
  const Ended tissue = lobe_in(folder, "scene plate.vtu --tissue livr");
  CHECK(tissue.status == 2);
  CHECK(has(tissue.err, "--tissue: \"livr\" is none that lobe tissues lists; did you mean \"liver\"?"));
  for (const char* wrong :
       {"none.vtu", "plate.vtu -o organ.txt", "plate.vtu --hold up", "plate.vtu --scale 0"}) {
    CAPTURE(wrong);
    CHECK(lobe_in(folder, std::string("scene ") + wrong).status == 2);
  }
  folder.write("bad.vtu", "no mesh");
  CHECK(lobe_in(folder, "scene bad.vtu").status == 2);
  CHECK_FALSE(std::filesystem::exists(folder.path / "plate_scene.json"));
  CHECK_FALSE(std::filesystem::exists(folder.path / "bad_scene.json"));
}

TEST_CASE("lobe view of a mesh makes its scene once, and again when it is asked to") {
  const Folder folder;
  write_plate(folder);
  const std::string view = "view plate.vtu --port 99999";  // which lobe-view refuses
  const Ended first = lobe_in(folder, view);
  CHECK(first.status == 2);
  CHECK(has(first.out, "written to plate_scene.json"));
  folder.write("plate_scene.json", "{}");
  CHECK(has(lobe_in(folder, view).out, "plate_scene.json was made before"));
  CHECK(bytes_of(folder.path / "plate_scene.json") == "{}");
  CHECK(has(lobe_in(folder, view + " --tissue spleen").out, "material   spleen"));
  CHECK(has(bytes_of(folder.path / "plate_scene.json"), "\"tissue\": \"spleen\""));
}

TEST_CASE("lobe tissues lists all of them with their sources") {
  const Folder folder;
  const Json list = Json::parse(lobe_in(folder, "tissues --json").out);
  REQUIRE(list.size() == tissues().size());
  const std::string text = lobe_in(folder, "tissues").out;
  for (std::size_t i = 0; i < list.size(); ++i) {
    CHECK(list[i]["name"] == tissues()[i].name);
    CHECK(list[i]["young_modulus_Pa"] == tissues()[i].young_modulus);
    CHECK(list[i]["standard_deviation_Pa"].is_null() == (tissues()[i].spread == 0));
    CHECK(has(text, std::string(tissues()[i].source)));
  }
}

TEST_CASE("lobe check reads the skin, which only lobe view shows") {
  const Folder folder;
  Json scene = small_scene();
  scene["skin"] = "skin.obj";
  write_scene_files(folder, scene);
  const Ended missing = lobe_in(folder, "check scene.json");
  CHECK(missing.status == 2);
  CHECK(has(missing.err, "skin.obj"));
  folder.write("skin.obj", "solid x\n");
  CHECK(lobe_in(folder, "check scene.json").status == 2);
  folder.write("skin.obj", "v 0 0 0\nv 0.01 0 0\nv 0 0.01 0\nf 1 2 3\n");
  const Ended right = lobe_in(folder, "check scene.json");
  CHECK_MESSAGE(right.status == 0, right.err);
}
