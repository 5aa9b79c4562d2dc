#include "lobe_mesh/surface.h"

#include <cmath>
#include <limits>

#include "lobe/file/scanner.h"
#include "lobe/io/surface_io.h"
#include "lobe_mesh/diagnose.h"
#include "meshing/shapes.h"
#include "near.h"

using namespace lobe;
using namespace lobe::meshing;
using test::near;

TEST_CASE("every format gives back the volume of what was written") {
  const SurfaceFolder folder;
  const Surface sphere = make_sphere(0.05, 2);
  for (const std::string name : {"a.obj", "a.off", "a.ply", "a.stl"}) {
    CAPTURE(name);
    const Surface read = read_surface(folder.write(name, sphere));
    CHECK(read.point_count() == sphere.point_count());
    CHECK(read.triangle_count() == sphere.triangle_count());
    CHECK(enclosed_volume(read) == near(enclosed_volume(sphere), 1e-6));
    CHECK(diagnose(read).meshable());
  }
}

TEST_CASE("ascii STL and PLY, quadrilaterals and negative OBJ indices are read") {
  const SurfaceFolder folder;
  const std::string stl =
      "solid x\nfacet normal 0 0 1\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n vertex 0 1 0\n endloop\n"
      "endfacet\nfacet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 "
      "0\nendloop\nendfacet\n"
      "endsolid x\n";
  const Surface two = read_surface(folder.write("a.stl", stl));
  CHECK(two.point_count() == 4);
  CHECK(two.triangle_count() == 2);
  const Surface quad =
      read_surface(folder.write("q.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf -4//1 -3//1 -2//1 -1//1\n"));
  CHECK(quad.triangle_count() == 2);
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 255\n1 0 0 255\n0 1 0 255\n3 0 1 2\n";
  CHECK(read_surface(folder.write("p.ply", ply)).triangle_count() == 1);
}

TEST_CASE(
    "surfaces in VTK's formats are read: legacy polygons and strips, grids of triangles, strips of VTP") {
  const SurfaceFolder folder;
  const std::string head = "# vtk DataFile Version 3.0\ncube\nASCII\nDATASET ",
                    points = "POINTS 8 float\n0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\n",
                    sides = "4 0 3 2 1 4 4 5 6 7";
  const std::string around = "4 0 5 1 6 2 7 3 4 0";  // a strip of eight triangles
  const auto check_cube = [](const Surface& cube) {
    CHECK(cube.triangle_count() == 12);
    CHECK(enclosed_volume(cube) == near(1, 1e-12));
    CHECK(diagnose(cube).meshable());
  };
  check_cube(read_surface(
      folder.write("a.vtk", head + "POLYDATA\n" + points + "LINES 1 3 2 0 1\nPOLYGONS 2 10\n" + sides +
                                "\nTRIANGLE_STRIPS 1 11\n10 " + around + "\nCELL_DATA 4\nSCALARS a int\n")));
  const std::string quads = "4 0 3 2 1 4 4 5 6 7 4 0 1 5 4 4 1 2 6 5 4 2 3 7 6 4 3 0 4 7";
  check_cube(read_surface(folder.write("b.vtk", head + "UNSTRUCTURED_GRID\n" + points + "CELLS 6 30\n" +
                                                    quads + "\nCELL_TYPES 6\n9 9 9 9 9 9\n")));
  for (const std::string name : {"c.vtu", "c.vtp"}) {
    const Surface sphere = make_sphere(0.05, 2);
    write_surface(folder.path / name, sphere.points, sphere.triangles);
    CHECK(read_surface(folder.path / name).triangles == sphere.triangles);
  }
  const Surface strip = read_surface(folder.write(
      "d.vtp",
      "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"4\" NumberOfPolys=\"0\"><Points>"
      "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 1 1 0"
      "</DataArray></Points><Polys><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">"
      "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\"></DataArray></Polys>"
      "<Strips><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray>"
      "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">4</DataArray></Strips>"
      "</Piece></PolyData></VTKFile>"));
  CHECK(strip.triangle_count() == 2);
  Triangles expected(3, 2);
  expected << 0, 1, /**/ 1, 3, /**/ 2, 2;
  CHECK(strip.triangles == expected);
  // Strips alone, and a file that promises more of them than it has.
  const std::string alone =
      "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"4\" NumberOfStrips=\"1\"><Points>"
      "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 1 1 0"
      "</DataArray></Points><Strips><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 3"
      "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">4</DataArray></Strips>"
      "</Piece></PolyData></VTKFile>";
  CHECK(read_surface(folder.write("f.vtp", alone)).triangles == expected);
  std::string promising = alone;
  promising.replace(promising.find("NumberOfStrips=\"1\""), 18, "NumberOfStrips=\"2\"");
  const auto more = folder.write("g.vtp", promising);
  CHECK(contains(input_error([&] { read_surface(more); }), "NumberOfStrips is '2', but 1 are in the file"));
  const std::string tetrahedron =
      folder
          .write("e.vtk", head + "UNSTRUCTURED_GRID\n" + points + "CELLS 1 5\n4 0 1 2 4\nCELL_TYPES 1\n10\n")
          .string();
  CHECK(contains(input_error([&] { read_surface(tetrahedron); }), "lobe takes it as it is"));
}

