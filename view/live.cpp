#include "live.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include "gauge.h"
#include "lobe/live/session_scene.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/read_shape.h"
#include "skin_feed.h"
#include "thread_feed.h"

namespace lobe::view {
namespace {

using Json = nlohmann::json;

constexpr std::chrono::milliseconds between_measurements(125);

std::atomic<std::uint64_t> sessions_so_far = 0;

Json array(const Vec3d& p) { return {p[0], p[1], p[2]}; }
Json array(const Eigen::Vector4d& q) { return {q[0], q[1], q[2], q[3]}; }

constexpr HandLimits hand_limits;

SessionOptions session_options(const LiveOptions& options) {
  SessionOptions result;
  result.back_memory = 256u << 20;  // [bytes]; for undoing what was done minutes ago
  result.frame = options.frame;
  result.hand = hand_limits;
  result.speed = options.speed;
  result.threads = options.threads;
  result.running = options.running;
  result.condensing = options.condensing;
  result.published = options.published;
  return result;
}

template <class Real>
class LiveOf final : public Live {
 public:
  LiveOf(const Scene& scene, const Resolved& resolved, const LiveOptions& options)
      : scene_(scene),
        setup_(session_setup(scene, resolved.setup)),
        session_(setup_, with_skin(session_options(options))),
        published_(options.published) {
    if (!scene.skin.empty()) skin_.emplace(skin_path(scene), setup_.mesh, session_.world());
    for (const Tool& tool : scene.tools) scene_tools_.insert(tool.name());
    session_.start();
    measuring_ = std::thread([this] { keep_measuring(); });
  }

  ~LiveOf() override {
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
    }
    changed_.notify_all();
    measuring_.join();
    sewing_.reset();
    controller_.reset();
    haptics_.reset();
    session_.stop();
  }

  void change_hands(bool somebody) override {
    number_ = no_controller;
    sewing_.reset();
    controller_.reset();
    if (somebody) {
      number_ = controller_.emplace(session_.connect("page")).number();
      sewing_.emplace(
          session_, [this](const HandCommand& command) { return send_numbered(command); }, hand_limits);
    }
    lead_device();
  }

  bool hands_hold() const override {
    const auto status = session_.status();
    if (threads_.is_held()) return true;
    return status && std::any_of(status->hands.begin(), status->hands.end(), [&](const HandStatus& hand) {
             return hand.controller == number_ && hand.tool != 0;
           });
  }

  void take_haptics(std::unique_ptr<HapticRig> rig) override {
    if (!rig) return;
    haptics_.emplace(session_, std::move(rig));
    lead_device();
  }

  std::unique_ptr<HapticRig> release_haptics() override {
    if (!haptics_) return nullptr;
    std::unique_ptr<HapticRig> rig = haptics_->release();
    haptics_.reset();
    return rig;
  }

  bool send(HandCommand command) override {
    if (!controller_ || (haptics_ && haptics_->takes(command))) return true;
    return controller_->send(command);
  }

  SewingHand* sewing_hand(std::uint64_t sequence) override {
    sequence_ = sequence;
    return sewing_ ? &*sewing_ : nullptr;
  }

  std::uint64_t news() const override {
    const auto status = session_.status();
    if (!status) return 0;
    std::uint64_t hash = 14695981039346656037u;
    const auto mix = [&](std::uint64_t value) { hash = (hash ^ value) * 1099511628211u; };
    mix(std::uint64_t(status->picture));
    mix(std::uint64_t(status->is_running) + 2 * std::uint64_t(status->stands_still));
    mix(std::uint64_t(1000 * status->speed));
    if (!status->messages->empty()) {
      mix(status->messages->back().number);
      mix(std::uint64_t(status->messages->back().times));
    }
    mix(last_seen(*status));
    const std::lock_guard lock(mutex_);
    mix(measured_->number);
    mix(troubles_.size());
    return hash;
  }

  void write(const std::string& scalar, Told& told, BlockWriter& out, Json& status) override {
    const auto session = session_.status();  // before the picture, which then has all that the status lists
    const auto picture = session_.pictures().latest();
    if (!session || !picture) return;
    const SurfaceMesh& surface = *picture->surface.mesh;
    if (const std::uint64_t stamp = first_stamp_ + surface.revision; told.topology != stamp) {
      told.topology = stamp;
      const Mat3X<float> rest = rest_of(*picture);
      write_topology(surface, rest, out);
      write_fibres(surface, rest, setup_.mesh.fibres, out);
      write_bodies(surface, setup_.mesh.bodies, out);
      write_json(obstacles_tag, obstacles().dump(), out);
    }
    write_positions(surface, picture->surface.x.template cast<float>(), out);
    write_lines(picture->lines, out);
    write_measured(scalar, surface.revision, told, out, status);
    write_json(tools_tag, tools(*session, *picture).dump(), out);
    add_figures(*session, *picture, status);
    if (haptics_) status["haptic"] = haptics_->rig().figures();
  }

