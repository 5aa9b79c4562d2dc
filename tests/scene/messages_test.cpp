// Every message about a scene's text, in the words that the user sees.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "folder.h"
#include "lobe/error.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/tool_kinds.h"

using namespace lobe;

namespace {

std::string message(const std::string& text) {
  try {
    parse_scene(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// A small good scene with some of its keys replaced.
std::string with(const std::string& patch) {
  auto document =
      nlohmann::json::parse(R"({"mesh": "a.vtu", "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4}]})");
  document.update(nlohmann::json::parse(patch));
  return document.dump();
}

struct Case {
  const char* patch;
  std::string expected;
};

void check(const std::vector<Case>& cases) {
  for (const Case& c : cases) {
    CAPTURE(c.patch);
    CHECK(message(with(c.patch)) == c.expected);
  }
}

}  // namespace

TEST_CASE("syntax errors have line and column") {
  CHECK(message("{\n  \"mesh\": \"a\",\n  oops\n}").starts_with("scene.json:3:3: syntax error"));
  CHECK(message("{\"é\": nope}").starts_with("scene.json:1:8: syntax error"));  // columns are characters
  CHECK(message("").starts_with("scene.json:1:1: syntax error"));
  CHECK(message("{} {}").starts_with("scene.json:1:4: syntax error"));
  CHECK(message("{\"volume_penalty\": NaN}").starts_with("scene.json:1:20: syntax error"));
  CHECK(message("{\"volume_penalty\": -Infinity}").starts_with("scene.json:1:21: syntax error"));
  CHECK(message("{\"volume_penalty\": 1e999}").starts_with("scene.json:1:"));
  CHECK(message("{\"volume_penalty\": 1e999}").ends_with("number overflow parsing '1e999'"));
  CHECK(message("{\"mesh\": \"\xff\"}").find("ill-formed UTF-8") != std::string::npos);
  CHECK(message("{\"mesh\": \"a\nb\"}").find('\n') == std::string::npos);
}

TEST_CASE("a mesh in place of a scene is told from a scene with a fault") {
  const test::Folder folder;
  for (const char* name : {"liver.VTU", "liver.stl", "liver.nii.gz"})
    CHECK_THROWS_WITH_AS(
        read_scene(folder.write(name, "solid")),
        doctest::Contains((std::string("is no scene but a mesh, a surface or an image: lobe scene ") + name +
                           " writes a scene for it")
                              .c_str()),
        InputError);
}

TEST_CASE("an integer beyond 64 bits signed is a number, not a negative one") {
  CHECK(message(with(R"({"volume_penalty": 18446744073709551615})")) == "");
}

TEST_CASE("a key given twice is refused") {
  CHECK(
      message(
          R"({"mesh": "a", "materials": [{"density": 1, "name": "b"}, {"density": 2, "density": 3}], "mesh": "b"})") ==
      "/materials/1/density: given twice\n/mesh: given twice");
}

TEST_CASE("hostile texts are refused") {
  CHECK(message(std::string(100000, '[')) == "scene.json: nested more than 64 levels deep");
  std::string deep = R"({"all": true})";
  for (int i = 0; i < 59; ++i) deep = R"({"not": )" + deep + "}";
  const auto region = [&] { return with(R"({"regions": [{"model": "nonlinear", "where": )" + deep + "}]}"); };
  CHECK(message(region()) == "");
  for (int i = 0; i < 5; ++i) deep = R"({"not": )" + deep + "}";
  CHECK(message(region()) == "scene.json: nested more than 64 levels deep");
  CHECK(message(std::string((64u << 20) + 1, ' ')) == "scene.json: longer than 64 MB");
}

