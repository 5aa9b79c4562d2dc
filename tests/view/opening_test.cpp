// Other organs than the first: files that are sent, what comes with lobe, and what is chosen for them.
#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "child.h"
#include "inbox.h"
#include "library.h"
#include "lobe/error.h"
#include "near.h"
#include "opening.h"
#include "pace.h"
#include "viewed.h"

using namespace lobe;
using namespace lobe::test;
using namespace lobe::view;

namespace {

template <class Act>
std::string fault_of(const Act& act) {
  try {
    act();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string content_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// A page, with the choices and the status that it was told last.
struct Page {
  Viewed& viewed;
  ClientId id = 1;
  Json choices, status;

  explicit Page(Viewed& v) : viewed(v) { viewed.viewer->opened(id); }
  void look() {
    const std::string message = viewed.viewer->next_frame(id);
    if (message.empty()) return std::this_thread::sleep_for(std::chrono::milliseconds(5));
    for (const Block& block : read_blocks(message)) {
      if (block.tag == choices_tag) choices = Json::parse(block.bytes);
      if (block.tag == status_tag) status = Json::parse(block.bytes);
    }
  }
  // Within a minute.
  template <class Condition>
  bool comes_to(const Condition& condition) {
    for (int i = 0; i < 12000 && !condition(); ++i) look();
    return condition();
  }
  bool opens(int number) {
    return comes_to([&] { return !choices.is_null() && choices["opened"] == number && !status.is_null(); });
  }
};

Json to_open(const std::vector<std::string>& files, const std::string& tissue = "", double scale = 0) {
  return {{"do", "open"}, {"files", files}, {"tissue", tissue}, {"hold", ""},
          {"springs", 0}, {"edge", 0},      {"scale", scale}};
}

Json to_remake(const std::string& tissue, const std::string& hold, double springs = 0,
               const Json& pins = Json::array()) {
  return {{"do", "remake"}, {"tissue", tissue}, {"hold", hold}, {"springs", springs},
          {"pins", pins},   {"edge", 0},        {"scale", 0}};
}

}  // namespace

TEST_CASE("files of plain names and known kinds are taken, and are gone with the inbox") {
  std::filesystem::path file;
  {
    Inbox inbox;
    CHECK(!inbox.has("/tmp/organ.stl"));
    inbox.take("organ.stl", "solid a");
    inbox.take("organ.stl", "solid b");
    file = inbox.path_of("organ.stl");
    CHECK(content_of(file) == "solid b");
    CHECK(inbox.has(file));
    CHECK(inbox.has(inbox.make_folder() / "made.vtu"));
    CHECK(!inbox.has(file.parent_path().parent_path() / "other"));
    CHECK(inbox.make_folder() != inbox.make_folder());
    for (const char* name : {"", "../organ.stl", "a/b.stl", ".stl", "-o.stl", "a\nb.stl", "é.stl"})
      CHECK(fault_of([&] { inbox.take(name, ""); }).starts_with("name: must be of letters"));
    CHECK(fault_of([&] { inbox.take("organ.exe", ""); }) == "organ.exe: is of no kind that lobe reads");
    CHECK(fault_of([&] { inbox.take("a.nrrd", "NRRD0004\nData File: /etc/passwd\n\n"); }) ==
          "a.nrrd: has its voxels in another file: save it as one file");
    inbox.take("b.nrrd", "NRRD0004\nencoding: raw\n\ndata file:");
    CHECK(fault_of([&] { inbox.path_of("other.stl"); }) == "/files: \"other.stl\" was not sent");
  }
  CHECK(!std::filesystem::exists(file.parent_path()));
}

TEST_CASE("names are plain as the page makes them") {
  CHECK(plain_name("organ.vtu") == "organ.vtu");
  CHECK(plain_name("my organ (2).vtu") == "my_organ__2_.vtu");
  CHECK(plain_name("-.né.vtu") == "n_.vtu");
  CHECK(plain_name("\xf0\x9f\x98\x80.vtu") == "__.vtu");  // two units of UTF-16
  CHECK(plain_name("..").empty());
}

TEST_CASE("a scene that was sent has the files of these names that were sent with it, or known ones") {
  Folder folder;
  const std::filesystem::path file = folder.path / "scene.json";
  using Names = std::vector<std::string>;
  const auto missing = [&](const Json& scene, const Names& sent, const std::string& known = "") {
    folder.write("scene.json", scene.dump());
    return find_files_of_scene(file, sent, [&](const std::filesystem::path& named) {
      return named == known ? named : std::filesystem::path();
    });
  };
  const auto now = [&] { return Json::parse(content_of(file)); };
  CHECK(missing({{"mesh", "organ.vtu"}, {"skin", "organ.obj"}}, {"organ.vtu", "organ.obj"}).empty());
  CHECK(missing({{"mesh", "/home/me/organ.vtu"}}, {"organ.vtu"}).empty());
  CHECK(now()["mesh"] == "organ.vtu");
  CHECK(missing({{"mesh", "C:\\organs\\my organ.vtu"}}, {"my_organ.vtu"}).empty());
  CHECK(now()["mesh"] == "my_organ.vtu");
  // What was not sent is named once, and nothing is changed.
  const Json deep{{"mesh", "/etc/passwd"},
                  {"bodies", {{{"name", "a"}, {"mesh", "../b/c.vtu"}}}},
                  {"tools", {{{"shape", {{"mesh", {{"file", "/x/c.vtu"}}}}}}}},
                  {"skin", ""}};
  CHECK(missing(deep, {"organ.vtu"}) == Names{"c.vtu", "passwd"});
  CHECK(now() == deep);
  // A known one stays; one that was sent wins.
  CHECK(missing({{"mesh", "/home/me/organ.vtu"}}, {}, "/home/me/organ.vtu").empty());
  CHECK(now()["mesh"] == "/home/me/organ.vtu");
  CHECK(missing({{"mesh", "/home/me/organ.vtu"}}, {"organ.vtu"}, "/home/me/organ.vtu").empty());
  CHECK(now()["mesh"] == "organ.vtu");
  folder.write("deep.json", std::string(1000000, '['));
  CHECK(fault_of([&] {
          find_files_of_scene(folder.path / "deep.json", {}, [](const auto&) { return ""; });
        }).starts_with("deep.json"));
}

TEST_CASE("a child says what it says and how it ended") {
  Child child;
  CHECK(child.run({"sh", "-c", "echo out; echo err >&2; exit 3"}) == 3);
  CHECK(child.said() == "out\nerr\n");
  CHECK(!child.was_stopped());
  Child other;
  CHECK(other.run({"sh", "-c", "echo $TMPDIR"}, "/tmp/some folder") == 0);
  CHECK(other.said() == "/tmp/some folder\n");
  CHECK(Child().run({"no-such-program-of-lobe"}) == 127);
}

TEST_CASE("a child that is stopped takes along those that it has started") {
  Child child;
  std::thread stopper([&] {
    comes_to([&] { return child.said() == "there\n"; });
    child.stop();
  });
  CHECK(child.run({"sh", "-c", "sleep 60 & echo there; wait"}) == 128 + 9);  // sleep holds the output open
  stopper.join();
  CHECK(child.was_stopped());
  CHECK(child.run({"true"}) == 127);
}

TEST_CASE("the library has scenes by their names, then meshes") {
  Folder folder;
  std::filesystem::create_directories(folder.path / "scenes");
  std::filesystem::create_directories(folder.path / "meshes");
  folder.write("scenes/b.json", R"({"name": "A liver"})");
  folder.write("scenes/a.json", "{");
  folder.write("meshes/kidney.vtu", "");
  const std::vector<Shipped> all = library(folder.path);
  REQUIRE(all.size() == 2);
  CHECK(all[0].name == "scenes/b.json");
  CHECK(all[0].title == "A liver");
  CHECK(all[1].name == "meshes/kidney.vtu");
  CHECK(library(folder.path / "none").empty());
}

TEST_CASE("a mesh that is sent is opened with a tissue, changed, and saved as a scene") {
  Viewed viewed;
  Page page(viewed);
  REQUIRE(page.opens(0));
  CHECK(page.choices["chosen"].is_null());  // its scene was written by hand
  TetMesh mesh = box_mesh({60, 60, 60}, 3, 3, 3);
  write_vtu(viewed.folder.path / "cube.vtu", mesh);
  viewed.viewer->received_file("cube.vtu", content_of(viewed.folder.path / "cube.vtu"));
  viewed.ask(page.id, to_open({"cube.vtu"}, "kidney"));
  CHECK(page.comes_to([&] { return page.status.contains("opening"); }));
  CHECK(page.status["opening"]["title"] == "Opening cube.vtu");
  REQUIRE(page.opens(1));
  const Json& chosen = page.choices["chosen"];
  CHECK(chosen["tissue"] == "kidney");
  CHECK(chosen["hold"].get<std::string>().size() == 2);
  CHECK(chosen["has_own_mesh"] == true);
  CHECK(chosen["size"][0].get<double>() == near(0.06, 2e-4));  // millimetres, by its size
  CHECK(chosen["tets"] == mesh.tet_count());

  viewed.ask(page.id, to_remake("spleen", "z-"));
  REQUIRE(page.opens(2));
  CHECK(page.choices["chosen"]["tissue"] == "spleen");
  CHECK(page.choices["chosen"]["hold"] == "z-");
  CHECK(page.choices["chosen"]["size"][0].get<double>() == near(0.06, 2e-4));

  viewed.ask(page.id, {{"do", "save_scene"}, {"to", "kept"}});
  const Scene kept = read_scene(viewed.folder.path / "kept.json");
  CHECK(kept.materials[0].name == "spleen");
  CHECK(mesh_path(kept).parent_path() == viewed.folder.path);
  CHECK(read_mesh(mesh_path(kept)).mesh.tet_count() == mesh.tet_count());
}

TEST_CASE("a body lies on springs and is held by pins, which pages are told; its error is measured") {
  Viewed viewed;
  Page page(viewed);
  REQUIRE(page.opens(0));
  write_vtu(viewed.folder.path / "cube.vtu", box_mesh({0.06, 0.06, 0.06}, 2, 2, 2));
  viewed.viewer->received_file("cube.vtu", content_of(viewed.folder.path / "cube.vtu"));
  Json asked = to_open({"cube.vtu"});
  asked["hold"] = "z-";
  asked["springs"] = 2e5;
  viewed.ask(page.id, asked);
  REQUIRE(page.opens(1));
  CHECK(page.choices["chosen"]["hold"] == "z-");
  CHECK(page.choices["chosen"]["springs"] == 2e5);
  CHECK(page.choices["chosen"]["pins"].empty());

  const Json pins{{0.06, 0.06, 0.06}, {0.0, 0.06, 0.06}};
  viewed.ask(page.id, to_remake("liver", "none", 0, pins));
  REQUIRE(page.opens(2));
  CHECK(page.choices["chosen"]["hold"] == "none");
  CHECK(page.choices["chosen"]["springs"] == 0);
  CHECK(page.choices["chosen"]["pins"] == pins);

  CHECK(page.choices["errors"].is_null());
  viewed.ask(page.id, {{"do", "judge"}});
  CHECK(page.comes_to([&] { return page.status.contains("opening"); }));
  CHECK(page.status["opening"]["title"] == "Measuring the error");
  REQUIRE(page.comes_to([&] { return !page.choices["errors"].is_null(); }));
  REQUIRE(!page.choices["errors"].empty());
  CHECK(page.choices["errors"][0]["element"]["relative_l2"].get<double>() > 0.01);
  CHECK(page.choices["opened"] == 2);
  viewed.ask(page.id, to_remake("liver", "z-"));
  REQUIRE(page.opens(3));
  CHECK(page.choices["errors"].is_null());
}

TEST_CASE("what was asked for before stays where a scene is made anew, but no edge in other units") {
  Origin origin{{"organ.stl", "vessel.stl"}, 0.001, 0};
  Choices choices = carried_over(origin, {"liver", "z+", 0.004, 0, 5e4, {{1, 2, 3}}});
  CHECK(choices.springs == 5e4);
  CHECK(choices.pins.size() == 1);
  CHECK(choices.edge == 0.004);
  CHECK(choices.scale == 0.001);
  choices = carried_over(origin, {"spleen", "", 0, 0});
  CHECK(choices.tissue == "spleen");
  CHECK(choices.hold.empty());
  CHECK(choices.edge == 0.004);
  CHECK(choices.scale == 0.001);
  choices = carried_over(origin, {"spleen", "", 0, 0.01});
  CHECK(choices.edge == 0);
  CHECK(choices.scale == 0.01);
  CHECK(carried_over(origin, {"spleen", "", 0, -1}).scale == 0);  // found
  CHECK(carried_over(origin, {"", "", 0.03, 0.1}).edge == 0.03);
  CHECK(origin.edge == 0.03);
}

TEST_CASE("a scene is sent with its files, and saved with them") {
  Viewed viewed(true);
  Page page(viewed);
  REQUIRE(page.opens(0));
  Json scene = Json::parse(content_of(viewed.folder.path / "block.json"));
  scene["skin"] = "block.obj";
  viewed.viewer->received_file("sent.json", scene.dump());
  for (const char* name : {"block.vtu", "block.obj"})
    viewed.viewer->received_file(name, content_of(viewed.folder.path / name));
  viewed.ask(page.id, to_open({"block.vtu", "sent.json", "block.obj"}));
  CHECK(fault_of([&] {
          viewed.viewer->received_file("block.vtu", "another");
        }).starts_with("block.vtu: cannot be taken while"));
  REQUIRE(page.opens(1));
  CHECK(page.choices["chosen"].is_null());
  CHECK(page.status["has_skin"] == true);
  viewed.ask(page.id, {{"do", "save_scene"}, {"to", "kept"}});
  const Scene kept = read_scene(viewed.folder.path / "kept.json");
  CHECK(skin_path(kept) == viewed.folder.path / "kept_block.obj");
  CHECK(std::filesystem::exists(skin_path(kept)));
  const auto& written = viewed.viewer->write_recordings();
  REQUIRE(written.size() == 2);
  const Scene recorded = read_scene(written[1].scene);
  CHECK(std::filesystem::exists(skin_path(recorded)));
  CHECK(skin_path(recorded).parent_path() == viewed.folder.path);
}

TEST_CASE("scenes that were saved are opened again, alone where this program has their files") {
  Viewed viewed;
  Page page(viewed);
  REQUIRE(page.opens(0));
  viewed.take(page.id, 0, 0.03, 0.03);
  viewed.lead(page.id, 0, 0.03, 0.03, 0.07);
  REQUIRE(page.comes_to([&] { return page.status["time"].get<double>() > 0.2; }));
  viewed.ask(page.id, {{"do", "export"}, {"to", "hands"}});
  viewed.ask(page.id, {{"do", "save_scene"}, {"to", "kept"}});
  CHECK(read_scene(viewed.folder.path / "hands.json").mesh == viewed.folder.path / "block.vtu");
  const auto send = [&](const std::string& name, const std::string& as) {
    viewed.viewer->received_file(as, content_of(viewed.folder.path / name));
  };
  send("hands.json", "hands.json");
  viewed.ask(page.id, to_open({"hands.json"}));
  CHECK(page.opens(1));
  send("kept.json", "again.json");  // it names "kept.vtu"
  viewed.ask(page.id, to_open({"again.json"}));
  CHECK(page.opens(2));
  // Another file of this folder is not read because a scene names it.
  send("block.json", "block.json");  // "block.vtu"
  viewed.ask(page.id, to_open({"block.json"}));
  viewed.ask(page.id, {{"do", "cancel"}});
  CHECK(!viewed.viewer->is_preparing());
  send("block.vtu", "block.vtu");
  viewed.ask(page.id, to_open({"block.json", "block.vtu"}));
  CHECK(page.opens(3));
}

TEST_CASE("the size of a body is told before it is meshed; a mesh of its own has none") {
  Viewed viewed;
  Page page(viewed);
  REQUIRE(page.opens(0));
  CHECK(page.choices["measured"].is_null());
  viewed.viewer->received_file("block.vtu", content_of(viewed.folder.path / "block.vtu"));
  viewed.ask(page.id, {{"do", "measure"}, {"files", {"block.vtu"}}});
  REQUIRE(page.comes_to([&] { return !page.choices["measured"].is_null(); }));
  CHECK(page.choices["measured"]["files"] == Json{"block.vtu"});
  CHECK(page.choices["measured"]["body"].is_null());
  CHECK(page.choices["opened"] == 0);
  const auto known = readable_extensions();
  if (std::find(known.begin(), known.end(), ".off") == known.end()) return;  // there is no lobe-mesh
  viewed.viewer->received_file(
      "tetra.off", "OFF\n4 4 0\n0 0 0\n60 0 0\n0 60 0\n0 0 60\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  viewed.ask(page.id, {{"do", "measure"}, {"files", {"tetra.off"}}});
  REQUIRE(page.comes_to([&] { return page.choices["measured"]["files"] == Json{"tetra.off"}; }));
  const Json& body = page.choices["measured"]["body"];
  REQUIRE_MESSAGE(!body.is_null(), page.choices["measured"].dump());
  CHECK(body["size"] == Json{60.0, 60.0, 60.0});
  CHECK(body["scale"] == 0.001);
  CHECK(body["parts"][0]["volume"].get<double>() == near(36000, 1e-6));
}

TEST_CASE("warnings of the mesher are found among what programs say") {
  const std::string said =
      "organ.stl: 12 triangles\nlobe-mesh: warning: a, b: c\nlobe: warning: d\n\rlobe-mesh: warning: e\n";
  CHECK(warnings_of_mesher(said) == std::vector<std::string>{"a, b: c", "e"});
}

TEST_CASE("the pace of this machine is that of a tetrahedron in a step") {
  const double pace = measured_pace(1);
  CHECK(pace > 1e-10);
  CHECK(pace < 1e-5);  // 10 µs: a machine under a heavy load
}

TEST_CASE("what is being opened can be cancelled; another one may follow at once") {
  Viewed viewed;
  Page page(viewed);
  REQUIRE(page.opens(0));
  viewed.viewer->received_file("block.vtu", content_of(viewed.folder.path / "block.vtu"));
  viewed.ask(page.id, to_open({"block.vtu"}));
  viewed.ask(page.id, {{"do", "cancel"}});
  viewed.ask(page.id, to_open({"block.vtu"}, "kidney"));
  REQUIRE(page.opens(1));
  CHECK(page.choices["chosen"]["tissue"] == "kidney");
  CHECK(comes_to([&] { return viewed.viewer->abandon(); }));
}

TEST_CASE("what cannot be opened leaves the organ as it is") {
  Viewed viewed;
  Page page(viewed);
  REQUIRE(page.opens(0));
  viewed.viewer->received_file("bad.vtu", "no mesh at all");
  viewed.ask(page.id, to_open({"bad.vtu"}));
  CHECK(page.comes_to([&] { return page.status.contains("opening"); }));
  CHECK(page.comes_to([&] { return !page.status.contains("opening"); }));
  for (const Json& wrong : {to_open({}), to_open({"never_sent.stl"}), Json{{"do", "cancel"}},
                            Json{{"do", "open_shipped"}, {"what", "../secret.json"}}, to_remake("", "")})
    viewed.ask(page.id, wrong);
  const double time = page.status["time"];  // enough of it for a scene to be opened
  REQUIRE(page.comes_to([&] { return page.status["time"].get<double>() > time + 0.3; }));
  CHECK(page.choices["opened"] == 0);
  CHECK(page.status["scene"] == "block");
}
