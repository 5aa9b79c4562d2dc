// On a bar of 0.4 × 0.1 × 0.1 m in 4 × 1 × 1 cells, held at x = 0.
#include "lobe/scene/resolve.h"
#include "near.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "lobe/error.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/write_scene.h"
#include "lobe/sim/world.h"

using namespace lobe;
using namespace lobe::test;
using nlohmann::json;

namespace {

TetMesh bar(double scale = 1) { return box_mesh(Vec3d(0.4, 0.1, 0.1) * scale, 4, 1, 1); }

// A scene without any warning, with some of its keys replaced.
Scene scene(const std::string& patch = "{}") {
  json document = json::parse(R"({
    "mesh": "bar.vtu",
    "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4}],
    "boundary": [{"fix": true, "where": {"box": {"min": [-1, -1, -1], "max": [0, 1, 1]}}}]
  })");
  document.update(json::parse(patch));
  return parse_scene(document.dump());
}

Resolved resolved(const std::string& patch) { return resolve(scene(patch), bar()); }

std::string faults(const std::string& patch) {
  try {
    resolved(patch);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string warnings(const std::string& patch, double scale = 1) {
  std::string text;
  for (const std::string& warning : resolve(scene(patch), bar(scale)).warnings) {
    text += (text.empty() ? "" : "\n") + warning;
  }
  return text;
}

const std::string spans = "; the mesh spans [0, 0, 0] to [0.4, 0.1, 0.1] m, its labels are 0";
const std::string end_face = R"({"plane": {"point": [0.4, 0, 0], "normal": [1, 0, 0], "within": 1e-9}})";
const std::string clamp = R"({"fix": true, "where": {"box": {"min": [-1, -1, -1], "max": [0, 1, 1]}}})";

}  // namespace

TEST_CASE("a plain scene resolves without a warning") {
  const Resolved result = resolved(R"({"volume_penalty": 5, "guard_below": 0.3, "gravity": [0, 0, -9.81],
    "loose_pieces": "stay", "time": {"damping": 3, "safety": 0.5, "selective_mass": 5, "ramp": 0.2, "load_ramp": 0.3, "sleep": 1e-5}})");
  const Setup& setup = result.setup;
  CHECK(result.warnings.empty());
  CHECK(setup.mesh.tet_count() == 24);
  REQUIRE(setup.materials.size() == 1);
  CHECK(setup.materials[0].lambda == 4e4);
  CHECK(setup.materials[0].mu == 1e4);
  CHECK(setup.materials[0].density == 1000);
  CHECK(setup.material_of == std::vector<std::uint16_t>(24, 0));
  CHECK(setup.region_of == std::vector<RegionModel>(24, RegionModel::nonlinear));
  REQUIRE(setup.prescribed.size() == 4);
  for (const PrescribedVertex& p : setup.prescribed) {
    CHECK(setup.mesh.points(0, p.vertex) == 0);
    CHECK(p.displacement == Vec3d::Zero());
  }
  CHECK(setup.volume_penalty == 5);
  CHECK(setup.guard_below == 0.3);
  CHECK(setup.gravity == Vec3d(0, 0, -9.81));
  CHECK(setup.loose_pieces == LoosePieces::stay);
  CHECK(setup.damping == 3);
  CHECK(setup.safety == 0.5);
  CHECK(setup.selective_mass == 5);
  CHECK(setup.ramp == 0.2);
  CHECK(setup.load_ramp == 0.3);
  CHECK(setup.sleep == 1e-5);
}

TEST_CASE("the first matching material wins, the one without where is the default") {
  const Resolved result = resolved(R"({"materials": [
    {"lame_lambda": 4e4, "lame_mu": 1e4},
    {"lame_lambda": 5e4, "lame_mu": 1e4, "where": {"tetrahedra": [0, 1, 2]}},
    {"lame_lambda": 6e4, "lame_mu": 1e4, "where": {"tetrahedra": [2, 3]}}]})");
  std::vector<std::uint16_t> expected(24, 0);
  expected[0] = expected[1] = expected[2] = 1;
  expected[3] = 2;
  CHECK(result.setup.material_of == expected);
  CHECK(result.setup.materials[2].lambda == 6e4);
  CHECK(result.warnings.empty());
}

