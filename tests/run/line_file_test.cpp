#include "lobe/run/line_file.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "folder.h"

using namespace lobe;
using namespace lobe::test;

namespace {

std::vector<TermLines> two_lines() {
  TermLines bent{"threads", "3-0", 3, Mat3X<double>(3, 4), {0.25, 0.5}},
      straight{"attachments", "bed", 4, Mat3X<double>(3, 2), {1.5}, {0.75}};
  bent.ends << 0, 0.01, 0.01, 0.01, 0, 0, 0, 0.02, 0, 0, 0, 0;
  straight.ends << 0, 0, 0, 0, 0.5, 0.25;
  return {bent, straight};
}

}  // namespace

TEST_CASE("threads and strands are written as a line for each segment, with its tension and damage") {
  const Folder folder;
  write_lines(folder.path / "threads.vtp", two_lines());
  const std::string text = bytes_of(folder.path / "threads.vtp");
  const auto has = [&](const std::string& part) { return text.find(part) != std::string::npos; };
  CHECK(has("NumberOfPoints=\"6\" NumberOfLines=\"3\""));
  CHECK(has(">0 1 2 3 4 5 </DataArray>"));
  CHECK(has(">2 4 6 </DataArray>"));
  CHECK(has("Name=\"number\" format=\"ascii\">3 3 4 </DataArray>"));
  CHECK(has("Name=\"tension\" format=\"ascii\">0.25 0.5 1.5 </DataArray>"));
  CHECK(has("Name=\"damage\" format=\"ascii\">0 0 0.75 </DataArray>"));
}

TEST_CASE("threads are drawn as capsules from point to point") {
  nlohmann::ordered_json bodies = nlohmann::ordered_json::array();
  add_lines(bodies, two_lines());
  REQUIRE(bodies.size() == 3);
  const auto& second = bodies[1];
  const auto& q = second["orientation"];
  const Eigen::Quaterniond turn(q[3].get<double>(), q[0].get<double>(), q[1].get<double>(),
                                q[2].get<double>());
  const Vec3d from(second["position"][0], second["position"][1], second["position"][2]);
  const Vec3d end = from + turn * Vec3d(0, 0, second["capsule"][1].get<double>());
  CHECK((end - Vec3d(0.01, 0.02, 0)).norm() < 1e-15);
}
