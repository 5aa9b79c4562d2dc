// The C++ side of lobe_session: a Session of either precision, in an engine's axes.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "axes.h"
#include "haptic_tools.h"
#include "lobe/live/sewing.h"
#include "lobe/scene/resolve.h"
#include "lobe_c.h"

struct lobe_session {
  virtual ~lobe_session() = default;
  virtual lobe_status send(const lobe::HandCommand& command) = 0;
  virtual void start() = 0;
  virtual void stop() = 0;
  virtual bool is_started() const = 0;
  virtual void step_frame() = 0;
  virtual lobe::TripleBuffer<lobe::SessionStatus>::View status() const = 0;
  virtual int controller() const = 0;
  virtual bool fill(lobe_surface& surface) = 0;                          // false: there is no picture yet
  virtual lobe::Index tet_count() const = 0;                             // tetrahedra of the latest picture
  virtual std::shared_ptr<void> lead_by(lobe::c::HapticTool& tool) = 0;  // leads it until the result goes
  virtual lobe::SewingHand& sewing() = 0;
  virtual std::vector<lobe::LinesSnapshot> lines() const = 0;  // of the latest picture
  virtual void save_scene(const std::string& file) = 0;
  virtual void save_recording(const std::string& file) = 0;
  virtual void save(const std::string& file) = 0;
  virtual void restore(const std::string& file) = 0;

  struct Buffers {
    std::vector<float> position, normal;
    std::vector<std::uint32_t> index;
    std::vector<std::uint8_t> region, cut, body;
  };
  std::unique_ptr<Buffers> take_buffers();
  void give_back(std::unique_ptr<Buffers> buffers);

  lobe::c::Axes axes;
  std::vector<std::string> bodies;    // names of several
  std::mutex driving;                 // held by whoever starts, stops or advances it
  lobe::c::HapticTools haptic_tools;  // emptied before the session goes

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Buffers>> free_;
};

namespace lobe::c {

std::unique_ptr<lobe_session> open(Scene scene, const lobe_options& options);

}  // namespace lobe::c
