#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "joined_meshes.h"
#include "lobe/error.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/describe.h"
#include "lobe/scene/each_selector.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/write_scene.h"
#include "near.h"
#include "scenes.h"

using namespace lobe;
using namespace lobe::test;
using nlohmann::json;

namespace {

// A plate of label 1, 40 x 40 x 10 mm, and 2 mm above it one of label 2, 20 x 40 x 10 mm.
const TetMesh& two_plates() {
  static const TetMesh mesh = [] {
    TetMesh below = box_mesh({0.04, 0.04, 0.01}, 4, 4, 1), above = box_mesh({0.02, 0.04, 0.01}, 2, 4, 1);
    below.labels.assign(std::size_t(below.tet_count()), 1);
    above.labels.assign(std::size_t(above.tet_count()), 2);
    above.points.row(2).array() += 0.012;
    return joined(below, above);
  }();
  return mesh;
}

constexpr const char* plain_bed = R"({"name": "bed", "bed": {"from": {"label": 1}, "to": {"label": 2},
  "within": 0.0021, "stiffness": 1e6, "fracture_energy": 20}})";

// With keys of the bed or the ligament replaced.
Scene tied(const std::string& attachment, const std::string& patch = "{}", const std::string& rest = "{}") {
  json entry = json::parse(attachment);
  for (const char* kind : {"bed", "ligament"})
    if (entry.contains(kind)) entry[kind].merge_patch(json::parse(patch));
  json document = json::parse(R"({"mesh": "plates.vtu", "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4}],
    "boundary": [{"fix": true, "where": {"label": 2}},
                 {"fix": true, "where": {"box": {"min": [-1, -1, -1], "max": [1, 1, 0]}}}]})");
  document["attachments"] = json::array({entry});
  document.update(json::parse(rest));
  return parse_scene(document.dump());
}

