// The files that a run leaves: frames, their collection, the request for pictures.
#include <doctest/doctest.h>

#include <set>

#include "lobe/error.h"
#include "near.h"
#include "run/small_scene.h"

using namespace lobe;
using namespace lobe::test;
namespace fs = std::filesystem;

namespace {

std::set<std::string> files_in(const fs::path& directory) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(directory)) names.insert(entry.path().filename().string());
  return names;
}

// Times and file names of a collection.
std::vector<std::pair<double, std::string>> frames_of(const fs::path& pvd) {
  const std::string text = bytes_of(pvd);
  const auto value = [&](const std::string& key, std::size_t from) {
    const std::size_t at = text.find(key + "=\"", from) + key.size() + 2;
    return text.substr(at, text.find('"', at) - at);
  };
  std::vector<std::pair<double, std::string>> frames;
  for (std::size_t at = text.find("<DataSet"); at != text.npos; at = text.find("<DataSet", at + 1))
    frames.emplace_back(std::stod(value("timestep", at)), value("file", at));
  return frames;
}

void check_same_frames(const fs::path& a, const fs::path& b, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::string frame = bytes_of(a / frame_name(i));
    CHECK(!frame.empty());
    CHECK(frame == bytes_of(b / frame_name(i)));
  }
}

}  // namespace

TEST_CASE("frames are written at the start, as often as asked for, and at the end") {
  const Folder folder;
  Json scene = small_scene();
  scene["time"]["duration"] = 0.34;
  const RunResult result = play(write_scene_files(folder, scene), folder.path / "out");
  CHECK(result.ok);
  CHECK(result.picture_request.empty());
  CHECK(result.report == folder.path / "out" / "report.json");
  CHECK(files_in(folder.path / "out") ==
        std::set<std::string>{"frame_0000.vtu", "frame_0001.vtu", "frame_0002.vtu", "frame_0003.vtu",
                              "frame_0004.vtu", "report.json", "series.pvd"});
  const auto frames = frames_of(folder.path / "out" / "series.pvd");
  const std::vector<double> times = {0, 0.1, 0.2, 0.3, 0.34};
  REQUIRE(frames.size() == times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    CHECK(frames[i].first == near(times[i], 1e-12, times.back()));
    CHECK(frames[i].second == frame_name(i));
  }
}

TEST_CASE("every frame shows the mesh that is left, held where it is held") {
  const Folder folder;
  play(write_scene_files(folder), folder.path / "out");
  const TetMesh input = beam_mesh();
  for (std::size_t i = 0; i < 4; ++i) {
    const MeshFile frame = read_mesh(folder.path / "out" / frame_name(i));
    const Eigen::MatrixXd& source = frame.cell_data.at("source");
    for (Index t = 0; t < frame.mesh.tet_count(); ++t) {
      const Index of_input = static_cast<Index>(source(0, t));
      CHECK((t == 0 || source(0, t) > source(0, t - 1)));
      CHECK(tet_points(frame.mesh, t) == tet_points(input, of_input));
      CHECK(frame.mesh.labels[std::size_t(t)] == input.labels[std::size_t(of_input)]);
      CHECK(frame.cell_data.at("region")(0, t) == (barycentre(input, of_input).x() < 0.03 ? 0 : 2));
    }
    const Eigen::MatrixXd& u = frame.point_data.at("displacement");
    CHECK(u.allFinite());
    CHECK(frame.point_data.at("velocity").allFinite());
    const Vec3d grasped = std::min(1.0, 0.5 * double(i)) * lift;  // the path ends at 0.2 s
    for (Index v = 0; v < input.vertex_count(); ++v) {
      if (input.points(0, v) == 0) CHECK(u.col(v).norm() == 0);
      if (input.points(0, v) == 0.08) CHECK((u.col(v) - grasped).norm() < 1e-7 * lift.norm());
    }
  }
}

TEST_CASE("volume ratios sum up to the volume, von Mises stresses are those of the stresses") {
  const Folder folder;
  play(write_scene_files(folder), folder.path / "out");
  const MeshFile frame = read_mesh(folder.path / "out" / frame_name(3));
  const Eigen::MatrixXd &stress = frame.cell_data.at("stress"), &ratio = frame.cell_data.at("volume_ratio");
  double volume = 0;
  for (Index t = 0; t < frame.mesh.tet_count(); ++t) {
    volume += ratio(0, t) * signed_volume(tet_points(frame.mesh, t));
    const auto s = stress.col(t);
    const double square =
        0.5 * (std::pow(s[0] - s[1], 2) + std::pow(s[1] - s[2], 2) + std::pow(s[2] - s[0], 2)) +
        3 * s.tail(3).squaredNorm();
    CHECK(frame.cell_data.at("von_mises")(0, t) == near(std::sqrt(square), 1e-4));
  }
  CHECK(volume == near(report_in(folder.path / "out")["series"].back()["volume"], 1e-6));
  CHECK(frame.cell_data.at("strain").norm() > 0.01);
}

