// Pages and what they ask for, without a network.
#include "viewer.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <numeric>

#include "skin_feed.h"
#include "viewed.h"

using namespace lobe;
using namespace lobe::view;
using namespace lobe::test;

TEST_CASE("a page is told what stands around the organ, and how far jaws are open") {
  Viewed viewed(false, "none", Json::parse(R"({
    "tools": [{"name": "jaws", "type": "probe", "shape": {"jaws": {"size": [0.01, 0.004, 0.02]}},
               "path": [[0, 0.03, 0.03, 0.1, 1, 0, 0, 0, 0.07], [9, 0.03, 0.03, 0.1, 1, 0, 0, 0, 0.07]]}],
    "contact": {"obstacles": [{"name": "bar", "shape": {"capsule": {"radius": 0.008, "length": 0.1}},
                               "position": [0, 0.1, 0.2]},
                              {"name": "table", "shape": {"plane": {}}, "position": [0, 0, -0.1]}]}})"));
  viewed.viewer->opened(1);
  Json obstacles, tools;
  const std::string message = viewed.message(1);
  for (const Block& block : read_blocks(message)) {
    if (block.tag == obstacles_tag) obstacles = Json::parse(block.bytes);
    if (block.tag == tools_tag) tools = Json::parse(block.bytes);
  }
  REQUIRE(obstacles.size() == 2);
  CHECK(obstacles[0]["name"] == "bar");
  CHECK(obstacles[0]["position"] == Json{0.0, 0.1, 0.2});
  CHECK(obstacles[0]["shape"]["capsule"]["length"] == 0.1);
  CHECK(obstacles[1]["shape"].contains("plane"));
  REQUIRE(viewed.comes_to(1, [&](const Json&, const Json& shown) {
    tools = shown;
    return shown.size() == 1;
  }));
  CHECK(tools[0]["jaw"] == Json{0.01, 0.004, 0.02});
  CHECK(std::abs(tools[0]["opening"].get<double>() - 0.07) < 1e-9);
  CHECK(tools[0]["blade"][2].get<double>() > 0.019);  // before it is turned over
}

TEST_CASE("what was done in a page, saved as a scene, is played to the same bits") {
  Viewed viewed;
  viewed.viewer->opened(1);
  viewed.take(1, 0, 0.03, 0.03);
  REQUIRE(viewed.holds(1, 1));
  viewed.lead(1, 0, 0.04, 0.03, 0.07);
  REQUIRE(viewed.comes_to(1, [](const Json&, const Json& tools) {
    return tools.at(0).at("position").at(2).get<double>() > 0.065;
  }));
  viewed.bring(1, 1, {{"type", "cautery"}, {"radius", 0.008}, {"at", {0.005, 0.005, 0.055}}}, true);
  REQUIRE(
      viewed.comes_to(1, [](const Json& status, const Json&) { return status["tets"].get<int>() < 1296; }));
  viewed.ask(1, {{"do", "let_go"}, {"hand", 0}});
  viewed.pause(1);
  viewed.ask(1, {{"do", "export"}, {"to", "hands"}});
  viewed.record("hands.lobe");
  const Recording recording = read_recording(viewed.folder.path / "hands.lobe");
  CHECK(played(viewed.folder.path / "hands.json") == recording.commands.back().digest);
  // The same with regions that lobe is to choose for the one grasp; the cautery is no gesture.
  const Scene gestures = read_scene(viewed.folder.path / "hands_gestures.json");
  REQUIRE(gestures.auto_regions);
  REQUIRE(gestures.auto_regions->gestures.size() == 1);
  CHECK(gestures.auto_regions->gestures[0].value.norm() > 1e-3);
  CHECK(gestures.tools.size() == 2);
  const Resolved resolved = resolve(gestures, read_mesh(mesh_path(gestures)).mesh);
  REQUIRE(resolved.proposal);
  CHECK(resolved.proposal->gestures.size() == 1);
}

