// The program lobe-mesh itself: exit status, messages, files.
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>

#include "lobe/io/mesh_io.h"
#include "lobe/mesh/quality.h"
#include "lobe_mesh/diagnose.h"
#include "meshing/shapes.h"
#include "near.h"

using namespace lobe;
using namespace lobe::meshing;
using test::near;

namespace {

struct Run {
  int status = 0;
  std::string out, err;
};

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

Run lobe_mesh(const std::string& arguments) {
  const SurfaceFolder folder;
  const std::string out = (folder.path / "out").string(), err = (folder.path / "err").string();
  const int status = std::system((LOBE_BIN_DIR "/lobe-mesh " + arguments + " >" + out + " 2>" + err).c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(out), text_of(err)};
}

}  // namespace

TEST_CASE("lobe-mesh writes a mesh and a report that agree") {
  const SurfaceFolder folder;
  const std::string surface = folder.write("s.stl", scaled(make_sphere(1, 3), 50)).string();  // millimetres
  for (const std::string mesher : {"cgal", "tetgen"}) {
    const std::string mesh = (folder.path / (mesher + ".vtu")).string(),
                      report = (folder.path / (mesher + ".json")).string();
    const Run run = lobe_mesh(surface + " -o " + mesh + " --scale 0.001 --edge 0.015 --json --mesher " +
                              mesher + " --report " + report);
    CHECK_MESSAGE(run.status == 0, run.err);
    const auto json = nlohmann::json::parse(run.out);
    CHECK(json == nlohmann::json::parse(text_of(report)));
    const MeshFile read = read_mesh(mesh);
    CHECK(json["tets"] == read.mesh.tet_count());
    CHECK(json["vertices"] == read.mesh.vertex_count());
    CHECK(json["volume"].get<double>() == near(total_volume(read.mesh), 1e-9));
    CHECK(json["volume"].get<double>() == near(5.2e-4, 0.05));
    CHECK(json["time_step"].get<double>() > 0);
  }
  CHECK(folder.file_count() == 5);
}

TEST_CASE("lobe-mesh --diagnose describes a bad surface and ends well") {
  const SurfaceFolder folder;
  const std::string surface = folder.write("s.off", without_triangle(make_cube(1), 0)).string();
  const Run words = lobe_mesh(surface + " --diagnose");
  CHECK(words.status == 0);
  CHECK(contains(words.out, "3 open edges"));
  const Run json = lobe_mesh(surface + " --diagnose --json");
  const auto diagnosis = nlohmann::json::parse(json.out);
  CHECK(diagnosis["meshable"] == false);
  for (const auto& finding : diagnosis["findings"]) {
    const bool open = finding["name"] == "open edges";
    CHECK(finding["count"] == (open ? 3 : 0));
    CHECK(finding["triangles"].size() == (open ? 3 : 0));  // the neighbours of the missing one
  }
  const std::string inside_out = folder.write("inverted.off", inverted(make_sphere(1, 3))).string();
  for (const auto& finding :
       nlohmann::json::parse(lobe_mesh(inside_out + " --diagnose --json").out)["findings"])
    if (finding["name"] == "pieces facing the wrong way") CHECK(finding["triangles"].size() == 100);
}

TEST_CASE("groups of a surface and names of surfaces are kept in the mesh, or are said to be lost") {
  const SurfaceFolder folder;
  const std::string organ =
      folder
          .write("organ.obj", std::string("v 0 0 0\nv .1 0 0\nv .1 .1 0\nv 0 .1 0\nv 0 0 .1\nv .1 0 .1\n"
                                          "v .1 .1 .1\nv 0 .1 .1\ng held\nf 1 4 3 2\ng free\nf 5 6 7 8\n"
                                          "f 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"))
          .string();
  const std::string tumour =
      folder.write("tumour.off", moved(make_sphere(0.02, 2), {0.05, 0.05, 0.05})).string();
  const auto meshed = [&](const std::string& surfaces, const std::string& name) {
    return lobe_mesh(surfaces + " --edge 0.03 -o " + (folder.path / name).string());
  };
  const Run kept = meshed(organ, "a.vtu");
  REQUIRE_MESSAGE(kept.status == 0, kept.err);
  CHECK(contains(kept.err, "groups of the surface: held, free\n"));
  const MeshFile one = read_mesh(folder.path / "a.vtu");
  REQUIRE(one.surfaces.size() == 2);
  CHECK(one.surfaces[0].name == "held");
  for (const auto& triangle : one.surfaces[0].triangles)
    for (const Index v : triangle) CHECK(std::abs(one.mesh.points(2, v)) < 1e-12);
  CHECK(one.label_names.empty());
  CHECK(meshed(organ + " " + tumour, "b.vtu").status == 0);
  const MeshFile two = read_mesh(folder.path / "b.vtu");
  CHECK(two.label_names == std::map<int, std::string>{{0, "organ"}, {1, "tumour"}});
  REQUIRE(two.surfaces.size() == 2);
  CHECK(two.surfaces[0].name == "organ: held");
  CHECK(contains(meshed(organ, "a.vtk").err,
                 "the groups of the surface (held, free) are left out: -o MESH.vtu or MESH.msh keeps them"));
}

