#include "iso_surface.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <vtkCellArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPolyData.h>

#include <Eigen/Geometry>
#include <numbers>

namespace organs {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

Vec3 to_vec3(const auto& p) { return {p.x(), p.y(), p.z()}; }

Mesh to_mesh(const Surface& surface) {
  std::vector<Kernel::Point_3> points;
  for (const Vec3& p : surface.points) points.emplace_back(p.x(), p.y(), p.z());
  std::vector<std::array<int, 3>> triangles = surface.triangles;
  Mesh mesh;
  if (pmp::is_polygon_soup_a_polygon_mesh(triangles))
    pmp::polygon_soup_to_polygon_mesh(points, triangles, mesh);
  return mesh;
}

vtkNew<vtkImageData> sample(const Formula& formula, const Eigen::AlignedBox3d& box, double spacing) {
  const Eigen::Array3i count = (box.sizes() / spacing).array().ceil().cast<int>() + 1;
  vtkNew<vtkImageData> grid;
  grid->SetDimensions(count.x(), count.y(), count.z());
  grid->SetOrigin(box.min().x(), box.min().y(), box.min().z());
  grid->SetSpacing(spacing, spacing, spacing);
  grid->AllocateScalars(VTK_DOUBLE, 1);
  auto* value = static_cast<double*>(grid->GetScalarPointer());
  for (int k = 0; k < count.z(); ++k)
    for (int j = 0; j < count.y(); ++j)
      for (int i = 0; i < count.x(); ++i) *value++ = formula(box.min() + spacing * Vec3(i, j, k));
  return grid;
}

Mesh marching_cubes(const Formula& formula, const Eigen::AlignedBox3d& box, double spacing) {
  const vtkNew<vtkImageData> grid = sample(formula, box, spacing);
  vtkNew<vtkFlyingEdges3D> contour;
  contour->SetInputData(grid);
  contour->SetValue(0, 0.0);
  contour->ComputeNormalsOff();
  contour->ComputeScalarsOff();
  contour->Update();
  vtkPolyData* triangles = contour->GetOutput();
  Surface surface;
  for (vtkIdType i = 0; i < triangles->GetNumberOfPoints(); ++i)
    surface.points.push_back(Eigen::Map<const Vec3>(triangles->GetPoint(i)));
  vtkIdType size = 0;
  const vtkIdType* corner = nullptr;
  for (vtkCellArray* cells = triangles->GetPolys(); cells->GetNextCell(size, corner);)
    surface.triangles.push_back(
        {static_cast<int>(corner[0]), static_cast<int>(corner[1]), static_cast<int>(corner[2])});
  Mesh mesh = to_mesh(surface);
  if (!pmp::is_outward_oriented(mesh)) pmp::reverse_face_orientations(mesh);
  return mesh;
}

// Newton's method along the gradient, taken by central differences.
Vec3 project(const Formula& formula, Vec3 p) {
  const double h = 1e-5;
  for (int i = 0; i < 8; ++i) {
    Vec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 step = h * Vec3::Unit(axis);
      gradient[axis] = (formula(p + step) - formula(p - step)) / (2 * h);
    }
    p -= formula(p) / gradient.squaredNorm() * gradient;
  }
  return p;
}

double smallest_angle(const Surface& surface) {
  double smallest = 180;
  for (const auto& triangle : surface.triangles) {
    for (int i = 0; i < 3; ++i) {
      const Vec3& a = surface.points[triangle[i]];
      const Vec3 u = surface.points[triangle[(i + 1) % 3]] - a;
      const Vec3 v = surface.points[triangle[(i + 2) % 3]] - a;
      smallest = std::min(smallest, std::atan2(u.cross(v).norm(), u.dot(v)) * 180 / std::numbers::pi);
    }
  }
  return smallest;
}

}  // namespace

Surface iso_surface(const Formula& formula, const Eigen::AlignedBox3d& box, double edge) {
  Mesh mesh = marching_cubes(formula, box, 0.4 * edge);
  pmp::isotropic_remeshing(faces(mesh), edge, mesh, pmp::parameters::number_of_iterations(8));
  mesh.collect_garbage();
  Surface result;
  for (const auto v : mesh.vertices()) result.points.push_back(project(formula, to_vec3(mesh.point(v))));
  for (const auto f : mesh.faces()) {
    std::array<int, 3> triangle{};
    int corner = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f))) triangle[corner++] = static_cast<int>(v);
    result.triangles.push_back(triangle);
  }
  return result;
}

SurfaceReport inspect(const Surface& surface) {
  SurfaceReport report;
  const Mesh mesh = to_mesh(surface);
  const auto component = get(CGAL::dynamic_face_property_t<std::size_t>(), mesh);
  report.closed =
      !mesh.is_empty() && CGAL::is_closed(mesh) && pmp::connected_components(mesh, component) == 1;
  report.self_intersecting = pmp::does_self_intersect(mesh);
  report.volume = report.closed ? pmp::volume(mesh) : 0;
  report.smallest_angle = smallest_angle(surface);
  Eigen::AlignedBox3d box;
  for (const Vec3& p : surface.points) box.extend(p);
  report.size = box.sizes();
  return report;
}

}  // namespace organs
