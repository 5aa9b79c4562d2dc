// Several surfaces, and edges of different lengths.
#include "lobe_mesh/model.h"

#include <cmath>
#include <functional>

#include "lobe/mesh/generators.h"
#include "lobe_mesh/area.h"
#include "lobe_mesh/clean.h"
#include "lobe_mesh/diagnose.h"
#include "lobe_mesh/interfaces.h"
#include "lobe_mesh/shared_walls.h"
#include "lobe_mesh/tetrahedralise.h"
#include "lobe_mesh/volumes.h"
#include "meshing/shapes.h"
#include "near.h"

using namespace lobe;
using namespace lobe::meshing;
using test::near;

namespace {

const Surface organ = make_sphere(0.05, 4);
const Surface tumour = moved(make_sphere(0.012, 3), {0.02, 0, 0});
const Surface cyst = moved(make_sphere(0.005, 2), {0.02, 0, 0.003});  // in the tumour
const Surface vessel = moved(make_sphere(0.008, 2), {-0.025, 0, 0});

// The faces between two labels as a surface, seen from outside of the first.
Surface between(const TetMesh& mesh, int label, int other) {
  std::vector<std::array<Index, 3>> faces;
  for (const InterfaceFace& face : interface_faces(mesh)) {
    if (face.label == label && face.other == other)
      faces.push_back(face.corners);
    else if (face.label == other && face.other == label)
      faces.push_back({face.corners[0], face.corners[2], face.corners[1]});
  }
  Surface surface{mesh.points, Triangles(3, faces.size())};
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (int k = 0; k < 3; ++k) surface.triangles(k, f) = faces[f][k];
  return surface;
}

// A block whose surface has a grid of so many cells: those of neighbours match.
Surface grid_block(const Vec3d& low, const Vec3d& size, int nx, int ny, int nz) {
  CleanReport ignored;
  return moved(clean(boundary_surface(box_mesh(size, nx, ny, nz)), ignored), low);
}

double mean_edge(const TetMesh& mesh, const std::function<bool(const Vec3d&)>& where) {
  double sum = 0;
  Index count = 0;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    if (!where(barycentre(mesh, t))) continue;
    const Mat34<double> x = tet_points(mesh, t);
    for (const auto& e : edge_corners) sum += (x.col(e[0]) - x.col(e[1])).norm() / 6;
    ++count;
  }
  REQUIRE(count > 20);
  return sum / count;
}

}  // namespace

TEST_CASE("a point gets the label of the innermost surface around it, in any order of the surfaces") {
  const Model model = make_model({tumour, organ, cyst, vessel});
  const int parents[] = {1, -1, 0, 1};
  for (int k = 0; k < 4; ++k) {
    CHECK(model.sides[k].inside == k);
    CHECK(model.sides[k].outside == parents[k]);
  }
  CHECK(model.region_at({0, 0, 0}) == 1);
  CHECK(model.region_at({0.02, 0, -0.008}) == 0);
  CHECK(model.region_at({0.02, 0, 0.004}) == 2);
  CHECK(model.region_at({-0.025, 0, 0}) == 3);
  CHECK(model.region_at({0.06, 0, 0}) == -1);
  CHECK(model.total_volume() == near(enclosed_volume(organ), 1e-9));
  CHECK(model.volumes[0] == near(enclosed_volume(tumour) - enclosed_volume(cyst), 1e-9));
}

TEST_CASE("surfaces that touch or intersect are refused with their numbers and the place") {
  const std::string message = input_error([&] { make_model({organ, tumour, moved(organ, {0.04, 0, 0})}); });
  CHECK(contains(message, "surfaces 0 and 2"));
  CHECK(contains(message, "--voxels EDGE"));
  // Two cubes whose common wall has other triangles in each: the place is where they touch.
  const std::vector<Surface> cubes = {grid_block({0, 0, 0}, {0.03, 0.03, 0.03}, 1, 1, 1),
                                      grid_block({0.03, 0, 0}, {0.03, 0.03, 0.03}, 2, 2, 2)};
  CHECK_THROWS_AS(make_model(cubes), SurfacesTouch);
  const std::string touching = input_error([&] { make_model(cubes); });
  CHECK_MESSAGE(contains(touching, "surfaces 0 and 1: touch or intersect near (0.03, "), touching);
}