TEST_CASE("a scene is saved with its mesh if the mesh's own file will be gone") {
  Viewed viewed(false, "none", {}, [](ViewerOptions& options) { options.saves_mesh = true; });
  std::filesystem::remove(viewed.folder.path / "block.vtu");
  viewed.viewer->opened(1);
  viewed.take(1, 0, 0.03, 0.03);
  REQUIRE(viewed.holds(1, 1));
  viewed.pause(1);
  viewed.ask(1, {{"do", "export"}, {"to", "hands"}});
  viewed.record("hands.lobe");
  const Recording recording = read_recording(viewed.folder.path / "hands.lobe");
  CHECK(played(viewed.folder.path / "hands.json") == recording.commands.back().digest);
}

TEST_CASE("what a page has cut with a scalpel is told, and its scene is played to the same bits") {
  Viewed viewed;
  viewed.viewer->opened(1);
  // A blade without length is refused: there will be one tool.
  for (const double heel : {0.03, 0.07})
    viewed.bring(1, 1, {{"type", "scalpel"}, {"at", {0.033, -0.005, 0.03, 0.033, -0.005, heel}}}, true);
  REQUIRE(viewed.comes_to(1, [](const Json&, const Json& tools) {
    return tools.size() == 1 && tools[0]["type"] == "scalpel" && tools[0]["on"] == true &&
           std::abs(tools[0]["blade"][2].get<double>() - 0.04) < 1e-12;
  }));
  viewed.lead(1, 1, 0.033, 0.065, 0.03);
  REQUIRE(
      viewed.comes_to(1, [](const Json& status, const Json&) { return status["tets"].get<int>() > 1296; }));
  viewed.ask(1, {{"do", "let_go"}, {"hand", 1}});
  viewed.pause(1);
  viewed.ask(1, {{"do", "export"}, {"to", "cuts"}});
  viewed.record("cuts.lobe");
  const Recording recording = read_recording(viewed.folder.path / "cuts.lobe");
  CHECK(played(viewed.folder.path / "cuts.json") == recording.commands.back().digest);
}

// A tool of the device's is where the pointer is, but for what the tissue pulls it back [m].
bool is_near(const Json& tools, const Vec3d& pointer, double within) {
  if (tools.size() != 1) return false;
  const auto at = tools[0].at("position").get<std::array<double, 3>>();
  return (Vec3d(at[0], at[1], at[2]) - pointer).norm() < within;
}
double felt(const Json& status) {
  return status.contains("haptic") && status["haptic"].contains("force")
             ? status["haptic"]["force"].at(2).get<double>()
             : 0;
}

TEST_CASE(
    "a page's hand through a haptic device: the tool follows it, its force is told, the scene is kept") {
  for (const char* device : {"mouse", "hand"}) {
    for (const bool waits : {false, true}) {  // until the device has the tool
      CAPTURE(device);
      CAPTURE(waits);
      Viewed viewed(false, device);
      viewed.viewer->opened(1);
      viewed.take(1, 0, 0.03, 0.03);
      REQUIRE(viewed.holds(1, 1));
      if (waits)
        REQUIRE(viewed.comes_to(1, [](const Json& status, const Json& tools) {
          return status.contains("haptic") && status["haptic"].value("there", false) &&
                 is_near(tools, {0.03, 0.03, 0.06}, 1e-4);
        }));
      viewed.lead(1, 0, 0.03, 0.03, 0.06);
      viewed.lead(1, 0, 0.03, 0.03, 0.07);
      CHECK(viewed.comes_to(1, [&](const Json& status, const Json& tools) {
        return felt(status) < -0.02 && status["haptic"]["device"] == device &&
               is_near(tools, {0.03, 0.03, 0.066}, 0.004);
      }));
      viewed.take(1, 0, 0.01, 0.05);  // the pointer is somewhere else at once
      viewed.lead(1, 0, 0.01, 0.05, 0.067);
      CHECK(viewed.comes_to(1, [&](const Json& status, const Json& tools) {
        return felt(status) < -0.02 && is_near(tools, {0.01, 0.05, 0.0645}, 0.0025);
      }));
      viewed.pause(1);
      viewed.ask(1, {{"do", "export"}, {"to", "felt"}});
      viewed.record("felt.lobe");
      const Recording recording = read_recording(viewed.folder.path / "felt.lobe");
      CHECK(played(viewed.folder.path / "felt.json") == recording.commands.back().digest);
    }
  }
}

