// A session simulates a body in real time, in frames of equal length. Meanwhile any thread may send commands
// of hands and read snapshots (docs/live.md).
//
//   Session<float> session(resolved.setup);
//   Controller mouse = session.connect("mouse");
//   session.start();  // a thread of its own; or call step_frame() in a loop
//   mouse.send({.kind = HandCommand::Kind::take_at_ray, .hand = 1,
//               .position = eye, .direction = ray, .radius = 0.01});
//   mouse.send({.kind = HandCommand::Kind::lead, .hand = 1, .position = there});
//   const auto picture = session.pictures().latest();
//
// Hands act only through commands of the world (sim/command.h). All of these are recorded. A replay gives the
// same bits.
#pragma once

#include <array>
#include <atomic>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "lobe/live/hand_queue.h"
#include "lobe/live/hands.h"
#include "lobe/live/pace.h"
#include "lobe/live/session_hook.h"
#include "lobe/live/timeline.h"

namespace lobe {

// Whether a session can have this speed, in simulated seconds per second of the clock.
inline bool is_session_speed(double speed) { return speed >= 0.001 && speed <= 100; }

struct SessionOptions {
  // Length of a frame [s], above 0. The session lowers it by up to 2e-9 of itself, so that multiples are
  // exact.
  double frame = 1.0 / 120;
  int threads = 1;                      // threads of the world
  double speed = 1;                     // simulated seconds per second of the clock, 0.001 … 100
  bool paced = true;                    // false: frames follow each other without waiting
  bool running = true;                  // false: it begins paused
  std::uint32_t queue = 1024;           // capacity of the queue of hand commands
  double back_every = 0.5;              // simulated time between two states kept for going back [s]
  std::size_t back_memory = 64u << 20;  // memory for these states [bytes]
  double controller_timeout = 0;        // after this silence a controller's hands let go [s]; 0: never
  HandLimits hand = {};                 // lag, top speed and greatest force of hands
  // Called with the finished share while pre-computed regions are condensed.
  CondensingLog::Progress condensing = {};
  // Called after each status by the thread that makes it, at first by the constructor. Must not wait. If it
  // throws, the session says so (SessionMessage) and goes on.
  std::function<void()> published = {};
};

// A controller is a person or program that has hands. When it is destroyed its hands let go. The session must
// outlive it.
class Controller {
 public:
  Controller(HandQueue& queue, const std::string& name) : queue_(&queue), number_(queue.connect(name)) {}
  Controller(Controller&& other) noexcept
      : queue_(std::exchange(other.queue_, nullptr)), number_(other.number_) {}
  Controller& operator=(Controller&& other) noexcept {
    std::swap(queue_, other.queue_);
    std::swap(number_, other.number_);
    return *this;
  }
  ~Controller() {
    if (queue_) queue_->disconnect(number_);
  }

  int number() const { return number_; }  // number in SessionStatus
  // Sends a command. False if the queue is full; the command may then be sent again. Never waits for the
  // simulation.
  bool send(const HandCommand& command) { return queue_->send(number_, command); }

 private:
  HandQueue* queue_;
  int number_;
};

template <class Real>
class Session {
 public:
  // Throws InputError for a setup that no world can be built from, and for invalid options.
  explicit Session(const Setup& setup, const SessionOptions& options = {});
  ~Session() { stop(); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // ---- Any thread

  // Registers a controller. Throws InputError if 64 are connected already.
  Controller connect(const std::string& name) { return {queue_, name}; }
  // The snapshots of the world, also called pictures here; latest() gives the newest. To see what a command
  // has done, read status() first and pictures() second: the snapshot then has the effect of all commands
  // that the status lists.
  const TripleBuffer<Snapshot<Real>>& pictures() const { return pictures_; }
  TripleBuffer<SessionStatus>::View status() const { return status_.latest(); }  // live/status.h
  // Runs `work` between two frames and returns when it is done. The simulation waits meanwhile. `work` may
  // do all that is listed under "Between frames only" below, or make a scene; it must not call
  // between_frames(). An exception of
  // `work` is thrown here. If the session is not started, `work` runs on the calling thread; then only the
  // thread that calls step_frame() may call this.
  void between_frames(const std::function<void()>& work);

  // ---- To run it: the thread that owns it

  // Starts a thread that simulates until stop(). An exception in a frame, of a hook for example, ends
  // neither the thread nor the program: the session gives the message `failed` and stands still. Only going
  // back or restarting leads on from there.
  void start();
  void stop();  // lets that thread end after its present frame; start() may be called again
  bool is_started() const { return thread_.joinable(); }
  // Performs the commands sent since the last frame, then simulates one frame. While it pauses it only
  // performs the commands, and returns false. Do not call it between start() and stop().
  bool step_frame();

  // ---- Between frames only: while the session is not started, or within between_frames()

  // The world, to be read. What is done to it directly is in no recording: replays, saved scenes then differ.
  // Send commands (HandCommand::Kind::edit).
  World<Real>& world() { return world_; }
  const World<Real>& world() const { return world_; }
  const Recording& recording() const { return timeline_.recording(); }
  double frame() const { return frame_; }  // [s]
  // Writes the present state, and the recording that led to it, into a file.
  void save(const std::filesystem::path& file) const { write_session(file, timeline_.save()); }
  // Goes on from a file of save(), of the same scene. All hands let go. Throws InputError for a file that is
  // damaged, or of another scene, precision or version; the session is then unchanged.
  void restore(const std::filesystem::path& file);
  // Calls a hook in each frame until remove_hook() or the end of the session. The hook must live until then.
  void add_hook(SessionHook<Real>& hook) { hooks_.push_back(&hook); }
  void remove_hook(SessionHook<Real>& hook) { std::erase(hooks_, &hook); }

 private:
  struct LastCommand {
    std::uint64_t sequence = 0;
    Pace::Clock::time_point at{};
  };

  void run();
  void run_frame();
  void fail(const std::string& why);
  void wait_until(Pace::Clock::time_point due);
  void take_commands();
  void perform_command(const HandQueue::Sent& sent);
  void control(const HandCommand& command);
  void edit(const HandCommand& command);
  void go_back(const HandCommand& command);
  void set_running(bool running);
  void drop_silent_controllers();
  void do_work();
  void report_condition(const Condition& condition);
  void publish(const Report& report);
  void publish_status();
  void say(const std::string& name, const std::string& text) { messages_.say(world_.time(), name, text); }

  const SessionOptions options_;
  const double frame_;  // [s]
  HandQueue queue_;
  World<Real> world_;
  const TripleBuffer<Snapshot<Real>>& pictures_;
  Timeline<Real> timeline_;
  Messages messages_;
  Hands<Real> hands_;
  std::vector<SessionHook<Real>*> hooks_;
  Pace pace_;
  std::array<LastCommand, HandQueue::most_controllers> last_commands_;
  double speed_;
  bool is_running_;
  bool steps_once_ = false, stands_still_ = false;
  bool has_failed_ = false;   // a frame was left in the middle
  bool was_told_ = false;     // something has happened that the next status must show
  bool was_changed_ = false;  // whether the body was edited, or put back, since the last snapshot
  std::int64_t frames_ = 0, reruns_ = 0;
  TripleBuffer<SessionStatus> status_;

  std::thread thread_;
  std::atomic<bool> stops_ = false;
  std::atomic<bool> is_driven_ = false;  // whether that thread drives it
  std::mutex asking_;
  std::atomic<const std::function<void()>*> work_ = nullptr;
  std::exception_ptr work_failed_;
};

extern template class Session<float>;
extern template class Session<double>;

}  // namespace lobe
