// A session (lobe/live/) as the viewer needs it, in either precision: with the hands of one page, and with
// what pages want to see.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "haptics.h"
#include "lobe/live/sewing.h"
#include "lobe/scene/resolve.h"
#include "protocol.h"

namespace lobe::view {

struct LiveOptions {
  double frame = 1.0 / 120;  // [s]
  double speed = 1;          // simulated seconds per second
  int threads = 1;
  bool running = true;
  std::function<void(double fraction)> condensing = {};
  // There is a new picture, by the thread of the simulation; or a new measurement, by that which measures.
  std::function<void()> published = {};
};

// What a page has been sent so far.
struct Told {
  std::uint64_t topology = 0;  // stamp(), 0: none
  std::uint64_t news = 0;
  std::uint64_t scalar = 0;
  std::uint64_t skin = 0;
};

class Live {
 public:
  virtual ~Live() = default;

  // Call it when another page gets the hands, or none. Hands then let go.
  virtual void change_hands(bool somebody) = 0;
  // Whether a hand of the page has a tool, or pulls a thread.
  virtual bool hands_hold() const = 0;
  // Gives it the device that its hand follows. Null: none.
  virtual void take_haptics(std::unique_ptr<HapticRig> rig) = 0;
  virtual std::unique_ptr<HapticRig> release_haptics() = 0;
  // Returns false if the simulation has not taken a command for a long time.
  virtual bool send(HandCommand command) = 0;
  // The hand of the page as one that sews; what it does has this number (HandCommand::sequence). Null: nobody
  // has the hands.
  virtual SewingHand* sewing_hand(std::uint64_t sequence) = 0;
  // Changes when there is something new to send.
  virtual std::uint64_t news() const = 0;
  // Writes a frame of what is new, and figures into `status`. `scalar`: as in gauge.h.
  virtual void write(const std::string& scalar, Told& told, BlockWriter& out, nlohmann::json& status) = 0;
  // Whether the scene has a skin (skin_feed.h). It is computed only while a page wants to see it.
  virtual bool has_skin() const = 0;
  virtual void want_skin(bool on) = 0;
  virtual void write_skin(Told& told, BlockWriter& out) = 0;
  // Sets which scalar is measured, some times a second.
  virtual void measure(const std::string& scalar) = 0;
  // What has failed beside the simulation since the last call, a line each. Any thread.
  virtual std::vector<std::string> take_troubles() = 0;
  // What the hands did, as a scene that `lobe run` plays. Throws InputError if no scene can describe it
  // (live/session_scene.h).
  virtual Scene hands_scene() = 0;
  // Writes what the hands did as a recording for `lobe replay`.
  virtual void write_recording(const std::filesystem::path& file) = 0;
};

// It condenses pre-computed regions, which may take seconds.
std::unique_ptr<Live> start_live(const Scene& scene, const Resolved& resolved, const LiveOptions& options);

}  // namespace lobe::view
