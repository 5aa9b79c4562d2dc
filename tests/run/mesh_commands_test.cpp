// lobe info, convert, refine, rest, fit and sensitivity as their callers use them.
#include <doctest/doctest.h>

#include "lobe/io/grouped_mesh.h"
#include "lobe/mesh/quality.h"
#include "lobe/scene/material_constants.h"
#include "lobe/text.h"
#include "lobe_command.h"
#include "near.h"
#include "run/small_scene.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("lobe info counts and measures a mesh") {
  const Folder folder;
  write_scene_files(folder);
  const Ended ended = lobe_in(folder, "info beam.vtu --json");
  REQUIRE_MESSAGE(ended.status == 0, ended.err);
  const Json info = Json::parse(ended.out);
  CHECK(info["vertices"] == 9 * 3 * 3);
  CHECK(info["tetrahedra"] == 192);
  for (const char* label : {"0", "1", "2", "3", "4", "5"}) CHECK(info["labels"][label] == 32);
  CHECK(info["volume_m3"].get<double>() == near(0.08 * 0.02 * 0.02, 1e-12));
  CHECK(info["smallest_tetrahedron_m3"].get<double>() == near(1e-6 / 6, 1e-9));
  CHECK(info["bounding_box_m"] == Json::parse(R"({"min": [0.0, 0.0, 0.0], "max": [0.08, 0.02, 0.02]})"));
  CHECK(info["dihedral_deg"]["smallest"].get<double>() == near(45, 1e-12));
  CHECK(info["dihedral_deg"]["largest"].get<double>() == near(90, 1e-12));
  int angles = 0;
  for (const Json& count : info["dihedral_histogram_10_deg"]) angles += count.get<int>();
  CHECK(angles == 6 * 192);
  const double step = info["stable_time_step_s"];
  CHECK(step > 0);
  const Json heavy = Json::parse(lobe_in(folder, "info beam.vtu --json --density 4000").out);
  CHECK(heavy["stable_time_step_s"].get<double>() == near(2 * step, 1e-12));  // ∝ √ρ
  CHECK(lobe_in(folder, "info beam.vtu").out.find("tetrahedra          192\n") != std::string::npos);
}

TEST_CASE("lobe convert scales a mesh, and lobe info and a scene say what a mesh in millimetres lacks") {
  const Folder folder;
  write_scene_files(folder);
  TetMesh mesh = beam_mesh();
  const TetMesh in_metres = mesh;
  mesh.points *= 1000;
  DataArray of_vertex{"number", Eigen::MatrixXd(1, mesh.vertex_count())};
  for (Index v = 0; v < mesh.vertex_count(); ++v) of_vertex.values(0, v) = v;
  write_vtu(folder.path / "mm.vtu", mesh, {of_vertex});
  const Ended info = lobe_in(folder, "info mm.vtu");
  CHECK(info.status == 0);
  CHECK(info.err ==
        "lobe: warning: its bounding box has a diagonal of 84.85 m; if it is in millimetres, scale it by "
        "0.001: lobe convert --scale, or \"mesh_scale\" in the scene\n");
  const Ended ended = lobe_in(folder, "convert mm.vtu -o m.vtu --scale 0.001");
  CHECK(ended.status == 0);
  CHECK(ended.out == "81 vertices, 192 tetrahedra, 0.08 × 0.02 × 0.02 m\nwritten to m.vtu\n");
  const MeshFile read = read_mesh(folder.path / "m.vtu");
  CHECK((read.mesh.points - in_metres.points).norm() < 1e-15);
  CHECK(read.mesh.labels == in_metres.labels);
  CHECK(read.point_data.at("number") == of_vertex.values);
  CHECK(lobe_in(folder, "info m.vtu").err.empty());
  CHECK(lobe_in(folder, "convert mm.vtu -o mm.msh").status == 0);
  CHECK(read_mesh(folder.path / "mm.msh").mesh.points == mesh.points);
  for (const char* wrong : {"mm.vtu -o a.txt", "none.vtu -o a.vtu", "mm.vtu -o a.vtu --scale 0", "mm.vtu"}) {
    CAPTURE(wrong);
    CHECK(lobe_in(folder, std::string("convert ") + wrong).status == 2);
  }
}

