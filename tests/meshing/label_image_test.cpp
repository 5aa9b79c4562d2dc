// Label images: what is read, what is refused, and the meshes of them.
#include "lobe_mesh/label_image.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <numbers>

#include "lobe/error.h"
#include "lobe_mesh/diagnose.h"
#include "lobe_mesh/interfaces.h"
#include "lobe_mesh/label_grid.h"
#include "lobe_mesh/label_layers.h"
#include "lobe_mesh/segment_names.h"
#include "lobe_mesh/tetrahedralise.h"
#include "meshing/shapes.h"
#include "near.h"

using namespace lobe;
using namespace lobe::meshing;
using test::near;

namespace {

using LabelAt = std::function<int(const Vec3d&)>;  // of the centre of a voxel [m]

LabelImage make_image(const std::array<Index, 3>& size, const Mat34<double>& to_world, const LabelAt& label) {
  LabelImage image{size, {}, to_world};
  for (Index k = 0; k < size[2]; ++k)
    for (Index j = 0; j < size[1]; ++j)
      for (Index i = 0; i < size[0]; ++i)
        image.values.push_back(label(to_world * Eigen::Vector4d(i, j, k, 1)));
  return image;
}

Mat34<double> aligned(const Vec3d& spacing, const Vec3d& origin) {
  Mat34<double> to_world;
  to_world << Mat3<double>(spacing.asDiagonal()), origin;
  return to_world;
}

// Voxels of 1 mm; a ball around the origin.
LabelImage ball(
    double radius, const LabelAt& label = [](const Vec3d&) { return 1; }) {
  const auto half = static_cast<Index>(std::ceil(radius / 1e-3)) + 1;
  const Index n = 2 * half + 1;
  return make_image({n, n, n}, aligned(Vec3d::Constant(1e-3), Vec3d::Constant(-1e-3 * half)),
                    [&](const Vec3d& x) { return x.norm() <= radius ? label(x) : 0; });
}

double length(const Mat3X<double>& line) {
  const auto n = line.cols() - 1;
  return (line.rightCols(n) - line.leftCols(n)).colwise().norm().sum();
}

double voxels(const LabelImage& image, int label) {
  return static_cast<double>(std::count(image.values.begin(), image.values.end(), label));
}

TetMesh mesh_of(const LabelImage& image, const MeshOptions& options, MeshReport& report) {
  const TetMesh mesh = tetrahedralise(image, options, report);
  check_faces(mesh);
  return mesh;
}

std::string nrrd_header(const std::string& rest, const std::string& sizes = "3 2 1") {
  return "NRRD0004\ndimension: 3\nsizes: " + sizes + "\nendian: little\n" + rest + "\n";
}

const std::string lps =
    "space: left-posterior-superior\nspace directions: (2,0,0) (0,3,0) (0,0,4)\n"
    "space origin: (10,20,30)\n";
const std::string six_bytes("\0\1\2\0\0\7", 6);

template <class Value>
void put(std::string& bytes, std::size_t at, Value value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

// A NIfTI-1 header of 3 × 2 × 1 voxels of type unsigned char, in millimetres, with an sform.
std::string nifti(const std::string& voxels = six_bytes) {
  std::string bytes(352, '\0');
  put<std::int32_t>(bytes, 0, 348);
  const std::int16_t dim[] = {3, 3, 2, 1, 1, 1, 1, 1};
  std::memcpy(bytes.data() + 40, dim, sizeof dim);
  put<std::int16_t>(bytes, 70, 2);  // unsigned char
  put<std::int16_t>(bytes, 72, 8);
  const float pixdim[] = {1, 2, 3, 4, 1, 1, 1, 1};
  std::memcpy(bytes.data() + 76, pixdim, sizeof pixdim);
  put<float>(bytes, 108, 352);
  bytes[123] = 2;  // millimetres
  put<std::int16_t>(bytes, 254, 1);
  const float rows[] = {2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30};
  std::memcpy(bytes.data() + 280, rows, sizeof rows);
  std::memcpy(bytes.data() + 344, "n+1", 4);
  return bytes + voxels;
}

}  // namespace

TEST_CASE("NRRD images are read with spacing, origin, orientation and unit") {
  const SurfaceFolder folder;
  const auto read = [&](const std::string& text) { return read_label_image(folder.write("a.nrrd", text)); };
  const LabelImage image = read(nrrd_header("type: uchar\nencoding: raw\n" + lps) + six_bytes);
  CHECK(image.size == std::array<Index, 3>{3, 2, 1});
  CHECK(image.values == std::vector<std::int32_t>{0, 1, 2, 0, 0, 7});
  CHECK(image.to_world == aligned({2, 3, 4}, {10, 20, 30}));
  // To the right and to the front becomes to the left and to the back; millimetres become metres.
  std::string ras = lps;
  ras.replace(ras.find("left-posterior"), 14, "right-anterior");
  const std::string millimetres = "space units: \"mm\" \"mm\" \"mm\"\n";
  const LabelImage turned = read(nrrd_header("type: uchar\nencoding: raw\n" + ras + millimetres) + six_bytes);
  CHECK(turned.to_world.isApprox(Vec3d(-1e-3, -1e-3, 1e-3).asDiagonal() * image.to_world));
  // Any axes, here a rotation by 90° about z; text and two bytes per voxel.
  const LabelImage oblique =
      read(nrrd_header("type: short\nencoding: ascii\nspace: left-posterior-superior\nspace directions: "
                       "(0,2,0) (-3,0,0) (0,0,4)\n"
                       "space origin: (0,0,0)\n") +
           "0 1 2 0 0 300\n");
  CHECK(oblique.values.back() == 300);
  CHECK(oblique.to_world.col(0) == Vec3d(0, 2, 0));
  CHECK(oblique.to_world.col(1) == Vec3d(-3, 0, 0));
  const LabelImage spaced = read(nrrd_header("type: uchar\nencoding: raw\nspacings: 2 3 4\n") + six_bytes);
  CHECK(spaced.to_world == aligned({2, 3, 4}, {0, 0, 0}));
}

TEST_CASE("NIfTI images are read with spacing, origin, orientation and unit") {
  const SurfaceFolder folder;
  const LabelImage image = read_label_image(folder.write("a.nii", nifti()));
  CHECK(image.size == std::array<Index, 3>{3, 2, 1});
  CHECK(image.values == std::vector<std::int32_t>{0, 1, 2, 0, 0, 7});
  CHECK(image.to_world.isApprox(Vec3d(-1e-3, -1e-3, 1e-3).asDiagonal() * aligned({2, 3, 4}, {10, 20, 30})));
  const std::string packed = (folder.path / "b.nii.gz").string();
  REQUIRE(std::system(("gzip -c " + (folder.path / "a.nii").string() + " >" + packed).c_str()) == 0);
  CHECK(read_label_image(packed).values == image.values);
}

TEST_CASE("whole numbers that are stored as floating-point ones are labels") {
  const SurfaceFolder folder;
  const std::vector<std::int32_t> expected{0, 1, 2, 0, 0, 7};
  const float singles[] = {0, 1, 2, 0, 0, 7};
  std::string bytes = nifti(std::string(reinterpret_cast<const char*>(singles), sizeof singles));
  put<std::int16_t>(bytes, 70, 16);
  put<std::int16_t>(bytes, 72, 32);
  CHECK(read_label_image(folder.write("a.nii", bytes)).values == expected);
  const std::string text = nrrd_header("type: double\nencoding: ascii\n" + lps) + "0 1 2 0 -0 7\n";
  CHECK(read_label_image(folder.write("a.nrrd", text)).values == expected);
}

TEST_CASE("images that are no segmentations are refused with the reason") {
  const SurfaceFolder folder;
  const auto refusal = [&](const std::string& name, const std::string& text) {
    return input_error([&] { read_label_image(folder.write(name, text)); });
  };
  CHECK(contains(refusal("a.nrrd", nrrd_header("type: float\nencoding: ascii\n" + lps) + "0 1 2 0 0.5 nan\n"),
                 "2 of its 6 voxels are no whole numbers below 2^31, the first is 0.5 at (1, 1, 0)"));
  CHECK(contains(refusal("a.nrrd", nrrd_header("type: double\nencoding: ascii\n" + lps) + "0 1 2 0 0 3e9\n"),
                 "the first is 3e+09 at (2, 1, 0)"));
  CHECK(contains(refusal("a.nrrd", nrrd_header("type: uchar\nencoding: raw\n" + lps) + "abc"), "teem"));
  CHECK(contains(refusal("a.nrrd", nrrd_header("type: uchar\nencoding: raw\n" + lps, "30000 30000 30000")),
                 "too large"));
  CHECK(contains(refusal("a.nrrd", nrrd_header("type: uchar\nencoding: raw\n") + six_bytes), "orientation"));
  CHECK(contains(refusal("a.nrrd", nrrd_header("type: uchar\nencoding: raw\nspace: left-posterior-superior\n"
                                               "space directions: (1,0,0) (1,0,0) (0,0,1)\n"
                                               "space origin: (0,0,0)\n") +
                                       six_bytes),
                 "orientation"));
  CHECK(contains(refusal("a.nrrd", nrrd_header("type: uchar\nencoding: raw\n" + lps +
                                               "space units: \"inch\" \"mm\" \"mm\"\n") +
                                       six_bytes),
                 "inch"));
  CHECK(contains(refusal("a.nrrd", ""), "teem"));
  CHECK(contains(refusal("a.nii", "hello"), "not a NIfTI file"));
  CHECK(contains(refusal("a.nii", nifti("ab")), "truncated"));
  std::string bytes = nifti();
  put<std::int16_t>(bytes, 254, 0);
  CHECK(contains(refusal("a.nii", bytes), "orientation"));
  bytes = nifti(std::string(48, '\0'));
  put<std::int16_t>(bytes, 70, 32);  // complex
  put<std::int16_t>(bytes, 72, 64);
  CHECK(contains(refusal("a.nii", bytes), "save the segmentation with an integer type"));
  bytes = nifti();
  put<float>(bytes, 112, 0.5F);  // slope
  CHECK(contains(refusal("a.nii", bytes), "scaled"));
  bytes = nifti(std::string(12, '\0'));
  const std::int16_t dim[] = {4, 3, 2, 1, 2};
  std::memcpy(bytes.data() + 40, dim, sizeof dim);
  CHECK(contains(refusal("a.nii", bytes), "more than 3 axes"));
  CHECK(contains(input_error([&] { read_label_image(folder.path / "none.nii"); }), "no such file"));

  const auto content = [](const LabelAt& label, double smoothing = 1) {
    return input_error([&] {
      make_label_grid(make_image({8, 8, 8}, aligned(Vec3d::Ones(), Vec3d::Zero()), label), smoothing);
    });
  };
  CHECK(contains(content([](const Vec3d&) { return 0; }), "empty"));
  CHECK(contains(content([](const Vec3d&) { return 5; }), "only one value"));
  CHECK(contains(content([](const Vec3d& x) { return x.x() < 4 ? -1 : 0; }), "-1"));
  CHECK(contains(content([](const Vec3d& x) { return static_cast<int>(x.x() + 8 * x.y() + 64 * x.z()); }),
                 "not a segmentation"));
  CHECK(contains(content([](const Vec3d& x) { return x == Vec3d(4, 4, 4) ? 9 : 0; }), "--smoothing 0"));
  CHECK(contains(content([](const Vec3d& x) { return x.x() < 4 ? 1 : 0; }, 9), "expected 0 … 5"));
}

TEST_CASE(
    "without smoothing a point has the label of the voxel around it, also in a turned and mirrored image") {
  Mat34<double> to_world;
  to_world << 0, -3, 0, 5, 2, 0, 0, -1, 0, 0, -4, 2;
  const auto label = [](const Vec3d& x) { return x.y() < 2 ? 4 : x.x() > 0 ? 0 : 2; };
  const LabelImage image = make_image({6, 5, 4}, to_world, label);
  const LabelGrid grid = make_label_grid(image, 0);
  CHECK(grid.values == std::vector<int>{2, 4});
  CHECK(grid.volumes[0] == near(24 * voxels(image, 2), 1e-9));
  const RegionAt region(grid);
  for (Index k = 0; k < 4; ++k)
    for (Index j = 0; j < 5; ++j)
      for (Index i = 0; i < 6; ++i) {
        const int value = image.at(i, j, k);
        CHECK(region(to_world * Eigen::Vector4d(i, j, k, 1)) == (value == 2 ? 1 : value == 4 ? 2 : 0));
      }
  CHECK(region(to_world * Eigen::Vector4d(-0.6, 2, 2, 1)) == 0);  // half a voxel outside
  CHECK(region(to_world * Eigen::Vector4d(-0.4, 2, 2, 1)) != 0);
}

TEST_CASE("surfaces face outwards, also in a mirrored image") {
  for (const double side : {1.0, -1.0}) {
    LabelImage image = ball(8e-3);
    image.to_world.row(1) *= side;
    const Surface surface = label_surfaces(make_label_grid(image, 1)).surfaces.front();
    CHECK(enclosed_volume(surface) == near(1e-9 * voxels(image, 1), 0.03));
    MeshReport report;
    CHECK(total_volume(mesh_of(image, {.edge = 4e-3}, report)) > 0);
  }
}

TEST_CASE("the smoothing takes the steps from a ball, not its volume") {
  const LabelImage image = ball(12e-3);
  const double volume = 1e-9 * voxels(image, 1), radius = std::cbrt(3 * volume / (4 * std::numbers::pi));
  const auto roughness = [&](double smoothing) {
    const auto [surfaces, sides, junctions] = label_surfaces(make_label_grid(image, smoothing));
    CHECK(junctions.empty());
    REQUIRE(surfaces.size() == 1);
    CHECK(sides[0].inside == 0);
    CHECK(sides[0].outside == -1);
    CHECK(diagnose(surfaces[0]).meshable());
    CHECK(enclosed_volume(surfaces[0]) == near(volume, 0.012));  // chords of one voxel
    const Eigen::RowVectorXd distance = surfaces[0].points.colwise().norm().array() - radius;
    CHECK(std::abs(distance.mean()) < 0.05e-3);
    return std::sqrt(distance.squaredNorm() / static_cast<double>(distance.size()));
  };
  CHECK(roughness(1) < 0.75 * roughness(0));
  CHECK(roughness(2) < 0.6 * roughness(0));
}

TEST_CASE("the surface of a box of voxels lies on their faces, with smoothing to 0.14 voxels") {
  const Vec3d spacing(1, 2, 3);
  const LabelImage image = make_image({20, 20, 20}, aligned(spacing, {10, 20, 30}), [&](const Vec3d& x) {
    return x.x() < 26 && x.y() > 25 && x.z() > 40 && x.z() < 80 ? 1 : 0;
  });
  const auto voxels_off = [&](double smoothing) {
    const Surface surface = label_surfaces(make_label_grid(image, smoothing)).surfaces.front();
    const Vec3d low = surface.points.rowwise().minCoeff() - Vec3d(9.5, 25, 40.5),
                high = surface.points.rowwise().maxCoeff() - Vec3d(25.5, 59, 79.5);
    return std::max(low.cwiseQuotient(spacing).cwiseAbs().maxCoeff(),
                    high.cwiseQuotient(spacing).cwiseAbs().maxCoeff());
  };
  CHECK(voxels_off(0) < 1e-9);
  CHECK(voxels_off(1) < 0.14);  // beside the edges of the box
}

TEST_CASE("a ball of voxels becomes a good mesh of its volume") {
  const LabelImage image = ball(12e-3);
  for (const double edge : {4e-3, 2e-3}) {
    CAPTURE(edge);
    MeshReport report;
    const TetMesh mesh = mesh_of(image, {.edge = edge}, report);
    check_boundary(mesh);
    CHECK(report.passes());
    CHECK(report.surface_volume == near(1e-9 * voxels(image, 1), 1e-9));
    CHECK(total_volume(mesh) == near(report.surface_volume, 0.01));
    // These voxels are 1.2 % less than the ball through whose centres they were chosen.
    CHECK(total_volume(mesh) == near(4.0 / 3 * std::numbers::pi * std::pow(12e-3, 3), 0.022));
  }
}

TEST_CASE("the mesh of a box of flat voxels has its place and, but for its edges, its volume") {
  // 28 × 14 × 12 voxels of 1 × 1 × 2 mm; along x they fill the image.
  const LabelImage image =
      make_image({28, 20, 20}, aligned({1e-3, 1e-3, 2e-3}, {0.1, -0.2, 0.3}), [](const Vec3d& x) {
        return x.y() > -0.1975 && x.y() < -0.1835 && x.z() > 0.307 && x.z() < 0.331 ? 3 : 0;
      });
  REQUIRE(voxels(image, 3) == 28 * 14 * 12);
  double lost[2];
  for (int i = 0; i < 2; ++i) {
    MeshReport report;
    const TetMesh mesh = mesh_of(image, {.edge = i == 0 ? 3e-3 : 1.5e-3}, report);
    CHECK(std::all_of(mesh.labels.begin(), mesh.labels.end(), [](int label) { return label == 3; }));
    const Vec3d low = mesh.points.rowwise().minCoeff(), high = mesh.points.rowwise().maxCoeff();
    CHECK((low - Vec3d(0.0995, -0.1975, 0.307)).cwiseAbs().maxCoeff() < 0.5e-3);
    CHECK((high - Vec3d(0.1275, -0.1835, 0.331)).cwiseAbs().maxCoeff() < 0.5e-3);
    lost[i] = 28 * 14 * 12 * 2e-9 - total_volume(mesh);
  }
  CHECK(lost[0] < 0.02 * 28 * 14 * 12 * 2e-9);  // edges are rounded
  CHECK(lost[1] < 0.6 * lost[0]);
  CHECK(lost[1] > 0);
}

TEST_CASE("labels meet in lines") {
  // Two halves of a ball and what is outside meet in a circle.
  const double radius = 10e-3;
  const LabelImage image = ball(radius, [](const Vec3d& x) { return x.z() < 0 ? 1 : 2; });
  const auto [surfaces, sides, junctions] = label_surfaces(make_label_grid(image, 1));
  CHECK(surfaces.size() == 3);
  REQUIRE(junctions.size() == 1);
  const Mat3X<double>& line = junctions[0];
  CHECK(line.col(0) == line.col(line.cols() - 1));
  CHECK(std::abs(line.row(2).maxCoeff()) < 0.8e-3);
  CHECK((line.topRows<2>().colwise().norm().array() - radius).abs().maxCoeff() < 0.8e-3);
  CHECK(length(line) == near(2 * std::numbers::pi * radius, 0.05));
}

TEST_CASE("a tube through a ball meets its surface in two circles, whatever the direction") {
  const double radius = 8e-3;
  for (const Vec3d& direction : {Vec3d(0, 0, 1), Vec3d(1, 1, 1), Vec3d(1, 0.4, 0.7), Vec3d(0.1, 1, -0.3)}) {
    const Vec3d along = direction.normalized();
    const LabelImage image =
        ball(16e-3, [&](const Vec3d& x) { return x.cross(along).norm() < radius ? 2 : 1; });
    const std::vector<Mat3X<double>> junctions = label_surfaces(make_label_grid(image, 1)).junctions;
    CHECK(junctions.size() == 2);
    for (const Mat3X<double>& line : junctions) {
      CHECK(line.col(0) == line.col(line.cols() - 1));
      CHECK(length(line) == near(2 * std::numbers::pi * radius, 0.05));
    }
  }
}

TEST_CASE("labels that share walls conform, with the volumes of their voxels") {
  const LabelImage image = ball(14e-3, [](const Vec3d& x) {
    return (x - Vec3d(0, 5e-3, 0)).norm() < 5e-3 ? 9 : x.x() < 0 ? 3 : 7;
  });
  MeshReport report;
  const TetMesh mesh = mesh_of(image, {.edge = 2e-3}, report);
  check_boundary(mesh);
  REQUIRE(report.parts.size() == 3);
  const int labels[] = {3, 7, 9};
  for (int k = 0; k < 3; ++k) {
    CHECK(report.parts[k].label == labels[k]);
    CHECK(report.parts[k].surface_volume == near(1e-9 * voxels(image, labels[k]), 1e-9));
    CHECK(report.parts[k].volume == near(report.parts[k].surface_volume, 0.03));
    CHECK(std::count(mesh.labels.begin(), mesh.labels.end(), labels[k]) == report.parts[k].tets);
  }
  CHECK(report.quality.volume == near(report.surface_volume, 0.01));
  CHECK(report.quality.min_dihedral > 8);
}

TEST_CASE(
    "parts that touch at an edge only are meshed, with a warning where the boundary then touches itself") {
  const LabelImage image =
      make_image({24, 24, 12}, aligned(Vec3d::Constant(1e-3), Vec3d::Zero()),
                 [](const Vec3d& x) { return (x.x() < 11.5e-3) == (x.y() < 11.5e-3) ? 1 : 0; });
  MeshReport report;
  const TetMesh mesh = mesh_of(image, {.edge = 3e-3, .smoothing = 0}, report);
  CHECK(total_volume(mesh) == near(2 * 12e-3 * 12e-3 * 12e-3, 0.06));
  const Diagnosis boundary = diagnose(boundary_surface(mesh));
  const Index pinches = boundary.non_manifold_edges.count + boundary.non_manifold_points.count;
  const bool warned = std::any_of(report.warnings.begin(), report.warnings.end(),
                                  [](const std::string& text) { return contains(text, "touches itself"); });
  CHECK(warned == (pinches > 0));
  CHECK(pinches > 0);
}

TEST_CASE("edges follow the labels of an image, and its unit does not matter") {
  const auto core = [](const Vec3d& x) { return x.norm() < 5e-3 ? 2 : 1; };
  LabelImage image = ball(14e-3, core);
  MeshReport coarse, fine;
  mesh_of(image, {.edge = 4e-3}, coarse);
  const TetMesh mesh = mesh_of(image, {.edge = 4e-3, .label_edges = {{2, 1.5e-3}}}, fine);
  CHECK(fine.parts[1].tets > 5 * coarse.parts[1].tets);
  CHECK(fine.shortest_edge == near(1.5e-3, 1e-9));
  image.to_world *= 1024;
  const TetMesh large =
      tetrahedralise(image, {.edge = 4e-3 * 1024, .label_edges = {{2, 1.5e-3 * 1024}}}, coarse);
  CHECK(large.tets == mesh.tets);
  const auto refusal = [&](const MeshOptions& options) {
    return input_error([&] { tetrahedralise(image, options, coarse); });
  };
  CHECK(contains(refusal({.label_edges = {{0, 1}}}), "the labels are 1, 2"));
  CHECK(contains(refusal({.mesher = Mesher::tetgen}), "--mesher cgal"));
}

TEST_CASE("an NRRD image of layers of segments is read with their names") {
  const SurfaceFolder folder;
  const std::string header =
      "NRRD0004\ndimension: 4\nsizes: 2 3 1 1\nendian: little\ntype: uchar\nencoding: raw\n"
      "space: left-posterior-superior\nspace directions: none (2,0,0) (0,3,0) (0,0,4)\n"
      "kinds: list domain domain domain\nspace origin: (10,20,30)\n"
      "Segment0_LabelValue:=1\nSegment0_Layer:=0\nSegment0_Name:=liver\n"
      "Segment1_LabelValue:=1\nSegment1_Layer:=1\nSegment1_Name:=tumour\n\n";
  const LabelImage image = read_label_image(folder.write("a.nrrd", header + std::string("\0\0\1\1\1\0", 6)));
  CHECK(image.size == std::array<Index, 3>{3, 1, 1});
  CHECK(image.values == std::vector<std::int32_t>{0, 2, 1});
  CHECK(image.to_world == aligned({2, 3, 4}, {10, 20, 30}));
  REQUIRE(image.notes.size() == 1);
  CHECK(image.notes[0].starts_with("its segments are in layers: label 1 is liver, label 2 is tumour;"));
  CHECK(segment_names(folder.path / "a.nrrd") == std::map<int, std::string>{{1, "liver"}, {2, "tumour"}});
  const std::string covering = header + std::string("\0\1\1\1\0\1", 6);  // the tumour is all of the liver
  CHECK(contains(input_error([&] { read_label_image(folder.write("c.nrrd", covering)); }),
                 "later segments cover label 1 (liver) wholly: move it behind them"));
  std::string fourth = header;
  fourth.replace(fourth.find("none"), 4, "(1,0,0)");
  CHECK_THROWS_AS(read_label_image(folder.write("b.nrrd", fourth + std::string(6, '\0'))), InputError);
}

TEST_CASE("an NRRD image without a unit is in metres, and one of 3D Slicer in millimetres") {
  const SurfaceFolder folder;
  const std::string header = "NRRD0005\ndimension: 3\nsizes: 3 2 1\ntype: uchar\nencoding: raw\n" + lps;
  const std::string slicer = "Segment0_ID:=Segment_1\nSegment0_LabelValue:=1\n",
                    centimetres = "space units: \"cm\" \"cm\" \"cm\"\n";
  const auto read = [&](const std::string& text) {
    return read_label_image(folder.write("a.seg.nrrd", text + "\n" + six_bytes));
  };
  const auto unit_of = [&](const std::string& text) {
    return read_label_image(folder.write("a.seg.nrrd", text + "\n" + six_bytes)).assumed_unit;
  };
  const Mat34<double> axes = aligned({2, 3, 4}, {10, 20, 30});
  CHECK(read(header).to_world == axes);
  CHECK(unit_of(header) == 1);
  CHECK(read(header + slicer).to_world == 1e-3 * axes);
  CHECK(unit_of(header + slicer) == 1e-3);
  const auto names_of = [&](const std::string& text) {
    return segment_names(folder.write("a.seg.nrrd", text + "\n" + six_bytes));
  };
  CHECK(names_of(header + slicer + "Segment0_Name:=left lung\n") ==
        std::map<int, std::string>{{1, "left lung"}});
  CHECK(names_of(header + slicer).empty());
  CHECK(read(header + centimetres + slicer).to_world.isApprox(1e-2 * axes));
  CHECK(unit_of(header + centimetres + slicer) == 0);
  const std::string spaced =
      "NRRD0005\ndimension: 3\nsizes: 3 2 1\ntype: uchar\nencoding: raw\nspacings: 2 3 4\n";
  CHECK(unit_of(spaced) == 1);
  CHECK(unit_of(spaced + "units: \"mm\" \"mm\" \"mm\"\n") == 0);
}

TEST_CASE("a NIfTI image says whether it names its unit") {
  const SurfaceFolder folder;
  std::string bytes = nifti();
  const auto read = [&](char unit) {
    bytes[123] = unit;
    return read_label_image(folder.write("a.nii", bytes));
  };
  CHECK(read(2).assumed_unit == 0);
  CHECK(read(1).assumed_unit == 0);
  CHECK(read(3).assumed_unit == 0);
  const LabelImage unnamed = read(0);
  CHECK(unnamed.assumed_unit == 1);
  CHECK(unnamed.to_world == read(1).to_world);  // metres
  CHECK(read(8).assumed_unit == 1);             // seconds of another axis
}

TEST_CASE("the size of a body is that of its voxels, without those of the background") {
  const LabelImage image = make_image({9, 9, 9}, aligned({1, 2, 3}, {5, 5, 5}), [](const Vec3d& x) {
    return x.x() >= 7 && x.x() <= 9 && x.y() == 9 && x.z() >= 11 && x.z() <= 14 ? 4 : 0;  // 3 × 1 × 2 voxels
  });
  CHECK(body_diagonal(image) == near(std::sqrt(9 + 4 + 36), 1e-12));
  CHECK(body_diagonal(make_image({3, 3, 3}, aligned({1, 1, 1}, {0, 0, 0}), [](const Vec3d&) { return 0; })) ==
        0);
}

TEST_CASE("segments in layers get labels in their order, and the last one where they overlap") {
  // Two layers of five voxels: 1 1 1 1 0 and 0 0 1 2 2.
  const std::vector<std::int32_t> values{1, 0, 1, 0, 1, 1, 1, 2, 0, 2};
  const MergedLayers merged = merge_layers(values, 2, {{1, 2, "vessel"}, {0, 1, "liver"}, {1, 1, "tumour"}});
  CHECK(merged.values == std::vector<std::int32_t>{2, 2, 3, 2, 1});
  CHECK(merged.shared == 2);
  CHECK(words_of(merged) ==
        "its segments are in layers: label 1 is vessel, label 2 is liver, label 3 is tumour; of several "
        "segments that overlap the last one is taken, in 2 voxels");
  // A list that does not name all of them is not that of the voxels.
  const MergedLayers found = merge_layers(values, 2, {{0, 1, "liver"}, {0, 2, "tumour"}});
  CHECK(found.values == std::vector<std::int32_t>{1, 1, 2, 3, 3});
  CHECK(words_of(found).starts_with(
      "its segments are in layers: label 1 is the value 1 of layer 0, label 2 is the value 1 of layer 1"));
}