TEST_CASE("unknown keys are refused with a suggestion") {
  check({
      {R"({"materials": [{"lame_lambda": 1, "lame_mu": 1, "densty": 1}]})",
       "/materials/0: unknown key \"densty\"; did you mean \"density\"?"},
      {R"({"materials": [{"lame_lambda": 1, "lamemu": 1}]})",
       "/materials/0: unknown key \"lamemu\"; did you mean \"lame_mu\"?"},
      {R"({"output": {"xyz": 1}})", "/output: unknown key \"xyz\"; known here: \"every\", \"pictures\""},
      {R"({"gravty": [0, 0, 0]})", "scene.json: unknown key \"gravty\"; did you mean \"gravity\"?"},
      {R"({"boundary": [{"fix": true, "where": {"bxo": {}}}]})",
       "/boundary/0/where: unknown key \"bxo\"; did you mean \"box\"?"},
      {R"({"tools": [{"type": "cautery", "radius": 1, "path": [[0, 0, 0, 0]], "release": true}]})",
       "/tools/0: unknown key \"release\"; known here: \"core\", \"hook\", \"name\", \"path\", "
       "\"radius\", \"type\""},
      {R"({"a\nb": 1, "time": {"x~/": 1}})",
       "scene.json: unknown key \"a\\nb\"; known here: \"$schema\", \"attachments\", \"bodies\", "
       "\"boundary\", \"comment\", "
       "\"contact\", "
       "\"gravity\", \"guard_below\", \"loose_pieces\", \"materials\", \"mesh\", \"mesh_scale\", \"name\", "
       "\"output\", "
       "\"regions\", \"skin\", \"threads\", \"time\", "
       "\"tools\", \"volume_penalty\"\n"
       "/time: unknown key \"x~/\"; known here: \"cut_step\", \"damping\", \"duration\", \"frame\", "
       "\"integrator\", \"load_ramp\", \"own_steps\", \"precision\", \"ramp\", \"safety\", "
       "\"selective_mass\", \"sleep\", "
       "\"spectral_radius\", \"step\""},
  });
}

TEST_CASE("keys of an earlier format are refused with what to do instead") {
  check({
      {R"({"condensed_cache": "cache"})",
       "/condensed_cache: is gone: leave it out; a region is condensed when the scene is loaded, which takes "
       "0.1 to 0.4 s"},
      {R"({"evaluator": "stored"})",
       "/evaluator: is gone: leave it out; forces are computed in closed form, as by \"direct\", which has "
       "the "
       "same result as \"stored\" and is faster"},
      {R"({"time": {"mass_scaling": 0.01}})",
       "/time/mass_scaling: is gone: use \"selective_mass\", which lengthens steps by more"},
      {R"({"regions": [{"model": "precomputed", "representation": "measured"}]})",
       "/regions/0/representation: is gone: say \"precomputed\" or \"tensor-mass\" as the model, or let lobe "
       "choose: \"regions\": {\"auto\": {}}"},
  });
}

TEST_CASE("the top level needs a mesh and materials") {
  CHECK(message("{}") ==
        "scene.json: needs \"materials\"\nscene.json: needs exactly one of \"mesh\" or \"bodies\"");
  CHECK(message("[]") == "scene.json: [], must be an object");
  CHECK(message("3") == "scene.json: 3, must be an object");
  check({{R"({"mesh": ""})", "/mesh: must not be empty"},
         {R"({"mesh": 3})", "/mesh: 3, must be a string"},
         {R"({"materials": []})", "/materials: 0 items, must be at least 1"},
         {R"({"name": 1})", "/name: 1, must be a string"}});
}