TEST_CASE("a page presses a probe on the body and feels it; its scene is played to the same bits") {
  Viewed viewed;
  viewed.viewer->opened(1);
  viewed.bring(1, 1,
               {{"type", "probe"}, {"shape", {{"sphere", {{"radius", 0.01}}}}}, {"at", {0.03, 0.03, 0.072}}});
  REQUIRE(viewed.holds(1, 1));
  viewed.lead(1, 1, 0.033, 0.031, 0.062);
  REQUIRE(viewed.comes_to(1, [](const Json&, const Json& tools) {
    return tools[0]["type"] == "probe" && tools[0]["radius"] == 0.01 &&
           tools[0]["force"][2].get<double>() > 0.1;
  }));
  viewed.ask(1, {{"do", "let_go"}, {"hand", 1}});
  REQUIRE(viewed.holds(1, 0));
  viewed.pause(1);
  viewed.ask(1, {{"do", "export"}, {"to", "pressed"}});
  viewed.record("pressed.lobe");
  const Recording recording = read_recording(viewed.folder.path / "pressed.lobe");
  CHECK(played(viewed.folder.path / "pressed.json") == recording.commands.back().digest);
}

TEST_CASE("a page grips the body between jaws and pulls; its scene is played to the same bits") {
  Viewed viewed;
  viewed.viewer->opened(1);
  const auto bring = [&](double opening, double w) {
    viewed.bring(1, 1,
                 {{"type", "probe"},
                  {"shape", {{"jaws", {{"size", {0.04, 0.004, 0.04}}}}}},
                  {"friction", 0.6},
                  {"at", {0.03, 0.03, 0.1, 1.0, 0.0, 0.0, w, opening}}});
  };
  bring(-0.01, 0);  // is refused: their opening must be at least 0
  bring(0.07, 1);   // and so is this, which is no unit quaternion
  REQUIRE(viewed.comes_to(
      1, [](const Json& status, const Json&) { return status["time"].get<double>() > 0.05; }));
  REQUIRE(viewed.holds(1, 0));
  bring(0.07, 0);  // from above
  REQUIRE(viewed.holds(1, 1));
  viewed.lead(1, 1, 0.03, 0.03, 0.075);
  const auto comes_to = [&](auto&& condition) {
    return viewed.comes_to(1, [&](const Json&, const Json& tools) { return condition(tools[0]); });
  };
  REQUIRE(comes_to([](const Json& jaws) { return jaws["position"][2].get<double>() < 0.0751; }));
  REQUIRE(comes_to([](const Json& jaws) {
    return !jaws["on"] && jaws["jaw"] == Json{0.04, 0.004, 0.04} && jaws["orientation"] == Json{1, 0, 0, 0} &&
           std::abs(jaws["opening"].get<double>() - 0.07) < 1e-9 && jaws["force"] == Json{0, 0, 0};
  }));
  viewed.ask(1, {{"do", "turn_on"}, {"hand", 1}, {"on", true}});
  REQUIRE(comes_to([](const Json& jaws) { return jaws["on"] && jaws["opening"].get<double>() < 0.056; }));
  viewed.lead(1, 1, 0.03, 0.03, 0.08);
  REQUIRE(comes_to([](const Json& jaws) { return jaws["force"][2].get<double>() < -0.5; }));
  viewed.ask(1, {{"do", "turn_on"}, {"hand", 1}, {"on", false}});
  REQUIRE(comes_to([](const Json& jaws) {
    return jaws["opening"].get<double>() > 0.0699 && jaws["force"] == Json{0, 0, 0};
  }));
  viewed.pause(1);
  viewed.ask(1, {{"do", "export"}, {"to", "gripped"}});
  viewed.record("gripped.lobe");
  const Recording recording = read_recording(viewed.folder.path / "gripped.lobe");
  CHECK(played(viewed.folder.path / "gripped.json") == recording.commands.back().digest);
}