TEST_CASE("a backslash continues a line of OBJ, and faults name the line where it begins") {
  const SurfaceFolder folder;
  const std::string points = "v 0 0 \\\n0\nv 2 0 0\nv 2 1 0\nv 0 1 0\n";
  const Surface quad = read_surface(folder.write("q.obj", points + "f 1 2 \\ \r\n 3 \\\n4\n"));
  CHECK(quad.point_count() == 4);
  CHECK(quad.triangle_count() == 2);
  const auto wrong = folder.write("r.obj", points + "f 1 2 \\\nx\n");
  CHECK(contains(input_error([&] { read_surface(wrong); }), "line 6"));
}

TEST_CASE("a concave polygon is triangulated inside its outline") {
  const SurfaceFolder folder;
  const Surface arrow =
      read_surface(folder.write("c.off", "OFF\n4 1 0\n0 0 0\n2 1 0\n0 2 0\n1 1 0\n4 0 1 2 3\n"));
  REQUIRE(arrow.triangle_count() == 2);
  double area = 0;
  for (const auto& t : arrow.triangles.colwise()) {
    const Vec3d a = arrow.points.col(t[1]) - arrow.points.col(t[0]),
                b = arrow.points.col(t[2]) - arrow.points.col(t[0]);
    area += (a[0] * b[1] - a[1] * b[0]) / 2;
    CHECK(a[0] * b[1] - a[1] * b[0] > 0);
  }
  CHECK(area == near(1, 1e-9));
}

TEST_CASE("files that are missing, empty, truncated or garbled are refused by name") {
  const SurfaceFolder folder;
  const auto error = [&](const std::filesystem::path& file) {
    const std::string text = input_error([&] { read_surface(file); });
    CHECK(contains(text, file.string()));
    return text;
  };
  CHECK(contains(error(folder.path / "no.obj"), "no such file"));
  CHECK(contains(error(folder.write("a.xyz", "hello")), "unknown extension"));
  std::string garbage;
  for (int i = 0; i < 2000; ++i) garbage += static_cast<char>(i * i * 7 + i / 3);
  for (const std::string extension : {".obj", ".off", ".ply", ".stl", ".vtp"}) {
    CAPTURE(extension);
    CHECK(contains(error(folder.write("empty" + extension, "")), "empty"));
    CHECK(error(folder.write("garbage" + extension, garbage)) != "");
    const auto whole = folder.write("whole" + extension, make_sphere(1, 1));
    const auto size = std::filesystem::file_size(whole);
    std::filesystem::resize_file(whole, extension == ".obj" ? size / 5 : size * 2 / 3);
    CHECK(error(whole) != "");
  }
  CHECK(contains(error(folder.write("i.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n")), "uses vertex 6"));
  CHECK(contains(error(folder.write("j.obj", "v 0 0 0\nv 1 zero 0\n")), "line 2"));
  CHECK(contains(error(folder.write("k.off", "OFF\n99999999999 1 0\n0 0 0\n")), "truncated"));
}

