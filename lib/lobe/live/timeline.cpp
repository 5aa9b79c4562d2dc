#include "lobe/live/timeline.h"

#include <utility>

#include "lobe/file/sealed_file.h"
#include "lobe/sim/enum_sizes.h"

namespace lobe {
namespace {

template <class Real>
constexpr io::Format format{
    std::is_same_v<Real, float> ? "lobesesf" : "lobesesd", 15,
    std::is_same_v<Real, float> ? "saved session in single precision" : "saved session in double precision"};

}  // namespace

template <class Real>
Timeline<Real>::Timeline(World<Real>& world, double apart, std::size_t most_bytes)
    : world_(world),
      recorder_(world, NotedFrames::some),
      first_(world.save()),
      checkpoints_(SIZE_MAX, apart, most_bytes) {
  checkpoints_.keep(world);
}

template <class Real>
Report Timeline<Real>::advance(double duration) {
  Report report = recorder_.advance(duration);
  if (report.ok) checkpoints_.keep(world_, recording().commands.size());
  return report;
}

template <class Real>
void Timeline<Real>::go_back(double seconds) {
  constexpr double tolerance = 1e-6;  // frames are a little shorter than asked for [s]
  const auto* entry = checkpoints_.latest(world_.time() - seconds + tolerance);
  if (!entry) return restart();
  recorder_.go_back(entry->checkpoint, entry->mark);
  let_go_of_all();
}

template <class Real>
void Timeline<Real>::restart() {
  recorder_.go_back(first_, 0);
  checkpoints_.clear();
  checkpoints_.keep(world_);
  let_go_of_all();
}

template <class Real>
void Timeline<Real>::restore(SavedSession<Real> saved) {
  recorder_.go_on(saved.state, std::move(saved.recording));
  checkpoints_.clear();
  checkpoints_.keep(world_, recording().commands.size());
  let_go_of_all();
}

template <class Real>
void Timeline<Real>::let_go_of_all() {
  for (ToolId tool : world_.tools().held_by_hands()) apply(LetGo{tool});
  std::vector<int> pulled;  // threads
  if (const Threads<Real>* threads = term_of<Threads>(world_.body().terms))
    for (const Thread& thread : threads->all())
      if (thread.hand.holds && !thread.is_on_needle()) pulled.push_back(thread.number);
  for (const int thread : pulled) apply(Pull{thread, false});
}

// ---- Files

template <class Real>
void write_session(const std::filesystem::path& file, const SavedSession<Real>& saved) {
  io::ByteWriter out;
  io::put(out, saved);
  io::write_sealed(file, format<Real>, out.bytes());
}

template <class Real>
SavedSession<Real> read_session(const std::filesystem::path& file) {
  const std::string contents = io::read_sealed(file, format<Real>);
  io::ByteReader in(file.string(), contents);
  SavedSession<Real> saved;
  io::get(in, saved);
  in.expect_end();
  return saved;
}

#define LOBE_INSTANTIATE(Real)                                                          \
  template class Timeline<Real>;                                                        \
  template void write_session(const std::filesystem::path&, const SavedSession<Real>&); \
  template SavedSession<Real> read_session(const std::filesystem::path&);
LOBE_INSTANTIATE(float)
LOBE_INSTANTIATE(double)
#undef LOBE_INSTANTIATE

}  // namespace lobe