TEST_CASE("closed surfaces that share walls become labels that conform, with exact walls") {
  const std::vector<Surface> layers = {grid_block({0, 0, 0}, {0.04, 0.03, 0.01}, 8, 6, 2),
                                       grid_block({0, 0, 0.01}, {0.04, 0.03, 0.008}, 8, 6, 2),
                                       grid_block({0, 0, 0.018}, {0.02, 0.03, 0.006}, 4, 6, 1)};
  MeshReport report;
  const TetMesh mesh = tetrahedralise(layers, {.edge = 0.004}, report);
  check_boundary(mesh);
  REQUIRE(report.parts.size() == 3);
  for (std::size_t k = 0; k < 3; ++k) CHECK(report.parts[k].volume == near(enclosed_volume(layers[k]), 1e-6));
  CHECK(area(between(mesh, 0, 1)) == near(0.04 * 0.03, 1e-6));
  CHECK(area(between(mesh, 1, 2)) == near(0.02 * 0.03, 1e-6));
  CHECK(area(between(mesh, 1, -1)) == near(0.02 * 0.03 + 0.008 * 0.14, 1e-6));
  CHECK(between(mesh, 0, 2).triangle_count() == 0);
  CHECK(contains(
      input_error([&] { tetrahedralise(layers, {.edge = 0.004, .mesher = Mesher::tetgen}, report); }),
      "does not keep walls that surfaces share"));
}

TEST_CASE("a surface may share a part of the one around it, and belongs to the inner one") {
  const Surface body = grid_block({0, 0, 0}, {0.04, 0.04, 0.02}, 8, 8, 4),
                lump = grid_block({0.01, 0.01, 0.01}, {0.02, 0.02, 0.01}, 4, 4, 2);
  const Model model = make_model({body, lump});
  CHECK(model.volumes[0] == near(3.2e-5 - 4e-6, 1e-9));
  CHECK(model.volumes[1] == near(4e-6, 1e-9));
  REQUIRE(model.surfaces.size() == 3);  // outside and body, outside and lump, body and lump
  CHECK(area(model.surfaces[1]) == near(0.02 * 0.02, 1e-9));
  CHECK(model.region_at({0.02, 0.02, 0.015}) == 1);
  CHECK(model.region_at({0.005, 0.02, 0.015}) == 0);
  CHECK(model.region_at({0.02, 0.02, 0.021}) == -1);
}

TEST_CASE("cavities are not meshed, and no surface may be there twice") {
  MeshReport report;
  const TetMesh mesh = tetrahedralise({organ, tumour, vessel}, {.edge = 0.007, .cavities = 1}, report);
  check_boundary(mesh);
  REQUIRE(report.parts.size() == 2);
  const double inside[] = {enclosed_volume(organ), enclosed_volume(tumour), enclosed_volume(vessel)};
  CHECK(report.parts[0].volume == near(inside[0] - inside[1] - inside[2], 0.01));
  CHECK(report.parts[1].volume == near(inside[1], accepted_volume_error));
  CHECK(diagnose(between(mesh, 0, -1)).components == 2);
  CHECK(contains(input_error([&] { make_model({organ, organ}); }), "has no space of its own"));
  CHECK(contains(input_error([&] { make_model({organ}, 1); }), "need a surface around them"));
}

TEST_CASE("nested surfaces become labels whose interfaces conform") {
  for (const Mesher mesher : {Mesher::cgal, Mesher::tetgen}) {
    CAPTURE(static_cast<int>(mesher));
    MeshReport report;
    const TetMesh mesh = tetrahedralise({organ, tumour, vessel}, {.edge = 0.007, .mesher = mesher}, report);
    CHECK(report.mesher == mesher);
    CHECK(report.passes());
    check_boundary(mesh);  // no face belongs to more than two tetrahedra, so none hangs
    REQUIRE(report.parts.size() == 3);
    const double inside[] = {enclosed_volume(organ), enclosed_volume(tumour), enclosed_volume(vessel)};
    for (const int label : {1, 2}) {
      CAPTURE(label);
      // Every triangle of the interface belongs to one tetrahedron of either label: together they close.
      const Surface interface = between(mesh, label, 0);
      const Diagnosis diagnosis = diagnose(interface);
      CHECK(diagnosis.closed());
      CHECK(diagnosis.components == 1);
      CHECK(enclosed_volume(interface) == near(report.parts[label].volume, 1e-9));
      CHECK(report.parts[label].volume == near(inside[label], accepted_volume_error));
      CHECK(between(mesh, label, -1).triangle_count() == 0);
    }
    CHECK(between(mesh, 1, 2).triangle_count() == 0);
    CHECK(report.parts[0].volume == near(inside[0] - inside[1] - inside[2], 0.01));
  }
}