TEST_CASE("materials are one of two pairs, and stable") {
  check({
      {R"({"materials": [{"lame_lambda": 1, "lame_mu": 1}, {"young_modulus": 1, "poisson_ratio": 0.5}]})",
       "/materials/1/poisson_ratio: 0.5, must be below 0.5"},
      {R"({"materials": [{"young_modulus": 0, "poisson_ratio": -1}]})",
       "/materials/0/poisson_ratio: -1, must be above -1\n/materials/0/young_modulus: 0, must be above 0"},
      {R"({"materials": [{"lame_lambda": 1}]})", "/materials/0: \"lame_lambda\" also needs \"lame_mu\""},
      {R"({"materials": [{"poisson_ratio": 0.1}]})",
       "/materials/0: \"poisson_ratio\" also needs \"young_modulus\" or \"tissue\""},
      {R"({"materials": [{}]})",
       "/materials/0: needs exactly one of \"lame_lambda\" with \"lame_mu\", \"young_modulus\" with "
       "\"poisson_ratio\", \"young_modulus_along\" or \"tissue\""},
      {R"({"materials": [{"lame_lambda": 1, "lame_mu": 1, "young_modulus": 1}]})",
       "/materials/0: needs exactly one of \"lame_lambda\" with \"lame_mu\", \"young_modulus\" with "
       "\"poisson_ratio\", \"young_modulus_along\" or \"tissue\", has 2"},
      {R"({"materials": [{"lame_lambda": -2, "lame_mu": 3}]})",
       "/materials/0/lame_lambda: -2, must be above -2/3 lame_mu = -2 (unstable material)"},
      {R"({"materials": [{"lame_lambda": 1, "lame_mu": 0}]})", "/materials/0/lame_mu: 0, must be above 0"},
      {R"({"materials": [{"lame_lambda": 1, "lame_mu": 1, "density": 0}]})",
       "/materials/0/density: 0, must be above 0"},
      {R"({"materials": [{"lame_lambda": "4e4", "lame_mu": 1}]})",
       "/materials/0/lame_lambda: \"4e4\", must be a number"},
      {R"({"materials": [{"lame_lambda": 1, "lame_mu": 1, "nodal_pressure": 1.1}]})",
       "/materials/0/nodal_pressure: 1.1, must be at most 1"},
      {R"({"materials": [{"lame_lambda": 1, "lame_mu": 1, "nodal_pressure": "yes"}]})",
       "/materials/0/nodal_pressure: \"yes\", must be a number or a boolean"},
      {R"({"materials": [{"lame_lambda": -0.5, "lame_mu": 1, "nodal_pressure": true}]})",
       "/materials/0/nodal_pressure: needs lame_lambda of at least 0, not -0.5; leave it out"},
      {R"({"materials": [{"young_modulus": 1e308, "poisson_ratio": 0.4999}]})",
       "/materials/0: too stiff for double precision"},
      {R"({"volume_penalty": -1})", "/volume_penalty: -1, must be at least 0"},
      {R"({"guard_below": 1})", "/guard_below: 1, must be below 1"},
  });
}

TEST_CASE("regions name a model") {
  check({
      {R"({"regions": [{"model": "nonlinaer"}]})",
       "/regions/0/model: \"nonlinaer\", must be \"tensor-mass\", \"precomputed\", \"nonlinear\", "
       "\"reduced\" or \"corotational\"; did you mean \"nonlinear\"?"},
      {R"({"regions": [{}]})", "/regions/0: needs \"model\""},
      {R"({"regions": {"auto": {"gestures": [{"where": {"all": true}}]}}})",
       "/regions/auto/gestures/0: needs exactly one of \"displacement\" or \"force\""},
      {R"({"regions": {"auto": {"gestures": [{"where": {"box": {"min": [0, 2, 0], "max": [1, 1, 1]}}, "force": [0, 0, 1]}]}}})",
       "/regions/auto/gestures/0/where/box/max/1: 1, must be at least min, 2"},
      {R"({"regions": {"auto": {"tolerence": 0.1}}})",
       "/regions/auto: unknown key \"tolerence\"; did you mean \"tolerance\"?"},
      {R"({"regions": {}})", "/regions: needs \"auto\""},
      {R"({"regions": {"auto": {"tolerance": 1}}})", "/regions/auto/tolerance: 1, must be below 1"},
      {R"({"regions": "auto"})", "/regions: \"auto\", must be an array or an object"},
  });
}

TEST_CASE("a boundary entry is one condition and where it acts") {
  check({
      {R"({"boundary": [{"where": {"all": true}}]})",
       "/boundary/0: needs exactly one of \"fix\", \"displacement\", \"traction\", \"force\" or "
       "\"pressure\""},
      {R"({"boundary": [{"fix": true, "force": [0, 0, 1], "where": {"all": true}}]})",
       "/boundary/0: needs exactly one of \"fix\", \"displacement\", \"traction\", \"force\" or "
       "\"pressure\", has 2"},
      {R"({"boundary": [{"fix": true}]})", "/boundary/0: needs \"where\""},
      {R"({"boundary": [{"fix": false, "where": {"all": true}}]})", "/boundary/0/fix: false, must be true"},
      {R"({"boundary": [{"force": [0, 1], "where": {"all": true}}]})",
       "/boundary/0/force: 2 items, must be 3"},
      {R"({"boundary": [{"force": [0, null, 1], "where": {"all": true}}]})",
       "/boundary/0/force/1: null, must be a number"},
      {R"({"gravity": -9.81})", "/gravity: -9.81, must be an array"},
  });
}

