#include "organ.h"

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkColorTransferFunction.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace picture {
namespace {

constexpr Color organ_color = {0.62, 0.20, 0.16};
// Of several bodies, by their number; liver, kidney, stomach and so on look about like that.
constexpr std::array<Color, 8> body_colors = {{organ_color,
                                               {0.72, 0.45, 0.36},
                                               {0.80, 0.58, 0.50},
                                               {0.42, 0.55, 0.30},
                                               {0.55, 0.36, 0.52},
                                               {0.78, 0.66, 0.38},
                                               {0.36, 0.50, 0.62},
                                               {0.60, 0.60, 0.58}}};
constexpr Color flesh_color = {0.86, 0.42, 0.36};  // what a cut lays open
constexpr double flesh_share = 0.45;               // of it in the colour of an exposed face

// Which style the faces of a surface have.
class StyleOfFace {
 public:
  explicit StyleOfFace(vtkPolyData* surface)
      : region_(surface->GetCellData()->GetArray("region")),
        embedded_(surface->GetCellData()->GetArray("embedded")) {}

  bool is_known() const { return region_; }
  int operator()(vtkIdType face) const {
    constexpr int models = std::size(lobe::region_model_names);
    const int region = std::clamp(static_cast<int>(region_->GetTuple1(face)), 0, models - 1);
    if (region != int(lobe::RegionModel::reduced) || !embedded_) return region;
    return embedded_->GetTuple1(face) != 0 ? models : models + 1;
  }

 private:
  vtkDataArray *region_, *embedded_;
};

// Of the organ, or of what the panel asks for.
class ColorOfFace {
 public:
  ColorOfFace(vtkPolyData* surface, const Panel& panel)
      : by_region_(panel.color == "region"),
        style_(surface),
        body_(panel.color == "body" ? surface->GetCellData()->GetArray("body") : nullptr) {}

  const Color& operator()(vtkIdType face) const {
    if (by_region_ && style_.is_known()) return region_styles()[std::size_t(style_(face))].color;
    if (body_) return body_colors[std::size_t(std::max(0.0, body_->GetTuple1(face))) % body_colors.size()];
    return organ_color;
  }

 private:
  bool by_region_;
  StyleOfFace style_;
  vtkDataArray* body_;
};

// One colour per face, towards flesh where a cut has exposed it.
vtkSmartPointer<vtkUnsignedCharArray> face_colors(vtkPolyData* surface, const Panel& panel) {
  const ColorOfFace color(surface, panel);
  vtkDataArray* exposed = surface->GetCellData()->GetArray("exposed");
  auto colors = vtkSmartPointer<vtkUnsignedCharArray>::New();
  colors->SetName("face color");
  colors->SetNumberOfComponents(3);
  colors->SetNumberOfTuples(surface->GetNumberOfCells());
  for (vtkIdType i = 0; i < surface->GetNumberOfCells(); ++i) {
    const Color& base = color(i);
    const double share = exposed->GetTuple1(i) != 0 ? flesh_share : 0;
    for (int k = 0; k < 3; ++k)
      colors->SetComponent(i, k, std::round(255 * ((1 - share) * base[k] + share * flesh_color[k])));
  }
  return colors;
}

// Smooth, but sharp where faces meet at more than 45 degrees: rims and cuts.
vtkSmartPointer<vtkPolyData> with_normals(vtkPolyData* surface) {
  vtkNew<vtkPolyDataNormals> normals;
  normals->SetInputData(surface);
  normals->SetFeatureAngle(45);
  normals->SplittingOn();
  normals->ConsistencyOn();
  normals->Update();
  return normals->GetOutput();
}

vtkNew<vtkActor> wet_skin(vtkPolyData* shaded, const Panel& panel, vtkLookupTable* colors) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(shaded);
  // Mesh lines lie in front of the faces, by 2e-4 of the depth that is drawn.
  mapper->SetResolveCoincidentTopologyToPolygonOffset();
  mapper->SetRelativeCoincidentTopologyPolygonOffsetParameters(0, 200);
  if (shows_array(panel)) {
    const bool of_points = shaded->GetPointData()->HasArray(panel.color.c_str());
    of_points ? mapper->SetScalarModeToUsePointFieldData() : mapper->SetScalarModeToUseCellFieldData();
    mapper->SelectColorArray(panel.color.c_str());
    mapper->SetLookupTable(colors);
    mapper->UseLookupTableScalarRangeOn();
    mapper->InterpolateScalarsBeforeMappingOn();
  } else {
    mapper->SetScalarModeToUseCellFieldData();
    mapper->SelectColorArray("face color");
    mapper->SetColorModeToDirectScalars();
  }
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  vtkProperty* property = actor->GetProperty();
  property->SetInterpolationToPhong();
  property->SetAmbient(0.20);
  property->SetDiffuse(0.88);
  property->SetSpecular(shows_array(panel) ? 0.12 : 0.38);
  property->SetSpecularPower(38);
  return actor;
}

vtkNew<vtkActor> mesh_lines(vtkPolyData* shaded) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(shaded);
  mapper->ScalarVisibilityOff();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  vtkProperty* property = actor->GetProperty();
  property->SetRepresentationToWireframe();
  property->LightingOff();
  property->SetColor(0.10, 0.04, 0.04);
  property->SetOpacity(0.22);
  property->SetLineWidth(1);
  return actor;
}