TEST_CASE("what was painted, simulated and held, is saved and played to the same bits") {
  Viewed viewed;
  viewed.viewer->opened(1);
  viewed.ask(1, {{"do", "edit"}, {"on", true}});
  viewed.ask(1, {{"do", "new_material"}, {"name", "firm"}, {"young", 1e5}});
  viewed.ask(1, {{"do", "paint_material"}, {"at", {0.06, 0, 0.06}}, {"radius", 0.03}, {"material", 1}});
  viewed.ask(1, {{"do", "paint"}, {"at", {0, 0, 0.06}}, {"radius", 0.02}, {"as", "tensor-mass"}});
  viewed.ask(1, {{"do", "paint"}, {"at", {0, 0.06, 0.06}}, {"radius", 0.015}, {"as", "held"}});
  viewed.ask(1, {{"do", "apply"}});
  REQUIRE(viewed.comes_to(1, [](const Json& status, const Json&) { return status["mode"] == "live"; }));
  viewed.take(1, 0, 0.03, 0.03);
  REQUIRE(viewed.holds(1, 1));
  viewed.lead(1, 0, 0.03, 0.03, 0.07);
  REQUIRE(
      viewed.comes_to(1, [](const Json& status, const Json&) { return status["time"].get<double>() > 0.3; }));
  viewed.pause(1);
  viewed.ask(1, {{"do", "export"}, {"to", "hands"}});
  CHECK(read_scene(viewed.folder.path / "hands.json").materials.size() == 2);
  viewed.record("hands.lobe");
  const Recording recording = read_recording(viewed.folder.path / "hands.lobe");
  CHECK(played(viewed.folder.path / "hands.json") == recording.commands.back().digest);
}

TEST_CASE("two instruments hold at once; one is let go, the other stays") {
  Viewed viewed;
  viewed.viewer->opened(1);
  viewed.take(1, 0, 0.01, 0.01);
  viewed.take(1, 1, 0.05, 0.05);
  REQUIRE(viewed.holds(1, 2));
  viewed.lead(1, 1, 0.05, 0.05, 0.07);
  viewed.ask(1, {{"do", "let_go"}, {"hand", 1}});
  REQUIRE(viewed.comes_to(
      1, [](const Json&, const Json& tools) { return tools.size() == 1 && tools[0]["hand"] == 0; }));
}

TEST_CASE("pages that ask for nonsense and for what is not theirs, or take no pictures, disturb no hand") {
  Viewed viewed;
  for (ClientId page : {1, 2, 3}) viewed.viewer->opened(page);
  viewed.take(1, 0, 0.03, 0.03);
  REQUIRE(viewed.holds(1, 1));
  const std::string nested(60000, '[');
  for (int i = 0; i < 60; ++i) {
    viewed.lead(1, 0, 0.03 + 0.0002 * i, 0.03, 0.06 + 0.0002 * i);
    for (int k = 0; k < 20; ++k) {
      viewed.viewer->received(2, R"({"do": "nonsense", "number": 1e999)");
      viewed.ask(2, {{"do", "restart"}});
      viewed.ask(2, {{"do", "let_go"}, {"hand", 0}});
      viewed.ask(3, {{"do", "lead"}, {"hand", 0}, {"to", {1e300, 0, 0}}});
    }
    viewed.viewer->received(2, nested);
  }
  CHECK(viewed.comes_to(1, [](const Json&, const Json& tools) {
    return tools.size() == 1 && tools[0]["position"][2].get<double>() > 0.0717;
  }));
  viewed.pause(1);
  viewed.ask(1, {{"do", "export"}, {"to", "hands"}});
  viewed.record("hands.lobe");
  const Recording recording = read_recording(viewed.folder.path / "hands.lobe");
  for (const RecordedCommand& one : recording.commands) {
    REQUIRE(std::holds_alternative<Command>(one.command));  // nobody went back
    const Command& command = std::get<Command>(one.command);
    CHECK(!std::holds_alternative<LetGo>(command));
    if (const auto* lead = std::get_if<Lead>(&command)) CHECK(lead->target.position.norm() < 0.2);
  }
  CHECK(played(viewed.folder.path / "hands.json") == recording.commands.back().digest);
}

