#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <limits>
#include <numbers>

#include "io/fixture.h"
#include "lobe/io/mesh_io.h"

using namespace lobe;

namespace {

TetMesh awkward_mesh() {
  TetMesh mesh = cylinder_mesh(std::numbers::pi / 31, 0.1, 3, 4);
  mesh.points.row(2).array() += 1e-17;
  mesh.points(0, 0) = 5e-324;  // the smallest number there is
  for (std::size_t t = 0; t < mesh.labels.size(); ++t) mesh.labels[t] = static_cast<int>(t) - 100;
  return mesh;
}

}  // namespace

TEST_CASE("VTU: what was written is read back bit by bit") {
  const fixture::Folder folder;
  const TetMesh mesh = awkward_mesh();
  const DataArray u{"displacement", Eigen::MatrixXd::Random(3, mesh.vertex_count())};
  const DataArray ratio{"a <\"&\"> name", Eigen::MatrixXd::Random(1, mesh.tet_count()),
                        DataArray::Type::float32};
  const DataArray region{"region", Eigen::MatrixXd::Constant(1, mesh.tet_count(), -7),
                         DataArray::Type::int32};
  write_vtu(folder.path / "a.vtu", mesh, {u}, {ratio, region});
  CHECK(folder.file_count() == 1);  // no temporary file stays
  const MeshFile file = read_mesh(folder.path / "a.vtu");
  CHECK(file.mesh.points == mesh.points);
  CHECK(file.mesh.tets == mesh.tets);
  CHECK(file.mesh.labels == mesh.labels);
  CHECK(file.point_data.at("displacement") == u.values);
  CHECK(file.cell_data.at("region") == region.values);
  CHECK(file.cell_data.at(ratio.name) == ratio.values.cast<float>().cast<double>());
  CHECK(file.ignored_cells == 0);
}

TEST_CASE("VTU: a mesh without labels is written with 0") {
  const fixture::Folder folder;
  TetMesh mesh = box_mesh({1, 1, 1}, 1, 1, 1);
  mesh.labels.clear();
  write_vtu(folder.path / "a.vtu", mesh);
  CHECK(read_mesh(folder.path / "a.vtu").mesh.labels == std::vector<int>(6, 0));
}

TEST_CASE("VTU: arrays that do not fit the mesh are refused before anything is written") {
  const fixture::Folder folder;
  const TetMesh mesh = box_mesh({1, 1, 1}, 1, 1, 1);
  const auto fault = [&](DataArray array) {
    return fixture::fault_of([&] { write_vtu(folder.path / "a.vtu", mesh, {array}); });
  };
  CHECK_CONTAINS(fault({"u", Eigen::MatrixXd::Zero(3, 7)}),
                 "array 'u' has 7 columns, expected 8 for PointData");
  Eigen::MatrixXd bad = Eigen::MatrixXd::Constant(1, 8, std::numeric_limits<double>::quiet_NaN());
  CHECK_CONTAINS(fault({"r", bad, DataArray::Type::int32}), "array 'r' holds nan, which is no int32");
  CHECK(folder.file_count() == 0);
}

TEST_CASE("VTU: a full disk is a fault, and what was there before stays whole") {
  const fixture::Folder folder;
  const TetMesh small = box_mesh({1, 1, 1}, 1, 1, 1), large = box_mesh({1, 1, 1}, 12, 12, 12);
  write_vtu(folder.path / "a.vtu", small);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit tight{20000, before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &tight);
  const std::string text = fixture::fault_of([&] { write_vtu(folder.path / "a.vtu", large); });
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  CHECK_CONTAINS(text, "a.vtu: cannot be written");
  CHECK(folder.file_count() == 1);
  CHECK(read_mesh(folder.path / "a.vtu").mesh.tet_count() == 6);
}

TEST_CASE("VTU: a pipe or a device is no place for a file, and stays") {
  const fixture::Folder folder;
  const std::filesystem::path pipe = folder.path / "a.vtu";
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  CHECK_CONTAINS(fixture::fault_of([&] {
                   write_vtu(pipe, box_mesh({1, 1, 1}, 1, 1, 1));
                 }),
                 "a.vtu: is a device or a pipe");
  CHECK(std::filesystem::is_fifo(pipe));
}

TEST_CASE("VTU: a folder that is not there is a fault") {
  const fixture::Folder folder;
  CHECK_CONTAINS(fixture::fault_of([&] {
                   write_vtu(folder.path / "no" / "a.vtu", box_mesh({1, 1, 1}, 1, 1, 1));
                 }),
                 "a.vtu: cannot be written: No such file or directory");
}

TEST_CASE("PVD: frames with their times, names escaped") {
  const fixture::Folder folder;
  write_pvd(folder.path / "series.pvd", {{0, "frame_0000.vtu"}, {0.1, "a&b.vtu"}});
  const std::string text = io::read_file(folder.path / "series.pvd");
  CHECK_CONTAINS(text, "<DataSet timestep=\"0\" part=\"0\" file=\"frame_0000.vtu\"/>");
  CHECK_CONTAINS(text, "<DataSet timestep=\"0.1\" part=\"0\" file=\"a&amp;b.vtu\"/>");
  CHECK(folder.file_count() == 1);
}
