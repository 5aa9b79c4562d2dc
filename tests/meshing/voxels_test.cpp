// Surfaces that share walls or overlap, by way of voxels.
#include "lobe_mesh/voxels.h"

#include <algorithm>
#include <numbers>

#include "lobe/mesh/quality.h"
#include "lobe/text.h"
#include "lobe_mesh/model.h"
#include "lobe_mesh/volumes.h"
#include "meshing/shapes.h"
#include "near.h"

using namespace lobe;
using namespace lobe::meshing;
using test::near;

namespace {

Surface block(const Vec3d& low, const Vec3d& high) {
  Surface surface = make_cube(1);
  surface.points = ((high - low).asDiagonal() * surface.points).colwise() + low;
  return surface;
}

std::ptrdiff_t count_of(const LabelImage& image, std::int32_t value) {
  return std::count(image.values.begin(), image.values.end(), value);
}

}  // namespace

TEST_CASE("a voxel has the number of the last surface around its centre") {
  const Surface hollow = joined(make_cube(0.02), inverted(moved(make_cube(0.01), {0.005, 0.005, 0.005})));
  CHECK(count_of(voxelise({hollow}, 0.001), 1) == 20 * 20 * 20 - 10 * 10 * 10);
  const Surface lower = block({0, 0, 0}, {0.02, 0.02, 0.01}),
                upper = block({0, 0, 0.01}, {0.02, 0.02, 0.016}),
                rod = block({0.008, 0.008, -0.004}, {0.012, 0.012, 0.02});
  const LabelImage image = voxelise({lower, upper, rod}, 0.001);
  CHECK(count_of(image, 1) == 20 * 20 * 10 - 4 * 4 * 10);
  CHECK(count_of(image, 2) == 20 * 20 * 6 - 4 * 4 * 6);
  CHECK(count_of(image, 3) == 4 * 4 * 24);
  const LabelImage ball = voxelise({make_sphere(0.01, 4)}, 0.0005);
  CHECK(1.25e-10 * double(count_of(ball, 1)) == near(4e-6 * std::numbers::pi / 3, 0.01));
}

TEST_CASE("surfaces that share a wall become labels that conform, with their volumes") {
  MeshReport report;
  const std::vector<Surface> parts = {block({0, 0, 0}, {0.03, 0.024, 0.009}),
                                      block({0, 0, 0.009}, {0.03, 0.02, 0.015})};
  CHECK(contains(input_error([&] { tetrahedralise(parts, {.edge = 0.004}, report); }), "--voxels EDGE"));
  const TetMesh mesh = tetrahedralise_voxels(parts, 0.001, {.edge = 0.004}, report);
  check_faces(mesh);
  const std::vector<double> volumes = label_volumes(mesh, 2);
  CHECK(volumes[0] == near(0.03 * 0.024 * 0.009, 0.02));
  CHECK(volumes[1] == near(0.03 * 0.02 * 0.006, 0.02));
  CHECK(report.parts[1].label == 1);
}

TEST_CASE("voxels that make no sense are refused") {
  MeshReport report;
  const std::vector<Surface> twice = {make_cube(0.02), make_cube(0.02)};
  CHECK(contains(input_error([&] { tetrahedralise_voxels(twice, 0.002, {.edge = 0.005}, report); }),
                 "surface 0: has no voxel of 0.002 m of its own"));
  CHECK(contains(input_error([&] { voxelise(twice, 0); }), "must be a positive number"));
  CHECK(contains(input_error([&] { voxelise(twice, 1e-6); }),
                 "more than half a billion voxels: choose at least 2.6"));  // 1.05 · 0.02 m / ∛5e8 = 26.5 µm
  const std::string lost =
      input_error([&] { tetrahedralise_voxels({make_cube(0.02)}, 0.02, {.edge = 0.005}, report); });
  CHECK(contains(lost, "surface 0: voxels of 0.02 m lose all of its volume"));
  CHECK(contains(lost, ": --voxels 0.0033 keeps it"));  // half of 2 V/A
  CHECK(contains(input_error([&] {
                   voxelise({make_cube(0.02), block({0.1, 0.1, 0.1}, {0.101, 0.101, 0.101})}, 0.02);
                 }),
                 "surface 1: has no voxel of 0.02 m of its own: it is too small or too thin"));
}

