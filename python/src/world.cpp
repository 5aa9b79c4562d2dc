#include "world.h"

#include <algorithm>

#include "lobe/error.h"

namespace lobe::python {
namespace {

template <class Real>
class WorldOf : public AnyWorld {
 public:
  WorldOf(const Setup& setup, int threads) : world_(setup, threads) {}

  Report advance(double duration) override { return world_.advance(duration); }
  void apply(const Command& command) override { world_.apply(command); }
  double time() const override { return world_.time(); }
  const Elements& elements() const override { return world_.elements(); }
  const Tools& tools() const override { return world_.tools(); }
  Mat3X<double> positions() override {
    return elements().points.view() + world_.displacements().template cast<double>();
  }
  Mat3X<double> forces() override { return world_.forces().template cast<double>(); }
  Energies energies() override { return world_.energies(); }
  std::vector<BodyFigures> bodies() override {
    const StateView<Real> now = world_.state();
    return body_figures(elements(), now.u.template cast<double>(), now.v.template cast<double>());
  }
  std::vector<ThreadLine> threads() override { return thread_lines(world_); }
  std::vector<TermLines> lines() override { return term_lines(world_); }
  std::vector<AttachmentFigures> attachments() override { return attachment_figures(world_); }
  std::vector<ClipFigures> clips() override { return clip_figures(world_); }
  std::vector<CarrierFigures> carriers() override { return carrier_figures(world_); }
  std::vector<NeedleFigures> needles() override { return needle_figures(world_); }
  std::optional<double> free_length(ToolId needle) const override {
    if (const Threads<Real>* threads = term_of<Threads>(world_.body().terms))
      for (const Thread& thread : threads->all())
        if (thread.is_on_needle() && thread.hand.needle == needle) return thread.free_length();
    return {};
  }
  int next_thread() const override {
    int next = 0;
    for (const auto& term : world_.body().terms)
      if (const auto* threads = dynamic_cast<const Threads<Real>*>(term.get()))
        for (const Thread& thread : threads->all()) next = std::max(next, thread.number + 1);
    return next;
  }
  FoundPoint embed(const Vec3d& x) override {
    world_.displacements();
    return embed_now(x, elements(), world_.grains(), world_.body().motion.u.padded());
  }
  double time_step_limit() override { return world_.time_step_limit(); }
  PyCheckpoint save() const override { return {world_.save()}; }
  void restore(const PyCheckpoint& checkpoint) override {
    const auto* same_precision = std::get_if<Checkpoint<Real>>(&checkpoint.of);
    if (!same_precision) throw InputError("checkpoint", "is of a world in the other precision");
    world_.restore(*same_precision);
  }

  std::shared_ptr<PySnapshot> snapshot() override {
    auto made = std::make_shared<Snapshot<Real>>();
    const StateView<Real> now = world_.state();
    made->time = now.time;
    made->u = now.u;
    made->v = now.v;
    copies_.copy(world_.surface(), elements().points.view(), now.u, made->surface);
    for (const PlacedTool& tool : placed_tools(world_))
      made->tools.push_back({tool.name, tool.type, tool.position, Eigen::Quaterniond(tool.orientation),
                             -tool.force, -tool.torque, tool.shape.radius, tool.shape.blade});
    return std::make_shared<PySnapshot>(PySnapshot{std::shared_ptr<const Snapshot<Real>>(std::move(made))});
  }

 private:
  World<Real> world_;
  SurfaceCopies copies_;
};

}  // namespace

void PyWorld::restore(const PyCheckpoint& checkpoint) {
  use([&](AnyWorld& world) {
    world.restore(checkpoint);
    ++times_restored_;
  });
}

std::shared_ptr<PyWorld> make_world(const std::shared_ptr<PyScene>& scene, int threads,
                                    const std::optional<std::string>& precision) {
  if (threads < 1) throw InputError("threads", std::to_string(threads) + ", must be 1 or more");
  if (precision && *precision != "single" && *precision != "double")
    throw InputError("precision", "\"" + *precision + "\", must be \"single\" or \"double\"");
  const bool in_double = precision ? *precision == "double" : scene->scene().in_double();
  const Setup& setup = scene->resolved().setup;
  std::unique_ptr<AnyWorld> world;
  {
    const py::gil_scoped_release others_run;
    if (in_double)
      world = std::make_unique<WorldOf<double>>(setup, threads);
    else
      world = std::make_unique<WorldOf<float>>(setup, threads);
  }
  return std::make_shared<PyWorld>(scene, in_double, std::move(world));
}

}  // namespace lobe::python
