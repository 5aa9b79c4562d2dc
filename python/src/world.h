// A world in Python, of either precision. One thread at a time: a call while another is under way is refused.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "checkpoint.h"
#include "lobe/diagnostics/body_figures.h"
#include "lobe/sim/world.h"
#include "scene.h"
#include "snapshot.h"

namespace lobe::python {

class AnyWorld {
 public:
  virtual ~AnyWorld() = default;
  virtual Report advance(double duration) = 0;
  virtual void apply(const Command& command) = 0;
  virtual double time() const = 0;
  virtual const Elements& elements() const = 0;
  virtual const Tools& tools() const = 0;
  virtual std::shared_ptr<PySnapshot> snapshot() = 0;
  virtual Mat3X<double> positions() = 0;  // 3 × #vertices [m]
  virtual Mat3X<double> forces() = 0;     // 3 × #vertices [N]
  virtual Energies energies() = 0;
  virtual std::vector<BodyFigures> bodies() = 0;
  virtual std::vector<ThreadLine> threads() = 0;
  virtual std::vector<TermLines> lines() = 0;  // of threads and of attachments
  virtual std::vector<AttachmentFigures> attachments() = 0;
  virtual std::vector<ClipFigures> clips() = 0;
  virtual std::vector<CarrierFigures> carriers() = 0;
  virtual std::vector<NeedleFigures> needles() = 0;
  // Natural length of the thread of a needle before its first bite [m]; none: it draws none.
  virtual std::optional<double> free_length(ToolId needle) const = 0;
  virtual int next_thread() const = 0;           // a number that no thread has
  virtual FoundPoint embed(const Vec3d& x) = 0;  // the tissue at x [m], or the nearest
  virtual double time_step_limit() = 0;
  virtual PyCheckpoint save() const = 0;
  virtual void restore(const PyCheckpoint& checkpoint) = 0;

  // ---- Made of these

  Index tet_count() const { return elements().topology.tet_count(); }
  Index vertex_count() const { return elements().topology.vertex_count(); }
  // Brings a tool; its number.
  template <class Bring>
  ToolId bring(const Bring& command) {
    const ToolId id = tools().next_id();
    apply(command);
    return id;
  }
};

class PyWorld {
 public:
  PyWorld(std::shared_ptr<PyScene> scene, bool in_double, std::unique_ptr<AnyWorld> world)
      : scene(std::move(scene)), in_double(in_double), world_(std::move(world)) {}

  const std::shared_ptr<PyScene> scene;  // that it was built from
  const bool in_double;

  // Returns work(world). Nobody else is in this world meanwhile: throws std::runtime_error if somebody is.
  // The GIL is released, so that `work` must not touch objects of Python.
  template <class Work>
  auto use(Work&& work) {
    const py::gil_scoped_release others_run;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) throw std::runtime_error("another thread is using this world");
    return work(*world_);
  }
  void apply(const Command& command) {
    use([&](AnyWorld& world) { world.apply(command); });
  }
  // How often it was restored. Tools of before are none of its present tools, though they may have the same
  // number. Within use() only.
  int times_restored() const { return times_restored_; }
  void restore(const PyCheckpoint& checkpoint);

 private:
  std::mutex mutex_;
  std::unique_ptr<AnyWorld> world_;
  int times_restored_ = 0;
};

// Throws InputError for a scene that no world can be built from.
std::shared_ptr<PyWorld> make_world(const std::shared_ptr<PyScene>& scene, int threads,
                                    const std::optional<std::string>& precision);

}  // namespace lobe::python