TEST_CASE("every tetrahedron needs a material") {
  CHECK(
      faults(
          R"({"materials": [{"lame_lambda": 4e4, "lame_mu": 1e4, "where": {"not": {"tetrahedra": [7, 9]}}}]})") ==
      "/materials: 2 tetrahedra have no material (the first: 7); add one without \"where\" as the default");
}

TEST_CASE("the first matching region wins, what is left is nonlinear") {
  const auto models = [](const std::string& regions) {
    return resolved("{\"regions\": " + regions + "}").setup.region_of;
  };
  std::vector<RegionModel> expected(24, RegionModel::nonlinear);
  expected[0] = expected[1] = RegionModel::tensor_mass;
  CHECK(models(R"([{"model": "tensor-mass", "where": {"tetrahedra": [0, 1]}}])") == expected);
  CHECK(
      models(
          R"([{"model": "nonlinear", "where": {"not": {"tetrahedra": [0, 1]}}}, {"model": "tensor-mass"}])") ==
      expected);
  CHECK(models(R"([{"model": "tensor-mass"}])") == std::vector<RegionModel>(24, RegionModel::tensor_mass));
}

TEST_CASE("entries that come too late are pointed out") {
  CHECK(warnings(
            R"({"regions": [{"model": "tensor-mass"}, {"model": "nonlinear", "where": {"label": 99}}]})") ==
        "/regions/1: never used: /regions/0 has no \"where\" and takes everything");
  CHECK(warnings(R"({"regions": [{"model": "tensor-mass", "where": {"all": true}},
                                 {"model": "nonlinear", "where": {"tetrahedra": [1, 2]}}]})") ==
        "/regions/1/where: earlier entries have taken all of its 2 tetrahedra");
  CHECK(warnings(
            R"({"materials": [{"lame_lambda": 4e4, "lame_mu": 1e4}, {"lame_lambda": 1, "lame_mu": 1e4}]})") ==
        "/materials/1: never used: /materials/0 is the default already");
}

TEST_CASE("selections that select nothing are refused, all at once") {
  CHECK(
      faults(
          R"({"materials": [{"lame_lambda": 4e4, "lame_mu": 1e4}, {"lame_lambda": 4e4, "lame_mu": 1e4, "where": {"label": 3}}],
    "regions": [{"model": "tensor-mass", "where": {"sphere": {"center": [9, 9, 9], "radius": 1}}}],
    "boundary": [{"fix": true, "where": {"box": {"min": [1, 1, 1], "max": [2, 2, 2]}}},
                 {"force": [0, 0, 1], "where": {"not": {"all": true}}},
                 {"traction": [0, 0, 1], "where": {"nearest": {"point": [0, 0, 0], "count": 2}}}],
    "tools": [{"type": "grasp", "where": {"sphere": {"center": [9, 9, 9], "radius": 1}}, "path": [[0, 0, 0, 0]]}]})") ==
      "/materials/1/where: selects no tetrahedron" + spans + "\n/regions/0/where: selects no tetrahedron" +
          spans + "\n/boundary/0/where: selects no vertex" + spans +
          "\n/boundary/1/where: selects no vertex" + spans + "\n/boundary/2/where: selects no boundary face" +
          spans + "\n/tools/0/where: selects no vertex" + spans);
}

TEST_CASE("indices beyond the mesh are refused with their place, once") {
  CHECK(faults(R"({"regions": [{"model": "tensor-mass", "where": {"tetrahedra": [24]}}],
                   "boundary": [{"fix": true, "where": {"vertices": [0, 99]}}],
                   "tools": [{"type": "grasp", "where": {"vertices": [20]}, "path": [[0, 0, 0, 0]]}]})") ==
        "/regions/0/where/tetrahedra/0: 24, must be from 0 to 23: the mesh has 24 tetrahedra\n"
        "/boundary/0/where/vertices/1: 99, must be from 0 to 19: the mesh has 20 vertices\n"
        "/tools/0/where/vertices/0: 20, must be from 0 to 19: the mesh has 20 vertices");
}

