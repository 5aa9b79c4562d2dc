#include "lobe/scene/tissues.h"

#include <doctest/doctest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "lobe/error.h"
#include "lobe/scene/explain.h"
#include "lobe/scene/material_constants.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/schema.h"
#include "near.h"
#include "scene/validator.h"

using namespace lobe;
using namespace lobe::test;
using nlohmann::json;

namespace {

json scene_of(const std::string& material) {
  return {{"mesh", "organ.vtu"}, {"materials", json::array({json::parse(material)})}};
}

Material material_of(const std::string& material) {
  return parse_scene(scene_of(material).dump()).materials.at(0);
}

}  // namespace

TEST_CASE("a tissue stands for its modulus, Poisson's ratio, density and name") {
  const Material liver = material_of(R"({"tissue": "liver"})");
  CHECK(liver.name == "liver");
  CHECK(liver.density == 1060);
  CHECK(liver.lame_mu == near(1800, 1e-12));  // the published shear modulus
  CHECK(poisson_ratio(liver.lame_lambda, liver.lame_mu) == near(0.45, 1e-12));
  CHECK(young_modulus(liver.lame_lambda, liver.lame_mu) == near(5220, 1e-12));
}

TEST_CASE("keys beside a tissue override it") {
  const Material stiff = material_of(R"({"tissue": "kidney", "young_modulus": 8e3, "name": "graft"})");
  CHECK(stiff.name == "graft");
  CHECK(stiff.density == 1050);
  CHECK(young_modulus(stiff.lame_lambda, stiff.lame_mu) == near(8000, 1e-12));
  CHECK(poisson_ratio(stiff.lame_lambda, stiff.lame_mu) == near(0.45, 1e-12));
  const Material nearly = material_of(R"({"tissue": "kidney", "poisson_ratio": 0.3, "density": 900})");
  CHECK(nearly.density == 900);
  CHECK(young_modulus(nearly.lame_lambda, nearly.lame_mu) == near(5000, 1e-12));
  CHECK(poisson_ratio(nearly.lame_lambda, nearly.lame_mu) == near(0.3, 1e-12));
  const Material lame = material_of(R"({"tissue": "kidney", "lame_lambda": 3e4, "lame_mu": 2e4})");
  CHECK(lame.lame_lambda == 3e4);
  CHECK(lame.lame_mu == 2e4);
  CHECK(lame.density == 1050);
}

TEST_CASE("a tissue that is not known is refused with the nearest name") {
  try {
    parse_scene(scene_of(R"({"tissue": "livr"})").dump());
    FAIL("accepted");
  } catch (const InputError& error) {
    const std::string text = error.what();
    CHECK(text.starts_with("/materials/0/tissue: \"livr\", must be \"bile-duct\""));
    CHECK(text.ends_with("did you mean \"liver\"?"));
  }
}

TEST_CASE("what does not go together beside a tissue is refused by the schema and explained") {
  const json schema = json::parse(scene_schema());
  const auto accepts = [&](const std::string& material) {
    CAPTURE(material);
    const json document = scene_of(material);
    const bool satisfied = satisfies_scene_schema(document);
    CHECK(satisfied == explain(document, schema).empty());
    return satisfied;
  };
  const std::vector<std::string> keys = {
      R"("tissue": "liver")",
      R"("lame_lambda": 1e4)",
      R"("lame_mu": 1e4)",
      R"("young_modulus": 1e4)",
      R"("poisson_ratio": 0.4)",
      R"("density": 1000)",
      R"("fibre": {"direction": [1, 0, 0]}, "young_modulus_along": 1e4, "young_modulus_across": 5e3,
         "poisson_ratio_along": 0.3, "poisson_ratio_across": 0.3, "shear_modulus_along": 3e3)"};
  int accepted = 0;
  for (unsigned chosen = 0; chosen < 1u << keys.size(); ++chosen) {
    std::string text;
    for (std::size_t i = 0; i < keys.size(); ++i)
      if (chosen >> i & 1u) text += (text.empty() ? "" : ", ") + keys[i];
    accepted += accepts("{" + text + "}");
  }
  // One of three sets, with a tissue or without; a tissue alone, or with E or ν. Each with density or not.
  CHECK(accepted == 2 * (3 * 2 + 3));
}

TEST_CASE("the schema and the page have all tissues, in order") {
  const json known = json::parse(scene_schema())["definitions"]["material"]["properties"]["tissue"]["enum"];
  std::ostringstream page;
  page << std::ifstream(LOBE_DOCS_DIR "/tissues.md").rdbuf();
  std::vector<std::string> names;
  for (const Tissue& tissue : tissues()) {
    const std::string name(tissue.name);
    CAPTURE(name);
    names.push_back(name);
    CHECK(find_tissue(name) == &tissue);
    CHECK(tissue.young_modulus > 100);
    CHECK(tissue.spread < tissue.young_modulus);
    CHECK(tissue.density >= 950);
    std::ostringstream row;
    row.precision(4);
    row << "| `" << name << "` | " << tissue.young_modulus / 1000;
    if (tissue.spread > 0) row << " ± " << tissue.spread / 1000;
    row << " | " << tissue.density << " | " << tissue.measured << " | ";
    CHECK(page.str().find(row.str()) != std::string::npos);
    CHECK(page.str().find(tissue.source) != std::string::npos);
    CHECK(page.str().find(tissue.density_source) != std::string::npos);
  }
  CHECK(std::is_sorted(names.begin(), names.end()));
  CHECK(known == json(names));
  CHECK(find_tissue("marble") == nullptr);
}
