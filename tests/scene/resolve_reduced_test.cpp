// Where lobe makes all of a body one reduced region, and where it does not.
#include <doctest/doctest.h>

#include <algorithm>

#include "lobe/io/mesh_io.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr char usual[] = R"({"lame_lambda": 4e4, "lame_mu": 1e4})";

Resolved chosen(const TetMesh& mesh, const std::string& materials = usual) {
  return resolve(parse_scene(R"({"mesh": "m.vtu",
      "boundary": [{"fix": true, "where": {"box": {"min": [-1, -1, -1], "max": [0, 1, 1]}}}],
      "regions": {"auto": {"reduced": true, "correct": true, "tolerance": 0.03}},
      "time": {"selective_mass": 12}, "materials": [)" +
                             materials + "]}"),
                 mesh);
}

TetMesh bar(int across) { return box_mesh({0.4, 0.1, 0.1}, 4 * across, across, across); }

bool is_reduced(RegionModel model) { return model == RegionModel::reduced; }

void check_reduced(const Resolved& resolved) {
  const auto& models = resolved.setup.region_of;
  CHECK(std::all_of(models.begin(), models.end(), is_reduced));
  CHECK(resolved.setup.selective_mass == 1);
  REQUIRE(resolved.proposal);
  CHECK(resolved.proposal->region_of == models);
}

// Nothing is, and why.
std::string reason(const Resolved& resolved) {
  const auto& models = resolved.setup.region_of;
  CHECK(std::none_of(models.begin(), models.end(), is_reduced));
  CHECK(resolved.setup.selective_mass == 12);
  const std::string start = "/regions/auto/reduced: nothing is reduced: ";
  for (const std::string& warning : resolved.warnings)
    if (warning.starts_with(start)) return warning.substr(start.size());
  return "";
}

}  // namespace

TEST_CASE("automatic regions are reduced where the mesh is fine enough for it") {
  check_reduced(chosen(bar(12)));
  const std::string coarse = "a cell of the lattice has the volume of ";
  CHECK(reason(chosen(bar(4))).starts_with(coarse));
  const std::string of_liver = reason(chosen(read_mesh(LOBE_DATA_DIR "/meshes/liver_10k.vtu").mesh));
  REQUIRE(of_liver.starts_with(coarse));
  CHECK(std::stod(of_liver.substr(coarse.size())) == near(33, 0.03));
}

TEST_CASE("automatic regions are not reduced with what reduced regions do not go with") {
  const std::string why =
      reason(chosen(bar(12), R"({"lame_lambda": 4e4, "lame_mu": 1e4, "nodal_pressure": true})"));
  CHECK(why.find("does not go with \"nodal_pressure\"") != std::string::npos);
}

TEST_CASE("automatic regions are not reduced where a tissue's tetrahedra lock") {
  const auto tissue = [](const std::string& nu, const std::string& where) {
    return R"({"young_modulus": 3e4, "poisson_ratio": )" + nu + where + "}";
  };
  const std::string end = R"(, "where": {"sphere": {"center": [0.4, 0.05, 0.05], "radius": 0.05}})";
  check_reduced(chosen(bar(12), tissue("0.45", "")));
  for (const std::string& materials : {tissue("0.49", ""), tissue("0.3", "") + ", " + tissue("0.49", end)})
    CHECK(reason(chosen(bar(12), materials)) ==
          "Poisson's ratio is 0.49, and above 0.45 linear tetrahedra lock; use \"nonlinear\" with "
          "\"nodal_pressure\": true");
}
