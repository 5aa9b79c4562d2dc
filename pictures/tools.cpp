#include "tools.h"

#include <vtkActor.h>
#include <vtkConeSource.h>
#include <vtkCubeSource.h>
#include <vtkLineSource.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkSphereSource.h>
#include <vtkTransform.h>
#include <vtkTransformPolyDataFilter.h>
#include <vtkTubeFilter.h>

#include <Eigen/Geometry>

#include "organ.h"

namespace picture {
namespace {

constexpr Color steel = {0.74, 0.76, 0.79};
constexpr Color sleeve = {0.16, 0.17, 0.19};  // the insulation of a shaft
constexpr Color glow = {1.0, 0.62, 0.16};
constexpr Color held = {0.98, 0.86, 0.30};
constexpr int sides = 32;

vtkProperty* add(vtkRenderer* renderer, vtkAlgorithm* source, const Color& color) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(source->GetOutputPort());
  mapper->ScalarVisibilityOff();
  // In front of mesh lines, which VTK pulls towards the eye (by -1, -4; faces by 2, 2).
  mapper->SetRelativeCoincidentTopologyPolygonOffsetParameters(-3, -6);
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  vtkProperty* property = actor->GetProperty();
  property->SetInterpolationToPhong();
  property->SetColor(color[0], color[1], color[2]);
  property->SetAmbient(0.25);
  property->SetDiffuse(0.75);
  property->SetSpecular(0.8);
  property->SetSpecularPower(45);
  renderer->AddActor(actor);
  return property;
}

vtkProperty* add_rod(vtkRenderer* renderer, const Vec3& a, const Vec3& b, double radius, const Color& color) {
  vtkNew<vtkLineSource> line;
  line->SetPoint1(a.x(), a.y(), a.z());
  line->SetPoint2(b.x(), b.y(), b.z());
  vtkNew<vtkTubeFilter> tube;
  tube->SetInputConnection(line->GetOutputPort());
  tube->SetRadius(radius);
  tube->SetNumberOfSides(sides);
  tube->CappingOn();
  return add(renderer, tube, color);
}

vtkProperty* add_ball(vtkRenderer* renderer, const Vec3& center, double radius, const Color& color) {
  vtkNew<vtkSphereSource> sphere;
  sphere->SetCenter(center.x(), center.y(), center.z());
  sphere->SetRadius(radius);
  sphere->SetThetaResolution(sides);
  sphere->SetPhiResolution(sides / 2);
  return add(renderer, sphere, color);
}

vtkNew<vtkTransformPolyDataFilter> moved(vtkAlgorithm* source, const Eigen::Matrix3d& axes,
                                         const Vec3& position) {
  Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = axes;
  matrix.topRightCorner<3, 1>() = position;
  vtkNew<vtkTransform> placed;
  placed->SetMatrix(matrix.data());
  vtkNew<vtkTransformPolyDataFilter> transform;
  transform->SetInputConnection(source->GetOutputPort());
  transform->SetTransform(placed);
  return transform;
}

// A cone from its base to its point, squeezed along `flat` to the given share of its width.
vtkProperty* add_spike(vtkRenderer* renderer, const Vec3& base, const Vec3& point, double radius,
                       const Vec3& flat, double share, const Color& color) {
  vtkNew<vtkConeSource> cone;  // along x, its middle at the origin
  cone->SetHeight((point - base).norm());
  cone->SetRadius(radius);
  cone->SetResolution(sides);
  Eigen::Matrix3d axes;
  axes.col(0) = (point - base).normalized();
  axes.col(1) = (flat - flat.dot(axes.col(0)) * axes.col(0)).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  axes.col(1) *= share;
  return add(renderer, moved(cone, axes, (base + point) / 2), color);
}

// Bare metal near the tip, then the insulating sleeve.
void add_shaft(vtkRenderer* renderer, const Vec3& start, const Vec3& axis, double radius, double length) {
  const Vec3 bare_end = start + 5 * radius * axis;
  add_rod(renderer, start, bare_end, radius, steel);
  add_rod(renderer, bare_end, start + length * axis, 1.25 * radius, sleeve)->SetSpecular(0.45);
}

void glowing(vtkProperty* property) {
  property->SetAmbient(0.75);
  property->SetDiffuse(0.35);
}

void add_cautery(vtkRenderer* renderer, const Tool& tool, const Vec3& axis, double length) {
  glowing(add_ball(renderer, tool.position, tool.radius, glow));
  for (const double size : {1.25, 1.55}) {
    vtkProperty* halo = add_ball(renderer, tool.position, size * tool.radius, glow);
    glowing(halo);
    halo->SetSpecular(0);
    halo->SetOpacity(0.13);
  }
  add_shaft(renderer, tool.position + 0.6 * tool.radius * axis, axis, 0.42 * tool.radius, length);
}

// Two jaws that meet at the position, hinged on the shaft, open along `side`.
void add_grasper(vtkRenderer* renderer, const Tool& tool, const Vec3& axis, const Vec3& side, double length) {
  const double r = tool.radius;
  const Vec3 hinge = tool.position + 3.6 * r * axis;
  for (const double sign : {-1.0, 1.0}) {
    const Vec3 elbow = tool.position + 1.9 * r * axis + sign * 0.75 * r * side;
    add_rod(renderer, hinge, elbow, 0.24 * r, steel);
    add_ball(renderer, elbow, 0.28 * r, steel);
    const Vec3 tip = tool.position - 0.15 * r * axis + sign * 0.10 * r * side;
    add_spike(renderer, elbow, tip, 0.34 * r, side, 0.7, steel);
  }
  add_ball(renderer, hinge, 0.5 * r, steel);
  add_shaft(renderer, hinge, axis, 0.42 * r, length);
}

void add_scalpel(vtkRenderer* renderer, const Tool& tool, const Vec3& axis, double length) {
  const Vec3 end = tool.position + 4 * tool.radius * axis;
  add_spike(renderer, end, tool.position, 0.8 * tool.radius, axis.unitOrthogonal(), 0.12, steel);
  add_shaft(renderer, end, axis, 0.5 * tool.radius, length);
}

void add_probe(vtkRenderer* renderer, const Tool& tool, const Vec3& axis, double length) {
  add_ball(renderer, tool.position, tool.radius, steel);
  add_shaft(renderer, tool.position, axis, 0.42 * tool.radius, length);
}

}  // namespace