TEST_CASE("bad input ends with one line per fault, status 2 and nothing written") {
  const SurfaceFolder folder;
  const Surface cube = make_cube(0.1), sphere = make_sphere(0.05, 2);
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    CAPTURE(arguments);
    const std::size_t files = folder.file_count();
    const Run run = lobe_mesh(arguments + " --quiet -o " + (folder.path / "m.vtu").string());
    CHECK(run.status == 2);
    CHECK_MESSAGE(contains(run.err, message), run.err);
    CHECK(run.err.starts_with("lobe-mesh: error: "));
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    CHECK(folder.file_count() == files);
  };
  const auto file = [&](const std::string& name, const auto& content) {
    return folder.write(name, content).string();
  };
  refused((folder.path / "none.obj").string(), "no such file");
  refused(file("empty.stl", std::string()), "empty file");
  refused(file("x.txt", std::string("hello")), "unknown extension");
  refused(file("open.off", without_triangle(without_triangle(cube, 11), 10)), "--repair wrap");
  refused(file("two.off", joined(sphere, moved(sphere, {0.03, 0, 0}))), "intersect");
  Surface flat = cube;
  flat.points.row(0).setZero();
  refused(file("flat.off", flat), "flat");
  refused(file("nan.obj",
               std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 nan\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")),
          "vertex 3");
  const std::string good = file("cube.off", cube);
  for (const std::string edge : {"-1", "0", "nan", "inf", "long"})
    refused(good + " --edge " + edge, "--edge");
  refused(good + " --edge 1e-6", "million");
  refused(good + " --edge 1", "too long");
  refused(good + " --mesher gmsh", "gmsh");
  refused(good + " --colour red", "--colour");
  refused(good + " " + good, "surface 1: has no space of its own");
  refused(good + " --report " + (folder.path / "no/r.json").string(), "there is no folder");
  refused(good + " --report " + (folder.path / "m.vtu").string(), "two outputs");
  const Run no_output = lobe_mesh(good);
  CHECK(no_output.status == 2);
  CHECK(contains(no_output.err, "-o MESH.vtu"));
}

TEST_CASE("repairs and doubts are reported on standard error") {
  const SurfaceFolder folder;
  const std::string mesh = (folder.path / "m.vtu").string();
  const Surface sphere = make_sphere(50, 2);
  const Run inside_out =
      lobe_mesh(folder.write("i.off", inverted(sphere)).string() + " --edge 25 -o " + mesh);
  CHECK_MESSAGE(inside_out.status == 0, inside_out.err);
  CHECK(contains(inside_out.err, "inverted piece"));
  CHECK(contains(inside_out.err, "--scale 0.001"));
  const Surface two = joined(sphere, moved(sphere, {150, 0, 0}));
  const Run pieces = lobe_mesh(folder.write("p.off", two).string() + " --edge 0.025 --scale 1e-3 -o " + mesh);
  CHECK_MESSAGE(pieces.status == 0, pieces.err);
  CHECK(contains(pieces.err, "2 separate pieces"));
}

TEST_CASE("--repair auto meshes what the default refuses, and warns that it was wrapped") {
  const SurfaceFolder folder;
  const Surface sphere = make_sphere(0.05, 2);
  const std::string surface = folder.write("s.off", joined(sphere, moved(sphere, {0.03, 0, 0}))).string(),
                    mesh = (folder.path / "m.vtu").string();
  const Run refused = lobe_mesh(surface + " --edge 0.015 -o " + mesh);
  CHECK(refused.status == 2);
  CHECK(!std::filesystem::exists(mesh));
  const Run run = lobe_mesh(surface + " --edge 0.015 --json --repair auto -o " + mesh);
  REQUIRE_MESSAGE(run.status == 0, run.err);
  CHECK(contains(run.err, "warning: wrapped, because"));
  const auto json = nlohmann::json::parse(run.out);
  CHECK(json["repair"]["steps"].back()["name"] == "wrap");
  CHECK(contains(json["warnings"][0], "wrapped, because"));
}

