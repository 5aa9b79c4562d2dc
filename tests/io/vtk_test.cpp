// VTK itself opens what we write. Built where the pictures are, which need VTK anyway.
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include "io/fixture.h"
#include "lobe/io/mesh_io.h"

using namespace lobe;

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
