#include "lobe/skin/skin.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <fstream>
#include <map>
#include <numeric>
#include <set>

#include "folder.h"
#include "lobe/error.h"
#include "lobe/fem/body.h"
#include "lobe/mesh/surface.h"
#include "near.h"
#include "textured.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Mat3X<double> normals_of(const Mat3X<double>& x, const Triangles& triangles) {
  Mat3X<double> normals = Mat3X<double>::Zero(3, x.cols());
  for (const auto& t : triangles.colwise())
    for (Index v : t) {
      const Vec3d a = x.col(t[0]), b = x.col(t[1]), c = x.col(t[2]);
      normals.col(v) += (b - a).cross(c - a);
    }
  normals.colwise().normalize();
  return normals;
}

std::vector<Index> shuffled_tets(Index count, unsigned seed) {
  std::vector<Index> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  return order;
}

// Rest positions, which copies share with what they are copies of.
Mat3X<double> points_of(const Topology& topology, const TetMesh& mesh) {
  Mat3X<double> points(3, topology.vertex_count());
  for (Index v = 0; v < topology.vertex_count(); ++v) points.col(v) = mesh.points.col(topology.origin(v));
  return points;
}

// How much longer an edge of a shown triangle is than at rest, the most of all.
double longest_stretch(const Skin& skin, const TexturedSurface& surface, const Mat3X<float>& x) {
  double stretch = 0;
  for (const Eigen::Vector3i& t : skin.mesh().triangles)
    for (int i = 0; i < 3; ++i) {
      const Index a = t[i], b = t[(i + 1) % 3];
      const double rest =
          (surface.points.col(skin.mesh().file_vertex[a]) - surface.points.col(skin.mesh().file_vertex[b]))
              .norm();
      stretch = std::max(stretch, double((x.col(a) - x.col(b)).norm()) / rest);
    }
  return stretch;
}

double largest_singular_value(const Topology& topology, const Mat3X<double>& X, const Mat3X<double>& x) {
  double largest = 0;
  for (Index t = 0; t < topology.tet_count(); ++t) {
    if (!topology.alive(t)) continue;
    const Mat34<double> rest = X(Eigen::all, topology.corners(t)), now = x(Eigen::all, topology.corners(t));
    const Mat3<double> D = rest.rightCols<3>().colwise() - rest.col(0);
    const Mat3<double> d = now.rightCols<3>().colwise() - now.col(0);
    largest = std::max(largest, Eigen::JacobiSVD<Mat3<double>>(d * D.inverse()).singularValues()[0]);
  }
  return largest;
}

std::set<Index> shown(const Skin& skin) {
  return {skin.mesh().file_triangle.begin(), skin.mesh().file_triangle.end()};
}

TexturedSurface obj(const std::string& text) {
  const Folder folder;
  std::ofstream(folder.path / "skin.obj") << text;
  return read_obj(folder.path / "skin.obj");
}

std::string fault_of(const std::string& text) {
  try {
    obj(text);
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(what.find("skin.obj") + 8);
  }
  return "none";
}

// A cube [0, 1] with a normal and a square of texture for each side.
const char* const cube_obj = R"(# a cube
mtllib none.mtl
v 0 0 0
v 1 0 0
v 0 1 0
v 1 1 0
v 0 0 1
v 1 0 1
v 0 1 1
v 1 1 1 0.5 0.5 0.5
vt 0 0
vt 1 0
vt 1 1
vt 0 1 0
vn -1 0 0
vn 1 0 0
vn 0 -1 0
vn 0 1 0
vn 0 0 -1
vn 0 0 1
s off
f 1/1/1 5/2/1 7/3/1 3/4/1
f 2/1/2 4/2/2 8/3/2 6/4/2
f 1/1/3 2/2/3 6/3/3 5/4/3
f 3/1/4 7/2/4 8/3/4 4/4/4
f 1/1/5 3/2/5 \
  4/3/5 2/4/5
f -4/-4/-1 -3/-3/-1 -1/-2/-1 -2/-1/-1
)";

}  // namespace