std::string tie_faults(const std::string& attachment, const std::string& patch = "{}",
                       const std::string& rest = "{}") {
  try {
    resolve(tied(attachment, patch, rest), two_plates());
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("attachments are read, with their defaults, and written again") {
  const Scene scene = parse_scene(full_scene);
  REQUIRE(scene.attachments.size() == 4);
  CHECK(scene.attachments[0].softening == 4);
  CHECK(scene.attachments[1].softening == 3);
  const auto& bed = std::get<SceneBed>(scene.attachments[0].what);
  CHECK(bed.to);
  CHECK(bed.spacing == 0.0025);
  CHECK(bed.fracture_energy == 50);
  const auto& wall = std::get<SceneBed>(scene.attachments[1].what);
  CHECK(!wall.to);
  CHECK(wall.spacing == 0);
  CHECK(!wall.fracture_energy);
  const auto& ligament = std::get<SceneLigament>(scene.attachments[2].what);
  CHECK(ligament.slack == 0.002);
  CHECK(ligament.strength == 4);
  CHECK(!ligament.ends_in_world);
  const auto& suspension = std::get<SceneLigament>(scene.attachments[3].what);
  CHECK(suspension.ends_in_world);
  CHECK(suspension.to == Vec3d(0, 0, 0.1));
  CHECK(to_json(parse_scene(to_json(scene))) == to_json(scene));
}

TEST_CASE("a bed becomes strands to the nearest points, which stand for its area") {
  const Resolved resolved = resolve(tied(plain_bed), two_plates());
  REQUIRE(resolved.setup.attachments.size() == 1);
  const AttachmentSetup& bed = resolved.setup.attachments[0];
  double area = 0, stiffness = 0;
  for (const StrandSetup& strand : bed.strands) {
    area += strand.area;
    stiffness += strand.stiffness;
    CHECK(strand.length == near(0.002, 1e-12));
    CHECK(strand.from.tet < strand.to.tet);
  }
  CHECK(bed.strands.size() == 16);  // two for each square centimetre
  CHECK(area == near(8e-4, 1e-12));
  CHECK(stiffness == near(800, 1e-12));
  CHECK(stiffness / 2 * bed.softening * bed.holds_until * bed.holds_until == near(20 * 8e-4, 1e-12));
  CHECK(
      describe(tied(plain_bed), resolved)
          .find(
              "attachment bed: 16 strands of up to 0.002 m on 0.0008 m², gives way from 0.003651 m on, tears "
              "at 0.01095 m, 0.016 J in all\n") != std::string::npos);
  const Resolved fine = resolve(tied(plain_bed, R"({"spacing": 0.0035})"), two_plates());
  CHECK(fine.setup.attachments[0].strands.size() == 4 * 16);
  const Resolved held =
      resolve(tied(plain_bed, R"({"to": null, "within": null, "to_world": true})"), two_plates());
  for (const StrandSetup& strand : held.setup.attachments[0].strands) {
    CHECK(strand.ends_in_world());
    CHECK(strand.length == 0);
  }
}

TEST_CASE("attachments that tie nothing are refused with their place") {
  CHECK(tie_faults(plain_bed, R"({"within": 0.001})")
            .starts_with("/attachments/0/bed/within: 0.001 m: no strand reaches from \"from\" to \"to\", "
                         "which are at least 0.002 m"));
  CHECK(tie_faults(plain_bed, R"({"spacing": 0.001})")
            .starts_with("/attachments/0/bed/spacing: 0.001 m, must be"));
  CHECK(tie_faults(plain_bed, R"({"to": {"label": 1}})").starts_with("/attachments/0/bed/to: selects face"));
  CHECK(tie_faults(plain_bed, R"({"to": {"label": 7}})")
            .starts_with("/attachments/0/bed/to: selects no boundary face"));
  CHECK(tie_faults(plain_bed, R"({"to": null})").find("/attachments/0/bed") != std::string::npos);
  CHECK(tie_faults(plain_bed, "{}", R"({"regions": [{"model": "precomputed"}]})")
            .find("of a precomputed region") != std::string::npos);
  CHECK(tie_faults(plain_bed, "{}", R"({"time": {"integrator": "implicit"}})")
            .starts_with("/attachments: a probe"));
  constexpr const char* ligament = R"({"name": "l", "ligament": {"from": [0.012, 0.013, 0.005],
    "to": [0.012, 0.013, 0.015], "stiffness": 100, "strength": 0.5, "slack": 0.001}})";
  const Resolved resolved = resolve(tied(ligament), two_plates());
  const AttachmentSetup& made = resolved.setup.attachments.at(0);
  CHECK(made.holds_until == near(0.005, 1e-12));
  CHECK(made.strands.at(0).length == near(0.011, 1e-12));
  CHECK(tie_faults(ligament, R"({"to": [0.012, 0.013, 0.03]})") ==
        "/attachments/0/ligament/to: is 0.008 m outside of every tetrahedron");
  CHECK(tie_faults(ligament, R"({"to": [0.012, 0.013, 0.0050001]})").find("has both ends in tetrahedron") !=
        std::string::npos);
  const json twice = json::array({json::parse(plain_bed), json::parse(plain_bed)});
  CHECK(tie_faults(plain_bed, "{}", json{{"attachments", twice}}.dump()) ==
        "/attachments/1/name: \"bed\" is the name of /attachments/0 already");
}

TEST_CASE("what an attachment ties to the world or to what is held is not loose") {
  constexpr const char* only_below = R"({"boundary": [{"fix": true,
    "where": {"box": {"min": [-1, -1, -1], "max": [1, 1, 0]}}}]})";
  const auto warnings = [&](const std::string& rest) {
    std::string all;
    for (const std::string& warning : resolve(tied(plain_bed, "{}", rest), two_plates()).warnings)
      all += warning + "\n";
    return all;
  };
  json loose = json::parse(only_below);
  CHECK(warnings(loose.dump()).find("is not held") == std::string::npos);
  loose["attachments"] = json::array();
  CHECK(warnings(loose.dump()).find("is not held") != std::string::npos);
}

TEST_CASE("a bed that selects by number selects something else on another mesh") {
  CHECK(!selects_by_number(tied(plain_bed)));
  CHECK(selects_by_number(tied(plain_bed, R"({"from": {"label": null, "vertices": [0, 1, 2]}})")));
}