  void measure(const std::string& scalar) override {
    const std::lock_guard lock(mutex_);
    wanted_ = scalar;
  }

  std::vector<std::string> take_troubles() override {
    const std::lock_guard lock(mutex_);
    return std::exchange(troubles_, {});
  }

  Scene hands_scene() override {
    Scene scene;
    session_.between_frames([&] { scene = session_scene(scene_, setup_, session_); });
    return scene;
  }

  bool has_skin() const override { return skin_.has_value(); }
  void want_skin(bool on) override {
    if (!skin_) return;
    skin_->set_wanted(on);
    if (on) session_.between_frames([&] { skin_->update(session_.world()); });  // where it pauses
  }
  void write_skin(Told& told, BlockWriter& out) override {
    if (skin_) skin_->write(first_stamp_, told.skin, out);
  }

  void write_recording(const std::filesystem::path& file) override {
    session_.between_frames([&] { lobe::write_recording(file, session_.recording()); });
  }

 private:
  // The skin is computed anew with each picture, by the thread of the session.
  SessionOptions with_skin(SessionOptions options) {
    options.published = [this, published = options.published] {
      if (skin_) skin_->update(session_.world());
      if (gauge_.follows()) gauge_.follow(session_.world());
      threads_.update(session_.world());
      if (published) published();
    };
    return options;
  }

  // By whichever thread: that of the server, or that of the session, which leads what a hand pulls.
  bool send_numbered(const HandCommand& command) {
    HandCommand numbered = command;
    numbered.sequence = sequence_;
    return controller_->send(numbered);
  }

  void lead_device() {
    if (haptics_) haptics_->change_hands(controller_ ? std::optional(controller_->number()) : std::nullopt);
  }

  // The thread of the session measures energies and fields between frames. This thread waits for them. What
  // cannot be measured is not tried again until something else is wanted.
  void keep_measuring() {
    std::string failed;  // to measure
    std::unique_lock lock(mutex_);
    while (!changed_.wait_for(lock, between_measurements, [&] { return ends_; })) {
      const std::string scalar = wanted_;
      if (scalar == failed) continue;
      failed.clear();
      const std::shared_ptr<const Measured> before = measured_;
      lock.unlock();
      try {
        if (const auto next = measured_since(*before, scalar)) {
          const std::lock_guard storing(mutex_);
          measured_ = next;
        }
        if (measured() != before && published_) published_();
        lock.lock();
      } catch (const std::exception& error) {
        lock.lock();
        failed = scalar;
        troubles_.push_back("colours and energies cannot be measured: " + std::string(error.what()));
      }
    }
  }

  // Null if nothing has moved since, and the same was measured.
  std::shared_ptr<const Measured> measured_since(const Measured& before, const std::string& scalar) {
    std::shared_ptr<Measured> next;
    session_.between_frames([&] {
      if (session_.world().time() == before.time && before.scalar == scalar) return;
      next = std::make_shared<Measured>();
      gauge_.measure(session_.world(), scalar, *next);
      next->number = before.number + 1;
    });
    return next;
  }

  std::shared_ptr<const Measured> measured() const {
    const std::lock_guard lock(mutex_);
    return measured_;
  }

  std::uint64_t last_seen(const SessionStatus& status) const {
    const auto number = std::size_t(number_.load());
    return number < status.sequences.size() ? status.sequences[number] : 0;
  }

  static Mat3X<float> rest_of(const Snapshot<Real>& picture) {
    return (picture.surface.x - at_surface<Real>(*picture.surface.mesh, picture.u)).template cast<float>();
  }

  void write_measured(const std::string& scalar, std::uint64_t revision, Told& told, BlockWriter& out,
                      Json& status) const {
    const auto latest = measured();
    if (latest->number == 0) return;
    status["energy"] = {{"time", latest->time}, {"elastic", latest->elastic}, {"kinetic", latest->kinetic}};
    if (latest->linear_error >= 0) status["linear_error"] = latest->linear_error;
    if (scalar == "none" || latest->scalar != scalar || latest->revision != revision ||
        told.scalar == latest->number)
      return;
    told.scalar = latest->number;
    write_scalar(scalar, latest->values, out);
  }