TEST_CASE("pressure is refused in a precomputed region, and with the implicit integrator") {
  const std::string pressed =
      R"("boundary": [)" + clamp + R"(, {"pressure": 10, "where": )" + end_face + "}]";
  const std::string left = R"("where": {"box": {"min": [-1, -1, -1], "max": [0.25, 1, 1]}})";
  CHECK(resolved("{" + pressed + "}").setup.pressures.size() == 2);
  CHECK(
      resolved("{" + pressed + R"(, "regions": [{"model": "precomputed", )" + left + "}]}").warnings.empty());
  CHECK(faults("{" + pressed + R"(, "regions": [{"model": "precomputed"}]})") ==
        "/boundary/1: 2 faces under pressure are in a precomputed region, whose inside bears no load that "
        "follows it: make that part tensor-mass or nonlinear");
  CHECK(faults("{" + pressed + R"(, "time": {"integrator": "implicit"}})")
            .starts_with("/boundary/1/pressure: a probe, a needle, a pressure, a thread, an attachment, a "
                         "clip, a force term or "
                         "springs does not go with"));
}

TEST_CASE("a precomputed region must be held, and explicit") {
  const std::string near = R"("where": {"box": {"min": [-1, -1, -1], "max": [0.19, 1, 1]}})";
  CHECK(resolved(R"({"regions": [{"model": "precomputed", )" + near + "}]}").warnings.empty());
  CHECK(
      faults(R"({"regions": [{"model": "nonlinear", )" + near + R"(}, {"model": "precomputed"}]})") ==
      "precomputed region: 12 of its tetrahedra, among them 12, are in parts without enough fixed vertices; "
      "a linear part that turns grows, so fix some of their vertices, let one part have "
      "\"frame\": \"corotated\", or make them tensor-mass or nonlinear");
  CHECK(faults(R"({"regions": [{"model": "precomputed"}], "time": {"integrator": "implicit"}})") ==
        "/regions/0/model: \"model\": \"precomputed\" does not go with \"integrator\": \"implicit\": an "
        "implicit step "
        "solves for every vertex; use \"tensor-mass\"");
  CHECK(faults(R"({"regions": [{"model": "nonlinear", "frame": "corotated"}]})") ==
        "/regions/0/frame: \"corotated\" needs \"model\": \"precomputed\"");
  CHECK(faults(R"({"regions": [{"model": "precomputed", "frame": "corotated", )" + near +
               R"(}, {"model": "precomputed"}]})") ==
        "/regions/1/frame: all precomputed regions have one frame in common; give all of them the same");
}

TEST_CASE("a precomputed region whose interface is wide is warned of, unless it has a frame") {
  const auto warnings_of = [](const std::string& keys, const std::string& where) {
    const Scene plate = scene(R"({"regions": [{"model": "precomputed", )" + keys + "\"where\": " + where +
                              R"(}], "boundary": [{"fix": true, "where": {"plane": {"point": [0, 0, 0],
                              "normal": [0, 0, 1], "within": 1e-9}}}]})");
    return resolve(plate, box_mesh({0.24, 0.24, 0.02}, 24, 24, 2)).warnings;
  };
  const std::string half = R"({"box": {"min": [-1, -1, -1], "max": [1, 1, 0.01]}})";
  const std::vector<std::string> warnings = warnings_of("", half);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].starts_with("/regions: the precomputed region shares 625 vertices with others"));
  CHECK(warnings[0].ends_with("let it end at a narrower part, or make it tensor-mass"));
  CHECK(warnings_of("", R"({"all": true})").empty());
  CHECK(warnings_of(R"("frame": "corotated", )", half).empty());
}

TEST_CASE("regions that the scene leaves to lobe are chosen, unless the caller wants a reference") {
  const Scene automatic = scene(R"({"regions": {"auto": {"tolerance": 0.3}}, "gravity": [0, 0, -0.1]})");
  const Resolved chosen = resolve(automatic, bar());
  REQUIRE(chosen.proposal);
  CHECK(chosen.setup.region_of == chosen.proposal->region_of);
  double last = 0;
  resolve(automatic, bar(), {true, [&](double fraction) { last = fraction; }});
  CHECK(last == 1);
  const Resolved reference = resolve(automatic, bar(), {false});
  CHECK_FALSE(reference.proposal);
  for (const RegionModel model : reference.setup.region_of) CHECK(model == RegionModel::nonlinear);
}

TEST_CASE("reduced regions are corrected above one tolerance in common") {
  const Scene corrected = scene(R"({"regions": [{"model": "reduced", "tolerance": 0.01}]})");
  CHECK(corrected.reduced_tolerance() == 0.01);
  CHECK(json::parse(to_json(corrected))["regions"][0]["tolerance"] == 0.01);
  CHECK_FALSE(scene(R"({"regions": [{"model": "reduced"}]})").reduced_tolerance());
  CHECK(faults(R"({"regions": [{"model": "nonlinear", "tolerance": 0.01}]})") ==
        "/regions/0/tolerance: needs \"model\": \"reduced\"");
  CHECK(faults(R"({"regions": [{"model": "reduced", "tolerance": 0.01, "where": {"tetrahedra": [1]}},
                              {"model": "reduced"}]})") ==
        "/regions/1/tolerance: the error of all reduced regions is estimated together; give all of them the "
        "same");
}

