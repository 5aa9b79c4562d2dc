#include "annotations.h"

#include <vtkActor2D.h>
#include <vtkCellData.h>
#include <vtkPlaneSource.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <sstream>

#include "organ.h"

namespace picture {
namespace {

vtkNew<vtkTextActor> label(const std::string& text, int letter) {
  vtkNew<vtkTextActor> actor;
  actor->SetInput(text.c_str());
  vtkTextProperty* property = actor->GetTextProperty();
  property->SetFontFamilyToArial();
  property->SetFontSize(letter);
  property->SetColor(0.13, 0.14, 0.17);
  return actor;
}

int width_of(vtkTextActor* text, vtkRenderer* renderer) {
  double size[2];
  text->GetSize(renderer, size);
  return static_cast<int>(size[0]);
}

void add_swatch(vtkRenderer* renderer, int x, int y, int side, const Color& color) {
  vtkNew<vtkPlaneSource> square;
  square->SetOrigin(0, 0, 0);
  square->SetPoint1(side, 0, 0);
  square->SetPoint2(0, side, 0);
  vtkNew<vtkPolyDataMapper2D> mapper;
  mapper->SetInputConnection(square->GetOutputPort());
  vtkNew<vtkActor2D> actor;
  actor->SetMapper(mapper);
  actor->SetPosition(x, y);
  actor->GetProperty()->SetColor(color[0], color[1], color[2]);
  renderer->AddActor2D(actor);
}

void add_color_bar(vtkRenderer* renderer, int x, int y, int width, int height, vtkLookupTable* colors) {
  vtkNew<vtkPlaneSource> bar;
  bar->SetOrigin(0, 0, 0);
  bar->SetPoint1(width, 0, 0);
  bar->SetPoint2(0, height, 0);
  const int cells = static_cast<int>(colors->GetNumberOfTableValues());
  bar->SetResolution(cells, 1);
  bar->Update();
  vtkNew<vtkUnsignedCharArray> rgb;
  rgb->SetNumberOfComponents(3);
  for (int i = 0; i < cells; ++i) {
    const double* color = colors->GetTableValue(i);
    rgb->InsertNextTuple3(255 * color[0], 255 * color[1], 255 * color[2]);
  }
  bar->GetOutput()->GetCellData()->SetScalars(rgb);
  vtkNew<vtkPolyDataMapper2D> mapper;
  mapper->SetInputData(bar->GetOutput());
  vtkNew<vtkActor2D> actor;
  actor->SetMapper(mapper);
  actor->SetPosition(x, y);
  renderer->AddActor2D(actor);
}

std::string short_number(double value) {
  std::ostringstream text;
  text.precision(3);
  text << value;
  return text.str();
}

}  // namespace

int PanelSize::letter() const { return std::max(9, std::min(height / 32, width / 24)); }

void add_title(vtkRenderer* renderer, const std::string& title, const PanelSize& size) {
  if (title.empty()) return;
  const vtkNew<vtkTextActor> actor = label(title, size.letter() * 5 / 4);
  actor->GetTextProperty()->SetVerticalJustificationToTop();
  actor->SetPosition(size.letter(), size.height - 0.8 * size.letter());
  renderer->AddActor2D(actor);
}

void add_region_legend(vtkRenderer* renderer, const std::vector<int>& regions, const PanelSize& size) {
  const int letter = size.letter();
  int x = letter;
  const int y = letter;
  for (const int region : regions) {
    const RegionStyle& style = region_styles()[region];
    add_swatch(renderer, x, y, letter, style.color);
    const vtkNew<vtkTextActor> name = label(style.name, letter);
    name->SetPosition(x + 1.5 * letter, y);
    renderer->AddActor2D(name);
    x += 3 * letter + width_of(name, renderer);
  }
}

void add_color_scale(vtkRenderer* renderer, vtkLookupTable* colors, const std::string& name,
                     const PanelSize& size) {
  const int letter = size.letter();
  const int length = size.width * 6 / 10;
  const int left = (size.width - length) / 2;
  add_color_bar(renderer, left, 5 * letter / 2, length, letter, colors);
  const auto add_text = [&](const std::string& text, double share) {
    const vtkNew<vtkTextActor> actor = label(text, letter);
    actor->SetPosition(left + share * (length - width_of(actor, renderer)), letter);
    renderer->AddActor2D(actor);
  };
  add_text(short_number(colors->GetRange()[0]), 0);
  add_text(name, 0.5);
  add_text(short_number(colors->GetRange()[1]), 1);
}

}  // namespace picture