TEST_CASE("--diagnose marks the faults in a file") {
  const SurfaceFolder folder;
  const std::string surface = folder.write("s.off", without_triangle(make_cube(1), 0)).string(),
                    marked = (folder.path / "marked.vtp").string();
  for (const std::string extension : {".vtp", ".vtu", ".ply"}) {
    const std::string file = (folder.path / ("marked" + extension)).string();
    CHECK(lobe_mesh(surface + " --diagnose --marked " + file).status == 0);
    CHECK(contains(text_of(file), extension == ".ply" ? "open_edges" : "open edges"));
  }
  CHECK(contains(lobe_mesh(surface + " --diagnose --marked m.stl").err, ".vtp, .vtu or .ply"));
  const Run wrong = lobe_mesh(surface + " -o " + (folder.path / "m.vtu").string() + " --marked " + marked);
  CHECK(wrong.status == 2);
  CHECK(contains(wrong.err, "--diagnose"));
}

TEST_CASE("each rung of the repair is reported with its volumes and its distance from the input") {
  const SurfaceFolder folder;
  const Surface sphere = make_sphere(0.05, 3);
  const std::string surface = folder.write("s.off", without_triangle(joined(sphere, sphere), 7)).string();
  const Run run = lobe_mesh(surface + " --edge 0.02 --json -o " + (folder.path / "m.vtu").string());
  REQUIRE_MESSAGE(run.status == 0, run.err);
  const auto steps = nlohmann::json::parse(run.out)["repair"]["steps"];
  REQUIRE(steps.size() >= 2);
  for (const auto& step : steps) {
    CHECK(contains(run.err, step["message"]));
    CHECK(step["distance"].get<double>() < 1e-10);  // [m]: the second copy fills the hole of the first
  }
  CHECK(steps[0]["volume_before"].get<double>() > 1.9 * enclosed_volume(sphere));
  CHECK(steps.back()["volume_after"].get<double>() == near(enclosed_volume(sphere), 1e-9));
}

TEST_CASE("--repaired writes the surface that is meshed, and makes no mesh unless one is asked for") {
  const SurfaceFolder folder;
  const Surface sphere = make_sphere(0.05, 3);
  const std::string surface = folder.write("s.off", without_triangle(joined(sphere, sphere), 7)).string();
  for (const std::string extension : {".obj", ".off", ".ply", ".stl", ".vtp"}) {
    CAPTURE(extension);
    const std::filesystem::path repaired = folder.path / ("r" + extension);
    const Run run = lobe_mesh(surface + " --json --repaired " + repaired.string());
    REQUIRE_MESSAGE(run.status == 0, run.err);
    CHECK(nlohmann::json::parse(run.out)["repair"]["steps"].size() >= 2);
    const Surface read = read_surface(repaired);
    CHECK(read.point_count() == sphere.point_count());
    CHECK(enclosed_volume(read) == near(enclosed_volume(sphere), 1e-6));
    CHECK(diagnose(read).meshable());
  }
  const std::string mesh = (folder.path / "m.vtu").string(), both = (folder.path / "both.ply").string();
  CHECK(lobe_mesh(surface + " --edge 0.02 -o " + mesh + " --repaired " + both).status == 0);
  CHECK(std::filesystem::exists(mesh));
  CHECK(text_of(both) == text_of(folder.path / "r.ply"));
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    const Run bad = lobe_mesh(arguments);
    CHECK(bad.status == 2);
    CHECK_MESSAGE(contains(bad.err, message), bad.err);
  };
  refused(surface + " --repaired r.vtk", ".stl or .vtp");
  refused(surface + " " + surface + " --repaired " + both, "one surface at a time");
  refused(surface + " --diagnose --repaired " + both, "not with --diagnose");
  refused(surface + " --picture p.png --repaired " + both, "shows a mesh");
}