TEST_CASE("the skin of a scene is told to those who want it, follows the body, opens, and is whole again") {
  Viewed viewed(true);
  viewed.viewer->opened(1);
  std::size_t shown = 0;  // triangles
  Mat3X<float> x;         // of its vertices [m]
  const auto see = [&] {
    const std::string message = viewed.message(1);
    for (const Block& block : read_blocks(message)) {
      std::uint32_t head[3];
      if (block.tag == skin_tag) {
        std::memcpy(head, block.bytes.data(), sizeof head);
        shown = head[2];
      }
      if (block.tag == skin_positions_tag) {
        x.resize(3, Eigen::Index(block.bytes.size() / 12));
        std::memcpy(x.data(), block.bytes.data() + 4, block.bytes.size() - 4);
      }
    }
  };
  const auto comes_to = [&](const std::function<bool()>& condition) {
    for (int i = 0; i < 3000 && !condition(); ++i) see();
    return condition();
  };
  see();
  CHECK(shown == 0);  // nobody has asked for it
  viewed.ask(1, {{"do", "skin"}, {"on", true}});
  REQUIRE(comes_to([&] { return shown > 0; }));
  const std::size_t whole = shown;
  CHECK(whole == 12 * 6 * 6);
  const Mat3X<float> at_rest = x;
  const auto moved = [&] { return (x - at_rest).colwise().norm().maxCoeff(); };
  viewed.take(1, 0, 0.03, 0.03);
  REQUIRE(viewed.holds(1, 1));
  viewed.lead(1, 0, 0.04, 0.03, 0.075);
  CHECK(comes_to([&] { return moved() > 1e-3f; }));
  viewed.bring(1, 1, {{"type", "cautery"}, {"radius", 0.008}, {"at", {0.005, 0.005, 0.055}}}, true);
  CHECK(comes_to([&] { return shown < whole; }));
  viewed.ask(1, {{"do", "restart"}});
  const bool is_back = comes_to([&] { return shown == whole && moved() < 1e-7f; });
  CAPTURE(moved());
  CHECK(shown == whole);
  CHECK(is_back);
}

TEST_CASE(
    "a skin of a world that was put back and cut at once, while nobody looked, is that of the one cut") {
  const Viewed viewed(true);
  const Scene scene = read_scene(viewed.folder.path / "block.json");
  const Setup setup = resolve(scene, read_mesh(mesh_path(scene)).mesh).setup;
  const auto triangles = [&](bool is_put_back) {
    World<float> world(setup);
    SkinFeed<float> feed(viewed.folder.path / "block.obj", setup.mesh, world);
    const auto start = world.save();
    if (is_put_back) {
      std::vector<Index> first(40);
      std::iota(first.begin(), first.end(), 0);
      world.apply(RemoveTets{first});
      world.restore(start);
    }
    world.apply(RemoveTets{{1290, 1291, 1292}});
    feed.set_wanted(true);
    feed.update(world);
    std::uint64_t told = 0;
    BlockWriter out;
    feed.write(0, told, out);
    const std::string message = out.take();
    const std::vector<Block> blocks = read_blocks(message);
    REQUIRE(blocks.size() == 2);
    std::uint32_t head[3];
    std::memcpy(head, blocks[0].bytes.data(), sizeof head);
    return head[2];
  };
  CHECK(triangles(false) < 12 * 6 * 6);
  CHECK(triangles(true) == triangles(false));
}