TEST_CASE("affine motion of the body is that of the skin, outside of the tetrahedra as well") {
  const TetMesh mesh = irregular_box(4);
  Mat3<double> F;
  F << 1.1, 0.2, -0.1, /**/ 0.05, 0.9, 0.3, /**/ -0.2, 0.1, 1.2;
  const Vec3d shift(0.01, -0.02, 0.03);
  const Mat3X<double> u = affine_displacement(mesh.points, F).colwise() + shift;
  for (const double factor : {0.9, 1.0, 1.1}) {
    const TexturedSurface surface = fine_boundary_of(mesh, 1, factor);
    Skin skin(surface, mesh);
    CHECK((skin.farthest() > 1e-4) == (factor > 1));
    const Mat3X<double> expected = (F * surface.points).colwise() + shift;
    const Mat3X<double> expected_normals = normals_of(expected, surface.triangles);
    Mat3X<float> x, normals, x_single, normals_single;
    skin.update(mesh.points, u, x, normals);
    skin.update(mesh.points, u.cast<float>().eval(), x_single, normals_single);
    for (Index i = 0; i < skin.mesh().vertex_count(); ++i) {
      const Index v = skin.mesh().file_vertex[i];
      CHECK((x.col(i).cast<double>() - expected.col(v)).norm() < 5e-8);  // of 0.1 m, whose rounding is 7e-9
      CHECK((normals.col(i).cast<double>() - expected_normals.col(v)).norm() < 2e-5);
    }
    CHECK((x - x_single).cwiseAbs().maxCoeff() < 5e-8F);
    CHECK((normals - normals_single).cwiseAbs().maxCoeff() < 2e-5F);
  }
}

TEST_CASE("a rigid rotation turns normals") {
  const TetMesh mesh = cylinder_mesh(0.02, 0.04, 3, 3);
  Skin skin(fine_boundary_of(mesh, 1, 1.02), mesh);
  const Mat3<double> R = Eigen::AngleAxisd(2.1, Vec3d(1, -2, 0.5).normalized()).toRotationMatrix();
  Mat3X<float> x, normals, turned_x, turned;
  skin.update(mesh.points, Mat3X<double>::Zero(3, mesh.vertex_count()).eval(), x, normals);
  skin.update(mesh.points, affine_displacement(mesh.points, R), turned_x, turned);
  CHECK((turned - R.cast<float>() * normals).cwiseAbs().maxCoeff() < 1e-4F);
  CHECK((normals.colwise().norm().array() - 1).abs().maxCoeff() < 1e-6F);
}

TEST_CASE("where the skin is the boundary itself, it opens as the surface does") {
  const TetMesh mesh = irregular_box(5);
  const TexturedSurface boundary = textured_boundary(mesh);
  const Topology uncut(mesh);
  for (unsigned seed : {1U, 2U, 3U}) {
    Topology topology(mesh);
    const std::vector<RegionModel> regions(std::size_t(mesh.tet_count()), RegionModel::nonlinear);
    Surface surface(topology, regions);
    Skin skin(boundary, mesh);
    int splits = 0;
    for (Index t : shuffled_tets(mesh.tet_count(), seed)) {
      const MeshEdit edit = topology.remove(std::vector<Index>{t});
      surface.follow(topology, edit, regions);
      skin.follow(topology, edit);
      splits += int(edit.splits.size());
      std::set<Index> skin_faces;
      for (Index i = 0; i < Index(uncut.boundary_faces().size()); ++i) {
        const Index code = uncut.boundary_faces()[i];
        if (surface.triangle_of({code / 4, std::uint32_t(code % 4)}) >= 0) skin_faces.insert(i);
      }
      const std::set<Index> now = shown(skin);
      CHECK(std::includes(skin_faces.begin(), skin_faces.end(), now.begin(), now.end()));
      if (splits > 0) continue;
      CHECK(now == skin_faces);
      Skin at_once(boundary, mesh);
      at_once.follow_all(topology);
      CHECK(shown(at_once) == now);
    }
    CHECK(splits > 0);
    CHECK(skin.mesh().triangle_count() == 0);
  }
}

TEST_CASE("nothing bridges pieces that go apart: each shown triangle moves with one of them") {
  const TetMesh coarse = irregular_box(2, 0.02), mesh = refine(coarse).mesh;
  const TexturedSurface fine = fine_boundary_of(mesh, 1, 1.0), outside = fine_boundary_of(mesh, 1, 1.05);
  for (const TexturedSurface& surface : {fine, outside, textured_boundary(coarse)}) {
    Topology topology(mesh);
    Skin skin(surface, mesh);
    CHECK(skin.loose_count() == 0);
    const std::vector<Index> order = shuffled_tets(mesh.tet_count(), 8);
    std::size_t most_pieces = 0, shown_in_pieces = 0;
    for (std::size_t i = 0; i < order.size(); i += 8) {
      const std::vector<Index> now(order.begin() + std::ptrdiff_t(i),
                                   order.begin() + std::ptrdiff_t(std::min(i + 8, order.size())));
      skin.follow(topology, topology.remove(now));
      const Mat3X<double> X = points_of(topology, mesh);
      Mat3X<double> u = Mat3X<double>::Zero(3, X.cols());
      const auto pieces = topology.pieces();
      for (std::size_t p = 0; p < pieces.size(); ++p)
        for (Index t : pieces[p])
          for (Index v : topology.corners(t)) u.col(v) = double(p) * Vec3d(0.1, 0.05, -0.07);
      Mat3X<float> x, normals;
      skin.update(X, u, x, normals);
      if (skin.mesh().triangle_count() > 0) CHECK(longest_stretch(skin, surface, x) < 1.01);
      most_pieces = std::max(most_pieces, pieces.size());
      if (pieces.size() > 2) shown_in_pieces = std::max(shown_in_pieces, skin.mesh().triangles.size());
    }
    CHECK(most_pieces > 10);
    CHECK(shown_in_pieces > std::size_t(surface.triangles.cols()) / 10);
    CHECK(skin.mesh().triangle_count() == 0);
  }
}