TEST_CASE("two runs write the same bytes") {
  const SurfaceFolder folder;
  const std::string organ = folder.write("organ.off", make_sphere(0.05, 3)).string(),
                    tumour = folder.write("tumour.off", make_sphere(0.02, 2)).string();
  for (const std::string options : {" --label-edge 1=0.006", " --mesher tetgen"}) {
    CAPTURE(options);
    std::string first;
    for (const std::string name : {"a.vtu", "b.vtu"}) {
      const std::string mesh = (folder.path / name).string();
      REQUIRE(lobe_mesh(organ + " " + tumour + " --edge 0.012 -o " + mesh + options).status == 0);
      if (first.empty())
        first = text_of(mesh);
      else
        CHECK(text_of(mesh) == first);
    }
    CHECK(first.size() > 10000);
  }
}

TEST_CASE("a label image becomes a mesh with its labels") {
  const SurfaceFolder folder;
  std::string image =
      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 16 12 12\nencoding: raw\nspacings: 1 1 1\n"
      "units: \"mm\" \"mm\" \"mm\"\n\n";
  for (int n = 0; n < 16 * 12 * 12; ++n) image += n % 16 < 8 ? '\5' : '\2';
  const std::string file = folder.write("a.nrrd", image).string(), mesh = (folder.path / "m.vtu").string();
  const Run run = lobe_mesh(file + " --edge 0.003 --label-edge 2=0.002 --json -o " + mesh);
  REQUIRE_MESSAGE(run.status == 0, run.err);
  const auto json = nlohmann::json::parse(run.out);
  CHECK(json["image"] == file);
  CHECK(json["parts"][0]["label"] == 2);
  CHECK(json["parts"][1]["label"] == 5);
  CHECK(json["parts"][1]["surface_volume"].get<double>() == near(8 * 12 * 12 * 1e-9, 1e-9));
  const std::vector<int> labels = read_mesh(mesh).mesh.labels;
  CHECK(std::count(labels.begin(), labels.end(), 5) == json["parts"][1]["tets"]);
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    const Run bad = lobe_mesh(arguments + " -o " + (folder.path / "x.vtu").string());
    CHECK(bad.status == 2);
    CHECK_MESSAGE(contains(bad.err, message), bad.err);
  };
  refused(file + " --repair wrap", "--repair");
  refused(file + " --mesher tetgen", "--mesher cgal");
  refused(file + " " + file, "meshed alone");
  refused(file + " --label-edge 3=0.001", "the labels are 2, 5");
  refused(folder.write("s.off", make_cube(0.1)).string() + " --smoothing 2", "belongs to a label image");
}

TEST_CASE("where an image names no unit, its size says whether it is in millimetres, unless --scale does") {
  const SurfaceFolder folder;
  std::string voxels;  // 8 × 6 × 6 in an empty margin
  for (int n = 0; n < 10 * 8 * 8; ++n) {
    const int i = n % 10, j = n / 10 % 8, k = n / 80;
    voxels += i % 9 > 0 && j % 7 > 0 && k % 7 > 0 ? '\1' : '\0';
  }
  const auto meshed = [&](const std::string& spacings, const std::string& options) {
    const std::string file = folder
                                 .write("a.nrrd",
                                        "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 10 8 8\n"
                                        "encoding: raw\nspacings: " +
                                            spacings + "\n\n" + voxels)
                                 .string();
    return lobe_mesh(file + " --json" + options + " -o " + (folder.path / "m.vtu").string());
  };
  const auto volume_of = [](const Run& run) {
    return nlohmann::json::parse(run.out)["parts"][0]["surface_volume"].get<double>();
  };
  const Run large = meshed("5 5 5", " --edge 0.008");  // 58 across
  REQUIRE_MESSAGE(large.status == 0, large.err);
  CHECK(volume_of(large) == near(8 * 6 * 6 * 125e-9, 1e-9));
  CHECK(contains(large.err,
                 "no unit is named, and the body is 58.31 m large: it is taken to be in millimetres"));
  const Run asked = meshed("5 5 5", " --edge 0.08 --scale 0.01");
  REQUIRE_MESSAGE(asked.status == 0, asked.err);
  CHECK(volume_of(asked) == near(8 * 6 * 6 * 125e-6, 1e-9));
  CHECK_FALSE(contains(asked.err, "no unit"));
  const Run small = meshed("0.005 0.005 0.005", " --edge 0.008 --find-units");
  REQUIRE_MESSAGE(small.status == 0, small.err);
  CHECK(volume_of(small) == near(8 * 6 * 6 * 125e-9, 1e-9));
  CHECK(contains(small.err, "no unit is named: it is taken to be in metres (--scale 0.001 for millimetres)"));
}

