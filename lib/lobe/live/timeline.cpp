#include "lobe/live/timeline.h"

namespace lobe {

template <class Real>
Timeline<Real>::Timeline(World<Real>& world, double apart, std::size_t most_bytes)
    : world_(world), recorded_(world), first_(world.save()), kept_(SIZE_MAX, apart, most_bytes) {
  kept_.keep(world);
}

template <class Real>
Report Timeline<Real>::advance(double duration) {
  Report report = recorded_.advance(duration);
  if (report.ok) kept_.keep(world_, recording().commands.size());
  return report;
}

template <class Real>
void Timeline<Real>::go_back(double seconds) {
  constexpr double tolerance = 1e-6;  // frames are a little shorter than asked for [s]
  const auto* kept = kept_.latest(world_.time() - seconds + tolerance);
  if (!kept) return restart();
  recorded_.go_back(kept->checkpoint, kept->mark);
  let_go_of_all();
}

template <class Real>
void Timeline<Real>::restart() {
  recorded_.go_back(first_, 0);
  kept_.clear();
  kept_.keep(world_);
  let_go_of_all();
}

template <class Real>
void Timeline<Real>::let_go_of_all() {
  for (ToolId tool : world_.tools().held_by_hands()) apply(LetGo{tool});
}

template class Timeline<float>;
template class Timeline<double>;

}  // namespace lobe