TEST_CASE("a mesh without tetrahedra is refused") {
  CHECK_THROWS_WITH_AS(resolve(scene(), TetMesh{}), "bar.vtu: the mesh has no tetrahedron", InputError);
}

TEST_CASE("the first boundary entry wins at a vertex, conflicts are pointed out") {
  const Resolved result = resolved(R"({"boundary": [
    {"fix": true, "where": {"vertices": [0, 1]}},
    {"displacement": [0, 0, 0], "where": {"vertices": [1]}},
    {"displacement": [0.01, 0, 0], "where": {"vertices": [1, 2]}}]})");
  REQUIRE(result.setup.prescribed.size() == 3);
  CHECK(result.setup.prescribed[1].displacement == Vec3d::Zero());
  CHECK(result.setup.prescribed[2].displacement == Vec3d(0.01, 0, 0));
  CHECK(result.warnings ==
        std::vector<std::string>{"/boundary/2: 1 vertex is moved differently by earlier entries, "
                                 "which win (vertex 1 by /boundary/0)"});
}

TEST_CASE("components that are null stay free, and entries add up to what they prescribe together") {
  const Resolved result = resolved(R"({"boundary": [
    {"displacement": [0, null, null], "where": {"vertices": [0, 1]}},
    {"displacement": [0, 0.01, null], "where": {"vertices": [1, 2]}},
    {"displacement": [0.02, 0.02, null], "where": {"vertices": [2]}}]})");
  REQUIRE(result.setup.prescribed.size() == 3);
  CHECK(result.setup.prescribed[0].axes == Axes{true, false, false});
  CHECK(result.setup.prescribed[1].axes == Axes{true, true, false});
  CHECK(result.setup.prescribed[1].displacement == Vec3d(0, 0.01, 0));
  CHECK(result.setup.prescribed[2].displacement == Vec3d(0, 0.01, 0));
  CHECK(result.warnings ==
        std::vector<std::string>{"/boundary/2: 1 vertex is moved differently by earlier entries, "
                                 "which win (vertex 2 by /boundary/1)"});
  CHECK(faults(R"({"boundary": [{"displacement": [null, null, null], "where": {"vertices": [0]}}]})") ==
        "/boundary/0/displacement: every component is null, so that nothing is prescribed");
}

TEST_CASE("a force is shared equally, a traction lies on boundary faces") {
  const Resolved result =
      resolved("{\"boundary\": [" + clamp + ", {\"force\": [0, 0, -2], \"where\": " + end_face +
               "}, {\"traction\": [0, 7, 0], \"where\": " + end_face + "}]}");
  const Setup& setup = result.setup;
  REQUIRE(setup.vertex_loads.size() == 4);
  for (const VertexLoad& load : setup.vertex_loads) {
    CHECK(load.force == Vec3d(0, 0, -0.5));
    CHECK(setup.mesh.points(0, load.vertex) == near(0.4, 1e-12));
  }
  REQUIRE(setup.face_loads.size() == 2);
  for (const FaceLoad& load : setup.face_loads) {
    CHECK(load.traction == Vec3d(0, 7, 0));
    for (const int corner : face_corners[load.face]) {
      CHECK(setup.mesh.points(0, setup.mesh.tets(corner, load.tet)) == near(0.4, 1e-12));
    }
  }
  CHECK(result.warnings.empty());
}

TEST_CASE("loads without effect are pointed out") {
  CHECK(warnings("{\"boundary\": [" + clamp + R"(, {"force": [1, 0, 0], "where": {"all": true}},
      {"traction": [1, 0, 0], "where": {"all": true}}]})") ==
        "/boundary/1: 4 of the 20 vertices that share the force are fixed: their share has no effect\n"
        "/boundary/2: 2 of the 36 loaded faces have only fixed vertices: their load has no effect");
  CHECK(warnings(R"({"boundary": []})") ==
        "nothing is fixed: the body floats; add {\"fix\": true, \"where\": …} to \"boundary\"");
}

