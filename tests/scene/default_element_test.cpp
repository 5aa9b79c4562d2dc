// Which element a scene gets that names none, and what it gets where it names one.
#include "lobe/scene/default_element.h"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "lobe/error.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/write_scene.h"
#include "lobe/solve/static_solver.h"

using namespace lobe;
using nlohmann::json;

namespace {

const TetMesh two_cells = box_mesh({0.2, 0.1, 0.1}, 2, 1, 1);

json held_scene(const json& material, const json& rest) {
  json document = {
      {"mesh", "bar.vtu"},
      {"materials", {{{"young_modulus", 1e4}, {"poisson_ratio", 0.4}}}},
      {"boundary", {{{"fix", true}, {"where", {{"box", {{"min", {-1, -1, -1}}, {"max", {0, 1, 1}}}}}}}}},
      {"gravity", {0, 0, -9.81}}};
  document["materials"][0].update(material);
  document.update(rest);
  return document;
}

Setup setup_of(const json& material, const json& rest = json::object()) {
  return resolve(parse_scene(held_scene(material, rest).dump()), two_cells, {false}).setup;
}

const Elastic& only(const Setup& setup) { return setup.materials.at(0); }

json with_model(const char* model) { return {{"regions", {{{"model", model}}}}}; }

}  // namespace

TEST_CASE("a scene that names no element has edge-smoothed tetrahedra, and one that names one has that") {
  CHECK(only(setup_of(json::object())).is_smoothed());
  CHECK(only(setup_of({{"element", "edge-smoothed"}})).is_smoothed());
  CHECK_FALSE(only(setup_of({{"element", "tetrahedron"}})).is_smoothed());
  const auto sag = [](const json& material) { return -solve_static(setup_of(material)).u.row(2).minCoeff(); };
  CHECK(sag(json::object()) > 1.2 * sag({{"element", "tetrahedron"}}));
}

TEST_CASE("every model takes the default but a reduced one") {
  for (const char* model : {"nonlinear", "tensor-mass", "precomputed", "corotational"})
    CHECK_MESSAGE(only(setup_of(json::object(), with_model(model))).is_smoothed(), model);
  CHECK(only(setup_of(json::object(), {{"regions", {{"auto", json::object()}}}})).is_smoothed());
  CHECK(only(setup_of(json::object(), {{"time", {{"integrator", "implicit"}, {"precision", "double"}}}}))
            .is_smoothed());
  CHECK_FALSE(only(setup_of(json::object(), {{"regions", {{"auto", {{"reduced", true}}}}}})).is_smoothed());
  CHECK_FALSE(
      with_default_element(parse_scene(held_scene(json::object(), with_model("reduced")).dump()), Material{})
          .element == ElementType::edge_smoothed);
}

TEST_CASE("near incompressibility smoothed tetrahedra have nodal pressure unless the scene says otherwise") {
  const auto nearly = [](json more = json::object()) {
    more["poisson_ratio"] = 0.49;
    return more;
  };
  CHECK(only(setup_of({{"poisson_ratio", 0.45}})).nodal_pressure == 0);
  CHECK(only(setup_of(nearly())).nodal_pressure == 1);
  CHECK(only(setup_of(nearly({{"nodal_pressure", 0}}))).nodal_pressure == 0);
  CHECK(only(setup_of(nearly({{"nodal_pressure", 0.5}}))).nodal_pressure == 0.5);
  CHECK(only(setup_of(nearly({{"element", "edge-smoothed"}}))).nodal_pressure == 1);
  CHECK(only(setup_of(nearly({{"law", "neo-hookean"}}))).nodal_pressure == 1);
  CHECK(only(setup_of(nearly({{"element", "tetrahedron"}}))).nodal_pressure == 0);
}

TEST_CASE("nodal pressure is no default beside what it does not go with") {
  const json nearly = {{"poisson_ratio", 0.49}};
  CHECK(only(setup_of(nearly, {{"time", {{"sleep", 1e-5}}}})).nodal_pressure == 0);
  CHECK(only(setup_of(nearly, with_model("precomputed"))).nodal_pressure == 0);
  CHECK(only(setup_of(nearly, with_model("tensor-mass"))).nodal_pressure == 1);
}

TEST_CASE("a scene that names no element names none when it is written") {
  const json plain = json::parse(to_json(parse_scene(held_scene(json::object(), json::object()).dump())));
  CHECK_FALSE(plain["materials"][0].contains("element"));
  CHECK_FALSE(plain["materials"][0].contains("nodal_pressure"));
  const json named = json::parse(to_json(
      parse_scene(held_scene({{"element", "tetrahedron"}, {"nodal_pressure", 0}}, json::object()).dump())));
  CHECK(named["materials"][0]["element"] == "tetrahedron");
  CHECK(named["materials"][0]["nodal_pressure"] == 0.0);
}