TEST_CASE("the diagnosis counts each kind of fault and says where it is") {
  Surface cube = make_cube(1);
  CHECK(diagnose(cube).meshable());
  CHECK(diagnose(cube).volume == near(1, 1e-9));
  CHECK(diagnose(without_triangle(cube, 3)).open_edges.count == 3);
  CHECK(diagnose(inverted(cube)).inverted);
  CHECK(diagnose(joined(cube, moved(cube, {3, 0, 0}))).components == 2);
  CHECK(diagnose(joined(cube, moved(cube, {0.5, 0.5, 0.5}))).self_intersections.count > 0);
  CHECK(diagnose(joined(cube, cube)).duplicate_points.count == 8);
  Surface flipped = cube;
  std::swap(flipped.triangles(0, 0), flipped.triangles(1, 0));
  CHECK(diagnose(flipped).inconsistent_edges.count == 3);
  Surface fin = cube;
  fin.triangles.conservativeResize(3, 13);
  fin.triangles.col(12) << 0, 1, 7;
  CHECK(diagnose(fin).non_manifold_edges.count == 2);
  Surface again = cube;
  again.triangles.conservativeResize(3, 13);
  again.triangles.col(12) = cube.triangles.col(4);
  CHECK(diagnose(again).duplicate_triangles.count == 1);
  CHECK(diagnose(joined(cube, cube)).duplicate_triangles.count ==
        12);  // vertices of their own in the same places
  again.triangles.col(12) << 2, 2, 5;
  CHECK(diagnose(again).degenerate.count == 1);
  Surface needle = cube;
  needle.points.conservativeResize(3, 9);
  needle.points.col(8) = (cube.points.col(cube.triangles(0, 0)) + cube.points.col(cube.triangles(1, 0))) / 2;
  needle.triangles.conservativeResize(3, 13);
  needle.triangles.col(12) << cube.triangles(0, 0), cube.triangles(1, 0), 8;
  CHECK(diagnose(needle).degenerate.count == 1);
  Surface touching = joined(cube, moved(cube, {1, 1, 1}));
  const auto corner_at = [&](Index from) {
    for (Index v = from; v < touching.point_count(); ++v)
      if (touching.points.col(v) == Vec3d(1, 1, 1)) return v;
    return Index{-1};
  };
  const Index corner = corner_at(0), other = corner_at(8);
  for (Index& v : touching.triangles.reshaped())
    if (v == other) v = corner;
  CHECK(diagnose(touching).non_manifold_points.count == 1);
  CHECK(diagnose(touching).closed());
  CHECK_FALSE(diagnose(touching).meshable());
  const Surface small = moved(scaled(cube, 0.5), {0.25, 0.25, 0.25});
  CHECK(diagnose(joined(cube, inverted(small))).cavities == 1);
  CHECK(diagnose(joined(cube, inverted(small))).meshable());
  CHECK(diagnose(joined(cube, small)).wrong_sides.count == 1);
  CHECK(diagnose(joined(cube, inverted(moved(cube, {3, 0, 0})))).wrong_sides.count == 1);
  CHECK(diagnose(inverted(cube)).wrong_sides.count == 1);
  CHECK(diagnose(joined(cube, inverted(small))).wrong_sides.count == 0);
  CHECK(contains(diagnose(scaled(cube, 100)).scale_hint, "0.001"));
  CHECK(diagnose(scaled(cube, 0.1)).scale_hint.empty());
  Surface nan = cube;
  nan.points(1, 5) = std::numeric_limits<double>::quiet_NaN();
  CHECK(diagnose(nan).not_finite.count == 1);
  CHECK(contains(in_words(diagnose(nan)), "1 coordinate that is not finite: vertex 5"));
  CHECK(contains(in_json(diagnose(nan)), "\"meshable\": false"));
}

TEST_CASE("the marked surface carries every fault at its triangles") {
  const SurfaceFolder folder;
  Surface bad = without_triangle(make_cube(1), 3);
  std::swap(bad.triangles(0, 0), bad.triangles(1, 0));
  const Diagnosis diagnosis = diagnose(bad);
  write_marked(folder.path / "m.vtp", bad, diagnosis);
  CHECK(read_surface(folder.path / "m.vtp").triangles == bad.triangles);
  const std::string text = io::read_file(folder.path / "m.vtp");
  CHECK(contains(text, "Name=\"open edges\""));
  CHECK(contains(text, "Name=\"inconsistently oriented edges\""));
  CHECK_FALSE(contains(text, "Name=\"degenerate triangles\""));
  CHECK(diagnosis.open_edges.triangles.size() == 3);
  CHECK(diagnosis.inconsistent_edges.count >= 2);
  CHECK(diagnosis.inconsistent_edges.triangles.size() ==
        2 * static_cast<std::size_t>(diagnosis.inconsistent_edges.count));
}