TEST_CASE("a skin that a blade has cut has vertices on both sides, at rest at one place") {
  const Viewed viewed(true);
  const Scene scene = read_scene(viewed.folder.path / "block.json");
  Setup setup = resolve(scene, read_mesh(mesh_path(scene)).mesh).setup;
  setup.scalpels = {{"blade",
                     0.1,
                     {{0.001, {0.031, -0.1, 0.1}}, {0.02, {0.031, -0.1, 0.03}}},
                     {{0.031, 0.2, 0.1}, {0.031, 0.2, 0.03}}}};
  World<float> world(setup);
  SkinFeed<float> feed(viewed.folder.path / "block.obj", setup.mesh, world);
  feed.set_wanted(true);
  const auto block = [&](std::uint32_t wanted) {
    std::uint64_t told = 0;
    BlockWriter out;
    feed.update(world);
    feed.write(0, told, out);
    const std::string message = out.take();
    for (const Block& own : read_blocks(message))
      if (own.tag == wanted) return std::string(own.bytes);
    return std::string();
  };
  const auto head = [&] {
    std::array<std::uint32_t, 3> numbers{};
    std::memcpy(numbers.data(), block(skin_tag).data(), sizeof numbers);
    return numbers;
  };
  const std::array<std::uint32_t, 3> before = head();
  for (int i = 0; i < 3; ++i) REQUIRE(world.advance(0.01).ok);
  const std::array<std::uint32_t, 3> after = head();
  CHECK(after[0] > before[0]);
  CHECK(after[1] > before[1]);  // vertices
  CHECK(after[2] > before[2]);  // parts of triangles: none is lost
  CHECK(block(skin_positions_tag).size() == 4 + 12 * after[1]);
  Mat3X<float> rest(3, Eigen::Index(after[1]));
  std::memcpy(rest.data(), block(skin_tag).data() + 12 + 12 * after[2], 12 * after[1]);
  for (Eigen::Index v = Eigen::Index(before[1]); v < rest.cols(); ++v)
    CHECK(std::abs(rest(0, v) - 0.031F) < 0.005F);  // on the line, or as near as it has snapped
}

TEST_CASE("the error of linear regions is estimated where they are, and asked for by name") {
  Viewed viewed;
  viewed.viewer->opened(1);
  viewed.ask(1, {{"do", "show"}, {"what", "linear_error"}});
  REQUIRE(viewed.comes_to(1, [](const Json& status, const Json&) { return status.contains("energy"); }));
  CHECK(!viewed.frame(1)[0].contains("linear_error"));  // of a body that has not moved
  viewed.take(1, 0, 0.03, 0.03);
  REQUIRE(viewed.holds(1, 1));
  viewed.lead(1, 0, 0.06, 0.03, 0.06);
  CHECK(viewed.comes_to(1, [](const Json& status, const Json&) {
    return status.contains("linear_error") && status["linear_error"].get<double>() > 1e-4;
  }));
}

TEST_CASE("the error of reduced regions is estimated while it is shown") {
  Viewed viewed(false, "none", {{"regions", {{{"model", "reduced"}, {"cell", 0.02}}}}});
  viewed.viewer->opened(1);
  viewed.ask(1, {{"do", "show"}, {"what", "linear_error"}});
  REQUIRE(viewed.comes_to(1, [](const Json& status, const Json&) { return status.contains("energy"); }));
  viewed.take(1, 0, 0.03, 0.03);
  REQUIRE(viewed.holds(1, 1));
  viewed.lead(1, 0, 0.06, 0.03, 0.06);
  CHECK(viewed.comes_to(1, [](const Json& status, const Json&) {
    return status.contains("linear_error") && status["linear_error"].get<double>() > 1e-4;
  }));
}