  Json tools(const SessionStatus& status, const Snapshot<Real>& picture) const {
    Json list = Json::array();
    for (const HandStatus& hand : status.hands) {
      if (hand.tool == 0) continue;
      if (hand.type == GraspSetup::type && !hand.holds) continue;
      list.push_back({{"tool", hand.tool},
                      {"hand", hand.hand},
                      {"type", hand.type},
                      {"on", hand.holds},
                      {"position", array(hand.pose.position)},
                      {"orientation", array(hand.pose.orientation)},
                      {"force", array(hand.force)},
                      {"radius", hand.shape.radius},
                      {"blade", array(hand.shape.blade)}});
      if (hand.type == GraspSetup::type) list.back()["most"] = hand_limits.force_cap;
      add_jaws(hand.shape.jaw, hand.shape.opening, list.back());
    }
    int number = -1;  // of the scene's own, which no hand leads
    for (const ToolSnapshot& tool : picture.tools) {
      if (!scene_tools_.contains(tool.name)) continue;
      list.push_back({{"tool", number--},
                      {"type", tool.type},
                      {"on", true},
                      {"position", array(tool.position)},
                      {"orientation", array(Eigen::Vector4d(tool.orientation.coeffs()))},
                      {"force", array(tool.force)},
                      {"radius", tool.radius},
                      {"blade", array(Vec3d(tool.orientation.conjugate() * tool.blade))}});
      add_jaws(tool.jaw, tool.opening, list.back());
    }
    return list;
  }

  static void add_jaws(const Vec3d& jaw, double opening, Json& tool) {
    if (jaw.isZero(0)) return;
    tool["jaw"] = array(jaw);
    tool["opening"] = opening;
  }

  Json obstacles() const {
    Json list = Json::array();
    for (const ObstacleSetup& obstacle : setup_.contact.obstacles)
      list.push_back({{"name", obstacle.name},
                      {"position", array(obstacle.position)},
                      {"orientation", array(obstacle.orientation)},
                      {"shape", write_shape(obstacle.shape, {})}});
    return list;
  }

  void add_figures(const SessionStatus& session, const Snapshot<Real>& picture, Json& status) const {
    status["picture"] = picture.frame;
    status["time"] = picture.time;
    status["running"] = session.is_running;
    status["stands_still"] = session.stands_still;
    status["speed"] = session.speed;
    status["factor"] = session.real_time_factor;
    status["possible"] = session.possible_factor;
    status["late"] = session.frames_late;
    status["again"] = session.reruns;
    status["can_go_back"] = session.can_go_back;
    status["steps"] = picture.figures.steps;
    status["step"] = picture.figures.time_step;
    status["tets"] = picture.figures.tets;
    status["seen"] = last_seen(session);
    if (Json threads = threads_.figures(); !threads.empty()) status["threads"] = std::move(threads);
    if (setup_.mesh.bodies.any()) status["bodies"] = setup_.mesh.bodies.names;
    Json& messages = status["messages"] = Json::array();
    for (const SessionMessage& message : *session.messages)
      messages.push_back({{"number", message.number},
                          {"name", message.name},
                          {"text", message.text},
                          {"about", message.about},
                          {"time", message.time},
                          {"times", message.times}});
  }

  const Scene scene_;
  const Setup setup_;
  std::optional<SkinFeed<Real>> skin_;  // none while the session is being made
  Gauge<Real> gauge_;                   // of the thread of the session, between frames
  ThreadFeed threads_;
  Session<Real> session_;
  const std::function<void()> published_;
  static constexpr int no_controller = HandQueue::most_controllers;
  std::optional<Controller> controller_;
  std::optional<Sewing<Real>> sewing_;  // of controller_
  std::atomic<std::uint64_t> sequence_ = 0;
  std::atomic<int> number_ = no_controller;  // of controller_, for threads that look for news
  std::optional<Haptics<Real>> haptics_;
  std::set<std::string> scene_tools_;
  const std::uint64_t first_stamp_ = ++sessions_so_far << 32;  // two sessions have no revision in common

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool ends_ = false;
  std::string wanted_ = "none";
  std::shared_ptr<const Measured> measured_ = std::make_shared<const Measured>();
  std::vector<std::string> troubles_;
  std::thread measuring_;
};

}  // namespace

std::unique_ptr<Live> start_live(const Scene& scene, const Resolved& resolved, const LiveOptions& options) {
  if (scene.in_double()) return std::make_unique<LiveOf<double>>(scene, resolved, options);
  return std::make_unique<LiveOf<float>>(scene, resolved, options);
}

}  // namespace lobe::view
