// Scenes that begin at rest: written, read again, loaded, compared with the image.
#include "lobe/scene/rest_scene.h"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "folder.h"
#include "lobe/error.h"
#include "lobe/io/grouped_mesh.h"
#include "lobe/mesh/generators.h"
#include "lobe/mesh/outer_faces.h"
#include "lobe/scene/bind_groups.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/scene_mesh.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;
using nlohmann::json;

namespace {

// A beam that sags by some millimetres under its weight.
json sagging(const json& patch = json::object()) {
  json scene = json::parse(R"({
    "mesh": "beam.vtu",
    "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4, "density": 1000}],
    "boundary": [{"fix": true, "where": {"box": {"min": [-1, -1, -1], "max": [0, 1, 1]}}}],
    "gravity": [0, 0, -9.81]
  })");
  scene.update(patch);
  return scene;
}

TetMesh beam_at_z(double z) {
  TetMesh mesh = box_mesh({0.08, 0.02, 0.02}, 8, 2, 2);
  for (Index t = 0; t < mesh.tet_count(); ++t) mesh.labels[std::size_t(t)] = 1 + t % 3;
  mesh.points.row(2).array() += z;
  return mesh;
}

struct Loaded {
  Scene scene;
  MeshFile file;
  Setup setup;
};

Loaded load_scene(const std::filesystem::path& path) {
  Loaded loaded{read_scene(path), {}, {}};
  loaded.file = read_scene_mesh(loaded.scene);
  bind_groups(loaded.file, loaded.scene);
  loaded.setup = resolve(loaded.scene, loaded.file.mesh, {false}).setup;
  return loaded;
}

struct Trip {
  RestScene found;
  Loaded image, rest;  // the scene that was given, and the one that was written, as they are read
  std::vector<std::filesystem::path> files;
};

// Finds the scene at rest, writes it, reads it, and puts its loads on: the image comes back.
Trip round_trip_of(const Folder& folder, const json& scene) {
  Trip trip{{}, load_scene(folder.write("image.json", scene.dump())), {}, {}};
  trip.found = find_rest_scene(trip.image.scene, trip.image.file, trip.image.setup, {.tolerance = 1e-8});
  REQUIRE_MESSAGE(trip.found.shape.converged, trip.found.shape.reason);
  std::filesystem::create_directories(folder.path / "out");
  trip.files = write_rest_scene(folder.path / "out" / "rest.json", trip.found, trip.image.file);
  trip.rest = load_scene(folder.path / "out" / "rest.json");
  CHECK(trip.rest.setup.mesh.points == trip.found.shape.points);
  CHECK(trip.rest.setup.mesh.tets == trip.image.setup.mesh.tets);
  CHECK(trip.rest.setup.mesh.labels == trip.image.setup.mesh.labels);
  const StaticResult back = solve_static(trip.rest.setup);
  REQUIRE(back.converged);
  CHECK(back.u.colwise().norm().maxCoeff() > 1e-3);
  const Mat3X<double> off = trip.rest.setup.mesh.points + back.u - trip.image.setup.mesh.points;
  CHECK(off.colwise().norm().maxCoeff() < 1e-7);
  return trip;
}

bool has_note(const RestScene& found, const std::string& place) {
  return std::any_of(found.notes.begin(), found.notes.end(),
                     [&](const std::string& note) { return note.starts_with(place + ":"); });
}

}  // namespace

TEST_CASE("what a scene selects by place is the same tissue in the scene at rest") {
  const Folder folder;
  write_vtu(folder.path / "beam.vtu", beam_at_z(0));
  const json scene = sagging(json::parse(R"({
    "materials": [{"lame_lambda": 8e4, "lame_mu": 2e4, "where": {"box": {"min": [0, 0, 0], "max": [1, 1, 0.0101]}}},
                  {"lame_lambda": 4e4, "lame_mu": 1e4}],
    "regions": [{"model": "tensor-mass", "where": {"plane": {"point": [0, 0, 0.0101], "normal": [0, 0, 1], "side": "below"}}}],
    "boundary": [{"fix": true, "where": {"box": {"min": [-1, -1, -1], "max": [0, 1, 1]}}},
                 {"traction": [0, 0, -20], "where": {"plane": {"point": [0, 0, 0.02], "normal": [0, 0, 1], "within": 1e-6}}},
                 {"pressure": 30, "where": {"plane": {"point": [0.08, 0, 0], "normal": [1, 0, 0], "within": 1e-6}}},
                 {"force": [0, 0.002, 0], "where": {"nearest": {"point": [0.09, 0, 0.03], "count": 3}}}]})"));
  const Trip trip = round_trip_of(folder, scene);
  CHECK(trip.found.warnings.empty());
  for (const char* place : {"/materials/0", "/regions/0", "/boundary/1", "/boundary/2"})
    CHECK_MESSAGE(has_note(trip.found, place), place);
  CHECK_FALSE(has_note(trip.found, "/boundary/0"));  // what is held stays in its place
  CHECK(trip.rest.setup.material_of == trip.image.setup.material_of);
  CHECK(trip.rest.setup.region_of == trip.image.setup.region_of);
  CHECK(trip.rest.setup.face_loads.size() == trip.image.setup.face_loads.size());
  CHECK(trip.rest.setup.pressures.size() == trip.image.setup.pressures.size());
  CHECK(trip.rest.setup.vertex_loads == trip.image.setup.vertex_loads);
}