TEST_CASE("--picture draws a picture, or says why not and keeps the mesh") {
  const SurfaceFolder folder;
  const std::string surface = folder.write("s.off", make_sphere(0.05, 3)).string(),
                    mesh = (folder.path / "m.vtu").string(), picture = (folder.path / "p.png").string();
  const Run run = lobe_mesh(surface + " --edge 0.012 --quiet -o " + mesh + " --picture " + picture);
  const bool can_draw = std::filesystem::exists(LOBE_BIN_DIR "/lobe-picture");
  CHECK(std::filesystem::exists(mesh));
  if (can_draw) {
    CHECK_MESSAGE(run.status == 0, run.err);
    CHECK(std::filesystem::file_size(picture) > 20000);
    CHECK(text_of(picture).starts_with("\x89PNG"));
  } else {
    CHECK(run.status == 1);
    CHECK(contains(run.err, "LOBE_PICTURES"));
  }
  CHECK(folder.file_count() == (can_draw ? 3 : 2));
  CHECK(contains(lobe_mesh(surface + " --picture p.jpg -o " + mesh).err, "ends in .png"));
}

TEST_CASE("a terminal shows a progress bar, a file does not") {
  const SurfaceFolder folder;
  const std::string surface = folder.write("s.off", make_sphere(0.05, 4)).string();
  const auto on_terminal = [&](const std::string& options) {
    const std::string screen = (folder.path / "screen").string(),
                      run = LOBE_BIN_DIR "/lobe-mesh " + surface + " --edge 0.006 -o " +
                            (folder.path / "m.vtu").string() + options;
    REQUIRE(std::system(("script -qec '" + run + "' " + screen + " >/dev/null").c_str()) == 0);
    return text_of(screen);
  };
  const std::string screen = on_terminal("");
  CHECK(contains(screen, "mesh (cgal) [#"));
  CHECK(contains(screen, "tetrahedra of mean edge"));
  CHECK(!contains(on_terminal(" --quiet"), "mesh (cgal)"));
  CHECK(!contains(lobe_mesh(surface + " --edge 0.006 -o " + (folder.path / "m.vtu").string()).err, "[#"));
}

TEST_CASE("several surfaces become labels in any format, sizes are read from the command line") {
  const SurfaceFolder folder;
  const std::string organ = folder.write("organ.off", make_sphere(0.05, 3)).string(),
                    tumour = folder.write("tumour.off", make_sphere(0.02, 2)).string();
  for (const std::string extension : {".vtu", ".vtk", ".msh", ".msh2", ".mesh", ".ele"}) {
    CAPTURE(extension);
    const std::string mesh = (folder.path / ("m" + extension)).string();
    const Run run =
        lobe_mesh(organ + " " + tumour +
                  " --edge 0.015 --label-edge 1=0.008 --ball 0,0,0.05,0.01,0.01 --json -o " + mesh);
    REQUIRE_MESSAGE(run.status == 0, run.err);
    const auto json = nlohmann::json::parse(run.out);
    const MeshFile read = read_mesh(mesh);
    CHECK(std::count(read.mesh.labels.begin(), read.mesh.labels.end(), 1) == json["parts"][1]["tets"]);
    CHECK(json["shortest_edge"] == 0.008);
  }
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    const Run run = lobe_mesh(organ + " " + arguments + " -o " + (folder.path / "x.vtu").string());
    CHECK(run.status == 2);
    CHECK_MESSAGE(contains(run.err, message), run.err);
  };
  refused("--label-edge one=0.1", "LABEL,EDGE");
  refused("--label-edge 0.5=0.1", "whole label");
  refused("--ball 0,0,0", "X,Y,Z,RADIUS,EDGE");
  refused("--sizes " + organ, "unknown extension");
  refused(organ, "surface 1: has no space of its own");
}