TEST_CASE("a label that is too small for the edge keeps its volume by edges of its own") {
  MeshReport report;
  const Surface duct = moved(make_sphere(0.005, 2), {-0.025, 0, 0});
  tetrahedralise({organ, duct}, {.edge = 0.012}, report);
  REQUIRE(report.warnings.size() == 1);
  CHECK(contains(report.warnings[0], "label 1 is smaller than an edge: its edges are 0.003"));
  CHECK(contains(report.warnings[0], "--label-edge 1="));
  CHECK(std::abs(report.parts[1].volume_error()) < 3);
  tetrahedralise({organ, duct}, {.edge = 0.012, .mesher = Mesher::tetgen}, report);
  REQUIRE(report.warnings.size() == 1);
  CHECK(contains(report.warnings[0], "the mesh is below the gate"));  // by its shapes
  CHECK(std::abs(report.parts[1].volume_error()) < 3);
  tetrahedralise({organ, vessel}, {.edge = 0.008, .label_edges = {{1, 0.003}}}, report);
  CHECK(report.warnings.empty());
  CHECK(std::abs(report.parts[1].volume_error()) < 3);
}

TEST_CASE("edges follow the sizes of labels and balls, and grow gradually") {
  MeshReport report;
  const TetMesh mesh = tetrahedralise(
      {organ, tumour},
      {.edge = 0.012, .label_edges = {{1, 0.004}}, .balls = {{{-0.05, 0, 0}, 0.01, 0.004}}, .growth = 0.5},
      report);
  CHECK(report.passes());
  check_boundary(mesh);
  const auto shell = [](const Vec3d& centre, double from, double to) {
    return [=](const Vec3d& p) { return (p - centre).norm() >= from && (p - centre).norm() < to; };
  };
  const Vec3d ball{-0.05, 0, 0}, lump{0.02, 0, 0}, far{0, -0.05, 0};
  const double in_ball = mean_edge(mesh, shell(ball, 0, 0.01)),
               in_tumour = mean_edge(mesh, shell(lump, 0, 0.01)),
               around = mean_edge(mesh, shell(ball, 0.012, 0.018)),
               coarse = mean_edge(mesh, shell(far, 0, 0.02));
  CHECK(in_ball == near(0.004, 0.25));
  CHECK(in_tumour == near(0.004, 0.25));
  CHECK(around > 1.1 * in_ball);
  CHECK(coarse > 2 * in_ball);
  CHECK(report.shortest_edge == near(0.004, 1e-9));
  MeshReport uniform;
  const TetMesh fine = tetrahedralise({organ, tumour}, {.edge = 0.004}, uniform);
  CHECK(fine.tet_count() > 3 * mesh.tet_count());
}

TEST_CASE("far too many tetrahedra are refused, for a body in millimetres with the scale that mends it") {
  MeshReport report;
  const auto refusal = [&](double size) {
    return input_error([&] { tetrahedralise({make_cube(size)}, {.edge = size / 1e4}, report); });
  };
  CHECK(
      contains(refusal(100), "the body is 173.2 m large; if the file is in millimetres, use --scale 0.001"));
  CHECK(contains(refusal(0.1), "choose a longer edge (or --scale, if the units are wrong)"));
}

TEST_CASE("a sizing that makes no sense is refused") {
  const auto refusal = [](const MeshOptions& options) {
    MeshReport report;
    return input_error([&] { tetrahedralise({organ}, options, report); });
  };
  CHECK(contains(refusal({.label_edges = {{1, 0.01}}}), "the labels are 0"));
  CHECK(contains(refusal({.label_edges = {{0, -1}}}), "edge of label 0"));
  CHECK(contains(refusal({.balls = {{{0, 0, 0}, 0.01, 0}}}), "edge of a ball"));
  CHECK(contains(refusal({.balls = {{{0, 0, 0}, 0.01, 1e-6}}}), "million"));
  CHECK(contains(refusal({.balls = {{{0, 0, 0}, 0.01, 0.005}}, .mesher = Mesher::tetgen}), "--mesher cgal"));
}