TEST_CASE("two runs, and others on two and seven threads, write the same frames to the last bit") {
  const Folder folder;
  write_vtu(folder.path / "beam.vtu", box_mesh({0.04, 0.04, 0.04}, 14, 14, 14));  // several ranges of work
  Json scene = small_scene();
  scene["boundary"][0]["where"] =
      Json::parse(R"({"plane": {"point": [0, 0, 0], "normal": [0, 0, 1], "side": "below"}})");
  scene["tools"][0]["where"] = Json::parse(R"({"nearest": {"point": [0.02, 0.02, 0.04], "count": 9}})");
  scene["tools"][1]["path"] = {{0, 0.03, -0.01, 0.04}, {0.02, 0.03, 0.05, 0.04}};
  scene["time"] = {{"duration", 0.02}, {"frame", 0.01}};
  scene["output"]["every"] = 0.01;
  const fs::path file = folder.write("scene.json", scene.dump());
  for (const auto& [name, threads] :
       {std::pair("a", 1), std::pair("b", 1), std::pair("c", 2), std::pair("d", 7)})
    CHECK(play(file, folder.path / name, threads).ok);
  CHECK(report_in(folder.path / "a")["tetrahedra_removed"] > 0);
  for (const char* other : {"b", "c", "d"}) check_same_frames(folder.path / "a", folder.path / other, 3);
}

TEST_CASE("a run replaces the files of an earlier one and leaves all others alone") {
  const Folder folder;
  const fs::path scene = write_scene_files(folder), out = folder.path / "out";
  fs::create_directories(out);
  for (const std::string old : {"frame_0001.vtu", "frame_9999.vtu", "picture_0.5.png", "pictures.json",
                                "report.json", "series.pvd", "notes.txt", "frame_0001.txt"})
    folder.write("out/" + old, "old");
  play(scene, out);
  CHECK(files_in(out) == std::set<std::string>{"frame_0000.vtu", "frame_0001.vtu", "frame_0002.vtu",
                                               "frame_0003.vtu", "report.json", "series.pvd", "notes.txt",
                                               "frame_0001.txt"});
  for (const std::string file : {"frame_0001.vtu", "report.json", "series.pvd"})
    CHECK(bytes_of(out / file) != "old");
}

TEST_CASE("a mesh or scene that the results would overwrite is refused and nothing is deleted") {
  const Folder folder;
  const fs::path out = folder.path / "out";
  fs::create_directories(out);
  for (const std::string old : {"frame_0000.vtu", "frame_0002.vtu", "report.json"})
    folder.write("out/" + old, "old");
  write_vtu(out / "frame_0001.vtu", beam_mesh());
  fs::create_symlink(out / "frame_0001.vtu", folder.path / "link.vtu");
  write_vtu(folder.path / "beam.vtu", beam_mesh());
  Json scene = small_scene();
  const auto refused = [&](const std::string& scene_file, const std::string& place) {
    const fs::path file = folder.write(scene_file, scene.dump());
    const std::set<std::string> before = files_in(out);
    CHECK_THROWS_WITH_AS(play(file, out), doctest::Contains((place + ": would be overwritten").c_str()),
                         InputError);
    CHECK(files_in(out) == before);
  };
  scene["mesh"] = "out/frame_0001.vtu";
  refused("scene.json", "frame_0001.vtu");
  scene["mesh"] = "link.vtu";
  refused("scene.json", "link.vtu");
  scene["mesh"] = "../beam.vtu";
  refused("out/pictures.json", "pictures.json");
}

TEST_CASE("the request for pictures names the frames, their times, and the tools where they are") {
  const Folder folder;
  Json scene = small_scene();
  scene["output"]["pictures"] = {0, 0.11, 0.3};
  const fs::path out = folder.path / "out";
  CHECK(play(write_scene_files(folder, scene), out).picture_request == out / "pictures.json");
  const Json pictures = Json::parse(bytes_of(out / "pictures.json"))["pictures"];
  REQUIRE(pictures.size() == 3);
  const char* names[] = {"picture_0.png", "picture_0.11.png", "picture_0.3.png"};
  const char* titles[] = {"t = 0.00 s", "t = 0.12 s", "t = 0.30 s"};  // the first frame at or after it
  const std::size_t frames[] = {0, 2, 4};
  const std::size_t tools[] = {0, 2, 1};  // nothing is held before the first step; the cautery ends at 0.2 s
  for (std::size_t i = 0; i < 3; ++i) {
    const Json& panel = pictures[i]["panels"][0];
    CHECK(pictures[i]["out"] == names[i]);
    CHECK(panel["title"] == titles[i]);
    CHECK(panel["mesh"] == frame_name(frames[i]));
    CHECK(panel["first"] == frame_name(0));
    CHECK(panel["tools"].size() == tools[i]);
  }
  CHECK(frames_of(out / "series.pvd").at(2).first == near(0.12, 1e-12));
  const Json cautery = pictures[1]["panels"][0]["tools"][1];
  CHECK(cautery["type"] == "cautery");
  CHECK(cautery["radius"] == 0.004);
  CHECK(cautery["position"][1].get<double>() == near(-0.01 + 0.04 * 0.07 / 0.15, 1e-12));
  const Json held = pictures[2]["panels"][0]["tools"][0]["points"];
  CHECK(held.size() == 9);
  for (const Json& point : held) CHECK(point[0].get<double>() == near(0.08 + lift.x(), 1e-6));
}
