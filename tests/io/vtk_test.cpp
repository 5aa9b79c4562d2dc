// VTK itself opens what we write. Built where the pictures are, which need VTK anyway.
#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPLYReader.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include "io/fixture.h"
#include "lobe/io/surface_io.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("VTK reads a VTU of ours: points, tetrahedra, labels, displacement") {
  const fixture::Folder folder;
  const TetMesh mesh = fixture::two_cubes();
  const DataArray u{"displacement", Eigen::MatrixXd::Random(3, 12)};
  write_vtu(folder.path / "a.vtu", mesh, {u});
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName((folder.path / "a.vtu").c_str());
  reader->Update();
  vtkUnstructuredGrid* grid = reader->GetOutput();
  REQUIRE(grid->GetNumberOfPoints() == 12);
  REQUIRE(grid->GetNumberOfCells() == 12);
  vtkDataArray* displacement = grid->GetPointData()->GetArray("displacement");
  REQUIRE(displacement != nullptr);
  for (int v = 0; v < 12; ++v)
    for (int k = 0; k < 3; ++k) {
      CHECK(grid->GetPoint(v)[k] == mesh.points(k, v));
      CHECK(displacement->GetComponent(v, k) == u.values(k, v));
    }
  vtkDataArray* label = grid->GetCellData()->GetArray("label");
  REQUIRE(label != nullptr);
  for (int t = 0; t < 12; ++t) {
    CHECK(grid->GetCellType(t) == VTK_TETRA);
    CHECK(label->GetComponent(t, 0) == mesh.labels[static_cast<std::size_t>(t)]);
    for (int k = 0; k < 4; ++k) CHECK(grid->GetCell(t)->GetPointId(k) == mesh.tets(k, t));
  }
}

TEST_CASE("VTK reads a surface of ours as VTP, VTU and PLY: points, triangles, data of the triangles") {
  const fixture::Folder folder;
  Mat3X<double> points(3, 4);
  points << 0, 0.1, 0, 0, /**/ 0, 0, 1, 0, /**/ 0, 0, 0, 1;
  Triangles triangles(3, 2);
  triangles << 0, 0, /**/ 2, 1, /**/ 1, 3;
  for (const char* name : {"a.vtp", "a.vtu", "a.ply"})
    write_surface(folder.path / name, points, triangles,
                  {{"open edges", Eigen::RowVector2d(0, 1), DataArray::Type::int32}});
  const auto read = [&](auto reader, const char* name) {
    reader->SetFileName((folder.path / name).c_str());
    reader->Update();
    auto* surface = reader->GetOutput();
    REQUIRE(surface->GetNumberOfPoints() == 4);
    REQUIRE(surface->GetNumberOfCells() == 2);
    CHECK(surface->GetPoint(1)[0] == near(0.1, 1e-7));  // VTK reads PLY in single precision
    CHECK(surface->GetCell(1)->GetNumberOfPoints() == 3);
    CHECK(surface->GetCell(1)->GetPointId(2) == 3);
    return vtkSmartPointer<vtkCellData>(surface->GetCellData());
  };
  for (const auto& data : {read(vtkSmartPointer<vtkXMLPolyDataReader>::New(), "a.vtp"),
                           read(vtkSmartPointer<vtkXMLUnstructuredGridReader>::New(), "a.vtu")}) {
    REQUIRE(data->GetArray("open edges") != nullptr);
    CHECK(data->GetArray("open edges")->GetComponent(1, 0) == 1);
  }
  read(vtkSmartPointer<vtkPLYReader>::New(), "a.ply");  // drops properties of faces that it does not know
}
