// A world in Python, of either precision. One thread at a time: a call while another is under way is refused.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "lobe/sim/checkpoint.h"
#include "scene.h"
#include "snapshot.h"

namespace lobe::python {

struct PyCheckpoint {
  std::variant<Checkpoint<float>, Checkpoint<double>> of;
};

class PyWorld {
 public:
  virtual ~PyWorld() = default;
  virtual Report advance(double duration) = 0;
  virtual void apply(const Command& command) = 0;
  virtual double time() const = 0;
  virtual bool in_double() const = 0;
  virtual const Elements& elements() const = 0;
  virtual const Tools& tools() const = 0;
  virtual std::shared_ptr<PySnapshot> snapshot() = 0;
  virtual Mat3X<double> positions() = 0;  // 3 × #vertices [m]
  virtual Mat3X<double> forces() = 0;     // 3 × #vertices [N]
  virtual Energies energies() = 0;
  virtual double time_step_limit() = 0;
  virtual PyCheckpoint save() const = 0;
  virtual void restore(const PyCheckpoint& checkpoint) = 0;

  std::shared_ptr<PyScene> scene;  // that it was built from

  // Held during a call.
  std::unique_lock<std::mutex> claim() {
    std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock);
    if (!lock) throw std::runtime_error("another thread is using this world");
    return lock;
  }

 private:
  std::mutex mutex_;
};

std::shared_ptr<PyWorld> make_world(const std::shared_ptr<PyScene>& scene, int threads,
                                    const std::optional<std::string>& precision);

}  // namespace lobe::python