TEST_CASE("tools are resolved, and doubtful ones pointed out") {
  const std::string tools = R"({"tools": [
    {"name": "g", "type": "grasp", "where": {"vertices": [4]}, "path": [[0, 0, 0, 0], [1, 0, 0, 0.1]], "release": true},
    {"name": "c", "type": "cautery", "radius": 0.01, "path": [[0, 0.2, -1, 0.05], [1, 0.2, 1, 0.05]]}]})";
  const Resolved result = resolved(tools);
  CHECK(result.warnings.empty());
  REQUIRE(result.setup.grasps.size() == 1);
  CHECK(result.setup.grasps[0].name == "g");
  CHECK(result.setup.grasps[0].vertices == std::vector<Index>{4});
  CHECK(result.setup.grasps[0].path.size() == 2);
  CHECK(result.setup.grasps[0].release);
  REQUIRE(result.setup.cauteries.size() == 1);
  CHECK(result.setup.cauteries[0].name == "c");
  CHECK(result.setup.cauteries[0].radius == 0.01);
  CHECK(result.setup.cauteries[0].path.at(1).position == Vec3d(0.2, 1, 0.05));
  CHECK(warnings(R"({"tools": [
    {"type": "grasp", "where": {"vertices": [0, 1]}, "path": [[0, 0, 0, 0], [1.5, 0, 0, 0]]},
    {"type": "cautery", "radius": 0.01, "path": [[0, -0.1, 30, 0], [0.5, 0.5, 30, 0]]}]})") ==
        "/tools/0: 1 of the 2 vertices it grasps are held by \"boundary\" in all components, "
        "and stay there\n"
        "/tools/0/path: ends at 1.5 s, after the run's duration of 1 s\n"
        "/tools/1/path: never comes within its radius of the mesh's bounding box");
}

TEST_CASE("a piece that nothing holds is named, one that a held piece or a grasp holds is not") {
  const TetMesh one = box_mesh({0.1, 0.1, 0.1}, 1, 1, 1);
  const auto with_second = [&](double x) {  // another box of six tetrahedra
    TetMesh two = one;
    two.points.conservativeResize(3, 16);
    two.points.rightCols<8>() = one.points.colwise() + Vec3d(x, 0, 0);
    two.tets.conservativeResize(4, 12);
    two.tets.rightCols<6>() = one.tets.array() + 8;
    two.labels.resize(12, 0);
    return two;
  };
  const auto said = [](const TetMesh& mesh, const std::string& more) {
    return resolve(
               parse_scene(R"({"mesh": "m.vtu", "materials": [{"young_modulus": 3e4, "poisson_ratio": 0.3}],
      "boundary": [{"fix": true, "where": {"vertices": [0, 1, 2, 3]}}])" +
                               more + "}",
                           "s"),
               mesh)
        .warnings;
  };
  CHECK(said(with_second(0.15), "") ==
        std::vector<std::string>{
            "/boundary: a piece of 6 tetrahedra, among them 6, is not held and can move freely"});
  CHECK(said(one, "").empty());
  CHECK(said(with_second(0.15),
             R"(, "tools": [{"type": "grasp", "where": {"vertices": [9]}, "path": [[0, 0, 0, 0]]}])")
            .empty());
  TetMesh touching = with_second(0.1);
  for (Index& v : touching.tets.reshaped())
    if (v == 8) v = 1;  // they have the vertex at (0.1, 0, 0) in common
  CHECK(said(touching, "").empty());
}

TEST_CASE("a cautery beside the body at rest is pointed out, unless something may move the body there") {
  const std::string cautery =
      R"("tools": [{"type": "cautery", "radius": 0.01, "path": [[0, -0.1, 0.3, 0], [0.5, 0.5, 0.3, 0]]}])";
  CHECK(warnings("{" + cautery + "}") ==
        "/tools/0/path: never comes within its radius of the mesh's bounding box");
  CHECK(warnings(R"({"gravity": [0, 0, -1], )" + cautery + "}").find("never comes") == std::string::npos);
}