// A line through the middle of each face, drawn just in front of it.
vtkNew<vtkActor> fibre_lines(vtkPolyData* surface) {
  vtkDataArray* line = surface->GetCellData()->GetArray("fibre line");
  vtkNew<vtkPoints> ends;
  vtkNew<vtkCellArray> cells;
  for (vtkIdType i = 0; i < surface->GetNumberOfCells(); ++i) {
    vtkIdType size = 0;
    const vtkIdType* corner = nullptr;
    surface->GetCellPoints(i, size, corner);
    Vec3 centre = Vec3::Zero();
    for (vtkIdType k = 0; k < size; ++k)
      centre += Eigen::Map<const Vec3>(surface->GetPoint(corner[k])) / size;
    const Vec3 half = 0.4 * Eigen::Map<const Vec3>(line->GetTuple3(i));
    for (const Vec3& end : {Vec3(centre - half), Vec3(centre + half)}) ends->InsertNextPoint(end.data());
    const vtkIdType pair[2] = {2 * i, 2 * i + 1};
    cells->InsertNextCell(2, pair);
  }
  vtkNew<vtkPolyData> lines;
  lines->SetPoints(ends);
  lines->SetLines(cells);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(lines);
  mapper->ScalarVisibilityOff();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetColor(0.98, 0.90, 0.62);
  actor->GetProperty()->SetLineWidth(2);
  return actor;
}

}  // namespace

const RegionStyles& region_styles() {
  static const RegionStyles styles = {{{lobe::region_model_names[0], {0.29, 0.52, 0.75}},
                                       {lobe::region_model_names[1], {0.40, 0.62, 0.50}},
                                       {lobe::region_model_names[2], {0.66, 0.23, 0.18}},
                                       {lobe::region_model_names[3], {0.80, 0.55, 0.30}},
                                       {lobe::region_model_names[4], {0.55, 0.42, 0.68}},
                                       {"reduced, on its lattice", {0.80, 0.55, 0.30}},
                                       {"reduced, full now", {0.80, 0.36, 0.42}}}};
  return styles;
}

std::vector<int> regions_shown(vtkPolyData* surface) {
  std::set<int> shown;
  if (const StyleOfFace style(surface); style.is_known())
    for (vtkIdType i = 0; i < surface->GetNumberOfCells(); ++i) shown.insert(style(i));
  return {shown.begin(), shown.end()};
}

bool shows_array(const Panel& panel) {
  return panel.color != "none" && panel.color != "region" && panel.color != "body";
}

Eigen::Vector2d array_range(vtkPolyData* surface, const Panel& panel) {
  vtkDataArray* array = surface->GetPointData()->GetArray(panel.color.c_str());
  if (!array) array = surface->GetCellData()->GetArray(panel.color.c_str());
  if (array) {
    Eigen::Vector2d range;
    array->GetFiniteRange(range.data(), array->GetNumberOfComponents() == 1 ? 0 : -1);
    return range.allFinite() ? range : Eigen::Vector2d(0, 1);
  }
  std::string names = "none, region, body";
  for (vtkFieldData* data : {static_cast<vtkFieldData*>(surface->GetPointData()),
                             static_cast<vtkFieldData*>(surface->GetCellData())})
    for (int i = 0; i < data->GetNumberOfArrays(); ++i)
      if (const char* name = data->GetArrayName(i)) names += std::string(", ") + name;
  throw std::runtime_error(panel.mesh.string() + ": no array \"" + panel.color + "\"; there are: " + names);
}

vtkSmartPointer<vtkLookupTable> color_map(const Eigen::Vector2d& range) {
  // Viridis (CC0) at equal distances.
  constexpr std::array<Color, 9> viridis = {{{0.267, 0.005, 0.329},
                                             {0.279, 0.175, 0.483},
                                             {0.230, 0.322, 0.546},
                                             {0.173, 0.449, 0.558},
                                             {0.128, 0.567, 0.551},
                                             {0.158, 0.684, 0.502},
                                             {0.369, 0.789, 0.383},
                                             {0.678, 0.864, 0.190},
                                             {0.993, 0.906, 0.144}}};
  vtkNew<vtkColorTransferFunction> function;
  for (std::size_t i = 0; i < viridis.size(); ++i)
    function->AddRGBPoint(static_cast<double>(i) / (viridis.size() - 1), viridis[i][0], viridis[i][1],
                          viridis[i][2]);
  auto table = vtkSmartPointer<vtkLookupTable>::New();
  table->SetNumberOfTableValues(256);
  for (int i = 0; i < 256; ++i) {
    Color color{};
    function->GetColor(i / 255.0, color.data());
    table->SetTableValue(i, color[0], color[1], color[2]);
  }
  table->SetVectorModeToMagnitude();
  table->SetNanColor(0.6, 0.6, 0.6, 1);
  table->SetTableRange(range[0], range[1] > range[0] ? range[1] : range[0] + 1);
  return table;
}

void add_organ(vtkRenderer* renderer, vtkPolyData* surface, const Panel& panel, vtkLookupTable* colors) {
  for (const char* array : {"region", "body"})
    if (panel.color == array && !surface->GetCellData()->HasArray(array))
      throw std::runtime_error(panel.mesh.string() + ": has no cell array \"" + array + "\"");
  if (!shows_array(panel)) surface->GetCellData()->AddArray(face_colors(surface, panel));
  const vtkSmartPointer<vtkPolyData> shaded = with_normals(surface);
  renderer->AddActor(wet_skin(shaded, panel, colors));
  if (panel.edges) renderer->AddActor(mesh_lines(shaded));
  if (panel.fibres) renderer->AddActor(fibre_lines(surface));
}

}  // namespace picture