TEST_CASE("lobe refine keeps the body, its labels and its arrays, and stops at the number asked for") {
  const Folder folder;
  const TetMesh mesh = beam_mesh();
  DataArray of_vertex{"place", 2 * mesh.points}, of_tet{"number", Eigen::MatrixXd(1, mesh.tet_count())};
  for (Index t = 0; t < mesh.tet_count(); ++t) of_tet.values(0, t) = t + 0.25;
  write_vtu(folder.path / "beam.vtu", mesh, {of_vertex}, {of_tet});
  const Ended ended = lobe_in(folder, "refine beam.vtu -o fine.vtu --tets 1537");  // 8 × 192 = 1536
  REQUIRE_MESSAGE(ended.status == 0, ended.err);
  CHECK(ended.out.starts_with("192 tetrahedra became 12288, "));
  const MeshFile fine = read_mesh(folder.path / "fine.vtu");
  REQUIRE(fine.mesh.tet_count() == 64 * 192);
  CHECK(fine.prepared.warnings().empty());
  CHECK(total_volume(fine.mesh) == near(total_volume(mesh), 1e-12));
  CHECK((fine.point_data.at("place") - 2 * fine.mesh.points).norm() < 1e-15);
  for (Index t = 0; t < fine.mesh.tet_count(); ++t) {
    CHECK(fine.cell_data.at("number")(0, t) == t / 64 + 0.25);
    CHECK(fine.mesh.labels[std::size_t(t)] == t / 64 % 6);
  }
  lobe_in(folder, "refine beam.vtu -o twice.vtu --times 2");
  CHECK(bytes_of(folder.path / "twice.vtu") == bytes_of(folder.path / "fine.vtu"));
}

TEST_CASE("lobe refine and lobe convert keep groups of surfaces and names, and say where they cannot") {
  const Folder folder;
  const TetMesh mesh = beam_mesh();
  Groups groups{{{11, "held", {}}}, {{1, "soft"}}};
  for (const auto& tet : mesh.tets.colwise())
    for (int skipped = 0; skipped < 4; ++skipped) {
      std::vector<Index> face;
      for (int k = 0; k < 4; ++k)
        if (k != skipped && mesh.points(0, tet[k]) == 0) face.push_back(tet[k]);
      if (face.size() == 3) groups.surfaces[0].triangles.push_back({face[0], face[1], face[2]});
    }
  REQUIRE(groups.surfaces[0].triangles.size() == 8);
  write_grouped_mesh(folder.path / "beam.msh", mesh, groups);
  const Ended kept = lobe_in(folder, "refine beam.msh -o fine.vtu");
  CHECK(kept.err == "");
  const MeshFile fine = read_mesh(folder.path / "fine.vtu");
  REQUIRE(fine.surfaces.size() == 1);
  CHECK(fine.surfaces[0].name == "held");
  CHECK(fine.surfaces[0].triangles.size() == 4 * 8);
  for (const auto& triangle : fine.surfaces[0].triangles)
    for (const Index v : triangle) CHECK(fine.mesh.points(0, v) == 0);
  CHECK(fine.label_names == groups.label_names);
  CHECK(lobe_in(folder, "info fine.vtu").out.find("  surface 11        32 triangles \"held\"\n") !=
        std::string::npos);
  CHECK(lobe_in(folder, "convert fine.vtu -o fine.msh2").err == "");
  CHECK(read_mesh(folder.path / "fine.msh2").surfaces[0].triangles.size() == 4 * 8);
  CHECK(lobe_in(folder, "convert beam.msh -o a.mesh").err ==
        "lobe: warning: a.mesh: .mesh holds the numbers of groups and labels, not their names\n");
  CHECK(
      lobe_in(folder, "refine beam.msh -o a.vtk").err ==
      "lobe: warning: a.vtk: the groups of surfaces and the names of labels are left out; .vtu and .msh hold "
      "them\n");
}

