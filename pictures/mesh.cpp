#include "mesh.h"

#include <vtkCellData.h>
#include <vtkDataSetSurfaceFilter.h>
#include <vtkDoubleArray.h>
#include <vtkErrorCode.h>
#include <vtkExtractGeometry.h>
#include <vtkIdList.h>
#include <vtkOBJReader.h>
#include <vtkPLYReader.h>
#include <vtkPlane.h>
#include <vtkPointData.h>
#include <vtkSTLReader.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>
#include <vector>

namespace picture {
namespace {

template <class Reader>
vtkSmartPointer<vtkPointSet> read_with(const std::filesystem::path& file) {
  vtkNew<Reader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  if (reader->GetErrorCode() != vtkErrorCode::NoError)
    throw std::runtime_error(file.string() + ": cannot be read");
  return reader->GetOutput();
}

vtkSmartPointer<vtkPointSet> read_points_and_cells(const std::filesystem::path& file) {
  const std::string type = file.extension().string();
  if (type == ".vtu") return read_with<vtkXMLUnstructuredGridReader>(file);
  if (type == ".vtp") return read_with<vtkXMLPolyDataReader>(file);
  if (type == ".obj") return read_with<vtkOBJReader>(file);
  if (type == ".stl") return read_with<vtkSTLReader>(file);
  if (type == ".ply") return read_with<vtkPLYReader>(file);
  throw std::runtime_error(file.string() + ": must be .vtu, .vtp, .obj, .stl or .ply");
}

// VTK's readers do not look whether cells name points that exist, and its filters trust them.
void refuse_strange_points(vtkPointSet* mesh, const std::filesystem::path& file) {
  vtkNew<vtkIdList> corners;
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell) {
    mesh->GetCellPoints(cell, corners);
    for (vtkIdType i = 0; i < corners->GetNumberOfIds(); ++i)
      if (corners->GetId(i) < 0 || corners->GetId(i) >= mesh->GetNumberOfPoints())
        throw std::runtime_error(file.string() + ": cell " + std::to_string(cell) + " names point " +
                                 std::to_string(corners->GetId(i)) + ", there are " +
                                 std::to_string(mesh->GetNumberOfPoints()));
  }
}

vtkSmartPointer<vtkPointSet> read_mesh(const std::filesystem::path& file) {
  const auto mesh = read_points_and_cells(file);
  if (mesh->GetNumberOfPoints() == 0 || mesh->GetNumberOfCells() == 0)
    throw std::runtime_error(file.string() + ": is empty or is not a mesh");
  refuse_strange_points(mesh, file);
  return mesh;
}

// Keeps the cells that are not wholly beyond the plane.
vtkSmartPointer<vtkUnstructuredGrid> clipped(vtkDataSet* mesh, const Clip& clip) {
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(clip.point.data());
  plane->SetNormal(clip.normal.data());
  vtkNew<vtkExtractGeometry> extract;
  extract->SetInputData(mesh);
  extract->SetImplicitFunction(plane);
  extract->ExtractInsideOn();
  extract->ExtractBoundaryCellsOn();
  extract->Update();
  return extract->GetOutput();
}

// What there is on the kept side of a plane.
vtkSmartPointer<vtkDataSet> kept(const vtkSmartPointer<vtkPointSet>& mesh, const std::optional<Clip>& clip) {
  if (clip) return clipped(mesh, *clip);
  return mesh;
}

// With the cell array vtkOriginalCellIds: which cell each face is of.
vtkSmartPointer<vtkPolyData> boundary(vtkDataSet* mesh) {
  vtkNew<vtkDataSetSurfaceFilter> filter;
  filter->SetInputData(mesh);
  filter->PassThroughCellIdsOn();
  filter->Update();
  return filter->GetOutput();
}

// A face, known by the rest positions of its corners: those survive renumbering and the doubling of vertices.
using Face = std::array<std::array<double, 3>, 3>;

Face face_of(vtkPolyData* surface, vtkIdType cell) {
  vtkIdType size = 0;
  const vtkIdType* corner = nullptr;
  surface->GetCellPoints(cell, size, corner);
  Face face{};
  for (int i = 0; i < 3 && i < size; ++i) surface->GetPoint(corner[i], face[i].data());
  std::sort(face.begin(), face.end());
  return face;
}

// Whether a face was on the boundary at the start, as the cell array "skin" says in frames of bodies that a
// blade has cut: one bit for the face opposite to each corner.
bool was_boundary(vtkDataSet* mesh, vtkPolyData* surface, vtkIdType face) {
  vtkDataArray* skin = surface->GetCellData()->GetArray("skin");
  vtkDataArray* cells = surface->GetCellData()->GetArray("vtkOriginalCellIds");
  if (!skin || !cells) return false;
  const Face corners = face_of(surface, face);
  vtkNew<vtkIdList> points;
  mesh->GetCellPoints(static_cast<vtkIdType>(cells->GetTuple1(face)), points);
  for (vtkIdType i = 0; i < points->GetNumberOfIds(); ++i) {
    std::array<double, 3> x{};
    mesh->GetPoint(points->GetId(i), x.data());
    if (std::find(corners.begin(), corners.end(), x) == corners.end())
      return (static_cast<int>(skin->GetTuple1(face)) >> i & 1) != 0;
  }
  return false;
}

// `surface`, of `mesh`, is still at rest here.
void mark_exposed(vtkDataSet* mesh, vtkPolyData* surface, const Panel& panel,
                  const std::optional<Clip>& clip) {
  vtkNew<vtkUnsignedCharArray> exposed;
  exposed->SetName("exposed");
  exposed->SetNumberOfValues(surface->GetNumberOfCells());
  exposed->Fill(0);
  if (!panel.first.empty()) {
    const vtkSmartPointer<vtkPolyData> skin = boundary(kept(read_mesh(panel.first), clip));
    std::set<Face> outside;
    for (vtkIdType i = 0; i < skin->GetNumberOfCells(); ++i) outside.insert(face_of(skin, i));
    for (vtkIdType i = 0; i < surface->GetNumberOfCells(); ++i)
      exposed->SetValue(i, !outside.contains(face_of(surface, i)) && !was_boundary(mesh, surface, i));
  } else if (vtkDataArray* cut = surface->GetCellData()->GetArray("cut")) {
    for (vtkIdType i = 0; i < surface->GetNumberOfCells(); ++i) exposed->SetValue(i, cut->GetTuple1(i) != 0);
  }
  surface->GetCellData()->AddArray(exposed);
}

Eigen::Matrix<double, 3, 2> sides_of(vtkPolyData* surface, vtkIdType cell) {
  Eigen::Matrix<double, 3, 3> corners;
  vtkIdType size = 0;
  const vtkIdType* corner = nullptr;
  surface->GetCellPoints(cell, size, corner);
  if (size != 3) return Eigen::Matrix<double, 3, 2>::Zero();
  for (int i = 0; i < 3; ++i) surface->GetPoint(corner[i], corners.col(i).data());
  return corners.rightCols<2>().colwise() - corners.col(0);
}

// The part of each face's fibre that lies in it, as a sum of two sides of the face; 0 without an area.
std::vector<Eigen::Vector2d> fibres_in_faces(vtkPolyData* surface, const std::filesystem::path& file) {
  vtkDataArray* fibre = surface->GetCellData()->GetArray("fibre");
  if (!fibre || fibre->GetNumberOfComponents() != 3)
    throw std::runtime_error(file.string() + ": has no cell array \"fibre\" of 3 components");
  std::vector<Eigen::Vector2d> parts;
  for (vtkIdType i = 0; i < surface->GetNumberOfCells(); ++i) {
    const Eigen::Matrix<double, 3, 2> sides = sides_of(surface, i);
    const Eigen::Matrix2d products = sides.transpose() * sides;
    Eigen::Vector2d part = Eigen::Vector2d::Zero();
    if (products.determinant() > 0)
      part = products.inverse() * (sides.transpose() * Eigen::Map<const Vec3>(fibre->GetTuple3(i)));
    parts.push_back(part);
  }
  return parts;
}

void add_fibre_lines(vtkPolyData* surface, const std::vector<Eigen::Vector2d>& parts) {
  vtkNew<vtkDoubleArray> lines;
  lines->SetName("fibre line");
  lines->SetNumberOfComponents(3);
  for (vtkIdType i = 0; i < surface->GetNumberOfCells(); ++i) {
    const Eigen::Matrix<double, 3, 2> sides = sides_of(surface, i);
    const double size = std::sqrt(sides.col(0).cross(sides.col(1)).norm());
    const Vec3 line = size * (sides * parts[static_cast<std::size_t>(i)]);
    lines->InsertNextTuple(line.data());
  }
  surface->GetCellData()->AddArray(lines);
}

void move_by_displacement(vtkPolyData* surface, const std::filesystem::path& file) {
  vtkDataArray* displacement = surface->GetPointData()->GetArray("displacement");
  if (displacement && displacement->GetNumberOfComponents() != 3)
    throw std::runtime_error(file.string() + ": displacement must have 3 components");
  vtkNew<vtkPoints> moved;
  moved->SetDataTypeToDouble();
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i) {
    Vec3 x = Eigen::Map<const Vec3>(surface->GetPoint(i));
    if (displacement) x += Eigen::Map<const Vec3>(displacement->GetTuple3(i));
    if (!x.allFinite())
      throw std::runtime_error(file.string() + ": a coordinate or displacement is not finite");
    moved->InsertNextPoint(x.data());
  }
  surface->SetPoints(moved);
}

}  // namespace

vtkSmartPointer<vtkPolyData> read_surface(const Panel& panel, const std::optional<Clip>& clip) {
  const vtkSmartPointer<vtkDataSet> mesh = kept(read_mesh(panel.mesh), clip);
  const vtkSmartPointer<vtkPolyData> surface = boundary(mesh);
  if (surface->GetNumberOfCells() == 0)
    throw std::runtime_error(panel.mesh.string() + ": nothing is left on the kept side of the clip plane");
  mark_exposed(mesh, surface, panel, clip);
  std::vector<Eigen::Vector2d> fibres;
  if (panel.fibres) fibres = fibres_in_faces(surface, panel.mesh);
  move_by_displacement(surface, panel.mesh);
  if (panel.fibres) add_fibre_lines(surface, fibres);
  return surface;
}

}  // namespace picture