TEST_CASE("a selector is one of fourteen, with sensible values") {
  const auto region = [](const std::string& where) {
    return message(with(R"({"regions": [{"model": "nonlinear", "where": )" + where + "}]}"));
  };
  const std::string here = "/regions/0/where";
  const std::string one =
      ": needs exactly one of \"all\", \"all_of\", \"any_of\", \"body\", \"box\", \"label\", \"nearest\", "
      "\"not\", \"patch\", \"plane\", \"sphere\", \"surface\", \"tetrahedra\" or \"vertices\"";
  CHECK(region("{}") == here + one);
  CHECK(region(R"({"all": true, "label": 1})") == here + one + ", has 2");
  CHECK(region("true") == here + ": true, must be an object");
  CHECK(region(R"({"all": false})") == here + "/all: false, must be true");
  CHECK(region(R"({"box": {"min": [0, 0, 0]}})") == here + "/box: needs \"max\"");
  CHECK(region(R"({"box": {"min": [0, 2, 0], "max": [1, 1, 1]}})") ==
        here + "/box/max/1: 1, must be at least min, 2");
  CHECK(region(R"({"sphere": {"center": [0, 0, 0], "radius": 0}})") ==
        here + "/sphere/radius: 0, must be above 0");
  CHECK(region(R"({"plane": {"point": [0, 0, 0], "normal": [0, 0, 0], "within": 1}})") ==
        here + "/plane/normal: has length 0, must be above 0");
  CHECK(region(R"({"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}})") ==
        here + "/plane: needs exactly one of \"within\" or \"side\"");
  CHECK(region(R"({"plane": {"point": [0, 0, 0], "normal": [0, 0, 1], "side": "left"}})") ==
        here + "/plane/side: \"left\", must be \"above\" or \"below\"");
  CHECK(region(R"({"plane": {"point": [0, 0, 0], "normal": [0, 0, 1], "within": -1}})") ==
        here + "/plane/within: -1, must be at least 0");
  CHECK(region(R"({"nearest": {"point": [0, 0, 0], "count": 0}})") ==
        here + "/nearest/count: 0, must be at least 1");
  CHECK(region(R"({"label": 1.5})") == here + "/label: 1.5, must be an integer, a string or an array");
  CHECK(region(R"({"label": []})") == here + "/label: 0 items, must be at least 1");
  CHECK(region(R"({"vertices": [0, -1]})") == here + "/vertices/1: -1, must be at least 0");
  CHECK(region(R"({"tetrahedra": [3000000000]})") ==
        here + "/tetrahedra/0: 3000000000, must be at most 2147483647");
  CHECK(region(R"({"any_of": []})") == here + "/any_of: 0 items, must be at least 1");
  CHECK(region(R"({"all_of": [{"all": true}, {"not": {"bx": 1}}]})") ==
        here + "/all_of/1/not: unknown key \"bx\"; did you mean \"box\"?");
  CHECK(
      region(
          R"({"any_of": [{"not": {"plane": {"point": [0, 0, 0], "normal": [0, 0, 0], "side": "above"}}}]})") ==
      here + "/any_of/0/not/plane/normal: has length 0, must be above 0");
}

namespace {

// "grasp", "cautery" … or "clip_applier"
std::string all_types() {
  std::vector<std::string> types;
  for_each_kind_in_scenes([&](const auto& tool) { types.push_back("\"" + std::string(tool.type) + "\""); });
  std::string text = types.front();
  for (std::size_t i = 1; i < types.size(); ++i) text += (i + 1 < types.size() ? ", " : " or ") + types[i];
  return text;
}

}  // namespace