TEST_CASE("lobe refine warns where arrays are lost, and refuses what it cannot do") {
  const Folder folder;
  write_vtu(folder.path / "beam.vtu", beam_mesh(), {{"x", beam_mesh().points}});
  const Ended text = lobe_in(folder, "refine beam.vtu -o fine.msh");
  CHECK(text.status == 0);
  CHECK(text.err == "lobe: warning: fine.msh: only .vtu holds arrays; those of the mesh are left out\n");
  CHECK(read_mesh(folder.path / "fine.msh").mesh.tet_count() == 8 * 192);
  for (const char* wrong : {"beam.vtu -o fine.txt", "missing.vtu -o a.vtu", "beam.vtu -o a.vtu --times 0",
                            "beam.vtu -o a.vtu --times 1 --tets 10"}) {
    const Ended refused = lobe_in(folder, std::string("refine ") + wrong);
    CAPTURE(wrong);
    CHECK(refused.status == 2);
    CHECK(refused.err.starts_with("lobe: error: "));
    CHECK(!std::filesystem::exists(folder.path / "a.vtu"));
  }
}

TEST_CASE("lobe rest writes the unloaded shape, from which the loads lead back") {
  const Folder folder;
  write_scene_files(folder);
  const TetMesh given = read_mesh(folder.path / "beam.vtu").mesh;
  const Ended ended = lobe_in(folder, "rest scene.json -o rest.vtu --tolerance 1e-9");
  REQUIRE_MESSAGE(ended.status == 0, ended.err);
  CHECK(ended.err.find("tools are ignored") != std::string::npos);
  const MeshFile rest = read_mesh(folder.path / "rest.vtu");
  const Eigen::MatrixXd back = rest.mesh.points + rest.point_data.at("displacement") - given.points;
  CHECK(back.colwise().norm().maxCoeff() <= 1e-9);
  CHECK((rest.mesh.points - given.points).colwise().norm().maxCoeff() > 1e-5);
  CHECK(rest.mesh.labels == given.labels);
}

TEST_CASE("lobe rest writes a scene, which sinks back into the image") {
  const Folder folder;
  write_scene_files(folder);
  const Ended ended = lobe_in(folder, "rest scene.json -o rest.json --json");
  REQUIRE_MESSAGE(ended.status == 0, ended.err);
  const Json told = Json::parse(ended.out);
  CHECK(told["ok"] == true);
  CHECK(told["load_fraction"] == 1.0);
  CHECK(told["largest_distance_loaded_m"].get<double>() <= 1e-5);
  CHECK(told["mean_distance_loaded_m"].get<double>() <= told["largest_distance_loaded_m"].get<double>());
  CHECK(told["files"].size() == 2);
  REQUIRE(lobe_in(folder, "solve rest.json -o sagged").status == 0);
  const MeshFile sagged = read_mesh(folder.path / "sagged" / "solution.vtu");
  const Eigen::MatrixXd off = sagged.mesh.points + sagged.point_data.at("displacement") -
                              read_mesh(folder.path / "beam.vtu").mesh.points;
  CHECK(off.colwise().norm().maxCoeff() <= 1e-5);
}

TEST_CASE("lobe rest says what has no rest shape, and loses no file of the scene") {
  const Folder folder;
  Json scene = small_scene();
  scene["gravity"] = {0, 0, -1e5};
  write_scene_files(folder, scene);
  const Ended crushed = lobe_in(folder, "rest scene.json -o rest.json --json");
  CHECK(crushed.status == 1);
  CHECK(crushed.err.find("% of the loads taken off") != std::string::npos);
  CHECK(Json::parse(crushed.out)["ok"] == false);
  const std::string before = bytes_of(folder.path / "scene.json"), mesh = bytes_of(folder.path / "beam.vtu");
  for (const char* wrong :
       {"-o rest.vtk", "-o rest.vtu --tolerance 0", "-o scene.json", "-o beam.vtu", "-o beam.json"}) {
    CAPTURE(wrong);
    const Ended refused = lobe_in(folder, std::string("rest scene.json ") + wrong);
    CHECK(refused.status == 2);
    CHECK_FALSE(refused.err.empty());
  }
  CHECK(bytes_of(folder.path / "scene.json") == before);
  CHECK(bytes_of(folder.path / "beam.vtu") == mesh);
  scene = small_scene();
  scene.erase("boundary");
  folder.write("free.json", scene.dump());
  CHECK(lobe_in(folder, "rest free.json -o rest.json").err.find("is not held") != std::string::npos);
}