TEST_CASE("a run that is cancelled leaves nothing behind") {
  const SurfaceFolder folder, temporary;
  const std::string surface = folder.write("s.off", make_sphere(0.05, 4)).string();
  const std::size_t files = folder.file_count();
  const std::pair<std::string, std::string> runs[] = {{"cgal", "INT"}, {"tetgen", "TERM"}, {"cgal", "HUP"}};
  for (const auto& run : runs) {
    const std::string mesher = run.first, signal = run.second;
    CAPTURE(signal);
    const std::string command = "TMPDIR=" + temporary.path.string() + " timeout -s " + signal +
                                " 1 " LOBE_BIN_DIR "/lobe-mesh " + surface +
                                " --edge 0.0008 --quiet --mesher " + mesher + " -o " +
                                (folder.path / "m.vtu").string() + " 2>/dev/null";
    const int status = std::system(command.c_str());
    CHECK(WEXITSTATUS(status) == 124);  // of timeout: it was still at work
    CHECK(folder.file_count() == files);
    CHECK(temporary.file_count() == 0);
  }
}

TEST_CASE("damaged surfaces end in a mesh or a named error") {
  const SurfaceFolder folder;
  const std::string surface = folder.write("s.off", make_sphere(0.05, 3)).string();
  const auto table_of = [&](const std::string& options) {
    const std::string command = LOBE_BIN_DIR "/lobe-mesh-bench fuzz " + surface + options + " -o " +
                                (folder.path / "fuzz").string() + " >/dev/null";
    CHECK(std::system(command.c_str()) == 0);
    return text_of(folder.path / "fuzz" / "fuzz.md");
  };
  const std::string table = table_of(" --count 22");
  CHECK(contains(text_of(folder.path / "fuzz" / "fuzz.csv"), "\"noise\",2,"));
  CHECK(std::count(table.begin(), table.end(), '\n') == 2 + 11 + 1);
  CHECK(contains(table, "| together | 22 |"));
  CHECK(contains(table_of(" --count 3 --repair wrap"), "| together | 3 |"));
}

TEST_CASE("an internal error of a geometry library leaves no file in the working folder") {
  const SurfaceFolder folder;
  // CGAL meets one of its own in the refinement of this surface.
  const std::string command = "cd " + folder.path.string() +
                              " && " LOBE_BIN_DIR "/lobe-mesh-bench fuzz " LOBE_DATA_DIR
                              "/cylinder.obj --first 652 --count 1 -o fuzz >/dev/null 2>&1";
  CHECK(std::system(command.c_str()) == 0);
  CHECK(folder.file_count() == 1);  // the folder of the tables
}

TEST_CASE("the table of quality has a line for every mesher, size and body") {
  const SurfaceFolder folder;
  const std::filesystem::path out = folder.path / "quality";
  const std::string command = LOBE_BIN_DIR "/lobe-mesh-bench quality --tets 500 --first-tets 1000 " +
                              folder.write("a.off", make_sphere(0.05, 3)).string() + " " +
                              folder.write("b.off", make_sphere(0.05, 3)).string() + " -o " + out.string() +
                              " >/dev/null";
  CHECK(std::system(command.c_str()) == 0);
  const std::string table = text_of(out / "quality.md");
  CHECK(std::count(table.begin(), table.end(), '\n') == 2 + 2 * 2 + 2);
  CHECK(contains(table, "| a, 642 vertices | 1,000 | tetgen |"));
  CHECK(contains(table, "| b, 642 vertices | 500 | cgal |"));
  CHECK(!contains(table, "below the gate"));
}

TEST_CASE("lobe scene repairs and meshes a surface in millimetres, and writes a scene for it") {
  const SurfaceFolder folder;
  const Surface ball = scaled(inverted(make_sphere(1, 2)), 40);  // inside out
  folder.write("ball.stl", ball);
  const std::string command = "cd " + folder.path.string() + " && " + LOBE_BIN_DIR "/lobe ";
  REQUIRE(std::system((command + "scene ball.stl -o organ.json --edge 0.02 >out 2>err").c_str()) == 0);
  CHECK(contains(text_of(folder.path / "err"), "taken to be in millimetres"));
  const auto scene = nlohmann::json::parse(text_of(folder.path / "organ.json"));
  CHECK(scene["mesh"] == "organ.vtu");
  CHECK_FALSE(scene.contains("mesh_scale"));
  CHECK(total_volume(read_mesh(folder.path / "organ.vtu").mesh) == near(enclosed_volume(ball) * -1e-9, 0.02));
  CHECK(std::system((command + "check organ.json >out 2>err").c_str()) == 0);
  CHECK_FALSE(contains(text_of(folder.path / "out"), "warning"));

  folder.write("tumour.stl", moved(scaled(make_sphere(1, 2), 12), {10, 0, 0}));
  REQUIRE(std::system((command + "scene ball.stl tumour.stl --edge 0.02 >out 2>err").c_str()) == 0);
  const auto both = nlohmann::json::parse(text_of(folder.path / "ball_scene.json"))["materials"];
  REQUIRE(both.size() == 2);
  CHECK(both[1]["name"] == "tumour");
  CHECK(both[1]["where"]["label"] == 1);

  // A surface in a .vtu is not overwritten by its mesh.
  std::filesystem::copy_file(folder.path / "organ.vtu", folder.path / "grid.vtu");
  CHECK(std::system((command + "scene ball.stl grid.vtu -o grid.json >out 2>err").c_str()) != 0);
  CHECK(contains(text_of(folder.path / "err"), "grid.vtu, which is the input; give another name"));
}