TEST_CASE("a grasp may name copies, which cuts make, beside vertices of the mesh or alone") {
  const Scene read = scene(R"({"tools": [
    {"type": "grasp", "where": {"vertices": [4, 7]}, "copies": [22, 20], "path": [[0, 0, 0, 0]]},
    {"type": "grasp", "where": {"not": {"all": true}}, "copies": [31], "path": [[0, 0, 0, 0], [1, 0, 0, 0.1]]}]})");
  const Setup setup = resolve(parse_scene(to_json(read)), bar()).setup;
  REQUIRE(setup.grasps.size() == 2);
  CHECK(setup.grasps[0].vertices == std::vector<Index>{4, 7, 20, 22});
  CHECK(setup.grasps[1].vertices == std::vector<Index>{31});
  CHECK(gestures_of_grasps(setup).empty());
  World<float> world(setup);  // nothing is cut, so that they are not there
  world.advance(0.001);
  CHECK(world.held().all().size() == setup.prescribed.size() + 2);
  CHECK(
      faults(
          R"({"tools": [{"type": "grasp", "where": {"all": true}, "copies": [19], "path": [[0, 0, 0, 0]]}]})") ==
      "/tools/0/copies: 19 is a vertex of the mesh, which has 20; copies have higher numbers, others belong "
      "to "
      "\"where\"");
  CHECK(faults(R"({"regions": {"auto": {}}, "tools": [
          {"type": "grasp", "where": {"not": {"all": true}}, "copies": [31], "path": [[0, 0, 0, 0]]}]})") ==
        "/tools/0/where: must select a vertex of the mesh if regions are automatic");
}

// The bar has cells of 0.1 m. The quarters of the vertices at x = 0 reach to x = 0.075 at most, so a box up
// to 0.08 holds them wholly, and cuts the quarters of the next ones.
TEST_CASE("what is held by volume is held by shares") {
  const char* by_volume = R"({"boundary": [{"fix": true, "hold_by": "volume",
    "where": {"box": {"min": [-1, -1, -1], "max": [0.08, 1, 1]}}}]})";
  const TetMesh mesh = bar();
  std::vector<double> quarters(std::size_t(mesh.vertex_count()), 0);
  for (Index t = 0; t < mesh.tet_count(); ++t)
    for (const Index v : mesh.tets.col(t)) quarters[std::size_t(v)] += signed_volume(tet_points(mesh, t)) / 4;
  const Resolved held = resolved(by_volume);
  double sum = 0;
  for (const PrescribedVertex& p : held.setup.prescribed) {
    CHECK(mesh.points(0, p.vertex) == 0);
    sum += quarters[std::size_t(p.vertex)];
  }
  for (const PartlyHeldVertex& p : held.setup.partly_held) {
    CHECK(mesh.points(0, p.vertex) == near(0.1, 1e-12));
    CHECK(p.axes == all_axes);
    sum += p.share * quarters[std::size_t(p.vertex)];
  }
  CHECK(sum == near(0.08 * 0.01, 0.02));
  CHECK(held.setup.prescribed.size() == 4);
  CHECK(held.held[0].vertices.size() == 8);
  CHECK(held.warnings.empty());
  CHECK(to_json(parse_scene(to_json(scene(by_volume)))) == to_json(scene(by_volume)));
  CHECK(parse_scene(to_json(scene(by_volume))).boundary[0].hold_by == HoldBy::volume);
}

TEST_CASE("a grasp by area has a share for each vertex, and copies are grasped wholly") {
  const Resolved grasped = resolved(R"({"tools": [{"type": "grasp", "hold_by": "area", "copies": [20],
    "where": {"sphere": {"center": [0.4, 0.05, 0.05], "radius": 0.06}}, "path": [[0, 0, 0, 0]]}]})");
  const GraspSetup& grasp = grasped.setup.grasps[0];
  REQUIRE(grasp.shares.size() == grasp.vertices.size());
  CHECK(grasp.vertices.size() == 5);
  CHECK(grasp.any_partly());
  CHECK(grasp.vertices.back() == 20);
  CHECK(grasp.shares.back() == 1);
}

TEST_CASE("shares are refused where they mean nothing") {
  CHECK(faults(R"({"boundary": [{"force": [0, 0, 1], "hold_by": "area", "where": {"all": true}}]})") ==
        "/boundary/0/hold_by: only \"fix\" and \"displacement\" hold");
  CHECK(faults(R"({"boundary": [{"fix": true, "hold_by": "volume", "where": {"vertices": [0]}}]})")
            .starts_with("/boundary/0/where: names vertices, which have no volume"));
  CHECK(faults(R"({"boundary": [{"fix": true, "hold_by": "volume", "where": {"all": true}}],
                   "time": {"integrator": "implicit"}})")
            .starts_with("/boundary/0/hold_by: \"hold_by\": \"volume\" or \"area\" does not go with"));
}