TEST_CASE("lobe fit finds the modulus that a solution has, and lobe sensitivity what moves it") {
  const Folder folder;
  Json scene = small_scene();
  write_scene_files(folder, scene);
  REQUIRE(lobe_in(folder, "solve scene.json -o truth").status == 0);
  const MeshFile truth = read_mesh(folder.path / "truth" / "solution.vtu");
  Eigen::Index most = 0;
  truth.point_data.at("displacement").colwise().norm().maxCoeff(&most);
  const Vec3d at = truth.mesh.points.col(most), u = truth.point_data.at("displacement").col(most);
  std::string data = "quantity,at,component,value,unit\n";
  for (int axis = 0; axis < 3; ++axis)
    data += "displacement," + exact(at.x()) + ' ' + exact(at.y()) + ' ' + exact(at.z()) + ',' + "xyz"[axis] +
            ',' + exact(u[axis]) + ",m\n";
  folder.write("data.csv", data);
  const double lambda = scene["materials"][0]["lame_lambda"], mu = scene["materials"][0]["lame_mu"];
  scene["materials"][0]["lame_lambda"] = 2 * lambda;
  scene["materials"][0]["lame_mu"] = 2 * mu;
  folder.write("guess.json", scene.dump(1));
  const Ended fitted = lobe_in(folder, "fit guess.json --to data.csv -o fitted.json --json");
  REQUIRE_MESSAGE(fitted.status == 0, fitted.err);
  CHECK(Json::parse(fitted.out)["parameters"][0]["start"].get<double>() ==
        near(2 * young_modulus(lambda, mu), 1e-12));
  const Json found = Json::parse(bytes_of(folder.path / "fitted.json"))["materials"][0];
  CHECK(found["lame_lambda"].get<double>() == near(lambda, 1e-4));
  CHECK(found["lame_mu"].get<double>() == near(mu, 1e-4));
  CHECK(lobe_in(folder, "solve fitted.json -o again").status == 0);
  CHECK(lobe_in(folder, "fit guess.json scene.json --to data.csv").status == 2);
  CHECK(lobe_in(folder, "fit guess.json --to nothing.csv").status == 2);
  const Ended table = lobe_in(folder, "sensitivity scene.json -o shares.vtu");
  CHECK_MESSAGE(table.status == 0, table.err);
  CHECK(table.out.find("young_modulus + 10 %") != std::string::npos);
  CHECK(read_mesh(folder.path / "shares.vtu").cell_data.contains("weight"));
  CHECK(lobe_in(folder, "sensitivity scene.json --picture a.png").status == 2);
}

TEST_CASE("lobe fit finds the modulus of a motion from the forces that lobe run reports") {
  const Folder folder;
  Json scene = small_scene();
  scene["regions"] = Json::array();
  scene["tools"].erase(1);
  scene["tools"][0]["name"] = "forceps";
  write_scene_files(folder, scene);
  REQUIRE(lobe_in(folder, "run scene.json -o truth").status == 0);
  std::string data = "quantity,at,component,time,value,unit\n", late = data + "force,forceps,z,9,1,N\n";
  const Json report = report_in(folder.path / "truth");
  for (std::size_t i = 1; i < report["series"].size(); i += 3) {
    const Json& state = report["series"][i];
    const std::string time = exact(state["time"]);
    data += "force,forceps,z," + time + ',' + exact(state["tools"][0]["force"][2]) + ",N\n";
    data += "force,0,z," + time + ',' + exact(state["reactions"][0]["force"][2]) + ",N\n";
  }
  folder.write("data.csv", data);
  folder.write("late.csv", late);
  const double lambda = scene["materials"][0]["lame_lambda"], mu = scene["materials"][0]["lame_mu"];
  scene["materials"][0]["lame_lambda"] = 1.4 * lambda;
  scene["materials"][0]["lame_mu"] = 1.4 * mu;
  folder.write("guess.json", scene.dump(1));
  const Ended fitted = lobe_in(folder, "fit guess.json --to data.csv --json");
  REQUIRE_MESSAGE(fitted.status == 0, fitted.err);
  CHECK(Json::parse(fitted.out)["parameters"][0]["value"].get<double>() ==
        near(young_modulus(lambda, mu), 2e-3));
  const Ended refused = lobe_in(folder, "fit guess.json --to late.csv");
  CHECK(refused.status == 2);
  CHECK(refused.err.find("the scene ends after 0.3 s") != std::string::npos);
}