TEST_CASE("surfaces that overlap or touch in other triangles become voxels where that is left to lobe-mesh") {
  const SurfaceFolder folder;
  const Surface large = scaled(make_sphere(0.03, 3), 1000), small = scaled(make_sphere(0.012, 2), 1000);
  const std::string tumour = folder.write("tumour.stl", moved(small, {28, 0, 0})).string(),  // half outside
      organ = folder.write("organ.stl", large).string(), mesh = " -o " + (folder.path / "m.vtu").string();
  const std::string both = tumour + " " + organ + mesh;
  CHECK(lobe_mesh(both + " --find-units").status == 2);
  const Run run = lobe_mesh(both + " --find-units --find-voxels --edge 0.006 --json");
  REQUIRE_MESSAGE(run.status == 0, run.err);
  CHECK(contains(run.err, "warning: surfaces 0 and 1 touch or intersect near (0.02"));
  CHECK(contains(run.err, ") m: all are turned into voxels of 0.002 m, of which the smaller surface wins"));
  const auto parts = nlohmann::json::parse(run.out)["parts"];
  CHECK(parts[0]["volume"].get<double>() == near(1e-9 * enclosed_volume(small), 0.04));  // all of the tumour
  CHECK(parts[1]["volume"].get<double>() > 0.9e-9 * enclosed_volume(large));
  CHECK(contains(lobe_mesh(both + " --find-voxels --voxels 2").err, "--find-voxels"));
}

TEST_CASE("voxels that lose a part of the body end the programs with others that keep it, unless accepted") {
  const SurfaceFolder folder;
  Surface plate = make_cube(1);  // 60 × 60 × 1 mm, between the centres of voxels of 4 mm
  plate.points = (Vec3d(0.06, 0.06, 0.001).asDiagonal() * plate.points).colwise() + Vec3d(0.02, 0, 0.001);
  const std::string body = folder.write("body.stl", joined(make_sphere(0.01, 3), plate)).string(),
                    made = body + " --voxels 0.004 -o " + (folder.path / "m.vtu").string();
  const Run run = lobe_mesh(made);
  CHECK(run.status == 2);
  // The plate has 46 %, and the ball's voxels enclose a quarter more than the ball.
  CHECK(contains(run.err, "surface 0: voxels of 0.004 m lose 33 %"));
  CHECK(contains(run.err, ": --voxels 0.0008"));
  CHECK(contains(run.err, "(--accept-loss meshes what is left)"));
  CHECK(!std::filesystem::exists(folder.path / "m.vtu"));
  const Run accepted = lobe_mesh(made + " --accept-loss");
  CHECK_MESSAGE(accepted.status == 0, accepted.err);
  CHECK(contains(accepted.err, "warning: surface 0: voxels of 0.004 m lose 33 %"));
  for (const char* command : {"scene", "view"}) {
    CAPTURE(command);
    const std::string line = "cd " + folder.path.string() + " && " + LOBE_BIN_DIR "/lobe " + command +
                             " body.stl --voxels 0.004 >out 2>err";
    CHECK(std::system(line.c_str()) != 0);
    CHECK(contains(text_of(folder.path / "err"), ": --voxels 0.0008"));
    CHECK(folder.file_count() == 4);  // neither mesh nor scene
  }
}