TEST_CASE("voxels that are coarse for a wall are refused with others that keep it, or accepted if asked to") {
  const Surface shell = joined(make_sphere(0.02, 4), inverted(make_sphere(0.018, 4)));  // of 2 mm
  const double volume = enclosed_volume(shell);
  MeshReport report;
  const std::string lost =
      input_error([&] { tetrahedralise_voxels({shell}, 0.003, {.edge = 0.004}, report); });
  CHECK(contains(lost, "surface 0: voxels of 0.003 m lose 64 %"));
  CHECK(contains(lost, "--accept-loss"));
  const double keeping = voxels_that_keep({shell}, 0.75 * 0.003, 0, Winner::later, 1);
  CHECK(contains(lost, "--voxels " + rounded(keeping) + " keeps it"));
  CHECK(keeping > 0.0008);
  CHECK(keeping < 0.0023);
  CHECK(voxels_that_keep({shell}, 0.0008, 0, Winner::later, 1) == 0.0008);  // none need be shorter
  CHECK(voxels_that_keep({inverted(shell)}, 0.003, 0, Winner::later, 1) == 0);
  CHECK(make_model(voxelise({shell}, keeping), 1).total_volume() == near(volume, 1e-9));  // not the voxels'
}

TEST_CASE("of several surfaces the one that voxels lose is named; a mesh of what is left is no success") {
  const Surface ball = make_sphere(0.02, 4), plate = block({0.03, 0.0002, 0.0001}, {0.05, 0.02, 0.0011});
  MeshReport report;
  const MeshOptions options{.edge = 0.006};
  CHECK(contains(input_error([&] {
                   tetrahedralise_voxels({ball, plate}, 0.004, options, report);
                 }),
                 "surface 1: voxels of 0.004 m lose all of its volume"));
  report.parts = {{0, 10, 1e-6, 1e-6}, {1, 5, 0.7e-6, 1e-6}};
  CHECK(report.lost_volume() == near(30, 1e-9));
  CHECK(!report.passes());
}

TEST_CASE("of surfaces that overlap the later one wins, or the smaller one whatever the order") {
  const Surface large = make_cube(0.02), small = block({0.01, 0.01, 0.01}, {0.024, 0.02, 0.02});
  const LabelImage later = voxelise({small, large}, 0.001);
  CHECK(count_of(later, 1) == 4 * 10 * 10);
  CHECK(count_of(later, 2) == 20 * 20 * 20);
  const LabelImage smaller = voxelise({small, large}, 0.001, 0, Winner::smaller);
  CHECK(count_of(smaller, 1) == 14 * 10 * 10);
  CHECK(count_of(smaller, 2) == 20 * 20 * 20 - 1000);
  // A cavity wins in any case.
  const LabelImage hollow = voxelise({small, large}, 0.001, 1, Winner::smaller);
  CHECK(count_of(hollow, 1) == 4 * 10 * 10);
  CHECK(count_of(hollow, 2) == 0);
}

TEST_CASE("a cavity that takes nothing from what is meshed is refused") {
  const Surface body = make_cube(0.02), outside = moved(body, {0.05, 0, 0}),
                around = block({-0.01, -0.01, -0.01}, {0.03, 0.03, 0.03});
  for (const Surface& cavity : {outside, around, body}) {
    CHECK(contains(input_error([&] {
                     make_model({body, cavity}, 1);
                   }),
                   "cavity 0 (--void): takes no space from what is meshed"));
  }
  CHECK(contains(input_error([&] {
                   voxelise({body, outside}, 0.002, 1);
                 }),
                 "cavity 0 (--void): takes no voxel of 0.002 m"));
  CHECK(contains(input_error([&] {
                   voxelise({body, around}, 0.002, 1);
                 }),
                 "surface 0: has no voxel of 0.002 m of its own"));
  const Surface inside = block({0.005, 0.005, 0.005}, {0.01, 0.01, 0.01});
  CHECK(make_model({body, inside}, 1).total_volume() == near(8e-6 - 125e-9, 1e-9));
}