TEST_CASE("tools need their type's keys and paths that go forward") {
  check({
      {R"({"tools": [{"path": [[0, 0, 0, 0]]}]})", "/tools/0: needs \"type\": " + all_types()},
      {R"({"tools": [{"type": "gasp"}]})",
       "/tools/0/type: \"gasp\", must be " + all_types() + "; did you mean \"grasp\"?"},
      {R"({"tools": [{"type": 1}]})", "/tools/0/type: 1, must be " + all_types()},
      {R"({"tools": [7]})", "/tools/0: 7, must be an object"},
      {R"({"tools": [{"type": "grasp", "where": {"all": true}}]})", "/tools/0: needs \"path\""},
      {R"({"tools": [{"type": "cautery", "path": [[0, 0, 0, 0]]}]})", "/tools/0: needs \"radius\""},
      {R"({"tools": [{"type": "cautery", "radius": 0, "path": [[0, 0, 0, 0]]}]})",
       "/tools/0/radius: 0, must be above 0"},
      {R"({"tools": [{"type": "cautery", "radius": 1, "path": []}]})",
       "/tools/0/path: 0 items, must be at least 1"},
      {R"({"tools": [{"type": "cautery", "radius": 1, "path": [[0, 0, 0]]}]})",
       "/tools/0/path/0: 3 items, must be at least 4"},
      {R"({"tools": [{"type": "cautery", "radius": 1, "path": [[-1, 0, 0, 0], [0, "x", 0, 0]]}]})",
       "/tools/0/path/0/0: -1, must be at least 0\n/tools/0/path/1/1: \"x\", must be a number"},
      {R"({"tools": [{"type": "cautery", "radius": 1,
           "path": [[0, 0, 0, 0], [0.6, 0, 0, 0], [0.7, 0, 0, 0], [0.5, 0, 0, 0]]}]})",
       "/tools/0/path/3/0: time 0.5 goes back (previous 0.7)"},
      {R"({"tools": [{"type": "cautery", "radius": 1, "path": [[0.5, 0, 0, 0], [0.5, 1, 0, 0]]}]})",
       "/tools/0/path/1/0: time 0.5 is given twice; times must increase"},
      {R"({"tools": [{"type": "grasp", "where": {"all": true}, "copies": [7, 8, 7], "path": [[0, 0, 0, 0]]}]})",
       "/tools/0/copies/2: 7 is given twice"},
      {R"({"tools": [{"type": "grasp", "where": {"all": true}, "path": [[0, 0, 0, 0]], "release": 1}]})",
       "/tools/0/release: 1, must be a boolean"},
  });
}

TEST_CASE("times and choices have bounds") {
  check({
      {R"({"time": {"duration": 0, "frame": 0, "damping": -1, "safety": 1.1, "ramp": -1}})",
       "/time/damping: -1, must be at least 0\n/time/duration: 0, must be above 0\n/time/frame: 0, must be "
       "above 0\n"
       "/time/ramp: -1, must be at least 0\n/time/safety: 1.1, must be at most 1"},
      {R"({"time": {"safety": 0}})", "/time/safety: 0, must be above 0"},
      {R"({"time": {"precision": "half"}})", "/time/precision: \"half\", must be \"single\" or \"double\""},
      {R"({"time": {"integrator": "expliit"}})",
       "/time/integrator: \"expliit\", must be \"explicit\" or \"implicit\"; did you mean \"explicit\"?"},
      {R"({"loose_pieces": "drop"})", "/loose_pieces: \"drop\", must be \"fall\", \"vanish\" or \"stay\""},
      {R"({"output": {"every": 0}})", "/output/every: 0, must be above 0"},
      {R"({"output": {"pictures": [0.5, 1.5, -1]}})", "/output/pictures/2: -1, must be at least 0"},
      {R"({"output": {"pictures": [0.5, 1.5]}})", "/output/pictures/1: 1.5, must be at most the duration, 1"},
  });
}

TEST_CASE("long values are cut and many faults are counted") {
  const std::string name = message(with("{\"gravity\": \"" + std::string(1000, 'x') + "\"}"));
  CHECK(name == "/gravity: \"" + std::string(39, 'x') + "…, must be an array");
  std::string many = "[";
  for (int i = 0; i < 150; ++i) many += "true, ";
  const std::string text = message(with("{\"output\": {\"pictures\": " + many + "true]}}"));
  CHECK(std::count(text.begin(), text.end(), '\n') == 100);
  CHECK(text.ends_with("\nscene.json: … and 51 more faults"));
}
