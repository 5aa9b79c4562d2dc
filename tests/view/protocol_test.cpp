#include "protocol.h"

#include <doctest/doctest.h>

#include <cstring>

#include "lobe/error.h"
#include "lobe/fem/body.h"
#include "lobe/mesh/generators.h"

using namespace lobe;
using namespace lobe::view;

namespace {

template <class T>
T at(std::string_view bytes, std::size_t offset) {
  T value;
  REQUIRE(offset + sizeof value <= bytes.size());
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

}  // namespace

TEST_CASE("blocks are read as they were written, the content without what fills it up") {
  BlockWriter out;
  write_json(status_tag, "{}", out);
  write_json(tools_tag, "", out);
  write_json(tag("NEW!"), "12345", out);
  const std::string message = out.take();
  CHECK(message.size() == 8 + 4 + 8 + 8 + 8);
  const std::vector<Block> blocks = read_blocks(message);
  REQUIRE(blocks.size() == 3);
  CHECK(blocks[0].tag == status_tag);
  CHECK(blocks[0].bytes == "{}");
  CHECK(blocks[1].bytes.empty());
  CHECK(blocks[2].bytes == "12345");
}

TEST_CASE("what is cut off is no sequence of blocks") {
  BlockWriter out;
  write_json(status_tag, "{\"time\": 1}", out);
  const std::string message = out.take();
  for (std::size_t size = 1; size < message.size(); ++size)
    CHECK_THROWS_AS(read_blocks(message.substr(0, size)), InputError);
  CHECK(read_blocks("").empty());
}

TEST_CASE("the topology block has triangles, rest positions, regions and cut faces in this order") {
  const TetMesh mesh = box_mesh({1, 1, 1}, 1, 1, 1);
  const std::vector<RegionModel> regions(std::size_t(mesh.tet_count()), RegionModel::precomputed);
  const Surface surface(Topology(mesh), regions);
  Mat3X<float> rest(3, surface.mesh().vertex_count());
  for (Index v = 0; v < rest.cols(); ++v)
    rest.col(v) = mesh.points.col(surface.mesh().mesh_vertex[std::size_t(v)]).cast<float>();
  BlockWriter out;
  write_topology(surface.mesh(), rest, out);
  const std::string message = out.take();
  const std::vector<Block> blocks = read_blocks(message);
  REQUIRE(blocks.size() == 1);
  const std::string_view bytes = blocks[0].bytes;
  CHECK(blocks[0].tag == topology_tag);
  CHECK(at<std::uint32_t>(bytes, 4) == 8);   // vertices of a cube
  CHECK(at<std::uint32_t>(bytes, 8) == 12);  // triangles of its faces
  CHECK(at<int>(bytes, 12) == surface.mesh().triangles[0][0]);
  const std::size_t rest_at = 12 + 12 * 12, region_at = rest_at + 8 * 12;
  CHECK(at<float>(bytes, rest_at) == rest(0, 0));
  CHECK(at<std::uint8_t>(bytes, region_at) == 1);
  CHECK(at<std::uint8_t>(bytes, region_at + 12) == 0);
  CHECK(bytes.size() == region_at + 12 + 12);
}

TEST_CASE("the bodies block has the body of each triangle, and is not there where there is one body") {
  TetMesh mesh = box_mesh({1, 1, 1}, 2, 1, 1);
  const std::vector<RegionModel> regions(std::size_t(mesh.tet_count()), RegionModel::nonlinear);
  BlockWriter none;
  write_bodies(Surface(Topology(mesh), regions).mesh(), mesh.bodies, none);
  CHECK(none.take().empty());
  mesh.bodies.names = {"liver", "kidney"};
  for (Index t = 0; t < mesh.tet_count(); ++t)
    mesh.bodies.of.push_back(mesh.points(0, mesh.tets(0, t)) > 0.5);
  const Surface surface(Topology(mesh), TetTags(regions, mesh.bodies));
  BlockWriter out;
  write_bodies(surface.mesh(), mesh.bodies, out);
  const std::string message = out.take();
  const Block block = read_blocks(message)[0];
  CHECK(block.tag == bodies_tag);
  REQUIRE(block.bytes.size() == std::size_t(surface.mesh().triangle_count()));
  for (std::size_t t = 0; t < block.bytes.size(); ++t)
    CHECK(block.bytes[t] == char(mesh.bodies.body_of(surface.mesh().owner[t].tet)));
}

TEST_CASE("the lines block has names and sizes, then all ends, all tensions and all damages") {
  std::vector<LinesSnapshot> lines(2);
  lines[0].term = "threads";
  lines[0].ends = Mat3X<float>::Constant(3, 4, 0.25f);
  lines[0].tensions = {1, 2};
  lines[1].term = "attachments";
  lines[1].ends = Eigen::Vector3f(4, 5, 6).replicate(1, 2);
  lines[1].tensions = {3};
  lines[1].damages = {0.5f};
  BlockWriter out;
  write_lines(lines, out);
  const std::string message = out.take();
  const std::string_view bytes = read_blocks(message)[0].bytes;
  CHECK(at<std::uint32_t>(bytes, 0) == 2);
  CHECK(std::string(bytes.data() + 4) == "threads");
  CHECK(at<std::uint32_t>(bytes, 20) == 2);
  CHECK(std::string(bytes.data() + 24) == "attachments");
  CHECK(at<std::uint32_t>(bytes, 40) == 1);
  CHECK(at<float>(bytes, 44) == 0.25f);
  CHECK(at<float>(bytes, 44 + 12 * 4) == 4.0f);  // of the second
  CHECK(at<float>(bytes, 44 + 18 * 4) == 1.0f);
  CHECK(at<float>(bytes, 44 + 20 * 4) == 3.0f);
  CHECK(at<float>(bytes, 44 + 21 * 4) == 0.0f);  // a thread has no damage
  CHECK(at<float>(bytes, 44 + 23 * 4) == 0.5f);
  CHECK(bytes.size() == 44 + 24 * 4);
  BlockWriter none;
  write_lines({}, none);
  CHECK(none.take().empty());
}

TEST_CASE("a scalar comes back to within half a step of its range") {
  const std::vector<float> values = {-1.5f, 0.25f, 7, 3};
  BlockWriter out;
  write_scalar("von_mises", values, out);
  const std::string message = out.take();
  const std::string_view bytes = read_blocks(message)[0].bytes;
  CHECK(std::string(bytes.data()) == "von_mises");
  const float low = at<float>(bytes, 16), high = at<float>(bytes, 20);
  CHECK(low == -1.5f);
  CHECK(high == 7.0f);
  const double step = (high - low) / 65535.0;
  for (std::size_t i = 0; i < values.size(); ++i)
    CHECK(std::abs(low + step * at<std::uint16_t>(bytes, 24 + 2 * i) - values[i]) <= 0.51 * step);
}

TEST_CASE("a scalar that is the same everywhere, or nowhere, has a range") {
  for (const std::vector<float>& values : {std::vector<float>{}, std::vector<float>{2, 2}}) {
    BlockWriter out;
    write_scalar("volume_ratio", values, out);
    const std::string message = out.take();
    CHECK(read_blocks(message)[0].bytes.size() == 24 + 2 * values.size());
  }
}

TEST_CASE("the fibres block has the part of each fibre that lies in the triangle, and none without fibres") {
  TetMesh mesh = box_mesh({1, 1, 1}, 2, 2, 2);
  const Surface surface(Topology(mesh),
                        std::vector<RegionModel>(std::size_t(mesh.tet_count()), RegionModel::nonlinear));
  Mat3X<float> rest(3, surface.mesh().vertex_count());
  for (Index v = 0; v < rest.cols(); ++v)
    rest.col(v) = mesh.points.col(surface.mesh().mesh_vertex[std::size_t(v)]).cast<float>();
  BlockWriter none;
  write_fibres(surface.mesh(), rest, mesh.fibres, none);
  CHECK(none.take().empty());
  mesh.fibres.setZero(3, mesh.tet_count());
  for (Index t = 0; t < mesh.tet_count(); t += 2) mesh.fibres.col(t) = Vec3d(1, 2 + t, -0.5).normalized();
  BlockWriter out;
  write_fibres(surface.mesh(), rest, mesh.fibres, out);
  const std::string message = out.take();
  const Block block = read_blocks(message).at(0);
  CHECK(block.tag == fibres_tag);
  REQUIRE(block.bytes.size() == 8 * std::size_t(surface.mesh().triangle_count()));
  int without = 0;
  for (std::size_t t = 0; t < surface.mesh().triangles.size(); ++t) {
    const Eigen::Vector3i& corner = surface.mesh().triangles[t];
    const auto side = [&](int k) -> Vec3d {
      return (rest.col(corner[k]) - rest.col(corner[0])).cast<double>();
    };
    const Vec3d fibre = mesh.fibres.col(surface.mesh().owner[t].tet),
                normal = side(1).cross(side(2)).normalized();
    const Vec3d told = at<float>(block.bytes, 8 * t) * side(1) + at<float>(block.bytes, 8 * t + 4) * side(2);
    CHECK((told - (fibre - fibre.dot(normal) * normal)).norm() < 1e-6);
    without += fibre.isZero() && told.isZero(0);
  }
  CHECK(without > 0);
  CHECK(without < surface.mesh().triangle_count());
}
