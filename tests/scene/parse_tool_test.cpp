#include "lobe/scene/parse_tool.h"

#include <doctest/doctest.h>

#include <fstream>

#include "folder.h"
#include "lobe/error.h"

using namespace lobe;
using namespace lobe::test;

namespace {

std::string first_place(const std::string& text) {
  try {
    parse_tool(text);
  } catch (const InputError& error) {
    return error.faults().front().place;
  }
  return "no fault";
}

}  // namespace

TEST_CASE("each kind of tool that hands bring has the command of its JSON") {
  const ParsedTool cautery =
      parse_tool(R"({"type": "cautery", "name": "hook", "radius": 0.004, "at": [1, 2, 3]})");
  CHECK(cautery.position == Vec3d(1, 2, 3));
  CHECK(std::get<BringCautery>(cautery.command) == BringCautery{"hook", 0.004, {1, 2, 3}});
  const BringScalpel blade{"scalpel", {{0, 0, 1}, {0, 0, 2}}, 0.2, true};
  CHECK(std::get<BringScalpel>(
            parse_tool(R"({"type": "scalpel", "snap": 0.2, "surface": "faces", "at": [0, 0, 1, 0, 0, 2]})")
                .command) == blade);
  CHECK(std::get<BringScalpel>(parse_tool(R"({"type": "scalpel", "snap": 0.2, "surface": "faces",
                                              "blade": [0, 0, 1], "at": [0, 0, 1]})")
                                   .command) == blade);
  const ParsedTool jaws = parse_tool(R"({"type": "probe", "shape": {"jaws": {"size": [0.004, 0.012, 0.002]}},
                                         "friction": 0.4, "at": [1, 2, 3, 0, 0, 1, 0, 0.006]})");
  const auto& probe = std::get<BringProbe>(jaws.command);
  CHECK(probe.shape.kind == RigidShape::Kind::jaws);
  CHECK(probe.friction == 0.4);
  CHECK(probe.pose == ToolPose{{1, 2, 3}, {0, 0, 1, 0}, 0.006});
}

TEST_CASE("a tool's shape may be in a file of the folder") {
  const Folder folder;
  std::ofstream(folder.path / "tip.obj")
      << "v 0 0 1\nv 1 0 1\nv 0 1 1\nv 0 0 2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  const char* text = R"({"type": "probe", "shape": {"mesh": {"file": "tip.obj"}}, "at": [0, 0, 0]})";
  CHECK(std::get<BringProbe>(parse_tool(text, folder.path).command).shape.triangles.size() == 4);
  CHECK_THROWS_WITH_AS(parse_tool(text, folder.path / "none"), doctest::Contains("tip.obj"), InputError);
}

TEST_CASE("what is wrong with a tool is named as of the tool alone") {
  CHECK(first_place("[]") == "tool");
  CHECK(first_place("{").starts_with("tool:1:"));
  CHECK(first_place(R"({"type": "cautery", "radius": 0.01})") == "/at");
  CHECK(first_place(R"({"type": "cautery", "radius": 0.01, "at": 3})") == "/at");
  CHECK(first_place(R"({"type": "cautery", "radius": 0.01, "at": [1, 2]})") == "/at");
  CHECK(first_place(R"({"type": "cautery", "radius": 0.01, "at": [0, 0, 0], "path": []})") == "/path");
  CHECK(first_place(R"({"type": "cautery", "radius": -1, "at": [0, 0, 0]})") == "/radius");
  CHECK(first_place(R"({"type": "cautery", "radio": 1, "radius": 1, "at": [0, 0, 0]})") == "tool");
  CHECK(first_place(R"({"type": "scalpel", "at": [0, 0, 0]})") == "/at");
  CHECK(first_place(R"({"type": "grasp", "where": {"vertices": [0]}, "at": [0, 0, 0]})") == "/type");
  CHECK(first_place(R"({"type": "probe", "shape": {"sphere": {"radius": 0}}, "at": [0, 0, 0]})") ==
        "/shape/sphere/radius");
}