TEST_CASE("lobe-mesh --measure says how large a body is, in the coordinates of its files") {
  const SurfaceFolder folder;
  const auto measured = [](const std::string& arguments) {
    const Run run = lobe_mesh(arguments + " --measure");
    REQUIRE_MESSAGE(run.status == 0, run.err);
    return nlohmann::json::parse(run.out);
  };
  Surface box = make_cube(1);
  box.points = Vec3d(20, 30, 40).asDiagonal() * box.points;
  for (const char* name : {"box.stl", "box.obj", "box.off"}) {
    const auto json = measured(folder.write(name, inverted(box)).string());
    CHECK(json["size"] == nlohmann::json{20.0, 30.0, 40.0});
    CHECK(json["scale"] == 0.001);
    REQUIRE(json["parts"].size() == 1);
    CHECK(json["parts"][0]["volume"].get<double>() == near(24000, 1e-6));
    CHECK(json["parts"][0]["area"].get<double>() == near(5200, 1e-6));
  }
  const std::string stl = (folder.path / "box.stl").string();
  for (const char* name : {"box.ply", "box.vtp"}) {
    const std::string file = (folder.path / name).string();
    REQUIRE(lobe_mesh(stl + " --repaired " + file).status == 0);
    CHECK(measured(file)["parts"][0]["volume"].get<double>() == near(24000, 1e-6));
  }
  CHECK(measured(stl + " --scale 0.01")["scale"] == 0.01);
  // A part within another one: walls count on both sides.
  Surface small = make_cube(1);
  small.points = (small.points * 10).colwise() + Vec3d(5, 5, 5);
  const auto parts = measured(folder.write("small.stl", small).string() + " " + stl)["parts"];
  CHECK(parts[0]["volume"].get<double>() == near(1000, 1e-6));
  CHECK(parts[1]["volume"].get<double>() == near(23000, 1e-6));
  CHECK(parts[1]["area"].get<double>() == near(5800, 1e-6));
  CHECK(measured(stl + " --void " + (folder.path / "small.stl").string())["parts"].size() == 1);

  std::string voxels(4 * 4 * 4, '\0');  // two labels of 2 × 1 × 1
  voxels[1 + 4 * (1 + 4 * 1)] = voxels[2 + 4 * (1 + 4 * 1)] = '\1';
  voxels[1 + 4 * (2 + 4 * 1)] = voxels[2 + 4 * (2 + 4 * 1)] = '\3';
  const auto image = measured(folder
                                  .write("a.nrrd",
                                         "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n"
                                         "spacings: 5 5 3\n\n" +
                                             voxels)
                                  .string());
  CHECK(image["size"] == nlohmann::json{10.0, 10.0, 3.0});
  CHECK(image["scale"] == 0.001);
  REQUIRE(image["parts"].size() == 2);
  CHECK(image["parts"][1]["volume"].get<double>() == near(150, 1e-6));
  CHECK(image["parts"][1]["area"].get<double>() == near((2 * 50 + 2 * 30 + 2 * 15) / 1.5, 1e-6));
}

TEST_CASE("what has no size is refused by --measure") {
  const SurfaceFolder folder;
  const std::string open = folder.write("open.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").string();
  const Run run = lobe_mesh(open + " --measure");
  CHECK(run.status == 2);
  CHECK(contains(run.err, "surface 0: encloses no volume"));
  CHECK(lobe_mesh(folder.write("bad.ply", "ply").string() + " --measure").status == 2);
  CHECK(contains(lobe_mesh(open + " --measure -o m.vtu").err, "--measure: not with --output"));
}

TEST_CASE("lobe-mesh --void leaves a cavity out, and reports edges as lobe info does") {
  const SurfaceFolder folder;
  const std::string outer = folder.write("outer.stl", make_sphere(0.04, 3)).string(),
                    inner = folder.write("inner.stl", make_sphere(0.02, 3)).string(),
                    mesh = (folder.path / "m.vtu").string();
  const Run run = lobe_mesh(outer + " --void " + inner + " -o " + mesh + " --edge 0.008 --json");
  REQUIRE_MESSAGE(run.status == 0, run.err);
  const TetMesh read = read_mesh(mesh).mesh;
  CHECK(total_volume(read) ==
        near(enclosed_volume(make_sphere(0.04, 3)) - enclosed_volume(make_sphere(0.02, 3)), 0.02));
  CHECK(nlohmann::json::parse(run.out)["mean_edge"].get<double>() ==
        near(mesh_quality(read).mean_edge, 1e-9));
  CHECK(contains(lobe_mesh(outer + " --diagnose --void " + inner).err, "--void: not with --diagnose"));
}