TEST_CASE("a cautery that only passes through between two points is near") {
  CHECK(
      warnings(
          R"({"tools": [{"type": "cautery", "radius": 0.001, "path": [[0, 0.5, 0.05, 0.05], [1, -0.5, 0.05, 0.05]]}]})")
          .empty());
  CHECK(warnings(R"({"tools": [{"type": "cautery", "radius": 0.001, "path": [[0, 0.2, 0.05, 0.05]]}]})")
            .empty());
  // The corner of the box lies between the two points, but beside their line.
  CHECK(
      !warnings(
           R"({"tools": [{"type": "cautery", "radius": 0.001, "path": [[0, 0.5, 0.05, 0], [1, 0.35, 0.25, 0]]}]})")
           .empty());
}

TEST_CASE("mistakes in units are suspected") {
  const auto contains = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  CHECK(contains(
      warnings("{}", 1000),
      "mesh: its bounding box has a diagonal of 424.3 m; if it is in millimetres, scale it by 0.001: "
      "\"mesh_scale\": 0.001"));
  CHECK(warnings(R"({"mesh_scale": 0.001})", 1000) == warnings("{}"));
  CHECK(contains(warnings("{}", 0.001),
                 "mesh: its bounding box has a diagonal of 0.0004243 m; if it was scaled from millimetres "
                 "twice, scale it by 1000: \"mesh_scale\": 1000"));
  CHECK(warnings(R"({"materials": [{"lame_lambda": 4e4, "lame_mu": 1e4, "density": 1.06}]})") ==
        "/materials/0/density: 1.06 kg/m³ is unlike tissue; if it is in g/cm³, multiply it by 1000");
  CHECK(warnings(R"({"materials": [{"lame_lambda": 4e5, "lame_mu": 1e5, "density": 20000}]})") ==
        "/materials/0/density: 2e+04 kg/m³ is unlike tissue");
  // L² = 0.18 m², sag = 1000 · 9.81 · 0.18 / 10 m
  CHECK(warnings(R"({"materials": [{"young_modulus": 10, "poisson_ratio": 0.3}]})") ==
        "/materials/0: under gravity of 9.81 m/s² a body of 0.4243 m sags by ρ g L²/E = 176.6 m: too soft or "
        "too "
        "large; are moduli in Pa and coordinates in m?");
  CHECK(contains(warnings(R"({"materials": [{"young_modulus": 7e10, "poisson_ratio": 0.3}]})"),
                 "next to nothing: too stiff or too small"));
  CHECK(warnings(
            R"({"materials": [{"young_modulus": 1e4, "poisson_ratio": 0.46, "element": "tetrahedron"}]})") ==
        "/materials/0: Poisson's ratio 0.46: linear tetrahedra lock (respond too stiffly) above 0.45; in "
        "nonlinear regions \"nodal_pressure\": true helps");
  CHECK(warnings(R"({"materials": [{"young_modulus": 1e4, "poisson_ratio": 0.45}]})") == "");
}

TEST_CASE("nodal pressure silences the warning of locking where it acts, and only there") {
  const std::string material =
      R"("materials": [{"young_modulus": 1e4, "poisson_ratio": 0.49, "nodal_pressure": 0.9}])";
  CHECK(warnings("{" + material + "}") == "");
  CHECK(resolved("{" + material + "}").setup.materials[0].nodal_pressure == 0.9);
  CHECK(warnings("{" + material +
                 R"(, "regions": [{"model": "tensor-mass", "where": {"tetrahedra": [3, 4]}}]})") ==
        "/materials/0: Poisson's ratio 0.49: linear tetrahedra lock (respond too stiffly) above 0.45, and "
        "nodal_pressure does not reach 2 tetrahedra in linear or corotational regions");
}

TEST_CASE("a scene says that nothing sleeps, or leaves it to sessions") {
  CHECK_FALSE(parse_scene(R"({"mesh": "a.vtu", "materials": [{"tissue": "liver"}]})").time.sleep);
  const auto said = [](const std::string& sleep) {
    return parse_scene(R"({"mesh": "a.vtu", "materials": [{"tissue": "liver"}], "time": {"sleep": )" + sleep +
                       "}}");
  };
  CHECK(said("false").time.sleep == 0);
  CHECK(said("0").time.sleep == 0);
  CHECK(said("1e-5").time.sleep == 1e-5);
  CHECK(parse_scene(to_json(said("false"))).time.sleep == 0);
  CHECK_THROWS_WITH_AS(said("true"), doctest::Contains("/time/sleep: true does not say by how much"),
                       InputError);
}