TEST_CASE("a slit opens: its banks part, and no triangle is stretched more than the tetrahedra are") {
  const int n = 6;
  const double edge = 0.01;
  const TetMesh mesh = box_mesh(Vec3d::Constant(n * edge), n, n, n);
  const TexturedSurface surface = fine_boundary_of(mesh, 2, 1.0);
  Topology topology(mesh);
  Skin skin(surface, mesh);
  std::vector<Index> slit;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Vec3d middle = barycentre(mesh, t);
    if (std::abs(middle.x() - 2.5 * edge) < 0.5 * edge && middle.z() > 2 * edge) slit.push_back(t);
  }
  const Index before = skin.mesh().triangle_count();
  skin.follow(topology, topology.remove(slit));
  CHECK(skin.mesh().triangle_count() < before - 100);
  CHECK(skin.mesh().triangle_count() > before / 2);
  const Mat3X<double> X = points_of(topology, mesh);
  Mat3X<double> u = Mat3X<double>::Zero(3, X.cols());
  for (Index v = 0; v < X.cols(); ++v)
    if (X(0, v) < 2.5 * edge) u(0, v) = -2 * std::max(0.0, X(2, v) - 2 * edge);
  Mat3X<float> x, normals;
  skin.update(X, u, x, normals);
  CHECK(longest_stretch(skin, surface, x) < 1.01 * largest_singular_value(topology, X, X + u));
  Skin uncut(surface, mesh);
  uncut.update(X, u, x, normals);
  CHECK(longest_stretch(uncut, surface, x) > 1.5 * largest_singular_value(topology, X, X + u));
}

TEST_CASE("a reader that takes over the changed slots alone has the same triangles") {
  const TetMesh mesh = irregular_box(4);
  Topology topology(mesh);
  Skin skin(fine_boundary_of(mesh, 1, 1.0), mesh);
  std::vector<Eigen::Vector3i> mirror = skin.mesh().triangles;
  std::uint64_t revision = skin.mesh().revision;
  for (Index t : shuffled_tets(mesh.tet_count(), 4)) {
    skin.follow(topology, topology.remove(std::vector<Index>{t}));
    const auto slots = skin.mesh().changed_triangles.since(revision);
    const bool same_number = mirror.size() == skin.mesh().triangles.size();
    CHECK(same_number == (revision == skin.mesh().revision));
    mirror.resize(skin.mesh().triangles.size());
    if (slots) {
      for (Index slot : *slots)
        if (slot < Index(mirror.size())) mirror[slot] = skin.mesh().triangles[slot];
    } else {
      mirror = skin.mesh().triangles;
    }
    CHECK(mirror == skin.mesh().triangles);
    revision = skin.mesh().revision;
  }
}

TEST_CASE(
    "texture coordinates of corners survive, and normals of the file that differ at a vertex keep its "
    "crease") {
  const TexturedSurface surface = obj(cube_obj);
  CHECK(surface.points.cols() == 8);
  CHECK(surface.texture.cols() == 4);
  REQUIRE(surface.triangles.cols() == 12);
  const TetMesh mesh = box_mesh(Vec3d::Ones(), 2, 2, 2);
  Skin skin(surface, mesh);
  CHECK(skin.mesh().vertex_count() == 24);
  Mat3X<float> x, normals;
  skin.update(mesh.points, Mat3X<double>::Zero(3, mesh.vertex_count()).eval(), x, normals);
  for (Index t = 0; t < 12; ++t)
    for (int c = 0; c < 3; ++c) {
      const Index vertex = skin.mesh().triangles[t][c];
      CHECK(skin.mesh().file_vertex[vertex] == surface.triangles(c, t));
      CHECK(skin.mesh().texture[vertex] == surface.texture.col(surface.texture_of(c, t)).cast<float>());
      CHECK((normals.col(vertex) - surface.normals.col(surface.normal_of(c, t)).cast<float>()).norm() <
            1e-6F);
      CHECK((x.col(vertex).cast<double>() - surface.points.col(surface.triangles(c, t))).norm() < 1e-6);
    }
}

