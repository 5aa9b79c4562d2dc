#include "lobe/organ/display.h"

#include <numeric>

namespace lobe {
namespace {

FigureSnapshot figures_of(const Report& report, Index tets) {
  FigureSnapshot figures{report.ok,
                         report.steps,
                         report.reruns,
                         report.time_step,
                         std::accumulate(report.seconds.begin(), report.seconds.end(), 0.0),
                         tets,
                         report.tets_removed,
                         {},
                         report.events};
  for (const Condition& condition : report.conditions) figures.conditions.push_back(condition.text);
  for (const Event& event : report.events)
    if (!event.text.empty()) figures.conditions.push_back(event.text);
  return figures;
}

TetTags tags_of(const Elements& elements) { return {elements.region_of, elements.bodies}; }

// Forces are those on the tool, as a hand that holds it feels them.
ToolSnapshot snapshot_of(const PlacedTool& tool) {
  return {tool.name,          tool.type,     tool.position,     Eigen::Quaterniond(tool.orientation),
          -tool.force,        -tool.torque,  tool.shape.radius, tool.shape.blade,
          tool.shape.opening, tool.shape.jaw};
}

LinesSnapshot snapshot_of(const TermLines& lines) {
  return {lines.term,
          lines.name,
          lines.ends.cast<float>(),
          {lines.tensions.begin(), lines.tensions.end()},
          {lines.damages.begin(), lines.damages.end()}};
}

}  // namespace

template <class Real>
const Surface& Display<Real>::surface(const Elements& elements, const Grains* grains) {
  if (!surface_) {
    surface_ = std::make_unique<Surface>();
    rebuild(elements, grains);
  }
  return *surface_;
}

template <class Real>
void Display<Real>::rebuild(const Elements& elements, const Grains* grains) {
  if (!surface_) return;
  if (grains)
    surface_->rebuild(GrainCells(*grains, elements), tags_of(elements));
  else
    surface_->rebuild(elements.topology, tags_of(elements));
}

template <class Real>
void Display<Real>::follow(const Elements& elements, Grains* grains, const MeshEdit& edit) {
  if (!grains) {
    if (surface_) surface_->follow(elements.topology, edit, tags_of(elements));
    return;
  }
  std::vector<Index> changed = grains->take_changed();
  if (!surface_) return;
  const GrainCells cells(*grains, elements);
  cells.append_changed(edit, changed);
  surface_->follow(cells, std::move(changed), tags_of(elements));
}

template <class Real>
void Display<Real>::follow_regions(const Elements& elements, const Grains* grains,
                                   const std::vector<Index>& tets) {
  if (surface_) surface_->follow_regions(*surface_cells(elements, grains), tets, elements.region_of);
}

template <class Real>
void Display<Real>::publish(const Elements& elements, const StateView<Real>& state,
                            const std::vector<PlacedTool>& tools, const std::vector<TermLines>& lines,
                            const Report& report) {
  ++published_->frames;
  Snapshot<Real>* snapshot = published_->buffer.writable();
  if (!snapshot) return;
  snapshot->time = state.time;
  snapshot->frame = published_->frames;
  snapshot->u = state.u;
  snapshot->v = state.v;
  published_->surfaces.copy(*surface_, elements.points.view(), state.u, snapshot->surface);
  snapshot->tools.clear();
  for (const PlacedTool& tool : tools) snapshot->tools.push_back(snapshot_of(tool));
  snapshot->lines.clear();
  for (const TermLines& of_term : lines) snapshot->lines.push_back(snapshot_of(of_term));
  snapshot->figures = figures_of(report, elements.topology.alive_count());
  published_->buffer.publish();
}

template class Display<float>;
template class Display<double>;

}  // namespace lobe