TEST_CASE("sleep is refused beside nodal pressure and implicit steps") {
  CHECK(faults(R"({"time": {"sleep": 1e-5, "integrator": "implicit", "precision": "double"}})") ==
        "/time/sleep: \"sleep\" does not go with \"integrator\": \"implicit\": an implicit step solves for "
        "every "
        "vertex; leave it out");
  CHECK(faults(R"({"time": {"sleep": 1e-5},
    "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4, "nodal_pressure": true}]})") ==
        "/time/sleep: \"sleep\" does not go with \"nodal_pressure\": the pressure of a patch depends on its "
        "neighbours; leave one of them out");
}

TEST_CASE("own steps are off unless a scene asks for them, and are refused beside what has none") {
  CHECK_FALSE(resolved("{}").setup.own_steps);
  const Resolved on = resolved(R"({"time": {"own_steps": true}})");
  CHECK(on.setup.own_steps);
  CHECK(on.warnings.empty());
  CHECK(parse_scene(to_json(parse_scene(R"({"mesh": "a.vtu", "materials": [{"tissue": "liver"}],
    "time": {"own_steps": true}})")))
            .time.own_steps);
  CHECK(faults(R"({"time": {"own_steps": true, "selective_mass": 3}})") ==
        "/time/own_steps: \"own_steps\" does not go with \"selective_mass\": selective masses couple all "
        "vertices; leave one of them out");
  CHECK(faults(R"({"time": {"own_steps": true}, "regions": {"auto": {}}})") ==
        "/time/own_steps: \"own_steps\" does not go with \"regions\": {\"auto\": …}: regions that lobe "
        "chooses may be precomputed or reduced; leave one of them out");
}

TEST_CASE("a scene built in code is checked before it is resolved") {
  Scene bad = scene();
  bad.materials[0].lame_mu = -1;
  CHECK_THROWS_WITH_AS(resolve(bad, bar()), "/materials/0/lame_mu: -1.0, must be above 0", InputError);
}

TEST_CASE("gestures of automatic regions are vertices that are moved or loaded") {
  const Resolved result = resolved(R"({"regions": {"auto": {"gestures": [
    {"name": "lift", "where": )" + end_face +
                                   R"(, "displacement": [0, 0, 0.02]},
    {"where": )" + end_face + R"(, "force": [0, 0, -1]}]}}})");
  REQUIRE(result.gestures.size() == 2);
  CHECK(result.gestures[0].name == "lift");
  CHECK(result.gestures[0].vertices.size() == 4);
  CHECK(result.gestures[0].displacements == std::vector<Vec3d>(4, Vec3d(0, 0, 0.02)));
  CHECK(result.gestures[1].displacements.empty());
  CHECK(result.gestures[1].force == Vec3d(0, 0, -1));
  CHECK(result.proposal.has_value());
  const Setup end = at_the_end_of(result.gestures[0], result.setup);
  CHECK(end.prescribed.size() == result.setup.prescribed.size() + 4);
}

TEST_CASE("without gestures the grasps of the scene are the gestures, where they have moved furthest") {
  const Resolved result =
      resolved(R"({"regions": {"auto": {}}, "tools": [{"type": "grasp", "name": "clip", "where": )" +
               end_face + R"(, "path": [[0, 0, 0, 0], [0.5, 0, 0, 0.03], [1, 0, 0, 0.01]]}]})");
  REQUIRE(result.gestures.size() == 1);
  CHECK(result.gestures[0].name == "clip");
  CHECK(result.gestures[0].displacements[0] == Vec3d(0, 0, 0.03));
}

TEST_CASE("automatic regions: what cannot be had is refused at its place") {
  CHECK(
      faults(
          R"({"regions": {"auto": {"gestures": [{"where": {"sphere": {"center": [9, 9, 9], "radius": 1}}, "force": [0, 0, 1]}]}}})") ==
      "/regions/auto/gestures/0/where: selects no vertex" + spans);
  CHECK(
      faults(R"({"regions": {"auto": {}}, "time": {"integrator": "implicit"}})")
          .find("/regions/auto: \"regions\": {\"auto\": …} does not go with \"integrator\": \"implicit\"") ==
      0);
}