TEST_CASE("shares of held vertices and fields of fibres are those of the shape at rest") {
  const Folder folder;
  write_vtu(folder.path / "beam.vtu", beam_at_z(0));
  const json scene = sagging(json::parse(R"({
    "materials": [{"law": "holzapfel", "lame_lambda": 4e4, "lame_mu": 1e4, "holzapfel_k1": 1e4, "holzapfel_k2": 1,
                   "holzapfel_angle": 0,
                   "fibre": {"harmonic": {"from": {"box": {"min": [-1, -1, -1], "max": [0, 1, 1]}},
                                          "to": {"box": {"min": [0.079, -1, -1], "max": [1, 1, 1]}}}}}],
    "boundary": [{"fix": true, "hold_by": "volume", "where": {"box": {"min": [-1, -1, -1], "max": [0.0134, 1, 1]}}}]})"));
  const Trip trip = round_trip_of(folder, scene);
  CHECK(trip.found.shape.iterations > 1);
  CHECK(trip.rest.setup.partly_held.size() > 4);
  CHECK((trip.rest.setup.mesh.fibres - trip.image.setup.mesh.fibres).norm() > 1e-3);
}

TEST_CASE("bodies, arrays, fibres, threads and scales come along") {
  const Folder folder;
  TetMesh first = beam_at_z(0), second = beam_at_z(0.05);
  second.points *= 1000;
  second.fibres = Vec3d(0, 0, 1).replicate(1, second.tet_count());
  write_vtu(folder.path / "beam.vtu", first, {{"depth", first.points.row(2)}},
            {{"grey", first.points.row(0).leftCols(1).replicate(1, first.tet_count())}});
  write_vtu(folder.path / "second.vtu", second);
  const Trip one = round_trip_of(folder, sagging(json::parse(R"({"threads": [{"stitches": [
      {"through": [[0.06, 0.005, 0.01], [0.07, 0.005, 0.01]], "at": 0.5}]}]})")));
  CHECK(one.rest.file.point_data.at("depth") == one.image.file.point_data.at("depth"));
  CHECK(one.rest.file.cell_data.at("grey") == one.image.file.cell_data.at("grey"));
  const Vec3d before = one.image.scene.threads[0].stitches[0].through[1],
              after = one.rest.scene.threads[0].stitches[0].through[1];
  CHECK(after.z() > before.z() + 1e-3);
  const Trip two = round_trip_of(folder, [&] {
    json scene = sagging();
    scene.erase("mesh");
    scene["bodies"] = json::parse(R"([{"name": "a", "mesh": "beam.vtu"},
      {"name": "b", "mesh": "second.vtu", "mesh_scale": 0.001, "position": [0, 0.1, 0]}])");
    return scene;
  }());
  CHECK(two.files.size() == 3);
  CHECK(two.rest.scene.bodies[1].mesh_scale == 1);
  CHECK(two.rest.file.mesh.fibres == two.image.file.mesh.fibres);
}

TEST_CASE("groups of surfaces and names of labels stay in the file") {
  const Folder folder;
  const TetMesh mesh = beam_at_z(0);
  Groups groups{{{7, "held", {}}, {8, "top", {}}}, {{1, "liver"}, {2, "tumour"}, {3, "vessel"}}};
  for (const TetFace& face : outer_faces(mesh)) {
    std::array<Index, 3> triangle{};
    for (int k = 0; k < 3; ++k) triangle[std::size_t(k)] = mesh.tets(face_corners[face.face][k], face.tet);
    const auto on = [&](int axis, double at) {
      return std::all_of(triangle.begin(), triangle.end(),
                         [&](Index v) { return std::abs(mesh.points(axis, v) - at) < 1e-9; });
    };
    if (on(0, 0)) groups.surfaces[0].triangles.push_back(triangle);
    if (on(2, 0.02)) groups.surfaces[1].triangles.push_back(triangle);
  }
  write_grouped_mesh(folder.path / "beam.msh", mesh, groups);
  const Trip trip = round_trip_of(folder, sagging(json::parse(R"({"mesh": "beam.msh",
    "materials": [{"lame_lambda": 8e4, "lame_mu": 2e4, "where": {"label": "tumour"}},
                  {"lame_lambda": 4e4, "lame_mu": 1e4}],
    "boundary": [{"fix": true, "where": {"surface": "held"}}, {"pressure": 20, "where": {"surface": "top"}}]})")));
  CHECK(trip.found.notes.empty());
  CHECK(trip.files[1].extension() == ".msh");
  CHECK(trip.rest.file.surfaces.size() == 2);
  CHECK(trip.rest.file.label_names == trip.image.file.label_names);
}
