#include "render.h"

#include <vtkCamera.h>
#include <vtkErrorCode.h>
#include <vtkLightKit.h>
#include <vtkPNGWriter.h>
#include <vtkRenderWindow.h>
#include <vtkWindowToImageFilter.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

#include "annotations.h"
#include "mesh.h"
#include "organ.h"
#include "tools.h"

namespace picture {
namespace {

struct LoadedPanel {
  const Panel& panel;
  vtkSmartPointer<vtkPolyData> surface;
};

// The axes of the picture: to the right, up, and out of it to the eye.
struct View {
  Vec3 right, up, out;
};

View view_of(const Camera& camera) {
  View view;
  view.out = camera.direction.normalized();
  view.right = camera.up.cross(view.out).normalized();
  view.up = view.out.cross(view.right);
  return view;
}

// Everything that must be seen: organs, the tips of tools, the places of bodies.
std::vector<Vec3> points_to_show(const std::vector<LoadedPanel>& panels) {
  std::vector<Vec3> points;
  for (const auto& [panel, surface] : panels) {
    for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i)
      points.emplace_back(Eigen::Map<const Vec3>(surface->GetPoint(i)));
    for (const Tool& tool : panel.tools) points.push_back(tool.position);
    for (const Body& body : panel.bodies) points.push_back(body.position);
  }
  return points;
}

constexpr double view_angle = 24;  // vertical [degrees]: little perspective
// The shares of a panel that the points may fill; the rest is for text.
constexpr double share_across = 0.88;
constexpr double share_upright = 0.76;

// The nearest camera from which all points lie within these shares: for a point with picture coordinates (x,
// y, z) relative to the axis of view, the distance d of the eye must satisfy |y| ≤ (d − z) tan(angle / 2),
// and the same for x with the panel's aspect.
vtkNew<vtkCamera> fitting_camera(const std::vector<Vec3>& points, const Camera& wish, double aspect) {
  const View view = view_of(wish);
  Eigen::Matrix3d axes;
  axes << view.right, view.up, view.out;
  Eigen::AlignedBox3d box;
  for (const Vec3& p : points) box.extend(axes.transpose() * p);
  const double slope = std::tan(view_angle / 2 * std::numbers::pi / 180);
  const double slope_x = share_across * slope * aspect;
  const double slope_y = share_upright * slope;
  double distance = 1e-3 * box.diagonal().norm() + 1e-9;
  for (const Vec3& p : points) {
    const Vec3 q = axes.transpose() * p - box.center();
    distance = std::max({distance, q.z() + std::abs(q.x()) / slope_x, q.z() + std::abs(q.y()) / slope_y});
  }
  const Vec3 target = axes * box.center();
  const Vec3 eye = target + distance / wish.zoom * view.out;
  vtkNew<vtkCamera> camera;
  camera->SetViewAngle(view_angle);
  camera->SetFocalPoint(target.data());
  camera->SetPosition(eye.data());
  camera->SetViewUp(view.up.data());
  // Not that of all actors: a shaft that passes the eye would leave no depth resolution for the organ.
  const double reach = box.diagonal().norm();
  const double away = distance / wish.zoom;
  camera->SetClippingRange(std::max(0.05 * away, away - reach), away + reach);
  return camera;
}

vtkNew<vtkRenderer> empty_panel(double left, double right) {
  vtkNew<vtkRenderer> renderer;
  renderer->SetViewport(left, 0, right, 1);
  renderer->GradientBackgroundOn();
  renderer->SetBackground(0.86, 0.89, 0.92);  // at the bottom
  renderer->SetBackground2(1, 1, 1);
  vtkNew<vtkLightKit> lights;
  lights->SetKeyLightIntensity(0.92);
  lights->SetKeyLightAngle(38, 24);
  lights->SetKeyToFillRatio(1.9);
  lights->SetKeyToHeadRatio(3.0);
  lights->SetKeyToBackRatio(3.0);
  lights->AddLightsToRenderer(renderer);
  return renderer;
}

// One colour map per array, over all the panels that show it, unless a panel says otherwise.
std::map<std::string, Eigen::Vector2d> array_ranges(const std::vector<LoadedPanel>& panels) {
  std::map<std::string, Eigen::Vector2d> ranges;
  for (const auto& [panel, surface] : panels) {
    if (!shows_array(panel)) continue;
    const Eigen::Vector2d range = array_range(surface, panel);
    const auto [known, is_new] = ranges.try_emplace(panel.color, range);
    if (!is_new) known->second = {std::min(known->second[0], range[0]), std::max(known->second[1], range[1])};
  }
  return ranges;
}

std::vector<LoadedPanel> load(const Picture& picture) {
  std::vector<LoadedPanel> panels;
  for (const Panel& panel : picture.panels) panels.push_back({panel, read_surface(panel, picture.clip)});
  return panels;
}

// Up and out of the picture, leaning towards its middle, so that much of the shaft is seen.
Vec3 default_axis(const Tool& tool, vtkPolyData* surface, const View& view) {
  const Vec3 center = Eigen::Map<const Vec3>(surface->GetCenter());
  const double aside = 2 * (tool.position - center).dot(view.right) / surface->GetLength();
  return 0.80 * view.up + (0.2 - 0.5 * std::clamp(aside, -1.0, 1.0)) * view.right + 0.55 * view.out;
}

void fill_panel(vtkRenderer* renderer, const LoadedPanel& loaded, const View& view,
                const std::map<std::string, Eigen::Vector2d>& ranges, const PanelSize& size) {
  const auto& [panel, surface] = loaded;
  const bool by_array = shows_array(panel);
  const auto colors = by_array ? color_map(panel.range.value_or(ranges.at(panel.color))) : nullptr;
  add_organ(renderer, surface, panel, colors);
  for (const Tool& tool : panel.tools)
    add_tool(renderer, tool, default_axis(tool, surface, view), view.out, 2 * surface->GetLength());
  for (const Body& body : panel.bodies) add_body(renderer, body);
  add_title(renderer, panel.title, size);
  if (panel.color == "region") add_region_legend(renderer, regions_shown(surface), size);
  if (by_array) add_color_scale(renderer, colors, panel.color, size);
}

// Written to a temporary name and renamed.
void write_png(vtkRenderWindow* window, const std::filesystem::path& file) {
  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(window);
  image->ReadFrontBufferOff();
  const std::filesystem::path unfinished = file.string() + ".tmp";
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(image->GetOutputPort());
  writer->SetFileName(unfinished.c_str());
  writer->Write();
  std::error_code failed;
  if (writer->GetErrorCode() == vtkErrorCode::NoError) std::filesystem::rename(unfinished, file, failed);
  if (writer->GetErrorCode() != vtkErrorCode::NoError || failed) {
    std::filesystem::remove(unfinished, failed);
    throw std::runtime_error(file.string() + ": cannot be written");
  }
}

}  // namespace

void render(const Picture& picture) {
  const std::vector<LoadedPanel> panels = load(picture);
  const auto ranges = array_ranges(panels);
  const int count = static_cast<int>(panels.size());
  const PanelSize size{picture.size.x() / count, picture.size.y()};
  const double aspect = static_cast<double>(size.width) / size.height;
  const vtkNew<vtkCamera> camera = fitting_camera(points_to_show(panels), picture.camera, aspect);

  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(true);
  window->SetMultiSamples(8);
  window->SetSize(picture.size.x(), picture.size.y());
  for (int i = 0; i < count; ++i) {
    const vtkNew<vtkRenderer> renderer = empty_panel(i / double(count), (i + 1) / double(count));
    window->AddRenderer(renderer);
    renderer->SetActiveCamera(camera);
    fill_panel(renderer, panels[i], view_of(picture.camera), ranges, size);
  }
  window->Render();
  write_png(window, picture.out);
}

}  // namespace picture
