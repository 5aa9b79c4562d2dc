#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "lobe/error.h"
#include "lobe/forces/embedded.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/describe.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/write_scene.h"
#include "near.h"
#include "scenes.h"

using namespace lobe;
using namespace lobe::test;
using nlohmann::json;

namespace {

const TetMesh& sewn_block() {
  static const TetMesh mesh = box_mesh({0.04, 0.04, 0.02}, 4, 4, 2);
  return mesh;
}

// A block with one stitch of which some keys are replaced.
Scene sewn(const std::string& patch, const std::string& rest = "{}") {
  json stitch = json::parse(R"({"through": [[0.01, 0.02, 0.012], [0.03, 0.02, 0.012]], "tie": {"at": 1}})");
  stitch.update(json::parse(patch));
  json document = json::parse(R"({"mesh": "block.vtu", "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4}],
    "boundary": [{"fix": true, "where": {"box": {"min": [-1, -1, -1], "max": [0, 1, 1]}}}]})");
  document["threads"] = json::array({{{"name", "silk"}, {"stitches", json::array({stitch})}}});
  document.update(json::parse(rest));
  return parse_scene(document.dump());
}

std::string sewing_faults(const std::string& patch, const std::string& rest = "{}") {
  try {
    resolve(sewn(patch, rest), sewn_block());
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("threads are read, with their defaults") {
  const Scene scene = parse_scene(full_scene);
  REQUIRE(scene.threads.size() == 1);
  const SceneThread& thread = scene.threads[0];
  CHECK(thread.name == "3-0");
  CHECK(thread.material == ThreadMaterial{80, 0.1, 20, 1.5});
  REQUIRE(thread.stitches.size() == 2);
  CHECK(thread.stitches[0].through.size() == 3);
  CHECK(thread.stitches[0].through[1] == Vec3d(0.01, 0, 0));
  CHECK(thread.stitches[0].at == 0.5);
  REQUIRE(thread.stitches[0].ties.size() == 2);
  CHECK(thread.stitches[0].ties[0].tighten == 0.002);
  CHECK(thread.stitches[0].ties[0].over == 0.1);
  CHECK(thread.stitches[0].ties[0].between == std::array<Index, 2>{0, 1});
  CHECK(thread.stitches[0].ties[1].at == 1);
  CHECK(!thread.stitches[0].ties[1].between);
  CHECK(thread.stitches[1].at == 0);
  REQUIRE(thread.stitches[1].ties.size() == 1);
  CHECK(thread.stitches[1].ties[0].over == 0.2);
  const Scene plain = sewn("{}");
  CHECK(plain.threads[0].material == ThreadMaterial{});
}

TEST_CASE("threads that are written and read again are the same") {
  const Scene scene = parse_scene(full_scene), again = parse_scene(to_json(scene));
  REQUIRE(again.threads.size() == 1);
  CHECK(again.threads[0].material == scene.threads[0].material);
  CHECK(to_json(again) == to_json(scene));
}

TEST_CASE("a stitch is resolved to points in tetrahedra, and its knot joins the first and the last") {
  const Resolved resolved = resolve(sewn("{}"), sewn_block());
  REQUIRE(resolved.setup.stitches.size() == 1);
  const StitchSetup& stitch = resolved.setup.stitches[0];
  CHECK(stitch.name == "silk");
  REQUIRE(stitch.bites.size() == 2);
  const Elements elements(resolved.setup);
  CHECK((rest_position(stitch.bites[1], elements) - Vec3d(0.03, 0.02, 0.012)).norm() < 1e-16);
  REQUIRE(stitch.ties.size() == 1);
  CHECK(stitch.ties[0].from == 0);
  CHECK(stitch.ties[0].to == 1);
  CHECK(resolved.warnings.empty());
  CHECK(describe(sewn("{}"), resolved)
            .find("thread     silk: EA 98 N, friction 0.2, 1 stitches, 2 bites, 1 knots\n") !=
        std::string::npos);
}

TEST_CASE("stitches that cannot be sewn are refused with their place") {
  CHECK(sewing_faults(R"({"through": [[0.01, 0.02, 0.023], [0.03, 0.02, 0.012]]})") ==
        "/threads/0/stitches/0/through/0: is 0.003 m outside of every tetrahedron: a thread passes through "
        "tissue");
  CHECK(sewing_faults(R"({"through": [[0.01, 0.02, 0.012]]})") ==
        "/threads/0/stitches/0/through: 1 items, must be at least 2");
  CHECK(sewing_faults(R"({"tie": {"at": 1, "tighten": 0.03}})") ==
        "/threads/0/stitches/0/tie/tighten: 0.03 m, leaves less than half of the loop's 0.04 m");
  CHECK(sewing_faults(R"({"tie": {"at": 1, "between": [0, 2]}})") ==
        "/threads/0/stitches/0/tie/between: must be two of the 2 points of the stitch, numbered from 0, in "
        "their order");
  CHECK(sewing_faults(R"({"at": 2})").starts_with("/threads/0/stitches/0/tie/at: 1 s, before the stitch"));
  CHECK(sewing_faults("{}", R"({"regions": [{"model": "precomputed"}]})")
            .starts_with("/threads/0/stitches/0/through/0: lies in tetrahedron "));
  CHECK(sewing_faults("{}", R"({"time": {"integrator": "implicit"}})").starts_with("/threads: a probe"));
  CHECK(sewing_faults(R"({"tie": [{"at": 1}, {"at": 1}]})") ==
        "/threads/0/stitches/0/tie/1/between: its loop and that of an earlier knot overlap");
}