TEST_CASE("a seam of the texture has two vertices of one place and one normal") {
  const TexturedSurface surface =
      obj("v 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nvt 0 0\nvt 0.5 0\nvt 1 1\nvt 0.25 0.75\nf 1/1 2/2 3/3\nf 1/4 "
          "3/3 4\n");
  const TetMesh mesh = box_mesh(Vec3d::Ones(), 2, 2, 2);
  Skin skin(surface, mesh);
  REQUIRE(skin.mesh().vertex_count() == 5);
  const Index first = skin.mesh().triangles[0][0], second = skin.mesh().triangles[1][0];
  CHECK(first != second);
  CHECK(skin.mesh().texture[first] == Eigen::Vector2f(0, 0));
  CHECK(skin.mesh().texture[second] == Eigen::Vector2f(0.25, 0.75));
  CHECK(skin.mesh().triangles[0][2] == skin.mesh().triangles[1][1]);
  CHECK(skin.mesh().texture[skin.mesh().triangles[1][2]] == Eigen::Vector2f(0, 0));  // has none
  Mat3X<float> x, normals;
  skin.update(mesh.points, random_displacement(mesh.vertex_count(), 0.1), x, normals);
  CHECK(x.col(first) == x.col(second));
  CHECK(normals.col(first) == normals.col(second));
}

TEST_CASE("a file that is no OBJ, or has a fault, is refused with its line") {
  CHECK(fault_of("v 0 0\n") == ":1: expected 3 numbers after v");
  CHECK(fault_of("\n\nv 0 zero 0\n") == ":3: 'zero', expected a finite number");
  CHECK(fault_of("v 0 nan 0\n") == ":1: 'nan', expected a finite number");
  CHECK(fault_of("v 0 0 0\nvt\n") == ":2: expected 1 numbers after vt");
  CHECK(fault_of("v 0 0 0\nf 1 1\n") == ":2: expected at least three corners of a face");
  CHECK(fault_of("v 0 0 0\nf 1 1 2\n") == ":2: a corner names point 2, but there are 1");
  CHECK(fault_of("v 0 0 0\nf 1 1 -2\n") == ":2: '-2' counts back beyond the first");
  CHECK(fault_of("v 0 0 0\nf 1 1 1/1\n") == ":2: a corner names texture coordinate 1, but there are 0");
  CHECK(fault_of("v 0 0 0\nf 1 1 1//1\n") == ":2: a corner names normal 1, but there are 0");
  CHECK(fault_of("v 0 0 0\nf 1 1 1/x\n") ==
        ":2: '1/x', expected a corner of whole numbers from 1 like 1/2/3");
  CHECK(fault_of("v 0 0 0\nf 1 1 0\n") == ":2: '0', expected a corner of whole numbers from 1 like 1/2/3");
  CHECK(fault_of("v 0 0 0\nf 1 1 1/1/1/1\n").starts_with(":2: '1/1/1/1', expected"));
  CHECK(fault_of("v 0 0 0\n") == ": has no face, expected lines that begin with f");
  CHECK(fault_of("solid stl\n") == ":1: 'solid', expected OBJ (v, vt, vn, f, …)");
}

TEST_CASE(
    "a skin without triangles, of corners that are not there, or of a body without tetrahedra is refused") {
  const TetMesh mesh = box_mesh(Vec3d::Ones(), 1, 1, 1);
  TexturedSurface surface = textured_boundary(mesh);
  CHECK_THROWS_WITH_AS(Skin(surface, TetMesh()), doctest::Contains("no tetrahedron"), InputError);
  CHECK_THROWS_WITH_AS(Skin(TexturedSurface(), mesh), doctest::Contains("no triangle"), InputError);
  surface.triangles(1, 3) = 8;
  CHECK_THROWS_WITH_AS(Skin(surface, mesh), doctest::Contains("skin: triangle 3"), InputError);
  surface.triangles(1, 3) = 0;
  surface.texture_of(2, 4) = 0;
  CHECK_THROWS_WITH_AS(Skin(surface, mesh), doctest::Contains("skin: triangle 4"), InputError);
}