void add_tool(vtkRenderer* renderer, const Tool& tool, const Vec3& away, const Vec3& eye, double length) {
  const Vec3 axis = tool.direction.value_or(away).normalized();
  const Vec3 across = eye.cross(axis);
  const Vec3 side = across.norm() > 1e-3 ? across.normalized() : axis.unitOrthogonal();
  switch (tool.type) {
    case ToolType::cautery:
      add_cautery(renderer, tool, axis, length);
      break;
    case ToolType::grasp:
      add_grasper(renderer, tool, axis, side, length);
      break;
    case ToolType::scalpel:
      add_scalpel(renderer, tool, axis, length);
      break;
    case ToolType::probe:
      add_probe(renderer, tool, axis, length);
      break;
  }
  for (const Vec3& point : tool.points) add_ball(renderer, point, 0.18 * tool.radius, held);
}

void add_body(vtkRenderer* renderer, const Body& body) {
  if (body.box.isZero(0)) {
    const Vec3 end = body.position + body.orientation * Vec3(0, 0, body.length);
    if (body.length > 0) add_rod(renderer, body.position, end, body.radius, steel);
    for (const Vec3& tip : {body.position, end}) add_ball(renderer, tip, body.radius, steel);
    return;
  }
  vtkNew<vtkCubeSource> cube;
  cube->SetXLength(body.box.x());
  cube->SetYLength(body.box.y());
  cube->SetZLength(body.box.z());
  add(renderer, moved(cube, body.orientation.toRotationMatrix(), body.position), steel);
}

}  // namespace picture
